# SPDX-License-Identifier: GPL-3.0-or-later
"""Which scatters follow changes by themselves, and changes of what."""

from collections.abc import Hashable

import bpy

from ...core.base.native import missing
from ..freshness.scene_snapshot import AROUND, SURFACE, VALUES, depends_on
from ..scatter.library import is_in_view_layer, read_only
from ..scatter.object import is_automatic, is_scatter
from ..surface.members import collections_of
from ..surface.surroundings import picture_of

_READ = {SURFACE, VALUES, AROUND}  # what a scatter is solved from


def follows(obj: bpy.types.Object) -> bool:
    """Whether a scatter may be solved without being asked: it has a result of its own, no bake
    that would be lost, and is in Object Mode in the view layer that is shown.
    """
    settings = obj.dapple
    if not settings.solved_settings or settings.baked_keys or not is_automatic(obj):
        return False
    there = is_in_view_layer(obj) and settings.surface is not None
    return there and obj.mode == "OBJECT" and not read_only(obj) and not missing()


def scatters() -> list[bpy.types.Object]:
    """Those of the file."""
    return [obj for obj in bpy.data.objects if is_scatter(obj)]


def dependencies(obj: bpy.types.Object) -> set[Hashable]:
    """What a scatter is solved from, by session_uid; the scatter is not in it.

    Nor are collections, which change with every object in them, and the scene, which changes with
    every selection and whatever is written: what Camera View reads of it stands there as values.
    """
    scene, density = bpy.context.scene, obj.dapple.density
    found: set[Hashable] = {
        uid for uid, parts in depends_on(obj, scene).items() if _READ & set(parts)
    }
    found.discard(scene.session_uid)
    if density.use_camera:
        found.add(picture_of(scene))
    for one in filter(None, (density.obstacles, density.distance_collection)):
        found -= {block.session_uid for block in (one, *one.children_recursive)}
    return found - {one.session_uid for one in collections_of(obj.dapple.surface)}
