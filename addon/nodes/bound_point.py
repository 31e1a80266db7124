# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: shading and bound place in one, for trees of one's own."""

import bpy

from . import bound_place, shading
from .builder import Builder, new_group
from .groups import Group, inner


def _build_bound_point() -> bpy.types.NodeTree:
    """New group; all but Surface are fields: vertices, face corners there, weights (records.py)."""
    tree = new_group(
        BOUND_POINT.name,
        [
            ("Surface", "NodeSocketGeometry"),
            *((f"{kind}{k}", "NodeSocketInt") for kind in "VC" for k in range(3)),
            *((f"W{k}", "NodeSocketFloat") for k in range(3)),
            ("Turn", "NodeSocketFloat"),
            ("Side", "NodeSocketFloat"),
        ],
        [("Position", "NodeSocketVector"), ("Rotation", "NodeSocketRotation")],
    )
    b = Builder(tree)
    surface = b.input("Surface")
    shaded = (surface, *inner(b, shading.SHADING, surface).outputs, False, None)
    fields = [f"{kind}{k}" for kind in "VCW" for k in range(3)] + ["Turn", "Side"]
    placed = inner(
        b, bound_place.BOUND_PLACE, surface, *shaded, *(b.input(name) for name in fields)
    )
    for name in ("Position", "Rotation"):
        b.output(name, placed.outputs[name])
    b.arrange()
    return tree


BOUND_POINT = Group("Dapple Bound Point", _build_bound_point)
