# SPDX-License-Identifier: GPL-3.0-or-later
"""The scatters of a surface."""

import bpy

from ..scatter.object import is_scatter
from .joined_parts import is_joined, objects_of


def scatters_of(surface: bpy.types.Object) -> list[bpy.types.Object]:
    """The scatters on a surface or on a part of one, in the view layer."""
    there = bpy.context.view_layer.objects
    return [obj for obj in there if is_scatter(obj) and _is_on(obj.dapple.surface, surface)]


def _is_on(surface: bpy.types.Object | None, obj: bpy.types.Object) -> bool:
    return surface == obj or (is_joined(surface) and obj in objects_of(surface))
