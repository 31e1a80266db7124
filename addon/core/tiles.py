# SPDX-License-Identifier: GPL-3.0-or-later
"""The cells of a scatter as tiles: a mesh of polygons, with what each tile owns."""

import colorsys
from dataclasses import dataclass
from typing import Any

import numpy as np

from .base.errors import ScatterError
from .base.native import named, package
from .settings.values import TileSettings
from .surface.arrays import Floats, Ints, SurfaceArrays
from .surface.binding import bound_nearest, samples_of
from .surface.frames import shaded
from .surface.records import Binding, Columns, own_random

_INSET_STREAM, _COLOR_STREAM = 2, 3  # of own_random
_HUES = (0.06, 0.53, 0.13, 0.35, 0.90, 0.72)  # of classes, one after another
_SATURATION = 0.6


@dataclass(frozen=True)
class Tiles:
    """Polygons in world space, tile after tile; tiles share no vertices."""

    vertices: Floats  # (v, 3)
    corners: Ints  # (c,) vertex indices, polygon after polygon
    starts: Ints  # (m,) where each polygon begins
    cells: Ints  # (m,) id of the point
    classes: Ints  # (m,)
    colors: Floats  # (v, 4) linear, of each vertex that of its tile
    lost: int  # points whose cells are narrower than the grout
    binding: Binding  # of the vertices, to the nearest places of the surface


def tiled(
    arrays: SurfaceArrays,
    binding: Binding,
    columns: Columns,
    settings: TileSettings,
    seed: int,
    context: Any,
) -> Tiles:
    """The cells of bound points on a surface as it stands.

    Raises:
        ScatterError: nothing is left of any of them.
    """
    ids, classes = columns["id"], columns["dapple_object_type"]
    with named(arrays.name):
        surface = package().Surface(arrays.vertices, arrays.faces, **shaded(arrays))
        samples = samples_of(binding, surface, ids, classes)
        spacing = samples.report.spacing
        made = package().mosaic(
            surface,
            samples,
            grout=settings.grout * spacing,
            insets=settings.random_inset * spacing * own_random(seed, ids, _INSET_STREAM),
            thickness=settings.thickness * spacing,
            context=context,
        )
    if len(ids) and made.empty == len(ids):
        raise ScatterError(
            f"Surface '{arrays.name}': all {len(ids)} tiles are empty: the grout and the random "
            "insets are wider than the cells"
        )
    owners = np.empty(len(made.vertices), dtype=np.int64)  # points, of the vertices
    owners[made.corners] = np.repeat(made.sites, np.diff(made.starts))
    colors = _colors(settings.color_by, seed, ids, classes)
    return Tiles(
        np.asarray(made.vertices),
        np.asarray(made.corners),
        np.asarray(made.starts[:-1]),
        ids[made.sites],
        np.asarray(made.classes),
        colors[owners],
        made.empty,
        bound_nearest(np.asarray(made.vertices), arrays),
    )


def _colors(color_by: str, seed: int, ids: Ints, classes: Ints) -> Floats:
    """(n, 4): the hue of the class, or a random one by the id; randomly lighter or darker."""
    chance = own_random(seed, ids, _COLOR_STREAM)
    if color_by == "CLASS":
        hues = np.array(_HUES)[classes % len(_HUES)]
    else:
        hues = np.array(_HUES)[(chance * len(_HUES)).astype(np.int64)]
    values = 0.35 + 0.45 * (1000.0 * chance % 1.0)
    pairs = zip(hues.tolist(), values.tolist(), strict=True)
    rows = [colorsys.hsv_to_rgb(hue, _SATURATION, value) for hue, value in pairs]
    return np.column_stack([np.array(rows).reshape(-1, 3), np.ones(len(ids))])
