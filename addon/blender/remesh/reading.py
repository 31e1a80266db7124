# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading an object's mesh for remeshing: triangles, and edges that are kept."""

import bpy
import numpy as np
from numpy.typing import NDArray

from ...core.base.errors import ScatterError
from ...core.remesh import OldMesh
from ...core.surface.arrays import Floats, Ints
from ...core.surface.mesh_snapshot import RawValues, placed_values
from ..base.mesh_arrays import (
    corner_vertices,
    polygon_starts,
    read_points,
    to_world,
    triangle_corners,
)
from ..surface.mesh import evaluated_mesh
from ..surface.values import own_group_weights, raw_values
from .density import Chosen, Images

# Attributes of marked edges.
_WEIGHTS = ("crease_edge", "bevel_weight_edge")
_SAME = 1e-5  # texture coordinates that differ by less are the same
_ALIKE = 0.996  # cosine of two normals between which no hard edge is seen: 5 degrees


def read_old(obj: bpy.types.Object, chosen: Chosen) -> OldMesh:
    """The object's own mesh, without modifiers, in world space.

    Raises:
        ScatterError: only modifiers make faces, the chosen density is not there, or it cannot be
            one.
    """
    mesh, name = obj.data, chosen.values
    corners, vertices = triangle_corners(mesh), corner_vertices(mesh)
    has_faces = len(vertices) > 0
    if not has_faces and _has_faces_shown(obj):
        raise ScatterError(
            f"'{obj.name}' has no faces of its own, its modifiers make them: apply them first, by "
            "Object > Convert > Mesh"
        )
    return OldMesh(
        name=obj.name,
        vertices=to_world(obj, read_points(mesh)),
        faces=vertices[corners] if has_faces else np.empty((0, 3), np.int32),
        lines=lines_of(mesh),
        density=placed_density(obj.name, mesh, _own_values(obj, name)) if name else None,
        picture=Images(chosen).on(obj, mesh, corners) if has_faces else None,
    )


def _has_faces_shown(obj: bpy.types.Object) -> bool:
    with evaluated_mesh(obj, bpy.context.evaluated_depsgraph_get()) as mesh:
        return len(mesh.polygons) > 0


def _own_values(obj: bpy.types.Object, name: str) -> RawValues:
    """An attribute, or the weights of a vertex group."""
    raw = raw_values(obj, obj.data, name)
    return RawValues(name, "POINT", own_group_weights(obj, name)) if raw is None else raw


def placed_density(name: str, mesh: bpy.types.Mesh, raw: RawValues) -> Floats:
    """A density for the mesh of an object with this name, as OldMesh has it."""
    return placed_values(name, [raw], polygon_starts(mesh), triangle_corners(mesh))[0][raw.name]


