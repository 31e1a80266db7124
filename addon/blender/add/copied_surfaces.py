# SPDX-License-Identifier: GPL-3.0-or-later
"""Scatters that are copied together with their surface are moved to the copy of the surface."""

from dataclasses import dataclass, field

import bpy

from ...nodes import get_input, has_input, set_input
from ..base import activity, operator_jobs
from ..base.handlers import Evaluation, Subscriber
from ..base.quiet import is_quiet
from ..scatter.linked_data import read_only
from ..scatter.modifier import scatter_modifier, write_surface_inputs
from ..scatter.object import is_scatter
from ..surface.joined_parts import Piece, copied_with, is_joined, pieces_of


@dataclass
class _State:
    known: set[int] = field(default_factory=set)  # session_uids of scatters that were looked at


_state = _State()


def _updated(evaluation: Evaluation) -> None:
    """Move copied scatters to copied surfaces, and note the parts of the surfaces of others."""
    if is_quiet() or operator_jobs.current() is not None or activity.is_rendering():
        return
    for obj, _ in evaluation.objects():
        if is_scatter(obj) and not read_only(obj):
            _look(obj)


def _look(obj: bpy.types.Object) -> None:
    if obj.session_uid not in _state.known and was_copied_with_parts(obj):
        follow_parts(obj)
    else:
        note_parts(obj)
    _state.known.add(obj.session_uid)


def _look_at_all() -> None:
    _state.known.clear()
    for obj in bpy.data.objects:
        if is_scatter(obj) and not read_only(obj):
            _look(obj)


SUBSCRIBER = Subscriber(
    updated=_updated,
    loaded=_look_at_all,
    imported=_look_at_all,
    undone=_look_at_all,
    enabled=_look_at_all,
)


def note_parts(scatter: bpy.types.Object) -> None:
    """Store the parts of its surface with a scatter."""
    noted, surface = scatter.dapple.parts, scatter.dapple.surface
    entries = surface.dapple.joined.entries if is_joined(surface) else ()
    if noted.surface == surface and [*map(_object, noted.entries)] == [*map(_object, entries)]:
        return
    noted.surface = surface if entries else None
    noted.entries.clear()
    for entry in entries:
        noted.entries.add().object = entry.object


def was_copied_with_parts(scatter: bpy.types.Object) -> bool:
    """Whether a scatter is a copy that was made together with parts of its surface."""
    noted, surface = scatter.dapple.parts, scatter.dapple.surface
    if noted.surface is None or noted.surface != surface:
        return False
    before, now = surface.dapple.joined.entries, noted.entries
    return len(before) == len(now) and any(
        one.object is not None and one.object != other.object
        for one, other in zip(now, before, strict=True)
    )


def follow_parts(scatter: bpy.types.Object) -> None:
    """Move a copied scatter to a surface of the copied parts and the other parts. Scatters that
    were copied together share it.
    """
    surface = scatter.dapple.surface
    copies = {
        other.object: one.object
        for one, other in zip(
            scatter.dapple.parts.entries, surface.dapple.joined.entries, strict=True
        )
        if one.object is not None
    }
    pieces = [_copied(piece, copies) for piece in pieces_of(surface)]
    known = (one for one in bpy.data.objects if is_joined(one) and pieces_of(one) == pieces)
    scatter.dapple.surface = next(known, None) or copied_with(surface, copies)
    note_parts(scatter)
    _take_tiles_along(scatter, surface)
    modifier = scatter_modifier(scatter)
    if modifier is not None:
        write_surface_inputs(scatter, modifier)


def _take_tiles_along(scatter: bpy.types.Object, before: bpy.types.Object) -> None:
    """Move copied tiles to the scatter's new surface."""
    tiles, surface = scatter.dapple.tiles.object, scatter.dapple.surface
    others = (one for one in bpy.data.objects if one != scatter and is_scatter(one))
    if tiles is None or any(one.dapple.tiles.object == tiles for one in others):
        return
    if tiles.parent == before:
        tiles.parent = surface
    for modifier in tiles.modifiers:
        asks = modifier.type == "NODES" and modifier.node_group and has_input(modifier, "Surface")
        if asks and get_input(modifier, "Surface") == before:
            set_input(modifier, "Surface", surface)


def _copied(piece: Piece, copies: dict[bpy.types.Object, bpy.types.Object]) -> Piece:
    path = tuple(copies.get(one, one) for one in piece.path)
    return Piece(copies.get(piece.object, piece.object), path)


def _object(entry: bpy.types.PropertyGroup) -> bpy.types.Object | None:
    return entry.object
