# SPDX-License-Identifier: GPL-3.0-or-later
"""Points that a bake with births adds to a scatter: stored with it, and removed again."""

import bmesh
import bpy
import numpy as np

from ...core.bake.population import Born
from ...core.surface.records import (
    ADDED_ATTRIBUTES,
    GONE_ATTRIBUTES,
    POINT_ATTRIBUTES,
    ROW_ATTRIBUTES,
)
from ..base.mesh_arrays import read_columns, read_points, to_local, write_columns
from .library import own_mesh
from .points import own_points


def add_points(obj: bpy.types.Object, born: Born) -> None:
    """Add the points that are born in a bake behind those that were optimized."""
    mesh, count = own_mesh(obj), len(obj.data.vertices)
    added = {name: kind for name, kind in ADDED_ATTRIBUTES.items() if name in mesh.attributes}
    types = {**ROW_ATTRIBUTES, **POINT_ATTRIBUTES, **added}
    before = read_columns(mesh, types)
    mesh.vertices.add(len(born.positions))
    places = np.concatenate([read_points(mesh)[:count], to_local(obj, born.positions)])
    mesh.vertices.foreach_set("co", places.astype(np.float32).ravel())
    after = {**born.binding.rows(), **born.columns}
    joined = {name: np.concatenate([values, after[name]]) for name, values in before.items()}
    joined["dapple_gone"] = np.repeat([0.0, 1.0], [count, len(born.positions)])
    write_columns(mesh, joined, {**types, **GONE_ATTRIBUTES})
    mesh.update()


def drop_added(obj: bpy.types.Object) -> None:
    """Remove the points that a bake has added."""
    own = own_points(obj)
    if own.all():
        return
    edited = bmesh.new()
    edited.from_mesh(obj.data)
    edited.verts.ensure_lookup_table()
    added = [edited.verts[k] for k in np.flatnonzero(~own)]
    bmesh.ops.delete(edited, geom=added, context="VERTS")
    edited.to_mesh(own_mesh(obj))
    edited.free()
    obj.dapple.locked_count = _count_locked(obj)


def _count_locked(obj: bpy.types.Object) -> int:
    if "dapple_locked" not in obj.data.attributes:
        return 0
    return int(read_columns(obj.data, {"dapple_locked": "BOOLEAN"})["dapple_locked"].sum())
