# SPDX-License-Identifier: GPL-3.0-or-later
"""How much room the points have: what instances are fitted to."""

import numpy as np

from ..base.native import package
from ..settings.values import Settings
from ..surface.arrays import Floats, Ints


def largest_scale(scale: float, growth: float, density_scale: float) -> float:
    """Of instances with a random scale up and a scale by density."""
    return abs(scale) * (1.0 + growth) * max(1.0, 1.0 - density_scale)


def rooms(points: Floats, classes: Ints, settings: Settings) -> Floats:
    """Half the distance (n,) to the nearest point of the same class, at most what the class says.

    So instances that are as large do not overlap others of their class. 0: not known.
    """
    found = np.zeros(len(points))
    for kind in np.unique(classes):
        rows = np.flatnonzero(classes == kind)
        distances = package().nearest_distances(points[rows])
        found[rows] = np.where(np.isfinite(distances), 0.5 * distances, 0.0)
    for index, own in enumerate(settings.classes):
        if own.most_room > 0.0:
            rows = classes == index
            found[rows] = np.where(found[rows] > 0.0, found[rows], np.inf)
            found[rows] = np.minimum(found[rows], own.most_room)
    return found
