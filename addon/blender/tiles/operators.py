# SPDX-License-Identifier: GPL-3.0-or-later
"""Make Tiles: the operator and its steps."""

from typing import Any

import bpy
import numpy as np

from ...core.base.steps import Steps, Task
from ...core.tiles import tiled
from ..base.all_or_nothing import all_or_nothing
from ..base.object_handles import ObjectHandle
from ..base.operator_jobs import Outcome
from ..base.step_operators import OPTIONS, StepsOperator
from ..base.translation import translated_report
from ..freshness.concurrent_edits import check_points_kept, points_now
from ..scatter.local_views import into_local_views
from ..scatter.object import surface_of, tile_settings_of
from ..surface.current_binding import current_binding
from ..surface.polls import ready
from ..surface.reading import as_read, read
from .mesh import attach_tiles, check_tile_object, write_tiles


class DAPPLE_OT_make_tiles(StepsOperator, bpy.types.Operator):
    """Turn the area of each point into a tile, on the surface in the current frame. The points are
    those that were optimized, not those of the bake. Existing tiles are replaced and keep their
    modifiers"""

    bl_idname = "dapple.make_tiles"
    bl_label = "Make Tiles"
    bl_options = OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return ready(cls, context, scatter=True)

    def steps(self, context: bpy.types.Context) -> Steps:
        return tile_steps(context)

    def written(self, context: bpy.types.Context) -> list[bpy.types.Object]:
        return [*filter(None, [context.object.dapple.tiles.object])]

    @staticmethod
    def done(context: bpy.types.Context, result: Any, obj: bpy.types.Object) -> Outcome:
        made, tiles = result
        into_local_views(obj, made)
        count = len(np.unique(tiles.cells))
        text = translated_report("'{name}': {count:,} tiles", name=made.name, count=count)
        if tiles.lost:
            text = translated_report(
                "{tiles}, {lost:,} were narrower than the grout", tiles=text, lost=tiles.lost
            )
        return Outcome(obj, [("WARNING" if tiles.lost else "INFO", text)])


def tile_steps(context: bpy.types.Context) -> Steps:
    """Make the active scatter's tiles on the current surface; returns the object and the Tiles."""
    handle, surface = ObjectHandle(context.object), ObjectHandle(surface_of(context.object))
    check_tile_object(context.object)
    before, arrays = points_now(context.object), read(surface.get())
    binding, columns = current_binding(context.object, surface.get(), arrays)
    settings, seed = tile_settings_of(context.object), context.object.dapple.seed
    tiles = yield Task(lambda worker: tiled(arrays, binding, columns, settings, seed, worker))
    obj = handle.get()
    check_points_kept(obj, before, "cut into tiles")
    check_tile_object(obj)
    made = [*filter(None, [obj.dapple.tiles.object])]
    with as_read(arrays, surface), all_or_nothing(bpy.context, [obj, *made]):
        written = write_tiles(obj, tiles)
        attach_tiles(obj, written, arrays, tiles.binding)
        return written, tiles


CLASSES = (DAPPLE_OT_make_tiles,)
