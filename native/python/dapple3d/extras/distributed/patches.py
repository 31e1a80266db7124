# SPDX-License-Identifier: GPL-3.0-or-later
"""Pieces of a surface that is too large to be looked at as a whole."""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal, Protocol, runtime_checkable

import numpy as np
from numpy.typing import DTypeLike, NDArray

from .digests import of_arrays

Place = Literal["vertices", "faces"]
Floats = NDArray[np.float64]
BINS = np.exp2(np.arange(-512, 513) / 4.0)  # bins of densities, four per power of two


@dataclass(frozen=True)
class Patch:
    """Some faces of a surface, with their vertices.

    vertices: (v, 3) float64. faces: (m, 3) int32, into them.
    ids: (m,) int64, increasing: which faces of the whole surface these are.
    density: (v,) or (m,) float64; None is 1 everywhere.
    """

    vertices: Floats
    faces: NDArray[np.int32]
    ids: NDArray[np.int64]
    density: Floats | None = None
    density_at: Place = "vertices"

    def only(self, chosen: NDArray[np.bool_]) -> "Patch":
        """The chosen faces, with the vertices that they have."""
        if chosen.all():
            return self
        used, faces = np.unique(self.faces[chosen], return_inverse=True)
        density = self.density
        if density is not None:
            density = density[used if self.density_at == "vertices" else chosen]
        shaped = faces.reshape(-1, 3).astype(np.int32)
        return Patch(self.vertices[used], shaped, self.ids[chosen], density, self.density_at)

    def digest(self) -> str:
        """What tells it from another one."""
        arrays: dict[str, NDArray] = {"faces": self.faces, "ids": self.ids}
        arrays["vertices"] = self.vertices
        if self.density is not None:
            arrays["density"] = self.density
        return of_arrays(arrays, self.density_at)

    def find(self, ids: NDArray[np.int64]) -> NDArray[np.int32]:
        """Index in the patch of each face of the whole surface; -1 where it has none."""
        if len(self.ids) == 0:
            return np.full(len(ids), -1, np.int32)
        places = np.minimum(np.searchsorted(self.ids, ids), len(self.ids) - 1)
        return np.where(self.ids[places] == ids, places, -1).astype(np.int32)

    def corners(self) -> Floats:
        """(m, 3, 3): the places of the corners of each face."""
        return self.vertices[self.faces]

    def points(self, faces: NDArray[np.int32], barycentric: Floats) -> Floats:
        """Where points on faces of the patch are: the same numbers for any patch around them."""
        corners = self.vertices[self.faces[faces]]
        weights = barycentric[:, :, None]
        first, second, third = (corners[:, k] * weights[:, k] for k in range(3))
        summed: Floats = first + second + third
        return summed

    def corner_densities(self) -> Floats:
        """(m, 3): the density at the corners of each face."""
        if self.density is None:
            return np.ones(self.faces.shape)
        if self.density_at == "vertices":
            return self.density[self.faces]
        return np.repeat(self.density[:, None], 3, axis=1)

    def face_densities(self) -> Floats:
        """The mean density of each face."""
        first, second, third = self.corner_densities().T
        means: Floats = (first + second + third) / 3.0
        return means

    def areas(self) -> Floats:
        """The area of each face."""
        corners = self.corners()
        u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        x = u[:, 1] * v[:, 2] - u[:, 2] * v[:, 1]
        y = u[:, 2] * v[:, 0] - u[:, 0] * v[:, 2]
        z = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
        areas: Floats = 0.5 * np.sqrt(x * x + y * y + z * z)
        return areas


@dataclass(frozen=True)
class Census:
    """What the plan needs to know of a tile.

    capacity: the integral of the density. histogram: of the capacity, by densities; entry k is of
    those from BINS[k - 1]. extent: the largest face's, along the axes of the tiles. digest: of the
    part of the surface.
    """

    capacity: float
    histogram: list[float]
    extent: float
    digest: str


@runtime_checkable
class Tileable(Protocol):
    """A surface that is read in pieces. Workers get a copy by pickle."""

    @property
    def face_count(self) -> int:
        """Number of faces of the whole surface."""

    @property
    def axes(self) -> tuple[int, int]:
        """The coordinates that lie along the rows and the columns of tiles: y and x are (1, 0)."""

    def lines(self, rows: int, columns: int) -> tuple[Floats, Floats]:
        """Positions of the borders between so many tiles, rows first, increasing.

        Returns:
            rows + 1 and columns + 1 coordinates at most: fewer if there cannot be as many tiles.
        """

    def read(self, rows: tuple[float, float], columns: tuple[float, float]) -> Patch:
        """At least the faces whose middle is within the borders; others need not be left out."""

    def describe(self) -> dict[str, Any]:
        """What tells it from another surface, for JSON; its 'name' does not.

        Where 'content' holds digests, nothing else is looked at to see whether a run goes on with
        the surface that it was begun with; without it each part of the surface is read.
        """


def check_real(name: str, kind: DTypeLike) -> None:
    """What an array holds.

    Raises:
        ValueError: no real numbers.
    """
    kind = np.dtype(kind)
    if kind.kind not in "biuf":
        raise ValueError(f"{name} holds {kind.name}: real numbers are needed")


def check_density(
    values: NDArray, first: tuple[int, ...] = (0,), counted: NDArray[np.bool_] | bool = True
) -> None:
    """A part of a density that begins at an index.

    Args:
        counted: those that are looked at.

    Raises:
        ValueError: naming the first that is not finite or below 0 by its index in the whole.
    """
    wrong = np.argwhere(counted & ~(np.isfinite(values) & (values >= 0.0)))
    if len(wrong):
        index = ", ".join(str(a + b) for a, b in zip(first, wrong[0], strict=True))
        value = values[tuple(wrong[0])]
        raise ValueError(f"density[{index}] is {value:g}: it must be finite and >= 0")


def middles(patch: Patch, axis: int) -> Floats:
    """Where the middle of each face is along an axis."""
    first, second, third = (patch.vertices[patch.faces[:, k], axis] for k in range(3))
    means: Floats = (first + second + third) / 3.0
    return means


def census(patch: Patch, axes: tuple[int, int]) -> Census:
    """Sums that do not depend on the machine."""
    densities = patch.face_densities()
    masses = patch.areas() * densities
    counted = masses > 0.0
    bins = np.digitize(densities[counted], BINS)
    order = np.argsort(bins, kind="stable")
    ends = np.searchsorted(bins[order], np.arange(len(BINS) + 2))
    sorted_masses = masses[counted][order].tolist()
    histogram = [math.fsum(sorted_masses[a:b]) for a, b in pairwise(ends)]
    corners = patch.corners()[counted][:, :, list(axes)]
    extent = float(np.ptp(corners, axis=1).max(initial=0.0))
    return Census(math.fsum(histogram), histogram, extent, patch.digest())
