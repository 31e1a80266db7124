# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether points were edited by hand since they were solved."""

import bpy

from ...core.surface.records import RESULT_KEY
from ..base.translation import counted, told
from ..scatter.hand_marks import touched_places
from ..scatter.key_stores import key_points
from ..scatter.object import solve_again
from ..scatter.points import points_digest
from .scene_snapshot import Present


def is_edited(obj: bpy.types.Object) -> bool:
    """Whether points were edited by hand since they were stored."""
    stored = obj.dapple.solved_points, obj.data.get(RESULT_KEY)
    return bool(stored[0]) and points_digest(obj) not in stored


def points_reason(obj: bpy.types.Object, present: Present) -> str:
    """Whether points were edited by hand, or added and removed under the keys."""
    if obj.dapple.baked_keys and len(obj.data.vertices) != key_points(obj):
        return solve_again(obj, told("Points were added or removed since the bake"))
    reason = _edited_reason(obj, present)
    if reason and obj.data.get(RESULT_KEY) == present.points(obj):
        return solve_again(obj, told("An undo brought back points of other settings"))
    return reason or _placed_reason(obj)


def _edited_reason(obj: bpy.types.Object, present: Present) -> str:
    if not obj.dapple.baked_keys and obj.dapple.report.count != len(obj.data.vertices):
        return _added_or_removed(len(obj.data.vertices) - obj.dapple.report.count)
    if not obj.dapple.solved_points or present.points(obj) == obj.dapple.solved_points:
        return ""
    return told("Points were edited by hand: reattach them, or lock them and optimize")


def _placed_reason(obj: bpy.types.Object) -> str:
    if obj.dapple.baked_keys or touched_places(obj) is None:
        return ""
    return solve_again(obj, told("Points were placed by hand; their neighbors are uneven"))


def _added_or_removed(added: int) -> str:
    if added > 0:
        return counted(
            added,
            "{count} point was added by hand: reattach it, or lock it and optimize",
            "{count:,} points were added by hand: reattach them, or lock them and optimize",
        )
    return counted(
        -added,
        "{count} point was removed by hand: reattach to keep the others, or optimize",
        "{count:,} points were removed by hand: reattach to keep the others, or optimize",
    )
