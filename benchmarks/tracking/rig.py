# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies made of bones: one closed mesh around them, moved by linear blend skinning."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from benchmarks.tracking.implicit import Array, Faces, blend, capsule, mesh

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Bone:
    """A capsule that turns about its start and carries its children."""

    parent: str | None
    start: Vector
    end: Vector
    radii: tuple[float, float]


Turns = Mapping[str, Vector]
"""Of a pose: for each bone its turn about the axes x, y, z through its start, in degrees."""


class Rig:
    """Bones with their mesh and weights.

    fillet is the width of the blend between bones where they meet, softness that of the weights,
    both in the bones' units.
    """

    def __init__(
        self, bones: Mapping[str, Bone], faces: int, *, fillet: float, softness: float
    ) -> None:
        self.bones = bones
        ends = np.array([place for bone in bones.values() for place in (bone.start, bone.end)])
        margin = max(max(bone.radii) for bone in bones.values()) + 3 * fillet
        self.vertices, self.faces = mesh(
            lambda points: blend(self._distances(points), fillet),
            ends.min(axis=0) - margin,
            ends.max(axis=0) + margin,
            faces,
        )
        distances = self._distances(self.vertices)
        weights = np.exp((distances.min(axis=0) - distances) / softness)
        self._weights = weights / weights.sum(axis=0)

    vertices: Array  # (v, 3) at rest
    faces: Faces  # (m, 3)

    def pose(self, turns: Turns, shift: Vector = (0, 0, 0)) -> Array:
        """Vertices (v, 3) with these turns, the roots shifted."""
        motions: dict[str, Array] = {}
        for name, bone in self.bones.items():
            parent = motions[bone.parent] if bone.parent else _translation(np.array(shift))
            start = np.array(bone.start)
            about = _translation(start) @ _turn(turns.get(name, (0, 0, 0))) @ _translation(-start)
            motions[name] = parent @ about
        blended = np.einsum("kv,kij->vij", self._weights, np.stack(list(motions.values())))
        return np.einsum("vij,vj->vi", blended[:, :3, :3], self.vertices) + blended[:, :3, 3]

    def _distances(self, points: Array) -> Array:
        return np.stack(
            [
                capsule(points, np.array(bone.start), np.array(bone.end), bone.radii)
                for bone in self.bones.values()
            ]
        )


def _translation(by: Array) -> Array:
    matrix = np.eye(4)
    matrix[:3, 3] = by
    return matrix


def _turn(degrees: Vector) -> Array:
    """About x, then y, then z."""
    matrix = np.eye(4)
    for axis, angle in enumerate(np.radians(degrees)):
        one = np.eye(4)
        i, j = (axis + 1) % 3, (axis + 2) % 3
        one[i, i] = one[j, j] = np.cos(angle)
        one[j, i] = np.sin(angle)
        one[i, j] = -one[j, i]
        matrix = one @ matrix
    return matrix
