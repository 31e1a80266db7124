# SPDX-License-Identifier: GPL-3.0-or-later
"""Spraying points onto a surface with a brush, by the mouse or by scripts, and the brush's size."""

from typing import Any

import bpy
import numpy as np
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
)

from ...core.base.errors import ScatterError
from ...core.spray import Brush
from ..base.all_or_nothing import sentence
from ..base.step_operators import OPTIONS, AllOrNothing, Status, tried
from ..base.translation import translated, translated_report
from ..solve import auto_update
from ..surface.polls import editable
from .hand_placed import kind_of_new
from .spray_drawing import Dots
from .spraying import Dab, Pen, Stroke, spacing_of

_PRESSURE_SIZE = "Enable tablet pressure sensitivity for size"
_PRESSURE_STRENGTH = "Enable tablet pressure sensitivity for strength"
_DRAGGED = 150.0  # pixels by which the mouse is dragged to double the radius, or for strength 1
_OWN = {"SKIP_SAVE"}  # the tool keeps the settings
_HIDDEN = {"SKIP_SAVE", "HIDDEN"}


class DAPPLE_PG_dab(bpy.types.PropertyGroup):
    __slots__ = ()  # a misspelled name is an error

    location: FloatVectorProperty(
        name="Location",
        description="Position in world space; the nearest position on the surface is used",
        subtype="XYZ",
        unit="LENGTH",
    )
    pressure: FloatProperty(
        name="Pressure",
        description="Pressure of the pen on the tablet",
        subtype="FACTOR",
        default=1.0,
        min=0.0,
        max=1.0,
    )


class DAPPLE_OT_spray_points(AllOrNothing, bpy.types.Operator):
    """Drag over the surface to add points inside the brush, apart from those that are there. They
    are locked. With Ctrl, remove the points inside the brush"""

    bl_idname = "dapple.spray_points"
    bl_label = "Spray Points"
    bl_options = OPTIONS

    radius: FloatProperty(
        name="Radius",
        description="Size of the brush, relative to the spacing of the points",
        subtype="FACTOR",
        default=3.0,
        min=0.01,
        max=20.0,
        soft_min=0.1,
        soft_max=10.0,
        options=_OWN,
    )
    use_pressure_size: BoolProperty(name="Size Pressure", description=_PRESSURE_SIZE, options=_OWN)
    strength: FloatProperty(
        name="Strength",
        description="How soon a place is full, or empty: the share of the places inside the brush "
        "that are tried where it passes",
        subtype="FACTOR",
        default=1.0,
        min=0.0,
        max=1.0,
        options=_OWN,
    )
    use_pressure_strength: BoolProperty(
        name="Strength Pressure", description=_PRESSURE_STRENGTH, default=True, options=_OWN
    )
    spacing: FloatProperty(
        name="Spacing",
        description="Least distance of sprayed points from all others, relative to the spacing of "
        "the points. They become about as dense as the others with 0.8, and fit between them "
        "below 0.5",
        subtype="FACTOR",
        default=0.8,
        min=0.05,
        max=10.0,
        soft_max=2.0,
        options=_OWN,
    )
    remove: BoolProperty(
        name="Remove", description="Remove the points inside the brush", options=_HIDDEN
    )
    object_type: IntProperty(
        name="Object Type",
        description="Number of the object type of the new points, from 0; -1: the active one",
        default=-1,
        min=-1,
        soft_max=9,
        options=_HIDDEN,
    )
    stroke: CollectionProperty(
        name="Stroke",
        description="Places that the brush touches, in world space, and the pressure of the pen",
        type=DAPPLE_PG_dab,
        options=_HIDDEN,
    )

    _pen: Pen | None = None
    _dots: Dots | None = None

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return editable(cls, context)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> Status:
        """Begin a stroke under the mouse."""
        if len(self.stroke) or context.region_data is None:
            return self.execute(context)
        return tried(self, context, lambda: self._begin(context, event))

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> Status:
        """Go on with the stroke; it ends when the button is released. Esc and the right button
        cancel it.
        """
        if event.type in {"ESC", "RIGHTMOUSE"}:
            self._release()
            return {"CANCELLED"}
        if event.type in {"MOUSEMOVE", "INBETWEEN_MOUSEMOVE"}:
            return self._move(event)
        if event.type != "LEFTMOUSE" or event.value != "RELEASE":
            return {"RUNNING_MODAL"}
        pen = self._release()
        self._note(pen.dabs)
        return tried(self, context, lambda: self._write(context, pen.stroke))

    def cancel(self, context: bpy.types.Context) -> None:
        """Blender ends the stroke, for example because its window is closed."""
        self._release()

    def work(self, context: bpy.types.Context) -> Status | None:
        """Repeat a stroke."""
        if not len(self.stroke):
            raise ScatterError("The stroke is empty: it needs at least one location")
        dabs = [self._dab(row) for row in range(len(self.stroke))]
        stroke = Stroke(context.object, self._brush(context.object), self.remove)
        for dab in dabs:
            stroke.dab(dab)
        return self._write(context, stroke)

    def _begin(self, context: bpy.types.Context, event: bpy.types.Event) -> Status:
        obj = context.object
        stroke = Stroke(obj, self._brush(obj), self.remove)
        self._kind(obj)
        self._pen = Pen(context, stroke)
        self._dots = Dots(context, lambda: stroke.places, self.remove)
        context.window_manager.modal_handler_add(self)
        return self._move(event)

    def _move(self, event: bpy.types.Event) -> Status:
        """Follow the mouse. Nothing is written, so that nothing has to be restored."""
        pen, dots = self._pen, self._dots
        assert pen is not None
        assert dots is not None
        try:
            pen.to((event.mouse_region_x, event.mouse_region_y), event.pressure)
        except Exception as error:
            self._release()
            self.report({"ERROR"}, sentence(self.bl_label, error))
            return {"CANCELLED"}
        dots.redraw()
        return {"RUNNING_MODAL"}

    def _release(self) -> Any:
        """The pen, which is put down."""
        if self._dots is not None:
            self._dots.remove()
        pen, self._pen, self._dots = self._pen, None, None
        return pen

    def _note(self, dabs: list[Dab]) -> None:
        """Store a stroke that the mouse made, to be repeated with other settings."""
        for dab in dabs:
            element = self.stroke.add()
            element.location, element.pressure = dab.place, dab.pressure

    def _write(self, context: bpy.types.Context, stroke: Stroke) -> Status | None:
        obj = context.object
        count = stroke.write(obj, self._kind(obj))
        if not count:
            self._tell_nothing()
            return {"CANCELLED"}
        auto_update.touch(obj)
        text = translated_report("Points added and locked: {count:,}", count=count)
        if self.remove:
            text = translated_report("Points removed: {count:,}", count=count)
        self.report({"INFO"}, text)
        return None

    def _tell_nothing(self) -> None:
        if not len(self.stroke):
            text = translated_report("The surface is not under the mouse")
        elif self.remove:
            text = translated_report("No points are inside the brush")
        else:
            text = translated_report("No room for more points: reduce Spacing, or remove some")
        self.report({"WARNING"}, text)

    def _brush(self, obj: bpy.types.Object) -> Brush:
        spacing = spacing_of(obj)
        return Brush(
            self.radius * spacing,
            self.spacing * spacing,
            self.strength,
            self.use_pressure_size,
            self.use_pressure_strength,
        )

    def _kind(self, obj: bpy.types.Object) -> int:
        """Number of the object type of new points."""
        count = max(len(obj.dapple.object_types), 1)
        if self.object_type >= count:
            raise ScatterError(
                f"Scatter '{obj.name}' has no object type {self.object_type}: it has {count}"
            )
        if self.object_type >= 0:
            return int(self.object_type)
        return kind_of_new(obj)

    def _dab(self, row: int) -> Dab:
        place = np.array(self.stroke[row].location, dtype=np.float64)
        if not np.isfinite(place).all():
            raise ScatterError(f"stroke[{row}].location is not finite: {place.tolist()}")
        return Dab(place, self.stroke[row].pressure)


