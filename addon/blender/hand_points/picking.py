# SPDX-License-Identifier: GPL-3.0-or-later
"""The place on a surface that is under the mouse."""

import bpy
import numpy as np
from bpy_extras.view3d_utils import region_2d_to_origin_3d, region_2d_to_vector_3d
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from ...core.surface.arrays import Floats
from ..scatter.object import surface_of
from ..surface.mesh import evaluated_mesh


def ray_hit(surface: bpy.types.Object, origin: Vector, direction: Vector) -> Floats | None:
    """The first intersection of a ray with the surface in world space; None if there is none."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    matrix = surface.evaluated_get(depsgraph).matrix_world
    inverse = matrix.inverted_safe()
    begin, end = inverse @ origin, inverse @ (origin + direction)
    if surface.type == "MESH":
        there, place, _, _ = surface.evaluated_get(depsgraph).ray_cast(begin, end - begin)
    else:
        with evaluated_mesh(surface, depsgraph) as mesh:
            faces = [tuple(face.vertices) for face in mesh.polygons]
            tree = BVHTree.FromPolygons([vertex.co for vertex in mesh.vertices], faces)
        place = tree.ray_cast(begin, end - begin)[0]
        there = place is not None
    return np.array(matrix @ place) if there else None


def place_under_mouse(context: bpy.types.Context, event: bpy.types.Event) -> Floats | None:
    """The place on the active scatter's surface that is under the mouse; None if there is none."""
    region, view = context.region, context.region_data
    if view is None:
        return None
    at = event.mouse_region_x, event.mouse_region_y
    origin = region_2d_to_origin_3d(region, view, at)
    return ray_hit(surface_of(context.object), origin, region_2d_to_vector_3d(region, view, at))
