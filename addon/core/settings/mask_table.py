# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of the masks of a density: each has a value at a place, and full density in a range."""

import math
from typing import Any

from .descriptors import Kind, Setting

_ANGLE = {"high": math.pi, "subtype": "ANGLE"}
_HEIGHT = {"soft_low": -1000.0, "soft_high": 1000.0, "unit": "LENGTH"}
_LENGTH = {"soft_high": 100.0, "unit": "LENGTH"}
_SHARE = {"high": 1.0, "subtype": "FACTOR"}


def _switch(name: str, label: str, tooltip: str, **more: Any) -> Setting:
    return Setting(f"use_{name}", Kind.SWITCH, False, label, tooltip, **more)


def _number(name: str, of: str, default: float, label: str, tooltip: str, **more: Any) -> Setting:
    return Setting(
        f"{name}_{of}", Kind.NUMBER, default, label, tooltip, under=f"use_{name}", **more
    )


def _ends(
    name: str, inverted: str = "Full density outside of the range instead of inside"
) -> tuple[Setting, ...]:
    """The last settings of each mask."""
    return (
        Setting(
            f"{name}_invert",
            Kind.SWITCH,
            False,
            "Invert",
            inverted,
            under=f"use_{name}",
        ),
        _number(
            name,
            "strength",
            1.0,
            "Strength",
            "How much the mask counts: at 0 it has no effect, at 1 the density falls to 0",
            low=0.0,
            **_SHARE,
        ),
    )


