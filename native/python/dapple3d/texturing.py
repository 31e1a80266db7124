# SPDX-License-Identifier: GPL-3.0-or-later
"""Decals around samples: as instances, or baked into one image through texture coordinates.

>>> from dapple3d import texturing
>>> daisy = texturing.Decal(picture, radius=0.05)  # (h, w, 4) in [0, 1]
>>> image = texturing.bake(surface, uv, samples, [daisy], 1024, 1024)

Chen et al. 2012, section 5.3 and Fig. 16b. Images have row 0 at the bottom, as in Blender.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from operator import index
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._native import Context, Samples, Surface, Texels, decal_cover, texels

__all__ = ["Decal", "bake", "frames", "turns"]

CHANNELS: Final = 4
BAND: Final = 1 << 16  # texels painted between two checks


@dataclass(frozen=True)
class Decal:
    """The image that is painted at the samples of a class.

    image: (h, w, 4) float in [0, 1]: red, green, blue and (not premultiplied) alpha.
    radius: half the side of its square, > 0, in the surface's units.

    Raises:
        ValueError: naming what is out of range.
    """

    image: NDArray[np.floating]
    radius: float

    def __post_init__(self) -> None:
        shape = np.shape(self.image)
        if len(shape) != 3 or shape[2] != CHANNELS or 0 in shape:
            raise ValueError(f"image has the shape {shape}: (h, w, 4) is needed")
        if not (np.min(self.image) >= 0 and np.max(self.image) <= 1):
            raise ValueError("image has values outside 0..1")
        if not 0 < self.radius < np.inf:
            raise ValueError(f"radius is {self.radius}: it must be finite and > 0")


def turns(ids: ArrayLike, seed: int = 0) -> NDArray[np.float64]:
    """An angle in [0, 2 pi) for each id; it depends only on id and seed.

    Args:
        ids: (n,) integers.
        seed: each seed gives other angles.
    """
    with np.errstate(over="ignore"):
        bits = np.asarray(ids).astype(np.uint64) + np.uint64(index(seed) % 2**64) * np.uint64(
            _GOLDEN
        )
        for shift, factor in _ROUNDS:
            bits = (bits ^ (bits >> np.uint64(shift))) * np.uint64(factor)
        bits ^= bits >> np.uint64(31)
    return 2 * np.pi * (bits >> np.uint64(11)).astype(np.float64) * 2.0**-53


_GOLDEN: Final = 0x9E3779B97F4A7C15
_ROUNDS: Final = ((33, 0xFF51AFD7ED558CCD), (33, 0xC4CEB9FE1A85EC53), (29, _GOLDEN))


def frames(samples: Samples, angles: ArrayLike | None = None) -> NDArray[np.float64]:
    """Orientation of an instance at each sample that matches the baked decal.

    Args:
        samples: n Samples.
        angles: (n,) in radians, about the normal; None: turns(samples.ids).

    Returns:
        (n, 3, 3) float64 rotations: the columns are the decal's x axis, its y axis, the normal.
    """
    angle = np.asarray(turns(samples.ids) if angles is None else angles, np.float64)
    x, y = _tangent_basis(samples.normals)
    cosine, sine = np.cos(angle)[:, None], np.sin(angle)[:, None]
    return np.stack([cosine * x + sine * y, cosine * y - sine * x, samples.normals], axis=2)


def bake(
    surface: Surface,
    uv: ArrayLike,
    samples: Samples,
    decals: Sequence[Decal],
    rows: int,
    columns: int,
    *,
    angles: ArrayLike | None = None,
    background: Sequence[float] = (0.0, 0.0, 0.0, 0.0),
    oversampling: int = 2,
    margin: int = 4,
    context: Context | None = None,
) -> NDArray[np.float64]:
    """Paint a decal around each sample into an image.

    Args:
        surface: the Surface.
        uv: (m, 3, 2) texture coordinates of its faces' corners, as for texels().
        samples: Samples on it; those of class c are painted with decals[c].
        decals: one for each class.
        rows: height of the image, in pixels.
        columns: width of the image, in pixels.
        angles: (n,) in radians, as for frames().
        background: red, green, blue, alpha where no decal is.
        oversampling: each pixel is the mean of oversampling^2 samples.
        margin: how far the image extends beyond the faces, in pixels.
        context: a Context for progress and cancel.

    Returns:
        (rows, columns, 4) float64 in [0, 1], alpha not premultiplied.

    Raises:
        ValueError: a class without a decal, or as texels() and decal_cover().
        Cancelled: through the context.
    """
    rows, columns, oversampling, margin = map(index, (rows, columns, oversampling, margin))
    if oversampling < 1:
        raise ValueError(f"oversampling is {oversampling}: it must be at least 1")
    missing = np.flatnonzero((samples.classes < 0) | (samples.classes >= len(decals)))
    if len(missing):
        k = missing[0]
        raise ValueError(f"sample {k} is of class {samples.classes[k]}: decals has {len(decals)}")
    fine = (rows * oversampling, columns * oversampling)
    context = context or Context()
    grid = texels(surface, uv, *fine, margin=margin * oversampling, context=context.part(0.0, 0.2))
    radii = np.array([decal.radius for decal in decals])[samples.classes]
    across = np.ascontiguousarray(frames(samples, angles)[:, :, 0])
    cover = decal_cover(surface, samples, radii, across, grid, context=context.part(0.2, 0.5))
    texel = _texel_size(surface, grid, context)
    pictures = [
        _shrunk(_premultiplied(np.asarray(decal.image, np.float64)), decal.radius, texel)
        for decal in decals
    ]
    behind, painting = np.asarray(background, np.float64), context.part(0.5, 1.0)
    result = np.empty((rows, columns, CHANNELS))
    for band in _bands(rows, columns * oversampling**2, painting):
        texel_rows = slice(band.start * oversampling, band.stop * oversampling)
        painted = _over(_paint([c[texel_rows] for c in cover], samples.classes, pictures), behind)
        parts = painted.reshape(-1, oversampling, columns, oversampling, CHANNELS)
        result[band] = np.clip(_straight(parts.mean(axis=(1, 3))), 0.0, 1.0)
    context.advance(1.0)
    return result


def _bands(rows: int, texels_per_row: int, context: Context) -> Iterator[slice]:
    """All rows, a few at a time; the context is checked and updated between them."""
    step = max(1, BAND // texels_per_row)
    for start in range(0, rows, step):
        context.check()
        context.advance(start / rows)
        yield slice(start, min(start + step, rows))


def _paint(
    cover: Sequence[NDArray[Any]],
    classes: NDArray[np.int32],
    pictures: Sequence[NDArray[np.float64]],
) -> NDArray[np.float64]:
    """(rows, columns, 4), premultiplied."""
    owner, places = cover
    result = np.zeros((*owner.shape, CHANNELS))
    for kind, pixels in enumerate(pictures):
        there = (owner >= 0) & (classes[owner] == kind)
        result[there] = _bilinear(pixels, places[there])
    return result


def _texel_size(surface: Surface, grid: Texels, context: Context) -> float:
    """Mean side of a texel on the surface."""
    count, faces, weights = 0, grid.faces, grid.barycentric
    for band in _bands(len(faces), faces.shape[1], context.part(0.5, 0.5)):
        inside = (faces[band] >= 0) & (weights[band].min(axis=2) >= 0)
        count += int(np.count_nonzero(inside))
    return float(np.sqrt(surface.area / max(1, count)))


def _shrunk(pixels: NDArray[np.float64], radius: float, texel: float) -> NDArray[np.float64]:
    """The image, halved until its pixels are about as large as texels, to prevent aliasing."""
    while min(pixels.shape[:2]) > 1 and 4 * radius / max(pixels.shape[:2]) <= texel:
        even = pixels[: pixels.shape[0] // 2 * 2, : pixels.shape[1] // 2 * 2]
        pixels = (even[::2, ::2] + even[1::2, ::2] + even[::2, 1::2] + even[1::2, 1::2]) / 4
    return pixels


def _bilinear(pixels: NDArray[np.float64], places: NDArray[np.float64]) -> NDArray[np.float64]:
    """(n, 4) of an image at places (n, 2) in [-1, 1], between the centers of its pixels."""
    size = np.array(pixels.shape[1::-1])
    at = np.clip((places + 1) / 2 * size - 0.5, 0, size - 1)
    low = np.minimum(at.astype(np.int64), np.maximum(size - 2, 0))
    high = np.minimum(low + 1, size - 1)
    x, y = (at - low).T[..., None]
    below = (1 - x) * pixels[low[:, 1], low[:, 0]] + x * pixels[low[:, 1], high[:, 0]]
    above = (1 - x) * pixels[high[:, 1], low[:, 0]] + x * pixels[high[:, 1], high[:, 0]]
    result: NDArray[np.float64] = (1 - y) * below + y * above
    return result


def _premultiplied(colors: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.concatenate([colors[..., :3] * colors[..., 3:], colors[..., 3:]], axis=-1)


def _straight(colors: NDArray[np.float64]) -> NDArray[np.float64]:
    alpha = colors[..., 3:]
    return np.concatenate([colors[..., :3] / np.where(alpha > 0, alpha, 1), alpha], axis=-1)


def _over(front: NDArray[np.float64], back: NDArray[np.float64]) -> NDArray[np.float64]:
    return front + (1 - front[..., 3:]) * _premultiplied(back)


def _tangent_basis(
    normals: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Two unit vectors perpendicular to each normal (Duff et al. 2017)."""
    x, y, z = normals.T
    sign = np.where(z < 0, -1.0, 1.0)
    a = -1 / (sign + z)
    b = x * y * a
    first = np.column_stack([1 + sign * x * x * a, sign * b, -sign * x])
    return first, np.column_stack([b, sign + y * y * a, -y])
