# SPDX-License-Identifier: GPL-3.0-or-later
"""The evaluated mesh of a surface, read in parts as arrays, and its rest positions."""

from collections.abc import Collection, Generator, Iterator
from contextlib import contextmanager
from typing import Any

import bpy
import numpy as np

from ...core.base.errors import ScatterError
from ...core.base.steps import PAUSE, Task, run_now
from ...core.surface.arrays import Floats, SurfaceArrays, topology_digest
from ...core.surface.mesh_snapshot import RawMesh, RawValues, outline_of_raw, surface_of_raw
from ..base.mesh_arrays import (
    corner_vertices,
    has_corner_normals,
    matrix_of,
    polygon_starts,
    read_columns,
    shading_normals,
)
from ..base.object_handles import ObjectHandle
from ..base.times import time_of
from ..scatter.object import is_fluid
from .joined_parts import parts_of
from .values import group_weights, raw_values, read_marked, read_materials


@contextmanager
def evaluated_mesh(
    obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph
) -> Iterator[bpy.types.Mesh]:
    """The mesh of an object after its modifiers; it is freed at the end of the block."""
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


def read_rest(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> Floats:
    """Rest positions (v, 3) of the evaluated surface's vertices; ScatterError if they are lost."""
    name = "rest_position"
    for part in parts_of(obj):
        if part.type == "MESH":  # parts of a joined surface may have other types
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


Parts = Generator[Task, Any, Any]


def mesh_parts(
    surface: ObjectHandle, known: RawMesh | None = None, *, shaded: bool = True, cut: bool = True
) -> Parts:
    """Read a mesh in parts.

    Reads its normals if they matter, Blender's triangles of polygons with many corners, and the
    polygons unless they equal those of a known mesh.
    """
    obj = surface.get()
    with evaluated_mesh(obj, evaluated()) as mesh:
        positions = np.empty((len(mesh.vertices), 3), dtype=np.float32)
        if len(positions):
            mesh.attributes["position"].data.foreach_get("vector", positions.ravel())
        corners, count = corner_vertices(mesh), len(mesh.polygons)
        matrix = matrix_of(obj.evaluated_get(evaluated()))
        has_own = shaded and has_corner_normals(mesh, matrix)
    fluid, time = is_fluid(obj), time_of(bpy.context.scene)
    normals = (yield from _normals(surface, len(corners))) if has_own else None
    if known is not None and len(known.starts) == count:
        found = RawMesh(
            surface.name, positions, corners, known.starts, known.cut, matrix, fluid, normals, time
        )
        if found.same_faces(known):
            return found
    yield PAUSE
    starts = _starts(surface, len(corners), count)
    triangles = None
    if cut and np.max(np.diff(np.append(starts, len(corners))), initial=3) > 4:
        yield PAUSE
        triangles = _cut(surface, len(corners))
    return RawMesh(
        surface.name, positions, corners, starts, triangles, matrix, fluid, normals, time
    )


def _normals(surface: ObjectHandle, corner_count: int) -> Parts:
    """Shading normals of the corners or the polygons."""
    yield PAUSE
    with evaluated_mesh(surface.get(), evaluated()) as mesh:
        _check_count(surface, len(mesh.loops), corner_count)
        return shading_normals(mesh)


def _starts(surface: ObjectHandle, corner_count: int, count: int) -> Any:
    if corner_count == 3 * count:  # all are triangles
        return np.arange(0, corner_count, 3, dtype=np.int32)
    with evaluated_mesh(surface.get(), evaluated()) as mesh:
        _check_count(surface, len(mesh.polygons), count)
        return polygon_starts(mesh)


def _cut(surface: ObjectHandle, corner_count: int) -> Any:
    """Blender's own triangulation, if there are polygons with more than four corners."""
    with evaluated_mesh(surface.get(), evaluated()) as mesh:
        _check_count(surface, len(mesh.loops), corner_count)
        mesh.calc_loop_triangles()
        cut = np.empty(3 * len(mesh.loop_triangles), dtype=np.int32)
        mesh.loop_triangles.foreach_get("loops", cut)
    return cut.reshape(-1, 3)


def value_parts(surface: ObjectHandle, known: RawMesh, name: str) -> Parts:
    """Read an attribute or a vertex group."""
    yield PAUSE
    obj = surface.get()
    with evaluated_mesh(obj, evaluated()) as mesh:
        _check_count(surface, len(mesh.vertices), len(known.positions))
        _check_count(surface, len(mesh.loops), len(known.corners))
        found = raw_values(obj, mesh, name)
    if found is None:
        found = RawValues(name, "POINT", group_weights(obj, name))
    return found


def material_values(surface: ObjectHandle, known: RawMesh, names: Collection[str]) -> RawValues:
    """Read which faces have one of these materials."""
    with evaluated_mesh(surface.get(), evaluated()) as mesh:
        _check_count(surface, len(mesh.polygons), len(known.starts))
        return read_materials(surface.get(), mesh, names)


def marked_values(surface: ObjectHandle, known: RawMesh, marks: Collection[str]) -> RawValues:
    """Read which edges have one of these marks."""
    with evaluated_mesh(surface.get(), evaluated()) as mesh:
        _check_count(surface, len(mesh.loops), len(known.corners))
        return read_marked(surface.get(), mesh, marks)


def read_uv(surface: ObjectHandle, known: RawMesh, name: str) -> Any:
    """Read a UV map: (c, 2) of the corners."""
    with evaluated_mesh(surface.get(), evaluated()) as mesh:
        _check_count(surface, len(mesh.loops), len(known.corners))
        places = np.empty((len(known.corners), 2), dtype=np.float32)
        uv_layer(surface.get(), mesh, name).uv.foreach_get("vector", places.ravel())
    return places


def uv_layer(obj: bpy.types.Object, mesh: bpy.types.Mesh, name: str) -> bpy.types.MeshUVLoopLayer:
    """The UV map with this name in an object's evaluated mesh; by default the one for renders."""
    layers = mesh.uv_layers
    layer = layers.get(name) if name else next((one for one in layers if one.active_render), None)
    if layer is None:
        wanted = f"no UV map '{name}'" if name else "no UV map, which an image needs"
        raise ScatterError(f"Surface '{obj.name}' has {wanted}")
    return layer


def _check_count(surface: ObjectHandle, count: int, known: int) -> None:
    if count != known:
        raise ScatterError(f"Surface '{surface.name}' changed while it was read")


def read_mesh(obj: bpy.types.Object) -> SurfaceArrays:
    """The current surface, without values."""
    return surface_of_raw(run_now(mesh_parts(ObjectHandle(obj))))


def read_outline(obj: bpy.types.Object) -> SurfaceArrays:
    """The same without triangles, which take most of the time."""
    return outline_of_raw(run_now(mesh_parts(ObjectHandle(obj), shaded=False, cut=False)))


def evaluated() -> bpy.types.Depsgraph:
    """The evaluated depsgraph of the current scene."""
    return bpy.context.evaluated_depsgraph_get()
