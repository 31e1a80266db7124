# SPDX-License-Identifier: GPL-3.0-or-later
"""Helpers to write node trees: add a node, connect its inputs, use its output."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import bpy

from . import tooltips

Socket: TypeAlias = Any  # bpy.types.NodeSocket


class Builder:
    """Adds nodes to one tree; every method returns the new node's output socket."""

    def __init__(self, tree: bpy.types.NodeTree) -> None:
        self.tree = tree
        self.source = tree.nodes.new("NodeGroupInput")
        self.sink = tree.nodes.new("NodeGroupOutput")

    def input(self, name: str) -> Socket:
        """The group input with this name."""
        return self.source.outputs[name]

    def output(self, name: str, value: Socket) -> None:
        """Connect the group output with this name."""
        self.tree.links.new(value, self.sink.inputs[name])

    def node(self, kind: str, *feeds: Any, **settings: Any) -> bpy.types.Node:
        """New node of a kind; `feeds` are connected to its enabled inputs in their order."""
        node = self.tree.nodes.new(kind)
        for key, value in settings.items():
            if getattr(node, key) != value:  # each assignment makes Blender search the whole tree
                setattr(node, key, value)
        sockets = [socket for socket in node.inputs if socket.enabled]
        for socket, feed in zip(sockets, feeds, strict=False):
            self._feed(socket, feed)
        return node

    def _feed(self, socket: Socket, feed: Any) -> None:
        if isinstance(feed, bpy.types.NodeSocket):
            self.tree.links.new(feed, socket)
        elif feed is not None and feed != _plain(socket.default_value):
            socket.default_value = feed

    def group(self, tree: bpy.types.NodeTree, *feeds: Any) -> bpy.types.Node:
        """New node with a group; `feeds` are connected to its inputs in their order."""
        node = self.node("GeometryNodeGroup")
        node.node_tree = tree
        for socket, feed in zip(node.inputs, feeds, strict=True):
            self._feed(socket, feed)
        return node

    def out(self, kind: str, *feeds: Any, **settings: Any) -> Socket:
        """First enabled output of a new node."""
        node = self.node(kind, *feeds, **settings)
        return next(socket for socket in node.outputs if socket.enabled)

    def integer(self, operation: str, a: Any, b: Any) -> Socket:
        return self.out("FunctionNodeIntegerMath", a, b, operation=operation)

    def number(self, operation: str, a: Any, b: Any = None, c: Any = None) -> Socket:
        return self.out("ShaderNodeMath", a, b, c, operation=operation)

    def vector(self, operation: str, a: Any, b: Any = None) -> Socket:
        return self.out("ShaderNodeVectorMath", a, b, operation=operation)

    def scaled(self, vector: Any, factor: Any) -> Socket:
        """A vector times a number."""
        node = self.node("ShaderNodeVectorMath", operation="SCALE")
        self._feed(node.inputs["Vector"], vector)
        self._feed(node.inputs["Scale"], factor)
        return node.outputs[0]

    def parts(self, vector: Any) -> list[Socket]:
        """X, Y and Z of a vector."""
        return list(self.node("ShaderNodeSeparateXYZ", vector).outputs)

    def compare(self, operation: str, a: Any, b: Any, data_type: str = "INT") -> Socket:
        return self.out("FunctionNodeCompare", a, b, data_type=data_type, operation=operation)

    def boolean(self, operation: str, a: Any, b: Any = None) -> Socket:
        return self.out("FunctionNodeBooleanMath", a, b, operation=operation)

    def mix(self, data_type: str, factor: Any, a: Any, b: Any) -> Socket:
        return self.out("ShaderNodeMix", factor, a, b, data_type=data_type)

    def switch(self, input_type: str, condition: Any, false: Any, true: Any) -> Socket:
        return self.out("GeometryNodeSwitch", condition, false, true, input_type=input_type)

    def attribute(self, name: str, data_type: str) -> Socket:
        """Field of a named attribute."""
        return self.out("GeometryNodeInputNamedAttribute", name, data_type=data_type)

    def attribute_or(self, name: str, data_type: str, input_type: str, other: Any) -> Socket:
        """Field of a named attribute, with a default for geometry that does not have it."""
        value = self.attribute(name, data_type)
        return self.switch(input_type, value.node.outputs["Exists"], other, value)

    def sample(
        self, geometry: Any, value: Any, index: Any, data_type: str, domain: str = "POINT"
    ) -> Socket:
        """Value of a field at the element with this index, by default a point."""
        kinds = {"data_type": data_type, "domain": domain}
        return self.out("GeometryNodeSampleIndex", geometry, value, index, **kinds)

    def count(self, geometry: Any, component: str = "MESH") -> Socket:
        """Number of points (or instances) of a geometry."""
        return self.out("GeometryNodeAttributeDomainSize", geometry, component=component)

    def count_faces(self, geometry: Any) -> Socket:
        """Number of faces of a mesh."""
        node = self.node("GeometryNodeAttributeDomainSize", geometry, component="MESH")
        return node.outputs["Face Count"]

    def count_points(self, geometry: Any) -> Socket:
        """Number of points of a geometry, be they a mesh's vertices or a point cloud."""
        return self.integer("ADD", self.count(geometry), self.count(geometry, "POINTCLOUD"))

    def turned(self, rotation: Any, angle: Any) -> Socket:
        """A rotation, turned by an angle about its own Z."""
        turn = self.out("FunctionNodeAxisAngleToRotation", (0.0, 0.0, 1.0), angle)
        return self.out("FunctionNodeRotateRotation", rotation, turn, rotation_space="LOCAL")

    def store(
        self, geometry: Any, name: str, value: Any, data_type: str, domain: str = "POINT"
    ) -> Socket:
        """Geometry with a named attribute added on its points or another domain."""
        return self.out(
            "GeometryNodeStoreNamedAttribute",
            geometry,
            True,
            name,
            value,
            data_type=data_type,
            domain=domain,
        )

    def captured(self, geometry: Any, **fields: tuple[str, Any]) -> bpy.types.Node:
        """Geometry with fields (socket type, value) captured on its points at once.

        Shared inputs are computed once, and nodes that use the captured fields do not compute them
        again.
        """
        node = self.node("GeometryNodeCaptureAttribute", geometry, domain="POINT")
        for name, (kind, value) in fields.items():
            node.capture_items.new(kind, name)
            self._feed(node.inputs[name], value)
        return node

    def each(
        self, domain: str, geometry: Any, number: Callable[["Builder", Socket, Socket], Socket]
    ) -> tuple[Socket, Socket]:
        """Geometry, and a field with a number for each element, computed from the element and its
        index.
        """
        begin = self.node("GeometryNodeForeachGeometryElementInput")
        end = self.node("GeometryNodeForeachGeometryElementOutput", domain=domain)
        begin.pair_with_output(end)
        _keep_quiet(begin)
        _keep_quiet(end)
        end.main_items.new("FLOAT", "Number")
        self._feed(begin.inputs["Geometry"], geometry)
        found = number(self, begin.outputs["Element"], begin.outputs["Index"])
        self._feed(end.inputs["Number"], found)
        return end.outputs["Geometry"], end.outputs["Number"]

    def arrange(self) -> None:
        """Lay the nodes out in columns by their distance from the group input."""
        before: dict[str, list[str]] = {}
        for link in self.tree.links:  # as socket.links searches all links
            before.setdefault(link.to_node.name, []).append(link.from_node.name)
        depths: dict[str, int] = {}
        columns: dict[int, int] = {}
        places: list[float] = []
        for node in self.tree.nodes:
            column = _depth(node.name, before, depths)
            row = columns.get(column, 0)
            places += (column * 220.0, -row * 220.0)
            columns[column] = row + 1
        self.tree.nodes.foreach_set("location", places)


