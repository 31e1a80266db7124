# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: the meshes of a collection, one for each frame -> the one of the current frame."""

import bpy

from .builder import Builder, Group, new_group


def _build_sequence() -> bpy.types.NodeTree:
    """New group. Objects are taken in the order of their names; before the first frame the first
    one is shown, after the last frame the last one.
    """
    tree = new_group(
        SEQUENCE.name,
        [
            ("Geometry", "NodeSocketGeometry"),
            ("Frames", "NodeSocketCollection"),
            ("Start", "NodeSocketInt"),
        ],
        [("Geometry", "NodeSocketGeometry")],
    )
    tree.is_modifier = True
    b = Builder(tree)
    info = b.node("GeometryNodeCollectionInfo", b.input("Frames"), True, True)
    meshes = info.outputs[0]
    now = b.number("FLOOR", b.node("GeometryNodeInputSceneTime").outputs["Frame"])
    last = b.integer("SUBTRACT", b.count(meshes, "INSTANCES"), 1)
    number = b.integer("SUBTRACT", now, b.input("Start"))
    number = b.integer("MINIMUM", b.integer("MAXIMUM", number, 0), last)
    chosen = b.compare("EQUAL", b.out("GeometryNodeInputIndex"), number)
    shown = b.out("GeometryNodeSeparateGeometry", meshes, chosen, domain="INSTANCE")
    b.output("Geometry", b.out("GeometryNodeRealizeInstances", shown))
    b.arrange()
    return tree


SEQUENCE = Group("Dapple Frames", _build_sequence)
