# SPDX-License-Identifier: GPL-3.0-or-later
"""How well dots render a picture, and the classical ways to place them.

One definition for every method: the picture's darkness, 1 - value, and the dots are blurred by a
Gaussian of 4 pixels, mirrored at the border, and compared by PSNR and SSIM (scikit-image, data
range 1). A dot is a point; all have the same weight, such that they sum to the darkness of the
picture, and each is shared bilinearly by the four pixels around it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from dapple3d import stippling
from numpy.typing import NDArray
from skimage.filters import gaussian
from skimage.metrics import peak_signal_noise_ratio, structural_similarity

SIGMA = 4.0  # pixels
Array = NDArray[np.float64]

# What an ink takes from red, green and blue light.
TAKES = 1.0 - np.array([stippling.COLORS[name] for name in stippling.INKS]) / 255.0


class Quality(NamedTuple):
    psnr: float  # dB
    ssim: float


def quality(picture: Array, positions: Array, classes: NDArray[np.int32] | None = None) -> Quality:
    """Compare points with a picture in [0, 1]: gray, or red, green, blue with classes of INKS."""
    darkness = 1.0 - picture
    if classes is None:
        return compare(darkness, darkness.sum() / len(positions) * spread(positions, picture.shape))
    ink = darkness.max(axis=2).sum()  # what the seven inks cover together
    taken = np.zeros_like(darkness)
    for index, takes in enumerate(TAKES):
        mine = spread(positions[classes == index], picture.shape[:2])
        taken += ink / len(positions) * mine[..., None] * takes
    return compare(darkness, taken)


def compare(wanted: Array, found: Array) -> Quality:
    """Blur both and compare; a third axis is color."""
    color = 2 if wanted.ndim == 3 else None
    a, b = (
        gaussian(image, SIGMA, mode="reflect", preserve_range=True, channel_axis=color)
        for image in (wanted, found)
    )
    return Quality(
        float(peak_signal_noise_ratio(a, b, data_range=1.0)),
        float(structural_similarity(a, b, data_range=1.0, channel_axis=color)),
    )


def spread(positions: Array, shape: tuple[int, ...]) -> Array:
    """The number of points at each pixel, each shared by the four whose centers are around it."""
    limit = np.array(shape[1::-1]) - 1.0
    at = np.clip(positions - 0.5, 0.0, limit)
    first = np.minimum(at.astype(int), np.maximum(limit - 1.0, 0.0).astype(int))
    part = at - first
    found = np.zeros(shape)
    for right in (0, 1):
        for down in (0, 1):
            weight = np.abs(1 - right - part[:, 0]) * np.abs(1 - down - part[:, 1])
            column = np.minimum(first[:, 0] + right, shape[1] - 1)
            np.add.at(found, (np.minimum(first[:, 1] + down, shape[0] - 1), column), weight)
    return found


def error_diffusion(picture: Array, count: int) -> Array:
    """Floyd and Steinberg 1976, rows in alternating directions; exactly count dots.

    Errors stay in the picture, so that as many dots come out as its darkness, scaled, asks for.
    """
    darkness = 1.0 - picture
    wanted = (darkness * count / darkness.sum()).tolist()
    rows, columns = picture.shape
    found: list[tuple[float, float]] = []
    for r in range(rows):
        step = 1 if r % 2 == 0 else -1
        for c in range(columns)[::step]:
            lack = wanted[r][c]
            if lack >= 0.5:
                found.append((c + 0.5, r + 0.5))
                lack -= 1.0
            shares = [
                (r + down, c + right * step, weight)
                for down, right, weight in ((0, 1, 7), (1, -1, 3), (1, 0, 5), (1, 1, 1))
                if r + down < rows and 0 <= c + right * step < columns
            ]
            whole = sum(weight for _, _, weight in shares)
            for row, column, weight in shares:
                wanted[row][column] += lack * weight / whole
    if len(found) != count:
        raise ValueError(f"{len(found)} dots came out, not {count}: the picture is too small")
    return np.array(found)


def ordered_dither(picture: Array, count: int) -> Array:
    """Bayer's matrix of 64 x 64; the scale of the darkness is the one that gives count dots."""
    matrix = np.zeros((1, 1))
    while len(matrix) < 64:
        matrix = np.block([[4 * matrix, 4 * matrix + 2], [4 * matrix + 3, 4 * matrix + 1]])
    rows, columns = picture.shape
    tiles = np.tile(matrix + 0.5, (-(-rows // 64), -(-columns // 64)))[:rows, :columns]
    chosen = np.argsort(-((1.0 - picture) / tiles).ravel(), kind="stable")[:count]
    return np.stack([chosen % columns + 0.5, chosen // columns + 0.5], axis=1)


def as_drawn(picture: Array, dots: stippling.Dots, scale: int = 4) -> Quality:
    """The same comparison for the discs as they are drawn, where overlaps lose ink."""
    drawn = stippling.draw(dots, scale) / 255.0
    rows, columns = picture.shape[:2]
    blocks = drawn.reshape(rows, scale, columns, scale, -1).mean(axis=(1, 3))
    return compare(1.0 - picture, 1.0 - blocks.reshape(picture.shape))
