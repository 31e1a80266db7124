# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading an object as it is shown, with its modifiers, for a mesh that follows its animation."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import bpy
import numpy as np

from ...core.base.errors import ScatterError
from ...core.remesh import OldMesh
from ...core.surface.arrays import Floats, Ints
from ..base.mesh_arrays import (
    corner_vertices,
    matrix_of,
    polygon_starts,
    read_points,
    to_world,
    triangle_corners,
)
from ..base.object_handles import ObjectHandle
from ..base.times import show_time
from ..surface.mesh import evaluated_mesh
from ..surface.values import read_weights
from .density import Chosen, Images
from .reading import lines_of, placed_density


@dataclass(frozen=True)
class Shown:
    """The object on a frame."""

    vertices: Floats  # (v, 3) in world space
    corners: Ints  # (c,) the vertex of each corner of the polygons
    starts: Ints  # (p,) the first corner of each polygon
    matrix: Floats  # (4, 4) from the object's space to the world

    def has_faces_of(self, other: "Shown") -> bool:
        """Whether the polygons are the same."""
        same = len(self.vertices) == len(other.vertices)
        same = same and np.array_equal(self.corners, other.corners)
        return bool(same and np.array_equal(self.starts, other.starts))

    def is_like(self, other: "Shown") -> bool:
        """Whether the polygons and the places of their vertices are the same."""
        return self.has_faces_of(other) and np.array_equal(self.vertices, other.vertices)


@contextmanager
def shown_copy(obj: bpy.types.Object) -> Iterator[bpy.types.Mesh]:
    """The object's mesh with its modifiers as a mesh of the file, with all attributes and without
    shape keys.
    """
    graph = bpy.context.evaluated_depsgraph_get()
    evaluated = obj.evaluated_get(graph)
    mesh = bpy.data.meshes.new_from_object(
        evaluated, preserve_all_data_layers=True, depsgraph=graph
    )
    try:
        yield mesh
    finally:
        bpy.data.meshes.remove(mesh)


def read_first(
    handle: ObjectHandle, frame: int, chosen: Chosen, images: Images
) -> tuple[OldMesh, Shown]:
    """What is remeshed: the object as it is shown on a frame, with the density as in read_old()."""
    show_time(bpy.context.scene, frame)
    return read_now(handle.get(), chosen, images)


def read_now(obj: bpy.types.Object, chosen: Chosen, images: Images) -> tuple[OldMesh, Shown]:
    """The same on the current frame."""
    with evaluated_mesh(obj, bpy.context.evaluated_depsgraph_get()) as mesh:
        shown = _shown(obj, mesh)
        corners = triangle_corners(mesh) if len(mesh.polygons) else _NO_FACES
        weights = read_weights(obj, mesh, chosen.values) if chosen.values else None
        old = OldMesh(
            name=obj.name,
            vertices=shown.vertices,
            faces=shown.corners[corners] if len(corners) else _NO_FACES,
            lines=lines_of(mesh),
            density=placed_density(obj.name, mesh, weights) if weights is not None else None,
            picture=images.on(obj, mesh, corners) if len(corners) else None,
        )
        return old, shown


def check_faces(obj: bpy.types.Object, old: OldMesh) -> None:
    """ScatterError if a curve or metaball has no faces, with what to do."""
    if len(old.faces):
        return
    if obj.type == "CURVE":
        raise ScatterError(
            f"'{obj.name}' has no faces, it is a bare curve: give it a little Extrude or Bevel "
            "Depth below Geometry in its Data properties"
        )
    if obj.type == "META":
        raise ScatterError(
            f"'{obj.name}' has no faces: of metaballs with the same name before the dot, the "
            "surface belongs to the first one. Select that"
        )


def read_shown(obj: bpy.types.Object) -> Shown:
    """The object as it is shown on the current frame."""
    with evaluated_mesh(obj, bpy.context.evaluated_depsgraph_get()) as mesh:
        return _shown(obj, mesh)


def read_next(handle: ObjectHandle, frame: int, first: Shown, first_frame: int) -> Shown:
    """The object on another frame; ScatterError if it has other faces."""
    show_time(bpy.context.scene, frame)
    obj = handle.get()
    shown = read_shown(obj)
    if not shown.has_faces_of(first):
        raise ScatterError(
            f"'{obj.name}' has other faces in frame {frame} than in frame {first_frame}: shape "
            "keys need the same ones. Choose frames in which they stay, or Bake to Sequence"
        )
    return shown


def _shown(obj: bpy.types.Object, mesh: bpy.types.Mesh) -> Shown:
    return Shown(
        vertices=to_world(obj, read_points(mesh)),
        corners=corner_vertices(mesh),
        starts=polygon_starts(mesh),
        matrix=matrix_of(obj),
    )


_NO_FACES = np.empty((0, 3), np.int32)
