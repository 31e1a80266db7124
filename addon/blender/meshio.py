# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes <-> numpy arrays, in bulk."""

import hashlib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ..core.errors import ScatterError
from ..core.records import Columns
from ..core.surface import Floats, SurfaceArrays, topology_digest
from .corners import corner_vertices, triangles
from .scatter import is_fluid
from .weights import read_weights

_NUMPY = {"INT": np.int32, "FLOAT": np.float32, "FLOAT_VECTOR": np.float32, "BOOLEAN": np.bool_}
_WIDTH = {"INT": 1, "FLOAT": 1, "FLOAT_VECTOR": 3, "BOOLEAN": 1}
_FIELD = {"INT": "value", "FLOAT": "value", "FLOAT_VECTOR": "vector", "BOOLEAN": "value"}


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
    cut: bool = True,
) -> SurfaceArrays:
    """The evaluated surface in world space, with values of its vertices by name.

    Triangulated, which takes most of the time, or without faces.
    """
    with evaluated_mesh(obj, depsgraph) as mesh:
        matrix = _matrix(obj.evaluated_get(depsgraph))
        vertices = _vertices(mesh) @ matrix[:3, :3].T + matrix[:3, 3]
        faces = triangles(mesh) if cut else np.empty((0, 3), dtype=np.int32)
        if np.linalg.det(matrix[:3, :3]) < 0.0:  # a mirrored surface still faces outwards
            faces = faces[:, ::-1]
        return SurfaceArrays(
            obj.name,
            np.ascontiguousarray(vertices),
            np.ascontiguousarray(faces),
            _fluid_topology(mesh) if is_fluid(obj) else topology(mesh),
            matrix,
            {name: read_weights(obj, mesh, name) for name in names},
            time=float(depsgraph.scene.frame_current_final),
        )


def read_rest(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> Floats:
    """Rest positions (v, 3) of the evaluated surface's vertices; ScatterError if they are lost."""
    with evaluated_mesh(obj, depsgraph) as mesh:
        if "rest_position" not in mesh.attributes:
            raise ScatterError(
                f"Surface '{obj.name}': its modifiers make a mesh without rest positions: use "
                "Match Subdivision and set Attach To to Faces, or apply them"
            )
        return _column(mesh, "rest_position", "FLOAT_VECTOR").astype(np.float64)


def topology(mesh: bpy.types.Mesh) -> str:
    """Digest of a mesh's polygons."""
    starts = np.empty(len(mesh.polygons), dtype=np.int32)
    mesh.polygons.foreach_get("loop_start", starts)
    return topology_digest(len(mesh.vertices), corner_vertices(mesh), starts)


def _fluid_topology(mesh: bpy.types.Mesh) -> str:
    """Digest of polygons and places, where a face is the same only as long as nothing moves."""
    digest = hashlib.blake2b(topology(mesh).encode(), digest_size=16)
    digest.update(_vertices(mesh).tobytes())
    return digest.hexdigest()


def _matrix(obj: bpy.types.Object) -> Floats:
    return np.array(obj.matrix_world, dtype=np.float64)


def _vertices(mesh: bpy.types.Mesh) -> Floats:
    positions = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    if len(positions) > 0:
        mesh.attributes["position"].data.foreach_get("vector", positions)
    return positions.reshape(-1, 3).astype(np.float64)


def write_points(mesh: bpy.types.Mesh, positions: Floats) -> None:
    """Make the mesh these points and nothing else."""
    mesh.clear_geometry()
    mesh.vertices.add(len(positions))
    mesh.vertices.foreach_set("co", np.asarray(positions, dtype=np.float32).ravel())
    mesh.update()


def read_points(mesh: bpy.types.Mesh) -> Floats:
    """Positions (n, 3) of the points of a mesh, in its own space."""
    return _vertices(mesh)


def write_columns(mesh: bpy.types.Mesh, columns: Columns, types: dict[str, str]) -> None:
    """Store columns as attributes on the points of a mesh."""
    for name, kind in types.items():
        attribute = own_attribute(mesh, name, kind)
        values: NDArray[Any] = np.ascontiguousarray(columns[name], dtype=_NUMPY[kind])
        attribute.data.foreach_set(_FIELD[kind], values.ravel())


def own_attribute(mesh: bpy.types.Mesh, name: str, kind: str) -> bpy.types.Attribute:
    """The attribute of that name on the points of a mesh; one of another kind makes room."""
    attribute = mesh.attributes.get(name)
    if attribute is not None and (attribute.data_type != kind or attribute.domain != "POINT"):
        mesh.attributes.remove(attribute)
        attribute = None
    return attribute or mesh.attributes.new(name, kind, "POINT")


def read_columns(mesh: bpy.types.Mesh, types: dict[str, str]) -> Columns:
    """Attributes on the points of a mesh as columns."""
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
    attribute.data.foreach_get(_FIELD[kind], values)
    return values.reshape(-1, 3) if _WIDTH[kind] == 3 else values


def to_local(obj: bpy.types.Object, positions: Floats) -> Floats:
    """World space -> the object's own space; ScatterError if that is flat."""
    try:
        inverse = np.linalg.inv(_matrix(obj))
    except np.linalg.LinAlgError:
        raise ScatterError(f"'{obj.name}' has a scale of 0: give it another one") from None
    return positions @ inverse[:3, :3].T + inverse[:3, 3]


def to_world(obj: bpy.types.Object, positions: Floats) -> Floats:
    """The object's own space -> world space."""
    matrix = _matrix(obj)
    return positions @ matrix[:3, :3].T + matrix[:3, 3]
