// SPDX-License-Identifier: GPL-3.0-or-later
// A job type for Flamenco: bakes the scatters of a file, then renders it if asked to. It belongs into the folder
// `scripts` beside flamenco-manager; docs/farm.md tells more.

const SCENE_FRAMES = "f'{C.scene.frame_start}-{C.scene.frame_end}'";

const JOB_TYPE = {
    label: "Dapple Bake",
    description: "Bake the scatters of Dapple, then render if asked to",
    settings: [
        { key: "bake_frames", type: "string", required: true, eval: SCENE_FRAMES,
          evalInfo: { showLinkButton: true, description: "Scene frame range" },
          description: "First and last frame to bake, such as '1-250'" },
        { key: "scatter", type: "string", required: false,
          description: "Name of a scatter object; empty: all of the scene" },
        { key: "baked_file", type: "string", subtype: "file_path", required: false,
          description: "Where the baked file is saved; empty: the copy that the job works on" },
        { key: "render", type: "bool", default: false,
          description: "Render the baked file" },
        { key: "frames", type: "string", required: true, eval: SCENE_FRAMES,
          evalInfo: { showLinkButton: true, description: "Scene frame range" },
          description: "Frames to render, such as '47', '1-30' or '3, 5-10, 47-327'" },
        { key: "chunk_size", type: "int32", default: 1, visible: "submission",
          description: "Number of frames that one task renders" },
        { key: "render_output_root", type: "string", subtype: "dir_path", required: false, visible: "submission",
          description: "Folder in which the job gets a folder for its pictures" },

        { key: "blendfile", type: "string", required: true, visible: "web",
          description: "The file to bake" },
    ]
};

function compileJob(job) {
    const settings = job.settings;
    checkSettings(settings);
    const bake = bakeTask(settings);
    job.addTask(bake);
    if (!settings.render) return;
    for (const chunk of frameChunker(settings.frames, settings.chunk_size)) {
        const render = renderTask(settings, job.name, chunk);
        render.addDependency(bake);
        job.addTask(render);
    }
}

function checkSettings(settings) {
    if (!/^-?\d+(--?\d+)?$/.test(settings.bake_frames))
        throw new Error(`bake_frames is '${settings.bake_frames}': a range such as 1-250 is needed`);
    if (settings.render && !settings.render_output_root)
        throw new Error("render_output_root is empty: choose a folder for the pictures");
}

function bakeTask(settings) {
    const args = ["--command", "dapple", "bake", `--frames=${settings.bake_frames}`, "--if-needed"];
    if (settings.scatter) args.push(`--scatter=${settings.scatter}`);
    if (settings.baked_file) args.push(`--output=${settings.baked_file}`);
    return blenderTask("bake", settings.blendfile, args);
}

function renderTask(settings, name, chunk) {
    const pictures = path.join(settings.render_output_root, name, "######");
    const frames = chunk.replace(/-/g, ".."); // as Blender writes ranges
    const args = ["--render-output", pictures, "--render-frame", frames];
    return blenderTask(`render-${chunk}`, settings.baked_file || settings.blendfile, args);
}

function blenderTask(name, blendfile, args) {
    const task = author.Task(name, "blender");
    task.addCommand(author.Command("blender-render", {
        exe: "{blender}",
        exeArgs: "{blenderArgs}",
        argsBefore: [],
        blendfile: blendfile,
        args: args,
    }));
    return task;
}
