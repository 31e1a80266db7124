# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: rest shape and place in one, for trees of one's own."""

import bpy

from . import rest_place, rest_shape
from .builder import Builder, new_group
from .groups import Group, inner


def _build_rest_point() -> bpy.types.NodeTree:
    """New group; Rest and Ahead are two near places of the rest shape (core/surface/rest.py)."""
    tree = new_group(
        REST_POINT.name,
        [
            ("Surface", "NodeSocketGeometry"),
            ("Rest", "NodeSocketVector"),
            ("Ahead", "NodeSocketVector"),
            ("Turn", "NodeSocketFloat"),
            ("Side", "NodeSocketFloat"),
            ("Part", "NodeSocketInt"),
            ("Parts", "NodeSocketInt"),
        ],
        [("Position", "NodeSocketVector"), ("Rotation", "NodeSocketRotation")],
    )
    b = Builder(tree)
    shape = inner(b, rest_shape.REST_SHAPE, b.input("Surface"), None).outputs["Shape"]
    names = ("Rest", "Rest", "Ahead", "Part", "Parts", "Turn", "Side")
    placed = inner(b, rest_place.REST_PLACE, shape, None, *(b.input(name) for name in names))
    for name in ("Position", "Rotation"):
        b.output(name, placed.outputs[name])
    b.arrange()
    return tree


REST_POINT = Group("Dapple Rest Point", _build_rest_point)
