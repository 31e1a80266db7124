# SPDX-License-Identifier: GPL-3.0-or-later
"""Node groups: points -> instances, by weight, scaled to fit."""

import bpy

from ..core.settings.weights import DIGIT, DIGITS
from .builder import Builder, Group, Socket, inner, new_group

WIDTH = DIGITS * DIGIT  # letters for each instance


def _build_instances() -> bpy.types.NodeTree:
    """New group: random objects of the collection, or the object; a small cone without either.

    Instances are placed on the existing points of an object type, or on all if it is below 0.
    Points of other origin, without `fade` or `scale`, all get instances of their own size.
    """
    tree = new_group(
        INSTANCES.name,
        [
            ("Points", "NodeSocketGeometry"),
            ("Object Type", "NodeSocketInt"),
            ("Instance", "NodeSocketObject"),
            ("Collection", "NodeSocketCollection"),
            ("Spacing", "NodeSocketFloat"),
            ("Bounds", "NodeSocketBool"),
            ("Fit to Spacing", "NodeSocketFloat"),
            ("Weights", "NodeSocketString"),
        ],
        [("Instances", "NodeSocketGeometry")],
    )
    b = Builder(tree)
    several = b.out("GeometryNodeCollectionInfo", b.input("Collection"), True, True)
    count = b.count(several, "INSTANCES")
    some = b.compare("GREATER_THAN", count, 0)
    shape = b.switch("GEOMETRY", some, _one(b), several)
    fits = b.compare("GREATER_THAN", b.input("Fit to Spacing"), 0.0, "FLOAT")
    fitted = inner(b, FIT_TO_SPACING, shape, b.input("Fit to Spacing")).outputs[0]
    pool = b.switch("GEOMETRY", fits, shape, fitted)
    pool = _repeated(b, pool, count, some)
    placed = b.out(
        "GeometryNodeInstanceOnPoints",
        b.input("Points"),
        _chosen(b),
        _boxed(b, pool),
        some,
        b.switch("INT", some, 0, _picked(b, b.count(pool, "INSTANCES"))),
        b.attribute("rotation", "QUATERNION"),
        _scale(b, fits),
    )
    b.output("Instances", placed)
    b.arrange()
    return tree


INSTANCES = Group("Dapple Instances", _build_instances)


def _chosen(b: Builder) -> Socket:
    fade = b.attribute_or("fade", "FLOAT", "FLOAT", 1.0)
    there = b.compare("GREATER_THAN", fade, 0.0, "FLOAT")
    kind = b.input("Object Type")
    mine = b.boolean(
        "AND", there, b.compare("EQUAL", b.attribute("dapple_object_type", "INT"), kind)
    )
    return b.switch("BOOLEAN", b.compare("LESS_THAN", kind, 0), mine, there)


def _repeated(b: Builder, pool: Socket, count: Socket, some: Socket) -> Socket:
    """Objects of a collection, repeated by their weights if there is a weight for each."""
    length = b.out("FunctionNodeStringLength", b.input("Weights"))
    fits = b.compare("EQUAL", length, b.integer("MULTIPLY", count, WIDTH))
    weighs = b.boolean("AND", some, fits)
    often = inner(b, WEIGHTED, pool, b.input("Weights")).outputs[0]
    return b.switch("GEOMETRY", weighs, pool, often)


def _boxed(b: Builder, source: Socket) -> Socket:
    """Each instanced object, or its bounding box."""
    box = b.out("GeometryNodeBoundBox", source)
    return b.switch("GEOMETRY", b.input("Bounds"), source, box)


def _scale(b: Builder, fits: Socket) -> Socket:
    """Scale of a point; fitted instances have radius 1 and the scale of their clearance."""
    scale = b.attribute_or("scale", "FLOAT_VECTOR", "VECTOR", (1.0, 1.0, 1.0))
    clearance = b.attribute("dapple_clearance", "FLOAT")
    unknown = b.compare("LESS_EQUAL", clearance, 0.0, "FLOAT")
    clearance = b.switch("FLOAT", unknown, clearance, b.number("MULTIPLY", b.input("Spacing"), 0.5))
    fitted = b.scaled(scale, b.number("POWER", clearance, b.input("Fit to Spacing")))
    return b.switch("VECTOR", fits, scale, fitted)


def _one(b: Builder) -> Socket:
    node = b.node("GeometryNodeObjectInfo", b.input("Instance"), True)
    chosen = node.outputs["Geometry"]
    some = b.compare("GREATER_THAN", b.count(chosen, "INSTANCES"), 0)
    return b.switch("GEOMETRY", some, _cone(b), chosen)


def _picked(b: Builder, count: Socket) -> Socket:
    """Index of the object for a point, from digits of its random scale that do not show."""
    own = b.number("FRACT", b.number("MULTIPLY", b.attribute("dapple_scale", "FLOAT"), 1000.0))
    index = b.number("FLOOR", b.number("MULTIPLY", own, count))
    return b.number("MINIMUM", index, b.number("SUBTRACT", count, 1.0))


def _cone(b: Builder) -> Socket:
    node = b.node("GeometryNodeMeshCone")
    node.inputs["Vertices"].default_value = 8
    node.inputs["Radius Top"].default_value = 0.0
    spacing = b.input("Spacing")
    b.tree.links.new(b.number("MULTIPLY", spacing, 0.3), node.inputs["Radius Bottom"])
    b.tree.links.new(b.number("MULTIPLY", spacing, 0.6), node.inputs["Depth"])
    return node.outputs["Mesh"]


def _build_fit_to_spacing() -> bpy.types.NodeTree:
    """New group; the strength is an exponent: with 0.5 a radius of 4 becomes 2.

    Instances without vertices keep their size.
    """
    geometry = [("Instances", "NodeSocketGeometry")]
    tree = new_group(
        FIT_TO_SPACING.name, [*geometry, ("Fit to Spacing", "NodeSocketFloat")], geometry
    )
    b = Builder(tree)
    shape = b.input("Instances")
    loose = b.compare("EQUAL", b.count(shape, "INSTANCES"), 0)
    shape = b.switch("GEOMETRY", loose, shape, b.out("GeometryNodeGeometryToInstance", shape))
    measured, radius = b.each("INSTANCE", shape, _radius)
    none = b.compare("LESS_EQUAL", radius, 0.0, "FLOAT")
    factor = b.number("POWER", radius, b.number("MULTIPLY", b.input("Fit to Spacing"), -1.0))
    factor = b.switch("FLOAT", none, factor, 1.0)
    b.output("Instances", b.out("GeometryNodeScaleInstances", measured, True, factor))
    b.arrange()
    return tree


FIT_TO_SPACING = Group("Dapple Fit to Spacing", _build_fit_to_spacing)


def _radius(b: Builder, element: Socket, _index: Socket) -> Socket:
    """Radius of all that one instance contains. Mesh to Points would take twice the time."""
    points = b.out("GeometryNodeRealizeInstances", element)
    x, y, _ = b.parts(b.out("GeometryNodeInputPosition"))
    across = b.number("SQRT", b.number("MULTIPLY_ADD", x, x, b.number("MULTIPLY", y, y)))
    node = b.node("GeometryNodeAttributeStatistic", points, True, across)
    return node.outputs["Max"]


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


WEIGHTED = Group("Dapple Weighted Objects", _build_weighted)


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
