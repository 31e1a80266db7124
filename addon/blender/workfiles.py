# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the frames of an unfinished bake are kept, and when they go."""

import hashlib
import re
from pathlib import Path

import bpy

from ..core.sidecar import Sidecar
from .scatter import is_scatter
from .translation import told


def work_files(obj: bpy.types.Object) -> Sidecar:
    """The sidecar of a scatter: beside the .blend, or in Blender's temporary folder."""
    name = re.sub(r"[^\w.-]", "_", obj.name)
    own = hashlib.blake2b(obj.name.encode(), digest_size=4).hexdigest()
    return Sidecar(_folder() / f"{name}-{own}")


def _folder() -> Path:
    if bpy.data.filepath:
        return Path(bpy.data.filepath).with_suffix(".dapple")
    return Path(bpy.app.tempdir) / "dapple"


def unsaved_note() -> str:
    """What to say about a file that was never saved; empty when it was."""
    if bpy.data.filepath:
        return ""
    return told(
        "Save the file: until then, frames of a stopped bake are kept only until Blender closes"
    )


def unfinished(obj: bpy.types.Object) -> int:
    """Solved frames of a bake that was stopped, perhaps of other settings."""
    return 0 if obj.dapple.bake_fingerprint else work_files(obj).frames()


def _saved(_path: str) -> None:
    """The file now holds the bake: its work files are of no use any more."""
    for obj in bpy.data.objects:
        if is_scatter(obj) and obj.dapple.bake_fingerprint:
            settings, files = obj.dapple, work_files(obj)
            last = settings.baked_start + settings.baked_frames - 1
            if files.fingerprint(last) == settings.bake_fingerprint:
                files.clear()


def register() -> None:
    """Watch files being saved."""
    bpy.app.handlers.persistent(_saved)
    bpy.app.handlers.save_post.append(_saved)


def unregister() -> None:
    """Stop watching."""
    bpy.app.handlers.save_post.remove(_saved)
