# SPDX-License-Identifier: GPL-3.0-or-later
"""Stands in for Blender's executable where there is only the module bpy, which has no command line.

It opens a file, enables the add-on, and runs the command that this adds or renders frames:

python stand_in.py -b FILE [-o PICTURE] [-s FIRST] [-e LAST] [-a | --command dapple ARGUMENT...]
"""

import argparse
import os
import sys
import tempfile
from pathlib import Path

os.environ.setdefault("BLENDER_USER_RESOURCES", tempfile.mkdtemp(prefix="dapple-blender-"))
import bpy

sys.path.insert(0, str(Path(__file__).resolve().parent))
import addon_host


def asked() -> argparse.Namespace:
    """As Blender reads it, as far as the tests use it."""
    parser = argparse.ArgumentParser(allow_abbrev=False)
    parser.add_argument("-b", dest="file")
    parser.add_argument("-o", dest="picture")
    parser.add_argument("-s", dest="first", type=int)
    parser.add_argument("-e", dest="last", type=int)
    parser.add_argument("-a", dest="render", action="store_true")
    parser.add_argument("--command", nargs=argparse.REMAINDER)
    return parser.parse_args()


def enable() -> None:
    """The add-on, in a repository of this process, where the wrapper keeps Blender's files."""
    home = os.environ["BLENDER_USER_RESOURCES"]
    addon_host.add_repository(Path(tempfile.mkdtemp(dir=home)) / "repository")
    addon_host.enable()


def render(wanted: argparse.Namespace) -> int:
    """Pictures of frames."""
    scene = bpy.context.scene
    scene.render.filepath = wanted.picture or scene.render.filepath
    scene.frame_start = scene.frame_start if wanted.first is None else wanted.first
    scene.frame_end = scene.frame_end if wanted.last is None else wanted.last
    return int(bpy.ops.render.render(animation=True) != {"FINISHED"})


def main() -> int:
    """The exit code."""
    wanted = asked()
    enable()
    try:
        bpy.ops.wm.open_mainfile(filepath=wanted.file)
    except RuntimeError as error:
        print(f"Error: {error}", file=sys.stderr)
        return 1
    if wanted.render:
        return render(wanted)
    name, *arguments = wanted.command
    entry = addon_host.part("blender.command.entry")
    if name != entry.NAME:
        print(f'Unrecognized command: "{name}"', file=sys.stderr)
        return 1
    return int(entry.main(arguments))


status = main()
sys.stdout.flush()
sys.stderr.flush()
os._exit(status)  # Blender hangs at exit when a class is still registered
