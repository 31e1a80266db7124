# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading the stored points of a scatter; places that were edited by hand."""

import bpy
import numpy as np
from numpy.typing import NDArray

from ...core.solve.locked import Locked
from ...core.solve.solve import with_own_ids
from ...core.surface.arrays import Floats
from ...core.surface.records import (
    EDITED_KEY,
    FADE_ATTRIBUTES,
    POINT_ATTRIBUTES,
    REST_ATTRIBUTES,
    RESULT_KEY,
    ROW_ATTRIBUTES,
    TRIANGLE_ATTRIBUTES,
    Binding,
    Columns,
    binding_from,
    check_binding,
    check_columns,
    check_ids,
    repeated,
    unbound,
)
from ...core.surface.rest import AtRest
from ...core.surface.sources import digest_of
from ..base.mesh_arrays import read_columns, read_points, to_world
from .linked_data import own_mesh

# Checked by check_binding instead, which knows the surface and points that were added by hand.
_BOUND = {*TRIANGLE_ATTRIBUTES, "dapple_barycentric"}


def own_points(obj: bpy.types.Object) -> NDArray[np.bool_]:
    """Whether each point was optimized; False for points that a bake added."""
    if "dapple_faded" not in obj.data.attributes:
        return np.ones(len(obj.data.vertices), dtype=bool)
    return read_columns(obj.data, FADE_ATTRIBUTES)["dapple_faded"] < 0.5


def own_columns(obj: bpy.types.Object, types: dict[str, str]) -> Columns:
    """Columns of the points, without points that a bake added."""
    own = own_points(obj)
    found = {name: values[own] for name, values in read_columns(obj.data, types).items()}
    check_columns({name: one for name, one in found.items() if name not in _BOUND}, obj.name)
    return found


def point_columns_of(obj: bpy.types.Object) -> Columns:
    """Point columns without added points."""
    return own_columns(obj, POINT_ATTRIBUTES)


def columns_with_own_ids(obj: bpy.types.Object) -> Columns:
    """Point columns without points of a bake; points added or copied by hand get new ids."""
    ranked = "dapple_rank" in obj.data.attributes
    types = {**POINT_ATTRIBUTES, "dapple_rank": "FLOAT"} if ranked else POINT_ATTRIBUTES
    columns = own_columns(obj, types)
    new = unbound(binding_from(own_columns(obj, ROW_ATTRIBUTES))) | repeated(columns["id"])
    return with_own_ids(columns, new, obj.dapple.seed)


def points_digest(obj: bpy.types.Object) -> str:
    """Digest of the points as they are stored and bound, without added points."""
    types = {"position": "FLOAT_VECTOR", **ROW_ATTRIBUTES, "id": "INT", "dapple_object_type": "INT"}
    return digest_of(own_columns(obj, types).values())


def write_digest(obj: bpy.types.Object) -> None:
    """Store the digest with the settings and with the points, as an undo may restore only one."""
    obj.dapple.solved_points = obj.data[RESULT_KEY] = points_digest(obj)


def places_of(obj: bpy.types.Object) -> Floats:
    """Stored positions (n, 3) in world space, without added points."""
    places = read_points(obj.data)[own_points(obj)]
    check_columns({"position": places}, obj.name)
    return to_world(obj, places)


def locked_points(obj: bpy.types.Object) -> Locked | None:
    """The locked points as they are stored; None if there are none."""
    if "dapple_locked" not in obj.data.attributes:
        return None
    kept = read_columns(obj.data, {"dapple_locked": "BOOLEAN"})["dapple_locked"] & own_points(obj)
    if not kept.any():
        return None
    types = {"id": "INT", "dapple_object_type": "INT", "position": "FLOAT_VECTOR"}
    columns = {name: values[kept] for name, values in read_columns(obj.data, types).items()}
    check_columns(columns, obj.name)
    places = to_world(obj, read_points(obj.data)[kept])
    return Locked(places, columns["id"], columns["dapple_object_type"])


def read_binding(obj: bpy.types.Object, vertex_count: int) -> tuple[Binding, Columns]:
    """Stored binding and point columns, checked against the surface; without added points."""
    binding = binding_from(own_columns(obj, ROW_ATTRIBUTES))
    check_binding(binding, vertex_count, obj.name)
    columns = point_columns_of(obj)
    check_ids(columns["id"], obj.name)
    return binding, columns


def read_at_rest(obj: bpy.types.Object) -> AtRest:
    """The places of the points on the rest shape."""
    return AtRest(own_columns(obj, REST_ATTRIBUTES), obj.dapple.attached_parts)


def edited_places(obj: bpy.types.Object) -> Floats | None:
    """Places (k, 3) of edits by hand, in the surface's own space; None if there are none."""
    stored = obj.data.get(EDITED_KEY)
    return None if stored is None else np.array(stored, dtype=np.float64).reshape(-1, 3)


def add_edited(obj: bpy.types.Object, places: Floats) -> None:
    """Add places of edits by hand."""
    before = edited_places(obj)
    joined = places if before is None else np.concatenate([before, places])
    if len(joined):
        own_mesh(obj)[EDITED_KEY] = joined.ravel().tolist()


def forget_edited(obj: bpy.types.Object) -> None:
    """Delete the places of edits by hand, once the points around them are even."""
    if EDITED_KEY in obj.data:
        del own_mesh(obj)[EDITED_KEY]
