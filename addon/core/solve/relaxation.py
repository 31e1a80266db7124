# SPDX-License-Identifier: GPL-3.0-or-later
"""Points evened out near a change, with the right count."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.native import package
from ..density.masked_surface import MaskedSurface
from ..settings.values import Settings
from ..surface.arrays import Floats, Ints
from .class_counts import classes_of, sampled, wanted_counts
from .locked import Locked

_ROUGH = 5e-4  # tolerance of classes before their counts are corrected
_HANDFUL = 3  # points that can appear or vanish at a place without moving many others
_RINGS = 3.0  # distance in spacings within which others make room for them
_YIELDS = 0.015  # share of its area that a point gives up for others
_FEW = 0.02  # tolerated deviation of the count, relative to the moving points
_TRIES = 4  # attempts to have no point where the density is 0
_STRANDED = 0.5  # share of points without density above which all are placed again
_MOST = 1.0  # share of missing points above which all are placed again
_MANY = 0.05  # share of missing points above which all are moved at once


@dataclass(frozen=True)
class Relaxer:
    """Evens out samples of a surface that are there already; locked ones stay."""

    masked: MaskedSurface
    settings: Settings
    context: Any
    locked: Locked | None

    def relaxed(self, given: Any, changed: Ints) -> Any:
        """Even out samples near the changed faces. The count may differ from the exact one."""
        if self.settings.object_types:
            return self._classes_relaxed(given, changed)
        return self._without_zero_density(self._relaxed(given, changed))

    def with_counts(self, given: Any) -> Any:
        """Even out samples over the whole surface, with the right counts."""
        if self.settings.object_types:
            return self._relax(given, [], classes=self._classes())
        return self._without_zero_density(self._resampled(given))

    def evened_around(self, given: Any, faces: Ints) -> Any:
        """Even out the same number of samples of a single class around these faces.

        Samples first appear and vanish there, since neighbors alone would leave a ring around
        removed ones. Then as many vanish or appear elsewhere if the neighbors have to change only a
        little for it.
        """
        found = self._relax(given, faces)
        spare = abs(len(found) - len(given))
        if spare:
            found = self._with_count_around(found, faces, len(given), spare)
        return self._without_zero_density(found)

    def _with_count_around(self, found: Any, faces: Ints, count: int, spare: int) -> Any:
        away = _distances_from(self.masked, found, faces)
        nearest = np.argsort(away)[: round(spare / _YIELDS) if spare > _HANDFUL else 0]
        reach = away[nearest].max(initial=0.0) + _RINGS * found.report.spacing
        stay = np.union1d(self._locked_rows(found), np.flatnonzero(away > reach)).astype(np.int32)
        around = np.union1d(faces, found.faces[nearest]).astype(np.int32)
        return self._relax(found, around, count=count, locked=stay)

    def _relaxed(self, given: Any, changed: Ints) -> Any:
        """Relax a single class near changes; solve again if most samples would move anyway."""
        wanted = self._wanted()
        everything = len(changed) == self.masked.face_count
        if not len(changed) and wanted == len(given):
            return given
        if self.locked is None and _stranded(self.masked, given) > _STRANDED:
            return self._sampled()
        if everything or not len(changed) or not len(given):
            return self._resampled(given)
        coming = 0.0
        if not self.settings.per_area:
            coming = _missing_points(self.masked, given, changed)
        if self.locked is None and coming > _MOST * wanted:
            return self._sampled()
        if coming > _MANY * wanted:
            return self._resampled(given)
        found = self._relax(given, changed)
        missing = abs(len(found) - wanted)
        if missing and missing <= _FEW * np.count_nonzero(~staying(given, found)):
            return self._relax(given, changed, count=wanted)
        return found

    def _classes_relaxed(self, given: Any, changed: Ints) -> Any:
        """Relax several classes near changes; solve again if everything changed."""
        if len(changed) == self.masked.face_count or not len(given):
            return self._sampled()
        if self.locked is None and _stranded(self.masked, given) > _STRANDED:
            return self._sampled()
        tolerance = max(self.settings.sample_options().get("tolerance", 0.0), _ROUGH)
        own = self._classes()
        return self._relax(given, changed, classes=own, free_counts=True, tolerance=tolerance)

    def _without_zero_density(self, found: Any) -> Any:
        """Replace samples where the density is 0, except locked ones."""
        for _ in range(_TRIES):
            left = self.masked.density_at(found) == 0.0
            left[self._locked_rows(found)] = False
            if not left.any():
                return found
            who = {"ids": found.ids[~left], "classes": found.classes[~left]}
            places = found.faces[~left], found.barycentric[~left]
            found = self._resampled(package().Samples(self.masked.surface, *places, **who))
        return found

    def _relax(self, given: Any, changed: Any, **options: Any) -> Any:
        own = {"locked": self._locked_rows(given), "context": self.context}
        options = {**self.settings.sample_options(), **own, **options}
        return package().relax(self.masked.surface, given, changed, **options)

    def _resampled(self, given: Any) -> Any:
        """Even out all samples with the right count."""
        return package().resample(
            self.masked.surface,
            given,
            self._wanted(),
            locked=self._locked_rows(given),
            context=self.context,
            **self.settings.sample_options(),
        )

    def _sampled(self) -> Any:
        """New samples, around locked ones."""
        return sampled(self.masked, self.settings, self.context, self.locked)

    def _classes(self) -> Any:
        counts = wanted_counts(self.masked, self.settings)
        return classes_of(self.masked, self.settings, counts)

    def _wanted(self) -> int:
        """Number of samples of a single class."""
        return wanted_counts(self.masked, self.settings)[0]

    def _locked_rows(self, samples: Any) -> Ints:
        return locked_rows(samples, self.locked)


def _stranded(masked: MaskedSurface, given: Any) -> float:
    """Share of the points at which the density is now 0."""
    if not len(given):
        return 0.0
    return float((masked.corner_density()[given.faces] == 0.0).all(axis=1).mean())


def _missing_points(masked: MaskedSurface, given: Any, changed: Ints) -> float:
    """Estimated number of points that the changed faces need."""
    corners = masked.surface.vertices[masked.surface.faces]
    sides = corners[:, 1:] - corners[:, :1]
    areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    capacities = areas * masked.corner_density().mean(axis=1)
    inside = np.count_nonzero(np.isin(given.faces, changed))
    capacity = float(capacities[changed].sum())
    rest = float(capacities.sum()) - capacity
    return capacity / rest * (len(given) - inside) - inside if rest > 0.0 else float(len(given))


def _distances_from(masked: MaskedSurface, samples: Any, faces: Ints) -> Floats:
    """Distances (n,) of samples from the nearest of these faces."""
    middles = masked.surface.vertices[masked.surface.faces[faces]].mean(axis=1)
    ways = [np.linalg.norm(samples.positions - one, axis=1) for one in middles]
    found: Floats = np.min(ways, axis=0)
    return found


def locked_rows(samples: Any, locked: Locked | None) -> Ints:
    """Rows of the locked samples."""
    ids = np.empty(0, dtype=np.int32) if locked is None else locked.ids
    return np.flatnonzero(np.isin(samples.ids, ids)).astype(np.int32)


def old_rows(given: Any, found: Any) -> Ints:
    """Previous rows (n,) of samples; -1 for new ones."""
    order = np.argsort(given.ids)
    place = np.searchsorted(given.ids, found.ids, sorter=order)
    rows = order[np.minimum(place, len(order) - 1)] if len(order) else np.zeros(len(found), int)
    there = given.ids[rows] == found.ids if len(order) else np.zeros(len(found), bool)
    return np.where(there, rows, -1).astype(np.int32)


def staying(given: Any, found: Any) -> NDArray[np.bool_]:
    """Which samples (n,) have not moved."""
    rows = old_rows(given, found)
    there = rows >= 0
    there[there] = (found.positions[there] == given.positions[rows[there]]).all(axis=1)
    return there
