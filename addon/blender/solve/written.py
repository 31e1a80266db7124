# SPDX-License-Identifier: GPL-3.0-or-later
"""What follows once a scatter was solved in the background."""

import bpy

from ..base.undo import push_undo
from ..display import preview


def follow_up(obj: bpy.types.Object, step: str) -> None:
    """Have the live preview start from there; what was asked for is an undo step of that name."""
    preview.solved_anew(obj)
    if step:
        push_undo(step)
