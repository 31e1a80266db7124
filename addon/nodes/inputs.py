# SPDX-License-Identifier: GPL-3.0-or-later
"""Inputs of a node group's modifier, by their names."""

from typing import Any

import bpy


def _identifier(group: bpy.types.NodeTree, name: str) -> str:
    for item in group.interface.items_tree:
        if item.item_type == "SOCKET" and item.in_out == "INPUT" and item.name == name:
            return item.identifier
    raise KeyError(f"node group {group.name!r} has no input {name!r}")


def has_input(modifier: bpy.types.NodesModifier, name: str) -> bool:
    """Whether the node group has an input called name."""
    return name in input_names(modifier)


def input_names(modifier: bpy.types.NodesModifier) -> set[str]:
    """The names for which has_input is true; look up several names in them."""
    items = modifier.node_group.interface.items_tree
    return {item.name for item in items if item.item_type == "SOCKET"}


def get_input(modifier: bpy.types.NodesModifier, name: str) -> Any:
    """Value of the input called name."""
    identifier = _identifier(modifier.node_group, name)
    if hasattr(modifier, "properties"):  # since Blender 5.2 inputs have their own type
        return getattr(modifier.properties.inputs, identifier).value
    return modifier.get(identifier)


def set_input(modifier: bpy.types.NodesModifier, name: str, value: Any) -> None:
    """Set the input with this name; the value has the socket's type.

    A data-block is only set if it differs, as setting it rebuilds the relations of the whole scene.
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
        modifier.node_group = modifier.node_group  # makes the depsgraph rebuild its relations


def inputs_of(modifier: bpy.types.NodesModifier) -> dict[str, Any]:
    """All stored values of the inputs, by Blender's identifiers."""
    if hasattr(modifier, "properties"):
        inputs = modifier.properties.inputs
        names = [
            item.identifier for item in modifier.node_group.interface.items_tree if _is_in(item)
        ]
        there = [name for name in names if hasattr(getattr(inputs, name, None), "value")]
        return {name: _plain(getattr(inputs, name).value) for name in there}
    return {name: _plain(modifier[name]) for name in modifier.keys()}  # noqa: SIM118


def restore_inputs(modifier: bpy.types.NodesModifier, values: dict[str, Any]) -> None:
    """Restore the values that inputs_of returned for the same node group."""
    now = inputs_of(modifier)
    changed = {name: value for name, value in values.items() if now.get(name) != value}
    for name, value in changed.items():
        if hasattr(modifier, "properties"):
            getattr(modifier.properties.inputs, name).value = value
        else:
            modifier[name] = value
    for name in now.keys() - values.keys():
        del modifier[name]
    if changed:
        modifier.node_group = modifier.node_group  # has the depsgraph ask for its relations anew


def _is_in(item: Any) -> bool:
    return item.item_type == "SOCKET" and item.in_out == "INPUT"


def _plain(value: Any) -> Any:
    return value.to_list() if hasattr(value, "to_list") else value
