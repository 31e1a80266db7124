# SPDX-License-Identifier: GPL-3.0-or-later
"""Auto Update as steps: read part by part, compare, have the worker solve, write.

Nothing waits for these steps: whoever runs them gives them up where something changes meanwhile.
"""

from dataclasses import replace

import bpy

from ...core.solve import scatter
from ...core.sources import sources_of
from ...core.steps import Steps, Task
from ...core.surface import SurfaceArrays
from ..base.held import Held
from ..base.times import time_of
from ..data.points import locked_points
from ..data.scatter import is_fluid, settings_of, surface_of
from ..data.store import write_scattered
from ..status.staleness import is_edited, needs_solving
from ..surface.bound import rest_of
from ..surface.parts import read_parts
from ..surface.resting import kind_of_binding, rest_position


def update_steps(held: Held) -> Steps:
    """Solve a scatter if it does not fit what is there now; whether it was solved.

    Points that were edited by hand are left alone.
    """
    surface, settings = Held(surface_of(held.get())), settings_of(held.get())
    read = yield from read_parts(settings, surface, held)
    time = time_of(bpy.context.scene)
    arrays = yield Task(lambda _: replace(read.arrays(), time=time))
    now = yield Task(lambda _: sources_of(arrays, settings))
    obj = held.get()
    if is_edited(obj) or not needs_solving(obj, now):
        return False
    kind, locked = _kind(obj, surface.get(), arrays), locked_points(obj)
    solved = yield Task(lambda worker: scatter(arrays, settings, worker, locked))
    with rest_position(surface, kind):
        rest = rest_of(surface.get(), arrays, solved.binding, kind)
        write_scattered(held.get(), arrays, solved, rest)
    return True


def _kind(obj: bpy.types.Object, surface: bpy.types.Object, arrays: SurfaceArrays) -> str:
    """FACES or REST; the faces of the render are looked at only where there are others."""
    known = obj.dapple.surface_topology.split()
    if obj.dapple.bind_to == "AUTO" and not is_fluid(surface) and known == [arrays.topology]:
        return str(obj.dapple.bound_to)
    return kind_of_binding(surface, bpy.context, obj.dapple.bind_to)
