# SPDX-License-Identifier: GPL-3.0-or-later
"""The attributes that a scatter and its baked keyframes store, and their schema.

A binding attaches each point to the surface by the three vertices of a triangle and barycentric
coordinates; the face corners there give the normals that the surface is shaded with. The points of
the scatter object store one binding. Baked keyframes are stored in three meshes without faces: one
point for each keyframe and point, one for each triangle, one for each frame.
"""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.errors import ScatterError
from .arrays import Floats, Ints

SCHEMA = 1
SCHEMA_KEY = "dapple_schema"
RESULT_KEY = "dapple_result"  # digest of the points, stored with their mesh
# Where points were edited by hand, in the surface's own space, until others are even around them.
EDITED_KEY = "dapple_edited"
PLACED_ATTRIBUTES = {"dapple_placed": "FLOAT_VECTOR"}  # positions before editing

# Attribute name -> Blender's type, all on points. Nodes read the names: nodes/bound_point.py.
ROW_ATTRIBUTES = {
    "dapple_v0": "INT",
    "dapple_v1": "INT",
    "dapple_v2": "INT",
    "dapple_c0": "INT",
    "dapple_c1": "INT",
    "dapple_c2": "INT",
    "dapple_barycentric": "FLOAT_VECTOR",
    "dapple_angle": "FLOAT",
}
KEY_ATTRIBUTES = {"dapple_face": "INT"}  # its position: barycentrics 1 and 2, angle carried
# Places of the rest shape, where points are bound to it, and in which of its parts: rest.py.
REST_ATTRIBUTES = {
    "dapple_rest": "FLOAT_VECTOR",
    "dapple_ahead": "FLOAT_VECTOR",
    "dapple_part": "INT",
}
# 1 - fade, where points appear or vanish: on each key, and on the points, 1 on those that a bake
# has added. Nodes read 0 where there is none.
FADE_ATTRIBUTES = {"dapple_faded": "FLOAT"}
# Tilt of instances against the normal, on each keyframe, where there is any (tilt.py).
TILT_ATTRIBUTES = {"dapple_tilt": "FLOAT_VECTOR"}
# Clearance of points, on each keyframe, where instances are fitted to it (class_counts.py).
CLEARANCE_ATTRIBUTES = {"dapple_clearance": "FLOAT"}
TRIANGLE_ATTRIBUTES = {f"dapple_{kind}{k}": "INT" for kind in "vc" for k in range(3)}
# Where the triangles' corners are on the rest shape, where points are bound to it.
REST_TRIANGLE_ATTRIBUTES = {
    **{f"dapple_r{k}": "FLOAT_VECTOR" for k in range(3)},
    "dapple_part": "INT",
}
FRAME_ATTRIBUTES = {
    "dapple_key": "INT",  # the key at or before the frame
    "dapple_since": "INT",  # frames since that key
    "dapple_span": "INT",  # frames from that key to the next; 0: no interpolation
    "dapple_vertices": "INT",  # number of vertices of the surface
    **{f"dapple_sketch{k}": "FLOAT_VECTOR" for k in range(3)},  # sketch of its shape, see stale.py
}
POINT_ATTRIBUTES = {
    "id": "INT",
    "dapple_object_type": "INT",
    "dapple_density": "FLOAT",
    "dapple_scale": "FLOAT",
    "dapple_turn": "FLOAT",
}
# Where a point stands, 0..1, in an order of which every beginning is even; whether it stays where
# it is; half the distance to its nearest like; the direction away from its neighbors, 0..1 long, in
# the axes of its instance before it is turned.
ADDED_ATTRIBUTES = {
    "dapple_rank": "FLOAT",
    "dapple_locked": "BOOLEAN",
    "dapple_clearance": "FLOAT",
    "dapple_apart": "FLOAT_VECTOR",
}
# The id of the mirror image, where points are in pairs; a point's own on the plane and where it has
# none.
MIRROR_ATTRIBUTES = {"dapple_mirror": "INT"}

MOST_CLASSES = 10_000
_LIMITS = {
    "id": 2**30,
    "dapple_object_type": MOST_CLASSES - 1,
    "dapple_part": 2**20,
}  # largest values

Columns = dict[str, np.ndarray]


@dataclass(frozen=True)
class Binding:
    """Where points sit on a surface."""

    corners: Ints  # (n, 3) vertex indices
    barycentric: Floats  # (n, 3)
    angle: Floats  # (n,) angle in radians from the first edge, see frames.py
    # (n, 3) face corners of the mesh at those vertices; 0 where they are not known.
    loops: Ints = field(default_factory=lambda: np.empty((0, 3), dtype=np.int32))

    def __post_init__(self) -> None:
        if self.loops.shape != self.corners.shape:
            object.__setattr__(self, "loops", np.zeros_like(self.corners))

    def rows(self) -> Columns:
        """Columns named as in ROW_ATTRIBUTES."""
        columns: Columns = {f"dapple_v{k}": self.corners[:, k] for k in range(3)}
        columns |= {f"dapple_c{k}": self.loops[:, k] for k in range(3)}
        columns["dapple_barycentric"] = self.barycentric
        columns["dapple_angle"] = self.angle
        return columns

    def positions(self, vertices: Floats) -> Floats:
        """Points (n, 3) on the surface with these vertices."""
        return self.interpolated(vertices[self.corners])

    def interpolated(self, values: Floats) -> Floats:
        """Values (n, d) at the points, from those of the corners of their faces (n, 3, d)."""
        return np.einsum("nk,nkd->nd", self.barycentric, values)

    def rows_at(self, rows: Any) -> "Binding":
        """The binding of some points, selected by indices or a mask."""
        return Binding(*(values[rows] for values in self._arrays()))

    def with_rows(self, rows: Any, others: "Binding") -> "Binding":
        """The binding with some points, selected by indices or a mask, bound as in `others`."""
        copies = [values.copy() for values in self._arrays()]
        for own, other in zip(copies, others._arrays(), strict=True):
            own[rows] = other
        return Binding(*copies)

    def _arrays(self) -> tuple[NDArray[Any], ...]:
        return self.corners, self.barycentric, self.angle, self.loops


