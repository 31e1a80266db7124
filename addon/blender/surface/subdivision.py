# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the viewport and the render evaluate a surface to the same faces.

Points are bound by vertex indices, so they must. Python cannot get a depsgraph in render mode, so a
copy of the object with the render's values is evaluated in a scene of its own. Differences made by
nodes (Is Viewport) are detected by the node group.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import bpy
from bpy.props import EnumProperty

from ...core.base.errors import ScatterError
from ..base.panel_values import CachedValue
from ..base.step_operators import OPTIONS, AllOrNothing
from ..base.translation import Translate, english, translated
from ..scatter.linked_data import read_only
from ..scatter.object import active_surface
from .joined_parts import parts_of
from .mesh import evaluated_mesh, topology

# Modifier type -> properties that the viewport and the render read.
_PAIRS = {
    "SUBSURF": ("levels", "render_levels"),
    "MULTIRES": ("levels", "render_levels"),
    "SCREW": ("steps", "render_steps"),
    "OCEAN": ("viewport_resolution", "resolution"),
}

# The same for curves and texts; 0 in the render is what the viewport has.
_CURVES = {"CURVE", "SURFACE", "FONT"}
_RESOLUTIONS = (("resolution_u", "render_resolution_u"), ("resolution_v", "render_resolution_v"))


def check_render_topology(obj: bpy.types.Object, context: bpy.types.Context) -> None:
    """ScatterError unless viewport and render evaluate obj to the same faces."""
    mismatch = render_mismatch(obj, context)
    if mismatch:
        raise ScatterError(mismatch)


def render_mismatch(obj: bpy.types.Object, context: bpy.types.Context) -> str:
    """How viewport and render differ in the faces of obj, and what to do; empty if they agree."""
    found = (_mismatch(part, context) for part in parts_of(obj))
    return next(filter(None, found), "")


def _mismatch(obj: bpy.types.Object, context: bpy.types.Context) -> str:
    causes = differences(obj, context.scene)
    if not causes:
        return ""
    with evaluated_mesh(obj, context.evaluated_depsgraph_get()) as mesh:
        seen, count = topology(mesh), len(mesh.vertices)
    with render_mesh(obj, context) as mesh:
        if topology(mesh) == seen:
            return ""
        rendered = len(mesh.vertices)
    return (
        f"Surface '{obj.name}' has {count} vertices in the viewport and {rendered} in the render "
        f"({'; '.join(causes)}): use Match Subdivision to make both equal, or "
        "set Attach To to Automatic or Rest Position"
    )


def differences(
    obj: bpy.types.Object, scene: bpy.types.Scene, translate: Translate = english
) -> list[str]:
    """Settings in which viewport and render differ, as text."""
    parts = parts_of(obj)
    causes = [
        words if part == obj else translate("'{part}': {cause}", part=part.name, cause=words)
        for part in parts
        for words in _own_differences(part, translate)
    ]
    modifiers = (modifier for part in parts for modifier in part.modifiers)
    if _simplified(scene) and any(modifier.type in _PAIRS for modifier in modifiers):
        render = scene.render
        causes.append(
            translate(
                "Simplify: {viewport} and {render}",
                viewport=render.simplify_subdivision,
                render=render.simplify_subdivision_render,
            )
        )
    return causes


def _own_differences(obj: bpy.types.Object, translate: Translate) -> Iterator[str]:
    for _, seen, used in _resolutions(obj):
        yield translate("Resolution: {viewport} and {render}", viewport=seen, render=used)
    for modifier in obj.modifiers:
        yield from _modifier_difference(modifier, translate)


def _modifier_difference(modifier: bpy.types.Modifier, translate: Translate) -> Iterator[str]:
    if modifier.show_viewport != modifier.show_render:
        if modifier.show_viewport:
            yield translate("{modifier}: shown in the viewport only", modifier=modifier.name)
        else:
            yield translate("{modifier}: shown in the render only", modifier=modifier.name)
    elif modifier.show_viewport and modifier.type in _PAIRS:
        viewport, render = (getattr(modifier, name) for name in _PAIRS[modifier.type])
        if viewport != render:
            values = {"viewport": viewport, "render": render}
            yield translate("{modifier}: {viewport} and {render}", modifier=modifier.name, **values)


def _resolutions(obj: bpy.types.Object) -> Iterator[tuple[tuple[str, str], int, int]]:
    """Names of resolutions that differ, with their values in the viewport and the render."""
    for names in _RESOLUTIONS if obj.type in _CURVES else ():
        seen, used = (getattr(obj.data, name) for name in names)
        if used not in (0, seen):
            yield names, seen, used


