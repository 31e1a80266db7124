# SPDX-License-Identifier: GPL-3.0-or-later
"""Leaning: what stands on a surface turns with it, and little more in any one frame.

A point that slides over a crease gets another normal at once, and its instance would flip too. So
the instance leans back to where the surface alone would have turned it, and straightens by a few
degrees a frame. A lean is a rotation vector in the axes of the instance: the direction it carries
is x, the normal z.
"""

import math

import numpy as np

from .frames import Normals, frames
from .records import Binding
from .surface import Floats

LIMIT = math.radians(9.5)  # that an instance turns against its surface in a frame
_TINY = 1e-9


def leaning(
    before: Binding, lean: Floats | None, after: Binding, vertices: Floats, normals: Normals
) -> Floats | None:
    """Leans (n, 3) after points went from one binding to another; None where none leans.

    lean is theirs before; both bindings are looked at on the vertices of the new frame.
    """
    turn = lean_to(shown(before, lean, vertices, normals), after, vertices, normals)
    angle = np.linalg.norm(turn, axis=1)
    left = np.maximum(angle - LIMIT, 0.0)
    if not left.any():
        return None
    found: Floats = turn * (left / np.maximum(angle, _TINY))[:, None]
    return found


def shown(binding: Binding, lean: Floats | None, vertices: Floats, normals: Normals) -> Floats:
    """Axes (n, 3, 3) of instances that lean."""
    own = frames(binding, vertices, normals).axes(binding.carry)
    return own if lean is None else own @ rotations(lean)


def lean_to(axes: Floats, binding: Binding, vertices: Floats, normals: Normals) -> Floats:
    """Leans (n, 3) that give the instances of a binding these axes."""
    own = frames(binding, vertices, normals).axes(binding.carry)
    return _rotation_vectors(np.swapaxes(own, 1, 2) @ axes)


def rotations(vectors: Floats) -> Floats:
    """Matrices (n, 3, 3) of rotation vectors (n, 3), by Rodrigues' formula."""
    angle = np.linalg.norm(vectors, axis=1)[:, None, None]
    x, y, z = vectors.T
    nought = np.zeros_like(x)
    cross = np.array([[nought, -z, y], [z, nought, -x], [-y, x, nought]]).transpose(2, 0, 1)
    once = np.sinc(angle / math.pi)  # sin(a) / a
    twice = 0.5 * np.sinc(angle / (2.0 * math.pi)) ** 2  # (1 - cos(a)) / a^2
    found: Floats = np.eye(3) + once * cross + twice * (cross @ cross)
    return found


def _rotation_vectors(matrices: Floats) -> Floats:
    """Their inverse, by the quaternions of the matrices: half turns have an axis too."""
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
