# SPDX-License-Identifier: GPL-3.0-or-later
"""Replaces Blender's executable if only the module bpy is installed, which has no command line."""

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
    """Blender's command line, as far as the tests use it."""
    parser = argparse.ArgumentParser(allow_abbrev=False)
    parser.add_argument("-b", dest="file")
    parser.add_argument("-o", "--render-output", dest="picture")
    parser.add_argument("-f", "--render-frame", dest="frames")
    parser.add_argument("--command", nargs=argparse.REMAINDER)
    return parser.parse_args()


def enable() -> None:
    """The add-on, in a repository of this process, where the wrapper keeps Blender's files."""
    home = os.environ["BLENDER_USER_RESOURCES"]
    addon_host.add_repository(Path(tempfile.mkdtemp(dir=home)) / "repository")
    addon_host.enable()


def render(picture: str, frames: str) -> int:
    """Pictures of frames, such as 3,5..8."""
    scene = bpy.context.scene
    scene.render.filepath = picture
    for part in frames.split(","):
        first, last = (part.split("..") * 2)[:2]
        scene.frame_start, scene.frame_end = int(first), int(last)
        bpy.ops.render.render(animation=True)
    return 0


def main() -> int:
    """The exit code."""
    wanted = asked()
    enable()
    try:
        bpy.ops.wm.open_mainfile(filepath=wanted.file)
    except RuntimeError as error:
        print(f"Error: {error}", file=sys.stderr)
        return 1
    if wanted.frames:
        return render(wanted.picture, wanted.frames)
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
