# SPDX-License-Identifier: GPL-3.0-or-later
"""The evaluated mesh of a surface: its places, faces and rest positions, read at once."""

import hashlib
from collections.abc import Collection, Iterable, Iterator
from contextlib import contextmanager

import bpy
import numpy as np

from ...core.base.errors import ScatterError
from ...core.surface.arrays import Floats, Ints, SurfaceArrays, topology_digest
from ...core.surface.mesh_snapshot import RawValues, cut_alike, placed_values, sizes, world_normals
from ...core.surface.sources import digest_of
from ..base.mesh_arrays import (
    corner_vertices,
    has_corner_normals,
    matrix_of,
    polygon_starts,
    read_columns,
    read_points,
    shading_normals,
    triangle_corners,
)
from ..scatter.object import is_fluid
from .joined import parts_of
from .values import read_materials, read_weights


@contextmanager
def evaluated_mesh(
    obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph
) -> Iterator[bpy.types.Mesh]:
    """The mesh of an object after its modifiers, gone when the block ends."""
    evaluated = obj.evaluated_get(depsgraph)
    if not evaluated.is_evaluated:
        raise ScatterError(
            f"Surface '{obj.name}' is not evaluated: it must be in the view layer and not disabled"
        )
    mesh = evaluated.to_mesh()
    if mesh is None:
        raise ScatterError(f"Surface '{obj.name}' has no mesh: its type is {obj.type}")
    try:
        yield mesh
    finally:
        evaluated.to_mesh_clear()


def read_surface(
    obj: bpy.types.Object,
    depsgraph: bpy.types.Depsgraph,
    names: Iterable[str] = (),
    materials: Collection[str] = (),
    cut: bool = True,
    like: SurfaceArrays | None = None,
) -> SurfaceArrays:
    """The evaluated surface in world space, with values by name, and where materials are.

    Triangulated, which takes most of the time, or without faces and values. A surface of the same
    polygons, `like`, has them cut as there.
    """
    with evaluated_mesh(obj, depsgraph) as mesh:
        matrix = matrix_of(obj.evaluated_get(depsgraph))
        points, corners = read_points(mesh), corner_vertices(mesh)
        vertices = points @ matrix[:3, :3].T + matrix[:3, 3]
        polygons = _fluid_topology(mesh) if is_fluid(obj) else topology(mesh)
        if like is not None and like.loops is not None and like.topology == polygons:
            loops = like.loops
        else:
            loops = _triangles(mesh, points, corners) if cut else np.empty((0, 3), dtype=np.int32)
            if np.linalg.det(matrix[:3, :3]) < 0.0:  # a mirrored surface still faces outward
                loops = np.ascontiguousarray(loops[:, ::-1])
        raw = _stored_values(obj, mesh, names, materials)
        on_faces = any(one.domain != "POINT" for one in raw)
        starts = polygon_starts(mesh) if on_faces else np.empty(0, dtype=np.int32)
        weights, digests = placed_values(obj.name, raw, starts, loops)
        return SurfaceArrays(
            obj.name,
            np.ascontiguousarray(vertices),
            corners[loops],
            polygons,
            matrix,
            weights,
            loops=loops,
            normals=_world_normals(mesh, matrix) if cut else None,
            time=float(depsgraph.scene.frame_current_final),
            digests=digests,
        )


def _triangles(mesh: bpy.types.Mesh, points: Floats, corners: Ints) -> Ints:
    """Corners (m, 3) of the triangles, faces on each other cut alike."""
    cut = triangle_corners(mesh)
    if len(cut) == len(mesh.polygons):
        return cut
    return cut_alike(points.astype(np.float32), corners, polygon_starts(mesh), cut)


def _world_normals(mesh: bpy.types.Mesh, matrix: Floats) -> Floats | None:
    """Shading normals (c, 3) of the corners in world space; None where all is smooth."""
    if not has_corner_normals(mesh, matrix):
        return None
    totals = sizes(polygon_starts(mesh), len(mesh.loops))
    return world_normals(shading_normals(mesh), matrix, totals)


def _stored_values(
    obj: bpy.types.Object, mesh: bpy.types.Mesh, names: Iterable[str], materials: Collection[str]
) -> list[RawValues]:
    found = [read_weights(obj, mesh, name) for name in names]
    return [*found, read_materials(obj, mesh, materials)] if materials else found


def value_digests(
    obj: bpy.types.Object,
    depsgraph: bpy.types.Depsgraph,
    names: Collection[str],
    materials: Collection[str],
) -> dict[str, str]:
    """Digests of values of the evaluated surface, by name; see SurfaceArrays.digests."""
    if not names and not materials:
        return {}
    with evaluated_mesh(obj, depsgraph) as mesh:
        found = _stored_values(obj, mesh, names, materials)
    return {raw.name: digest_of([raw.numbers(obj.name)]) for raw in found}


def read_rest(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> Floats:
    """Rest positions (v, 3) of the evaluated surface's vertices; ScatterError if they are lost."""
    name = "rest_position"
    for part in parts_of(obj):
        if part.type == "MESH":  # the parts of a joined surface may be others
            _check_rest(part, depsgraph, name)
    with evaluated_mesh(obj, depsgraph) as mesh:
        return read_columns(mesh, {name: "FLOAT_VECTOR"})[name].astype(np.float64)


def _check_rest(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, name: str) -> None:
    with evaluated_mesh(obj, depsgraph) as mesh:
        if name not in mesh.attributes:
            raise ScatterError(
                f"Surface '{obj.name}': its modifiers make a mesh without rest positions: use "
                "Match Subdivision and set Attach To to Faces, or apply them"
            )


def topology(mesh: bpy.types.Mesh) -> str:
    """Digest of a mesh's polygons."""
    return topology_digest(len(mesh.vertices), corner_vertices(mesh), polygon_starts(mesh))


def _fluid_topology(mesh: bpy.types.Mesh) -> str:
    """Digest of polygons and places, where a face is the same only as long as nothing moves."""
    digest = hashlib.blake2b(topology(mesh).encode(), digest_size=16)
    digest.update(read_points(mesh).tobytes())
    return digest.hexdigest()
