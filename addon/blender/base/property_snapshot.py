# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of Blender's structs and their custom properties, to be restored later."""

from collections.abc import Iterable
from contextlib import suppress
from typing import Any

import bpy


def is_group(prop: bpy.types.Property) -> bool:
    """Whether a property is a property group of an add-on, or a list of them."""
    group = bpy.types.PropertyGroup.bl_rna
    return prop.type in {"POINTER", "COLLECTION"} and prop.fixed_type.base == group


class Properties:
    """Values of one of Blender's structs, and of property groups in it."""

    def __init__(self, struct: Any, leave: Iterable[str] = (), groups: bool = True) -> None:
        self._struct, self._groups = struct, groups
        self._set: dict[str, Any] = {}  # values by name
        self._unset: set[str] = set()  # names of those that were never set
        self._inside: dict[str, Properties] = {}
        self._lists: dict[str, list[Properties]] = {}
        for prop in struct.bl_rna.properties:
            name = prop.identifier
            if name in leave or name == "rna_type":
                continue
            if is_group(prop):
                self._take_group(prop, groups)
            elif not prop.is_readonly and prop.type != "COLLECTION":
                self._set[name] = plain(getattr(struct, name))
                if groups and not struct.is_property_set(name):
                    self._unset.add(name)

    def _take_group(self, prop: bpy.types.Property, groups: bool) -> None:
        name = prop.identifier
        value: Any = getattr(self._struct, name) if groups else None
        if groups and prop.type == "COLLECTION":
            self._lists[name] = [Properties(one) for one in value]
        elif groups:
            self._inside[name] = Properties(value)

    def restore(self, struct: Any = None) -> None:
        struct = self._struct if struct is None else struct
        for name, inside in self._inside.items():
            inside.restore(getattr(struct, name))
        for name, before in self._lists.items():
            _restore_list(getattr(struct, name), before)
        for name, value in self._set.items():
            lost = self._groups and name not in self._unset and not struct.is_property_set(name)
            if lost or not _same(plain(getattr(struct, name)), value):
                with suppress(AttributeError, TypeError):  # Blender computes some values
                    setattr(struct, name, value)
        for name in self._unset:
            if struct.is_property_set(name):
                struct.property_unset(name)


def _restore_list(items: Any, before: list[Properties]) -> None:
    while len(items) > len(before):
        items.remove(len(items) - 1)
    while len(items) < len(before):
        items.add()
    for item, one in zip(items, before, strict=True):
        one.restore(item)


def _same(one: Any, other: Any) -> bool:
    return one is other or repr(one) == repr(other)


def plain(value: Any) -> Any:
    """A copy of a value that does not change with the file; data-blocks are not copied."""
    if isinstance(value, (bool, int, float, str, set, frozenset, bpy.types.ID)) or value is None:
        return value
    if hasattr(value, "to_dict"):
        return value.to_dict()
    if hasattr(value, "__len__"):
        return tuple(plain(one) for one in value)
    return value


def custom_of(block: bpy.types.ID) -> dict[str, Any]:
    """Custom properties of a data-block, without those that add-ons registered."""
    registered = {prop.identifier for prop in block.bl_rna.properties}
    return {name: plain(block[name]) for name in set(block.keys()) - registered}


def restore_custom(block: bpy.types.ID, before: dict[str, Any]) -> None:
    now = custom_of(block)
    for name in now.keys() - before.keys():
        del block[name]
    for name, value in before.items():
        if name not in now or not _same(now[name], value):
            block[name] = value
