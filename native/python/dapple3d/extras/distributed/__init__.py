# SPDX-License-Identifier: GPL-3.0-or-later
"""Work for many processes and machines: surfaces with more points than memory, many shots.

>>> from dapple3d.extras.distributed import HeightField, sample_tiles
>>> pines = sample_tiles(HeightField(heights), "pines", 10_000_000)
>>> for tile in pines.tiles():
...     place(tile.positions, tile.normals)
"""

from .files import open_surface
from .heights import HeightField
from .patches import Patch, Tileable
from .results import TilePoints, Tiles
from .shots import map_shots, track_shot
from .tiling import sample_tiles

__all__ = [
    "HeightField",
    "Patch",
    "TilePoints",
    "Tileable",
    "Tiles",
    "map_shots",
    "open_surface",
    "sample_tiles",
    "track_shot",
]
