# SPDX-License-Identifier: GPL-3.0-or-later
"""Data of an object that are the same on all frames, so that a bake need not read them again."""

from collections.abc import Iterable

import bpy

from .joined import parts_of

# Modifiers that leave weights as they are wherever vertices stay.
_KEEPS_WEIGHTS = {
    "ARMATURE",
    "CAST",
    "CLOTH",
    "COLLISION",
    "CORRECTIVE_SMOOTH",
    "CURVE",
    "DISPLACE",
    "HOOK",
    "LAPLACIANDEFORM",
    "LAPLACIANSMOOTH",
    "LATTICE",
    "MESH_CACHE",
    "MESH_DEFORM",
    "MESH_SEQUENCE_CACHE",
    "MULTIRES",
    "NORMAL_EDIT",
    "SHRINKWRAP",
    "SIMPLE_DEFORM",
    "SMOOTH",
    "SOFT_BODY",
    "SUBSURF",
    "SURFACE",
    "SURFACE_DEFORM",
    "TRIANGULATE",
    "WARP",
    "WAVE",
    "WEIGHTED_NORMAL",
}


def lasting(obj: bpy.types.Object, names: Iterable[str]) -> list[str]:
    """Those of a surface's values that no frame changes: vertex groups, which are slow to read,
    below modifiers that leave them alone.
    """
    parts = parts_of(obj)
    kept = all(
        modifier.type in _KEEPS_WEIGHTS for part in parts for modifier in part.modifiers
    ) and not any(_is_animated(part.data) for part in parts)
    if not kept:
        return []
    attributes = {one.name for part in parts for one in getattr(part.data, "attributes", ())}
    return [name for name in names if name not in attributes]


def is_rigid(obj: bpy.types.Object) -> bool:
    """Whether the shape of an object is the same on all frames."""
    mesh = obj.data
    plain = obj.type == "MESH" and not obj.modifiers and not mesh.shape_keys
    return bool(plain and not _is_animated(mesh))


def _is_animated(block: bpy.types.ID) -> bool:
    return getattr(block, "animation_data", None) is not None
