# SPDX-License-Identifier: GPL-3.0-or-later
"""Scatters from assets: they are placed on the surface on which they were dropped, or on the one
that the artist chooses, and solved like Optimize.

Handlers only note that a scatter appeared. A timer places it after Blender has made its undo step.
"""

from collections.abc import Collection, Iterator
from dataclasses import dataclass, field

import bpy
from mathutils import Vector

from ...core.base.errors import ScatterError
from ..base.activity import is_operated
from ..base.handlers import Evaluation, Subscriber
from ..base.quiet import is_quiet
from ..base.timers import call_within
from ..scatter.linked_data import read_only
from ..scatter.object import is_scatter, is_surface, is_unsolved
from ..solve import auto_update
from ..solve.auto_update import is_blocked
from .marking import instanced
from .placing import place

_BLOCKED_PAUSE = 0.1  # seconds between two looks whether what holds it up is over
_NEAR = 0.01  # distance, relative to the size of an object, up to which a place lies on it
_HITS = 32  # objects that a ray goes through at most
_DOWN = Vector((0.0, 0.0, -1.0))


@dataclass
class _State:
    """State that the timer and the handlers share, by session_uid."""

    known: set[int] = field(default_factory=set)  # scatters without points that were there before
    chosen: set[int] = field(default_factory=set)  # scatters that were given a surface
    notes: dict[int, str] = field(default_factory=dict)  # what did not fit their surface
    active: int = 0  # the last active object that is no scatter


_state = _State()


def note(obj: bpy.types.Object) -> str:
    """Settings of a scatter that did not fit the surface on which it was placed."""
    return _state.notes.get(obj.session_uid, "")


def target_surface(obj: bpy.types.Object) -> bpy.types.Object:
    """The surface for a dropped scatter; ScatterError if none is found."""
    active = next((one for one in bpy.data.objects if one.session_uid == _state.active), None)
    found = surface_at(obj.matrix_world.translation, instanced(obj), active)
    if found is None:
        raise ScatterError(f"There is no surface at '{obj.name}' and none below: choose one")
    return found


def touch(obj: bpy.types.Object) -> None:
    """Note that a setting of a scatter has changed: it is solved if it has a surface
    but no points.
    """
    if auto_update.enabled and is_unsolved(obj) and obj.dapple.surface is not None:
        _state.chosen.add(obj.session_uid)
        call_within(0.0, check)


def check() -> float | None:
    """Place new scatters and those that were given a surface; returns seconds until the
    next call.
    """
    if is_blocked() or is_operated():
        return _BLOCKED_PAUSE
    for obj in _waiting():
        new = obj.session_uid not in _state.known
        _state.known.add(obj.session_uid)
        if obj.session_uid in _state.chosen:
            _place(obj, obj.dapple.surface)
        elif new and obj.dapple.surface is None:
            _presume(obj)
    _state.chosen.clear()
    return None


def _waiting() -> list[bpy.types.Object]:
    """Scatters without points that are in the view layer and can be written."""
    there = bpy.context.view_layer.objects
    return [obj for obj in there if is_unsolved(obj) and not read_only(obj)]


def _presume(obj: bpy.types.Object) -> None:
    try:
        surface = target_surface(obj)
    except ScatterError:  # the panel asks the artist for a surface
        return
    _place(obj, surface)


def _place(obj: bpy.types.Object, surface: bpy.types.Object | None) -> None:
    if surface is None:  # it was taken back
        return
    _state.notes.pop(obj.session_uid, None)
    try:
        left_out = place(obj, surface)
    except ScatterError as error:
        left_out = str(error)
    else:
        auto_update.request(obj, "Place Scatter")
    if left_out:
        _state.notes[obj.session_uid] = left_out


def _updated(evaluation: Evaluation) -> None:
    """Note new scatters and the active object."""
    if not auto_update.enabled or is_quiet():
        return
    active = bpy.context.view_layer.objects.active
    if active is not None and not is_scatter(active):
        _state.active = active.session_uid
    for obj, update in evaluation.objects():
        if update.uid not in _state.known and is_unsolved(obj):
            call_within(0.0, check)


def _note_existing() -> None:
    """Note the scatters of a file that was opened, which stay unchanged."""
    vars(_state).update(vars(_State()))
    _state.known = {obj.session_uid for obj in bpy.data.objects if is_unsolved(obj)}


def _undone() -> None:
    """Forget scatters whose surface an undo has removed."""
    for obj in bpy.data.objects:
        if is_unsolved(obj) and obj.dapple.surface is None:
            auto_update.forget(obj)


SUBSCRIBER = Subscriber(
    updated=_updated, loaded=_note_existing, undone=_undone, enabled=_note_existing, ticks=(check,)
)


def surface_at(
    place: Vector, skipped: Collection[bpy.types.Object], otherwise: bpy.types.Object | None
) -> bpy.types.Object | None:
    """The surface at a place, or the next one below it, or the given object; None if
    there is none.
    """
    there = [
        obj
        for obj in bpy.context.view_layer.objects
        if is_surface(obj) and obj.visible_get() and obj not in skipped
    ]
    own = otherwise if otherwise in there else None
    return _nearest(place, there) or _below(place, there) or own


def _nearest(place: Vector, there: list[bpy.types.Object]) -> bpy.types.Object | None:
    found = [(away, k) for k, obj in enumerate(there) for away in _distance(place, obj)]
    return there[min(found)[1]] if found else None


def _distance(place: Vector, obj: bpy.types.Object) -> Iterator[float]:
    """Distance of a place from an object that it lies on. The bounding box is checked first, which
    is quick.
    """
    corners = [obj.matrix_world @ Vector(corner) for corner in obj.bound_box]
    low, high = (Vector(map(pick, zip(*corners, strict=True))) for pick in (min, max))
    near = _NEAR * (high - low).length
    if any(not a - near <= x <= b + near for a, x, b in zip(low, place, high, strict=True)):
        return
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    try:
        found, at, *_ = evaluated.closest_point_on_mesh(obj.matrix_world.inverted_safe() @ place)
    except RuntimeError:  # it has no faces
        return
    away = (obj.matrix_world @ at - place).length
    if found and away <= near:
        yield away


def _below(place: Vector, there: list[bpy.types.Object]) -> bpy.types.Object | None:
    depsgraph, start = bpy.context.evaluated_depsgraph_get(), place
    for _ in range(_HITS):
        hit, at, _, _, obj, _ = bpy.context.scene.ray_cast(depsgraph, start, _DOWN)
        if not hit:
            break
        if obj.original in there:
            return obj.original
        start = at + 1e-4 * max(1.0, at.length) * _DOWN
    return None
