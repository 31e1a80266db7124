# SPDX-License-Identifier: GPL-3.0-or-later
"""Bounding boxes and convex hulls of instances, as renders show them."""

import hashlib
from dataclasses import dataclass

import bmesh
import bpy
import numpy as np

from ...core.base.errors import ScatterError
from ...core.export import LongInts, Placed
from ...core.surface.arrays import Floats, Ints
from ..base.mesh_arrays import read_points
from .shown_instances import Collector, as_rendered

BOX_CORNERS = np.array(
    [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=np.float64
)
_MOST_KNOWN = 64
_known: dict[bytes, Floats] = {}  # corners of hulls, by a digest of the vertices


@dataclass(frozen=True)
class InstanceShapes:
    """The convex shapes of instances in world space, each by its corners."""

    ids: LongInts  # (s,) of the points
    points: Floats  # (p, 3) corners, those of all shapes one after the other
    counts: Ints  # (s,) number of corners of each

    @property
    def starts(self) -> LongInts:
        """The first corner (s,) of each."""
        found: LongInts = np.concatenate([[0], np.cumsum(self.counts, dtype=np.int64)])[:-1]
        return found

    def shrunk(self, share: float) -> "InstanceShapes":
        """The same, smaller by this share of their size."""
        if not len(self.counts):
            return self
        ends = [of.reduceat(self.points, self.starts, axis=0) for of in (np.minimum, np.maximum)]
        middles = np.repeat((ends[0] + ends[1]) / 2.0, self.counts, axis=0)
        points = middles + (1.0 - share) * (self.points - middles)
        return InstanceShapes(self.ids, points, self.counts)


def shapes_of(scatter: bpy.types.Object, shape: str) -> tuple[InstanceShapes, LongInts]:
    """Shapes of the instances of a scatter on the current frame, BOX or HULL, and the ids (k,) of
    all points that show meshes. Instances without a size have no shape.

    Raises:
        ScatterError: there are instances at places that are not finite.
    """
    collector = Collector([scatter], lambda obj, _: _corners(obj.data, shape))
    with as_rendered([scatter]):
        collector.read()
    (frame,) = collector.exported[0].frames
    if not np.isfinite(frame.matrices).all():
        raise ScatterError(f"Scatter '{scatter.name}' has instances that are nowhere")
    return placed_shapes(frame, collector.meshes[0]), np.unique(frame.ids)


def placed_shapes(frame: Placed, corners: list[Floats]) -> InstanceShapes:
    """Shapes of instances from the corners (k, 3) of each instanced mesh."""
    ids, points, counts = [np.empty(0, np.int64)], [np.empty((0, 3))], [np.empty(0, np.int32)]
    for prototype, own in enumerate(corners):
        rows = np.flatnonzero(frame.prototypes == prototype)
        matrices = frame.matrices[rows]
        rows, matrices = (
            one[np.abs(matrices[:, :3, :3]).max(axis=(1, 2)) > 0.0] for one in (rows, matrices)
        )
        if len(own) and len(rows):
            placed = own @ matrices[:, :3, :3].transpose(0, 2, 1) + matrices[:, None, :3, 3]
            ids.append(frame.ids[rows])
            points.append(placed.reshape(-1, 3))
            counts.append(np.full(len(rows), len(own), dtype=np.int32))
    return InstanceShapes(np.concatenate(ids), np.concatenate(points), np.concatenate(counts))


def _corners(mesh: bpy.types.Mesh, shape: str) -> Floats:
    """Corners (k, 3) of the shape in the mesh's own space; none without vertices."""
    points = read_points(mesh)
    if len(points) and not np.isfinite(points).all():
        raise ScatterError(f"Instance '{mesh.name}' has vertices that are not finite")
    if shape == "BOX" and len(points):
        low, high = points.min(axis=0), points.max(axis=0)
        return low + BOX_CORNERS * (high - low)
    return hull_corners(points)


def hull_corners(points: Floats) -> Floats:
    """The points (n, 3) that are corners of their convex hull; flat ones may keep others too."""
    points = np.unique(points, axis=0)
    if len(points) <= len(BOX_CORNERS):
        return points
    digest = hashlib.blake2b(points.tobytes(), digest_size=16).digest()
    if digest not in _known:
        while len(_known) >= _MOST_KNOWN:
            del _known[next(iter(_known))]
        _known[digest] = _on_hull(points)
    return _known[digest]


def _on_hull(points: Floats) -> Floats:
    hull = bmesh.new()
    try:
        vertices = [hull.verts.new(place) for place in points.tolist()]
        made = bmesh.ops.convex_hull(hull, input=vertices, use_existing_faces=False)["geom"]
        faces = [one for one in made if isinstance(one, bmesh.types.BMFace)]
        hull.verts.index_update()
        used = sorted({vertex.index for face in faces for vertex in face.verts})
    finally:
        hull.free()
    return points[used] if used and np.ptp(points, axis=0).min() > 0.0 else points
