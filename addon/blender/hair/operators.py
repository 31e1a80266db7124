# SPDX-License-Identifier: GPL-3.0-or-later
"""Add Hair Guides: the operator, and its entry in Add > Curve."""

from typing import Any

import bpy
from bpy.props import FloatProperty, IntProperty, StringProperty

from ...core.base.errors import ScatterError
from ..base.step_operators import OPTIONS, AllOrNothing, Status
from ..base.translation import english, translated, translated_count, translated_report
from ..scatter.linked_data import read_only
from ..scatter.local_views import into_local_views
from ..scatter.object import is_scatter
from ..surface.polls import free, ready
from ..surface.scatters import scatters_of
from .guides import add_guides


def scatter_names(_operator: Any, context: bpy.types.Context, text: str) -> list[str]:
    """The scatters on the active surface, on that of the active scatter or of hair just made."""
    obj = context.object
    if is_scatter(obj):
        obj = obj.dapple.surface
    elif obj is not None and obj.type == "CURVES":
        obj = obj.data.surface
    found = scatters_of(obj) if obj is not None else []
    return [one.name for one in found if text.lower() in one.name.lower()]


class DAPPLE_OT_add_hair_guides(AllOrNothing, bpy.types.Operator):
    """Make hair curves of the points, attached to the surface as Blender's own hair. However many
    of the first ones are taken, they are evenly spread. The points are those that were optimized,
    not those of the bake"""

    bl_idname = "dapple.add_hair_guides"
    bl_label = "Add Hair Guides"
    bl_options = OPTIONS

    scatter: StringProperty(
        name="Scatter",
        description="Scatter whose points are the roots; if empty, the active one, or that of the "
        "active surface",
        search=scatter_names,
        search_options=set(),
        options={"SKIP_SAVE"},
    )
    count: IntProperty(
        name="Count",
        description="Number of guides, of the points that come first in the order whose every "
        "beginning is evenly spread; 0 makes one of each point",
        default=0,
        min=0,
        soft_max=10_000,
    )
    length: FloatProperty(
        name="Length",
        description="Length of each guide, along the normal of the surface; 0 is a tenth of the "
        "size of the surface",
        default=0.0,
        min=0.0,
        soft_max=10.0,
        subtype="DISTANCE",
    )
    points: IntProperty(
        name="Points per Curve",
        description="Number of points of each guide, from its root to its tip",
        default=8,
        min=2,
        soft_max=50,
        max=1000,
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        obj = context.object
        if context.mode != "OBJECT" or obj is None or is_scatter(obj):
            return ready(cls, context, scatter=True)
        if not free(cls):
            return False
        if not scatters_of(obj):
            cls.poll_message_set(translated("Needs an active scatter, or a surface that has one"))
            return False
        return True

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> Status:
        """Ask for the scatter if the active surface has several."""
        found = [] if is_scatter(context.object) else scatters_of(context.object)
        if self.scatter or len(found) < 2 or bpy.app.background:
            return self.execute(context)
        self.scatter = found[0].name
        status: Status = context.window_manager.invoke_props_dialog(self)
        return status

    def concerned(self, context: bpy.types.Context) -> list[bpy.types.Object]:
        return [self._chosen(context)]

    def _chosen(self, context: bpy.types.Context) -> bpy.types.Object:
        """The scatter of the roots."""
        obj = context.object
        if self.scatter:
            obj = context.view_layer.objects.get(self.scatter)
            if not is_scatter(obj):
                raise ScatterError(f"'{self.scatter}' is not a Dapple scatter of the view layer")
        elif not is_scatter(obj):
            found = scatters_of(obj)
            if len(found) > 1:
                names = ", ".join(f"'{one.name}'" for one in found)
                raise ScatterError(
                    f"Surface '{obj.name}' has several scatters, {names}: choose one as Scatter"
                )
            obj = found[0]
        if read_only(obj):
            raise ScatterError(read_only(obj, english))
        return obj

    def work(self, context: bpy.types.Context) -> None:
        seen = context.object  # until the guides are the active object
        made = add_guides(self._chosen(context), self.count, self.length, self.points)
        into_local_views(seen, made.obj)
        text = translated_report("'{name}': {count:,} guides", name=made.obj.name, count=made.count)
        self.report({"INFO"}, text)
        if made.shared:
            shared = translated_count(
                made.shared,
                "{count:,} guide does not follow the surface: its texture coordinates are those of "
                "another place too. Unwrap the surface without overlaps",
                "{count:,} guides do not follow the surface: their texture coordinates are those "
                "of other places too. Unwrap the surface without overlaps",
            )
            self.report({"WARNING"}, shared)


def draw_menu(menu: Any, _context: bpy.types.Context) -> None:
    """Draw the entry of Add > Curve."""
    menu.layout.operator(
        DAPPLE_OT_add_hair_guides.bl_idname, text="Dapple Hair Guides", icon="CURVES"
    )


def register() -> None:
    """Add the entry to the menu."""
    bpy.types.VIEW3D_MT_curve_add.append(draw_menu)


def unregister() -> None:
    """Remove the entry."""
    bpy.types.VIEW3D_MT_curve_add.remove(draw_menu)


CLASSES = (DAPPLE_OT_add_hair_guides,)
