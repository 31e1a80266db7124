# SPDX-License-Identifier: GPL-3.0-or-later
"""Ways to write a scatter to a file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import addon_utils
import bpy

from addon.blender.export.points import export_points
from benchmarks.export.scene import FRAMES


@dataclass(frozen=True)
class Way:
    """An exporter with its options."""

    name: str
    suffix: str
    export: Callable[[Path, bpy.types.Object], Any]


def _usd(**options: Any) -> Callable[[Path, bpy.types.Object], Any]:
    def export(path: Path, _scatter: bpy.types.Object) -> None:
        bpy.ops.wm.usd_export(filepath=str(path), export_animation=True, **options)

    return export


def _alembic(**options: Any) -> Callable[[Path, bpy.types.Object], Any]:
    def export(path: Path, _scatter: bpy.types.Object) -> None:
        bpy.ops.wm.alembic_export(filepath=str(path), as_background_job=False, **options)

    return export


def _gltf(**options: Any) -> Callable[[Path, bpy.types.Object], Any]:
    def export(path: Path, _scatter: bpy.types.Object) -> None:
        addon_utils.enable("io_scene_gltf2")
        bpy.ops.export_scene.gltf(filepath=str(path), export_format="GLB", **options)

    return export


def _dapple(path: Path, scatter: bpy.types.Object) -> None:
    export_points(path, [scatter], () if path.suffix == ".glb" else FRAMES)


_GN = {"export_gn_mesh": True}
WAYS = (
    Way("USD", ".usdc", _usd()),
    Way("USD, *Tessellate*", ".usdc", _usd(export_subdivision="TESSELLATE")),
    Way(
        "USD, *Instancing*, *Tessellate*",
        ".usdc",
        _usd(use_instancing=True, export_subdivision="TESSELLATE"),
    ),
    Way("Alembic", ".abc", _alembic()),
    Way("Alembic, *Apply Subdivision*", ".abc", _alembic(apply_subdiv=True)),
    Way(
        "Alembic, this without *Instancing*",
        ".abc",
        _alembic(apply_subdiv=True, use_instancing=False),
    ),
    Way("glTF", ".glb", _gltf()),
    Way("glTF, *Geometry Nodes Instances*", ".glb", _gltf(**_GN)),
    Way("glTF, these and *GPU Instances*", ".glb", _gltf(**_GN, export_gpu_instances=True)),
    Way("Dapple, .usdc", ".usdc", _dapple),
    Way("Dapple, .glb", ".glb", _dapple),
)
