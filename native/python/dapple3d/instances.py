# SPDX-License-Identifier: GPL-3.0-or-later
"""What stands at points: where, turned how, how large, which kind. For files of other programs.

>>> from dapple3d import instances, usd
>>> usd.write("points.usda", instances.of_samples(samples))
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._native import Samples

__all__ = ["Instances", "of_samples", "orientations", "with_velocities"]

ROWS: dict[str, tuple[int, ...]] = {
    "positions": (3,),
    "orientations": (4,),
    "scales": (3,),
    "velocities": (3,),
    "normals": (3,),
    "ids": (),
    "classes": (),
}
TYPES = {"ids": np.int64, "classes": np.int32}


@dataclass(frozen=True)
class Instances:
    """Instances at one time; what is not known is None.

    Attributes:
        positions: (n, 3) float64.
        orientations: (n, 4) float64, unit quaternions w, x, y, z that turn an instance, whose z
            axis stands up, into its place.
        scales: (n, 3) float64, along the instance's own axes.
        velocities: (n, 3) float64, in units of the positions for each second.
        normals: (n, 3) float64.
        ids: (n,) int64, the same for the same point at other times.
        classes: (n,) int32, from 0, which prototype stands here.
    """

    positions: NDArray[np.float64]
    orientations: NDArray[np.float64] | None = None
    scales: NDArray[np.float64] | None = None
    velocities: NDArray[np.float64] | None = None
    normals: NDArray[np.float64] | None = None
    ids: NDArray[np.int64] | None = None
    classes: NDArray[np.int32] | None = None

    def __post_init__(self) -> None:
        """Check what was given.

        Raises:
            ValueError: naming the array, the rule and the first offender.
        """
        for name, values in self.arrays().items():
            object.__setattr__(self, name, _checked(name, values, len(self.positions)))

    def __len__(self) -> int:
        return len(self.positions)

    def arrays(self) -> dict[str, NDArray]:
        """Those that are known, by name."""
        found = {field.name: getattr(self, field.name) for field in fields(self)}
        return {name: values for name, values in found.items() if values is not None}


def _checked(name: str, values: ArrayLike, count: int) -> NDArray:
    array, shape = np.asarray(values), (count, *ROWS[name])
    if array.shape != shape or array.dtype.kind not in "fiu":
        raise ValueError(f"{name} is {array.dtype.name} {array.shape}: numbers {shape} are needed")
    bad = ~np.isfinite(array).all(axis=tuple(range(1, array.ndim)))
    if name == "classes":
        bad |= array < 0
    if bad.any():
        k = int(bad.argmax())
        rule = "at least 0" if name == "classes" else "finite"
        raise ValueError(f"{name}[{k}] is not {rule}: {array[k].tolist()}")
    return array.astype(TYPES.get(name, np.float64))


def of_samples(samples: Samples) -> Instances:
    """Instances that stand on the samples, along their normals."""
    return Instances(
        samples.positions,
        orientations(samples.normals),
        normals=samples.normals,
        ids=samples.ids.astype(np.int64),
        classes=samples.classes,
    )


def orientations(normals: ArrayLike, tangents: ArrayLike | None = None) -> NDArray[np.float64]:
    """Quaternions that turn the z axis onto normals.

    Args:
        normals: (n, 3), of any length but 0.
        tangents: (n, 3), what the x axis then points along as far as it can; without them the turn
            is the shortest one.

    Returns:
        (n, 4) float64: w, x, y, z with w >= 0.

    Raises:
        ValueError: naming the first normal without a direction, or tangent along its normal.
    """
    up = _directions("normals", normals)
    if tangents is None:
        return _shortest(up)
    along = _directions("tangents", tangents)
    flat = along - np.einsum("ij,ij->i", along, up)[:, None] * up
    x = _directions("tangents across the normal", flat)
    return _of_axes(np.stack([x, np.cross(up, x), up], axis=2))


def _directions(name: str, values: ArrayLike) -> NDArray[np.float64]:
    vectors = np.asarray(values, np.float64)
    if vectors.ndim != 2 or vectors.shape[1] != 3:
        raise ValueError(f"{name} has the shape {vectors.shape}: (n, 3) is needed")
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    wrong = ~(np.isfinite(lengths) & (lengths > 1e-30))[:, 0]
    if wrong.any():
        k = int(wrong.argmax())
        raise ValueError(f"{name}[{k}] has no direction: {vectors[k].tolist()}")
    return np.asarray(vectors / lengths)


def _shortest(up: NDArray) -> NDArray[np.float64]:
    """Half-way quaternions: (1 + z, cross((0, 0, 1), up)); straight down a turn about x."""
    x, y, z = up.T
    turns = np.column_stack([1.0 + z, -y, x, np.zeros_like(x)])
    turns[1.0 + z < 1e-12] = [0.0, 1.0, 0.0, 0.0]
    return np.asarray(turns / np.linalg.norm(turns, axis=1, keepdims=True))


def _of_axes(axes: NDArray) -> NDArray[np.float64]:
    """Quaternions of rotation matrices (n, 3, 3).

    The eigenvector of the largest eigenvalue of a symmetric matrix: Bar-Itzhack, New method for
    extracting the quaternion from a rotation matrix, 2000. It has no cases to tell apart.
    """
    trace = np.trace(axes, axis1=1, axis2=2)
    key = np.empty((len(axes), 4, 4))
    key[:, 0, 0] = trace
    key[:, 1:, 1:] = axes + axes.transpose(0, 2, 1) - trace[:, None, None] * np.eye(3)
    skew = [axes[:, i, j] - axes[:, j, i] for i, j in ((2, 1), (0, 2), (1, 0))]
    key[:, 0, 1:] = key[:, 1:, 0] = np.column_stack(skew)
    turns = np.linalg.eigh(key)[1][:, :, 3]
    return np.where(turns[:, :1] < 0, -turns, turns)


def with_velocities(frames: Sequence[Instances], fps: float) -> list[Instances]:
    """The frames with the velocities at which each point gets to its place on the next.

    On the last frame, and where its id is missing on the next, a point keeps its velocity; one
    that is there for a single frame stands still. Frames that have velocities keep them.

    Args:
        frames: with ids, or with the same points in the same order.
        fps: how many of them are a second.
    """
    done = list(frames)
    before: Instances | None = None
    for k, (here, after) in enumerate(zip(frames, [*frames[1:], None], strict=True)):
        if here.velocities is None:
            velocities = np.zeros_like(here.positions)
            if before is not None and before.velocities is not None:
                mine, old = _shared(here, before)
                velocities[mine] = before.velocities[old]
            if after is not None:
                mine, new = _shared(here, after)
                velocities[mine] = (after.positions[new] - here.positions[mine]) * fps
            done[k] = replace(here, velocities=velocities)
        before = done[k]
    return done


def _shared(one: Instances, other: Instances) -> tuple[Any, Any]:
    """Rows of the points that both have."""
    if one.ids is None or other.ids is None:
        both = np.arange(min(len(one), len(other)))
        return both, both
    _, mine, theirs = np.intersect1d(one.ids, other.ids, return_indices=True)
    return mine, theirs
