# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of object types: its operators, counts of points, and the pair with the
largest overlap.
"""

import bpy
import numpy as np
from bpy.props import EnumProperty
from mathutils import Vector
from numpy.typing import NDArray

from ...core.base.errors import ScatterError
from ...core.density.counts import class_counts, with_area
from ...core.solve.stale import changed_settings
from ...core.surface.arrays import Floats, Ints
from ...core.surface.sources import sources_from
from ...nodes import INSTANCE_INPUTS
from ..base import activity, operator_jobs
from ..base.handlers import Evaluation, Subscriber
from ..base.quiet import is_quiet
from ..base.step_operators import OPTIONS, AllOrNothing
from ..base.times import show_time
from ..base.translation import translated, translated_report
from ..scatter.linked_data import read_only
from ..scatter.modifier import ensure_modifier, property_name, write_instance_inputs
from ..scatter.object import is_scatter, settings_of
from ..scatter.placed_objects import follow_bounds, follow_members
from ..scatter.points import own_columns, point_columns_of
from ..settings.updates import settings_changed
from ..surface.playback import places_now
from ..surface.polls import may_be_listed, writable
from .overlapping import overlapping_ids

_COUNTING = {"count", "per_area", "density", "object_types"}  # what the number of points depends on


def edit_object_types(obj: bpy.types.Object, action: str) -> None:
    """ADD, REMOVE, or move UP or DOWN the active object type; the node group is updated."""
    kinds, at = obj.dapple.object_types, obj.dapple.object_type_index
    if action == "ADD":
        _add(obj)
        at = len(kinds) - 1
    elif action == "REMOVE" and 0 <= at < len(kinds):
        kinds.remove(at)
        at = min(at, len(kinds) - 1)
    elif action in ("UP", "DOWN"):
        to = at + (1 if action == "DOWN" else -1)
        if 0 <= to < len(kinds):
            kinds.move(at, to)
            at = to
    obj.dapple.object_type_index = max(at, 0)
    ensure_modifier(obj)
    write_instance_inputs(obj)


def _add(obj: bpy.types.Object) -> None:
    kind = obj.dapple.object_types.add()
    count = len(obj.dapple.object_types)
    kind.name = f"Type {count}"  # until it has an instance
    if count > 1:
        return
    for label, _ in INSTANCE_INPUTS:  # the current instances stay
        name = property_name(label)
        setattr(kind, name, getattr(obj.dapple, name))
    kind.use_weights = obj.dapple.use_weights
    for one, own in zip(kind.weights, obj.dapple.weights, strict=False):
        one.weight = own.weight


def count_labels(obj: bpy.types.Object) -> list[str]:
    """The number of points of each object type, as text for the list; a number that will change is
    marked with a tilde, an error is shown instead of a number.
    """
    settings = settings_of(obj)
    changed = changed_settings(obj.dapple.solved_settings, settings)
    try:
        if obj.dapple.solved_settings and not _COUNTING.intersection(changed):
            return [f"{count:,}" for count in _counted(obj)]
        if settings.per_area:
            settings = with_area(settings, _solved_mass(obj))
        return [f"~{count:,}" for count in class_counts(settings)]
    except ScatterError:
        return ["?"] * len(obj.dapple.object_types)


def _counted(obj: bpy.types.Object) -> list[int]:
    """The current number of points of each object type."""
    classes, most = (
        own_columns(obj, {"dapple_object_type": "INT"})["dapple_object_type"],
        len(obj.dapple.object_types),
    )
    return np.bincount(classes, minlength=most)[:most].tolist()


def _solved_mass(obj: bpy.types.Object) -> float:
    """The integral of the density of the last solution."""
    sources = sources_from(obj.dapple.solved_from)
    if sources is None or not sources.capacity:
        raise ScatterError(f"Scatter '{obj.name}' was not solved by this version")
    return sources.capacity


def select_overlap(obj: bpy.types.Object, context: bpy.types.Context) -> Vector:
    """Select the two points whose instances overlap most; returns the place between them in world
    space.

    If baked, the scene goes to the frame with this overlap.

    Raises:     ScatterError: a point does not exist any more, or has no place on the current
    surface.
    """
    report = obj.dapple.report
    ids = point_columns_of(obj)["id"]
    pair = [_row(ids, one, obj.name) for one in (report.overlap_first, report.overlap_second)]
    between = _places_of(obj, pair, context).mean(axis=0)
    if not np.isfinite(between).all():
        raise ScatterError(f"Scatter '{obj.name}' has points whose positions are not finite")
    chosen = np.zeros(len(obj.data.vertices), dtype=bool)
    chosen[pair] = True
    select_points(obj, chosen)
    return Vector(between)


def select_points(obj: bpy.types.Object, chosen: NDArray[np.bool_]) -> None:
    """Select these points of a scatter (n,) and no others."""
    obj.data.vertices.foreach_set("select", chosen)
    obj.data.update()


def _places_of(obj: bpy.types.Object, rows: list[int], context: bpy.types.Context) -> Floats:
    scene, report = context.scene, obj.dapple.report
    if not obj.dapple.baked_keys or not report.overlap_frame:
        return places_now(obj, rows, context)
    if not 0 <= report.overlap_frame - obj.dapple.baked_start < obj.dapple.baked_frames:
        raise ScatterError(
            f"Scatter '{obj.name}': frame {report.overlap_frame} is not baked: bake again"
        )
    before = scene.frame_current, scene.frame_subframe
    show_time(scene, report.overlap_frame)
    try:
        return places_now(obj, rows, context)
    except ScatterError:
        scene.frame_set(before[0], subframe=before[1])
        raise


def _row(ids: Ints, one: int, name: str) -> int:
    found = np.flatnonzero(ids == one)
    if not len(found):
        raise ScatterError(f"Scatter '{name}': point {one} was removed: optimize the scatter")
    return int(found[0])


class DAPPLE_OT_edit_object_types(AllOrNothing, bpy.types.Operator):
    """Edit the list of object types; optimize again to apply"""

    bl_idname = "dapple.edit_object_types"
    bl_label = "Edit Object Types"
    bl_options = OPTIONS

    action: EnumProperty(
        name="Action",
        description="Change to the list",
        items=[
            (
                "ADD",
                "Add",
                "Add an object type; the first one takes over the current instance settings",
            ),
            ("REMOVE", "Remove", "Remove the active object type"),
            ("UP", "Move Up", "Move the active object type up"),
            ("DOWN", "Move Down", "Move the active object type down"),
        ],
        default="ADD",
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        why = translated(
            "The object types come from a linked file: edit them there, or make the scatter local"
        )
        return may_be_listed(cls, context, why)

    def work(self, context: bpy.types.Context) -> None:
        edit_object_types(context.object, self.action)
        settings_changed(context.object.dapple, context)


class DAPPLE_OT_select_overlap(AllOrNothing, bpy.types.Operator):
    """Select the two points whose instances overlap most and place the 3D cursor between them; if
    baked, go to the frame with the largest overlap"""

    bl_idname = "dapple.select_overlap"
    bl_label = "Select Overlap"
    bl_options = OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        there = writable(cls, context) and context.mode == "OBJECT"
        return there and context.object.dapple.report.worst_overlap > 0

    def work(self, context: bpy.types.Context) -> None:
        context.scene.cursor.location = select_overlap(context.object, context)


class DAPPLE_OT_select_overlapping(AllOrNothing, bpy.types.Operator):
    """Select the points whose instances overlap those of other points on this frame, as renders
    show them"""

    bl_idname = "dapple.select_overlapping"
    bl_label = "Select Overlapping Instances"
    bl_options = OPTIONS

    shape: EnumProperty(
        name="Shape",
        description="What an instance occupies",
        items=(
            ("BOX", "Bounding Box", "The box around it, which turns with the instance"),
            ("HULL", "Convex Hull", "The smallest convex shape around it"),
        ),
        default="HULL",
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return writable(cls, context) and context.mode == "OBJECT"

    def work(self, context: bpy.types.Context) -> None:
        obj = context.object
        ids, total = overlapping_ids(obj, self.shape)
        chosen = np.isin(point_columns_of(obj)["id"], list(ids))
        select_points(obj, chosen)
        text = translated_report(
            "'{name}': {count:,} of {total:,} instances overlap",
            name=obj.name,
            count=len(ids),
            total=total,
        )
        self.report({"INFO"}, text)


CLASSES = (
    DAPPLE_OT_edit_object_types,
    DAPPLE_OT_select_overlap,
    DAPPLE_OT_select_overlapping,
)


def _updated(evaluation: Evaluation) -> None:
    """Update scatters whose instances have changed; Blender evaluates these scatters too."""
    if is_quiet() or operator_jobs.current() is not None or activity.is_rendering():
        return
    for obj, _ in evaluation.objects():
        if is_scatter(obj) and not read_only(obj):
            _follow(obj, evaluation.depsgraph)


def _follow(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> None:
    if any([follow_members(kind) for kind in (obj.dapple, *obj.dapple.object_types)]):
        write_instance_inputs(obj)
    for kind in obj.dapple.object_types:
        follow_bounds(kind, depsgraph)


SUBSCRIBER = Subscriber(updated=_updated)
