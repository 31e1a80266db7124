# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: bound points -> instances on the surface of the current (sub-)frame."""

import bpy

from .builder import VERSION, VERSION_KEY, Builder, Group, Socket, inner, new_group, version_of
from .detail import DETAIL, DETAIL_INPUTS, VIEWPORT
from .instances import INSTANCES
from .points import NUMBERS, POINT_INPUTS, POINTS

GROUP_NAME = "Dapple Scatter"
_KINDS_KEY = "dapple_object_types"  # number of object types of a group; 0: inputs without a number
_INSTANCES, _BOUNDS, _POINTS = range(3)  # values of the input Display
_DOT = 0.15  # radius of a displayed point, in spacings

INPUTS = [
    *POINT_INPUTS,
    ("Spacing", "NodeSocketFloat"),
    ("Hidden", "NodeSocketFloat"),
    ("Display", "NodeSocketInt"),
]
INSTANCE_INPUTS = [
    ("Instance", "NodeSocketObject"),
    ("Collection", "NodeSocketCollection"),
    *((name, "NodeSocketFloat") for name in NUMBERS),
    ("Fit to Spacing", "NodeSocketFloat"),
]
KIND_INPUTS = [*INSTANCE_INPUTS, ("Weights", "NodeSocketString")]  # which is not a setting


def ensure_group(classes: int = 0, detailed: bool = False) -> bpy.types.NodeTree:
    """The current group for a number of object types in the open file; built if necessary.

    `detailed` adds the level of detail. Without it the group does not depend on the camera, so it
    is not evaluated whenever the camera moves.
    """
    for group in bpy.data.node_groups:
        if is_current(group, classes, detailed) and group.library is None:
            return group
    return build(classes, detailed)


def is_current(group: bpy.types.NodeTree | None, classes: int, detailed: bool = False) -> bool:
    """Whether a group has the current version and this number of object types."""
    if group is None or version_of(group) != VERSION or group.get(_KINDS_KEY, 0) != classes:
        return False
    sockets = {
        (item.name, item.socket_type)
        for item in group.interface.items_tree
        if item.item_type == "SOCKET" and item.in_out == "INPUT"
    }
    return sockets >= set(_inputs(classes)) and detailed == (sockets >= set(DETAIL_INPUTS))


def input_name(name: str, kind: int | None) -> str:
    """The name of one of INSTANCE_INPUTS for an object type; None if there is only one."""
    return name if kind is None else f"{name} {kind + 1}"


def _kinds(classes: int) -> list[int | None]:
    return list(range(classes)) or [None]


def _inputs(classes: int) -> list[tuple[str, str]]:
    """Names and socket types."""
    own = [(input_name(name, k), kind) for k in _kinds(classes) for name, kind in KIND_INPUTS]
    return INPUTS + own


def build(classes: int = 0, detailed: bool = False) -> bpy.types.NodeTree:
    """New group, marked with its version."""
    kinds = _kinds(classes)
    name = f"{GROUP_NAME} {classes} Object Types" if classes else GROUP_NAME
    name, more = (f"{name} Detail", DETAIL_INPUTS) if detailed else (name, [])
    inputs = [*_inputs(classes), *more]
    tree = new_group(name, inputs, [("Geometry", "NodeSocketGeometry")])
    tree.is_modifier = True
    tree[VERSION_KEY], tree[_KINDS_KEY] = VERSION, classes
    b = Builder(tree)
    feeds = (*(b.input(name) for name, _ in POINT_INPUTS), *_numbers(b, kinds))
    hidden = b.input("Hidden")
    shown = inner(b, VIEWPORT, inner(b, POINTS, *feeds).outputs[0], hidden).outputs[0]
    if detailed:
        requested = (b.input(name) for name, _ in DETAIL_INPUTS)
        shown = inner(b, DETAIL, shown, *requested, hidden).outputs[0]
    b.output("Geometry", _displayed(b, shown, kinds))
    b.arrange()
    return tree


def _displayed(b: Builder, shown: Socket, kinds: list[int | None]) -> Socket:
    """Points, bounds or instances, depending on Display in the viewport."""
    requested = b.switch("INT", b.out("GeometryNodeIsViewport"), _INSTANCES, b.input("Display"))
    boxes = b.compare("EQUAL", requested, _BOUNDS)
    made = _instances(b, shown, kinds, boxes)
    there = b.compare("GREATER_THAN", b.attribute("fade", "FLOAT"), 0.0, "FLOAT")
    radius = b.number("MULTIPLY", b.input("Spacing"), _DOT)
    dots = b.out("GeometryNodeMeshToPoints", shown, there, None, radius)
    return b.switch("GEOMETRY", b.compare("EQUAL", requested, _POINTS), made, dots)


def _numbers(b: Builder, kinds: list[int | None]) -> list[Socket]:
    """The INSTANCE_INPUTS of a point's own object type."""
    first, *others = ([b.input(input_name(name, k)) for name in NUMBERS] for k in kinds)
    numbers = first
    for k, own in enumerate(others, 1):
        feeds = [socket for three in zip(numbers, first, own, strict=True) for socket in three]
        numbers = list(inner(b, OF_CLASS, k, *feeds).outputs)
    return numbers


def _instances(b: Builder, placed: Socket, kinds: list[int | None], boxes: Socket) -> Socket:
    """The instances or bounds of each object type on its points."""
    made = [_instanced(b, placed, kind, boxes) for kind in kinds]
    if len(made) == 1:
        return made[0]
    joined = b.node("GeometryNodeJoinGeometry")
    for one in reversed(made):  # the last link comes first
        b.tree.links.new(one, joined.inputs[0])
    return joined.outputs[0]


def _instanced(b: Builder, placed: Socket, kind: int | None, boxes: Socket) -> Socket:
    chosen = (b.input(input_name(name, kind)) for name in ("Instance", "Collection"))
    of, spacing = -1 if kind is None else kind, b.input("Spacing")
    sized = (b.input(input_name(name, kind)) for name in ("Fit to Spacing", "Weights"))
    return inner(b, INSTANCES, placed, of, *chosen, spacing, boxes, *sized).outputs[0]


def _build_of_class() -> bpy.types.NodeTree:
    """New group; for each of NUMBERS: the field so far, the first object type's and this one's."""
    sockets = (f"{name}{which}" for name in NUMBERS for which in (" So Far", " First", ""))
    inputs = [("Object Type", "NodeSocketInt"), *((name, "NodeSocketFloat") for name in sockets)]
    tree = new_group(OF_CLASS.name, inputs, [(name, "NodeSocketFloat") for name in NUMBERS])
    b = Builder(tree)
    here = b.compare("EQUAL", b.attribute("dapple_object_type", "INT"), b.input("Object Type"))
    for name in NUMBERS:
        before, own = b.input(f"{name} So Far"), b.input(name)
        other = b.compare("NOT_EQUAL", own, b.input(f"{name} First"), "FLOAT")
        b.output(name, b.switch("FLOAT", other, before, b.switch("FLOAT", here, before, own)))
    b.arrange()
    return tree


OF_CLASS = Group("Dapple Object Type", _build_of_class)
