# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: instances -> the same, each as often as its weight says.

No node reads numbers from a text, but one counts its letters: a digit is that many letters x, and
spaces up to its width. core/settings/weights.py writes it.
"""

import bpy

from ..core.settings.weights import DIGIT, DIGITS
from .builder import Builder, Socket, new_group
from .groups import Group

WIDTH = DIGITS * DIGIT  # letters for each instance


def _build_weighted() -> bpy.types.NodeTree:
    """New group; Weights has WIDTH letters for each instance."""
    geometry = [("Instances", "NodeSocketGeometry")]
    tree = new_group(WEIGHTED.name, [*geometry, ("Weights", "NodeSocketString")], geometry)
    b = Builder(tree)
    listed, amount = b.each("INSTANCE", b.input("Instances"), _amount)
    often = b.node("GeometryNodeDuplicateElements", domain="INSTANCE")
    for name, feed in (("Geometry", listed), ("Amount", amount)):
        b.tree.links.new(feed, often.inputs[name])
    b.output("Instances", often.outputs["Geometry"])
    b.arrange()
    return tree


WEIGHTED = Group("Dapple Weighted", _build_weighted)


def _amount(b: Builder, _element: Socket, index: Socket) -> Socket:
    first = b.integer("MULTIPLY", index, WIDTH)
    amount = _digit(b, first, 0)
    for place in range(1, DIGITS):
        amount = b.integer("ADD", b.integer("MULTIPLY", amount, 10), _digit(b, first, place))
    return amount


def _digit(b: Builder, first: Socket, place: int) -> Socket:
    at = b.integer("ADD", first, place * DIGIT)
    letters = b.out("FunctionNodeSliceString", b.input("Weights"), at, DIGIT)
    return b.out("FunctionNodeStringLength", b.out("FunctionNodeReplaceString", letters, " ", ""))
