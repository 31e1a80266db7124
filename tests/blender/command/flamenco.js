// SPDX-License-Identifier: GPL-3.0-or-later
// What Flamenco's manager gives a job type, as far as its documentation tells: node flamenco.js SCRIPT SETTINGS
// prints the settings of the type and the tasks of a job, as JSON. Anything else that a script asks for is missing.
const fs = require("fs");
const path = require("path");
const vm = require("vm");

class Task {
  constructor(name, type) {
    if (!["blender", "ffmpeg", "file-management", "misc"].includes(type)) throw new Error(`task type ${type}`);
    Object.assign(this, { name, type, commands: [], dependencies: [] });
  }
  addCommand(command) {
    if (!(command instanceof Command)) throw new Error(`task ${this.name}: no command`);
    this.commands.push(command);
  }
  addDependency(task) {
    if (!(task instanceof Task)) throw new Error(`task ${this.name}: depends on no task`);
    this.dependencies.push(task.name);
  }
}

// Parameters of the command that runs Blender, and their types.
const PARAMETERS = { exe: "string", exeArgs: "string", argsBefore: "array", blendfile: "string", args: "array" };

class Command {
  constructor(name, parameters) {
    if (name !== "blender-render") throw new Error(`command ${name}`);
    for (const [key, value] of Object.entries(parameters)) {
      const type = Array.isArray(value) ? "array" : typeof value;
      if (PARAMETERS[key] !== type) throw new Error(`parameter ${key} of ${name} is of type ${type}`);
      if (type === "array" && value.some((one) => typeof one !== "string")) throw new Error(`${key} holds no strings`);
    }
    Object.assign(this, { name, parameters });
  }
}

// "3, 5-8" in chunks of 3: ["3,5-6", "7-8"].
function frameChunker(frames, size) {
  const all = frames.split(",").flatMap((part) => {
    const [first, last] = part.trim().split("-").map(Number);
    return Array.from({ length: (last ?? first) - first + 1 }, (_, k) => first + k);
  });
  return Array.from({ length: Math.ceil(all.length / size) }, (_, k) => merged(all.slice(k * size, (k + 1) * size)));
}

function merged(frames) {
  const ranges = [];
  for (const frame of frames) {
    const last = ranges.at(-1);
    if (last && last[1] === frame - 1) last[1] = frame;
    else ranges.push([frame, frame]);
  }
  return ranges.map(([first, last]) => (first === last ? `${first}` : `${first}-${last}`)).join(",");
}

const tasks = [];
const job = { name: "shot", settings: JSON.parse(process.argv[3]), addTask: (task) => tasks.push(task) };
const author = { Task: (name, type) => new Task(name, type), Command: (name, values) => new Command(name, values) };
const context = vm.createContext({ author, frameChunker, path, print: () => {}, job });
vm.runInContext(fs.readFileSync(process.argv[2], "utf8"), context);
try {
  vm.runInContext("compileJob(job)", context);
} catch (error) {
  console.error(error.message);
  process.exit(1);
}
console.log(JSON.stringify({ type: vm.runInContext("JOB_TYPE", context), tasks }));