def _keep_quiet(node: bpy.types.Node) -> None:
    """Suppress the zone's warning about geometry without elements, which Blender 5 introduced."""
    if hasattr(node, "warning_propagation"):
        node.warning_propagation = "NONE"


def _plain(value: Any) -> Any:
    """A socket's value, vectors as tuples."""
    return tuple(value) if isinstance(value, bpy.types.bpy_prop_array) else value


def _depth(name: str, before: dict[str, list[str]], depths: dict[str, int]) -> int:
    """Number of links on the longest path to a node."""
    if name not in depths:
        own = [_depth(other, before, depths) for other in before.get(name, [])]
        depths[name] = max(own, default=-1) + 1
    return depths[name]


def new_group(
    name: str, inputs: list[tuple[str, str]], outputs: list[tuple[str, str]]
) -> bpy.types.NodeTree:
    """Empty node group with these (name, socket type) inputs and outputs."""
    tree = bpy.data.node_groups.new(name, "GeometryNodeTree")
    for label, kind in inputs:
        socket = tree.interface.new_socket(label, in_out="INPUT", socket_type=kind)
        socket.description = tooltips.of_input(label)
        if tooltips.is_machine_text(label):
            socket.hide_in_modifier = True
        if tooltips.default(label) is not None:
            socket.default_value = tooltips.default(label)
    for label, kind in outputs:
        socket = tree.interface.new_socket(label, in_out="OUTPUT", socket_type=kind)
        socket.description = tooltips.of_output(label)
    return tree


VERSION = 21
VERSION_KEY = "dapple_version"  # -VERSION for inner groups
_PART_KEY = "dapple_part"


def version_of(group: bpy.types.NodeTree | None) -> int:
    """Version of a group that plays a scatter; 0 for other groups."""
    found = 0 if group is None else group.get(VERSION_KEY, 0)
    return found if isinstance(found, int) else 0


@dataclass(frozen=True)
class Group:
    """A node group: its name in the file, and the function that builds it."""

    name: str
    build: Callable[[], bpy.types.NodeTree]


def inner(b: Builder, part: Group, *feeds: object) -> bpy.types.Node:
    """A node with the group; `feeds` are connected to its inputs in their order."""
    return b.group(ensure(part), *feeds)


def ensure(part: Group) -> bpy.types.NodeTree:
    """The group in the open file; built if necessary."""
    for group in bpy.data.node_groups:
        known = group.get(VERSION_KEY) == -VERSION and group.get(_PART_KEY) == part.name
        if known and group.library is None:
            return group
    group = part.build()
    group[VERSION_KEY], group[_PART_KEY] = -VERSION, part.name
    return group
