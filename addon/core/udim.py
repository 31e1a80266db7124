# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures in UDIM tiles: tile 1001 + u + 10 v covers the unit square of texture coordinates whose
lower left corner is (u, v), for u in 0..9. Where there is no tile the density is 0."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .errors import ScatterError
from .surface import Floats, Ints

Tile = tuple[int, Floats]  # its number, and (rows, columns) of densities, row 0 at the bottom
FIRST, ACROSS = 1001, 10
_ROUNDING = 1e-6  # of texture coordinates, which are stored in single precision


def squares(tiles: Sequence[Tile]) -> Ints:
    """The lower left corners (t, 2) of the tiles."""
    numbers = np.array([number - FIRST for number, _ in tiles], dtype=np.int32)
    return np.stack([numbers % ACROSS, numbers // ACROSS], axis=1)


def crossing(uv: Floats, tiles: Sequence[Tile]) -> NDArray[np.bool_]:
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
        ScatterError: no face is in a tile.
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
    blocks.append(np.zeros((3, width)))  # for faces in no tile
    nowhere = ~(center[:, None] == squares(tiles)).all(axis=2).any(axis=1)
    if nowhere.all():
        numbers = ", ".join(str(number) for number, _ in tiles)
        raise ScatterError(
            f"The UV map points at none of the image's tiles ({numbers}): no point can be placed"
        )
    places[nowhere] = (1.5, begin + 1.5)
    return np.concatenate(blocks), places / (width, begin + 3.0)
