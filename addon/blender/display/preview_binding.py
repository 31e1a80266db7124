# SPDX-License-Identifier: GPL-3.0-or-later
"""The binding that a preview shows: an object that the node group plays in the viewport only.

It is runtime data: no file has it, however it is saved.
"""

from collections.abc import Container

import bpy
import numpy as np

from ...core.surface.records import ROW_ATTRIBUTES, Binding
from ...nodes import get_input, has_input, set_input
from ..base.mesh_arrays import write_columns, write_points
from ..scatter.modifier import ensure_modifier, scatter_modifier
from ..scatter.object import is_scatter

_INPUT = "Preview"


def show_binding(obj: bpy.types.Object, binding: Binding) -> None:
    """Have the viewport show a scatter's points where this binding puts them."""
    modifier = ensure_modifier(obj)
    store = get_input(modifier, _INPUT)
    if store is not None and (store.type != "MESH" or _INPUT not in store):  # of a broken file
        set_input(modifier, _INPUT, None)
        store = None
    if store is None:
        label = f"{obj.name} {_INPUT}"
        store = bpy.data.objects.new(label, bpy.data.meshes.new(label))
        store[_INPUT] = True
        store.is_runtime_data = store.data.is_runtime_data = True
    if len(store.data.vertices) != len(binding.carry):
        write_points(store.data, np.zeros((len(binding.carry), 3)))
    write_columns(store.data, binding.rows(), ROW_ATTRIBUTES)
    store.data.update_tag()
    if get_input(modifier, _INPUT) is None:
        set_input(modifier, _INPUT, store)
    if get_input(modifier, "Surface") != obj.dapple.surface:
        set_input(modifier, "Surface", obj.dapple.surface)
    obj.update_tag()


def is_shown(obj: bpy.types.Object) -> bool:
    """Whether the node group of a scatter plays a preview."""
    return get_input(ensure_modifier(obj), _INPUT) is not None


def clear_bindings(keep: Container[int] = ()) -> None:
    """End what previews the file shows, but for those of some scatters."""
    for obj in bpy.data.objects:
        if is_scatter(obj) and obj.session_uid not in keep:
            _unlink(obj)
    _remove_unused()


def _unlink(obj: bpy.types.Object) -> None:
    modifier = scatter_modifier(obj)
    if modifier is None or not has_input(modifier, _INPUT):
        return
    if get_input(modifier, _INPUT) is not None:
        set_input(modifier, _INPUT, None)
        obj.update_tag()


def _remove_unused() -> None:
    for store in [item for item in bpy.data.objects if _INPUT in item and item.users == 0]:
        mesh = store.data
        bpy.data.objects.remove(store)
        bpy.data.meshes.remove(mesh)
