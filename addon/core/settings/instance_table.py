# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of instances, of object types and of tiles."""

import math

from .descriptors import Changes, Kind, Setting

KEEP, REMOVE = "KEEP", "REMOVE"  # of Borders

INSTANCES = (
    Setting(
        "instance",
        Kind.OBJECT,
        "",
        "Instance",
        "Object to instance on the points; a small cone if empty",
        Changes.INSTANCES,
    ),
    Setting(
        "collection",
        Kind.COLLECTION,
        "",
        "Collection",
        "Collection whose objects are instanced on the points, one picked at random for each "
        "point; overrides Instance",
        Changes.INSTANCES,
    ),
    Setting(
        "use_weights",
        Kind.SWITCH,
        False,
        "Object Weights",
        "Pick some objects of the collection more often than others",
        Changes.INSTANCES,
    ),
    Setting(
        "scale",
        Kind.NUMBER,
        1.0,
        "Scale",
        "Scale of the instances",
        Changes.INSTANCES,
        soft_low=0.0,
        soft_high=10.0,
    ),
    *(
        Setting(
            f"scale_{axis.lower()}",
            Kind.NUMBER,
            1.0,
            f"Scale {axis}",
            f"Scale of the instances along their {axis} axis",
            Changes.INSTANCES,
            soft_low=0.0,
            soft_high=10.0,
        )
        for axis in "XYZ"
    ),
    Setting(
        "random_scale_down",
        Kind.NUMBER,
        0.0,
        "Random Scale Down",
        "Maximum random reduction of the scale",
        Changes.INSTANCES,
        low=0.0,
        high=1.0,
        subtype="FACTOR",
    ),
    Setting(
        "random_scale_up",
        Kind.NUMBER,
        0.0,
        "Random Scale Up",
        "Maximum random enlargement of the scale. 1: up to twice as large",
        Changes.INSTANCES,
        low=0.0,
        soft_high=1.0,
        subtype="FACTOR",
    ),
    Setting(
        "fit_to_spacing",
        Kind.NUMBER,
        0.0,
        "Fit to Spacing",
        "How far instances are scaled to the free space around their points: 0 keeps "
        "their size, at 1 they touch the nearest instance of the same type without "
        "overlap. The other scales multiply",
        Changes.INSTANCES,
        low=0.0,
        high=1.0,
        subtype="FACTOR",
    ),
    Setting(
        "random_turn",
        Kind.NUMBER,
        1.0,
        "Random Turn",
        "Maximum random rotation around the normal, as a fraction of a full turn",
        Changes.INSTANCES,
        low=0.0,
        high=1.0,
        subtype="FACTOR",
    ),
    Setting(
        "align_to_normal",
        Kind.NUMBER,
        1.0,
        "Align to Normal",
        "Align instances with the surface normal (1) or with world Z (0)",
        Changes.INSTANCES,
        low=0.0,
        high=1.0,
        subtype="FACTOR",
        own_words=True,
    ),
    Setting(
        "random_tilt",
        Kind.NUMBER,
        0.0,
        "Random Tilt",
        "Maximum angle by which instances lean in a random direction",
        Changes.INSTANCES,
        low=0.0,
        high=math.pi,
        subtype="ANGLE",
    ),
    Setting(
        "density_scale",
        Kind.NUMBER,
        0.0,
        "Density Scale",
        "How much smaller instances are where the density is lower; negative values make them "
        "larger",
        Changes.INSTANCES,
        low=-1.0,
        high=1.0,
        subtype="FACTOR",
    ),
    Setting(
        "offset",
        Kind.NUMBER,
        0.0,
        "Offset",
        "Distance of the instances from the surface along its normal; negative values sink them",
        Changes.INSTANCES,
        soft_low=-10.0,
        soft_high=10.0,
        unit="LENGTH",
    ),
)
CLASS = (
    Setting(
        "use_count",
        Kind.SWITCH,
        False,
        "Exact Count",
        "Give this object type an exact number of points instead of a share of the rest",
        Changes.INDIRECTLY,
    ),
    Setting(
        "count",
        Kind.WHOLE,
        100,
        "Count",
        "Exact number of points of this object type",
        Changes.INDIRECTLY,
        low=1,
        soft_high=100_000,
        under="use_count",
    ),
    Setting(
        "weight",
        Kind.NUMBER,
        1.0,
        "Weight",
        "Share of the points that remain after exact counts, relative to the weights of the other"
        " object types",
        low=0.0,
        soft_high=10.0,
    ),
    Setting(
        "density",
        Kind.VALUES,
        "",
        "Density",
        "Attribute or vertex group of the surface that multiplies the density for this object type",
    ),
    Setting(
        "radius",
        Kind.NUMBER,
        0.0,
        "Radius",
        "Radius of an instance on the surface; instances of all object types are kept from "
        "overlapping, and points without a radius outside of it",
        low=0.0,
        soft_high=10.0,
        unit="LENGTH",
    ),
    Setting(
        "radius_from_bounds",
        Kind.SWITCH,
        False,
        "Radius from Bounds",
        "The radius is that of the largest instance, and follows its bounds and scale. With Fit to "
        "Spacing it becomes smaller where there is not enough room, and instances with it",
        Changes.INDIRECTLY,
    ),
    Setting(
        "borders",
        Kind.CHOICE,
        KEEP,
        "Borders",
        "What becomes of instances that would stick out over the border of the surface, or into "
        "areas without density, by their Radius",
        choices=(
            (KEEP, "Keep", "They stay: points may be up to the border"),
            ("MOVE_IN", "Move In", "All points keep the radius as distance from the border"),
            (
                REMOVE,
                "Remove",
                "Points that would be nearer to the border are left out; there are fewer, and "
                "the others keep their distances",
            ),
        ),
    ),
)
TILES = (
    Setting(
        "grout",
        Kind.NUMBER,
        0.1,
        "Grout",
        "Width of the gap between tiles, relative to the spacing of the points",
        Changes.NOTHING,
        low=0.0,
        high=1.0,
        subtype="FACTOR",
    ),
    Setting(
        "random_inset",
        Kind.NUMBER,
        0.0,
        "Random Inset",
        "Maximum random inset of a tile, relative to the spacing of the points",
        Changes.NOTHING,
        low=0.0,
        high=0.5,
        subtype="FACTOR",
    ),
    Setting(
        "thickness",
        Kind.NUMBER,
        0.15,
        "Thickness",
        "Thickness of the tiles, relative to the spacing of the points; 0 leaves them flat on the "
        "surface",
        Changes.NOTHING,
        low=0.0,
        soft_high=1.0,
        subtype="FACTOR",
    ),
    Setting(
        "color_by",
        Kind.CHOICE,
        "RANDOM",
        "Color By",
        "Meaning of the color attribute of the tiles",
        Changes.NOTHING,
        choices=(
            ("RANDOM", "Tile", "Each tile has a random color that depends on its ID"),
            ("CLASS", "Object Type", "Tiles of the same object type have the same hue"),
        ),
        own_words=True,
    ),
)
