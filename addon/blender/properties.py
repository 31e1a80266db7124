# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties of a scatter object: what is set, and the figures of the last result."""

import math
from dataclasses import fields
from typing import Any

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ..core.records import SCHEMA_KEY
from ..core.settings import ClassSettings, DensitySettings, Settings
from ..core.solve import Report
from ..core.stale import changed_settings
from ..core.tiles import TileSettings
from ..nodes import (
    GROUP_NAME,
    INSTANCE_INPUTS,
    VERSION_KEY,
    has_input,
    input_name,
    set_input,
)
from .weights import weight_names

_DEFAULT = Settings()
_DENSITY = DensitySettings()
_TILES = TileSettings()
BIND_TO = [
    ("FACES", "Faces", "Faces after all modifiers: exact, and can be baked; needs the same faces"),
    (
        "REST",
        "Rest Position",
        "The shape before all modifiers: they may make other faces in every frame or in the "
        "render; points ride and cannot be baked. Turns on the surface's Rest Position",
    ),
]
_STILL: set[str] = set()  # not animatable: update functions do not run during playback


def scatter_modifier(obj: bpy.types.Object) -> bpy.types.NodesModifier | None:
    """The modifier that plays the scatter back."""
    for modifier in obj.modifiers:
        group = modifier.node_group if modifier.type == "NODES" else None
        if group is not None and group.get(VERSION_KEY, 0) > 0:
            return modifier
    return None


def is_scatter(obj: bpy.types.Object | None) -> bool:
    """Whether the object was made by Dapple."""
    return obj is not None and obj.type == "MESH" and SCHEMA_KEY in obj.data


def _is_surface(settings: "DAPPLE_PG_scatter", obj: bpy.types.Object) -> bool:
    return obj.type == "MESH" and not is_scatter(obj)


def _instance_changed(settings: "DAPPLE_PG_scatter", context: bpy.types.Context) -> None:
    write_instance_inputs(settings.id_data)


def _settings_changed(settings: "DAPPLE_PG_scatter", context: bpy.types.Context) -> None:
    write_stale_input(settings.id_data)


def write_stale_input(obj: bpy.types.Object) -> None:
    """Have the modifier warn when the settings are not those of the result."""
    modifier = scatter_modifier(obj)
    if modifier is not None and has_input(modifier, "Stale"):
        set_input(modifier, "Stale", settings_reason(obj))
        obj.update_tag()


def settings_reason(obj: bpy.types.Object) -> str:
    """Which settings are not those that the result was solved with; empty when all are."""
    if not obj.dapple.solved_settings:
        return ""
    names = changed_settings(obj.dapple.solved_settings, settings_of(obj))
    if obj.dapple.bind_to != obj.dapple.bound_to:
        names.append("bind to")
    if not names:
        return ""
    again = "bake" if obj.dapple.baked_keys else "optimise"
    return f"Settings were changed ({', '.join(names)}): {again} again"


def write_instance_inputs(obj: bpy.types.Object) -> None:
    """Tell the node group what to instance and how."""
    modifier = scatter_modifier(obj)
    if modifier is None:
        return
    if not obj.dapple.classes:
        _write_kind(modifier, obj.dapple, None)
    for index, kind in enumerate(obj.dapple.classes):
        _write_kind(modifier, kind, index)
    obj.update_tag()


def _write_kind(modifier: bpy.types.NodesModifier, kind: "Instanced", index: int | None) -> None:
    for name, _ in INSTANCE_INPUTS:
        label = input_name(name, index)
        if has_input(modifier, label):
            set_input(modifier, label, getattr(kind, name.lower().replace(" ", "_")))


