# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties of a scatter object: settings, and data about the last result."""

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ...core.settings.solver_options import CUSTOM, QUALITIES
from ...core.settings.tables import BOUND_TO, GROUPS
from ...nodes import GROUP_NAME
from ..base.translation import OWN
from .declarations import STILL, DAPPLE_PG_material, with_settings
from .property_groups import (
    DAPPLE_PG_density,
    DAPPLE_PG_joined,
    DAPPLE_PG_object_type,
    DAPPLE_PG_part,
    DAPPLE_PG_parts,
    DAPPLE_PG_report,
    DAPPLE_PG_tiles,
    DAPPLE_PG_weight,
)
from .updates import (
    count_changed,
    get_auto_update,
    get_quality,
    scatter_on_changed,
    set_auto_update,
    set_quality,
)

_OVERRIDE = {"LIBRARY_OVERRIDABLE"}


@with_settings(GROUPS[""], {"count": count_changed, "scatter_on": scatter_on_changed})
class DAPPLE_PG_scatter(bpy.types.PropertyGroup):
    """Settings of a scatter object."""

    __slots__ = ()  # a misspelled name is an error

    auto_update: BoolProperty(
        name="Auto Update",
        description="Solve again after each change of a setting, the surface or avoided "
        "objects. By default on while the last solution took less than a "
        "second",
        options=STILL,
        translation_context=OWN,
        get=get_auto_update,
        set=set_auto_update,
    )
    quality: EnumProperty(
        name="Quality",
        description="How even and how regular the points become",
        items=[(*one, number) for number, one in enumerate((*QUALITIES, CUSTOM))],
        options=STILL,
        translation_context=OWN,
        get=get_quality,
        set=set_quality,
    )
    weights: CollectionProperty(
        name="Weights",
        description="How often each object of the collection is picked",
        type=DAPPLE_PG_weight,
    )
    object_types: CollectionProperty(
        name="Object Types",
        description="Object types that are scattered together, if there are several",
        type=DAPPLE_PG_object_type,
    )
    object_type_index: IntProperty(
        name="Active Object Type",
        description="Object type shown in the panel",
        min=0,
        soft_max=99,
        options=STILL,
    )
    default_count: BoolProperty(
        options=STILL,
        name="Default Count",
        description="Whether Count is the number that edges begin with, not a chosen one",
    )
    attached_parts: IntProperty(
        options=STILL,
        name="Attached Parts",
        description="Equal ranges of faces that may overlap in the rest position",
        default=1,
    )
    density: PointerProperty(
        name="Density",
        description="Areas with more, fewer or no points",
        type=DAPPLE_PG_density,
    )
    tiles: PointerProperty(
        name="Tiles",
        description="How the areas of the points become tiles",
        type=DAPPLE_PG_tiles,
    )
    joined: PointerProperty(
        name="Joined Surface",
        description="Parts of a surface that is made of several objects",
        type=DAPPLE_PG_joined,
    )
    parts: PointerProperty(
        name="Parts",
        description="Parts of the surface that the scatter is on, if that is made of several",
        type=DAPPLE_PG_parts,
    )
    report: PointerProperty(
        name="Report",
        description="Figures of the last optimization or bake",
        type=DAPPLE_PG_report,
    )
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
    baked_start: IntProperty(
        name="First Baked Frame", description="Frame of the scene that the bake starts at"
    )
    bake_fingerprint: StringProperty(
        name="Bake Fingerprint",
        description="Digest of everything that the keyframes were solved from",
    )
    baked_frozen: StringProperty(
        name="Frozen in the Bake",
        description=(
            "Objects that moved during the bake although the density was that of its first frame"
        ),
    )
    bake_key: StringProperty(
        name="Bake Key", description="Identifies the frames that a stopped bake left behind"
    )
    attached_to: EnumProperty(
        name="Attached To",
        description="Geometry that the points are attached to now",
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


def _allow_overrides(cls: type[bpy.types.PropertyGroup]) -> None:
    """Let library overrides save every property of a group."""
    for declared in cls.__annotations__.values():
        declared.keywords["override"] = _OVERRIDE


def register() -> None:
    for cls in CLASSES:
        _allow_overrides(cls)
        bpy.utils.register_class(cls)
    bpy.types.Object.dapple = PointerProperty(
        name=GROUP_NAME, type=DAPPLE_PG_scatter, override=_OVERRIDE
    )
    bpy.types.Scene.dapple_painted = StringProperty(
        name="Painted Scatter",
        description="Scatter whose surface is painted, until Done",
        options={"HIDDEN"},
    )


def unregister() -> None:
    if hasattr(bpy.types.Scene, "dapple_painted"):
        del bpy.types.Scene.dapple_painted
    if hasattr(bpy.types.Object, "dapple"):
        del bpy.types.Object.dapple
    for cls in filter(is_registered, reversed(CLASSES)):
        bpy.utils.unregister_class(cls)


def is_registered(cls: type) -> bool:
    """Whether a class is registered in Blender."""
    return "bl_rna" in cls.__dict__


CLASSES = (
    DAPPLE_PG_report,
    DAPPLE_PG_material,
    DAPPLE_PG_weight,
    DAPPLE_PG_object_type,
    DAPPLE_PG_density,
    DAPPLE_PG_tiles,
    DAPPLE_PG_part,
    DAPPLE_PG_parts,
    DAPPLE_PG_joined,
    DAPPLE_PG_scatter,
)
