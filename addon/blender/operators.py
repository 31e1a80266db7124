# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators: thin shells around work.py, store.py and topology.py."""

from typing import Any

import bpy
import numpy as np
from bpy.props import BoolProperty, EnumProperty, IntProperty

from ..core.errors import ScatterError
from ..core.native import missing
from ..core.quality import QUALITIES, quality_settings
from ..core.settings import Settings
from ..core.steps import Steps
from . import overlay, preview
from .classes import change_classes, select_overlap
from .job import Answer, StepsOperator
from .library import read_only, writable
from .locking import lock_points
from .properties import BIND_TO
from .scatter import is_scatter, is_surface
from .store import clear_keys
from .topology import differences, match_subdivision
from .translation import OWN, reported, told
from .work import add_steps, bake_steps, optimise_steps, rebind_steps, tile_steps
from .workfiles import work_files

_OPTIONS = {"REGISTER", "UNDO"}
_DEFAULT = Settings()


def _ready(cls: type[bpy.types.Operator], context: bpy.types.Context, scatter: bool) -> bool:
    """Whether the active object fits; tells the artist why not."""
    obj = context.object
    if missing():
        cls.poll_message_set(missing())
    elif context.mode != "OBJECT" or obj is None:
        cls.poll_message_set(told("Needs an active object in Object Mode"))
    elif scatter:
        return writable(cls, context)
    elif is_scatter(obj):
        cls.poll_message_set(told("The active object is a scatter, not a surface"))
    elif not is_surface(obj):
        cls.poll_message_set(told("Needs an active mesh, curve or text object"))
    else:
        return True
    return False


