# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of classes of a scatter: adding, removing, moving; the pair that overlaps most."""

import bpy
import numpy as np
from mathutils import Vector

from ..core.errors import ScatterError
from ..core.kinds import class_counts
from ..nodes import INSTANCE_INPUTS
from .meshio import read_points, to_world
from .scatter import property_name, settings_of, write_instance_inputs, write_stale_input
from .store import ensure_modifier


def change_classes(obj: bpy.types.Object, action: str) -> None:
    """ADD, REMOVE, UP or DOWN, at the class that is shown; the node group follows."""
    kinds, at = obj.dapple.classes, obj.dapple.class_index
    if action == "ADD":
        _add(obj)
        at = len(kinds) - 1
    elif action == "REMOVE" and at < len(kinds):
        kinds.remove(at)
        at = min(at, len(kinds) - 1)
    elif action in ("UP", "DOWN"):
        to = at + (1 if action == "DOWN" else -1)
        if 0 <= to < len(kinds):
            kinds.move(at, to)
            at = to
    obj.dapple.class_index = max(at, 0)
    ensure_modifier(obj)
    write_instance_inputs(obj)
    write_stale_input(obj)


def _add(obj: bpy.types.Object) -> None:
    kind = obj.dapple.classes.add()
    count = len(obj.dapple.classes)
    kind.name = f"Class {count}"
    if count > 1:
        return
    for label, _ in INSTANCE_INPUTS:  # what is placed now stays
        name = property_name(label)
        setattr(kind, name, getattr(obj.dapple, name))


def count_labels(obj: bpy.types.Object) -> list[str]:
    """The number of points that each class will get, for the list; the trouble if they cannot."""
    try:
        return [f"{count:,}" for count in class_counts(settings_of(obj))]
    except ScatterError:
        return ["?"] * len(obj.dapple.classes)


def select_overlap(obj: bpy.types.Object) -> Vector:
    """Select the two points whose things overlap most; the place between them, in the world."""
    pair = [obj.dapple.report.overlap_first, obj.dapple.report.overlap_second]
    chosen = np.zeros(len(obj.data.vertices), dtype=bool)
    chosen[pair] = True
    obj.data.vertices.foreach_set("select", chosen)
    obj.data.update()
    return Vector(to_world(obj, read_points(obj.data)[pair]).mean(axis=0))
