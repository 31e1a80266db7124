# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact counts follow points that were added or removed by hand."""

import bpy
import numpy as np

from ...core.solve.stale import changed_settings, settings_text
from ..scatter.object import settings_of
from ..scatter.points import point_columns_of


def follow_count(obj: bpy.types.Object) -> None:
    """Have the settings ask for as many points as there are, unless they were changed since the
    points were solved: then they say what is wanted.
    """
    if not obj.dapple.solved_settings:
        return
    changed = changed_settings(obj.dapple.solved_settings, settings_of(obj))
    classes = point_columns_of(obj)["dapple_class"]
    if "classes" not in changed:
        counts = np.bincount(classes, minlength=len(obj.dapple.classes))
        for kind, count in zip(obj.dapple.classes, counts.tolist(), strict=False):
            if kind.use_count and kind.count != count and count:
                kind.count = count
    if obj.dapple.amount == "COUNT" and "count" not in changed and len(classes):
        obj.dapple.count = len(classes)
    if not changed:
        obj.dapple.solved_settings = settings_text(settings_of(obj))
