# SPDX-License-Identifier: GPL-3.0-or-later
"""Densities by the shape and the surroundings of a surface: masks.

A mask is a quantity and a `Range` of it in which the density is full:

- `slope` and `aspect` are functions of the normals. Their factors multiply a density: `multiplied`.
- `Height`, `Distance`, `Noise`, `Camera`, `Obstacle` and `Solids` are fields: values at places.

`MaskedSurface` cuts the faces on which fields change, as it does for pictures on texture
coordinates: so a mask holds within large faces.

>>> low = density.Range(high=0.4, falloff=0.1)
>>> flat = density.slope(surface.corner_normals, density.Range(0.0, math.radians(45.0)))
>>> patches = density.Noise(density.Range(0.5, 1.0), size=0.3)
>>> masked = density.MaskedSurface(
...     density.multiplied(surface, flat), [density.Height(low), patches], count=2000
... )
>>> samples = masked.to_original(dapple.sample(masked.surface, 2000))

The distance to the border of a surface is a distance to the segments `border_edges`. Lengths are in
the units of the surface, angles in radians.
"""

from .arrays import multiplied, placed, product
from .fields import Camera, Distance, Field, Height, Noise, RangeField
from .masked import MaskedSurface
from .nearest import Nearest, border_edges
from .noise import noise
from .normals import vertex_normals
from .obstacle import Obstacle
from .orientation import aspect, slope
from .ranges import Range
from .solids import Solids

__all__ = [
    "Camera",
    "Distance",
    "Field",
    "Height",
    "MaskedSurface",
    "Nearest",
    "Noise",
    "Obstacle",
    "Range",
    "RangeField",
    "Solids",
    "aspect",
    "border_edges",
    "multiplied",
    "noise",
    "placed",
    "product",
    "slope",
    "vertex_normals",
]
