# SPDX-License-Identifier: GPL-3.0-or-later
"""Writing the keys of a bake into the file, and taking them out again."""

import bpy

from ...core.bake.keys import Baked
from ...core.bake.population import Born
from ...core.solve.solve import Report
from ...core.solve.stale import settings_text
from ...core.surface.records import FRAME_ATTRIBUTES
from ...core.surface.sources import Sources
from ...nodes import has_input, set_input
from ..base.all_or_nothing import once_done
from .added_points import add_points, drop_added
from .key_stores import STORES, key_types, new_store, stores_of, triangle_types
from .modifier import ensure_modifier, scatter_modifier, write_surface_inputs, write_warning
from .object import bake_settings_of, copy_report, write_report


def write_baked(
    obj: bpy.types.Object,
    baked: Baked,
    start: int,
    report: Report,
    born: Born | None = None,
    begun: Sources | None = None,
) -> None:
    """Store baked keys, the first frame of the bake being start, and the points they add.

    Begun is what the first frame was solved from.
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
    """Forget baked keys and the points they added.

    The others stick to the surface where they were optimized, with the figures that they had.
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
    """Take what held keys out of the file, unless something else has it."""
    for store in stores:
        if store.users == 0 and store.library is None:
            data = store.data
            bpy.data.objects.remove(store)
            if data is not None and data.users == 0:
                bpy.data.batch_remove([data])


def _write_solved_report(obj: bpy.types.Object) -> None:
    """Show the figures of the solution again."""
    copy_report(obj.dapple.solved, obj.dapple.report)
