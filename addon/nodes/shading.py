# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: a surface -> the same with the normals that its face corners are shaded with.

Flat faces, sharp edges and custom normals give the corners at a vertex different normals. From
Blender 4.4 on, the Normal node knows them. Before, it only knows those of vertices: there, edges
are split where corners differ, which keeps the order of faces and corners, and custom normals are
not known. Which of both it is is tried out on a cube, as a file may be opened in another version.
"""

import bpy

from .builder import Builder, Socket, new_group
from .groups import Group

NORMAL = "dapple_normal"
_MOST = 0.9  # of a coordinate: at the corner of a smooth cube it is 0.58, on its faces 1


def _build_shading() -> bpy.types.NodeTree:
    """New group; Hard is whether corners differ. The normals of a smooth surface are those of its
    vertices; Shaded then only takes longer.
    """
    tree = new_group(
        SHADING.name,
        [("Surface", "NodeSocketGeometry")],
        [("Hard", "NodeSocketBool"), ("Shaded", "NodeSocketGeometry")],
    )
    b = Builder(tree)
    surface = b.input("Surface")
    face, edge = (b.attribute(name, "BOOLEAN") for name in ("sharp_face", "sharp_edge"))
    custom = b.attribute("custom_normal", "FLOAT").node.outputs["Exists"]
    sharp = b.boolean("OR", _any(b, face, "FACE"), _any(b, edge, "EDGE"))
    b.output("Hard", b.boolean("OR", sharp, b.sample(surface, custom, 0, "BOOLEAN")))
    split = b.out("GeometryNodeSplitEdges", surface, b.boolean("OR", face, edge))
    split = b.store(split, NORMAL, b.out("GeometryNodeInputNormal"), "FLOAT_VECTOR")
    exact = b.store(surface, NORMAL, _of_corners(b), "FLOAT_VECTOR", "CORNER")
    b.output("Shaded", b.switch("GEOMETRY", _knows_corners(b), split, exact))
    b.arrange()
    return tree


SHADING = Group("Dapple Shading", _build_shading)


def _of_corners(b: Builder) -> Socket:
    """The field of the corners' normals, where Blender knows them."""
    node = b.node("GeometryNodeInputNormal")
    if hasattr(node, "legacy_corner_normals"):
        node.legacy_corner_normals = False
    return node.outputs[0]


def _any(b: Builder, value: Socket, domain: str) -> Socket:
    """Whether an attribute is set somewhere; most surfaces do not even have it."""
    surface = b.input("Surface")
    there = b.sample(surface, value.node.outputs["Exists"], 0, "BOOLEAN")
    statistic = b.node("GeometryNodeAttributeStatistic", surface, True, value, domain=domain)
    some = b.compare("GREATER_THAN", statistic.outputs["Sum"], 0.0, "FLOAT")
    return b.switch("BOOLEAN", there, False, some)


def _knows_corners(b: Builder) -> Socket:
    """Whether the normal at the corner of a smooth cube is not that of a face."""
    cube = b.out("GeometryNodeSetShadeSmooth", b.out("GeometryNodeMeshCube"), True, True)
    normal = b.sample(cube, _of_corners(b), 0, "FLOAT_VECTOR", "CORNER")
    x, y, z = (b.number("ABSOLUTE", part) for part in b.parts(normal))
    most = b.number("MAXIMUM", b.number("MAXIMUM", x, y), z)
    return b.compare("LESS_THAN", most, _MOST, "FLOAT")
