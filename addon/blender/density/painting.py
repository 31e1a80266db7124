# SPDX-License-Identifier: GPL-3.0-or-later
"""Painting a vertex group of a scatter's surface, and returning to the scatter."""

import itertools

import bpy

from ...core.base.errors import ScatterError
from ...core.settings.density_table import PAINTED, Painted
from ..base.recent_objects import activate, latest_of
from ..base.translation import english
from ..scatter.linked_data import read_only
from ..scatter.object import TO_MESH, is_scatter, kind_of, surface_of
from ..surface.joined_parts import parts_of


def painted_scatter(context: bpy.types.Context) -> bpy.types.Object | None:
    """The scatter whose surface is in Weight Paint mode for it."""
    if context.mode != "PAINT_WEIGHT":
        return None
    obj = context.view_layer.objects.get(context.scene.dapple_painted)
    if not is_scatter(obj) or obj.dapple.surface is None:
        return None
    return obj if context.object in parts_of(obj.dapple.surface) else None


def painted_group(context: bpy.types.Context) -> tuple[str, Painted | None]:
    """The active vertex group, and how the painted scatter uses it."""
    scatter, group = painted_scatter(context), context.object.vertex_groups.active
    if scatter is None or group is None:
        return "", None
    density = scatter.dapple.density
    uses = (one for one in PAINTED.values() if getattr(density, one.setting) == group.name)
    return group.name, next(uses, None)


def begin_painting(context: bpy.types.Context, painted: Painted) -> None:
    """Go to Weight Paint mode of the active scatter's surface.

    Raises:
        ScatterError: it cannot be painted; the scene is as before.
    """
    scatter = context.object
    parts = parts_of(surface_of(scatter))
    named = getattr(scatter.dapple.density, painted.setting)
    for part in parts:
        _check_writable(part)
    first = _first(parts)
    _check_seen(first, context)
    _check_named(scatter, parts, named)
    _to_weight_paint(context, first)
    name = named or _new_name(f"{scatter.name} {painted.suffix}", parts)
    weight = _even(scatter) if painted.full and not named else 0.0
    for part in parts:
        _activate_group(part, name, weight)
    setattr(scatter.dapple.density, painted.setting, name)
    context.scene.dapple_painted = scatter.name
    if lacks_brush(tool_name(context), context.tool_settings.weight_paint.brush):
        _give_brush()


def tool_name(context: bpy.types.Context) -> str:
    """The active tool of Weight Paint mode."""
    space = context.workspace  # a background Blender may have none
    tool = space.tools.from_space_view3d_mode("PAINT_WEIGHT") if space else None
    return tool.idname if tool else ""


def lacks_brush(tool: str, brush: bpy.types.Brush | None) -> bool:
    """Whether a tool needs a brush and has none, as in a Blender without its assets."""
    return brush is None and tool.startswith("builtin.brush")


def _give_brush() -> None:
    """Choose a brush of the file, a new one if it has none. Blender only activates assets."""
    if not bpy.ops.brush.asset_activate.poll():
        return
    own = (one for one in bpy.data.brushes if one.use_paint_weight and one.library is None)
    brush = next(own, None) or bpy.data.brushes.new("Paint", mode="WEIGHT_PAINT")
    brush.asset_mark()
    bpy.ops.brush.asset_activate(
        asset_library_type="LOCAL", relative_asset_identifier=f"Brush/{brush.name}"
    )


def _first(parts: list[bpy.types.Object]) -> bpy.types.Object:
    """The part to begin with: the one that was clicked last, or the largest."""
    return latest_of(parts) or max(parts, key=lambda part: part.dimensions.length)


def _new_name(wished: str, parts: list[bpy.types.Object]) -> str:
    """A name that no part has a vertex group of."""
    known = {group.name for part in parts for group in part.vertex_groups}
    numbered = (f"{wished}.{number:03}" for number in itertools.count(1))
    return next(name for name in itertools.chain([wished], numbered) if name not in known)


def _activate_group(obj: bpy.types.Object, name: str, weight: float) -> None:
    """Make a vertex group of an object the active one; a new one has this weight everywhere."""
    group = obj.vertex_groups.get(name)
    if group is None:
        group = obj.vertex_groups.new(name=name)
        if weight:
            group.add(range(len(obj.data.vertices)), weight, "REPLACE")
    obj.vertex_groups.active_index = group.index


def end_painting(context: bpy.types.Context) -> None:
    """Go back to the scatter, in Object Mode."""
    scatter = painted_scatter(context)
    bpy.ops.object.mode_set(mode="OBJECT")
    context.scene.dapple_painted = ""
    if scatter is not None:
        activate(context, scatter)


def _even(scatter: bpy.types.Object) -> float:
    """A weight to begin with. Of a count only the ratios of weights matter: from the middle,
    strokes can add points as well as take some away.
    """
    return 0.5 if scatter.dapple.amount == "COUNT" else 1.0


def _check_writable(surface: bpy.types.Object) -> None:
    name, mesh = surface.name, surface.data
    reason = read_only(surface, english)
    if surface.type != "MESH":
        kind = kind_of(surface)
        reason = f"Surface '{name}' is a {kind}: only meshes have vertex groups. {TO_MESH}"
    elif mesh.library is not None or mesh.override_library is not None:
        reason = (
            reason or f"The mesh of surface '{name}' is linked from another file: make it local"
        )
    elif mesh.users - mesh.use_fake_user > 1:
        reason = f"Surface '{name}' shares its mesh with other objects: make it single-user first"
    if reason:
        raise ScatterError(reason)


def _check_seen(surface: bpy.types.Object, context: bpy.types.Context) -> None:
    name, reason = surface.name, ""
    if not surface.data.polygons:
        reason = f"Surface '{name}' has no faces to paint on"
    elif surface.mode != "OBJECT":
        reason = f"Surface '{name}' is not in Object Mode: leave its mode first"
    elif context.view_layer.objects.get(name) != surface:
        reason = f"Surface '{name}' is not in the view layer"
    elif not surface.visible_get(viewport=_view(context)):
        reason = f"Surface '{name}' is hidden: show it first"
    if reason:
        raise ScatterError(reason)


def _check_named(scatter: bpy.types.Object, parts: list[bpy.types.Object], named: str) -> None:
    """ScatterError if a density already uses something that is not a vertex group."""
    if named and not any(named in part.vertex_groups for part in parts):
        raise ScatterError(
            f"'{scatter.name}' uses '{named}', which is not a vertex group of surface "
            f"'{scatter.dapple.surface.name}': clear that field to paint a new one"
        )


def _view(context: bpy.types.Context) -> bpy.types.SpaceView3D | None:
    """The 3D View, which may show some objects only."""
    space = context.space_data
    return space if isinstance(space, bpy.types.SpaceView3D) else None


def _to_weight_paint(context: bpy.types.Context, surface: bpy.types.Object) -> None:
    active, selected = context.object, list(context.selected_objects)
    activate(context, surface)
    try:
        bpy.ops.object.mode_set(mode="WEIGHT_PAINT")
    except RuntimeError as error:
        activate(context, active)
        for obj in selected:
            obj.select_set(True)
        raise ScatterError(f"Surface '{surface.name}' cannot be painted: {error}") from error
