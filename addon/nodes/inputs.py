# SPDX-License-Identifier: GPL-3.0-or-later
"""Inputs of a node group's modifier, by their names."""

from typing import Any

import bpy

_OLDER = {"Warning": "Stale"}  # what groups of older versions call an input


def _identifier(group: bpy.types.NodeTree, name: str) -> str:
    names = (name, _OLDER.get(name))
    for item in group.interface.items_tree:
        if item.item_type == "SOCKET" and item.in_out == "INPUT" and item.name in names:
            return item.identifier
    raise KeyError(f"node group {group.name!r} has no input {name!r}")


def has_input(modifier: bpy.types.NodesModifier, name: str) -> bool:
    """Whether the node group, perhaps of an older version, has an input called name."""
    names, items = (name, _OLDER.get(name)), modifier.node_group.interface.items_tree
    return any(item.item_type == "SOCKET" and item.name in names for item in items)


def get_input(modifier: bpy.types.NodesModifier, name: str) -> Any:
    """Value of the input called name."""
    identifier = _identifier(modifier.node_group, name)
    if hasattr(modifier, "properties"):  # Blender 5.2 gave the inputs a type of their own
        return getattr(modifier.properties.inputs, identifier).value
    return modifier.get(identifier)


def set_input(modifier: bpy.types.NodesModifier, name: str, value: Any) -> None:
    """Set the input called name; value has the socket's own type.

    A data-block is set only where it is another one: that has the whole scene's relations built.
    """
    block = value is None or isinstance(value, bpy.types.ID)
    if block and get_input(modifier, name) == value:
        return
    identifier = _identifier(modifier.node_group, name)
    if hasattr(modifier, "properties"):
        getattr(modifier.properties.inputs, identifier).value = value
    else:
        modifier[identifier] = value
    if block:
        modifier.node_group = modifier.node_group  # has the depsgraph ask for its relations anew
