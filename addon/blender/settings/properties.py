# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties of a scatter object: what is set, and the figures of the last result."""

import bpy
from bpy.props import (
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ...core.forward import AXES
from ...core.settings import Settings
from ...nodes import GROUP_NAME
from ..base.translation import OWN
from ..data.scatter import is_surface
from .property_groups import (
    STILL,
    DAPPLE_PG_class,
    DAPPLE_PG_density,
    DAPPLE_PG_report,
    DAPPLE_PG_tiles,
    Instanced,
    instance_changed,
    settings_changed,
)

_DEFAULT = Settings()
_OVERRIDE = {"LIBRARY_OVERRIDABLE"}
BOUND_TO = [  # the numbers are those of older files
    (
        "FACES",
        "Faces",
        "Faces after all modifiers, which must be the same in the viewport and in renders",
        0,
    ),
    (
        "REST",
        "Rest Position",
        "Shape before all modifiers, which may change the faces in every frame and in "
        "renders. Enables Rest Position on the surface",
        1,
    ),
]
BIND_TO = [
    (
        "AUTO",
        "Automatic",
        "Faces, or the rest position if the viewport and renders have different faces",
        2,
    ),
    *BOUND_TO,
]


def _is_surface(settings: "DAPPLE_PG_scatter", obj: bpy.types.Object) -> bool:
    return is_surface(obj)


class DAPPLE_PG_scatter(Instanced, bpy.types.PropertyGroup):
    """Settings of a scatter object."""

    surface: PointerProperty(
        update=settings_changed,
        name="Surface",
        description="Object to scatter points on: a mesh, curve, text or metaball",
        type=bpy.types.Object,
        poll=_is_surface,
    )
    count: IntProperty(
        options=STILL,
        update=settings_changed,
        name="Count",
        description="Exact number of points",
        default=_DEFAULT.count,
        min=1,
        soft_max=100_000,
    )
    amount: EnumProperty(
        options=STILL,
        update=settings_changed,
        name="Amount",
        description="How the number of points is defined",
        items=[
            ("COUNT", "Count", "An exact number of points"),
            (
                "PER_AREA",
                "Per Area",
                "A number of points per square unit of the surface in world space",
            ),
        ],
        default="COUNT",
    )
    points_per_area: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Points per Area",
        description="Number of points on a square unit of the surface in world space where the "
        "density is 1",
        default=100.0,
        min=0.0001,
        soft_max=10_000.0,
    )
    seed: IntProperty(
        options=STILL,
        update=settings_changed,
        name="Seed",
        description="Seed of the random start; each seed gives another scatter",
        default=_DEFAULT.seed,
        min=0,
    )
    capacity_weight: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Area Uniformity",
        description="How strongly the areas of the points are made equal, at the expense of "
        "regular spacing",
        default=_DEFAULT.capacity_weight,
        min=0.0,
        soft_max=100.0,
    )
    repulsion_weight: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Separation",
        description="How strongly close neighbors are pushed apart",
        default=_DEFAULT.repulsion_weight,
        min=0.0,
        soft_max=10.0,
    )
    tolerance: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Tolerance",
        description="Stop when the relative decrease of the energy falls below this value; "
        "smaller is more regular",
        default=_DEFAULT.tolerance,
        min=1e-9,
        max=1.0,
        precision=7,
    )
    max_evaluations: IntProperty(
        options=STILL,
        update=settings_changed,
        name="Max Iterations",
        description="Stop after this many evaluations of the energy",
        default=_DEFAULT.max_evaluations,
        min=1,
        soft_max=1000,
    )
    forward: EnumProperty(
        options=STILL,
        update=settings_changed,
        name="Forward Axis",
        description="Axis of the surface object that the X axis of the instances follows along the "
        "surface; instances then turn with the surface. Set Random Z Rotation to 0",
        items=[
            ("NONE", "Any", "Instances point in any direction"),
            *((axis, axis, f"{axis} axis of the surface object") for axis in AXES),
        ],
        default="NONE",
    )
    viewport_share: FloatProperty(
        options=STILL,
        update=instance_changed,
        name="Viewport Amount",
        description="Fraction of the points shown in the viewport, evenly spread; renders show all "
        "points",
        default=1.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )
    classes: CollectionProperty(name="Object Types", type=DAPPLE_PG_class)
    class_index: IntProperty(
        name="Active Object Type", description="Object type shown in the panel", options=STILL
    )
    key_every: IntProperty(
        options=STILL,
        update=settings_changed,
        name="Keyframe Interval",
        description="Number of frames from one keyframe to the next; larger intervals make smaller "
        "files, and points are interpolated in between",
        default=1,
        min=1,
        max=25,
    )
    stickiness: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Stickiness",
        description="How firmly points stick to their place on the deforming surface; with higher "
        "values they slide less and are less even",
        default=_DEFAULT.stickiness,
        min=0.0,
        soft_max=100.0,
    )
    bake_smoothing: EnumProperty(
        options=STILL,
        update=settings_changed,
        name="Smoothing",
        description="How a bake smooths the motion of the points over time",
        items=[
            (
                "FORWARDS",
                "Forward",
                "Solve frame by frame; solved frames are kept next to the file",
            ),
            (
                "BOTH_WAYS",
                "Both Directions",
                "Solve all frames together: motion is smooth in both directions of time",
            ),
            (
                "LOOP",
                "Loop",
                "Solve all frames together, with the last frame leading back to the first",
            ),
        ],
        default="FORWARDS",
    )
    bind_to: EnumProperty(
        options=STILL,
        update=settings_changed,
        name="Attach To",
        description="What the points are attached to while the surface deforms",
        items=BIND_TO,
        translation_context=OWN,
        default="AUTO",
    )
    bound_parts: IntProperty(
        options=STILL,
        name="Attached Parts",
        description="Equal ranges of faces that may overlap in the rest position",
        default=1,
    )
    count_over_time: EnumProperty(
        options=STILL,
        update=settings_changed,
        name="Population",
        description="What a bake preserves while the surface grows and shrinks",
        items=[
            ("KEEP_COUNT", "Keep Count", "The same points in all frames"),
            (
                "KEEP_DENSITY",
                "Keep Density",
                "As many points per area as at the start; points fade in and out",
            ),
        ],
        default="KEEP_COUNT",
    )
    fade_frames: IntProperty(
        options=STILL,
        update=settings_changed,
        name="Fade Duration",
        description="Number of frames over which a point appears or vanishes",
        default=12,
        min=1,
        soft_max=100,
    )
    on_topology_change: EnumProperty(
        options=STILL,
        name="On Topology Change",
        description="What to do if the faces of the surface are not those that the points are "
        "attached to, at the start of a bake or in a later frame",
        items=[
            ("REFUSE", "Stop", "Stop with an error message that names the frame"),
            ("REBIND", "Reattach", "Continue from the nearest places on the new faces"),
        ],
        default="REFUSE",
    )
    preview_budget: IntProperty(
        options=STILL,
        name="Preview Budget",
        description="Time limit of the live preview per frame, in milliseconds; if it takes "
        "longer, points stick to the surface",
        default=40,
        min=1,
        soft_max=1000,
    )
    density: PointerProperty(name="Density", type=DAPPLE_PG_density)
    tiles: PointerProperty(type=DAPPLE_PG_tiles)
    report: PointerProperty(type=DAPPLE_PG_report)
    solved: PointerProperty(
        name="Solved",
        description="Figures of the result that the bake started from",
        type=DAPPLE_PG_report,
    )
    surface_vertices: IntProperty(
        options=STILL,
        name="Surface Vertices",
        description="Number of vertices of the surface that the points are attached to",
    )
    locked_count: IntProperty(
        options=STILL, name="Locked Points", description="Number of points that stay in place"
    )
    baked_start: IntProperty(name="First Baked Frame")
    bake_fingerprint: StringProperty(
        name="Bake Fingerprint",
        description="Digest of everything that the keyframes were solved from",
    )
    bake_key: StringProperty(
        name="Bake Key", description="Identifies the frames that a stopped bake left behind"
    )
    bound_to: EnumProperty(
        name="Attached To",
        description="What the points are attached to now",
        items=BOUND_TO,
        translation_context=OWN,
    )
    surface_topology: StringProperty(
        name="Surface Topology", description="Digest of the faces that the points are attached to"
    )
    solved_settings: StringProperty(
        name="Solved Settings", description="Settings that the result was solved with, as JSON"
    )
    solved_from: StringProperty(
        name="Solved From",
        description="Digests of what the points were solved from, as JSON",
    )
    solved_points: StringProperty(
        name="Solved Points", description="Digest of the points as they were stored"
    )
    baked_settings: StringProperty(
        name="Baked Settings", description="Settings of the bake only, as JSON"
    )
    baked_from: StringProperty(
        name="Baked From",
        description="Digests of what the first baked frame was solved from, as JSON",
    )
    baked_frames: IntProperty(
        name="Baked Frames", description="Number of baked frames, 0 if there are none"
    )
    baked_keys: IntProperty(
        name="Baked Keyframes", description="Number of baked keyframes, 0 if there are none"
    )


CLASSES = (
    DAPPLE_PG_report,
    DAPPLE_PG_class,
    DAPPLE_PG_density,
    DAPPLE_PG_tiles,
    DAPPLE_PG_scatter,
)


def _allow_overrides(cls: type[bpy.types.PropertyGroup]) -> None:
    """Have library overrides keep every property of a group, also those of its mixins."""
    for base in cls.__mro__:
        for declared in getattr(base, "__annotations__", {}).values():
            if hasattr(declared, "keywords"):
                declared.keywords["override"] = _OVERRIDE


def register() -> None:
    for cls in CLASSES:
        _allow_overrides(cls)
        bpy.utils.register_class(cls)
    bpy.types.Object.dapple = PointerProperty(
        name=GROUP_NAME, type=DAPPLE_PG_scatter, override=_OVERRIDE
    )


def unregister() -> None:
    if hasattr(bpy.types.Object, "dapple"):
        del bpy.types.Object.dapple
    for cls in filter(is_registered, reversed(CLASSES)):
        bpy.utils.unregister_class(cls)


def is_registered(cls: type) -> bool:
    """Whether Blender knows a class."""
    return "bl_rna" in cls.__dict__
