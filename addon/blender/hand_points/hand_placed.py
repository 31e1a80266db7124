# SPDX-License-Identifier: GPL-3.0-or-later
"""Points that were added, moved, removed or locked by hand.

Added and moved points are attached to the nearest place of the surface and locked. All others keep
their ids and the known solution, so that Auto Update hardly moves them when it evens them out
around the edited ones. An exact count is adjusted.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import bpy
import numpy as np
from numpy.typing import NDArray

from ...core.base.errors import ScatterError
from ...core.solve.solve import Attached, attached
from ...core.solve.stale import changed_settings, settings_text
from ...core.surface.arrays import Floats, SurfaceArrays
from ...core.surface.records import (
    PLACED_ATTRIBUTES,
    ROW_ATTRIBUTES,
    Binding,
    Columns,
    binding_from,
    repeated,
    unbound,
)
from ...core.surface.rest import AtRest
from ..base.mesh_arrays import (
    own_attribute,
    read_columns,
    read_points,
    to_local,
    to_world,
    write_columns,
)
from ..base.object_handles import ObjectHandle
from ..scatter.linked_data import own_mesh
from ..scatter.object import settings_of, surface_of
from ..scatter.points import (
    add_edited,
    columns_with_own_ids,
    own_columns,
    point_columns_of,
    read_at_rest,
    write_digest,
)
from ..scatter.store import write_binding, write_own_ids
from ..solve.session_solutions import known_as_placed
from ..surface.current_binding import binding_now, other_faces, rest_of
from ..surface.reading import read
from ..surface.rest_position import rest_position

Chosen = NDArray[np.bool_]  # per point
(_PLACED,) = PLACED_ATTRIBUTES
_LOCKED = "dapple_locked"


def take_in(
    obj: bpy.types.Object, moved: Chosen, kind: int = 0, lost: Floats | None = None
) -> Chosen:
    """Attach points that were added, copied or moved, and lock them; returns which ones.

    `lost` are the places (k, 3) of removed points.

    Raises:
        ScatterError: points cannot be attached; the stored points are unchanged.
    """
    surface = surface_of(obj)
    arrays, placed = read(surface), new_points(obj) | moved
    before, columns = binding_now(obj, surface, arrays), columns_with_own_ids(obj)
    columns["dapple_object_type"][blank_points(obj)] = kind
    places = to_world(obj, read_points(obj.data))
    found = attached(before, places, placed, arrays, obj.dapple.forward)
    if lost is not None:
        found = replace(found, edited=np.concatenate([found.edited, lost]))
    with rest_position(ObjectHandle(surface), obj.dapple.attached_to):
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
    """Places on the rest shape, if points are bound to it; unmoved points keep theirs."""
    found = rest_of(surface, arrays, binding, obj.dapple.attached_to)
    if found is None or other_faces(obj, arrays):
        return found
    before = read_at_rest(obj)
    if before.parts != found.parts:
        return found
    columns = {name: values.copy() for name, values in before.columns.items()}
    for name, values in columns.items():
        values[placed] = found.columns[name][placed]
    return AtRest(columns, found.parts)


def kind_of_new(obj: bpy.types.Object) -> int:
    """The number of the active object type, which new points get; 0 without object types."""
    return int(obj.dapple.object_type_index) if obj.dapple.object_types else 0


def follow_count(obj: bpy.types.Object) -> None:
    """Set the count of the settings to the number of points, unless the settings were changed since
    the points were solved.
    """
    if not obj.dapple.solved_settings:
        return
    changed = changed_settings(obj.dapple.solved_settings, settings_of(obj))
    classes = point_columns_of(obj)["dapple_object_type"]
    if "object_types" not in changed:
        counts = np.bincount(classes, minlength=len(obj.dapple.object_types))
        for kind, count in zip(obj.dapple.object_types, counts.tolist(), strict=False):
            if kind.use_count and kind.count != count and count:
                kind.count = count
    if obj.dapple.amount == "COUNT" and "count" not in changed and len(classes):
        obj.dapple.count = len(classes)
    if not changed:
        obj.dapple.solved_settings = settings_text(settings_of(obj))


def is_being_edited(obj: bpy.types.Object) -> bool:
    """Whether the points are being edited, so that their previous places are stored."""
    return _PLACED in obj.data.attributes


def note_places(obj: bpy.types.Object) -> None:
    """Store the current places of the points."""
    write_columns(own_mesh(obj), {_PLACED: read_points(obj.data)}, PLACED_ATTRIBUTES)


def forget_places(obj: bpy.types.Object) -> None:
    """Delete the stored places."""
    mesh = own_mesh(obj)
    mesh.attributes.remove(mesh.attributes[_PLACED])


def moved_points(obj: bpy.types.Object) -> Chosen:
    """Points that are not at their stored places."""
    before = read_columns(obj.data, PLACED_ATTRIBUTES)[_PLACED].astype(np.float64)
    found: Chosen = (before != read_points(obj.data)).any(axis=1)
    return found


def blank_points(obj: bpy.types.Object) -> Chosen:
    """Points that were added by hand and are not attached yet."""
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
    inverse = np.linalg.pinv(arrays.matrix)  # it exists for a flattened surface too
    add_edited(obj, found.edited @ inverse[:3, :3].T + inverse[:3, 3])
    write_digest(obj)


def lock_points(obj: bpy.types.Object, lock: bool, every: bool) -> int:
    """Lock or unlock the selected points, or all; returns their number.

    Raises:
        ScatterError: no point is selected.
    """
    with _out_of_edit_mode(obj):
        mesh = own_mesh(obj)
        chosen = np.ones(len(mesh.vertices), dtype=bool)
        if not every:
            mesh.vertices.foreach_get("select", chosen)
        if not chosen.any():
            raise ScatterError(
                f"Scatter '{obj.name}': no point is selected. Select some in Edit Mode"
            )
        write_locked(obj, chosen, lock)
    return int(chosen.sum())


def write_locked(obj: bpy.types.Object, chosen: NDArray[np.bool_], lock: bool = True) -> None:
    """Lock or unlock the chosen points; the others stay as they are."""
    mesh = own_mesh(obj)
    attribute = own_attribute(mesh, _LOCKED, "BOOLEAN")
    locked = np.zeros(len(mesh.vertices), dtype=bool)
    attribute.data.foreach_get("value", locked)
    locked[chosen] = lock
    attribute.data.foreach_set("value", locked)
    mesh.update()
    obj.dapple.locked_count = int(locked.sum())


@contextmanager
def _out_of_edit_mode(obj: bpy.types.Object) -> Iterator[None]:
    """Leave Edit Mode for a moment, as attributes cannot be written there."""
    editing = obj.mode == "EDIT"
    if editing:
        bpy.ops.object.mode_set(mode="OBJECT")
    try:
        yield
    finally:
        if editing:
            bpy.ops.object.mode_set(mode="EDIT")
