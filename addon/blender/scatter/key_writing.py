# SPDX-License-Identifier: GPL-3.0-or-later
"""Writing the keyframes of a bake into the file, and removing them."""

import bmesh
import bpy
import numpy as np

from ...core.bake.keys import Baked
from ...core.bake.population import Born
from ...core.solve.solve import Report
from ...core.solve.stale import settings_text
from ...core.surface.records import (
    ADDED_ATTRIBUTES,
    FADE_ATTRIBUTES,
    FRAME_ATTRIBUTES,
    MIRROR_ATTRIBUTES,
    POINT_ATTRIBUTES,
    ROW_ATTRIBUTES,
)
from ...core.surface.sources import Sources
from ...nodes import has_input, set_input
from ..base.all_or_nothing import once_done
from ..base.mesh_arrays import read_columns, read_points, to_local, write_columns
from .key_stores import STORES, key_types, new_store, stores_of, triangle_types
from .linked_data import own_mesh
from .modifier import ensure_modifier, scatter_modifier, write_surface_inputs, write_warning
from .object import bake_settings_of, copy_report, write_report
from .points import own_points


def write_baked(
    obj: bpy.types.Object,
    baked: Baked,
    start: int,
    report: Report,
    born: Born | None = None,
    begun: Sources | None = None,
) -> None:
    """Store baked keyframes and the points that they add.

    `start` is the first frame of the bake, `begun` are the inputs of its solution.
    """
    clear_keys(obj)
    if born is not None:
        add_points(obj, born)
    modifier = ensure_modifier(obj)
    places = baked.keys["position"]
    types = key_types(baked.keys)
    set_input(modifier, "Keys", new_store(obj, "Keys", baked.keys, types, places))
    for name, columns, types in (
        ("Triangles", baked.triangles, triangle_types(baked.triangles)),
        ("Frames", baked.frames, FRAME_ATTRIBUTES),
    ):
        set_input(modifier, name, new_store(obj, name, columns, types))
    set_input(modifier, "Key Points", len(obj.data.vertices))
    set_input(modifier, "First Frame", start)
    obj.dapple.baked_start, obj.dapple.baked_frames = start, baked.frame_count
    obj.dapple.baked_keys = len(places) // max(len(obj.data.vertices), 1)
    obj.dapple.baked_settings = settings_text(bake_settings_of(obj))
    obj.dapple.baked_from = begun.text() if begun else ""
    write_surface_inputs(obj, modifier)
    copy_report(obj.dapple.report, obj.dapple.solved)
    write_report(obj, report)
    write_warning(obj)
    obj.update_tag()


def clear_keys(obj: bpy.types.Object) -> None:
    """Remove baked keyframes and the points that they added.

    The other points stay where they were optimized, with their figures.
    """
    drop_added(obj)
    if obj.dapple.baked_keys:
        _write_solved_report(obj)
    modifier = scatter_modifier(obj)
    if modifier is None:
        return
    stores = stores_of(obj)
    for name in STORES:
        if has_input(modifier, name):
            set_input(modifier, name, None)
    obj.dapple.baked_keys = obj.dapple.baked_frames = 0
    obj.dapple.bake_fingerprint = obj.dapple.baked_settings = obj.dapple.baked_from = ""
    obj.dapple.baked_frozen = ""
    obj.update_tag()
    once_done(lambda: _remove(stores))


def _remove(stores: list[bpy.types.Object]) -> None:
    """Remove objects of a bake from the file, unless something else uses them."""
    for store in stores:
        if store.users == 0 and store.library is None:
            data = store.data
            bpy.data.objects.remove(store)
            if data is not None and data.users == 0:
                bpy.data.batch_remove([data])


def _write_solved_report(obj: bpy.types.Object) -> None:
    """Show the figures of the solution again."""
    copy_report(obj.dapple.solved, obj.dapple.report)


def add_points(obj: bpy.types.Object, born: Born) -> None:
    """Append the points that a bake adds to the optimized ones."""
    mesh, count = own_mesh(obj), len(obj.data.vertices)
    optional = {**ADDED_ATTRIBUTES, **MIRROR_ATTRIBUTES}
    added = {name: kind for name, kind in optional.items() if name in mesh.attributes}
    types = {**ROW_ATTRIBUTES, **POINT_ATTRIBUTES, **added}
    before = read_columns(mesh, types)
    mesh.vertices.add(len(born.positions))
    places = np.concatenate([read_points(mesh)[:count], to_local(obj, born.positions)])
    mesh.vertices.foreach_set("co", places.astype(np.float32).ravel())
    after = {"dapple_mirror": born.columns["id"], **born.binding.rows(), **born.columns}
    joined = {name: np.concatenate([values, after[name]]) for name, values in before.items()}
    joined["dapple_faded"] = np.repeat([0.0, 1.0], [count, len(born.positions)])
    write_columns(mesh, joined, {**types, **FADE_ATTRIBUTES})
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
