# SPDX-License-Identifier: GPL-3.0-or-later
"""Corners of a mesh's faces as arrays.

Blender hands out an attribute as one block of memory, but asks each corner or triangle by itself
for a property, which takes a hundred times as long.
"""

import bpy
import numpy as np

from ...core.surface import Ints


def corner_vertices(mesh: bpy.types.Mesh) -> Ints:
    """Vertex (c,) of each corner, face after face."""
    vertices = np.empty(len(mesh.loops), dtype=np.int32)
    if len(vertices) > 0:
        mesh.attributes[".corner_vert"].data.foreach_get("value", vertices)
    return vertices


def triangles(mesh: bpy.types.Mesh) -> Ints:
    """Vertices (f, 3) of the triangles that Blender cuts the faces into."""
    mesh.calc_loop_triangles()
    vertices, count = corner_vertices(mesh), len(mesh.loop_triangles)
    if count == len(mesh.polygons):  # every face is a triangle
        return vertices.reshape(-1, 3)
    corners = np.empty(3 * count, dtype=np.int32)
    mesh.loop_triangles.foreach_get("loops", corners)
    return vertices[corners].reshape(-1, 3)
