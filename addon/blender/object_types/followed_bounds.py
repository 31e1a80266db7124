# SPDX-License-Identifier: GPL-3.0-or-later
"""What follows what is placed, edited or not: radii from bounds, weights of the objects of a
collection.
"""

import bpy

from ..base import jobs, renders
from ..base.handlers import Handlers
from ..base.quiet import is_quiet
from ..scatter.library import read_only
from ..scatter.modifier import write_instance_inputs
from ..scatter.object import is_scatter
from ..scatter.placed_objects import follow_bounds, follow_members


def _updated(_scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """What is placed has its scatter evaluated too."""
    if is_quiet() or jobs.current() is not None or renders.busy():
        return
    for one in depsgraph.updates:
        obj = one.id.original
        if isinstance(obj, bpy.types.Object) and is_scatter(obj) and not read_only(obj):
            _follow(obj, depsgraph)


def _follow(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> None:
    if any([follow_members(kind) for kind in (obj.dapple, *obj.dapple.classes)]):
        write_instance_inputs(obj)
    for kind in obj.dapple.classes:
        follow_bounds(kind, depsgraph)


_HANDLERS = Handlers(depsgraph_update_post=_updated)


def register() -> None:
    """Watch what is placed."""
    _HANDLERS.watch()


def unregister() -> None:
    """Watch nothing."""
    _HANDLERS.unwatch()
