# SPDX-License-Identifier: GPL-3.0-or-later
"""The evaluated mesh of a surface, its faces and its rest positions."""

from collections.abc import Iterator
from contextlib import contextmanager

import bpy
import numpy as np

from ...core.base.errors import ScatterError
from ...core.surface.arrays import Floats, topology_digest
from ..base.mesh_arrays import (
    corner_vertices,
    polygon_starts,
    read_columns,
)
from .joined import parts_of


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
