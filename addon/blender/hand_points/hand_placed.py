# SPDX-License-Identifier: GPL-3.0-or-later
"""Taking in points that were placed by hand: added, moved and removed ones.

Those that are added or moved are attached to the nearest place of the surface and locked. All
others keep their ids, and what is known of the solution stays known, so that Auto Update moves
hardly any of them when it makes them even around the placed ones. An exact count follows.
"""

from dataclasses import replace

import bpy
import numpy as np

from ...core.solve.hand_placed import attached
from ...core.surface.arrays import Floats, SurfaceArrays
from ...core.surface.records import Binding
from ...core.surface.rest import AtRest
from ..base.mesh_arrays import read_points, to_world
from ..base.object_handles import Held
from ..scatter.object import surface_of
from ..scatter.points import columns_with_own_ids, read_at_rest
from ..solve.session_solutions import known_as_placed
from ..surface.bound import binding_now, other_faces, rest_of
from ..surface.reading import read
from ..surface.rest_position import rest_position
from .counts import follow_count
from .placed import Chosen, blank_points, new_points, write_placed


def take_in(
    obj: bpy.types.Object, moved: Chosen, kind: int = 0, lost: Floats | None = None
) -> Chosen:
    """Attach points that were added, copied or moved, and lock them; lost are the places (k, 3) of
    removed ones. Which points that are.

    Raises:
        ScatterError: the points cannot be attached; what is stored of them is as before.
    """
    surface = surface_of(obj)
    arrays, placed = read(surface), new_points(obj) | moved
    before, columns = binding_now(obj, surface, arrays), columns_with_own_ids(obj)
    columns["dapple_class"][blank_points(obj)] = kind
    places = to_world(obj, read_points(obj.data))
    found = attached(before, places, placed, arrays, obj.dapple.forward)
    if lost is not None:
        found = replace(found, touched=np.concatenate([found.touched, lost]))
    with rest_position(Held(surface), obj.dapple.bound_to):
        rest = _rest(obj, surface, arrays, found.binding, placed)
        solved = obj.dapple.solved_points
        write_placed(obj, arrays, found, placed, columns, rest)
    follow_count(obj)
    known_as_placed(obj, solved, found.binding)
    return placed


def _rest(
    obj: bpy.types.Object,
    surface: bpy.types.Object,
    arrays: SurfaceArrays,
    binding: Binding,
    placed: Chosen,
) -> AtRest | None:
    """Places on the rest shape, if points are bound to it; those that stay have the same ones."""
    found = rest_of(surface, arrays, binding, obj.dapple.bound_to)
    if found is None or other_faces(obj, arrays):
        return found
    before = read_at_rest(obj)
    if before.parts != found.parts:
        return found
    columns = {name: values.copy() for name, values in before.columns.items()}
    for name, values in columns.items():
        values[placed] = found.columns[name][placed]
    return AtRest(columns, found.parts)
