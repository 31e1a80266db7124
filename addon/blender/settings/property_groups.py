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

from ...core.settings import DensitySettings
from ...core.tiles import TileSettings
from ..base.translation import OWN
from ..data.modifier import write_instance_inputs, write_warning
from ..status import freshness
from ..surface.weights import weight_names
from ..viewport import overlay

_DENSITY = DensitySettings()
_TILES = TileSettings()
STILL: set[str] = set()  # not animatable: update functions do not run during playback


def instance_changed(settings: bpy.types.PropertyGroup, context: bpy.types.Context) -> None:
    """Update function of what is placed."""
    write_instance_inputs(settings.id_data)


def settings_changed(settings: bpy.types.PropertyGroup, context: bpy.types.Context) -> None:
    """Update function of what a result was solved with."""
    write_warning(settings.id_data)
    overlay.touch(settings.id_data)
    freshness.touch(settings.id_data)


class DAPPLE_PG_report(bpy.types.PropertyGroup):
    """Figures of the last optimization or bake."""

    count: IntProperty(name="Points")
    spacing: FloatProperty(
        name="Spacing",
        description="Ideal spacing: the distance between neighbors if the points were packed as "
        "tightly as possible",
        unit="LENGTH",
    )
    alpha_min: FloatProperty(
        name="Min Spacing",
        description="Smallest distance between two points, relative to the ideal spacing",
    )
    alpha_mean: FloatProperty(
        name="Mean Spacing",
        description="Mean distance to the nearest point, relative to the ideal spacing",
    )
    capacity_variation: FloatProperty(
        name="Area Variation",
        description="Standard deviation of the areas of the points, relative to their mean",
    )
    whole_count_variation: FloatProperty(
        name="Due to Whole Counts",
        description="Part of the area variation that arises because each separate part of the "
        "surface has a whole number of points",
    )
    evaluations: IntProperty(name="Evaluations")
    milliseconds: FloatProperty(name="Milliseconds")
    converged: BoolProperty(name="Converged")
    key_error_max: FloatProperty(
        name="Max Keyframe Error",
        description="Largest distance of a point from where it was solved, on frames without a "
        "keyframe and in spacings",
    )
    key_error_mean: FloatProperty(
        name="Mean Keyframe Error",
        description="Mean distance of the points from where they were solved, on frames without a "
        "keyframe and in spacings",
    )
    worst_overlap: FloatProperty(
        name="Max Overlap",
        description="Largest overlap of two instances with radii, relative to the sum of both "
        "radii",
        subtype="FACTOR",
    )
    details: StringProperty(
        name="Details",
        description="Energies of the iterations and histogram of the spacings, as JSON",
    )
    overlap_first: IntProperty(name="First Overlapping Point", default=-1)
    overlap_second: IntProperty(name="Second Overlapping Point", default=-1)
    overlap_frame: IntProperty(
        name="Overlap Frame", description="Baked frame with the largest overlap"
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
        description="Attribute or vertex group of the evaluated surface that multiplies the "
        "density: there are no points where it is 0, and twice as many where it is twice as large. "
        "Colors count by their brightness",
        search=_weight_names,
        search_options={"SUGGESTION"},
    )
    curvature: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Curvature",
        description="How much sparser flat areas are than curved ones",
        default=_DENSITY.curvature,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )
    use_slope: BoolProperty(
        options=STILL,
        update=settings_changed,
        name="Slope",
        description="Only scatter points where the angle between the normal and world Z is in a "
        "range",
    )
    slope_from: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Min",
        description="Smallest angle between the normal and world Z with full density: 0 is a "
        "floor, 90 a wall, 180 a ceiling",
        default=_DENSITY.slope_from,
        min=0.0,
        max=math.pi,
        subtype="ANGLE",
    )
    slope_to: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Max",
        description="Largest angle between the normal and world Z with full density: 0 is a "
        "floor, 90 a wall, 180 a ceiling",
        default=_DENSITY.slope_to,
        min=0.0,
        max=math.pi,
        subtype="ANGLE",
    )
    slope_fade: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Falloff",
        description="Angle beyond the range over which the density falls to 0",
        default=_DENSITY.slope_fade,
        min=0.0,
        max=math.pi,
        subtype="ANGLE",
    )
    use_height: BoolProperty(
        options=STILL,
        update=settings_changed,
        name="Height",
        description="Only scatter points where world Z is in a range",
    )
    height_from: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Min",
        description="Lowest world Z with full density",
        default=_DENSITY.height_from,
        unit="LENGTH",
    )
    height_to: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Max",
        description="Highest world Z with full density",
        default=_DENSITY.height_to,
        unit="LENGTH",
    )
    height_fade: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Falloff",
        description="Height beyond the range over which the density falls to 0",
        default=_DENSITY.height_fade,
        min=0.0,
        unit="LENGTH",
    )
    image: PointerProperty(
        update=settings_changed,
        name="Image",
        description="Image whose brightness, as painted, and opacity multiply the density",
        type=bpy.types.Image,
    )
    uv_map: StringProperty(
        options=STILL,
        update=settings_changed,
        name="UV Map",
        description="UV map that places the image on the surface; if empty, the one that is "
        "active for rendering",
    )
    use_camera: BoolProperty(
        options=STILL,
        update=settings_changed,
        name="Camera View",
        description="Only scatter points in the view of the scene camera at the current frame, "
        "whether hidden behind something or not",
    )
    camera_margin: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Margin",
        description="How far points extend beyond the camera frame, relative to half the frame: "
        "for shadows and moving cameras",
        default=_DENSITY.camera_margin,
        min=0.0,
        soft_max=1.0,
        subtype="FACTOR",
    )
    obstacles: PointerProperty(
        update=settings_changed,
        name="Avoid Collection",
        description="Collection of objects that points avoid: the inside of closed meshes, the "
        "vicinity of any mesh, and the instances of other scatters with their radii. The "
        "scatter's own points, tiles and instances are never avoided",
        type=bpy.types.Collection,
    )
    obstacle_margin: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Margin",
        description="Distance that points keep from what they avoid",
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
        description="Width of the gap between tiles, relative to the spacing of the points",
        default=_TILES.grout,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )
    inset_randomness: FloatProperty(
        options=STILL,
        name="Random Inset",
        description="Maximum random inset of a tile, relative to the spacing of the points",
        default=_TILES.inset_randomness,
        min=0.0,
        max=0.5,
        subtype="FACTOR",
    )
    thickness: FloatProperty(
        options=STILL,
        name="Thickness",
        description="Thickness of the tiles, relative to the spacing of the points; 0 leaves them "
        "flat on the surface",
        default=_TILES.thickness,
        min=0.0,
        soft_max=1.0,
        subtype="FACTOR",
    )
    color_by: EnumProperty(
        options=STILL,
        name="Color By",
        translation_context=OWN,
        description="What the color attribute of the tiles shows",
        items=[
            ("RANDOM", "Tile", "Each tile has a random color that depends on its ID"),
            ("CLASS", "Object Type", "Tiles of the same object type have the same hue"),
        ],
        default=_TILES.color_by,
    )
    object: PointerProperty(
        name="Tiles",
        description="Object that holds the tiles",
        type=bpy.types.Object,
    )