class DAPPLE_OT_resize_spray_brush(bpy.types.Operator):
    """Drag to change the radius or the strength of the spray brush"""

    bl_idname = "dapple.resize_spray_brush"
    bl_label = "Resize Spray Brush"
    bl_options = {"INTERNAL", "BLOCKING"}  # noqa: RUF012

    setting: EnumProperty(
        name="Setting",
        description="Setting of the brush that is changed",
        items=(
            ("radius", "Radius", "Size of the brush"),
            ("strength", "Strength", "How soon a place is full, or empty"),
        ),
        options={"SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if brush_settings(context) is None:
            cls.poll_message_set(translated("Needs the tool Spray Points in a 3D View"))
            return False
        return True

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> Status:
        """Begin at the current value."""
        self._settings = brush_settings(context)
        self._before, self._from = getattr(self._settings, self.setting), event.mouse_x
        anchored.at = event.mouse_x, event.mouse_y
        self._show(context)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> Status:
        """The mouse to the right makes it larger; a click or Enter confirms."""
        if event.type == "MOUSEMOVE":
            self._change((event.mouse_x - self._from) / _DRAGGED, event.shift)
            self._show(context)
        elif event.type in {"ESC", "RIGHTMOUSE"}:
            setattr(self._settings, self.setting, self._before)
            self.cancel(context)
            return {"CANCELLED"}
        elif event.type in {"LEFTMOUSE", "RET", "NUMPAD_ENTER"} and event.value == "PRESS":
            self.cancel(context)
            return {"FINISHED"}
        return {"RUNNING_MODAL"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Leave the brush where the mouse is."""
        anchored.at = None
        context.area.header_text_set(None)
        context.area.tag_redraw()

    def _change(self, share: float, precise: bool) -> None:
        share *= 0.1 if precise else 1.0
        value = self._before * 2.0**share if self.setting == "radius" else self._before + share
        setattr(self._settings, self.setting, value)

    def _show(self, context: bpy.types.Context) -> None:
        text = translated(
            "Radius: {radius:.2f}   Strength: {strength:.3f}",
            radius=self._settings.radius,
            strength=self._settings.strength,
        )
        context.area.header_text_set(text)
        context.area.tag_redraw()


class _Anchored:
    at: tuple[int, int] | None = None  # pixels of the window, while the brush is resized


anchored = _Anchored()


def brush_settings(context: bpy.types.Context) -> Any:
    """The settings of the tool of the 3D View in Object Mode, if it is Spray Points; else None."""
    if context.mode != "OBJECT" or context.area is None or context.area.type != "VIEW_3D":
        return None
    tool = context.workspace.tools.from_space_view3d_mode("OBJECT", create=False)
    if tool is None or tool.idname != TOOL:
        return None
    return tool.operator_properties(DAPPLE_OT_spray_points.bl_idname)


TOOL = "dapple.spray"
CLASSES = (DAPPLE_PG_dab, DAPPLE_OT_spray_points, DAPPLE_OT_resize_spray_brush)
