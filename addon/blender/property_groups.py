# SPDX-License-Identifier: GPL-3.0-or-later
"""Property groups inside a scatter's: report, density, tiles, what is placed, one class."""

import math
from typing import Any

import bpy
from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ..core.settings import DensitySettings
from ..core.tiles import TileSettings
from . import freshness, overlay
from .scatter import write_instance_inputs, write_stale_input
from .translation import OWN
from .weights import weight_names

_DENSITY = DensitySettings()
_TILES = TileSettings()
STILL: set[str] = set()  # not animatable: update functions do not run during playback


def instance_changed(settings: bpy.types.PropertyGroup, context: bpy.types.Context) -> None:
    """Update function of what is placed."""
    write_instance_inputs(settings.id_data)


def settings_changed(settings: bpy.types.PropertyGroup, context: bpy.types.Context) -> None:
    """Update function of what a result was solved with."""
    write_stale_input(settings.id_data)
    overlay.touch(settings.id_data)
    freshness.touch(settings.id_data)


class DAPPLE_PG_report(bpy.types.PropertyGroup):
    """Figures of the last optimization or bake."""

    count: IntProperty(name="Points")
    spacing: FloatProperty(
        name="Spacing",
        description="Distance of neighbors if the points were packed as well as can be",
        unit="LENGTH",
    )
    alpha_min: FloatProperty(
        name="Smallest Spacing",
        description="Smallest distance of two points, as a share of the best possible spacing",
    )
    alpha_mean: FloatProperty(
        name="Mean Spacing",
        description="Mean distance to the nearest point, as a share of the best possible spacing",
    )
    capacity_spread: FloatProperty(
        name="Capacity Spread",
        description="Standard deviation of the areas that belong to the points, over their mean",
    )
    whole_count_spread: FloatProperty(
        name="By Whole Counts",
        description="What of the capacity spread comes of separate parts of the surface having "
        "whole numbers of points each",
    )
    evaluations: IntProperty(name="Evaluations")
    milliseconds: FloatProperty(name="Milliseconds")
    converged: BoolProperty(name="Converged")
    key_error_max: FloatProperty(
        name="Largest Distance Between Keys",
        description="On frames without a key: farthest that a point is from where it was solved, "
        "in spacings",
    )
    key_error_mean: FloatProperty(
        name="Mean Distance Between Keys",
        description="On frames without a key: mean distance from where points were solved, "
        "in spacings",
    )
    worst_overlap: FloatProperty(
        name="Worst Overlap",
        description="Of things with radii: by how much of both radii the two nearest overlap",
        subtype="FACTOR",
    )
    details: StringProperty(
        name="Details", description="Energies of the iterations, histogram of spacings, as JSON"
    )
    overlap_first: IntProperty(name="First Overlapping Point", default=-1)
    overlap_second: IntProperty(name="Second Overlapping Point", default=-1)
    overlap_frame: IntProperty(
        name="Frame of Overlap", description="Baked frame in which they overlap most"
    )


def _weight_names(settings: Any, context: bpy.types.Context, text: str) -> list[str]:
    """Names that fit what was typed so far; others, made by modifiers, can be typed too."""
    surface = settings.id_data.dapple.surface
    names = weight_names(surface) if surface is not None else []
    return [name for name in names if text.lower() in name.lower()]


class DAPPLE_PG_density(bpy.types.PropertyGroup):
    """Terms of the density, which are multiplied."""

    attribute: StringProperty(
        options=STILL,
        update=settings_changed,
        name="Attribute",
        description="Attribute or vertex group of the surface after its modifiers: 0 is no points, "
        "twice as much is twice as many. Colors count by their brightness",
        search=_weight_names,
        search_options={"SUGGESTION"},
    )
    curvature: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Curvature",
        description="How much thinner flat places are than bent ones",
        default=_DENSITY.curvature,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )
    use_slope: BoolProperty(
        options=STILL,
        update=settings_changed,
        name="Slope",
        description="Points only where the angle between the surface and the ground is in a range",
    )
    slope_from: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="From",
        translation_context=OWN,
        description="Angle between the normal and world Z: 0 is a floor, 90 a wall, 180 a ceiling",
        default=_DENSITY.slope_from,
        min=0.0,
        max=math.pi,
        subtype="ANGLE",
    )
    slope_to: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="To",
        translation_context=OWN,
        description="Angle between the normal and world Z: 0 is a floor, 90 a wall, 180 a ceiling",
        default=_DENSITY.slope_to,
        min=0.0,
        max=math.pi,
        subtype="ANGLE",
    )
    slope_fade: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Fade",
        description="Over how many degrees beside the range the points get fewer",
        default=_DENSITY.slope_fade,
        min=0.0,
        max=math.pi,
        subtype="ANGLE",
    )
    use_height: BoolProperty(
        options=STILL,
        update=settings_changed,
        name="Height",
        description="Points only where world Z is in a range",
    )
    height_from: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="From",
        translation_context=OWN,
        description="Lowest world Z with full density",
        default=_DENSITY.height_from,
        unit="LENGTH",
    )
    height_to: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="To",
        translation_context=OWN,
        description="Highest world Z with full density",
        default=_DENSITY.height_to,
        unit="LENGTH",
    )
    height_fade: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Fade",
        description="Over what height beside the range the points get fewer",
        default=_DENSITY.height_fade,
        min=0.0,
        unit="LENGTH",
    )
    image: PointerProperty(
        update=settings_changed,
        name="Image",
        description="Picture whose brightness, as painted, times opacity multiplies the density",
        type=bpy.types.Image,
    )
    uv_map: StringProperty(
        options=STILL,
        update=settings_changed,
        name="UV Map",
        description="Texture coordinates that lay the image on the surface; none: those that "
        "renders use",
    )
    use_camera: BoolProperty(
        options=STILL,
        update=settings_changed,
        name="Camera View",
        description="Points only where the scene's camera looks in this frame, hidden or not",
    )
    camera_margin: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Margin",
        description="How far beyond the camera's frame there are points, as a share of half the "
        "frame: for shadows, and for a camera that moves",
        default=_DENSITY.camera_margin,
        min=0.0,
        soft_max=1.0,
        subtype="FACTOR",
    )
    obstacles: PointerProperty(
        update=settings_changed,
        name="Keep Off",
        description="Collection of things that points keep off: from within closed meshes and from "
        "near any, and from the things of other scatters by their radii; never from the scatter's "
        "own points, tiles and instances",
        type=bpy.types.Collection,
    )
    obstacle_margin: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Margin",
        description="How far points stay away from what they keep off",
        default=_DENSITY.obstacle_margin,
        min=0.0,
        soft_max=10.0,
        unit="LENGTH",
    )


