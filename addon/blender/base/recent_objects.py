# SPDX-License-Identifier: GPL-3.0-or-later
"""The objects that were active last, in their order."""

from collections.abc import Iterable

import bpy

from .handlers import Evaluation, Subscriber

_MOST = 64

_uids: dict[int, None] = {}  # session_uids, the latest last


def latest_of(objects: Iterable[bpy.types.Object]) -> bpy.types.Object | None:
    """The one of these objects that was active last; None if none was."""
    _note_active()
    order = list(_uids)
    known = [obj for obj in objects if obj.session_uid in _uids]
    return max(known, key=lambda obj: order.index(obj.session_uid), default=None)


def _note(_evaluation: Evaluation) -> None:
    _note_active()


def _note_active() -> None:
    layer = bpy.context.view_layer
    active = layer.objects.active if layer is not None else None
    if active is None or next(reversed(_uids), None) == active.session_uid:
        return
    _uids.pop(active.session_uid, None)
    _uids[active.session_uid] = None
    while len(_uids) > _MOST:
        del _uids[next(iter(_uids))]


SUBSCRIBER = Subscriber(updated=_note, before_load=_uids.clear, disabled=_uids.clear)


def activate(context: bpy.types.Context, obj: bpy.types.Object) -> None:
    """Make an object the active one and the only selected one."""
    for other in context.selected_objects:
        other.select_set(False)
    obj.select_set(True)
    context.view_layer.objects.active = obj
