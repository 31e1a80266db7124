# SPDX-License-Identifier: GPL-3.0-or-later
"""What holds for every result."""

import dapple3d as dapple
import numpy as np
from shapes import on_faces

ARRAYS = {
    "positions": (np.float64, (3,)),
    "normals": (np.float64, (3,)),
    "faces": (np.int32, ()),
    "barycentric": (np.float64, (3,)),
    "ids": (np.int32, ()),
    "classes": (np.int32, ()),
}


def check_array(array: np.ndarray, dtype: type, shape: tuple[int, ...]) -> None:
    assert isinstance(array, np.ndarray)
    assert array.dtype == dtype
    assert array.shape == shape
    assert array.flags.c_contiguous
    assert not array.flags.writeable


def check_samples(surface: dapple.Surface, samples: dapple.Samples) -> None:
    count = len(samples)
    for name, (dtype, tail) in ARRAYS.items():
        check_array(getattr(samples, name), dtype, (count, *tail))
    assert samples.report.count == count
    assert len(np.unique(samples.ids)) == count
    if count == 0:
        return
    assert samples.barycentric.min() >= 0
    np.testing.assert_allclose(samples.barycentric.sum(axis=1), 1, atol=1e-14)
    np.testing.assert_allclose(np.linalg.norm(samples.normals, axis=1), 1, atol=1e-12)
    there = on_faces(surface.vertices, surface.faces, samples.faces, samples.barycentric)
    size = np.abs(surface.vertices).max()
    np.testing.assert_allclose(samples.positions, there, rtol=0, atol=1e-13 * size)
    energy = dapple.evaluate_energy(surface, samples.positions, samples.faces)
    extent = np.ptp(surface.vertices[np.unique(surface.faces)], axis=0).max()  # of what is used
    rounding = 1e-10 + 2.0**-48 * size / extent  # larger far from the origin
    assert abs(energy.areas.sum() - surface.area) <= rounding * surface.area
    assert abs(energy.capacities.sum() - surface.capacity) <= rounding * surface.capacity


def is_on_density(surface: dapple.Surface, samples: dapple.Samples) -> np.ndarray:
    """Whether the density is above 0 where each sample (n,) is.

    A point where a face's density falls to exactly 0, such as a corner, does not count: no sample
    may be there, but for a locked one.
    """
    values = surface.density
    if values is None:
        return np.ones(len(samples), dtype=bool)
    if surface.density_at == "faces":
        return values[samples.faces] > 0
    values = values / values.max()  # avoids underflow
    corners = values[surface.faces] if surface.density_at == "vertices" else values
    return (corners[samples.faces] * samples.barycentric).sum(axis=1) > 0


def same_bytes(a: dapple.Samples, b: dapple.Samples) -> bool:
    return all(getattr(a, name).tobytes() == getattr(b, name).tobytes() for name in ARRAYS)