class DAPPLE_PG_report(bpy.types.PropertyGroup):
    """Figures of the last optimisation or bake."""

    count: IntProperty(name="Points")
    spacing: FloatProperty(
        name="Spacing",
        description="Distance of neighbours if the points were packed as well as can be",
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
    overlap_first: IntProperty(name="First Overlapping Point", default=-1)
    overlap_second: IntProperty(name="Second Overlapping Point", default=-1)


def _weight_names(settings: Any, context: bpy.types.Context, text: str) -> list[str]:
    """Names that fit what was typed so far; others, made by modifiers, can be typed too."""
    surface = settings.id_data.dapple.surface
    names = weight_names(surface) if surface is not None else []
    return [name for name in names if text.lower() in name.lower()]


class DAPPLE_PG_density(bpy.types.PropertyGroup):
    """Terms of the density, which are multiplied."""

    attribute: StringProperty(
        options=_STILL,
        update=_settings_changed,
        name="Attribute",
        description="Attribute or vertex group of the surface after its modifiers: 0 is no points, "
        "twice as much is twice as many. Colours count by their brightness",
        search=_weight_names,
        search_options={"SUGGESTION"},
    )
    curvature: FloatProperty(
        options=_STILL,
        update=_settings_changed,
        name="Curvature",
        description="How much thinner flat places are than bent ones",
        default=_DENSITY.curvature,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )
    use_slope: BoolProperty(
        options=_STILL,
        update=_settings_changed,
        name="Slope",
        description="Points only where the angle between the surface and the ground is in a range",
    )
    slope_from: FloatProperty(
        options=_STILL,
        update=_settings_changed,
        name="From",
        description="Angle between the normal and world Z: 0 is a floor, 90 a wall, 180 a ceiling",
        default=_DENSITY.slope_from,
        min=0.0,
        max=math.pi,
        subtype="ANGLE",
    )
    slope_to: FloatProperty(
        options=_STILL,
        update=_settings_changed,
        name="To",
        description="Angle between the normal and world Z: 0 is a floor, 90 a wall, 180 a ceiling",
        default=_DENSITY.slope_to,
        min=0.0,
        max=math.pi,
        subtype="ANGLE",
    )
    slope_fade: FloatProperty(
        options=_STILL,
        update=_settings_changed,
        name="Fade",
        description="Over how many degrees beside the range the points get fewer",
        default=_DENSITY.slope_fade,
        min=0.0,
        max=math.pi,
        subtype="ANGLE",
    )
    use_height: BoolProperty(
        options=_STILL,
        update=_settings_changed,
        name="Height",
        description="Points only where world Z is in a range",
    )
    height_from: FloatProperty(
        options=_STILL,
        update=_settings_changed,
        name="From",
        description="Lowest world Z with full density",
        default=_DENSITY.height_from,
        unit="LENGTH",
    )
    height_to: FloatProperty(
        options=_STILL,
        update=_settings_changed,
        name="To",
        description="Highest world Z with full density",
        default=_DENSITY.height_to,
        unit="LENGTH",
    )
    height_fade: FloatProperty(
        options=_STILL,
        update=_settings_changed,
        name="Fade",
        description="Over what height beside the range the points get fewer",
        default=_DENSITY.height_fade,
        min=0.0,
        unit="LENGTH",
    )


class DAPPLE_PG_tiles(bpy.types.PropertyGroup):
    """How the cells of a scatter are made into tiles."""

    grout: FloatProperty(
        options=_STILL,
        name="Grout",
        description="Width of the gap between tiles, as a share of the points' spacing",
        default=_TILES.grout,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )
    inset_randomness: FloatProperty(
        options=_STILL,
        name="Random Inset",
        description="By how much more a tile may draw back, as a share of the points' spacing",
        default=_TILES.inset_randomness,
        min=0.0,
        max=0.5,
        subtype="FACTOR",
    )
    thickness: FloatProperty(
        options=_STILL,
        name="Thickness",
        description="Of the tiles, as a share of the points' spacing; 0 leaves them in the surface",
        default=_TILES.thickness,
        min=0.0,
        soft_max=1.0,
        subtype="FACTOR",
    )
    colour_by: EnumProperty(
        options=_STILL,
        name="Colour By",
        description="What the colour attribute of the tiles tells",
        items=[
            ("RANDOM", "Tile", "Each tile has a colour by chance of its id"),
            ("CLASS", "Class", "Tiles of one class have one colour"),
        ],
        default=_TILES.colour_by,
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
        update=_instance_changed,
    )
    collection: PointerProperty(
        name="Collection",
        description="Objects of which every point gets one by chance; goes before Instance",
        type=bpy.types.Collection,
        update=_instance_changed,
    )
    scale: FloatProperty(
        options=_STILL,
        name="Scale",
        description="Size of the instances",
        default=1.0,
        soft_min=0.0,
        soft_max=10.0,
        update=_instance_changed,
    )
    scale_randomness: FloatProperty(
        options=_STILL,
        name="Random Scale",
        description="By how much of their size instances may be smaller",
        default=0.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        update=_instance_changed,
    )
    turn_randomness: FloatProperty(
        options=_STILL,
        name="Random Turn",
        description="Share of a full turn by which instances are turned about the normal",
        default=1.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        update=_instance_changed,
    )


class DAPPLE_PG_class(Instanced, bpy.types.PropertyGroup):
    """One kind of things among several; its `name` is what the list shows."""

    use_count: BoolProperty(
        options=_STILL,
        update=_settings_changed,
        name="Exact Count",
        description="Give the class so many points, instead of a share of the rest",
    )
    count: IntProperty(
        options=_STILL,
        update=_settings_changed,
        name="Count",
        description="Number of points of the class, met exactly",
        default=100,
        min=1,
        soft_max=100_000,
    )
    share: FloatProperty(
        options=_STILL,
        update=_settings_changed,
        name="Share",
        description="Of the points that no class counts itself, in relation to the other shares",
        default=1.0,
        min=0.0,
        soft_max=10.0,
    )
    density: StringProperty(
        options=_STILL,
        update=_settings_changed,
        name="Density",
        description="Attribute or vertex group of the surface that multiplies its density for this "
        "class",
        search=_weight_names,
        search_options={"SUGGESTION"},
    )
    radius: FloatProperty(
        options=_STILL,
        update=_settings_changed,
        name="Radius",
        description="Of a thing on the ground: things of all classes are kept from overlapping",
        default=0.0,
        min=0.0,
        soft_max=10.0,
        unit="LENGTH",
    )


class DAPPLE_PG_scatter(Instanced, bpy.types.PropertyGroup):
    """Settings of a scatter object."""

    surface: PointerProperty(
        name="Surface",
        description="Mesh object to scatter over",
        type=bpy.types.Object,
        poll=_is_surface,
    )
    count: IntProperty(
        options=_STILL,
        update=_settings_changed,
        name="Count",
        description="Number of points, met exactly",
        default=_DEFAULT.count,
        min=1,
        soft_max=100_000,
    )
    seed: IntProperty(
        options=_STILL,
        update=_settings_changed,
        name="Seed",
        description="Another seed, another scatter",
        default=_DEFAULT.seed,
        min=0,
    )
    capacity_weight: FloatProperty(
        options=_STILL,
        update=_settings_changed,
        name="Capacity Weight",
        description="How much equal areas count against regular spacing; larger is less regular",
        default=_DEFAULT.capacity_weight,
        min=0.0,
        soft_max=100.0,
    )
    gap_weight: FloatProperty(
        options=_STILL,
        update=_settings_changed,
        name="Gap Weight",
        description="How much the smallest distances between neighbours count",
        default=_DEFAULT.gap_weight,
        min=0.0,
        soft_max=10.0,
    )
    tolerance: FloatProperty(
        options=_STILL,
        update=_settings_changed,
        name="Tolerance",
        description="Relative decrease of the energy at which to stop; smaller is more regular",
        default=_DEFAULT.tolerance,
        min=1e-9,
        max=1.0,
        precision=7,
    )
    max_evaluations: IntProperty(
        options=_STILL,
        update=_settings_changed,
        name="Max Evaluations",
        description="Evaluations of the energy after which the optimisation stops",
        default=_DEFAULT.max_evaluations,
        min=1,
        soft_max=1000,
    )
    classes: CollectionProperty(type=DAPPLE_PG_class)
    class_index: IntProperty(name="Class", description="The class that is shown", options=_STILL)
    key_every: IntProperty(
        options=_STILL,
        name="Key Every",
        description="Frames from one key to the next; more of them make a smaller file, "
        "the points of the frames between are mixed from the keys around",
        default=1,
        min=1,
        max=25,
    )
    stickiness: FloatProperty(
        options=_STILL,
        update=_settings_changed,
        name="Stickiness",
        description="How much points stay at their places on the deforming surface; more of it, "
        "and they slide less and are less even",
        default=_DEFAULT.stickiness,
        min=0.0,
        soft_max=100.0,
    )
    bake_smoothing: EnumProperty(
        options=_STILL,
        name="Smoothing",
        description="In which order a bake solves the frames",
        items=[
            ("FORWARDS", "Forwards", "Frame by frame; solved frames are kept beside the file"),
            ("BOTH_WAYS", "Both Ways", "All frames together: motion is smooth both ways in time"),
            ("LOOP", "Loop", "All frames together, and the last leads back to the first"),
        ],
        default="FORWARDS",
    )
    bind_to: EnumProperty(
        options=_STILL,
        update=_settings_changed,
        name="Bind To",
        description="What the points hold on to while the surface deforms",
        items=BIND_TO,
        default="FACES",
    )
    count_over_time: EnumProperty(
        options=_STILL,
        name="Count Over Time",
        description="What a bake keeps while the surface grows and shrinks",
        items=[
            ("KEEP_COUNT", "Keep Count", "The same points in all frames"),
            (
                "KEEP_DENSITY",
                "Keep Density",
                "As many points per area as at the start: some appear, some vanish; they fade",
            ),
        ],
        default="KEEP_COUNT",
    )
    fade_frames: IntProperty(
        options=_STILL,
        name="Fade",
        description="Frames that a point takes to appear or to vanish",
        default=12,
        min=1,
        soft_max=100,
    )
    on_topology_change: EnumProperty(
        options=_STILL,
        name="On Topology Change",
        description="What to do when the faces of the surface are not those the points are bound "
        "to, at the start of a bake or at a later frame",
        items=[
            ("REFUSE", "Refuse", "Stop with a sentence that names the frame"),
            ("REBIND", "Re-bind", "Go on from the places of the new faces that are nearest"),
        ],
        default="REFUSE",
    )
    preview_budget: IntProperty(
        options=_STILL,
        name="Preview Budget",
        description="Milliseconds that the live preview may take for a frame; when it takes "
        "longer, points ride on the surface",
        default=40,
        min=1,
        soft_max=1000,
    )
    density: PointerProperty(type=DAPPLE_PG_density)
    tiles: PointerProperty(type=DAPPLE_PG_tiles)
    report: PointerProperty(type=DAPPLE_PG_report)
    surface_vertices: IntProperty(
        options=_STILL,
        name="Surface Vertices",
        description="Vertices of the surface the points are bound to",
    )
    baked_start: IntProperty(name="First Baked Frame")
    bake_fingerprint: StringProperty(
        name="Bake Fingerprint", description="Digest of all that the keys were solved from"
    )
    bound_to: EnumProperty(
        name="Bound To", description="What the points hold on to now", items=BIND_TO
    )
    surface_topology: StringProperty(
        name="Surface Topology", description="Digest of the faces the points are bound to"
    )
    solved_settings: StringProperty(
        name="Solved Settings", description="Settings that the result was solved with, as JSON"
    )
    baked_frames: IntProperty(name="Baked Frames", description="Number of them, 0 if none")
    baked_keys: IntProperty(name="Baked Keys", description="Number of keys, 0 if none")


def settings_of(obj: bpy.types.Object) -> Settings:
    """The options that the native package takes."""
    values = {field.name: getattr(obj.dapple, field.name) for field in fields(Settings)}
    density = {f.name: getattr(obj.dapple.density, f.name) for f in fields(DensitySettings)}
    return Settings(
        **values
        | {
            "classes": tuple(map(_class_settings, obj.dapple.classes)),
            "density": DensitySettings(**density),
        }
    )


def tile_settings_of(obj: bpy.types.Object) -> TileSettings:
    """How the tiles of a scatter are cut."""
    tiles = obj.dapple.tiles
    return TileSettings(tiles.grout, tiles.inset_randomness, tiles.thickness, tiles.colour_by)


def _class_settings(kind: DAPPLE_PG_class) -> ClassSettings:
    share, count = (0.0, kind.count) if kind.use_count else (kind.share, 0)
    return ClassSettings(share, count, kind.radius, kind.density)


def write_report(obj: bpy.types.Object, report: Report) -> None:
    """Show these figures."""
    for field in fields(Report):
        setattr(obj.dapple.report, field.name, getattr(report, field.name))


CLASSES = (
    DAPPLE_PG_report,
    DAPPLE_PG_class,
    DAPPLE_PG_density,
    DAPPLE_PG_tiles,
    DAPPLE_PG_scatter,
)


def register() -> None:
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Object.dapple = PointerProperty(name=GROUP_NAME, type=DAPPLE_PG_scatter)


def unregister() -> None:
    del bpy.types.Object.dapple
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
