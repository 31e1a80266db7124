# SPDX-License-Identifier: GPL-3.0-or-later
"""Points evened out near a change, with the right count."""

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


def relaxed(
    masked: MaskedSurface,
    given: Any,
    changed: Ints,
    settings: Settings,
    context: Any,
    locked: Locked | None,
) -> Any:
    wanted = _wanted(masked, settings)
    everything = len(changed) == len(masked.surface.faces)
    if not len(changed) and wanted == len(given):
        return given
    if locked is None and _stranded(masked, given) > _STRANDED:
        return sampled(masked, settings, context)
    if everything or not len(changed) or not len(given):
        return resampled(masked, given, settings, context, locked)
    coming = 0.0 if settings.per_area else _missing_points(masked, given, changed)
    if locked is None and coming > _MOST * wanted:
        return sampled(masked, settings, context)
    if coming > _MANY * wanted:
        return resampled(masked, given, settings, context, locked)
    options = {
        "locked": locked_rows(given, locked),
        "context": context,
        **settings.sample_options(),
    }
    found = package().relax(masked.surface, given, changed, **options)
    missing = abs(len(found) - wanted)
    if missing and missing <= _FEW * np.count_nonzero(~staying(given, found)):
        return package().relax(masked.surface, given, changed, count=wanted, **options)
    return found


def classes_relaxed(
    masked: MaskedSurface,
    given: Any,
    changed: Ints,
    settings: Settings,
    context: Any,
    locked: Locked | None,
) -> Any:
    """Relax several classes near changes; solve again if everything changed."""
    if len(changed) == len(masked.surface.faces) or not len(given):
        return sampled(masked, settings, context, locked)
    if locked is None and _stranded(masked, given) > _STRANDED:
        return sampled(masked, settings, context)
    options = settings.sample_options()
    options["tolerance"] = max(options.get("tolerance", 0.0), _ROUGH)
    return package().relax(
        masked.surface,
        given,
        changed,
        classes=classes_of(masked, settings, wanted_counts(masked, settings)),
        free_counts=True,
        locked=locked_rows(given, locked),
        context=context,
        **options,
    )


def with_counts(
    masked: MaskedSurface, given: Any, settings: Settings, context: Any, locked: Locked | None
) -> Any:
    """Several classes with the right counts, even over the whole surface."""
    return package().relax(
        masked.surface,
        given,
        [],
        classes=classes_of(masked, settings, wanted_counts(masked, settings)),
        locked=locked_rows(given, locked),
        context=context,
        **settings.sample_options(),
    )


def _stranded(masked: MaskedSurface, given: Any) -> float:
    """Share of the points at which the density is now 0."""
    if not len(given):
        return 0.0
    return float((masked.corner_density()[given.faces] == 0.0).all(axis=1).mean())


def without_zero_density(
    masked: MaskedSurface, found: Any, settings: Settings, context: Any, locked: Locked | None
) -> Any:
    """Replace points where the density is 0, except locked ones."""
    for _ in range(_TRIES):
        left = masked.density_at(found) == 0.0
        left[locked_rows(found, locked)] = False
        if not left.any():
            return found
        who = {"ids": found.ids[~left], "classes": found.classes[~left]}
        places = found.faces[~left], found.barycentric[~left]
        rest = package().Samples(masked.surface, *places, **who)
        found = resampled(masked, rest, settings, context, locked)
    return found


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


def evened_around(
    masked: MaskedSurface,
    given: Any,
    faces: Ints,
    settings: Settings,
    context: Any,
    locked: Locked | None,
) -> Any:
    """Even out the same number of points around these faces.

    Points first appear and vanish there, since neighbors alone would leave a ring around removed
    points. Then as many points vanish or appear elsewhere if the neighbors have to change only a
    little for it.
    """

    def relaxed(samples: Any, where: Ints, count: int | None, rows: Ints) -> Any:
        options = settings.sample_options()
        return package().relax(
            masked.surface, samples, where, count=count, locked=rows, context=context, **options
        )

    found = relaxed(given, faces, None, locked_rows(given, locked))
    spare = abs(len(found) - len(given))
    if not spare:
        return found
    away = _distances_from(masked, found, faces)
    nearest = np.argsort(away)[: round(spare / _YIELDS) if spare > _HANDFUL else 0]
    reach = away[nearest].max(initial=0.0) + _RINGS * found.report.spacing
    stay = np.union1d(locked_rows(found, locked), np.flatnonzero(away > reach)).astype(np.int32)
    around = np.union1d(faces, found.faces[nearest]).astype(np.int32)
    return relaxed(found, around, len(given), stay)


def _distances_from(masked: MaskedSurface, samples: Any, faces: Ints) -> Floats:
    """Distances (n,) of samples from the nearest of these faces."""
    middles = masked.surface.vertices[masked.surface.faces[faces]].mean(axis=1)
    ways = [np.linalg.norm(samples.positions - one, axis=1) for one in middles]
    found: Floats = np.min(ways, axis=0)
    return found


def resampled(
    masked: MaskedSurface, given: Any, settings: Settings, context: Any, locked: Locked | None
) -> Any:
    """Even out all points with the right count; only locked points stay."""
    options, wanted = settings.sample_options(), _wanted(masked, settings)
    rows = locked_rows(given, locked)
    return package().resample(
        masked.surface, given, wanted, locked=rows, context=context, **options
    )


def _wanted(masked: MaskedSurface, settings: Settings) -> int:
    """Number of points of a single class."""
    return wanted_counts(masked, settings)[0]


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
