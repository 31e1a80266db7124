# SPDX-License-Identifier: GPL-3.0-or-later
"""Tilt: instances turn with the surface, but only by a little more in each frame.

A point that slides over a crease gets a different normal at once, and its instance would flip. So
the instance is tilted back to the rotation of the surface alone, and straightens by a few degrees
per frame. Where skinning folds a surface, its normal may jump between frames: there an instance
turns little more than its neighbors and is tilted as well. A tilt is a rotation vector in the axes
of the instance: x is its direction, z the normal.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..surface.arrays import Floats, SurfaceArrays
from ..surface.frames import Normals, frames, shading
from ..surface.records import Binding
from .keys import padded

LIMIT = math.radians(9.5)  # largest rotation relative to the surface per frame
MOST_APART = math.radians(30.0)  # largest difference to the neighbors' rotation per frame
_AROUND = 3.0  # size of the cells in which instances are compared, in spacings
_AGREE = 0.8  # mean of rotations that agree, relative to the length of one
_TINY = 1e-9


@dataclass(frozen=True)
class Shown:
    """The previous frame: axes (n, 3, 3) of the instances and the mean spacing of the points."""

    axes: Floats
    spacing: float


class TiltTracker:
    """The tilts of a bake, frame by frame."""

    def __init__(self) -> None:
        self.tilt: Floats | None = None  # tilts of the last frame
        # Vertices, normals and spacing of the last frame, if its topology is the same.
        self._then: tuple[Floats, Normals, float] | None = None

    def next(
        self, before: Binding, after: Binding, vertices: Floats, normals: Normals
    ) -> Floats | None:
        """Tilts (n, 3) of the next frame, which has these vertices; None if there are none.

        Points that appear come last in both bindings.
        """
        tilt, then = self.tilt, None
        if tilt is not None:
            tilt = padded(tilt, len(before.angle))
        if self._then is not None:
            was, shaded, spacing = self._then
            then = Shown(shown(before, tilt, was, shaded), spacing)
        return new_tilts(before, tilt, after, vertices, normals, then)

    def add(self, tilt: Floats | None, vertices: Floats, normals: Normals, spacing: float) -> None:
        """Store a finished frame."""
        self.tilt, self._then = tilt, (vertices, normals, spacing)

    def cross(
        self, before: Binding, first: SurfaceArrays, after: Binding, second: SurfaceArrays
    ) -> None:
        """Continue with another binding, on a surface of the same moment with other faces."""
        axes = shown(before, self.tilt, first.vertices, shading(first))
        self.tilt = tilt_to(axes, after, second.vertices, shading(second))
        self._then = None


def new_tilts(
    before: Binding,
    tilt: Floats | None,
    after: Binding,
    vertices: Floats,
    normals: Normals,
    then: Shown | None = None,
) -> Floats | None:
    """Tilts (n, 3) after points moved from one binding to another; None if there are none.

    `tilt` is the previous tilt. Both bindings are evaluated on the vertices of the new frame.
    `then` is the previous frame, if there is one.
    """
    axes = shown(before, tilt, vertices, normals)
    if then is not None:
        axes = steadied(then, axes, before.positions(vertices))
    turn = tilt_to(axes, after, vertices, normals)
    angle = np.linalg.norm(turn, axis=1)
    left = np.maximum(angle - LIMIT, 0.0)
    if not left.any():
        return None
    found: Floats = turn * (left / np.maximum(angle, _TINY))[:, None]
    return found


def shown(binding: Binding, tilt: Floats | None, vertices: Floats, normals: Normals) -> Floats:
    """Axes (n, 3, 3) of tilted instances."""
    own = frames(binding, vertices, normals).axes(binding.angle)
    return own if tilt is None else own @ rotations(tilt)


def steadied(then: Shown, axes: Floats, places: Floats) -> Floats:
    """Axes after a frame in which outlying rotations are limited to those of their neighbors."""
    if not len(axes):
        return axes
    turned = axes @ np.swapaxes(then.axes, 1, 2)
    cell, sums = _in_cells(turned, places, _AROUND * then.spacing)
    rows = np.flatnonzero(_angles(_rotation(sums)[cell], turned) > 0.5 * MOST_APART)
    others = sums[cell[rows]] - turned[rows]
    count = np.bincount(cell)[cell[rows]] - 1
    agree = np.linalg.norm(others, axis=(1, 2)) > _AGREE * math.sqrt(3.0) * np.maximum(count, 2)
    rows, around = rows[agree], _rotation(others[agree])
    apart = rotation_vectors(np.swapaxes(around, 1, 2) @ turned[rows])
    angle = np.linalg.norm(apart, axis=1)
    far = angle > MOST_APART
    if not far.any():
        return axes
    found, rows = axes.copy(), rows[far]
    less = rotations(apart[far] * (MOST_APART / angle[far])[:, None])
    found[rows] = around[far] @ less @ then.axes[rows]
    return found


def _in_cells(turned: Floats, places: Floats, size: float) -> tuple[NDArray[np.int64], Floats]:
    """Grid cell (n,) of each point, and the sums (c, 3, 3) of the matrices in each cell."""
    cells = np.floor((places - places.min(axis=0)) / max(size, _TINY)).astype(np.int64)
    _, inverse = np.unique(cells, axis=0, return_inverse=True)
    cell = inverse.reshape(-1).astype(np.int64)
    parts = [np.bincount(cell, part) for part in turned.reshape(-1, 9).T]
    sums = np.stack(parts, axis=1).astype(np.float64).reshape(-1, 3, 3)
    return cell, sums


def _rotation(sums: Floats) -> Floats:
    """The rotations (c, 3, 3) nearest to sums of rotations."""
    left, _, right = np.linalg.svd(sums)
    left[:, :, 2] *= np.linalg.det(left @ right)[:, None]
    found: Floats = left @ right
    return found


def _angles(one: Floats, other: Floats) -> Floats:
    found: Floats = np.arccos(np.clip((np.einsum("nij,nij->n", one, other) - 1.0) / 2.0, -1.0, 1.0))
    return found


def tilt_to(axes: Floats, binding: Binding, vertices: Floats, normals: Normals) -> Floats:
    """Tilts (n, 3) that give the instances of a binding these axes."""
    own = frames(binding, vertices, normals).axes(binding.angle)
    return rotation_vectors(np.swapaxes(own, 1, 2) @ axes)


def rotations(vectors: Floats) -> Floats:
    """Matrices (n, 3, 3) of rotation vectors (n, 3), by Rodrigues' formula."""
    angle = np.linalg.norm(vectors, axis=1)[:, None, None]
    x, y, z = vectors.T
    zero = np.zeros_like(x)
    cross = np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]]).transpose(2, 0, 1)
    once = np.sinc(angle / math.pi)  # sin(a) / a
    twice = 0.5 * np.sinc(angle / (2.0 * math.pi)) ** 2  # (1 - cos(a)) / a^2
    found: Floats = np.eye(3) + once * cross + twice * (cross @ cross)
    return found


