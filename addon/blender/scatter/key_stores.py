# SPDX-License-Identifier: GPL-3.0-or-later
"""Finding, reading and checking the objects that store the keyframes of a bake."""

from collections.abc import Container

import bpy
import numpy as np

from ...core.bake.keys import Baked, wrong_index
from ...core.base.errors import ScatterError
from ...core.surface.arrays import Floats, Ints
from ...core.surface.records import (
    CLEARANCE_ATTRIBUTES,
    FADE_ATTRIBUTES,
    FRAME_ATTRIBUTES,
    KEY_ATTRIBUTES,
    REST_TRIANGLE_ATTRIBUTES,
    TILT_ATTRIBUTES,
    TRIANGLE_ATTRIBUTES,
    Columns,
)
from ...nodes import get_input, has_input
from ..base.all_or_nothing import once_done
from ..base.mesh_arrays import read_columns, write_columns, write_points
from .modifier import scatter_modifier

STORES = ("Keys", "Triangles", "Frames")  # inputs of the node group for a bake


def stored_object(obj: bpy.types.Object, name: str) -> bpy.types.Object:
    """The object with a baked scatter's Keys, Triangles or Frames; ScatterError if none."""
    modifier = scatter_modifier(obj)
    found = get_input(modifier, name) if modifier and has_input(modifier, name) else None
    if found is None:
        raise ScatterError(f"Scatter '{obj.name}' has no baked {name}: bake again")
    if not isinstance(found, bpy.types.Object) or found.type != "MESH":
        kind = getattr(found, "type", "number").lower()
        raise ScatterError(
            f"{name} '{getattr(found, 'name', found)}' of '{obj.name}' is a {kind}, not a mesh: "
            "bake again"
        )
    if found.data == obj.data:  # seen once in Blender 5.2, after an undo
        raise ScatterError(f"{name} of '{obj.name}' is the mesh of its own points: bake again")
    return found


def stores_of(obj: bpy.types.Object) -> list[bpy.types.Object]:
    """The existing objects that store a bake."""
    modifier = scatter_modifier(obj)
    if modifier is None:
        return []
    found = (get_input(modifier, name) for name in STORES if has_input(modifier, name))
    return [store for store in found if isinstance(store, bpy.types.Object)]


def new_store(
    obj: bpy.types.Object,
    name: str,
    columns: Columns,
    types: dict[str, str],
    places: Floats | None = None,
) -> bpy.types.Object:
    """A new object outside all scenes whose points store columns."""
    label = f"{obj.name} {name}"
    store = bpy.data.objects.new(label, bpy.data.meshes.new(label))
    count = len(columns[next(iter(types))])
    write_points(store.data, np.zeros((count, 3)) if places is None else places)
    write_columns(store.data, columns, types)
    once_done(lambda: _name(store, label))  # the objects of the last bake have the name until then
    return store


def _name(store: bpy.types.Object, label: str) -> None:
    for block in (store, store.data):
        if block.name != label:
            block.name = label


def read_baked(obj: bpy.types.Object) -> Baked:
    """The keyframes of a baked scatter."""
    keys, triangles, frames = (stored_object(obj, name).data for name in STORES)
    return Baked(
        read_columns(keys, {**key_types(keys.attributes), "position": "FLOAT_VECTOR"}),
        read_columns(triangles, triangle_types(triangles.attributes)),
        read_columns(frames, FRAME_ATTRIBUTES),
    )


def key_types(there: Container[str]) -> dict[str, str]:
    """Columns of keyframes that a bake has: births, leaning and clearances are optional."""
    types = dict(KEY_ATTRIBUTES)
    for own in (FADE_ATTRIBUTES, TILT_ATTRIBUTES, CLEARANCE_ATTRIBUTES):
        types |= {name: kind for name, kind in own.items() if name in there}
    return types


def triangle_types(there: Container[str]) -> dict[str, str]:
    """Columns of triangles that a bake has: those of a rest shape are optional."""
    types = {**TRIANGLE_ATTRIBUTES, **REST_TRIANGLE_ATTRIBUTES}
    return {name: kind for name, kind in types.items() if name in there}


def key_tables(obj: bpy.types.Object) -> tuple[Ints, Columns, Columns, int]:
    """The triangle of each row of a bake, the triangles, the frames, the points per keyframe."""
    keys, triangles, frames = (stored_object(obj, name).data for name in STORES)
    return (
        read_columns(keys, KEY_ATTRIBUTES)["dapple_face"],
        read_columns(triangles, TRIANGLE_ATTRIBUTES),
        read_columns(frames, FRAME_ATTRIBUTES),
        key_points(obj),
    )


def check_keys(obj: bpy.types.Object) -> None:
    """ScatterError if a bake has an invalid index."""
    wrong = wrong_index(*key_tables(obj))
    if wrong:
        raise ScatterError(f"Scatter '{obj.name}': the keyframes are damaged ({wrong}): bake again")


def key_points(obj: bpy.types.Object) -> int:
    """Points per keyframe; ScatterError if the stored value is invalid."""
    modifier = scatter_modifier(obj)
    is_stored = modifier is not None and has_input(modifier, "Key Points")
    found = get_input(modifier, "Key Points") if is_stored else None
    if not isinstance(found, int) or found < 0:
        raise ScatterError(f"Scatter '{obj.name}': the number of its points is missing: bake again")
    return found


def frames(obj: bpy.types.Object) -> dict[str, np.ndarray]:
    """The table of the baked frames."""
    found = read_columns(stored_object(obj, "Frames").data, FRAME_ATTRIBUTES)
    count = len(found["dapple_key"])
    if count != obj.dapple.baked_frames:
        raise ScatterError(
            f"Scatter '{obj.name}' has {count} baked frames, not {obj.dapple.baked_frames}: bake "
            "again"
        )
    return found
