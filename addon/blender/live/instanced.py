# SPDX-License-Identifier: GPL-3.0-or-later
"""What follows what is placed, edited or not: radii from bounds, weights of the objects of a
collection.
"""

import bpy

from ..base import renders, under_way
from ..base.handlers import Handlers
from ..base.quiet import is_quiet
from ..data.library import read_only
from ..data.modifier import write_instance_inputs
from ..data.scatter import is_scatter
from ..data.weights import follow_members
from ..surface.footprint import follow_bounds


def _updated(_scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """What is placed has its scatter evaluated too."""
    if is_quiet() or under_way.current() is not None or renders.busy():
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
