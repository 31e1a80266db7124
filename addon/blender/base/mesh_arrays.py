# SPDX-License-Identifier: GPL-3.0-or-later
"""Points, attributes and face corners of meshes as numpy arrays."""

from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ...core.base.errors import ScatterError
from ...core.surface.arrays import Floats, Ints, is_sheared
from ...core.surface.mesh_snapshot import Singles
from ...core.surface.records import Columns

_NUMPY = {"INT": np.int32, "FLOAT": np.float32, "FLOAT_VECTOR": np.float32, "BOOLEAN": np.bool_}
_WIDTH = {"INT": 1, "FLOAT": 1, "FLOAT_VECTOR": 3, "BOOLEAN": 1}
_FIELD = {"INT": "value", "FLOAT": "value", "FLOAT_VECTOR": "vector", "BOOLEAN": "value"}


def matrix_of(obj: bpy.types.Object) -> Floats:
    """Matrix (4, 4) from the object's own space to world space."""
    return np.array(obj.matrix_world, dtype=np.float64)


def write_points(mesh: bpy.types.Mesh, positions: Floats) -> None:
    """Replace the geometry of a mesh by points."""
    mesh.clear_geometry()
    mesh.vertices.add(len(positions))
    mesh.vertices.foreach_set("co", np.asarray(positions, dtype=np.float32).ravel())
    mesh.update()


def read_points(mesh: bpy.types.Mesh) -> Floats:
    """Positions (n, 3) of the points of a mesh, in its own space; ScatterError in Edit Mode."""
    positions = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    if len(positions) > 0:
        _values(mesh, mesh.attributes.get("position")).foreach_get("vector", positions)
    return positions.reshape(-1, 3).astype(np.float64)


def write_columns(mesh: bpy.types.Mesh, columns: Columns, types: dict[str, str]) -> None:
    """Store columns as attributes on the points of a mesh."""
    for name, kind in types.items():
        attribute = own_attribute(mesh, name, kind)
        values: NDArray[Any] = np.ascontiguousarray(columns[name], dtype=_NUMPY[kind])
        attribute.data.foreach_set(_FIELD[kind], values.ravel())


def own_attribute(mesh: bpy.types.Mesh, name: str, kind: str) -> bpy.types.Attribute:
    """The attribute of that name on the points of a mesh; one of another type is replaced."""
    attribute = mesh.attributes.get(name)
    if attribute is not None and (attribute.data_type != kind or attribute.domain != "POINT"):
        mesh.attributes.remove(attribute)
        attribute = None
    return attribute or mesh.attributes.new(name, kind, "POINT")


def read_columns(mesh: bpy.types.Mesh, types: dict[str, str]) -> Columns:
    """Attributes on the points of a mesh as columns; ScatterError in Edit Mode."""
    return {name: _column(mesh, name, kind) for name, kind in types.items()}


def _column(mesh: bpy.types.Mesh, name: str, kind: str) -> np.ndarray:
    attribute = mesh.attributes.get(name)
    if attribute is None:
        raise ScatterError(f"Mesh '{mesh.name}' has no {kind} attribute '{name}' on its points")
    if attribute.data_type != kind or attribute.domain != "POINT":
        raise ScatterError(
            f"Attribute '{name}' of '{mesh.name}' is {attribute.data_type} on {attribute.domain}, "
            f"it must be {kind} on POINT: remove it and optimize"
        )
    values: NDArray[Any] = np.empty(len(mesh.vertices) * _WIDTH[kind], dtype=_NUMPY[kind])
    _values(mesh, attribute).foreach_get(_FIELD[kind], values)
    return values.reshape(-1, 3) if _WIDTH[kind] == 3 else values


def _values(mesh: bpy.types.Mesh, attribute: bpy.types.Attribute | None) -> Any:
    """The values of an attribute on the points, of which Blender gives none in Edit Mode."""
    if attribute is None or len(attribute.data) != len(mesh.vertices):
        raise ScatterError(f"Mesh '{mesh.name}' is in Edit Mode: leave it first")
    return attribute.data


def to_local(obj: bpy.types.Object, positions: Floats) -> Floats:
    """Positions in the object's own space; ScatterError if its scale is 0."""
    return in_space(matrix_of(obj), positions, obj.name)


def in_space(matrix: Floats, positions: Floats, name: str) -> Floats:
    """Positions in the space of an object with that matrix; ScatterError if its scale is 0."""
    if not np.isfinite(matrix).all():
        raise ScatterError(f"'{name}' has a location or scale that is not finite")
    try:
        inverse = np.linalg.inv(matrix)
    except np.linalg.LinAlgError:
        inverse = np.full((4, 4), np.nan)
    found = positions @ inverse[:3, :3].T + inverse[:3, 3]
    if not (np.abs(found) <= np.finfo(np.float32).max).all():
        raise ScatterError(f"'{name}' has a scale of 0: set another one")
    return found


def to_world(obj: bpy.types.Object, positions: Floats) -> Floats:
    """Positions in world space."""
    matrix = matrix_of(obj)
    return positions @ matrix[:3, :3].T + matrix[:3, 3]


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
    """Corners (f, 3) of the triangles into which Blender splits the faces."""
    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    if count == len(mesh.polygons):  # every face is a triangle
        return np.arange(3 * count, dtype=np.int32).reshape(-1, 3)
    corners = np.empty(3 * count, dtype=np.int32)
    mesh.loop_triangles.foreach_get("loops", corners)
    return corners.reshape(-1, 3)


def has_corner_normals(mesh: bpy.types.Mesh, matrix: Floats) -> bool:
    """Whether the shading normals of a mesh differ from its vertex normals in world space."""
    return mesh.normals_domain != "POINT" or is_sheared(matrix)


def shading_normals(mesh: bpy.types.Mesh) -> Singles:
    """Unit normals (c, 3) of the corners, or (p, 3) of the faces if all of them are flat."""
    flat = mesh.normals_domain == "FACE"
    normals = mesh.polygon_normals if flat else mesh.corner_normals
    found = np.empty((len(normals), 3), dtype=np.float32)
    normals.foreach_get("vector", found.ravel())
    return found
