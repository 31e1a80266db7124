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

from ..core.forward import AXES
from ..core.settings import Settings
from ..nodes import GROUP_NAME
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
from .scatter import is_surface
from .translation import OWN

_DEFAULT = Settings()
_OVERRIDE = {"LIBRARY_OVERRIDABLE"}
BOUND_TO = [  # the numbers are those of older files
    ("FACES", "Faces", "Faces after all modifiers, which must be the same everywhere", 0),
    (
        "REST",
        "Rest Position",
        "The shape before all modifiers: they may make other faces in every frame or in the "
        "render. Turns on the surface's Rest Position",
        1,
    ),
]
BIND_TO = [
    (
        "AUTO",
        "Automatic",
        "Faces, or the rest position where viewport and render have different faces",
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
        description="Object to scatter over: a mesh, curve, text or metaball",
        type=bpy.types.Object,
        poll=_is_surface,
    )
    count: IntProperty(
        options=STILL,
        update=settings_changed,
        name="Count",
        description="Number of points, met exactly",
        default=_DEFAULT.count,
        min=1,
        soft_max=100_000,
    )
    amount: EnumProperty(
        options=STILL,
        update=settings_changed,
        name="Amount",
        description="What tells the number of points",
        items=[
            ("COUNT", "Count", "Exactly so many points"),
            ("PER_AREA", "Per Area", "So many points on a square unit of the surface in the world"),
        ],
        default="COUNT",
    )
    points_per_area: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Points per Area",
        description="On a square unit of the surface, with its scale, where the density is 1",
        default=100.0,
        min=0.0001,
        soft_max=10_000.0,
    )
    seed: IntProperty(
        options=STILL,
        update=settings_changed,
        name="Seed",
        description="Another seed, another scatter",
        default=_DEFAULT.seed,
        min=0,
    )
    capacity_weight: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Capacity Weight",
        description="How much equal areas count against regular spacing; larger is less regular",
        default=_DEFAULT.capacity_weight,
        min=0.0,
        soft_max=100.0,
    )
    gap_weight: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Gap Weight",
        description="How much the smallest distances between neighbors count",
        default=_DEFAULT.gap_weight,
        min=0.0,
        soft_max=10.0,
    )
    tolerance: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Tolerance",
        description="Relative decrease of the energy at which to stop; smaller is more regular",
        default=_DEFAULT.tolerance,
        min=1e-9,
        max=1.0,
        precision=7,
    )
    max_evaluations: IntProperty(
        options=STILL,
        update=settings_changed,
        name="Max Evaluations",
        description="Evaluations of the energy after which the optimization stops",
        default=_DEFAULT.max_evaluations,
        min=1,
        soft_max=1000,
    )
    forward: EnumProperty(
        options=STILL,
        update=settings_changed,
        name="Forward",
        description="Axis of the surface object along which the X axis of the things points, as "
        "far as the surface lets it; then they turn with the surface. Set Random Turn to 0",
        items=[
            ("NONE", "Any", "Things point anywhere"),
            *((axis, axis, f"Along {axis} of the surface object") for axis in AXES),
        ],
        default="NONE",
    )
    viewport_share: FloatProperty(
        options=STILL,
        update=instance_changed,
        name="Show in Viewport",
        description="Share of the points that the viewport shows, evenly spread; renders show all",
        default=1.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )
    classes: CollectionProperty(type=DAPPLE_PG_class)
    class_index: IntProperty(name="Class", description="The class that is shown", options=STILL)
    key_every: IntProperty(
        options=STILL,
        update=settings_changed,
        name="Key Every",
        description="Frames from one key to the next; more of them make a smaller file, "
        "the points of the frames between are mixed from the keys around",
        default=1,
        min=1,
        max=25,
    )
    stickiness: FloatProperty(
        options=STILL,
        update=settings_changed,
        name="Stickiness",
        description="How much points stay at their places on the deforming surface; more of it, "
        "and they slide less and are less even",
        default=_DEFAULT.stickiness,
        min=0.0,
        soft_max=100.0,
    )
    bake_smoothing: EnumProperty(
        options=STILL,
        update=settings_changed,
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
        options=STILL,
        update=settings_changed,
        name="Bind To",
        description="What the points hold on to while the surface deforms",
        items=BIND_TO,
        translation_context=OWN,
        default="AUTO",
    )
    bound_parts: IntProperty(
        options=STILL,
        name="Bound Parts",
        description="Equal runs of faces that may lie on one another in the rest position",
        default=1,
    )
    count_over_time: EnumProperty(
        options=STILL,
        update=settings_changed,
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
        options=STILL,
        update=settings_changed,
        name="Fade",
        description="Frames that a point takes to appear or to vanish",
        default=12,
        min=1,
        soft_max=100,
    )
    on_topology_change: EnumProperty(
        options=STILL,
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
        options=STILL,
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
    solved: PointerProperty(
        name="Solved",
        description="Figures of the solution that a bake began with",
        type=DAPPLE_PG_report,
    )
    surface_vertices: IntProperty(
        options=STILL,
        name="Surface Vertices",
        description="Vertices of the surface the points are bound to",
    )
    locked_count: IntProperty(
        options=STILL, name="Locked Points", description="Points that stay where they are"
    )
    baked_start: IntProperty(name="First Baked Frame")
    bake_fingerprint: StringProperty(
        name="Bake Fingerprint", description="Digest of all that the keys were solved from"
    )
    bake_key: StringProperty(
        name="Bake Key", description="By which frames of a stopped bake are found"
    )
    bound_to: EnumProperty(
        name="Bound To",
        description="What the points hold on to now",
        items=BOUND_TO,
        translation_context=OWN,
    )
    surface_topology: StringProperty(
        name="Surface Topology", description="Digest of the faces the points are bound to"
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
        name="Baked Settings", description="Settings of the bake alone, as JSON"
    )
    baked_from: StringProperty(
        name="Baked From",
        description="Digests of what the first baked frame was solved from, as JSON",
    )
    baked_frames: IntProperty(name="Baked Frames", description="Number of them, 0 if none")
    baked_keys: IntProperty(name="Baked Keys", description="Number of keys, 0 if none")


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
