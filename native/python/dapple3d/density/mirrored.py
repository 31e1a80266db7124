# SPDX-License-Identifier: GPL-3.0-or-later
"""Pairs of mirror images that stay exact where samples move off the border of a density."""

import numpy as np

from .._native import Samples, Surface, SymmetricSamples, project
from .arrays import Floats

_ON_PLANE = 1e-6  # of the size of the samples


def with_exact_images(
    pairs: SymmetricSamples, samples: Samples, surface: Surface, normal: Floats, point: Floats
) -> Samples:
    """Samples of pairs on another surface, where each moved alone, as pairs again.

    Args:
        pairs: as they were sampled.
        samples: the same, on the other surface.
        surface: the other one, of the same shape.
        normal: (3,), of the plane of symmetry; of any length.
        point: (3,), on it.
    """
    before, now, mirror = pairs.samples.positions, np.array(samples.positions), pairs.mirror
    if not len(now):
        return samples
    normal = normal / np.linalg.norm(normal)
    height, tolerance = (now - point) @ normal, _ON_PLANE * np.ptp(before)
    rows = np.arange(len(mirror))
    images = now[mirror] - 2.0 * height[mirror, None] * normal
    on_plane = (mirror == rows) & (np.abs((before - point) @ normal) <= tolerance)
    images[on_plane] = before[on_plane]
    moved = np.linalg.norm(images - now, axis=1) > tolerance
    moved &= on_plane | (mirror < rows)
    if not moved.any():
        return samples
    places = project(surface, images[moved])
    faces, barycentric = np.array(samples.faces), np.array(samples.barycentric)
    faces[moved], barycentric[moved] = places.faces, places.barycentric
    return Samples(surface, faces, barycentric, ids=samples.ids)
