# SPDX-License-Identifier: GPL-3.0-or-later
"""Reattach as steps: read the surface, find the nearest places in a worker, check, write."""

import bpy

from ...core.base.steps import Steps, Task
from ...core.solve.class_counts import clearances
from ...core.solve.solve import nearest_binding
from ..base.object_handles import ObjectHandle
from ..freshness.concurrent_edits import check_points_kept, points_now
from ..scatter.object import settings_of
from ..scatter.points import columns_with_own_ids, places_of
from ..surface.current_binding import rest_of
from ..surface.joined_surface import surface_for
from ..surface.reading import as_read, read
from ..surface.rest_position import kind_of_binding, rest_position
from .session_solutions import write_reattached


def reattach_steps(context: bpy.types.Context) -> Steps:
    """Bind the active scatter to the places of its surface that are nearest to its points."""
    handle = ObjectHandle(context.object)
    with surface_for(context.object) as surface:
        kind = kind_of_binding(surface.get(), context, context.object.dapple.attach_to)
        before, arrays = points_now(context.object), read(surface.get())
        points, columns = places_of(context.object), columns_with_own_ids(context.object)
        settings = settings_of(context.object)
        binding = yield Task(lambda _: nearest_binding(points, arrays))
        columns["dapple_clearance"] = clearances(points, columns["dapple_object_type"], settings)
        obj = handle.get()
        check_points_kept(obj, before, "attached")
        with as_read(arrays, surface), rest_position(surface, kind):
            rest = rest_of(surface.get(), arrays, binding, kind)
            write_reattached(obj, arrays, binding, columns, rest)
    return obj