class DAPPLE_OT_add(StepsOperator, bpy.types.Operator):
    """Scatter points evenly over the active object"""

    bl_idname = "dapple.add"
    bl_label = "Dapple Scatter"
    bl_options = _OPTIONS

    count: IntProperty(
        name="Count", description="Number of points, met exactly", default=_DEFAULT.count, min=1
    )
    seed: IntProperty(
        name="Seed", description="Another seed, another scatter", default=_DEFAULT.seed, min=0
    )

    bind_to: EnumProperty(
        name="Bind To",
        description="What the points hold on to while the surface deforms",
        items=BIND_TO,
        translation_context=OWN,
        default="FACES",
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return _ready(cls, context, scatter=False)

    def steps(self, context: bpy.types.Context) -> Steps:
        chosen = ("count", "seed", "bind_to")
        given = {
            name: getattr(self, name) for name in chosen if self.properties.is_property_set(name)
        }
        return add_steps(context, **given)

    def done(self, context: bpy.types.Context, result: bpy.types.Object) -> None:
        for obj in context.selected_objects:
            obj.select_set(False)
        result.select_set(True)
        context.view_layer.objects.active = result


class DAPPLE_OT_optimise(StepsOperator, bpy.types.Operator):
    """Scatter the points anew over the surface as it is in this frame; baked keys are dropped"""

    bl_idname = "dapple.optimise"
    bl_label = "Optimise"
    bl_options = _OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return _ready(cls, context, scatter=True)

    def steps(self, context: bpy.types.Context) -> Steps:
        return optimise_steps(context)

    def done(self, context: bpy.types.Context, result: bpy.types.Object) -> None:
        preview.solved_anew(result)


class DAPPLE_OT_bake(StepsOperator, bpy.types.Operator):
    """Keep the points even in every frame of the scene's range: one key for each frame"""

    bl_idname = "dapple.bake"
    bl_label = "Bake"
    bl_options = _OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return _ready(cls, context, scatter=True)

    def steps(self, context: bpy.types.Context) -> Steps:
        scene = context.scene
        return bake_steps(context, scene.frame_start, scene.frame_end)

    def done(self, context: bpy.types.Context, result: Any) -> None:
        if result.trouble:
            self.report({"WARNING"}, result.trouble)
        if result.taken:
            text = reported(
                "{taken} of {done} frames were solved by a bake stopped before",
                taken=result.taken,
                done=result.done,
            )
            self.report({"INFO"}, text)


class DAPPLE_OT_rebind(StepsOperator, bpy.types.Operator):
    """Bind the points to the nearest places of the surface, whose faces changed; go to the frame
    and pose in which they were optimised first. Baked keys are dropped"""

    bl_idname = "dapple.rebind"
    bl_label = "Re-bind"
    bl_options = _OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return _ready(cls, context, scatter=True)

    def steps(self, context: bpy.types.Context) -> Steps:
        return rebind_steps(context)

    def done(self, context: bpy.types.Context, result: bpy.types.Object) -> None:
        preview.solved_anew(result)


class DAPPLE_OT_tile(StepsOperator, bpy.types.Operator):
    """Make the area that belongs to each point a tile: of the points as they were optimised, on the
    surface as it is in this frame. Tiles made before are replaced; their modifiers stay"""

    bl_idname = "dapple.tile"
    bl_label = "Make Tiles"
    bl_options = _OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return _ready(cls, context, scatter=True)

    def steps(self, context: bpy.types.Context) -> Steps:
        return tile_steps(context)

    def done(self, context: bpy.types.Context, result: Any) -> None:
        made, tiles = result
        count = len(np.unique(tiles.cells))
        text = reported("'{name}': {count:,} tiles", name=made.name, count=count)
        if tiles.lost:
            text = reported(
                "{tiles}, {lost:,} were narrower than the grout", tiles=text, lost=tiles.lost
            )
        self.report({"WARNING" if tiles.lost else "INFO"}, text)


class DAPPLE_OT_clear_bake(bpy.types.Operator):
    """Remove the baked keys; the points then ride on the surface as they were optimised"""

    bl_idname = "dapple.clear_bake"
    bl_label = "Clear Bake"
    bl_options = _OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        there = writable(cls, context) and context.mode == "OBJECT"
        return there and context.object.dapple.baked_keys > 0

    def execute(self, context: bpy.types.Context) -> Answer:
        clear_keys(context.object)
        return {"FINISHED"}


class DAPPLE_OT_discard_bake(bpy.types.Operator):
    """Remove the frames that a stopped bake has left; the next bake begins with its first frame"""

    bl_idname = "dapple.discard_bake"
    bl_label = "Discard Unfinished Bake"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return is_scatter(context.object) and work_files(context.object).frames() > 0

    def execute(self, context: bpy.types.Context) -> Answer:
        work_files(context.object).clear()
        return {"FINISHED"}


class DAPPLE_OT_preview(bpy.types.Operator):
    """Keep the points even in the viewport while you scrub or pose; never in a render. Run again
    to end it"""

    bl_idname = "dapple.preview"
    bl_label = "Live Preview"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return writable(cls, context) and not missing()

    def execute(self, context: bpy.types.Context) -> Answer:
        obj = context.object
        try:
            (preview.stop if preview.is_on(obj) else preview.start)(obj)
        except ScatterError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class DAPPLE_OT_match_subdivision(bpy.types.Operator):
    """Give the surface's modifiers the same levels in the viewport and in the render"""

    bl_idname = "dapple.match_subdivision"
    bl_label = "Match Subdivision"
    bl_options = _OPTIONS

    use: EnumProperty(
        name="Use",
        items=[
            ("RENDER", "Render", "Show the render's levels in the viewport"),
            ("VIEWPORT", "Viewport", "Render the viewport's levels"),
        ],
        default="RENDER",
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        surface = active_surface(context)
        if surface is None or not differences(surface, context.scene):
            return False
        if read_only(surface):
            cls.poll_message_set(read_only(surface))
        return not read_only(surface)

    def execute(self, context: bpy.types.Context) -> Answer:
        match_subdivision(active_surface(context), context.scene, self.use)
        return {"FINISHED"}


class DAPPLE_OT_edit_classes(bpy.types.Operator):
    """Change the list of classes; optimise again to see it"""

    bl_idname = "dapple.edit_classes"
    bl_label = "Edit Classes"
    bl_options = _OPTIONS

    action: EnumProperty(
        name="Action",
        items=[
            ("ADD", "Add", "Add a class; the first takes over what the scatter places now"),
            ("REMOVE", "Remove", "Remove the class that is shown"),
            ("UP", "Move Up", "Move the class that is shown one place up"),
            ("DOWN", "Move Down", "Move the class that is shown one place down"),
        ],
        default="ADD",
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not writable(cls, context):
            return False
        if context.object.override_library:
            cls.poll_message_set(told("A library override keeps the classes of its file"))
        return not context.object.override_library

    def execute(self, context: bpy.types.Context) -> Answer:
        change_classes(context.object, self.action)
        return {"FINISHED"}


class DAPPLE_OT_lock(bpy.types.Operator):
    """Keep the selected points where they are when the scatter is optimised, or set them free. In
    Edit Mode points can be moved, added and deleted before; in a bake all points move"""

    bl_idname = "dapple.lock"
    bl_label = "Lock Points"
    bl_options = _OPTIONS

    lock: BoolProperty(name="Lock", description="Off: unlock", default=True)
    every: BoolProperty(name="All Points", description="Not only those that are selected")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return writable(cls, context)

    def execute(self, context: bpy.types.Context) -> Answer:
        try:
            count = lock_points(context.object, self.lock, self.every)
        except ScatterError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if self.lock:
            self.report({"INFO"}, reported("{count:,} points locked", count=count))
        else:
            self.report({"INFO"}, reported("{count:,} points unlocked", count=count))
        return {"FINISHED"}


class DAPPLE_OT_show_density(bpy.types.Operator):
    """Colour the surface by its density, from dark for no points to yellow for the most; of the
    class that is shown. Run again to end it"""

    bl_idname = "dapple.show_density"
    bl_label = "Show Density"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return is_scatter(context.object) and not missing()

    def execute(self, context: bpy.types.Context) -> Answer:
        obj = context.object
        try:
            if overlay.is_on(obj):
                overlay.stop()
            else:
                overlay.start(obj)
        except ScatterError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class DAPPLE_OT_set_quality(bpy.types.Operator):
    """Set how even and how regular the points become; optimise again to see it"""

    bl_idname = "dapple.set_quality"
    bl_label = "Quality"
    bl_options = _OPTIONS

    quality: EnumProperty(
        name="Quality", items=QUALITIES, translation_context=OWN, default="NATURAL"
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return writable(cls, context)

    def execute(self, context: bpy.types.Context) -> Answer:
        for name, value in quality_settings(self.quality).items():
            setattr(context.object.dapple, name, value)
        return {"FINISHED"}


class DAPPLE_OT_select_overlap(bpy.types.Operator):
    """Select the two points whose things overlap most, and put the 3D cursor between them"""

    bl_idname = "dapple.select_overlap"
    bl_label = "Select Overlap"
    bl_options = _OPTIONS

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        there = writable(cls, context) and context.mode == "OBJECT"
        return there and context.object.dapple.report.worst_overlap > 0

    def execute(self, context: bpy.types.Context) -> Answer:
        context.scene.cursor.location = select_overlap(context.object)
        return {"FINISHED"}


def active_surface(context: bpy.types.Context) -> bpy.types.Object | None:
    """The active object, or the surface of the active scatter."""
    obj = context.object
    if is_scatter(obj):
        return obj.dapple.surface
    return obj if is_surface(obj) else None


CLASSES = (
    DAPPLE_OT_add,
    DAPPLE_OT_optimise,
    DAPPLE_OT_bake,
    DAPPLE_OT_rebind,
    DAPPLE_OT_tile,
    DAPPLE_OT_clear_bake,
    DAPPLE_OT_discard_bake,
    DAPPLE_OT_preview,
    DAPPLE_OT_match_subdivision,
    DAPPLE_OT_edit_classes,
    DAPPLE_OT_select_overlap,
    DAPPLE_OT_set_quality,
    DAPPLE_OT_lock,
    DAPPLE_OT_show_density,
)