def _simplified(scene: bpy.types.Scene) -> bool:
    render = scene.render
    unequal = render.simplify_subdivision != render.simplify_subdivision_render
    return bool(render.use_simplify and unequal)


@contextmanager
def render_mesh(obj: bpy.types.Object, context: bpy.types.Context) -> Iterator[bpy.types.Mesh]:
    """The mesh that a render would get, from a copy in a temporary scene."""
    copy, scene = obj.copy(), bpy.data.scenes.new("Dapple Render Topology")
    data = obj.data.copy() if obj.type in _CURVES else None
    try:
        copy.animation_data_clear()  # drivers would restore the viewport's levels
        if data is not None:
            data.animation_data_clear()
            copy.data = data
        _use_render_values(copy, scene, context.scene)
        scene.collection.objects.link(copy)
        layer = scene.view_layers[0]
        with context.temp_override(scene=scene, view_layer=layer):
            depsgraph = bpy.context.evaluated_depsgraph_get()
            with evaluated_mesh(copy, depsgraph) as mesh:
                yield mesh
    finally:
        bpy.data.batch_remove([copy, scene, *([data] if data is not None else [])])


def _use_render_values(
    copy: bpy.types.Object, scene: bpy.types.Scene, source: bpy.types.Scene
) -> None:
    copy.hide_viewport = False
    for modifier in copy.modifiers:
        modifier.show_viewport = modifier.show_render
        if modifier.type in _PAIRS:
            viewport, render = _PAIRS[modifier.type]
            setattr(modifier, viewport, getattr(modifier, render))
    for (name, _), _, used in _resolutions(copy):
        setattr(copy.data, name, used)
    scene.render.use_simplify = source.render.use_simplify
    scene.render.simplify_subdivision = source.render.simplify_subdivision_render
    scene.frame_set(source.frame_current, subframe=source.frame_subframe)


def match_subdivision(obj: bpy.types.Object, scene: bpy.types.Scene, use: str) -> None:
    """Give viewport and render the same values: those of use, RENDER or VIEWPORT."""
    for part in parts_of(obj):
        _match_own(part, use)
    if _simplified(scene):
        names = ("simplify_subdivision", "simplify_subdivision_render")
        _copy_one_way(scene.render, names, use)


def _match_own(obj: bpy.types.Object, use: str) -> None:
    for names, _, _ in _resolutions(obj):
        _copy_one_way(obj.data, names, use)
    for modifier in obj.modifiers:
        shown = ("show_viewport", "show_render")
        _copy_one_way(modifier, shown, use)
        if modifier.type in _PAIRS:
            _copy_one_way(modifier, _PAIRS[modifier.type], use)


def _copy_one_way(owner: Any, names: tuple[str, str], use: str) -> None:
    viewport, render = names
    source, target = (render, viewport) if use == "RENDER" else (viewport, render)
    setattr(owner, target, getattr(owner, source))


class DAPPLE_OT_match_subdivision(AllOrNothing, bpy.types.Operator):
    """Use the same levels of the surface's modifiers in the viewport and in renders"""

    bl_idname = "dapple.match_subdivision"
    bl_label = "Match Subdivision"
    bl_options = OPTIONS

    use: EnumProperty(
        name="Use",
        description="Which levels are used for both",
        items=[
            ("RENDER", "Render", "Use the levels of renders in the viewport"),
            ("VIEWPORT", "Viewport", "Use the levels of the viewport in renders"),
        ],
        default="RENDER",
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        surface = active_surface(context)
        if surface is None or not differences(surface, context.scene):
            return False
        reason = next(filter(None, map(read_only, parts_of(surface))), "")
        if reason:
            cls.poll_message_set(reason)
        return not reason

    def work(self, context: bpy.types.Context) -> None:
        surface = active_surface(context)
        if surface is not None:
            match_subdivision(surface, context.scene, self.use)

    def concerned(self, context: bpy.types.Context) -> list[bpy.types.Object]:
        surface = active_surface(context)
        parts = parts_of(surface) if surface is not None else []
        return [obj for obj in parts if obj.type != "MESH"]


def _differences(surface: bpy.types.Object) -> tuple[str, ...]:
    return tuple(differences(surface, bpy.context.scene, translated))


# How the viewport and renders of a surface differ.
DIFFERENCES = CachedValue(_differences, ())


CLASSES = (DAPPLE_OT_match_subdivision,)