def joined(bindings: list[Binding]) -> Binding:
    """Points of several bindings, one after another."""
    parts = zip(*(one._arrays() for one in bindings), strict=True)
    return Binding(*map(np.concatenate, parts))


def as_stored(binding: Binding) -> Binding:
    """A binding in single precision, as it is read again after it was stored."""
    weights, angle = (
        np.asarray(values, dtype=np.float32).astype(np.float64)
        for values in (binding.barycentric, binding.angle)
    )
    return replace(binding, barycentric=weights, angle=angle)


def binding_from(columns: Columns) -> Binding:
    """Binding of stored columns."""
    corners, loops = (
        np.column_stack([columns[f"dapple_{kind}{k}"] for k in range(3)]).astype(np.int32)
        for kind in "vc"
    )
    weights = np.asarray(columns["dapple_barycentric"], dtype=np.float64)
    angle = np.asarray(columns["dapple_angle"], dtype=np.float64)
    return Binding(corners, weights, angle, loops)


def check_binding(binding: Binding, vertex_count: int, name: str) -> None:
    """ScatterError unless the stored binding can be used on a surface of vertex_count vertices."""
    outside = (binding.corners < 0) | (binding.corners >= vertex_count)
    if outside.any():
        point, corner = np.argwhere(outside)[0]
        raise ScatterError(
            f"Scatter '{name}': dapple_v{corner}[{point}] is {binding.corners[point, corner]}, "
            f"but the surface has {vertex_count} vertices: optimize the scatter"
        )
    if unbound(binding).any():
        raise ScatterError(
            f"Scatter '{name}': point {int(np.argmax(unbound(binding)))} was added by hand and is "
            "not attached to the surface: Reattach attaches it where it is"
        )
    broken = ~np.isfinite(binding.barycentric).all(axis=1)
    if broken.any():
        point = int(np.argmax(broken))
        raise ScatterError(
            f"Scatter '{name}': dapple_barycentric[{point}] is not finite: "
            f"{binding.barycentric[point].tolist()}"
        )


def check_columns(columns: Columns, name: str) -> None:
    """ScatterError unless stored columns of a scatter or its keys hold what Dapple writes there."""
    for column, values in columns.items():
        limit = _LIMITS.get(column)
        if limit is not None:
            wrong = (values < 0) | (values > limit)
            rule = f"it must be from 0 to {limit}"
        elif values.dtype.kind == "f":
            wrong = ~np.asarray(np.isfinite(values).all(axis=tuple(range(1, values.ndim))))
            rule = ""
        else:
            continue
        if wrong.any():
            row = int(np.argmax(wrong))
            found = values[row].tolist()
            text = f"is {found}, {rule}" if rule else f"is not finite: {found}"
            raise ScatterError(f"Scatter '{name}': {column}[{row}] {text}")


def unbound(binding: Binding) -> NDArray[np.bool_]:
    """Which points have no weights at all, like vertices that were added by hand."""
    none: NDArray[np.bool_] = (binding.barycentric == 0.0).all(axis=1)
    return none


def repeated(ids: Ints) -> NDArray[np.bool_]:
    """Which points have the id of an earlier point, like vertices that were copied by hand."""
    first = np.unique(ids, return_index=True)[1]
    again = np.ones(len(ids), dtype=bool)
    again[first] = False
    return again


def check_ids(ids: Ints, name: str) -> None:
    """ScatterError if two points have the same id."""
    if repeated(ids).any():
        point = int(np.argmax(repeated(ids)))
        raise ScatterError(
            f"Scatter '{name}': point {point} was copied by hand, its id {ids[point]} is that of "
            "another one: Reattach gives it one of its own"
        )


def own_random(seed: int, ids: Ints, stream: int) -> Floats:
    """Numbers in [0, 1) that depend only on seed, id and stream (SplitMix64)."""
    mask = (1 << 64) - 1
    start = (seed * 0x9E3779B97F4A7C15 + stream * 0xD1B54A32D192ED03) & mask
    state = ids.astype(np.uint64) * np.uint64(0x9E3779B97F4A7C15) + np.uint64(start)
    return (mixed(state) >> np.uint64(11)).astype(np.float64) * 2.0**-53


def mixed(state: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Numbers (n,) of which each bit depends on all bits of the state (SplitMix64)."""
    state = (state ^ (state >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    state = (state ^ (state >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return state ^ (state >> np.uint64(31))


@dataclass(frozen=True)
class Placed:
    """Where points sit in one frame."""

    faces: Ints  # (n,) triangles of the surface, as it was cut when it was bound
    binding: Binding
    faded: Floats | None = None  # (n,) 0 exists, 1 does not; None: all exist
    tilt: Floats | None = None  # (n, 3) see tilt.py; None: no tilt
    clearance: Floats | None = None  # (n,) see class_counts.py; None: not stored
