# SPDX-License-Identifier: GPL-3.0-or-later
"""Instances at points: position, orientation, scale and prototype, for files of other programs.

>>> from dapple3d import instances
>>> from dapple3d.extras import usd
>>> usd.write("points.usda", instances.of_samples(samples))
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._native import Samples, nearest_distances

__all__ = [
    "Instances",
    "Mesh",
    "Reference",
    "Scatter",
    "Up",
    "along_normals",
    "of_matrices",
    "of_samples",
    "orientations",
    "quaternions",
    "with_velocities",
]

Up = Literal["Y", "Z"]
SKEWED = 1e-3  # cosine between axes that should be perpendicular
BALL = 0.2  # radius of the ball that replaces a missing prototype, in spacings

ROWS: dict[str, tuple[int, ...]] = {
    "positions": (3,),
    "orientations": (4,),
    "scales": (3,),
    "velocities": (3,),
    "normals": (3,),
    "ids": (),
    "classes": (),
    "prototypes": (),
}
TYPES: dict[str, type[np.signedinteger]] = {
    **{"ids": np.int64, "classes": np.int32, "prototypes": np.int32},
}
COUNTED = ("classes", "prototypes")


@dataclass(frozen=True)
class Reference:
    """A prototype in another file of the same format.

    Attributes:
        path: of the file.
        prim: in it, such as "/Plants/Fern" in USD and "Fern" in glTF; empty is the default prim, or
            the whole scene.
        held: whether a USD file stores a copy of the default prim of the other file, so that it is
            independent of that file; a glTF file always does, a scene of Godot never.
    """

    path: Path
    prim: str = ""
    held: bool = False


@dataclass(frozen=True)
class Mesh:
    """A prototype made of triangles, stored in the written file.

    Attributes:
        vertices: (v, 3) float64.
        faces: (m, 3) int32.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int32]

    def __post_init__(self) -> None:
        """Check what was given.

        Raises:
            ValueError: naming the array, the rule and the first offender.
        """
        vertices = _vectors("vertices", self.vertices).astype(np.float64)
        faces = whole("faces", _vectors("faces", self.faces), np.int32)
        check_faces(faces, len(vertices))
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "faces", faces)


@dataclass(frozen=True)
class Instances:
    """Instances at one time; unknown arrays are None.

    Attributes:
        positions: (n, 3) float64.
        orientations: (n, 4) float64, unit quaternions w, x, y, z.
        scales: (n, 3) float64, along the instance's own axes.
        velocities: (n, 3) float64, in units of the positions per second.
        normals: (n, 3) float64.
        ids: (n,) int64, constant over time.
        classes: (n,) int32, from 0.
        prototypes: (n,) int32, index of the prototype, from 0; None: that of the class.
    """

    positions: NDArray[np.float64]
    orientations: NDArray[np.float64] | None = None
    scales: NDArray[np.float64] | None = None
    velocities: NDArray[np.float64] | None = None
    normals: NDArray[np.float64] | None = None
    ids: NDArray[np.int64] | None = None
    classes: NDArray[np.int32] | None = None
    prototypes: NDArray[np.int32] | None = None

    def __post_init__(self) -> None:
        """Check what was given.

        Raises:
            ValueError: naming the array, the rule and the first offender.
        """
        for name, values in self.arrays().items():
            object.__setattr__(self, name, _checked(name, values, len(self.positions)))

    def __len__(self) -> int:
        return len(self.positions)

    @property
    def placed(self) -> NDArray[np.int32]:
        """(n,) int32: the prototype of each instance."""
        chosen = self.classes if self.prototypes is None else self.prototypes
        return np.zeros(len(self), np.int32) if chosen is None else chosen

    def arrays(self) -> dict[str, NDArray]:
        """The arrays that are known, by name."""
        found = {field.name: getattr(self, field.name) for field in fields(self)}
        return {name: values for name, values in found.items() if values is not None}


def _checked(name: str, values: ArrayLike, count: int) -> NDArray:
    array, shape = np.asarray(values), (count, *ROWS[name])
    if array.shape != shape or array.dtype.kind not in "fiu":
        raise ValueError(f"{name} is {array.dtype.name} {array.shape}: numbers {shape} are needed")
    _check_finite(name, array)
    if name not in TYPES:
        return array.astype(np.float64)
    found = whole(name, array, TYPES[name])
    if name in COUNTED and (found < 0).any():
        k = int((found < 0).argmax())
        raise ValueError(f"{name}[{k}] is not at least 0: {found[k]}")
    return found


def _vectors(name: str, values: ArrayLike) -> NDArray:
    """(n, 3) finite numbers."""
    array = np.asarray(values)
    if array.size == 0:
        array = array.reshape(-1, 3) if array.ndim < 2 else array
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "fiu":
        raise ValueError(f"{name} is {array.dtype.name} {array.shape}: numbers (n, 3) are needed")
    _check_finite(name, array)
    return array


