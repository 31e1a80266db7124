# SPDX-License-Identifier: GPL-3.0-or-later
"""Auto Update as steps: read part by part, compare, have the worker solve, write.

Nothing waits for these steps: whoever runs them gives them up where something changes meanwhile.
"""

from dataclasses import replace
from typing import Any

import bpy

from ...core.base.steps import Steps, Task
from ...core.settings.values import Settings
from ...core.surface.arrays import SurfaceArrays
from ...core.surface.sources import sources_of
from ..base.object_handles import Held
from ..base.quiet import quiet
from ..base.times import time_of
from ..freshness.staleness import is_edited, needs_solving
from ..scatter.object import is_fluid, settings_of
from ..scatter.points import locked_points
from ..surface.joining import surface_for
from ..surface.parts import read_parts
from ..surface.rest_position import kind_of_binding
from .incremental import Update, anew_steps, keep_steps, keeps


def update_steps(held: Held) -> Steps:
    """Solve a scatter if it does not fit what is there now; whether it was solved.

    Points that were edited by hand are left alone.
    """
    settings = settings_of(held.get())
    with surface_for(held.get()) as surface:
        arrays = yield from read_steps(held, surface, settings)
        now = yield Task(lambda _: sources_of(arrays, settings))
        if is_edited(held.get()) or not needs_solving(held.get(), now):
            return False
        update = update_of(held, surface, settings, arrays)
        yield from (keep_steps if keeps(update) else anew_steps)(update)
    return True


def read_steps(held: Held, surface: Held, settings: Settings) -> Any:
    """The surface of a scatter and what is beside it, with the time of that."""
    read = yield from read_parts(settings, surface, held)
    time = time_of(bpy.context.scene)
    return (yield Task(lambda _: replace(read.arrays(), time=time)))


def update_of(held: Held, surface: Held, settings: Settings, arrays: SurfaceArrays) -> Update:
    """A scatter that is solved from what was read."""
    kind = _kind(held.get(), surface.get(), arrays)
    return Update(held, surface, arrays, settings, kind, locked_points(held.get()))


def _kind(obj: bpy.types.Object, surface: bpy.types.Object, arrays: SurfaceArrays) -> str:
    """FACES or REST; the faces of the render are looked at only where there are others."""
    known = obj.dapple.surface_topology.split()
    if obj.dapple.bind_to == "AUTO" and not is_fluid(surface) and known == [arrays.topology]:
        return str(obj.dapple.bound_to)
    with quiet():  # it evaluates a copy in a scene of its own
        return kind_of_binding(surface, bpy.context, obj.dapple.bind_to)
