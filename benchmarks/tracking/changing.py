# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies whose faces change from frame to frame: a fluid, a remeshed body, a tearing cloth."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from benchmarks.tracking.implicit import Array, Faces, blend, capsule, mesh_by_step, step_for

LENGTH = 96  # frames
FACES = 12_000  # about, in the first frame
Mesh = tuple[Array, Faces]


@dataclass(frozen=True)
class Changing:
    """A name, the number of frames, and the mesh of each."""

    name: str
    length: int
    mesh: Callable[[int], Mesh]

    def frames(self) -> Iterator[Mesh]:
        for frame in range(self.length):
            yield self.mesh(frame)


def metaballs(length: int = LENGTH, faces: int = FACES) -> Changing:
    """Three balls: two merge and split again, a small one goes through them."""
    low, high = np.array([-1.6, -1.1, -1.1]), np.array([1.6, 1.1, 1.1])

    def field_of(frame: int) -> Callable[[Array], Array]:
        phase = 2 * np.pi * frame / length
        apart = 0.42 + 0.38 * np.cos(phase)
        small = np.array([0.1, 0.75 * np.cos(phase + 0.6), 0.55])
        balls = [
            (np.array([-apart, 0.03, 0.0]), 0.6),
            (np.array([apart, -0.04, 0.02]), 0.6),
            (small, 0.25),
        ]

        def field(points: Array) -> Array:
            distances = [np.linalg.norm(points - middle, axis=1) - r for middle, r in balls]
            return blend(np.stack(distances), 0.05)

        return field

    step = step_for(field_of(0), low, high, faces)
    return Changing("metaballs", length, lambda k: mesh_by_step(field_of(k), low, high, step))


def remesh(length: int = LENGTH, faces: int = FACES) -> Changing:
    """A body that bends an arm, meshed anew in each frame on a lattice that lies elsewhere."""
    low, high = np.array([-0.9, -0.8, -1.1]), np.array([1.4, 0.8, 1.2])

    def field_of(frame: int) -> Callable[[Array], Array]:
        angle = 0.9 * np.sin(2 * np.pi * frame / length)
        hand = np.array([0.35 + 0.75 * np.cos(angle), 0.0, 0.5 + 0.75 * np.sin(angle)])

        def field(points: Array) -> Array:
            torso = capsule(points, np.array([0, 0, -0.55]), np.array([0, 0, 0.55]), (0.42, 0.38))
            arm = capsule(points, np.array([0.2, 0.0, 0.5]), hand, (0.2, 0.16))
            return blend(np.stack([torso, arm]), 0.05)

        return field

    step = step_for(field_of(0), low, high, faces)

    def mesh(frame: int) -> Mesh:
        shift = step * np.array([0.37, 0.61, 0.23]) * frame % step
        return mesh_by_step(field_of(frame), low - shift, high, step)

    return Changing("remesh", length, mesh)


def tear(length: int = LENGTH, faces: int = FACES) -> Changing:
    """A waving cloth that tears along its middle and stretches beside the tear."""
    cells = 2 * round((faces / 2) ** 0.5 / 2)
    side = np.linspace(0, 1, cells + 1)
    rest = np.stack(np.meshgrid(side, side, indexing="ij"), axis=-1).reshape(-1, 2)
    i, j = (index.ravel() for index in np.indices((cells, cells)))
    a = i * (cells + 1) + j
    b, c, d = a + cells + 1, a + cells + 2, a + 1
    faces_at_rest = np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    right = np.concatenate([i, i]) >= cells // 2

    def mesh(frame: int) -> Mesh:
        torn = 0.8 * np.clip((frame / length - 0.2) / 0.6, 0, 1)
        line = cells // 2 * (cells + 1) + np.arange(cells + 1)
        split = line[side > 1 - torn + 1e-9]
        copies = np.arange(len(rest))
        copies[split] = len(rest) + np.arange(len(split))
        faces_now = faces_at_rest.copy()
        faces_now[right] = copies[faces_now[right]]
        places = np.vstack([rest, rest[split]])
        sign = np.where(places[:, 0] < 0.5, -1.0, 1.0)
        sign[line] = np.where(side > 1 - torn + 1e-9, -1.0, 0.0)
        sign[len(rest) :] = 1.0
        above = np.maximum(places[:, 1] - (1 - torn), 0)
        near = np.exp(-4 * np.abs(places[:, 0] - 0.5))
        wave = np.sin(5 * places[:, 0] + 2 * np.pi * 2 * frame / length)
        x = places[:, 0] + 0.35 * sign * above * near
        z = 0.08 * wave * places[:, 1] + 0.25 * above**2 * near
        return np.column_stack([x, places[:, 1], z]), faces_now.astype(np.int32)

    return Changing("tear", length, mesh)


CHANGING: dict[str, Callable[[int, int], Changing]] = {
    made.__name__: made for made in (metaballs, remesh, tear)
}
