# SPDX-License-Identifier: GPL-3.0-or-later
"""Make Tiles, as steps: the cells of the points, cut apart and written as an object."""

import bpy

from ...core.steps import Steps, Task
from ...core.surface import check_unchanged
from ...core.tiles import tiled
from ..base.held import Held
from ..data.scatter import surface_of, tile_settings_of
from ..surface.bound import current_binding
from ..surface.reading import read
from .tiles import check_tile_object, write_tiles


def tile_steps(context: bpy.types.Context) -> Steps:
    """The active scatter's cells on the surface of this frame; returns the object and the Tiles."""
    held, surface = Held(context.object), Held(surface_of(context.object))
    check_tile_object(context.object)
    arrays = read(surface.get())
    binding, columns = current_binding(context.object, surface.get(), arrays)
    settings, seed = tile_settings_of(context.object), context.object.dapple.seed
    tiles = yield Task(lambda worker: tiled(arrays, binding, columns, settings, seed, worker))
    obj = held.get()
    check_unchanged(arrays, read(surface.get()))
    return write_tiles(obj, tiles), tiles
