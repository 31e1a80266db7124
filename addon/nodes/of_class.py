# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: the numbers of all classes before one -> the same with those of this class.

A number that is the same for this class and the first one stays what it was: while it is one value
for all points, what changes nothing is left out further on, and no point has to look for its class.
"""

import bpy

from .builder import Builder, new_group
from .groups import Group
from .points import NUMBERS


def _build_of_class() -> bpy.types.NodeTree:
    """New group; for each of NUMBERS the field so far, the first class's and this one's."""
    sockets = (f"{name}{which}" for name in NUMBERS for which in (" So Far", " First", ""))
    inputs = [("Class", "NodeSocketInt"), *((name, "NodeSocketFloat") for name in sockets)]
    tree = new_group(OF_CLASS.name, inputs, [(name, "NodeSocketFloat") for name in NUMBERS])
    b = Builder(tree)
    here = b.compare("EQUAL", b.attribute("dapple_class", "INT"), b.input("Class"))
    for name in NUMBERS:
        before, own = b.input(f"{name} So Far"), b.input(name)
        other = b.compare("NOT_EQUAL", own, b.input(f"{name} First"), "FLOAT")
        b.output(name, b.switch("FLOAT", other, before, b.switch("FLOAT", here, before, own)))
    b.arrange()
    return tree


OF_CLASS = Group("Dapple Class", _build_of_class)