class Instanced:
    """What is put on points, and how."""

    instance: PointerProperty(
        name="Instance",
        description="Object to instance on the points; a small cone if empty",
        type=bpy.types.Object,
        update=instance_changed,
    )
    collection: PointerProperty(
        name="Collection",
        description="Collection whose objects are instanced on the points, one picked at random "
        "for each point; overrides Instance",
        type=bpy.types.Collection,
        update=instance_changed,
    )
    scale: FloatProperty(
        options=STILL,
        name="Scale",
        description="Scale of the instances",
        default=1.0,
        soft_min=0.0,
        soft_max=10.0,
        update=instance_changed,
    )
    scale_randomness: FloatProperty(
        options=STILL,
        name="Random Scale",
        description="Maximum random reduction of the scale",
        default=0.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        update=instance_changed,
    )
    turn_randomness: FloatProperty(
        options=STILL,
        name="Random Z Rotation",
        description="Maximum random rotation around the normal, as a fraction of a full turn",
        default=1.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        update=instance_changed,
    )
    align: FloatProperty(
        options=STILL,
        name="Align to Normal",
        description="Align instances with the surface normal (1) or with world Z (0)",
        default=1.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        update=instance_changed,
    )
    tilt: FloatProperty(
        options=STILL,
        name="Random Tilt",
        description="Maximum angle by which instances lean in a random direction",
        default=0.0,
        min=0.0,
        max=math.pi,
        subtype="ANGLE",
        update=instance_changed,
    )
    density_scale: FloatProperty(
        options=STILL,
        name="Scale by Density",
        description="How much smaller instances are where the density is lower; negative values "
        "make them larger",
        default=0.0,
        min=-1.0,
        max=1.0,
        subtype="FACTOR",
        update=instance_changed,
    )


class DAPPLE_PG_class(Instanced, bpy.types.PropertyGroup):
    """One object type among several; its `name` is what the list shows."""

    use_count: BoolProperty(
        options=STILL,
        update=settings_changed,
        name="Exact Count",
        description="Give this object type an exact number of points instead of a share of the "
        "rest",
    )
    count: IntProperty(
        options=STILL,
        update=settings_changed,
        name="Count",
        description="Exact number of points of this object type",
        default=100,
        min=1,
        soft_max=100_000,
    )
    share: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Weight",
        description="Share of the points that no object type counts exactly, relative to the "
        "weights of the other object types",
        default=1.0,
        min=0.0,
        soft_max=10.0,
    )
    density: StringProperty(
        options=STILL,
        update=settings_changed,
        name="Density",
        description="Attribute or vertex group of the surface that multiplies the density for this "
        "object type",
        search=_weight_names,
        search_options={"SUGGESTION"},
    )
    radius: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Radius",
        description="Radius of an instance on the surface; instances of all object types are kept "
        "from overlapping",
        default=0.0,
        min=0.0,
        soft_max=10.0,
        unit="LENGTH",
    )
