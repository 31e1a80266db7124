# SPDX-License-Identifier: GPL-3.0-or-later
"""Corners of convex hulls: few, and all points are between them."""

import addon_host
import numpy as np
import pytest
from scipy.optimize import linprog

shapes = addon_host.part("blender.scatter.instance_shapes")
RANDOM = np.random.default_rng(3)
TURN = np.linalg.qr(RANDOM.normal(size=(3, 3)))[0]
CLOUD = RANDOM.normal(size=(300, 3))
CLOUDS = {
    "cloud": CLOUD,
    "flat": CLOUD * [1, 1, 0],
    "flat and turned": CLOUD * [1, 1, 0] @ TURN,
    "thin and turned": CLOUD * [1, 1, 1e-6] @ TURN,
    "line": CLOUD[:, :1] * [1, 2, 3],
    "point": np.ones((20, 3)),
    "far away": CLOUD + 1e5,
    "large": 1e5 * CLOUD,
    "small": 1e-4 * CLOUD,
    "few": CLOUD[:5],
    "none": CLOUD[:0],
}


def is_between(corner, kept, slack):
    """Whether a place is a mixture of others, up to a length, by linear programming."""
    count = len(kept)
    mixed = np.vstack([kept.T - corner[:, None], -kept.T + corner[:, None]])
    found = linprog(
        np.zeros(count), A_ub=mixed, b_ub=np.full(6, slack), A_eq=np.ones((1, count)), b_eq=[1.0]
    )
    return found.status == 0


@pytest.mark.parametrize("name", CLOUDS)
def test_all_points_are_between_the_corners(name):
    points = CLOUDS[name]
    kept = shapes.hull_corners(points)
    assert {tuple(one) for one in kept} <= {tuple(one) for one in points}
    size = float(np.ptp(points, axis=0).max()) if len(points) else 0.0
    middle = points.mean(axis=0) if len(points) else 0.0
    scaled, own = (points - middle) / max(size, 1e-30), (kept - middle) / max(size, 1e-30)
    assert all(is_between(one, own, 1e-5) for one in scaled[:60])
    if name in ("cloud", "large", "small"):
        assert len(kept) < 80
