# SPDX-License-Identifier: GPL-3.0-or-later
"""Places on a surface: under the mouse, along rays, nearest to another place."""

from collections.abc import Callable
from typing import Any

import bpy
import numpy as np
from bpy_extras.view3d_utils import region_2d_to_origin_3d, region_2d_to_vector_3d
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from ...core.spray import Contact
from ...core.surface.arrays import Floats
from ..base.mesh_arrays import corner_vertices, matrix_of, polygon_starts
from ..base.object_handles import ObjectHandle
from ..scatter.object import surface_of
from ..surface.mesh import evaluated_mesh

Pixels = tuple[float, float]  # in a region
_Found = tuple[Vector, Vector] | None  # place and normal in the surface's own space


class Rays:
    """Searches on the evaluated faces of a surface, in world space. Blender keeps a tree of the
    faces of meshes; of other objects one is made here, of their faces as they are now.
    """

    def __init__(self, surface: bpy.types.Object) -> None:
        self._surface = ObjectHandle(surface)
        self._tree = None if surface.type == "MESH" else _tree_of(surface)

    def first(self, origin: Floats, direction: Floats) -> Contact | None:
        """The first intersection with a ray; None if there is none."""
        matrix, own = self._spaces()
        cast, _ = self._searches()
        begin, way = own[:3, :3] @ origin + own[:3, 3], own[:3, :3] @ direction
        return _contact(matrix, own, cast(begin.tolist(), way.tolist(), np.inf))

    def nearest(self, place: Floats) -> Contact | None:
        """The place nearest to another one in the surface's own space; None without faces."""
        matrix, own = self._spaces()
        _, nearest = self._searches()
        return _contact(matrix, own, nearest((own[:3, :3] @ place + own[:3, 3]).tolist()))

    def between(self, begins: Floats, ends: Floats) -> tuple[Floats, Floats]:
        """Where lines (k, 3) first meet a face: places and normals (k, 3), nan if nowhere."""
        matrix, own = self._spaces()
        cast, _ = self._searches()
        starts, ways = begins @ own[:3, :3].T + own[:3, 3], (ends - begins) @ own[:3, :3].T
        lengths = np.linalg.norm(ways, axis=1)
        found = np.full((2, len(begins), 3), np.nan)
        lines = zip(starts.tolist(), ways.tolist(), lengths.tolist(), strict=True)
        for row, line in enumerate(lines):
            hit = cast(*line)
            if hit is not None:
                found[0, row], found[1, row] = hit
        return found[0] @ matrix[:3, :3].T + matrix[:3, 3], _units(found[1] @ own[:3, :3])

    def _spaces(self) -> tuple[Floats, Floats]:
        """The matrices (4, 4) to world space and back."""
        evaluated = self._surface.get().evaluated_get(bpy.context.evaluated_depsgraph_get())
        return matrix_of(evaluated), np.array(evaluated.matrix_world.inverted_safe())

    def _searches(self) -> tuple[Callable[..., _Found], Callable[..., _Found]]:
        """Ray casting and the search for the nearest place. The evaluated object is looked up each
        time, since Blender replaces it.
        """
        if self._tree is not None:
            return _of_tree(self._tree)
        return _of_mesh(self._surface.get().evaluated_get(bpy.context.evaluated_depsgraph_get()))


def place_under_mouse(context: bpy.types.Context, event: bpy.types.Event) -> Floats | None:
    """The place on the active scatter's surface that is under the mouse; None if there is none."""
    at = event.mouse_region_x, event.mouse_region_y
    found = contact_at(context.region, context.region_data, at, Rays(surface_of(context.object)))
    return None if found is None else found.place


def contact_at(
    region: bpy.types.Region, view: bpy.types.RegionView3D | None, at: Pixels, rays: Rays
) -> Contact | None:
    """The place of a surface that is seen at a pixel of a 3D View; None if there is none."""
    if view is None:
        return None
    origin, way = region_2d_to_origin_3d(region, view, at), region_2d_to_vector_3d(region, view, at)
    return rays.first(np.array(origin), np.array(way))


def _tree_of(surface: bpy.types.Object) -> Any:
    with evaluated_mesh(surface, bpy.context.evaluated_depsgraph_get()) as mesh:
        vertices = np.empty((len(mesh.vertices), 3), dtype=np.float32)
        mesh.vertices.foreach_get("co", vertices.ravel())
        faces = np.split(corner_vertices(mesh), polygon_starts(mesh)[1:])
        return BVHTree.FromPolygons(vertices.tolist(), [one.tolist() for one in faces if len(one)])


def _of_mesh(evaluated: bpy.types.Object) -> tuple[Callable[..., _Found], Callable[..., _Found]]:
    def cast(begin: Any, way: Any, length: float) -> _Found:
        there, place, normal, _ = evaluated.ray_cast(begin, way, distance=min(length, 1e30))
        return (place, normal) if there else None

    def nearest(place: Any) -> _Found:
        there, found, normal, _ = evaluated.closest_point_on_mesh(place)
        return (found, normal) if there else None

    return cast, nearest


def _of_tree(tree: Any) -> tuple[Callable[..., _Found], Callable[..., _Found]]:
    def found(hit: Any) -> _Found:
        return None if hit[0] is None else (hit[0], hit[1])

    def cast(begin: Any, way: Any, length: float) -> _Found:
        return found(tree.ray_cast(begin, way, min(length, 1e30)))

    return cast, lambda place: found(tree.find_nearest(place))


def _contact(matrix: Floats, own: Floats, found: _Found) -> Contact | None:
    if found is None:
        return None
    place, (normal,) = np.array(found[0]), _units(np.array(found[1])[None] @ own[:3, :3])
    if not np.isfinite(normal).all():
        return None
    return Contact(matrix[:3, :3] @ place + matrix[:3, 3], normal)


def _units(vectors: Floats) -> Floats:
    """Vectors (k, 3) of length 1; nan where they have none."""
    with np.errstate(divide="ignore", invalid="ignore"):
        found: Floats = vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
    return found