class DAPPLE_PG_tiles(bpy.types.PropertyGroup):
    """How the cells of a scatter are made into tiles."""

    grout: FloatProperty(
        options=STILL,
        name="Grout",
        description="Width of the gap between tiles, as a share of the points' spacing",
        default=_TILES.grout,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )
    inset_randomness: FloatProperty(
        options=STILL,
        name="Random Inset",
        description="By how much more a tile may draw back, as a share of the points' spacing",
        default=_TILES.inset_randomness,
        min=0.0,
        max=0.5,
        subtype="FACTOR",
    )
    thickness: FloatProperty(
        options=STILL,
        name="Thickness",
        description="Of the tiles, as a share of the points' spacing; 0 leaves them in the surface",
        default=_TILES.thickness,
        min=0.0,
        soft_max=1.0,
        subtype="FACTOR",
    )
    color_by: EnumProperty(
        options=STILL,
        name="Color By",
        translation_context=OWN,
        description="What the color attribute of the tiles tells",
        items=[
            ("RANDOM", "Tile", "Each tile has a color by chance of its id"),
            ("CLASS", "Class", "Tiles of one class have one color"),
        ],
        default=_TILES.color_by,
    )
    object: PointerProperty(
        name="Tiles",
        description="Object that the tiles are written to",
        type=bpy.types.Object,
    )


class Instanced:
    """What is put on points, and how."""

    instance: PointerProperty(
        name="Instance",
        description="Object to put on every point; a small cone if empty",
        type=bpy.types.Object,
        update=instance_changed,
    )
    collection: PointerProperty(
        name="Collection",
        description="Objects of which every point gets one by chance; goes before Instance",
        type=bpy.types.Collection,
        update=instance_changed,
    )
    scale: FloatProperty(
        options=STILL,
        name="Scale",
        description="Size of the instances",
        default=1.0,
        soft_min=0.0,
        soft_max=10.0,
        update=instance_changed,
    )
    scale_randomness: FloatProperty(
        options=STILL,
        name="Random Scale",
        description="By how much of their size instances may be smaller",
        default=0.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        update=instance_changed,
    )
    turn_randomness: FloatProperty(
        options=STILL,
        name="Random Turn",
        description="Share of a full turn by which instances are turned about the normal",
        default=1.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        update=instance_changed,
    )
    align: FloatProperty(
        options=STILL,
        name="Align to Normal",
        description="1 stands upright on the surface, 0 upright in the world",
        default=1.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        update=instance_changed,
    )
    tilt: FloatProperty(
        options=STILL,
        name="Random Tilt",
        description="Largest angle by which instances lean, each its own way",
        default=0.0,
        min=0.0,
        max=math.pi,
        subtype="ANGLE",
        update=instance_changed,
    )
    density_scale: FloatProperty(
        options=STILL,
        name="Scale by Density",
        description="How much smaller instances are where the density is less; below 0 larger",
        default=0.0,
        min=-1.0,
        max=1.0,
        subtype="FACTOR",
        update=instance_changed,
    )


class DAPPLE_PG_class(Instanced, bpy.types.PropertyGroup):
    """One kind of things among several; its `name` is what the list shows."""

    use_count: BoolProperty(
        options=STILL,
        update=settings_changed,
        name="Exact Count",
        description="Give the class so many points, instead of a share of the rest",
    )
    count: IntProperty(
        options=STILL,
        update=settings_changed,
        name="Count",
        description="Number of points of the class, met exactly",
        default=100,
        min=1,
        soft_max=100_000,
    )
    share: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Share",
        description="Of the points that no class counts itself, in relation to the other shares",
        default=1.0,
        min=0.0,
        soft_max=10.0,
    )
    density: StringProperty(
        options=STILL,
        update=settings_changed,
        name="Density",
        description="Attribute or vertex group of the surface that multiplies its density for this "
        "class",
        search=_weight_names,
        search_options={"SUGGESTION"},
    )
    radius: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Radius",
        description="Of a thing on the ground: things of all classes are kept from overlapping",
        default=0.0,
        min=0.0,
        soft_max=10.0,
        unit="LENGTH",
    )
