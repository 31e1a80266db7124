# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures as densities: how fine they need to be, and UDIM tiles as one picture.

UDIM tile 1001 + u + 10 v covers the unit square of texture coordinates whose lower left corner is
(u, v), for u from 0 to 9. Where there is no tile the density is 0.
"""

from collections.abc import Sequence

import numpy as np

from .arrays import Flags, Floats, Ints

Tile = tuple[int, Floats]  # its number, and (rows, columns) of densities, row 0 at the bottom
FIRST, ACROSS = 1001, 10
_ROUNDING = 1e-6  # of texture coordinates in single precision


def reduced(image: Floats, most: int) -> Floats:
    """A picture of at most so many rows and columns: means of blocks of pixels."""
    for axis in (0, 1):
        length = image.shape[axis]
        if length > most:
            starts = np.arange(most) * length // most
            sums = np.add.reduceat(image, starts, axis=axis)
            sizes = np.diff(np.append(starts, length))
            image = sums / (sizes[:, None] if axis == 0 else sizes)
    return image


def filled_share(image: Floats) -> float:
    """Mean of a picture over its maximum; at least a thousandth, also where it is black."""
    most = float(image.max())
    return max(float(image.mean()) / most, 1e-3) if most > 0.0 else 1.0


def texture_area(uv: Floats) -> float:
    """Area of faces (m, 3, 2) in texture space: how often they have the whole picture."""
    a, b = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    return float(0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum())


def repeats(uv: Floats) -> bool:
    """Whether faces (m, 3, 2) reach out of the unit square, so that the picture repeats."""
    return float(uv.min()) < -_ROUNDING or float(uv.max()) > 1.0 + _ROUNDING


def squares(tiles: Sequence[Tile]) -> Ints:
    """The lower left corners (t, 2) of the tiles."""
    numbers = np.array([number - FIRST for number, _ in tiles], dtype=np.int32)
    return np.stack([numbers % ACROSS, numbers // ACROSS], axis=1)


def crossing(uv: Floats, tiles: Sequence[Tile]) -> Flags:
    """Which faces (m,) reach over the border of one of the tiles."""
    low = np.floor(uv.min(axis=1) + _ROUNDING)
    high = np.ceil(uv.max(axis=1) - _ROUNDING) - 1.0
    several = (high > low).any(axis=1)
    found = np.zeros(len(uv), dtype=np.bool_)
    for square in squares(tiles):
        found |= ((low <= square) & (square <= high)).all(axis=1)
    return several & found


def laid_out(uv: Floats, tiles: Sequence[Tile]) -> tuple[Floats, Floats]:
    """One picture that holds all tiles, and where on it the faces' corners (m, 3, 2) are.

    A face belongs to the tile that its center is in. Each tile goes on a pixel beyond its border,
    so that nothing of another one is seen there.

    Raises:
        ValueError: no face is in a tile.
    """
    width = 2 + max(picture.shape[1] for _, picture in tiles)
    blocks, places = [], np.zeros_like(uv)
    center = np.floor(uv.mean(axis=1))
    begin = 0
    for square, (_, picture) in zip(squares(tiles), tiles, strict=True):
        rows, columns = picture.shape
        mine = (center == square).all(axis=1)
        within = np.clip(uv[mine] - square, 0.0, 1.0)
        places[mine] = within * (columns, rows) + (1.0, begin + 1.0)
        framed = np.pad(picture, 1, mode="edge")
        blocks.append(np.pad(framed, ((0, 0), (0, width - framed.shape[1]))))
        begin += rows + 2
    blocks.append(np.zeros((3, width)))  # for faces outside of all tiles
    nowhere = ~(center[:, None] == squares(tiles)).all(axis=2).any(axis=1)
    if nowhere.all():
        numbers = ", ".join(str(number) for number, _ in tiles)
        raise ValueError(
            f"the UV map points at none of the image's tiles ({numbers}): no point can be placed"
        )
    places[nowhere] = (1.5, begin + 1.5)
    return np.concatenate(blocks), places / (width, begin + 3.0)
