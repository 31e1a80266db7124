# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading what a distance is measured to and has no faces: curves, points, origins."""

import bpy
import numpy as np

from ...core.bake.keys import Baked
from ...core.base.errors import ScatterError
from ...core.surface.arrays import Floats
from ...core.surface.records import check_columns
from ..base.mesh_arrays import matrix_of, read_points, to_world
from ..scatter.object import is_scatter
from .played import points_now

_MESHES = {"MESH", "CURVE", "SURFACE", "META", "FONT"}


def read_lines(
    obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, known: dict[int, Baked] | None = None
) -> Floats | None:
    """Segments (k, 2, 3) in world space, or points as segments; None: the object has faces.

    A curve without bevel is its line, a scatter its points, a mesh without faces its edges or its
    vertices. What has no shape is a point at its origin.
    """
    evaluated = obj.evaluated_get(depsgraph)
    found: Floats | None
    if is_scatter(obj):
        places, there = points_now(obj, {} if known is None else known)
        found = _points(places[there])
    elif obj.type in _MESHES:
        found = _of_mesh(evaluated)
    elif obj.type == "CURVES":
        found = _of_strands(evaluated)
    else:
        found = _points(matrix_of(evaluated)[None, :3, 3])
    if found is not None:
        check_columns({"position": found.reshape(-1, 3)}, obj.name)
    return found


def _of_mesh(evaluated: bpy.types.Object) -> Floats | None:
    mesh = evaluated.to_mesh() if evaluated.is_evaluated else None
    if mesh is None:
        raise ScatterError(
            f"Object '{evaluated.name}', to which a distance is measured, is not evaluated: it "
            "must be in the view layer and not disabled"
        )
    try:
        if len(mesh.polygons):
            return None
        places = to_world(evaluated, read_points(mesh))
        edges = np.empty(2 * len(mesh.edges), dtype=np.int32)
        mesh.edges.foreach_get("vertices", edges)
    finally:
        evaluated.to_mesh_clear()
    loose = np.ones(len(places), dtype=bool)
    loose[edges] = False
    return np.concatenate([places[edges.reshape(-1, 2)], _points(places[loose])])


def _of_strands(evaluated: bpy.types.Object) -> Floats:
    """Lines through the control points of strands, such as hair."""
    curves = evaluated.data.curves
    if not len(curves):
        return np.empty((0, 2, 3))
    lengths = np.empty(len(curves), dtype=np.int32)
    curves.foreach_get("points_length", lengths)
    stored = np.empty(3 * int(lengths.sum()), dtype=np.float32)
    evaluated.data.attributes["position"].data.foreach_get("vector", stored)
    places = to_world(evaluated, stored.reshape(-1, 3).astype(np.float64))
    inner = np.ones(len(places), dtype=bool)
    inner[np.cumsum(lengths) - 1] = False  # the last of each
    first = np.flatnonzero(inner)
    return np.stack([places[first], places[first + 1]], axis=1)


def _points(places: Floats) -> Floats:
    """Points (k, 3) as segments."""
    return np.repeat(places[:, None], 2, axis=1)
