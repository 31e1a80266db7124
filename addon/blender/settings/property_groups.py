# SPDX-License-Identifier: GPL-3.0-or-later
"""Property groups of a scatter: report, density, tiles, object type, joined surface."""

from typing import Any

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ...core.settings.density_table import SHOWN_TERMS
from ...core.settings.tables import GROUPS
from ..base.translation import OWN
from .declarations import STILL, with_settings
from .updates import weight_changed

_SHARE: dict[str, Any] = {"min": 0.0, "soft_max": 1.0, "subtype": "FACTOR"}


class DAPPLE_PG_report(bpy.types.PropertyGroup):
    """Figures of the last optimization or bake."""

    __slots__ = ()  # a misspelled name is an error

    count: IntProperty(name="Points", description="Number of points", min=0, soft_max=100_000)
    spacing: FloatProperty(
        name="Spacing",
        description="Ideal spacing: the distance between neighbors if the points were packed as "
        "tightly as possible",
        min=0.0,
        soft_max=10.0,
        unit="LENGTH",
    )
    alpha_min: FloatProperty(
        name="Min Spacing",
        description="Smallest distance between two points, relative to the ideal spacing; 0 where "
        "the surface is thinner than that everywhere",
        **_SHARE,
    )
    alpha_mean: FloatProperty(
        name="Mean Spacing",
        description="Mean distance to the nearest point, relative to the ideal spacing; 0 where "
        "the surface is thinner than that everywhere",
        **_SHARE,
    )
    capacity_variation: FloatProperty(
        name="Area Variation",
        description="Standard deviation of the areas of the points, relative to their mean",
        **_SHARE,
    )
    whole_count_variation: FloatProperty(
        name="Due to Whole Counts",
        description="Part of the area variation that arises because each separate part of the "
        "surface has a whole number of points",
        **_SHARE,
    )
    thin_share: FloatProperty(
        name="On Thin Parts",
        description="Share of the points on parts of the surface that are thinner than the ideal "
        "spacing, such as wires. Min and Mean Spacing leave them out",
        **_SHARE,
    )
    doubled_faces: IntProperty(
        name="Doubled Faces",
        description="Number of faces that do not count because they lie on others",
        min=0,
    )
    small_parts: IntProperty(
        name="Small Parts",
        description="Number of connected parts of the surface that are too small for a whole point",
        min=0,
    )
    evaluations: IntProperty(
        name="Evaluations",
        description="Number of evaluations of the energy, which take most of the time",
        min=0,
        soft_max=1000,
    )
    milliseconds: FloatProperty(
        name="Milliseconds", description="How long the solution took, in milliseconds"
    )
    converged: BoolProperty(
        name="Converged",
        description="Whether the energy fell by less than the tolerance before the iterations "
        "were used up",
    )
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
    overlap_first: IntProperty(
        name="First Overlapping Point",
        description="ID of one of the two points that overlap most, -1 if none do",
        default=-1,
    )
    overlap_second: IntProperty(
        name="Second Overlapping Point",
        description="ID of the other of the two points that overlap most, -1 if none do",
        default=-1,
    )
    overlap_frame: IntProperty(
        name="Overlap Frame", description="Baked frame with the largest overlap"
    )
    overlap_between: BoolProperty(
        name="Overlap Between Keyframes",
        description="Whether the baked frame with the largest overlap is not a keyframe",
    )
    type_overlaps: StringProperty(
        name="Overlaps of Object Types",
        description="Largest overlap of each object type in a bake, its frame, and whether that is "
        "between keyframes, as JSON",
    )
    measured: BoolProperty(
        name="Measured",
        description="Whether the figures belong to the current points",
        default=True,
    )


@with_settings(GROUPS["density"])
class DAPPLE_PG_density(bpy.types.PropertyGroup):
    """Terms of the density, which are multiplied."""

    __slots__ = ()  # a misspelled name is an error

    shown_term: EnumProperty(
        name="Show",
        description="Term of the density that Show Density displays",
        items=SHOWN_TERMS,
        translation_context=OWN,  # of the items too, some of which Blender translates otherwise
        options=STILL,
    )


@with_settings(GROUPS["tiles"])
class DAPPLE_PG_tiles(bpy.types.PropertyGroup):
    """Settings of the tiles that are made from the cells of a scatter."""

    __slots__ = ()  # a misspelled name is an error

    object: PointerProperty(
        name="Tiles",
        description="Object that holds the tiles",
        type=bpy.types.Object,
    )


class DAPPLE_PG_weight(bpy.types.PropertyGroup):
    """How often an object of a collection, or a collection in it, is instanced."""

    __slots__ = ()  # a misspelled name is an error

    object: PointerProperty(
        name="Object",
        description="Object of the collection that the weight applies to",
        type=bpy.types.Object,
    )
    collection: PointerProperty(
        name="Collection",
        description="Nested collection that the weight applies to",
        type=bpy.types.Collection,
    )
    weight: FloatProperty(
        name="Weight",
        description="How often the object is picked, relative to the others of the collection",
        default=1.0,
        min=0.0,
        soft_max=10.0,
        options=STILL,
        update=weight_changed,
    )


@with_settings(GROUPS["object_types"])
class DAPPLE_PG_object_type(bpy.types.PropertyGroup):
    """An object type; the list shows its `name`."""

    __slots__ = ()  # a misspelled name is an error

    weights: CollectionProperty(
        name="Weights",
        description="How often each object of the collection is picked",
        type=DAPPLE_PG_weight,
    )


class DAPPLE_PG_part(bpy.types.PropertyGroup):
    """An object that is a part of a joined surface, or one that instances some parts."""

    __slots__ = ()  # a misspelled name is an error

    object: PointerProperty(
        name="Part", description="Object of the scene that is the part", type=bpy.types.Object
    )
    inside: IntProperty(
        name="Inside", description=("Index of the instancing object, -1 for an object of the scene")
    )
    instances: BoolProperty(
        name="Instances", description="Whether the part is an instance of a collection"
    )
    rest_scale: FloatProperty(
        name="Rest Scale", description="Scale of its rest positions on the joined surface"
    )
    rest_shift: FloatVectorProperty(
        name="Rest Shift", description="Shift of its rest positions on the joined surface"
    )


class DAPPLE_PG_parts(bpy.types.PropertyGroup):
    """The parts of a scatter's joined surface. If the scatter is copied together with them, Blender
    replaces them by the copies; the surface itself is in no collection and is never copied.
    """

    __slots__ = ()  # a misspelled name is an error

    surface: PointerProperty(
        name="Surface", description="Surface that the parts belong to", type=bpy.types.Object
    )
    entries: CollectionProperty(
        name="Parts", description="Objects that are one surface", type=DAPPLE_PG_part
    )


class DAPPLE_PG_joined(bpy.types.PropertyGroup):
    """The parts of a joined surface; empty for other objects."""

    __slots__ = ()  # a misspelled name is an error

    entries: CollectionProperty(
        name="Parts", description="Objects that are one surface", type=DAPPLE_PG_part
    )
    collection: PointerProperty(
        name="Collection",
        description="Collection whose objects are the parts, if there is one",
        type=bpy.types.Collection,
    )
    cells: IntProperty(name="Cells", description="Number of parts that were ever added")
