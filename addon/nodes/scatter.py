# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: bound points -> instances on the surface of the current (sub-)frame."""

import bpy

from . import instances, of_class, points, viewport
from .builder import Builder, Socket, new_group
from .groups import VERSION, VERSION_KEY, inner, version_of

GROUP_NAME = "Dapple Scatter"
KEPT_SINCE = 4  # groups from this version on have the same INPUTS
_KINDS_KEY = "dapple_classes"  # that a group has inputs for; 0: one kind, inputs without a number

INPUTS = [*points.INPUTS, ("Spacing", "NodeSocketFloat"), ("Hidden", "NodeSocketFloat")]
INSTANCE_INPUTS = [
    ("Instance", "NodeSocketObject"),
    ("Collection", "NodeSocketCollection"),
    *((name, "NodeSocketFloat") for name in points.NUMBERS),
]


def ensure_group(classes: int = 0) -> bpy.types.NodeTree:
    """The group of this version for so many classes in the open file, built if there is none."""
    for group in bpy.data.node_groups:
        if is_current(group, classes) and group.library is None:
            return group
    return build(classes)


def is_current(group: bpy.types.NodeTree | None, classes: int) -> bool:
    """Whether a group is of this version and for so many classes."""
    if group is None or version_of(group) != VERSION or group.get(_KINDS_KEY, 0) != classes:
        return False
    sockets = {
        (item.name, item.socket_type)
        for item in group.interface.items_tree
        if item.item_type == "SOCKET" and item.in_out == "INPUT"
    }
    return sockets >= set(_inputs(classes))


def input_name(name: str, kind: int | None) -> str:
    """What one of INSTANCE_INPUTS is called for a class; None: where there is one kind only."""
    return name if kind is None else f"{name} {kind + 1}"


def _kinds(classes: int) -> list[int | None]:
    return list(range(classes)) or [None]


def _inputs(classes: int) -> list[tuple[str, str]]:
    """Names and socket types."""
    own = [(input_name(name, k), kind) for k in _kinds(classes) for name, kind in INSTANCE_INPUTS]
    return INPUTS + own


def build(classes: int = 0) -> bpy.types.NodeTree:
    """New group, marked with its version."""
    kinds = _kinds(classes)
    name = f"{GROUP_NAME} {classes} Classes" if classes else GROUP_NAME
    tree = new_group(name, _inputs(classes), [("Geometry", "NodeSocketGeometry")])
    tree.is_modifier = True
    tree[VERSION_KEY], tree[_KINDS_KEY] = VERSION, classes
    b = Builder(tree)
    feeds = (*(b.input(name) for name, _ in points.INPUTS), *_numbers(b, kinds))
    shown = inner(b, viewport, inner(b, points, *feeds).outputs[0], b.input("Hidden"))
    b.output("Geometry", _instances(b, shown.outputs[0], kinds))
    b.arrange()
    return tree


def _numbers(b: Builder, kinds: list[int | None]) -> list[Socket]:
    """Those among INSTANCE_INPUTS that belong to a point's class."""
    first, *others = ([b.input(input_name(name, k)) for name in points.NUMBERS] for k in kinds)
    numbers = first
    for k, own in enumerate(others, 1):
        feeds = [socket for three in zip(numbers, first, own, strict=True) for socket in three]
        numbers = list(inner(b, of_class, k, *feeds).outputs)
    return numbers


def _instances(b: Builder, placed: Socket, kinds: list[int | None]) -> Socket:
    """What is chosen for each class on its points."""
    made = [_instanced(b, placed, kind) for kind in kinds]
    if len(made) == 1:
        return made[0]
    joined = b.node("GeometryNodeJoinGeometry")
    for one in reversed(made):  # the last that is linked comes first
        b.tree.links.new(one, joined.inputs[0])
    return joined.outputs[0]


def _instanced(b: Builder, placed: Socket, kind: int | None) -> Socket:
    chosen = (b.input(input_name(name, kind)) for name in ("Instance", "Collection"))
    of = -1 if kind is None else kind
    return inner(b, instances, placed, of, *chosen, b.input("Spacing")).outputs[0]
