# SPDX-License-Identifier: GPL-3.0-or-later
"""Python with bpy in a process of its own: the wheel's Python, or this Blender executable."""

import os
import re
import shlex
import signal
import subprocess
import sys
import tempfile
from contextlib import contextmanager, suppress
from importlib import metadata
from pathlib import Path

import bpy

HERE = Path(__file__).resolve().parent

_HEAD = f"""
import os, sys
arguments = sys.argv[sys.argv.index("--") + 1 :]
sys.path.insert(0, {str(HERE)!r})
import bpy
"""
_TAIL = """
sys.stdout.flush()
os._exit(0)
"""


def run(script, *arguments, **environment):
    """Run a script, which finds its arguments in `arguments`; returns what it prints."""
    return _said(_done(_command, script, *arguments, **environment))


def bare(script, *arguments, **environment):
    """Like run, but in a Blender as users have it: its Python finds only bpy and its modules."""
    environment.setdefault("PATH", _path_without_virtual_environments())
    return _said(_done(_bare_command, script, *arguments, **environment))


def killed(script, *arguments, **environment):
    """Run a script that ends its own process by the signal KILL."""
    done = _done(_command, script, *arguments, **environment)
    assert done.returncode == -signal.SIGKILL, done.stdout + done.stderr


@contextmanager
def started(script, *arguments, **environment):
    """Start a script in a process, which is ended at the end of the block."""
    with tempfile.TemporaryDirectory() as folder:
        words, variables = _written(_command, folder, script, arguments, environment)
        with subprocess.Popen(
            words,
            env=variables,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        ) as process:
            try:
                yield process
            finally:
                process.kill()


def _said(done):
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def _done(command, script, *arguments, **environment):
    with tempfile.TemporaryDirectory() as folder:
        words, variables = _written(command, folder, script, arguments, environment)
        return subprocess.run(words, env=variables, capture_output=True, text=True, timeout=120)


def _written(command, folder, script, arguments, environment):
    """The script in a folder: the command that runs it, and its environment."""
    path = Path(folder, "script.py")
    path.write_text(_HEAD + script + _TAIL)
    home = {"BLENDER_USER_RESOURCES": folder}
    return [*command(path), "--", *map(str, arguments)], {**os.environ, **home, **environment}


def _command(path):
    if not bpy.app.binary_path:
        return [sys.executable, str(path)]
    return [*blender("--background"), "--python", str(path)]


def _bare_command(path):
    if bpy.app.binary_path:
        command = [*blender("--background"), "--python", str(path)]
        command.remove("--python-use-system-env")
        return command
    packages = path.parent / "packages"
    packages.mkdir()
    module = Path(bpy.utils.resource_path("LOCAL")).parent
    (packages / module.name).symlink_to(module, target_is_directory=True)
    for found in _required("bpy", set()):
        if not (packages / found.name).exists():
            (packages / found.name).symlink_to(found)
    path.write_text(f"import sys\nsys.path.append({str(packages)!r})\n{path.read_text()}")
    return [sys.executable, "-I", "-S", str(path)]


def _path_without_virtual_environments():
    """An executable's Python takes the first python3 on the path for its own, with its packages."""
    folders = os.environ.get("PATH", os.defpath).split(os.pathsep)
    return os.pathsep.join(
        folder for folder in folders if not Path(folder).parent.joinpath("pyvenv.cfg").exists()
    )


def _required(name, seen):
    """Folders and files of the packages that a package asks for: a Blender program has them too."""
    seen.add(name)
    found = []
    for line in metadata.requires(name) or []:
        needed = re.match(r"[\w.-]+", line)[0]
        if "extra ==" in line or needed in seen:
            continue
        with suppress(metadata.PackageNotFoundError):
            tops = {file.parts[0] for file in metadata.files(needed) if file.parts[0] != ".."}
            found += [Path(metadata.distribution(needed).locate_file(top)) for top in tops]
            found += _required(needed, seen)
    return found


def blender(*options):
    """Command line of this Blender executable, which fails when its script fails."""
    return [
        bpy.app.binary_path,
        "--factory-startup",
        "--python-use-system-env",
        "--python-exit-code",
        "1",
        *options,
    ]


_ENABLE = """
import addon_host
from pathlib import Path
addon_host.add_repository(Path(arguments[0], "repository"))
addon_host.enable()
bpy.ops.wm.save_userpref()
"""


def program(folder):
    """A program to call as `blender`: this executable with the add-on enabled and no settings of
    the user, or a replacement.
    """
    home = Path(folder, "blender home")
    home.mkdir()
    command = [sys.executable, str(HERE / "stand_in.py")]
    if bpy.app.binary_path:
        run(_ENABLE, home, BLENDER_USER_RESOURCES=str(home))
        command = [bpy.app.binary_path, "--python-use-system-env"]
    path = Path(folder, "blender")
    words = shlex.join(["env", f"BLENDER_USER_RESOURCES={home}", *command])
    path.write_text(f'#!/bin/sh\nexec {words} "$@"\n')
    path.chmod(0o755)
    return path