def rotation_vectors(matrices: Floats) -> Floats:
    """The inverse of rotations(), by quaternions, which also handle half turns."""
    quaternions = _quaternions(matrices)
    sine = np.linalg.norm(quaternions[:, 1:], axis=1)
    angle = 2.0 * np.arctan2(sine, quaternions[:, 0])
    found: Floats = quaternions[:, 1:] * (angle / np.maximum(sine, _TINY))[:, None]
    return found


def _quaternions(matrices: Floats) -> Floats:
    """Unit quaternions (n, 4) with w >= 0: the longest column of four times their outer product."""
    m = matrices
    x, y, z = m[:, 2, 1] - m[:, 1, 2], m[:, 0, 2] - m[:, 2, 0], m[:, 1, 0] - m[:, 0, 1]
    xy, xz, yz = m[:, 1, 0] + m[:, 0, 1], m[:, 0, 2] + m[:, 2, 0], m[:, 2, 1] + m[:, 1, 2]
    a, b, c = m[:, 0, 0], m[:, 1, 1], m[:, 2, 2]
    columns = np.array(
        [
            [1.0 + a + b + c, x, y, z],
            [x, 1.0 + a - b - c, xy, xz],
            [y, xy, 1.0 - a + b - c, yz],
            [z, xz, yz, 1.0 - a - b + c],
        ]
    )
    longest = np.einsum("kkn->kn", columns).argmax(axis=0)
    found: Floats = columns[longest, :, np.arange(len(m))]
    found *= np.where(found[:, 0] < 0.0, -1.0, 1.0)[:, None]
    return found / np.linalg.norm(found, axis=1)[:, None]
