# SPDX-License-Identifier: GPL-3.0-or-later
"""Several classes of points: their counts, their clearance, arguments for the package."""

from dataclasses import replace
from typing import Any

import numpy as np

from ..base.errors import ScatterError
from ..base.native import package
from ..density.masked_surface import MaskedSurface
from ..settings.values import Settings
from ..surface.arrays import Floats, Ints
from .locked import Locked

MOST_POINTS = 20_000_000
_PACKED = 0.55  # share of the surface that discs of different sizes can cover


def class_counts(settings: Settings) -> list[int]:
    """Points of each class: exact counts, and the rest of the total by largest remainders.

    If every class has an exact count, their sum replaces the total.

    Raises:
        ScatterError: the exact counts exceed the total.
    """
    counts = [kind.count for kind in settings.object_types]
    shares = [0.0 if kind.count else kind.weight for kind in settings.object_types]
    rest, total = settings.count - sum(counts), sum(shares)
    if all(counts) or not settings.object_types:
        return counts
    if rest < 0:
        raise ScatterError(
            f"The exact counts of the object types add up to {sum(counts):,} points, Count is "
            f"{settings.count:,}: increase it, or reduce them"
        )
    if rest and not total:
        raise ScatterError(f"{rest:,} points have no object type: all weights are 0")
    quotas = [rest * share / total if total else 0.0 for share in shares]
    given = [int(quota) for quota in quotas]
    order = sorted(range(len(quotas)), key=lambda k: (given[k] - quotas[k], k))
    for k in order[: rest - sum(given)]:
        given[k] += 1
    return [count + more for count, more in zip(counts, given, strict=True)]


def counted(surface: Any, settings: Settings) -> Settings:
    """The settings with the count from points per area on a dapple.Surface.

    Raises:
        ScatterError: the count is too large.
    """
    return with_area(settings, surface.capacity) if settings.per_area else settings


def with_area(settings: Settings, capacity: float) -> Settings:
    """The settings with the count from points per area on a surface of this capacity.

    Raises:
        ScatterError: the count is too large.
    """
    count = round(settings.per_area * capacity)
    if count > MOST_POINTS:
        raise ScatterError(
            f"{settings.per_area:g} points per area are {count:,} points on this surface: "
            f"at most {MOST_POINTS:,} are possible"
        )
    return replace(settings, count=max(count, 1))


def shrunk(settings: Settings, surface: Any) -> Settings:
    """The settings with smaller discs of shrinkable classes, so that all fit on a dapple.Surface.

    Their instances get less clearance.
    """
    if not any(kind.shrinks for kind in settings.object_types):
        return settings
    counts = class_counts(counted(surface, settings))
    areas = [
        count * np.pi * kind.radius**2
        for count, kind in zip(counts, settings.object_types, strict=True)
    ]
    rigid = sum(
        area for area, kind in zip(areas, settings.object_types, strict=True) if not kind.shrinks
    )
    left, requested = max(_PACKED * surface.area - rigid, 0.0), sum(areas) - rigid
    factor = np.sqrt(left / requested) if requested > left else 1.0
    classes = [
        replace(kind, radius=factor * kind.radius, max_clearance=factor * kind.max_clearance)
        if kind.shrinks
        else kind
        for kind in settings.object_types
    ]
    return replace(settings, object_types=tuple(classes))


def wanted_counts(masked: MaskedSurface, settings: Settings) -> list[int]:
    """The number of points that each class should have; one class if there are no object types."""
    sized = counted(masked.surface, shrunk(settings, masked.surface))
    return class_counts(sized) or [sized.count]


def sampled(
    masked: MaskedSurface, settings: Settings, context: Any, locked: Locked | None = None
) -> Any:
    """dapple.Samples of one class, or of the classes in the settings.

    Locked points come first in their class.

    Raises:
        ScatterError: a class has fewer points than are locked.
    """
    options = settings.sample_options()
    counts = wanted_counts(masked, settings)
    groups = locked.of_classes(counts) if locked else [None] * len(counts)
    kept = [None if one is None else one.samples(masked.surface) for one in groups]
    if not settings.object_types:
        return package().sample(
            masked.surface, counts[0], context=context, locked=kept[0], **options
        )
    classes = classes_of(masked, settings, counts, kept)
    return package().sample_classes(masked.surface, classes, context=context, **options)


def tracked(masked: MaskedSurface, samples: Any, settings: Settings) -> Any:
    """A dapple.Tracker that keeps the classes even, each by itself and together."""
    options = settings.tracker_options() | of_classes(masked, samples, settings)
    return package().Tracker(masked.surface, samples, **options)


def resumed_on(
    tracker: Any,
    masked: MaskedSurface,
    vertices: Floats,
    samples: tuple[Any, Any],
    settings: Settings,
    anywhere: bool,
) -> None:
    """Move a tracker to another surface, at these refined vertices.

    The samples are those of the last frame and of the first frame there. They can move freely, or
    only where the density pushes them.
    """
    now, first = samples
    classes = of_classes(masked, now, settings)
    tracker.resume_on(
        masked.surface, masked.vertices(vertices), now, first, anywhere=anywhere, **classes
    )


def of_classes(masked: MaskedSurface, samples: Any, settings: Settings) -> dict[str, Any]:
    """The option `classes` for functions that move dapple.Samples; empty for one class.

    Raises:
        ScatterError: samples have a class that is not in the settings.
    """
    if not settings.object_types:
        return {}
    counts = _counts_of(samples.classes, settings)
    return {"classes": classes_of(masked, settings, counts)}


def classes_of(
    masked: MaskedSurface, settings: Settings, counts: list[int], locked: list[Any] | None = None
) -> list[Any]:
    """A dapple.SampleClass with its count for each class in the settings."""
    kinds = shrunk(settings, masked.surface).object_types
    return [
        package().SampleClass(
            count, radius=kind.radius, locked=kept, **masked.class_density(kind.density)
        )
        for count, kept, kind in zip(counts, locked or [None] * len(counts), kinds, strict=True)
    ]


def _counts_of(classes: Ints, settings: Settings) -> list[int]:
    found = np.bincount(classes, minlength=len(settings.object_types)).tolist()
    if len(found) > len(settings.object_types):
        raise ScatterError(
            f"There are points of object type {len(found)}, the list has "
            f"{len(settings.object_types)}: optimize the scatter"
        )
    return found


def largest_scale(scale: float, growth: float, density_scale: float) -> float:
    """Largest scale of instances with a random scale and a scale by density."""
    return abs(scale) * (1.0 + growth) * max(1.0, 1.0 - density_scale)


def clearances(points: Floats, classes: Ints, settings: Settings) -> Floats:
    """Half the distance (n,) to the nearest point of the same class, limited by the class.

    Instances of this radius do not overlap others of their class. 0 if unknown.
    """
    found = np.zeros(len(points))
    for kind in np.unique(classes):
        rows = np.flatnonzero(classes == kind)
        distances = package().nearest_distances(points[rows])
        found[rows] = np.where(np.isfinite(distances), 0.5 * distances, 0.0)
    for index, own in enumerate(settings.object_types):
        if own.max_clearance > 0.0:
            rows = classes == index
            found[rows] = np.where(found[rows] > 0.0, found[rows], np.inf)
            found[rows] = np.minimum(found[rows], own.max_clearance)
    return found