MATERIAL = (
    _switch(
        "material",
        "Material",
        "Only scatter points on the faces of chosen materials. No effect until one is chosen",
    ),
    Setting(
        "materials",
        Kind.MATERIALS,
        (),
        "Materials",
        "Materials of the surface whose faces have full density",
        under="use_material",
    ),
    *_ends("material", "Full density on the faces of all other materials instead of these"),
)
SLOPE = (
    _switch(
        "slope",
        "Slope",
        "Only scatter points where the angle between the normal and world Z is in a range. "
        "Flat-shaded faces have one angle each, smooth ones the angle of their shading",
    ),
    _number(
        "slope",
        "min",
        0.0,
        "Min",
        "Smallest angle between the normal and world Z with full density: 0 is a floor, 90 a "
        "wall, 180 a ceiling",
        low=0.0,
        **_ANGLE,
    ),
    _number(
        "slope",
        "max",
        0.7853982,
        "Max",
        "Largest angle between the normal and world Z with full density: 0 is a floor, 90 a "
        "wall, 180 a ceiling",
        low=0.0,
        **_ANGLE,
    ),
    _number(
        "slope",
        "falloff",
        0.1745329,
        "Falloff",
        "Angle beyond the range over which the density falls to 0",
        low=0.0,
        **_ANGLE,
    ),
    *_ends("slope"),
)
HEIGHT = (
    _switch("height", "Height", "Only scatter points where world Z is in a range"),
    _number("height", "min", 0.0, "Min", "Lowest world Z with full density", **_HEIGHT),
    _number("height", "max", 1.0, "Max", "Highest world Z with full density", **_HEIGHT),
    _number(
        "height",
        "falloff",
        0.1,
        "Falloff",
        "Height beyond the range over which the density falls to 0",
        low=0.0,
        **_LENGTH,
    ),
    *_ends("height"),
)
DISTANCE = (
    _switch(
        "distance",
        "Distance",
        "Only scatter points whose distance to an object, or to the nearest object of a "
        "collection, is in a range. No effect until one of them is chosen",
    ),
    Setting(
        "distance_object",
        Kind.OBJECT,
        "",
        "Object",
        "Object that the distance is measured to: the faces of a mesh, 0 inside where it is "
        "closed, the line of a curve, the points of a scatter, or the origin of an empty",
        under="use_distance",
    ),
    Setting(
        "distance_collection",
        Kind.COLLECTION,
        "",
        "Collection",
        "Collection of objects; the distance is that to the nearest one. The surface and "
        "the scatter's own tiles and instances do not count",
        under="use_distance",
    ),
    Setting(
        "ignore_height",
        Kind.SWITCH,
        False,
        "Ignore Height",
        "Ignore the height when measuring, so that a path need not lie on the ground",
        under="use_distance",
    ),
    _number(
        "distance",
        "min",
        0.0,
        "Min",
        "Smallest distance with full density",
        low=0.0,
        **_LENGTH,
    ),
    _number(
        "distance", "max", 0.5, "Max", "Largest distance with full density", low=0.0, **_LENGTH
    ),
    _number(
        "distance",
        "falloff",
        0.5,
        "Falloff",
        "Distance beyond the range over which the density falls to 0",
        low=0.0,
        **_LENGTH,
    ),
    *_ends("distance"),
)
BORDER = (
    _switch(
        "border",
        "Border",
        "Only scatter points whose distance to the border of the surface is in a range. No "
        "effect on a closed surface, which has no border",
    ),
    _number(
        "border",
        "min",
        0.0,
        "Min",
        "Smallest distance to the border with full density",
        low=0.0,
        **_LENGTH,
    ),
    _number(
        "border",
        "max",
        0.2,
        "Max",
        "Largest distance to the border with full density",
        low=0.0,
        **_LENGTH,
    ),
    _number(
        "border",
        "falloff",
        0.2,
        "Falloff",
        "Distance beyond the range over which the density falls to 0",
        low=0.0,
        **_LENGTH,
    ),
    *_ends("border"),
)
ASPECT = (
    _switch(
        "aspect",
        "Aspect",
        "Only scatter points where the surface faces a direction. No effect on level ground, "
        "which faces none",
        own_words=True,
    ),
    _number(
        "aspect",
        "direction",
        0.0,
        "Direction",
        "Direction as on a compass: 0 is north (world Y), 90 is east (world X), 180 is south, "
        "270 is west",
        soft_low=0.0,
        soft_high=2.0 * math.pi,
        subtype="ANGLE",
    ),
    _number(
        "aspect",
        "min",
        0.0,
        "Min",
        "Smallest angle with full density between the direction and the one that the surface faces",
        low=0.0,
        **_ANGLE,
    ),
    _number(
        "aspect",
        "max",
        0.7853982,
        "Max",
        "Largest angle with full density between the direction and the one that the surface faces",
        low=0.0,
        **_ANGLE,
    ),
    _number(
        "aspect",
        "falloff",
        0.7853982,
        "Falloff",
        "Angle beyond the range over which the density falls to 0",
        low=0.0,
        **_ANGLE,
    ),
    *_ends("aspect"),
)
NOISE = (
    _switch(
        "noise",
        "Noise",
        "Only scatter points where a noise is in a range: patches that move with the surface",
    ),
    _number(
        "noise",
        "size",
        1.0,
        "Size",
        "Size of the patches",
        low=0.0001,
        soft_low=0.01,
        **_LENGTH,
    ),
    Setting(
        "noise_detail",
        Kind.WHOLE,
        2,
        "Detail",
        "Number of finer noise layers; each has half the size and half the influence of the "
        "previous one",
        low=0,
        high=8,
        under="use_noise",
    ),
    Setting(
        "noise_seed",
        Kind.WHOLE,
        0,
        "Seed",
        "Seed of the noise; each seed gives other patches",
        low=0,
        soft_high=10_000,
        under="use_noise",
    ),
    _number(
        "noise",
        "min",
        0.5,
        "Min",
        "Smallest value of the noise with full density. Values are from 0 to 1 and spread "
        "evenly: about half of a surface is above 0.5",
        low=0.0,
        **_SHARE,
    ),
    _number(
        "noise",
        "max",
        1.0,
        "Max",
        "Largest value of the noise with full density",
        low=0.0,
        **_SHARE,
    ),
    _number(
        "noise",
        "falloff",
        0.1,
        "Falloff",
        "Difference from the range over which the density falls to 0",
        low=0.0,
        **_SHARE,
    ),
    *_ends("noise"),
)
# By name, in the order of the panel.
MASKS = {
    "material": MATERIAL,
    "slope": SLOPE,
    "height": HEIGHT,
    "distance": DISTANCE,
    "border": BORDER,
    "aspect": ASPECT,
    "noise": NOISE,
}
