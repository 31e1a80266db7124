# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits in the modifier tab are copied to the panel, so that the panel does not overwrite them.

The last inputs of each modifier are remembered during the session. Inputs that differ from them and
from the panel were edited by the artist.
"""

import math
from typing import Any

import bpy

from ...nodes import get_input
from ..base.handlers import Evaluation, Subscriber
from ..base.quiet import is_quiet
from .linked_data import read_only
from .modifier import linked_inputs, scatter_modifier
from .object import is_scatter

_SINGLE = 1e-6  # relative precision of Blender's numbers
_known: dict[int, dict[str, Any]] = {}  # inputs by the scatter's session_uid


def _updated(evaluation: Evaluation) -> None:
    if is_quiet():
        return
    for obj, update in evaluation.objects():
        if update.geometry and is_scatter(obj):
            _take_over(obj)


def _take_over(obj: bpy.types.Object) -> None:
    """Copy edited inputs to the panel."""
    modifier = scatter_modifier(obj)
    if modifier is None:
        return
    found = [(linked, get_input(modifier, linked.name)) for linked in linked_inputs(obj, modifier)]
    before = _known.get(obj.session_uid, {})
    _known[obj.session_uid] = {linked.name: _remembered(value) for linked, value in found}
    if read_only(obj):
        return
    for linked, value in found:
        now = _remembered(value)
        edited = not _same(before.get(linked.name, now), now)
        if edited and not _same(_remembered(linked.value()), now):
            linked.take_over(value)


def _remembered(value: Any) -> Any:
    """A value that stays valid after an undo: the session_uid of a data-block."""
    return ("", value.session_uid) if isinstance(value, bpy.types.ID) else value


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=_SINGLE)
    return bool(one == other)


SUBSCRIBER = Subscriber(updated=_updated, before_load=_known.clear, disabled=_known.clear)
