# SPDX-License-Identifier: GPL-3.0-or-later
"""Several classes of points: their counts, their clearance, arguments for the package."""

from typing import Any

import numpy as np

from ..base.errors import ScatterError
from ..base.native import package
from ..density.counts import class_counts, cleared_name, counted, shrunk, values_of
from ..density.masked_surface import MaskedSurface
from ..settings.instance_table import REMOVE
from ..settings.values import Settings
from ..surface.arrays import Floats, Ints
from .locked import Locked


def wanted_counts(masked: MaskedSurface, settings: Settings) -> list[int]:
    """The number of points that each class should have; one class if there are no object types.

    Of a class whose points are removed near borders, as many are left as its density leaves.
    """
    sized = counted(masked.surface, shrunk(settings, masked.surface))
    counts = class_counts(sized)
    for index, kind in enumerate(settings.object_types):
        if kind.stays_inside and kind.borders == REMOVE:
            counts[index] = round(counts[index] * masked.cleared_share(cleared_name(index)))
    return counts or [sized.count]


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
    kept = locked or [None] * len(counts)
    densities = map(masked.class_density, values_of(settings))
    return [
        package().SampleClass(count, radius=kind.radius, locked=own, **density)
        for count, own, kind, density in zip(counts, kept, kinds, densities, strict=True)
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
