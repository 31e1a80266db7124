# SPDX-License-Identifier: GPL-3.0-or-later
"""Remesh with Dapple: the operator, its dialog and its steps."""

import math
from contextlib import nullcontext, suppress
from typing import Any

import bpy

from ...core.base.errors import ScatterError
from ...core.base.steps import Steps, Task
from ...core.mesh_sequence import MeshSequence
from ...core.moving_mesh import MovingMesh
from ...core.remesh import NewMesh, Options, remeshed
from ...core.settings.density_table import DENSITY
from ..base.all_or_nothing import Status, all_or_nothing
from ..base.object_handles import ObjectHandle
from ..base.operator_jobs import Messages, Outcome
from ..base.step_operators import OPTIONS, StepsOperator
from ..base.times import time_of
from ..base.translation import translated, translated_count, translated_report
from ..scatter.linked_data import read_only
from ..scatter.object import is_scatter, is_surface
from ..settings.declarations import with_arguments
from ..surface.polls import free
from ..surface.reading import frame_kept
from ..surface.values import matching_names
from .density import Chosen, Images, full_name
from .frame_meshes import mesh_now
from .motion import motion_steps
from .new_object import Remeshed, show_mesh
from .reading import read_old
from .sequence import sequence_steps
from .shown import check_faces, read_now, read_shown
from .writing import replace_mesh, write_new

_MOST = 10_000_000
_FRAME = {  # of the scene
    "min": -1_048_574,
    "max": 1_048_574,
    "soft_min": 0,
    "soft_max": 10_000,
    "subtype": "TIME",
}


def _vertex_count(obj: bpy.types.Object) -> int:
    """Vertices of a mesh, or of the mesh that an object of another type shows; 0 if none."""
    if obj.type == "MESH":
        return len(obj.data.vertices)
    with suppress(ScatterError):
        return len(read_shown(obj).vertices)
    return 0


def _density_names(_operator: Any, context: bpy.types.Context, text: str) -> list[str]:
    return matching_names(context.object, text)


