# SPDX-License-Identifier: GPL-3.0-or-later
"""Which instances overlap, by their bounding boxes or convex hulls."""

import bpy
import numpy as np

from ...core.base.native import package
from ...core.export import LongInts
from ..scatter.instance_shapes import InstanceShapes, shapes_of
from ..scatter.shown_instances import check_shown

_SHRUNK = 1e-5  # of an instance's size: those that only touch do not overlap


def overlapping_ids(scatter: bpy.types.Object, shape: str) -> tuple[set[int], int]:
    """Ids of the points whose instances overlap those of other points on the current frame, and
    the number of all points with instances. The shape is BOX or HULL.

    Raises:
        ScatterError: the scatter shows no instances, or has some at places that are not finite.
    """
    shapes, ids = shapes_of(scatter, shape)
    check_shown(scatter, len(ids) > 0)
    return set(np.unique(overlapping_pairs(shapes)).tolist()), len(ids)


def overlapping_pairs(shapes: InstanceShapes) -> LongInts:
    """Ids (k, 2) of two points of which shapes overlap."""
    smaller = shapes.shrunk(_SHRUNK)
    pairs = shapes.ids[package().touching_solids(smaller.points, smaller.counts)].reshape(-1, 2)
    found: LongInts = pairs[pairs[:, 0] != pairs[:, 1]]
    return found
