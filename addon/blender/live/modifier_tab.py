# SPDX-License-Identifier: GPL-3.0-or-later
"""What is edited in the modifier tab is taken over by the panel, so that it overwrites nothing.

The inputs that a modifier had last are remembered in the session: where they are others, and not
those that the panel shows, the artist has edited them there.
"""

import math
from collections.abc import Iterator
from typing import Any

import bpy

from ...nodes import DETAIL_INPUTS, INSTANCE_INPUTS, get_input, has_input, input_name
from ..base.handlers import Handlers, unwatch, watch
from ..base.quiet import is_quiet
from ..data.library import read_only
from ..data.modifier import property_name, scatter_modifier
from ..data.scatter import is_scatter

_SINGLE = 1e-6  # relative precision of Blender's numbers
_known: dict[int, dict[str, Any]] = {}  # inputs by the scatter's session_uid


def _updated(_scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    if is_quiet():
        return
    for one in depsgraph.updates:
        obj = one.id.original
        if one.is_updated_geometry and isinstance(obj, bpy.types.Object) and is_scatter(obj):
            _take_over(obj)


def _take_over(obj: bpy.types.Object) -> None:
    """Give the panel the inputs that were edited."""
    found = {name: (owner, prop, value) for name, owner, prop, value in _inputs(obj)}
    now = {name: _remembered(value) for name, (*_, value) in found.items()}
    before = _known.get(obj.session_uid, now)
    _known[obj.session_uid] = now
    if read_only(obj):
        return
    for name, (owner, prop, value) in found.items():
        edited = not _same(before.get(name, now[name]), now[name])
        if edited and not _same(_remembered(getattr(owner, prop)), now[name]):
            setattr(owner, prop, value)


def _inputs(obj: bpy.types.Object) -> Iterator[tuple[str, Any, str, Any]]:
    """Inputs that are properties too: name, owner and name of the property, value."""
    modifier = scatter_modifier(obj)
    if modifier is None:
        return
    for name, _ in DETAIL_INPUTS:
        if has_input(modifier, name):
            yield name, obj.dapple, property_name(name), get_input(modifier, name)
    kinds: list[tuple[Any, int | None]] = [(kind, k) for k, kind in enumerate(obj.dapple.classes)]
    for owner, number in kinds or [(obj.dapple, None)]:
        for name, _ in INSTANCE_INPUTS:
            label = input_name(name, number)
            if has_input(modifier, label):
                yield label, owner, property_name(name), get_input(modifier, label)


def _remembered(value: Any) -> Any:
    """A value that outlives an undo: of a data-block its number."""
    return ("", value.session_uid) if isinstance(value, bpy.types.ID) else value


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=_SINGLE)
    return bool(one == other)


def _forget(*_arguments: Any) -> None:
    _known.clear()


_HANDLERS: Handlers = {"depsgraph_update_post": _updated, "load_pre": _forget}


def register() -> None:
    """Watch the modifiers of scatters."""
    watch(_HANDLERS)


def unregister() -> None:
    """Watch and know nothing."""
    unwatch(_HANDLERS)
    _forget()
