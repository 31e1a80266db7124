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
    shown = frames(before, vertices, normals).axes(before.carry)
    if lean is not None:
        shown = shown @ rotations(lean)
    own = frames(after, vertices, normals).axes(after.carry)
    turn = _rotation_vectors(np.swapaxes(own, 1, 2) @ shown)
    angle = np.linalg.norm(turn, axis=1)
    left = np.maximum(angle - LIMIT, 0.0)
    if not left.any():
        return None
    found: Floats = turn * (left / np.maximum(angle, _TINY))[:, None]
    return found


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
    """Their inverse; half a turn, whose axis the formula does not determine, is taken for none."""
    m = matrices
    doubled = np.stack(
        [m[:, 2, 1] - m[:, 1, 2], m[:, 0, 2] - m[:, 2, 0], m[:, 1, 0] - m[:, 0, 1]], 1
    )
    sine = 0.5 * np.linalg.norm(doubled, axis=1)
    cosine = 0.5 * (np.trace(m, axis1=1, axis2=2) - 1.0)
    angle = np.arctan2(sine, cosine)
    found: Floats = doubled * (0.5 * angle / np.maximum(sine, _TINY))[:, None]
    return found
