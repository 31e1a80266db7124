# SPDX-License-Identifier: GPL-3.0-or-later
"""Which instances overlap, by their bounding boxes or convex hulls."""

from collections.abc import Iterator
from dataclasses import dataclass

import bmesh
import bpy
import numpy as np
from mathutils.bvhtree import BVHTree

from ...core.base.errors import ScatterError
from ...core.export import Placed
from ...core.surface.arrays import Floats, Ints
from ..base.mesh_arrays import read_points
from ..scatter.shown_instances import Collector, as_rendered

_SHRUNK = 1e-5  # of an instance's size: those that only touch do not overlap
_CHUNK = 1_000_000  # pairs that are looked at together
BOX_CORNERS = np.array(
    [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=np.float64
)
_SIDES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
BOX_FACES = np.array([(a, *rest) for a, b, c, d in _SIDES for rest in ((b, c), (c, d))])


@dataclass(frozen=True)
class Shape:
    """A convex polyhedron around an instanced mesh; triangles are counterclockwise from outside."""

    vertices: Floats  # (v, 3)
    faces: Ints  # (f, 3)


def overlapping_ids(scatter: bpy.types.Object, shape: str) -> tuple[set[int], int]:
    """Ids of the points whose instances overlap those of other points on the current frame, and
    the number of all points with instances. The shape is BOX or HULL.

    Raises:
        ScatterError: the scatter shows no instances.
    """
    collector = Collector([scatter])
    with as_rendered([scatter]):
        try:
            collector.read()
            collector.check()
            around = box_around if shape == "BOX" else hull_around
            shapes = [around(mesh) for mesh in collector.meshes[0]]
        finally:
            collector.free()
    (frame,) = collector.exported[0].frames
    if not np.isfinite(frame.matrices).all():
        raise ScatterError(f"Scatter '{scatter.name}' has instances that are nowhere")
    rows = {int(row) for pair in overlapping_pairs(frame, shapes) for row in pair}
    return {int(frame.ids[row]) for row in rows}, len(np.unique(frame.ids))


def box_around(mesh: bpy.types.Mesh) -> Shape | None:
    """The bounding box in the mesh's own space; None without vertices."""
    points = read_points(mesh)
    if not len(points):
        return None
    low, high = points.min(axis=0), points.max(axis=0)
    return Shape(low + BOX_CORNERS * (high - low), BOX_FACES)


def hull_around(mesh: bpy.types.Mesh) -> Shape | None:
    """The convex hull; the bounding box of a flat mesh, None without vertices."""
    box = box_around(mesh)
    if box is None or np.ptp(box.vertices, axis=0).min() == 0.0:
        return box
    hull = bmesh.new()
    try:
        hull.from_mesh(mesh)
        made = bmesh.ops.convex_hull(hull, input=hull.verts, use_existing_faces=False)["geom"]
        faces = [one for one in made if isinstance(one, bmesh.types.BMFace)]
        bmesh.ops.recalc_face_normals(hull, faces=faces)
        found = [[vertex.index for vertex in face.verts] for face in faces]
        places = np.array([vertex.co for vertex in hull.verts], dtype=np.float64)
    finally:
        hull.free()
    if not found:
        return box
    used, faces_of_used = np.unique(np.array(found), return_inverse=True)
    return Shape(places[used], faces_of_used.reshape(-1, 3).astype(np.int32))


def overlapping_pairs(frame: Placed, shapes: list[Shape | None]) -> Iterator[tuple[int, int]]:
    """Rows of instances of two points that overlap."""
    solids: dict[int, _Solid] = {}
    places = [_placed(frame, shapes, row) for row in range(len(frame.ids))]
    rows = np.array([row for row, place in enumerate(places) if place is not None], dtype=np.int64)
    if not len(rows):
        return
    low = np.array([places[row].min(axis=0) for row in rows])
    high = np.array([places[row].max(axis=0) for row in rows])
    for first, second in near_pairs(low, high):
        for one, other in zip(rows[first].tolist(), rows[second].tolist(), strict=True):
            if frame.ids[one] == frame.ids[other]:
                continue
            for row in (one, other):
                if row not in solids:
                    solids[row] = _Solid.of(places[row], shapes[frame.prototypes[row]].faces)
            if solids[one].meets(solids[other]):
                yield one, other


def _placed(frame: Placed, shapes: list[Shape | None], row: int) -> Floats | None:
    """The vertices of an instance's shape in world space, a little toward their middle."""
    shape, matrix = shapes[frame.prototypes[row]], frame.matrices[row]
    if shape is None:
        return None
    vertices = shape.vertices @ matrix[:3, :3].T + matrix[:3, 3]
    middle = (vertices.min(axis=0) + vertices.max(axis=0)) / 2.0
    found: Floats = middle + (1.0 - _SHRUNK) * (vertices - middle)
    return found


def near_pairs(low: Floats, high: Floats) -> Iterator[tuple[Ints, Ints]]:
    """Pairs of boxes (n, 3) along the axes that meet: sorted along x, where each is followed by
    those that begin before it ends.
    """
    order = np.argsort(low[:, 0], kind="stable")
    low, high = low[order], high[order]
    ends = np.searchsorted(low[:, 0], high[:, 0], side="right")
    counts = np.maximum(ends - np.arange(len(low)) - 1, 0)
    sums = np.concatenate([[0], np.cumsum(counts)])
    begin = 0
    while begin < len(low):
        end = max(int(np.searchsorted(sums, sums[begin] + _CHUNK, side="right")) - 1, begin + 1)
        first = np.repeat(np.arange(begin, end), counts[begin:end])
        second = first + 1 + np.arange(len(first)) - (sums[first] - sums[begin])
        meet = ((low[first] <= high[second]) & (low[second] <= high[first])).all(axis=1)
        yield order[first[meet]], order[second[meet]]
        begin = end


@dataclass(frozen=True)
class _Solid:
    """A convex body in world space."""

    vertices: Floats
    tree: BVHTree
    normals: Floats  # (f, 3) outward, of any length
    heights: Floats  # (f,) of the faces along them

    @classmethod
    def of(cls, vertices: Floats, faces: Ints) -> "_Solid":
        corners = vertices[faces]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        heights = np.einsum("fk,fk->f", normals, corners[:, 0])
        middle = vertices.mean(axis=0)
        inward = normals @ middle > heights  # of a mirrored instance
        normals, heights = (
            np.where(inward[:, None], -normals, normals),
            np.where(inward, -heights, heights),
        )
        tree = BVHTree.FromPolygons(vertices.tolist(), faces.tolist(), all_triangles=True)
        return cls(vertices, tree, normals, heights)

    def meets(self, other: "_Solid") -> bool:
        """Whether the surfaces cut each other, or one body is inside the other."""
        inside = self._holds(other.vertices[0]) or other._holds(self.vertices[0])
        return inside or bool(self.tree.overlap(other.tree))

    def _holds(self, place: Floats) -> bool:
        return bool((self.normals @ place < self.heights).all())
