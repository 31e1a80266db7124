# SPDX-License-Identifier: GPL-3.0-or-later
"""Counts of points and sizes of discs, by the part of a surface that its density leaves."""

from dataclasses import replace
from typing import Any

import numpy as np

from ..base.errors import ScatterError
from ..settings.values import Settings

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


def values_of(settings: Settings) -> list[str]:
    """Name of the values that each class has its density from, '' for none: see masked_surface."""
    return [
        cleared_name(index) if kind.stays_inside else kind.density
        for index, kind in enumerate(settings.object_types)
    ]


def cleared_name(index: int) -> str:
    """Name of the values of a class that are 0 near its border."""
    return f"object type {index + 1}, away from borders"
