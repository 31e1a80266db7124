# SPDX-License-Identifier: GPL-3.0-or-later
"""Corners of a mesh's faces as arrays.

Blender hands out an attribute as one block of memory, but asks each corner or triangle by itself
for a property, which takes a hundred times as long.
"""

import bpy
import numpy as np

from ...core.surface.arrays import Floats, Ints, is_sheared
from ...core.surface.mesh_snapshot import Singles


def corner_vertices(mesh: bpy.types.Mesh) -> Ints:
    """Vertex (c,) of each corner, face after face."""
    vertices = np.empty(len(mesh.loops), dtype=np.int32)
    if len(vertices) > 0:
        mesh.attributes[".corner_vert"].data.foreach_get("value", vertices)
    return vertices


def polygon_starts(mesh: bpy.types.Mesh) -> Ints:
    """First corner (p,) of each polygon."""
    starts = np.empty(len(mesh.polygons), dtype=np.int32)
    mesh.polygons.foreach_get("loop_start", starts)
    return starts


def triangle_corners(mesh: bpy.types.Mesh) -> Ints:
    """Corners (f, 3) of the triangles that Blender cuts the faces into."""
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    if count == len(mesh.polygons):  # every face is a triangle
        return np.arange(3 * count, dtype=np.int32).reshape(-1, 3)
    corners = np.empty(3 * count, dtype=np.int32)
    mesh.loop_triangles.foreach_get("loops", corners)
    return corners.reshape(-1, 3)


def has_corner_normals(mesh: bpy.types.Mesh, matrix: Floats) -> bool:
    """Whether the normals of a mesh are not those of its vertices where a matrix brings it."""
    return mesh.normals_domain != "POINT" or is_sheared(matrix)


def shading_normals(mesh: bpy.types.Mesh) -> Singles:
    """Unit normals (c, 3) of the corners, or (p, 3) of the faces where all of them are flat."""
    flat = mesh.normals_domain == "FACE"
    normals = mesh.polygon_normals if flat else mesh.corner_normals
    found = np.empty((len(normals), 3), dtype=np.float32)
    normals.foreach_get("vector", found.ravel())
    return found
