# SPDX-License-Identifier: GPL-3.0-or-later
"""The current scene, to be compared with the inputs of a result.

Each part is read on demand and kept until it is marked as changed, so a check after a change only
reads what changed.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import bpy
import numpy as np

from ...core.bake.keys import wrong_index
from ...core.density.terms import names_of
from ...core.settings.values import marks_of, materials_of
from ...core.solve.stale import Sketched, sketched
from ...core.surface.arrays import SurfaceArrays, topology_digest
from ...core.surface.sources import (
    Outline,
    Sources,
    around_sources,
    joined,
    outline_of,
    surface_sources,
)
from ..scatter.key_stores import key_tables, stores_of
from ..scatter.object import is_scatter, settings_of
from ..scatter.points import points_digest
from ..surface.joined_parts import collections_of, members_of
from ..surface.mesh import read_outline
from ..surface.reading import value_digests
from ..surface.scene_objects import own_objects
from ..surface.surroundings import read_around

SURFACE, VALUES, AROUND = "surface", "values", "around"
POINTS, KEYS = "points", "keys"


@dataclass(frozen=True)
class SurfaceSummary:
    """The current surface without its arrays."""

    name: str
    vertices: int
    trouble: str  # why it cannot have points, in English; empty if it can
    empty: bool  # whether it has no faces
    outline: Outline
    sketched: Sketched


@dataclass
class SceneSnapshot:
    """The current inputs of one scatter, as far as they were read."""

    parts: dict[str, tuple[Any, Any]] = field(default_factory=dict)  # name: (version, value)

    def forget(self, *names: str) -> None:
        """Read these parts again when they are needed."""
        for name in names:
            self.parts.pop(name, None)

    def surface(self, obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> SurfaceSummary:
        """The surface of a scatter; ScatterError if it has no mesh."""
        surface = obj.dapple.surface
        return self._kept(SURFACE, surface.session_uid, lambda: _summarize(surface))

    def sources(self, obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> Sources:
        """All current inputs of a solution; ScatterError if there can be no solution."""
        settings, surface = settings_of(obj), obj.dapple.surface
        outline, uid = self.surface(obj, depsgraph).outline, surface.session_uid
        names, materials = names_of(settings), materials_of(settings.density)
        marks = marks_of(settings)
        values = self._kept(
            VALUES,
            (uid, names, materials, marks),
            lambda: value_digests(surface, names, materials, marks),
        )
        own = sorted(one.session_uid for one in own_objects(obj))
        nearby = self._kept(
            AROUND,
            (uid, settings.density, own),
            lambda: around_sources(outline.pose, read_around(settings, surface, obj)),
        )
        found = surface_sources(outline, values, settings)
        return replace(joined(found, nearby), frame=float(depsgraph.scene.frame_current_final))

    def points(self, obj: bpy.types.Object) -> str:
        """Digest of the points as they are stored."""
        return str(self._kept(POINTS, obj.data.session_uid, lambda: points_digest(obj)))

    def wrong_key(self, obj: bpy.types.Object) -> str:
        """The first invalid index of a bake; empty if all are valid."""
        version = obj.dapple.bake_fingerprint
        return str(self._kept(KEYS, version, lambda: wrong_index(*key_tables(obj))))

    def _kept(self, name: str, version: Any, read: Callable[[], Any]) -> Any:
        known = self.parts.get(name)
        if known is None or known[0] != version:
            known = self.parts[name] = (version, read())
        return known[1]


def _summarize(surface: bpy.types.Object) -> SurfaceSummary:
    arrays = read_outline(surface)
    count, empty = len(arrays.vertices), _is_empty(arrays)
    trouble = "has no faces" if empty else _trouble(arrays)
    if trouble:
        arrays = replace(arrays, vertices=np.empty((0, 3)))
    return SurfaceSummary(arrays.name, count, trouble, empty, outline_of(arrays), sketched(arrays))


def _is_empty(arrays: SurfaceArrays) -> bool:
    """Whether a surface that is not triangulated has no faces."""
    none = np.empty(0, dtype=np.int32)
    count = len(arrays.vertices)
    return not count or arrays.topology == topology_digest(count, none, none)


def _trouble(arrays: SurfaceArrays) -> str:
    finite = np.isfinite(arrays.vertices).all(axis=1)
    if finite.all():
        return ""
    vertex = int(np.argmin(finite))
    return f"vertices[{vertex}] is not finite: {arrays.vertices[vertex].tolist()}"


def depends_on(obj: bpy.types.Object, scene: bpy.types.Scene) -> dict[int, tuple[str, ...]]:
    """Data-blocks that a result depends on, by session_uid, with the parts read from each."""
    density, surface = obj.dapple.density, obj.dapple.surface
    found: dict[int, tuple[str, ...]] = {obj.session_uid: ()}
    around = [scene, density.image, *_obstacles(density.avoid_collection)]
    if density.avoid_shape != "DISC":
        around += _instances(density.avoid_collection)
    if density.use_distance:
        around += _with_data(density.distance_object)
        around += _obstacles(density.distance_collection)
    if density.use_camera_view:
        around += _with_data(scene.camera)
        around += _obstacles(density.hiding_collection) if density.camera_hidden else []
    whole = [block for one in members_of(surface) for block in _with_data(one)]
    parts = [([*whole, *collections_of(surface)], (SURFACE, VALUES, AROUND)), (around, (AROUND,))]
    parts += [([obj.data], (POINTS,)), (_stores(obj), (KEYS,))]
    for blocks, names in parts:
        for block in filter(None, blocks):
            known = found.get(block.session_uid, ())
            found[block.session_uid] = (*known, *names)
    return found


def _with_data(obj: bpy.types.Object | None) -> list[Any]:
    return [] if obj is None else [obj, obj.data]


def _obstacles(collection: bpy.types.Collection | None) -> list[Any]:
    if collection is None:
        return []
    objects = [block for obj in collection.all_objects for block in _with_data(obj)]
    return [collection, *collection.children_recursive, *objects]


def _instances(collection: bpy.types.Collection | None) -> list[Any]:
    """Objects that the scatters of a collection instance."""
    scatters = [obj for obj in collection.all_objects if is_scatter(obj)] if collection else []
    return [block for obj in scatters for one in own_objects(obj) for block in _with_data(one)]


def _stores(obj: bpy.types.Object) -> list[Any]:
    if not obj.dapple.baked_keys:
        return []
    return [block for store in stores_of(obj) for block in _with_data(store)]
