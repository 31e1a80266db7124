# SPDX-License-Identifier: GPL-3.0-or-later
"""A remesh on a surface that deforms: the same vertices and triangles on all frames."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._native import Context, RemeshResult, Samples, Surface, Tracker, option_table

LEAST_ANGLE = 20.0  # degrees
SLIVER = 15.0  # degrees; thinner triangles are counted
WORSE = 1e-9  # least growth of a cosine that counts
LATTICE = ("capacity_weight", "repulsion_weight")  # the energy is that of remesh()

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class MovedMesh:
    """A remesh on one frame of a motion; its triangles are those of the first one.

    Attributes:
        vertices: (n, 3) float64.
        source_faces: (n,) int32, the face of the surface that each vertex lies on.
        barycentric: (n, 3) float64, where in that face.
        smallest_angle: of all triangles, in degrees.
        mean_smallest_angle: mean of the triangles' smallest angles, in degrees.
        below_15: number of triangles with an angle below 15 degrees.
        flipped: number of triangles that face away from the surface.
        held: number of vertices within faces that did not slide, for the sake of triangles.
    """

    vertices: Floats
    source_faces: NDArray[np.int32]
    barycentric: Floats
    smallest_angle: float
    mean_smallest_angle: float
    below_15: int
    flipped: int
    held: int

    def figures(self) -> dict[str, Any]:
        """The figures by name, without the arrays."""
        names = ("smallest_angle", "mean_smallest_angle", "below_15", "flipped", "held")
        return {name: getattr(self, name) for name in names}


class MeshTracker:
    """Keeps the vertices of a remesh evenly spaced on a surface that deforms.

    On each frame the vertices move with the surface and are spaced evenly again, as by Tracker.
    Those on creases, borders and marked edges stay in their places of the surface. So does any
    other vertex whose slide would make an angle of a triangle below `least_angle` smaller, so that
    triangles become thin by the deformation alone. Triangles never change.

    >>> tracker = dapple.MeshTracker(surface, dapple.remesh(surface, 2000))
    >>> moved = tracker.advance(next_vertices)
    >>> moved.vertices, moved.below_15

    Args:
        surface: the Surface of the first frame.
        mesh: RemeshResult of that surface, by remesh().
        least_angle: degrees, 0..60. At 0 slides only never turn a triangle over, at 60 few vertices
            slide.
        context: a Context for cancellation.
        options: of Tracker, without `classes`; the weights of the energy are those of remesh() by
            default.

    Raises:
        ValueError: a mesh that is not of the surface, or an option out of range.
        Cancelled: through the context.
    """

    def __init__(
        self,
        surface: Surface,
        mesh: RemeshResult,
        *,
        least_angle: float = LEAST_ANGLE,
        context: Context | None = None,
        **options: Any,
    ) -> None:
        if not 0.0 <= least_angle <= 60.0:
            raise ValueError(f"least_angle is {least_angle}: it must be in 0..60")
        if "classes" in options:
            raise ValueError("classes are given: the vertices of a mesh are of one class")
        self.faces: NDArray[np.int32] = np.asarray(mesh.faces)
        """(m, 3) int32: the triangles, the same on all frames."""
        if mesh.density is not None:
            surface = surface.with_density(mesh.density, density_at="corners")
        samples = Samples(surface, mesh.source_faces, mesh.barycentric)
        defaults = {one.name: one.default for one in option_table("remesh") if one.name in LATTICE}
        self._tracker = Tracker(surface, samples, context=context, **defaults | options)
        self._pinned: Flags = np.asarray(mesh.features) != 0
        self._limit = math.cos(math.radians(least_angle))
        self._sides = np.ones(len(self.faces))
        _, outward = self._shapes(surface, samples)
        self._sides[outward < 0.0] = -1.0  # as they face on the first frame
        self._first = self._described(surface, samples, 0)
        self._last = samples

    @property
    def first(self) -> MovedMesh:
        """The mesh on the first frame."""
        return self._first

    def advance(self, vertices: ArrayLike, *, context: Context | None = None) -> MovedMesh:
        """The mesh on the next frame. The tracker is unchanged if this raises.

        Args:
            vertices: (v, 3) float64, one for each vertex of the surface.
            context: a Context for progress and cancellation.

        Raises:
            SurfaceError: vertices of another number or not finite.
            Cancelled: through the context.
        """
        before = self._last
        found = self._tracker.advance(vertices, context=context)
        surface = self._tracker.surface
        kept, stays = self._held(surface, found, before)
        if stays.any():
            self._tracker.resume(vertices, kept, settled=self._tracker.settled)
        self._last = kept
        return self._described(surface, kept, int((stays & ~self._pinned).sum()))

    def _held(self, surface: Surface, found: Samples, before: Samples) -> tuple[Samples, Flags]:
        """The samples, some of which stay in their places of the surface, and which do."""
        carried = Samples(surface, before.faces, before.barycentric, ids=found.ids)
        limits = np.maximum(self._cosines(surface, carried) + WORSE, self._limit)
        stays = self._pinned.copy()
        while True:
            faces = np.where(stays, before.faces, found.faces).astype(np.int32)
            places = np.where(stays[:, None], before.barycentric, found.barycentric)
            kept = Samples(surface, faces, places, ids=found.ids)
            worse = self._cosines(surface, kept) > limits
            more = np.zeros(len(stays), dtype=bool)
            more[self.faces[worse]] = True
            if not (more & ~stays).any():
                return kept, stays
            stays |= more

    def _cosines(self, surface: Surface, samples: Samples) -> Floats:
        """Cosines (m,) of the smallest angles; above 1 for triangles that face away."""
        cosines, outward = self._shapes(surface, samples)
        return np.where(outward < 0.0, 3.0 - cosines, cosines)  # the thinner, the less bad

    def _shapes(self, surface: Surface, samples: Samples) -> tuple[Floats, Floats]:
        """Cosines (m,) of the smallest angles, and how far triangles face outward."""
        corners = np.asarray(samples.positions)[self.faces]
        sides = np.roll(corners, -1, axis=1) - corners
        lengths = np.maximum(np.sqrt((sides * sides).sum(axis=2)), 1e-300)
        others = np.roll(sides, 1, axis=1)
        cosines = -(sides * others).sum(axis=2) / (lengths * np.roll(lengths, 1, axis=1))
        normals = np.cross(sides[:, 0], sides[:, 1])
        below = _normals(surface, np.asarray(samples.faces))[self.faces].sum(axis=1)
        return cosines.max(axis=1), self._sides * (normals * below).sum(axis=1)

    def _described(self, surface: Surface, samples: Samples, held: int) -> MovedMesh:
        cosines, outward = self._shapes(surface, samples)
        angles = np.degrees(np.arccos(np.clip(cosines, -1.0, 1.0)))
        return MovedMesh(
            np.asarray(samples.positions),
            np.asarray(samples.faces),
            np.asarray(samples.barycentric),
            smallest_angle=float(angles.min(initial=60.0)),
            mean_smallest_angle=float(angles.mean()) if len(angles) else 60.0,
            below_15=int((angles < SLIVER).sum()),
            flipped=int((outward < 0.0).sum()),
            held=held,
        )


def _normals(surface: Surface, faces: NDArray[np.int32]) -> Floats:
    """Unit normals (n, 3) of some faces of a surface."""
    a, b, c = (surface.vertices[surface.faces[faces, k]] for k in range(3))
    found = np.cross(b - a, c - a)
    lengths = np.sqrt((found * found).sum(axis=1))
    normals: Floats = found / np.maximum(lengths, 1e-300)[:, None]
    return normals
