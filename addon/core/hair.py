# SPDX-License-Identifier: GPL-3.0-or-later
"""Hair guides: which points of a scatter get one, where its root is, and its points.

Blender's node Deform Curves on Surface moves hair from the mesh without modifiers and shape keys to
the evaluated one, and finds a root on both by its texture coordinates. So guides are made on the
former, the base.
"""

import numpy as np

from .base.native import named, package
from .surface.arrays import Floats, Ints, SurfaceArrays
from .surface.binding import binding_of, bound_nearest, samples_of
from .surface.frames import shading
from .surface.records import Binding


def first_points(ranks: Floats, ids: Ints, count: int) -> Ints:
    """Rows of the first points in the progressive order, in that order; all if the count is 0."""
    order = np.lexsort((ids, ranks))
    return (order[:count] if count else order).astype(np.int32)


def on_base(binding: Binding, now: SurfaceArrays, base: SurfaceArrays) -> Binding:
    """The binding of points of the evaluated surface to its base.

    If the modifiers change the faces, the points are the nearest ones to their places on the rest
    shape, which the evaluated surface must have.
    """
    with named(base.name):
        if now.rest is None:
            native = package().Surface(base.vertices, base.faces)
            ids = np.arange(len(binding.corners), dtype=np.int32)
            return binding_of(samples_of(binding, native, ids, np.zeros_like(ids)), base)
        rest = now.rest @ base.matrix[:3, :3].T + base.matrix[:3, 3]
        return bound_nearest(binding.positions(rest), base)


def straight_curves(base: SurfaceArrays, roots: Binding, length: float, points: int) -> Floats:
    """Points (n, points, 3) in world space of straight curves along the normals at their roots."""
    steps = np.linspace(0.0, length, points)[:, None]
    begin, along = roots.positions(base.vertices), shading(base).at(roots)
    return begin[:, None] + steps * along[:, None]
