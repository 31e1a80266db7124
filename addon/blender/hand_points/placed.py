# SPDX-License-Identifier: GPL-3.0-or-later
"""Points that are placed by hand: which they are, and how they are stored.

While points are edited, an attribute has the places that they had.
"""

import bpy
import numpy as np
from numpy.typing import NDArray

from ...core.solve.hand_placed import Attached
from ...core.surface.arrays import SurfaceArrays
from ...core.surface.records import (
    PLACED_ATTRIBUTES,
    ROW_ATTRIBUTES,
    Columns,
    binding_from,
    repeated,
    unbound,
)
from ...core.surface.rest import AtRest
from ..base.mesh_arrays import read_columns, read_points, to_local, write_columns
from ..scatter.hand_marks import add_touched
from ..scatter.library import own_mesh
from ..scatter.points import own_columns, write_digest
from ..scatter.store import write_binding, write_own_ids
from .locking import write_locked

(_PLACED,) = PLACED_ATTRIBUTES
Chosen = NDArray[np.bool_]  # per point


def is_being_edited(obj: bpy.types.Object) -> bool:
    """Whether the points are edited, and the places are known that they had."""
    return _PLACED in obj.data.attributes


def note_places(obj: bpy.types.Object) -> None:
    """Remember where the points are."""
    write_columns(own_mesh(obj), {_PLACED: read_points(obj.data)}, PLACED_ATTRIBUTES)


def forget_places(obj: bpy.types.Object) -> None:
    """Remember no more where they were."""
    mesh = own_mesh(obj)
    mesh.attributes.remove(mesh.attributes[_PLACED])


def moved_points(obj: bpy.types.Object) -> Chosen:
    """Points that are not where they were."""
    before = read_columns(obj.data, PLACED_ATTRIBUTES)[_PLACED].astype(np.float64)
    found: Chosen = (before != read_points(obj.data)).any(axis=1)
    return found


def blank_points(obj: bpy.types.Object) -> Chosen:
    """Points that were added by hand and are attached to nothing yet."""
    return unbound(binding_from(own_columns(obj, ROW_ATTRIBUTES)))


def new_points(obj: bpy.types.Object) -> Chosen:
    """Points that were added or copied by hand."""
    return blank_points(obj) | repeated(own_columns(obj, {"id": "INT"})["id"])


def write_placed(
    obj: bpy.types.Object,
    arrays: SurfaceArrays,
    found: Attached,
    placed: Chosen,
    columns: Columns,
    rest: AtRest | None,
) -> None:
    """Store placed points where they were attached, and lock them."""
    mesh, places = own_mesh(obj), read_points(obj.data)
    places[placed] = to_local(obj, found.positions[placed])
    mesh.vertices.foreach_set("co", places.astype(np.float32).ravel())
    write_binding(obj, arrays, found.binding, rest)
    write_own_ids(obj, columns)
    write_locked(obj, placed)
    inverse = np.linalg.pinv(arrays.matrix)  # which a flattened surface has too
    add_touched(obj, found.touched @ inverse[:3, :3].T + inverse[:3, 3])
    write_digest(obj)
