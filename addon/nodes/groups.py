# SPDX-License-Identifier: GPL-3.0-or-later
"""Groups inside others, each built once in a file.

Blender looks through a whole tree at each of its edits, so a tree of n nodes takes time n^2 to
build: many small groups are built many times faster than one.
"""

from collections.abc import Callable
from dataclasses import dataclass

import bpy

from .builder import Builder

VERSION = 19
VERSION_KEY = "dapple_version"  # -VERSION for groups inside others
_PART_KEY = "dapple_part"


def version_of(group: bpy.types.NodeTree | None) -> int:
    """Of a group that plays a scatter; 0 of any other."""
    found = 0 if group is None else group.get(VERSION_KEY, 0)
    return found if isinstance(found, int) else 0


@dataclass(frozen=True)
class Group:
    """A node group: its name in the file, and what builds it."""

    name: str
    build: Callable[[], bpy.types.NodeTree]


def inner(b: Builder, part: Group, *feeds: object) -> bpy.types.Node:
    """A node with the group; feeds go to its inputs in their order."""
    return b.group(ensure(part), *feeds)


def ensure(part: Group) -> bpy.types.NodeTree:
    """The group as it is in the open file, built if there is none."""
    for group in bpy.data.node_groups:
        known = group.get(VERSION_KEY) == -VERSION and group.get(_PART_KEY) == part.name
        if known and group.library is None:
            return group
    group = part.build()
    group[VERSION_KEY], group[_PART_KEY] = -VERSION, part.name
    return group