def _check_finite(name: str, array: NDArray) -> None:
    bad = ~np.isfinite(array).all(axis=tuple(range(1, array.ndim)))
    if bad.any():
        k = int(bad.argmax())
        raise ValueError(f"{name}[{k}] is not finite: {array[k].tolist()}")


def whole(name: str, values: NDArray, kind: type[np.signedinteger]) -> NDArray:
    """Finite numbers as integers of a type.

    Raises:
        ValueError: naming the first row with a number that is not an integer, or too large.
    """
    bits, least = np.iinfo(kind).bits, np.iinfo(kind).min
    most = -float(least)  # the smallest value that is too large; exact as a float
    if values.dtype.kind == "f":
        fits = (values == np.floor(values)) & (values >= least) & (values < most)
    else:
        fits = (values >= least) & (values <= np.iinfo(kind).max)
    wrong = np.argwhere(~fits)
    if len(wrong):
        row, value = wrong[0][0], values[tuple(wrong[0])]
        raise ValueError(f"{name}[{row}] is {value!s}: a whole number of {bits} bits is needed")
    return values.astype(kind)


def check_faces(faces: NDArray, vertices: int) -> None:
    """Refuse faces without vertices.

    Raises:
        ValueError: naming the first one.
    """
    wrong = ((faces < 0) | (faces >= vertices)).any(axis=1)
    if wrong.any():
        k = int(wrong.argmax())
        raise ValueError(f"faces[{k}] is {faces[k].tolist()}: there are {vertices} vertices")


@dataclass(frozen=True)
class Scatter:
    """Instances with a name, on one or more frames.

    Attributes:
        name: letters, digits and _.
        frames: the instances; their number may change.
        prototypes: the prototypes of classes 0, 1, ..., or those that the instances refer to;
            empty: a small ball for each class.
    """

    name: str
    frames: Sequence[Instances]
    prototypes: Sequence[Reference | Mesh] = ()

    def __post_init__(self) -> None:
        """Check what was given.

        Raises:
            ValueError: naming the first frame with other arrays than the first has, or the
                prototype that is missing.
        """
        if not self.frames:
            raise ValueError("frames is empty: at least one is needed")
        names = [sorted(frame.arrays()) for frame in self.frames]
        for k, found in enumerate(names):
            if found != names[0]:
                raise ValueError(f"frames[{k}] has {found}, but frames[0] {names[0]}")
        given = len(self.prototypes)
        if 0 < given < self.needed:
            raise ValueError(
                f"prototypes has {given} of {self.needed} entries: one for each class is needed"
            )

    @property
    def needed(self) -> int:
        """Number of prototypes in use; at least one."""
        return max(int(frame.placed.max(initial=0)) for frame in self.frames) + 1

    @property
    def used(self) -> NDArray[np.int32]:
        """Indices of the prototypes in use, increasing; at least one."""
        numbers = np.unique(np.concatenate([frame.placed for frame in self.frames]))
        return numbers if len(numbers) else np.zeros(1, np.int32)

    @property
    def radius(self) -> float:
        """Radius of balls that do not touch on the first frame with two points."""
        several = next((frame.positions for frame in self.frames if len(frame) > 1), None)
        if several is None:
            return BALL
        return BALL * float(np.median(nearest_distances(several))) or BALL


def of_samples(samples: Samples, up: Up = "Z") -> Instances:
    """Instances at the samples, aligned with their normals.

    Args:
        samples: of a surface.
        up: the axis of the prototypes that is aligned with the normals.
    """
    return Instances(
        samples.positions,
        orientations(samples.normals, up=up),
        normals=samples.normals,
        ids=samples.ids.astype(np.int64),
        classes=samples.classes,
    )


def of_matrices(
    matrices: NDArray[np.float64], **others: NDArray | None
) -> tuple[Instances, NDArray[np.bool_]]:
    """Instances with these matrices, which may contain mirroring.

    Args:
        matrices: (n, 4, 4), for column vectors: the last column is the position.
        others: arrays of Instances, by name.

    Returns:
        The instances, and (n,) whether each matrix is sheared, so that rotation and scales only
        approximate it.
    """
    linear = np.asarray(matrices, np.float64)[:, :3, :3]
    scales = np.linalg.norm(linear, axis=1)
    scales[np.linalg.det(linear) < 0] *= -1.0
    axes = linear / np.where(scales == 0.0, 1.0, scales)[:, None, :]
    off = np.abs(np.swapaxes(axes, 1, 2) @ axes - np.eye(3)).max(axis=(1, 2), initial=0.0)
    skewed = (off > SKEWED) & (scales != 0.0).all(axis=1)
    found = Instances(matrices[:, :3, 3], quaternions(axes), scales, **others)
    return found, skewed


