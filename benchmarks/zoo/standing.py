# SPDX-License-Identifier: GPL-3.0-or-later
"""Where instances stand and how, judged by the surface as Blender shades it."""

from __future__ import annotations

from collections.abc import Iterator

import bpy
import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree
from mathutils.geometry import barycentric_transform
from numpy.typing import NDArray

_NEAR = 1e-3  # of the size of the surface: faces that a point may stand on


def degrees_off(scatter: bpy.types.Object, surface: bpy.types.Object) -> NDArray[np.float64]:
    """Angles (n,) between the instances' Z axes and the shading normals below them.

    Where several faces are as near (edges, faces on each other) the best of them counts.
    """
    found = []
    for matrix, triangles in _below(scatter, surface):
        axis = matrix.to_3x3().col[2].normalized()
        place = matrix.translation
        angles = []
        for corners, normals, _ in triangles:
            normal = barycentric_transform(place, *corners, *normals)
            angles.append(axis.angle(normal, 0.0))
        found.append(min(angles))
    return np.degrees(found)


def at_faces_of_zero(scatter: bpy.types.Object, surface: bpy.types.Object, attribute: str) -> int:
    """How many instances stand where an attribute of the faces is 0 and on no other face."""
    if not attribute:
        return 0
    values: NDArray[np.float32] = np.empty(len(surface.data.polygons), dtype=np.float32)
    surface.data.attributes[attribute].data.foreach_get("value", values)
    return sum(
        all(values[polygon] == 0.0 for *_, polygon in triangles)
        for _, triangles in _below(scatter, surface)
    )


def _below(scatter: bpy.types.Object, surface: bpy.types.Object) -> Iterator[tuple]:
    """Each instance's matrix and the triangles that it stands on: corners, normals, polygon."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    evaluated = surface.evaluated_get(depsgraph)
    matrix, mesh = evaluated.matrix_world.copy(), evaluated.to_mesh()
    mesh.calc_loop_triangles()
    places = [matrix @ vertex.co for vertex in mesh.vertices]
    turned = matrix.to_3x3().inverted().transposed()
    normals = [(turned @ normal.vector).normalized() for normal in mesh.corner_normals]
    triangles = [
        (
            [places[v] for v in triangle.vertices],
            [normals[k] for k in triangle.loops],
            triangle.polygon_index,
        )
        for triangle in mesh.loop_triangles
    ]
    tree = BVHTree.FromPolygons(places, [t.vertices[:] for t in mesh.loop_triangles])
    near = _NEAR * max(evaluated.dimensions)
    evaluated.to_mesh_clear()
    for instance in depsgraph.object_instances:
        if instance.is_instance and instance.parent.original == scatter:
            found = tree.find_nearest_range(Vector(instance.matrix_world.translation), near)
            nearest = min(distance for *_, distance in found)
            yield (
                instance.matrix_world.copy(),
                [triangles[k] for *_, k, distance in found if distance <= nearest + 0.01 * near],
            )