def triangle_polygons(mesh: bpy.types.Mesh) -> Ints:
    """The polygon (t,) of each triangle."""
    mesh.calc_loop_triangles()
    found = np.empty(len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("polygon_index", found)
    return found


def edge_vertices(mesh: bpy.types.Mesh) -> Ints:
    """Vertices (e, 2) of the edges."""
    found = np.empty(2 * len(mesh.edges), np.int32)
    mesh.edges.foreach_get("vertices", found)
    return found.reshape(-1, 2)


def lines_of(mesh: bpy.types.Mesh) -> Ints:
    """Edges (k, 2) that stay: marked ones, seams of textures, borders of materials."""
    marked = np.zeros(len(mesh.edges), bool)
    for name in ("use_seam", "use_edge_sharp"):
        values = np.empty(len(mesh.edges), bool)
        mesh.edges.foreach_get(name, values)
        marked |= values
    for name in _WEIGHTS:
        attribute = mesh.attributes.get(name)
        if attribute is not None and attribute.domain == "EDGE":
            weights = np.empty(len(mesh.edges), np.float32)
            attribute.data.foreach_get("value", weights)
            marked |= weights > 0
    # Files repeat vertices along seams and hard edges: these have one face on each side.
    uses = _faces_of_edges(mesh)
    marked |= _divided(mesh) | (uses == 1)
    return edge_vertices(mesh)[marked & (uses > 0)]


def _faces_of_edges(mesh: bpy.types.Mesh) -> Ints:
    """The number (e,) of faces at each edge."""
    return np.bincount(_corner_edges(mesh), minlength=len(mesh.edges)).astype(np.int32)


def _corner_edges(mesh: bpy.types.Mesh) -> Ints:
    """The edge (c,) after each corner."""
    found = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("edge_index", found)
    return found


def _divided(mesh: bpy.types.Mesh) -> np.ndarray:
    """Per edge, whether texture coordinates or materials differ on its two sides."""
    edges, nexts = _corner_edges(mesh), _next_corners(mesh)
    order = np.argsort(edges, kind="stable")
    same = edges[order][1:] == edges[order][:-1]
    first, second = order[:-1][same], order[1:][same]
    vertices = corner_vertices(mesh)
    turned = vertices[first] == vertices[nexts[second]]
    found = np.zeros(len(mesh.edges), bool)
    for values in _corner_values(mesh):
        begin = np.where(turned[:, None], values[nexts[second]], values[second])
        end = np.where(turned[:, None], values[second], values[nexts[second]])
        # At the pole of a sphere they differ at one end alone, which is no seam.
        apart = np.abs(values[first] - begin).max(axis=1) > _SAME
        apart &= np.abs(values[nexts[first]] - end).max(axis=1) > _SAME
        found[edges[first[apart]]] = True
    return found


def _next_corners(mesh: bpy.types.Mesh) -> Ints:
    """The next corner (c,) of the polygon of each."""
    totals = _corner_counts(mesh)
    ends = np.cumsum(totals)
    found = np.arange(1, len(mesh.loops) + 1, dtype=np.int32)
    found[ends - 1] = ends - totals
    return found


def _corner_counts(mesh: bpy.types.Mesh) -> Ints:
    """The number (p,) of corners of each polygon."""
    found = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_total", found)
    return found


def _corner_values(mesh: bpy.types.Mesh) -> list[Floats]:
    """Values that divide the surface: texture coordinates (c, 2), and the material (c, 1) of the
    corners' faces.
    """
    found = []
    for layer in mesh.uv_layers:
        values = np.empty(2 * len(mesh.loops), np.float32)
        layer.uv.foreach_get("vector", values)
        found.append(values.reshape(-1, 2).astype(np.float64))
    materials = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("material_index", materials)
    found.append(np.repeat(materials, _corner_counts(mesh))[:, None].astype(np.float64))
    return found


def hard_edges(mesh: bpy.types.Mesh) -> NDArray[np.bool_]:
    """Per edge (e,) between smooth faces, whether they are shaded apart: at a sharp edge, by custom
    normals, or because files of other programs repeat the vertices there.
    """
    normals, ends = _normals_along(mesh)
    _, group = np.unique(
        ends.min(axis=1) * len(mesh.vertices) + ends.max(axis=1), return_inverse=True
    )
    order = np.argsort(group, kind="stable")
    first, second = order[:-1], order[1:]
    apart = (normals[first] * normals[second]).sum(axis=2).max(axis=1) < _ALIKE
    smooth = _smooth_corners(mesh)
    apart &= (group[first] == group[second]) & smooth[first] & smooth[second]
    hard = np.zeros(len(mesh.loops), bool)
    hard[group[first[apart]]] = True
    found = np.zeros(len(mesh.edges), bool)
    found[_corner_edges(mesh)] = hard[group]
    return found


def _normals_along(mesh: bpy.types.Mesh) -> tuple[Floats, NDArray[np.int64]]:
    """The normals (c, 2, 3) at both ends of the edge after each corner, and the places (c, 2) of
    the ends, the smaller number first.
    """
    nexts, places = _next_corners(mesh), _places_of_vertices(mesh)[corner_vertices(mesh)]
    normals = np.empty(3 * len(mesh.loops), np.float32)
    mesh.corner_normals.foreach_get("vector", normals)
    found = np.stack([np.arange(len(nexts)), nexts], axis=1)
    turned = places > places[nexts]
    found[turned] = found[turned, ::-1]
    return normals.reshape(-1, 3).astype(np.float64)[found], places[found]


def _places_of_vertices(mesh: bpy.types.Mesh) -> NDArray[np.int64]:
    """Per vertex (v,) a number that those at the same place share."""
    _, found = np.unique(read_points(mesh), axis=0, return_inverse=True)
    return found.ravel().astype(np.int64)


def _smooth_corners(mesh: bpy.types.Mesh) -> NDArray[np.bool_]:
    """Per corner, whether its polygon is shaded smooth."""
    smooth = np.empty(len(mesh.polygons), bool)
    mesh.polygons.foreach_get("use_smooth", smooth)
    return np.repeat(smooth, _corner_counts(mesh))
