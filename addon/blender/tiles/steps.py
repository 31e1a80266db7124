# SPDX-License-Identifier: GPL-3.0-or-later
"""Make Tiles, as steps: the cells of the points, cut apart and written as an object."""

import bpy

from ...core.base.steps import Steps, Task
from ...core.tiles import tiled
from ..base.all_or_nothing import all_or_nothing
from ..base.object_handles import Held
from ..freshness.concurrent_edits import check_points_kept, points_now
from ..scatter.object import surface_of, tile_settings_of
from ..surface.bound import current_binding
from ..surface.reading import as_read, read
from .following import have_follow
from .mesh import check_tile_object, write_tiles


def tile_steps(context: bpy.types.Context) -> Steps:
    """The active scatter's cells on the surface of this frame; returns the object and the Tiles."""
    held, surface = Held(context.object), Held(surface_of(context.object))
    check_tile_object(context.object)
    before, arrays = points_now(context.object), read(surface.get())
    binding, columns = current_binding(context.object, surface.get(), arrays)
    settings, seed = tile_settings_of(context.object), context.object.dapple.seed
    tiles = yield Task(lambda worker: tiled(arrays, binding, columns, settings, seed, worker))
    obj = held.get()
    check_points_kept(obj, before, "cut into tiles")
    check_tile_object(obj)
    made = [*filter(None, [obj.dapple.tiles.object])]
    with as_read(arrays, surface), all_or_nothing(bpy.context, [obj, *made]):
        made_of = write_tiles(obj, tiles)
        have_follow(obj, made_of, arrays, tiles.binding)
        return made_of, tiles
