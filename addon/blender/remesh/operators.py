# SPDX-License-Identifier: GPL-3.0-or-later
"""Remesh with Dapple: the operator, its dialog and its steps."""

import math
from typing import Any

import bpy

from ...core.base.errors import ScatterError
from ...core.base.steps import Steps, Task
from ...core.remesh import NewMesh, Options, remeshed
from ..base.all_or_nothing import Status, all_or_nothing
from ..base.object_handles import ObjectHandle
from ..base.operator_jobs import Messages, Outcome
from ..base.step_operators import OPTIONS, StepsOperator
from ..base.translation import translated, translated_report
from ..scatter.linked_data import read_only
from ..scatter.object import is_scatter
from ..surface.polls import free
from .reading import read_old
from .writing import write_new

_MOST = 10_000_000


class DAPPLE_OT_remesh(StepsOperator, bpy.types.Operator):
    """Replace the mesh by even triangles on the same surface. Texture coordinates, colors, vertex
    groups, shape keys, materials, attributes and modifiers are kept; seams, creases, borders and
    marked edges stay where they are"""

    bl_idname = "dapple.remesh"
    bl_label = "Remesh with Dapple"
    bl_options = OPTIONS

    count: bpy.props.IntProperty(
        name="Vertices",
        description="Number of vertices of the new mesh; the result has more only if its topology"
        " or the lines that are kept need them",
        default=5000,
        min=1,
        soft_min=8,
        soft_max=100_000,
        max=_MOST,
    )
    feature_angle: bpy.props.FloatProperty(
        name="Crease Angle",
        description="Edges between faces that differ by more than this angle are creases, which "
        "are kept; 180 degrees keeps none",
        default=math.radians(30),
        min=0.0,
        max=math.pi,
        subtype="ANGLE",
    )

    max_distance: bpy.props.FloatProperty(
        name="Max Distance",
        description="Largest distance between the old mesh and the new one: vertices are added "
        "where it would be larger. 0 sets no limit",
        default=0.0,
        min=0.0,
        subtype="DISTANCE",
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        obj = context.object
        if not free(cls):
            return False
        if context.mode != "OBJECT" or obj is None or obj.type != "MESH":
            cls.poll_message_set(translated("Needs an active mesh object in Object Mode"))
        elif is_scatter(obj):
            cls.poll_message_set(translated("The active object is a scatter, not a surface"))
        elif read_only(obj) or not obj.data.is_editable:
            cls.poll_message_set(
                read_only(obj) or translated("The mesh of the active object is linked")
            )
        else:
            return True
        return False

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> Status:
        """Ask for the number of vertices, starting with the current number."""
        if not self.properties.is_property_set("count"):
            self.count = len(context.object.data.vertices)
        if bpy.app.background:
            return super().invoke(context, event)
        self.asked = True
        status: Status = context.window_manager.invoke_props_dialog(self)
        return status

    def execute(self, context: bpy.types.Context) -> Status:
        """Do the work now in a script, or in the background after the dialog."""
        if getattr(self, "asked", False):
            return super().invoke(context, None)
        return super().execute(context)

    def steps(self, context: bpy.types.Context) -> Steps:
        options = {
            "feature_angle": math.degrees(self.feature_angle),
            "max_distance": self.max_distance,
        }
        return remesh_steps(context.object, self.count, options)

    def watched(self, context: bpy.types.Context) -> dict[int, str]:
        return {one.session_uid: one.name for one in (context.object, context.object.data)}

    @staticmethod
    def done(context: bpy.types.Context, result: Any, obj: bpy.types.Object) -> Outcome:
        return Outcome(obj, _messages(obj.name, result))


def _messages(name: str, new: NewMesh) -> Messages:
    """What the artist is told about a new mesh."""
    report = new.report
    text = translated_report(
        "'{name}': {vertices:,} vertices, {faces:,} triangles, angles from {angle:.0f} degrees",
        name=name,
        vertices=report.vertices,
        faces=report.faces,
        angle=report.smallest_angle,
    )
    found = [("INFO", text), *_more_vertices(new)]
    if report.dropped_lines:
        given_up = translated_report(
            "{count:,} creases or seams were lost: more vertices may keep them",
            count=report.dropped_lines,
        )
        found.append(("WARNING", given_up))
    if report.flaws:
        flaws = translated_report(
            "In {count:,} places the new mesh is connected differently from the old one",
            count=report.flaws,
        )
        found.append(("WARNING", flaws))
    return found


def _more_vertices(new: NewMesh) -> Messages:
    """Why there are more vertices than asked for, and whether they are enough."""
    found, more = [], new.report.vertices - new.report.asked
    if more > 0 and new.max_distance:
        text = translated_report("Max Distance needs {count:,} more vertices", count=more)
        found.append(("INFO", text))
    elif more > 0:
        text = translated_report(
            "The topology and the lines that are kept need {count:,} more vertices", count=more
        )
        found.append(("WARNING", text))
    if new.report.distance > new.max_distance > 0:
        text = translated_report(
            "The new mesh is up to {distance:.3g} away from the old one, more than Max Distance",
            distance=new.report.distance,
        )
        found.append(("WARNING", text))
    return found


def remesh_steps(obj: bpy.types.Object, count: int, options: Options) -> Steps:
    """Replace an object's mesh; returns the NewMesh."""
    handle, mesh = ObjectHandle(obj), obj.data.session_uid
    old = read_old(obj)
    new: NewMesh = yield Task(lambda worker: remeshed(old, count, options, worker))
    obj = handle.get()
    if obj.data.session_uid != mesh or obj.mode != "OBJECT":
        raise ScatterError(f"'{obj.name}' was edited in the meantime: nothing was written")
    with all_or_nothing(bpy.context, [obj]):
        made = write_new(obj, new)
        name, before = obj.data.name, obj.data
        obj.data = made
        if before.users == 0:
            bpy.data.meshes.remove(before)
            made.name = name
    return new


def draw_menu(menu: Any, _context: bpy.types.Context) -> None:
    """Draw the entry of the menu Object."""
    menu.layout.operator(DAPPLE_OT_remesh.bl_idname, icon="MOD_REMESH")


def register() -> None:
    """Add the entry to the menu."""
    bpy.types.VIEW3D_MT_object.append(draw_menu)


def unregister() -> None:
    """Remove the entry."""
    bpy.types.VIEW3D_MT_object.remove(draw_menu)


CLASSES = (DAPPLE_OT_remesh,)
