# SPDX-License-Identifier: GPL-3.0-or-later
"""Masks whose values are known at all places: distances and noise."""

import numpy as np

from .masks import Flags, Mask, mask_of
from .nearest import Nearest, border_of
from .noise import bend, noise
from .settings import DensitySettings
from .surface import Floats, Ints, SurfaceArrays, turn_of

_INNER = 0.58  # farthest that a place of a triangle is from its corners, of its longest edge
_COARSE = 0.25  # of the falloff: where values differ by less over a face, it needs no cut
_SOFT = 2.0  # times as long edges as at a sharp change are good enough where there is a falloff


class Field:
    """A mask by values at places."""

    def __init__(self, mask: Mask) -> None:
        self._mask, self.rides = mask, False
        self.coarseness = _SOFT if mask.fade > 0.0 else 1.0
        self._known: tuple[Floats, Floats] = (np.empty((0, 3)), np.empty(0))

    def at(self, points: Floats) -> Floats:
        """Its values (n,) at places (n, 3)."""
        raise NotImplementedError

    def beyond(self, longest: Floats) -> Floats:
        """How far values in triangles with these longest edges are beyond those at corners."""
        raise NotImplementedError

    def values(self, points: Floats) -> Floats:
        """Factors (n,) of the density there."""
        return self._mask.factors(self._looked_up(points))

    def changes(self, points: Floats, faces: Ints) -> Flags:
        """Which faces (m,) may have places with several factors, so that it matters."""
        values, corners = self._looked_up(points)[faces], points[faces]
        longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
        beyond = self.beyond(longest)
        least, most = values.min(axis=1), values.max(axis=1)
        found: Flags = self._mask.falls(least - beyond, most + beyond)
        found &= most - least + beyond > _COARSE * self._mask.fade
        return found

    def _looked_up(self, points: Floats) -> Floats:
        """Values at places of which many begin with those that were asked for last."""
        places, values = self._known
        count = len(places)
        if not np.array_equal(points[:count], places):
            count = 0
        if count < len(points):
            values = np.concatenate([values[:count], self.at(points[count:])])
            self._known = (points.copy(), values)
        return values[: len(points)]


class Distance(Field):
    """By the distance to meshes and lines."""

    def __init__(self, mask: Mask, nearest: Nearest) -> None:
        super().__init__(mask)
        self._nearest = nearest

    def beyond(self, longest: Floats) -> Floats:
        return _INNER * longest

    def at(self, points: Floats) -> Floats:
        return self._nearest.distances(points)


class Noise(Field):
    """By a noise in the axes of the surface's object, in lengths of the world."""

    def __init__(self, mask: Mask, settings: DensitySettings, matrix: Floats) -> None:
        super().__init__(mask)
        self._size, self._detail = settings.noise_scale, settings.noise_detail
        self._seed, self._origin, self._axes = settings.noise_seed, matrix[:3, 3], turn_of(matrix)

    def beyond(self, longest: Floats) -> Floats:
        return bend(longest / self._size, self._detail)

    def at(self, points: Floats) -> Floats:
        places = _along(points - self._origin, self._axes) / self._size
        return noise(places, self._detail, self._seed)


def fields_of(
    arrays: SurfaceArrays, settings: DensitySettings, first: SurfaceArrays | None = None
) -> list[Field]:
    """What the settings ask for and what has an effect on this surface; of a later frame of a bake
    with its first one, on which border and noise are.
    """
    found: list[Field] = []
    begin = first or arrays
    around, mask = arrays.around, mask_of(settings, "distance")
    if mask is not None and (around.targets or len(around.lines)):
        found.append(Distance(mask, Nearest(around.targets, around.lines, settings.distance_plan)))
    mask = mask_of(settings, "border")
    border = border_of(begin.vertices, begin.faces) if mask else np.empty((0, 2, 3))
    if mask is not None and len(border):
        found.append(_riding(Distance(mask, Nearest((), border)), first))
    mask = mask_of(settings, "noise")
    if mask is not None:
        found.append(_riding(Noise(mask, settings, begin.matrix), first))
    return found


def _riding(field: Field, first: SurfaceArrays | None) -> Field:
    field.rides = first is not None
    return field


def _along(places: Floats, axes: Floats) -> Floats:
    """places @ axes, rounded alike on every machine."""
    x, y, z = places.T
    parts = [x * one[0] + y * one[1] + z * one[2] for one in axes.T]
    found: Floats = np.stack(parts, axis=1)
    return found
