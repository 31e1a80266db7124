# SPDX-License-Identifier: GPL-3.0-or-later
"""Make Tiles: the operator."""

from typing import Any

import bpy
import numpy as np

from ...core.base.steps import Steps
from ..base.jobs import Outcome
from ..base.step_operators import OPTIONS, StepsOperator
from ..base.translation import reported
from ..surface.polls import ready
from .steps import tile_steps


class DAPPLE_OT_tile(StepsOperator, bpy.types.Operator):
    """Turn the area of each point into a tile, on the surface in the current frame. The points are
    those that were optimized, not those of the bake. Existing tiles are replaced and keep their
    modifiers"""

    bl_idname = "dapple.tile"
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
        count = len(np.unique(tiles.cells))
        text = reported("'{name}': {count:,} tiles", name=made.name, count=count)
        if tiles.lost:
            text = reported(
                "{tiles}, {lost:,} were narrower than the grout", tiles=text, lost=tiles.lost
            )
        return Outcome(obj, [("WARNING" if tiles.lost else "INFO", text)])


CLASSES = (DAPPLE_OT_tile,)
