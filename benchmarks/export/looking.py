# SPDX-License-Identifier: GPL-3.0-or-later
"""What another Blender makes of a file, and what the file itself holds."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

_IMPORT = """
import json, os, sys
import bpy, addon_utils
path, frames = sys.argv[1], json.loads(sys.argv[2])
bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
if path.endswith(".glb"):
    addon_utils.enable("io_scene_gltf2")
    bpy.ops.import_scene.gltf(filepath=path)
elif path.endswith(".abc"):
    bpy.ops.wm.alembic_import(filepath=path, as_background_job=False)
else:
    bpy.ops.wm.usd_import(filepath=path)
found = []
for frame in frames:
    bpy.context.scene.frame_set(frame)
    found.append(
        [
            (
                [list(row) for row in one.matrix_world],
                "instance" if one.is_instance else one.object.type,
                getattr(one.object.data, "name", ""),
            )
            for one in bpy.context.evaluated_depsgraph_get().object_instances
            if one.object.type in ("MESH", "EMPTY")
        ]
    )
print("FOUND", json.dumps(found), flush=True)
os._exit(0)
"""


@dataclass(frozen=True)
class Things:
    """What there is on a frame.

    matrices: (n, 4, 4).
    kinds, meshes: "instance" or the type of an object, and the name of its mesh.
    """

    matrices: np.ndarray
    kinds: list[str]
    meshes: list[str]


@dataclass(frozen=True)
class Look:
    """Things on each frame, and whether the file has ids of points and their object types."""

    frames: list[Things]
    ids: bool
    types: bool


def look(path: Path, frames: Sequence[int]) -> Look:
    """Import a file into another Blender and show these frames."""
    with tempfile.TemporaryDirectory() as home:
        done = subprocess.run(
            [sys.executable, "-c", _IMPORT, str(path), json.dumps(list(frames))],
            env={**os.environ, "BLENDER_USER_RESOURCES": home},
            capture_output=True,
            text=True,
            timeout=600,
            check=False,
        )
    said = [line for line in done.stdout.splitlines() if line.startswith("FOUND")]
    if not said:
        raise RuntimeError(f"{path} could not be imported: {done.stdout}{done.stderr}")
    found = json.loads(said[0].removeprefix("FOUND"))
    return Look([_things(rows) for rows in found], *_held(path))


def _things(rows: list[tuple[list[list[float]], str, str]]) -> Things:
    ordered = sorted(rows, key=lambda row: row[1] == "EMPTY")  # others first, where both are
    matrices, kinds, meshes = (list(column) for column in zip(*ordered, strict=True))
    return Things(np.array(matrices, np.float64), kinds, meshes)


def _held(path: Path) -> tuple[bool, bool]:
    """Whether the file has ids of points, and their object types."""
    if path.suffix == ".usdc":
        return _held_usd(path)
    content = path.read_bytes()
    if path.suffix == ".glb":
        return b'"_ID":' in content, b'"prototype":' in content
    return False, b"dapple_class" in content


def _held_usd(path: Path) -> tuple[bool, bool]:
    from pxr import Usd, UsdGeom

    stage = Usd.Stage.Open(str(path))
    names = [
        attribute.GetName()
        for prim in stage.Traverse()
        if prim.IsA(UsdGeom.PointInstancer)
        for attribute in prim.GetAuthoredAttributes()
    ]
    return "ids" in names, bool({"primvars:dapple_class", "primvars:classes"} & set(names))
