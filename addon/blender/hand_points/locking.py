# SPDX-License-Identifier: GPL-3.0-or-later
"""Locking points of a scatter, also in Edit Mode."""

from collections.abc import Iterator
from contextlib import contextmanager

import bpy
import numpy as np
from numpy.typing import NDArray

from ...core.base.errors import ScatterError
from ..base.mesh_arrays import own_attribute
from ..scatter.linked_data import own_mesh

_NAME = "dapple_locked"


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
    attribute = own_attribute(mesh, _NAME, "BOOLEAN")
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