@with_arguments(one for one in DENSITY if one.under == "image")
class DAPPLE_OT_remesh(StepsOperator, bpy.types.Operator):
    """Replace the mesh by even triangles on the same surface. Texture coordinates, colors, vertex
    groups, shape keys, materials, attributes and modifiers are kept; seams, creases, borders and
    marked edges stay where they are. A curve, text or metaball is hidden, and a new object has
    the mesh"""

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
        soft_max=10.0,
        subtype="DISTANCE",
    )

    adaptive: bpy.props.BoolProperty(
        name="Adaptive",
        description="Vertices are closer together where the new mesh would be far from the old one,"
        " as on small round parts: about half of the largest distance with as many vertices. It"
        " takes about five times as long",
        default=False,
    )

    density: bpy.props.StringProperty(
        name="Density",
        description="Attribute or vertex group: where it is twice as large, there are twice as many"
        " vertices in an area, and where it is 0, a hundredth of the largest number. Empty: as"
        " many everywhere",
        search=_density_names,
        search_options={"SUGGESTION"},
    )

    image: bpy.props.StringProperty(
        name="Image",
        description="Image that multiplies the density: vertices are closer together where it is"
        " brighter; where it is black, there are a hundredth of the largest number. Empty: none",
    )

    animation: bpy.props.EnumProperty(
        name="Animation",
        description="What becomes of the motion",
        items=(
            (
                "KEEP",
                "Keep",
                "Modifiers, armature and shape keys stay and move the new mesh as the old one",
            ),
            (
                "SHAPE_KEYS",
                "Bake to Shape Keys",
                "The new mesh gets a shape key for each frame, with evenly spaced vertices in "
                "each. Modifiers that are shown are contained in the keys and removed",
            ),
            (
                "SEQUENCE",
                "Bake to Sequence",
                "A new object shows a new mesh on each frame, also where faces change as in a "
                "fluid; vertices stay where the surface does not change. The old object is hidden",
            ),
        ),
        default="KEEP",
    )
    frame_start: bpy.props.IntProperty(
        name="Start",
        description="First frame that is baked, whose mesh is remeshed",
        default=1,
        **_FRAME,
    )
    frame_end: bpy.props.IntProperty(
        name="End",
        description="Last frame that is baked",
        default=250,
        **_FRAME,
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        obj = context.object
        if not free(cls):
            return False
        if context.mode != "OBJECT" or obj is None:
            cls.poll_message_set(translated("Needs an active object in Object Mode"))
        elif is_scatter(obj):
            cls.poll_message_set(translated("The active object is a scatter, not a surface"))
        elif not is_surface(obj):
            cls.poll_message_set(translated("Needs an active mesh, curve, text or metaball object"))
        elif read_only(obj):
            cls.poll_message_set(read_only(obj))
        elif obj.type == "MESH" and not obj.data.is_editable:
            cls.poll_message_set(translated("The mesh of the active object is linked"))
        else:
            return True
        return False

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> Status:
        """Ask for the number of vertices, starting with the current number."""
        if not self.properties.is_property_set("count"):
            self.count = _vertex_count(context.object) or self.count
        self.frame_start, self.frame_end = self._frames(context)
        if bpy.app.background:
            return super().invoke(context, event)
        self.asked = True
        status: Status = context.window_manager.invoke_props_dialog(self)
        return status

    def draw(self, context: bpy.types.Context) -> None:
        """Draw the dialog."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        for name in ("count", "feature_angle", "density"):
            layout.prop(self, name)
        self.draw_image(layout, context.object)
        row = layout.row()
        row.enabled = self.animation != "SEQUENCE"
        row.prop(self, "adaptive")
        layout.prop(self, "max_distance")
        layout.prop(self, "animation")
        if self.animation != "KEEP":
            column = layout.column(align=True)
            column.prop(self, "frame_start")
            column.prop(self, "frame_end")

    def draw_image(self, layout: bpy.types.UILayout, obj: bpy.types.Object | None) -> None:
        layout.prop_search(self, "image", bpy.data, "images", icon="IMAGE_DATA")
        if not self.image:
            return
        layout.prop(self, "image_channel")
        if obj is not None and obj.type == "MESH":
            layout.prop_search(self, "uv_map", obj.data, "uv_layers", icon="GROUP_UVS")

    def _frames(self, context: bpy.types.Context) -> tuple[int, int]:
        """The frames that were set, else those of the scene."""
        scene, is_set = context.scene, self.properties.is_property_set
        first = self.frame_start if is_set("frame_start") else scene.frame_start
        return first, self.frame_end if is_set("frame_end") else scene.frame_end

    def execute(self, context: bpy.types.Context) -> Status:
        """Do the work now in a script, or in the background after the dialog."""
        if getattr(self, "asked", False):
            return super().invoke(context, None)
        return super().execute(context)

    def steps(self, context: bpy.types.Context) -> Steps:
        options = {
            "feature_angle": min(math.degrees(self.feature_angle), 180.0),  # pi is rounded up
            "max_distance": self.max_distance,
            "adaptive": self.adaptive,
        }
        chosen = Chosen(self.density, full_name(self.image), self.image_channel, self.uv_map)
        if self.animation != "KEEP":
            bake = motion_steps if self.animation == "SHAPE_KEYS" else sequence_steps
            frames = self._frames(context)
            return bake(context, context.object, self.count, chosen, options, frames)
        if context.object.type != "MESH":
            return shown_steps(context.object, self.count, chosen, options)
        return remesh_steps(context.object, self.count, chosen, options)

    def watched(self, context: bpy.types.Context) -> dict[int, str]:
        return {one.session_uid: one.name for one in (context.object, context.object.data)}

    @staticmethod
    def done(context: bpy.types.Context, result: Any, obj: bpy.types.Object) -> Outcome:
        figures, shown = result.figures, result.obj.get()
        if isinstance(figures, MovingMesh):
            return Outcome(shown, [*_messages(obj.name, figures.new), _motion_message(figures)])
        if isinstance(figures, MeshSequence):
            return Outcome(shown, _sequence_messages(obj.name, figures))
        return Outcome(shown, _messages(obj.name, figures))


def _messages(name: str, new: NewMesh) -> Messages:
    """The messages about a new mesh."""
    report = new.report
    text = translated_report(
        "'{name}': {vertices:,} vertices, {faces:,} triangles, angles from {angle:.0f} degrees",
        name=name,
        vertices=report.vertices,
        faces=report.faces,
        angle=report.smallest_angle,
    )
    found = [("INFO", text), *_more_vertices(new)]
    if new.left_out:
        left_out = translated_count(
            new.left_out,
            "{count} vertex without faces was left out",
            "{count:,} vertices without faces were left out",
        )
        found.append(("WARNING", left_out))
    if report.dropped_lines:
        given_up = translated_report(
            "{count:,} creases or seams were lost: more vertices may keep them",
            count=report.dropped_lines,
        )
        found.append(("WARNING", given_up))
    return [*found, *_flaws(report.flaws)]


def _motion_message(moving: MovingMesh) -> tuple[str, str]:
    """How good the triangles are on the worst frame."""
    frames, worst = moving.frames, moving.frames[moving.worst]
    if not worst.below_15 and not worst.flipped:
        text = translated_report(
            "{frames:,} frames as shape keys, no triangle below 15 degrees", frames=len(frames)
        )
        return "INFO", text
    text = translated_report(
        "{frames:,} frames as shape keys; on the worst, frame {frame}, {below:,} triangles have an "
        "angle below 15 degrees and {flipped:,} are turned over",
        frames=len(frames),
        frame=moving.first + moving.worst,
        below=worst.below_15,
        flipped=worst.flipped,
    )
    return "WARNING" if worst.flipped else "INFO", text


def _sequence_messages(name: str, sequence: MeshSequence) -> Messages:
    """The messages about a mesh for each frame."""
    least, most = sequence.counts
    text = translated_report(
        "'{name}': {frames:,} frames with {least:,} to {most:,} vertices, of which {kept:.0f} % "
        "stay from frame to frame",
        name=name,
        frames=sequence.frame_count,
        least=least,
        most=most,
        kept=100 * sequence.kept,
    )
    return [("INFO", text), *_flaws(sequence.flaws)]


def _flaws(count: int) -> Messages:
    """That the topology is another one at so many places; nothing if it is the same."""
    if not count:
        return []
    text = translated_report(
        "In {count:,} places the new mesh is connected differently from the old one", count=count
    )
    return [("WARNING", text)]


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


def remesh_steps(obj: bpy.types.Object, count: int, chosen: Chosen, options: Options) -> Steps:
    """Replace an object's mesh; returns Remeshed with the NewMesh."""
    handle, mesh = ObjectHandle(obj), obj.data.session_uid
    old = read_old(obj, chosen)
    new: NewMesh = yield Task(lambda worker: remeshed(old, count, options, worker))
    obj = handle.get()
    if obj.data.session_uid != mesh or obj.mode != "OBJECT":
        raise ScatterError(f"'{obj.name}' was edited in the meantime: nothing was written")
    with all_or_nothing(bpy.context, [obj]):
        replace_mesh(obj, write_new(obj.data, new))
    return Remeshed(handle, new)


def shown_steps(obj: bpy.types.Object, count: int, chosen: Chosen, options: Options) -> Steps:
    """Hide a curve, text or metaball, and make a new object that shows what it does now as a new
    mesh. Returns Remeshed with the NewMesh.
    """
    handle, time = ObjectHandle(obj), time_of(bpy.context.scene)
    old, shown = read_now(obj, chosen, Images(chosen))
    check_faces(obj, old)
    new: NewMesh = yield Task(lambda worker: remeshed(old, count, options, worker))
    obj, scene = handle.get(), bpy.context.scene
    # The artist may have changed the frame; one that is shown again loses poses without a key.
    kept = nullcontext() if time_of(scene) == time else frame_kept(scene, show=time)
    with kept, all_or_nothing(bpy.context, [obj]):
        made = show_mesh(obj, mesh_now(obj, new, shown))
    return Remeshed(ObjectHandle(made), new)


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
