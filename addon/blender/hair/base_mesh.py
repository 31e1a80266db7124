# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh that hair is attached to: without modifiers, and with a UV map."""

from dataclasses import dataclass

import bpy
import numpy as np
from mathutils.bvhtree import BVHTree
from numpy.typing import NDArray

from ...core.base.errors import ScatterError
from ...core.surface.arrays import Floats, SurfaceArrays
from ...core.surface.mesh_snapshot import RawMesh, surface_of_raw
from ...core.surface.records import Binding
from ..base.mesh_arrays import (
    corner_vertices,
    has_corner_normals,
    matrix_of,
    polygon_starts,
    read_points,
    shading_normals,
    triangle_corners,
)
from ..base.translation import english
from ..scatter.linked_data import read_only
from ..scatter.object import TO_MESH, kind_of
from ..surface.joined_parts import is_joined

_SAME_UV = 1e-6  # texture coordinates that are nearer than this are the same
_SAME_PLACE = 1e-3  # of the surface's size


@dataclass(frozen=True)
class BaseMesh:
    """A surface without its modifiers."""

    arrays: SurfaceArrays
    uv_map: str  # name of the active UV map
    uv: Floats  # (c, 2) its coordinates at the face corners


def check_can_have_hair(surface: bpy.types.Object) -> None:
    """ScatterError unless Blender can attach hair to an object."""
    name = surface.name
    if is_joined(surface):
        raise ScatterError(
            f"Surface '{name}' is made of several objects, and Blender attaches hair to one: "
            "scatter over a single object"
        )
    if surface.type != "MESH":
        raise ScatterError(
            f"Surface '{name}' is a {kind_of(surface)}, and Blender attaches hair to meshes. "
            f"{TO_MESH}"
        )
    if reason := read_only(surface, english):
        raise ScatterError(f"The surface cannot be changed for hair: {reason}")
    if surface.mode != "OBJECT":
        raise ScatterError(f"Surface '{name}' is not in Object Mode: switch to it first")
    if surface.data.uv_layers.active is None:
        raise ScatterError(
            f"Surface '{name}' has no UV map, by which Blender attaches hair: unwrap it first, "
            "with UV > Unwrap in Edit Mode"
        )


def read_base(surface: bpy.types.Object) -> BaseMesh:
    """The mesh of an object without modifiers and shape keys."""
    mesh, matrix = surface.data, matrix_of(surface)
    raw = RawMesh(
        surface.name,
        read_points(mesh).astype(np.float32),
        corner_vertices(mesh),
        polygon_starts(mesh),
        triangle_corners(mesh),
        matrix,
        normals=shading_normals(mesh) if has_corner_normals(mesh, matrix) else None,
    )
    layer = mesh.uv_layers.active
    uv = np.empty((len(mesh.loops), 2), dtype=np.float32)
    layer.uv.foreach_get("vector", uv.ravel())
    return BaseMesh(surface_of_raw(raw), layer.name, uv.astype(np.float64))


def shared_coordinates(base: BaseMesh, roots: Binding) -> NDArray[np.bool_]:
    """Which roots (n,) have texture coordinates that belong to another place of the mesh too."""
    corners, faces = base.arrays.face_corners, base.arrays.faces
    flat = np.column_stack([base.uv, np.zeros(len(base.uv))])
    tree = BVHTree.FromPolygons(flat.tolist(), corners.tolist(), all_triangles=True)
    places = roots.positions(base.arrays.vertices)
    near = _SAME_PLACE * float(np.linalg.norm(np.ptp(base.arrays.vertices, axis=0)))
    found = np.zeros(len(places), dtype=bool)
    for row, (u, v) in enumerate(roots.interpolated(base.uv[roots.loops])):
        for place, _, face, _ in tree.find_nearest_range((u, v, 0.0), _SAME_UV):
            weights = _weights(base.uv[corners[face]], np.array(place[:2]))
            there = weights @ base.arrays.vertices[faces[face]]
            found[row] |= not np.linalg.norm(there - places[row]) <= near
    return found


def _weights(triangle: Floats, place: Floats) -> Floats:
    """Barycentric coordinates (3,) of a place in a triangle (3, 2); nan if it has no area."""
    edges = (triangle[1:] - triangle[0]).T
    area = edges[0, 0] * edges[1, 1] - edges[0, 1] * edges[1, 0]
    if area == 0.0:
        return np.full(3, np.nan)
    second, third = np.linalg.solve(edges, place - triangle[0])
    return np.array([1.0 - second - third, second, third])