def orientations(
    normals: ArrayLike, tangents: ArrayLike | None = None, *, up: Up = "Z"
) -> NDArray[np.float64]:
    """Quaternions that rotate an axis to normals.

    Args:
        normals: (n, 3), of any length but 0.
        tangents: (n, 3), the direction that the x axis follows as closely as possible; None: the
            shortest rotation.
        up: the axis.

    Returns:
        (n, 4) float64: w, x, y, z with w >= 0.

    Raises:
        ValueError: naming the first normal without a direction, or tangent along its normal.
    """
    heads = _directions("normals", normals)
    if tangents is None:
        return _shortest(heads, up)
    along = _directions("tangents", tangents)
    flat = along - np.einsum("ij,ij->i", along, heads)[:, None] * heads
    x = _directions("tangents across the normal", flat)
    side = np.cross(heads, x)
    axes = [x, side, heads] if up == "Z" else [x, heads, -side]
    return quaternions(np.stack(axes, axis=2))


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


def _shortest(heads: NDArray, up: Up) -> NDArray[np.float64]:
    """Shortest rotations by 1 + dot and cross of axis and normal; opposite: a half turn about x."""
    axis = np.eye(3)[1 if up == "Y" else 2]
    turns = np.column_stack([1.0 + heads @ axis, np.cross(axis, heads)])
    turns[turns[:, 0] < 1e-12] = [0.0, 1.0, 0.0, 0.0]
    return np.asarray(turns / np.linalg.norm(turns, axis=1, keepdims=True))


def quaternions(axes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Quaternions (n, 4), w, x, y, z with w >= 0, of rotation matrices (n, 3, 3).

    The eigenvector of the largest eigenvalue of a symmetric matrix: Bar-Itzhack, New method for
    extracting the quaternion from a rotation matrix, 2000. It needs no case distinctions.
    """
    trace = np.trace(axes, axis1=1, axis2=2)
    key = np.empty((len(axes), 4, 4))
    key[:, 0, 0] = trace
    key[:, 1:, 1:] = axes + axes.transpose(0, 2, 1) - trace[:, None, None] * np.eye(3)
    skew = [axes[:, i, j] - axes[:, j, i] for i, j in ((2, 1), (0, 2), (1, 0))]
    key[:, 0, 1:] = key[:, 1:, 0] = np.column_stack(skew)
    turns = np.linalg.eigh(key)[1][:, :, 3]
    return np.where(turns[:, :1] < 0, -turns, turns)


def along_normals(frames: Sequence[Instances], *, up: Up = "Z") -> list[Instances]:
    """The frames with orientations along the normals, where there are none yet.

    On its first frame an instance has the shortest rotation, as by orientations(). On each further
    frame the shortest rotation between the two normals is added, so that nothing spins where a
    normal nearly points down.

    Args:
        frames: with normals, or unchanged; with ids, or with the same points in the same order.
        up: the axis that is rotated to the normals.

    Raises:
        ValueError: naming the first normal without a direction.
    """
    done: list[Instances] = []
    for here in frames:
        if here.orientations is None and here.normals is not None:
            turns = orientations(here.normals, up=up)
            before = done[-1] if done else None
            if before is not None and before.normals is not None:
                assert before.orientations is not None
                mine, old = _shared(here, before)
                turns[mine] = _carried(
                    before.orientations[old], before.normals[old], here.normals[mine], turns[mine]
                )
            here = replace(here, orientations=turns)
        done.append(here)
    return done


def _carried(before: NDArray, start: NDArray, end: NDArray, anew: NDArray) -> NDArray[np.float64]:
    """Rotations continued from the frame before; computed anew where a normal has flipped."""
    a, b = _directions("normals", start), _directions("normals", end)
    real, imaginary = 1.0 + np.einsum("ij,ij->i", a, b)[:, None], np.cross(a, b)
    w, v = before[:, :1], before[:, 1:]
    turns = np.column_stack(
        [
            real[:, 0] * w[:, 0] - np.einsum("ij,ij->i", imaginary, v),
            real * v + w * imaginary + np.cross(imaginary, v),
        ]
    )
    turns[real[:, 0] < 1e-12] = anew[real[:, 0] < 1e-12]
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    return np.asarray(np.where(turns[:, :1] < 0, -turns, turns))


def with_velocities(frames: Sequence[Instances], fps: float) -> list[Instances]:
    """The frames with the velocities that take each point to its place on the next frame.

    On the last frame, and where its id is missing on the next one, a point keeps its velocity; a
    point on a single frame has velocity 0. Frames that have velocities keep them.

    Args:
        frames: with ids, or with the same points in the same order.
        fps: frames per second.
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
    """Rows of the points with an id in both frames."""
    if one.ids is None or other.ids is None:
        both = np.arange(min(len(one), len(other)))
        return both, both
    _, mine, theirs = np.intersect1d(one.ids, other.ids, return_indices=True)
    return mine, theirs
