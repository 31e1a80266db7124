# SPDX-License-Identifier: GPL-3.0-or-later
"""Instances in the space of game engines: one frame, meters, y up, 32-bit floats."""

import numpy as np
from numpy.typing import NDArray

from ..instances import Instances, Scatter, Up


def single_frame(scatter: Scatter, format_name: str) -> Instances:
    """The only frame; ValueError if there are several."""
    if len(scatter.frames) != 1:
        raise ValueError(
            f"{scatter.name} has {len(scatter.frames)} frames: {format_name} holds one"
        )
    return scatter.frames[0]


def check_space(up: str, meters_per_unit: float) -> None:
    """Raise ValueError unless the space of points is described."""
    if up not in ("Y", "Z"):
        raise ValueError(f"up is {up!r}: Y or Z is needed")
    if not (np.isfinite(meters_per_unit) and meters_per_unit > 0):
        raise ValueError(f"meters_per_unit is {meters_per_unit}: a number > 0 is needed")


def single(name: str, values: NDArray) -> NDArray[np.float32]:
    with np.errstate(over="ignore"):
        found = np.ascontiguousarray(values, "<f4")
    wrong = ~np.isfinite(found).all(axis=tuple(range(1, found.ndim)))
    if wrong.any():
        k = int(wrong.argmax())
        raise ValueError(f"{name}[{k}] is no 32-bit float: {values[k].tolist()}")
    return found


def standing(found: Instances, up: Up, factor: float) -> Instances:
    """In meters, y up."""
    positions, turns, scales = found.positions * factor, found.orientations, found.scales
    for name, values in (("positions", positions), ("scales", scales)):
        if values is not None:
            single(name, values)
    if up == "Z":
        positions = with_y_up(positions)
        if turns is not None:
            turns = np.column_stack([turns[:, 0], with_y_up(turns[:, 1:])])
        if scales is not None:
            scales = scales[:, [0, 2, 1]]
    return Instances(positions, turns, scales, ids=found.ids)


def with_y_up(vectors: NDArray) -> NDArray:
    return vectors[:, [0, 2, 1]] * [1.0, 1.0, -1.0]


def with_z_up(vectors: NDArray) -> NDArray:
    return vectors[:, [0, 2, 1]] * [1.0, -1.0, 1.0]


def matrices_of(
    positions: NDArray, turns: NDArray | None, scales: NDArray | None
) -> NDArray[np.float64]:
    """Matrices (n, 4, 4) of column vectors, of what is scaled, then turned, then moved."""
    found = np.tile(np.eye(4), (len(positions), 1, 1))
    if turns is not None:
        found[:, :3, :3] = rotation_matrices(turns)
    if scales is not None:
        found[:, :3, :3] *= scales[:, None, :]
    found[:, :3, 3] = positions
    return found


def rotation_matrices(turns: NDArray) -> NDArray:
    """Rotation matrices (n, 3, 3) of quaternions: v + 2 w (u x v) + 2 u x (u x v)."""
    cross = np.zeros((len(turns), 3, 3))
    x, y, z = turns[:, 1:].T
    cross[:, 0, 1], cross[:, 0, 2], cross[:, 1, 2] = -z, y, -x
    cross -= np.swapaxes(cross, 1, 2)
    return np.eye(3) + 2.0 * turns[:, :1, None] * cross + 2.0 * cross @ cross
