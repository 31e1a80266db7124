# SPDX-License-Identifier: GPL-3.0-or-later
"""Painting a vertex group of a scatter's surface, and back to the scatter.

The scene remembers the name of the scatter, so that undo, redo and a file that is saved meanwhile
do too. Whether it is painted is looked up: Weight Paint may be left without the add-on.
"""

import bpy

from ...core.density_table import PAINTED, Painted
from ...core.errors import ScatterError
from ..base.translation import english
from ..data.library import read_only
from ..data.scatter import is_scatter, surface_of
from .scatters import activate


def painted_scatter(context: bpy.types.Context) -> bpy.types.Object | None:
    """The scatter whose surface is in Weight Paint mode because of it."""
    if context.mode != "PAINT_WEIGHT":
        return None
    obj = context.view_layer.objects.get(context.scene.dapple_painted)
    return obj if is_scatter(obj) and obj.dapple.surface == context.object else None


def painted_group(context: bpy.types.Context) -> tuple[str, Painted | None]:
    """The vertex group that strokes change, and what it is for the scatter that is painted."""
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
    surface = surface_of(scatter)
    named = getattr(scatter.dapple.density, painted.setting)
    _check(surface, context)
    _check_named(scatter, surface, named)
    _to_weight_paint(context, surface)
    group = surface.vertex_groups.get(named) if named else None
    if group is None:
        group = surface.vertex_groups.new(name=f"{scatter.name} {painted.suffix}")
        if painted.full:
            group.add(range(len(surface.data.vertices)), _even(scatter), "REPLACE")
    surface.vertex_groups.active_index = group.index
    setattr(scatter.dapple.density, painted.setting, group.name)
    context.scene.dapple_painted = scatter.name


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


def _check(surface: bpy.types.Object, context: bpy.types.Context) -> None:
    name, mesh = surface.name, surface.data
    reason = read_only(surface, english)
    if surface.type != "MESH":
        reason = f"Surface '{name}' is a {surface.type.lower()}: only meshes have vertex groups"
    elif mesh.library is not None or mesh.override_library is not None:
        reason = (
            reason or f"The mesh of surface '{name}' is linked from another file: make it local"
        )
    elif mesh.users - mesh.use_fake_user > 1:
        reason = f"Surface '{name}' shares its mesh with other objects: make it single-user first"
    elif not mesh.polygons:
        reason = f"Surface '{name}' has no faces to paint on"
    elif surface.mode != "OBJECT":
        reason = f"Surface '{name}' is not in Object Mode: leave its mode first"
    elif context.view_layer.objects.get(name) != surface:
        reason = f"Surface '{name}' is not in the view layer"
    elif not surface.visible_get(viewport=_view(context)):
        reason = f"Surface '{name}' is hidden: show it first"
    if reason:
        raise ScatterError(reason)


def _check_named(scatter: bpy.types.Object, surface: bpy.types.Object, named: str) -> None:
    """What is used already is replaced by nothing else."""
    if named and named not in surface.vertex_groups:
        raise ScatterError(
            f"'{scatter.name}' uses '{named}', which is not a vertex group of surface "
            f"'{surface.name}': clear that field to paint a new one"
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
