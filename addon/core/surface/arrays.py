# SPDX-License-Identifier: GPL-3.0-or-later
"""A surface as arrays in world space, and what identifies it."""

import hashlib
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.errors import ChangedError, ScatterError

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
REATTACH = (
    "Set New Topology to Reattach to continue from the nearest places, "
    "or Attach To to Rest Position"
)
_SHEAR = 1e-5  # of squared lengths and dot products, as in nodes/surface.py


@dataclass(frozen=True)
class Surroundings:
    """The inputs of a density besides the surface, in the frame in which it is computed."""

    uv: Floats | None = None  # (m, 3, 2) texture coordinates of the faces' corners
    image: Floats | None = None  # (rows, columns) >= 0, row 0 at v = 0
    tiles: tuple[tuple[int, Floats], ...] = ()  # UDIM tiles by number, instead
    camera: Floats | None = None  # (4, 4) world space to clip space
    obstacles: tuple[tuple[Floats, Ints], ...] = ()  # vertices, faces of meshes in world space
    hiding: tuple[tuple[Floats, Ints], ...] = ()  # meshes behind which the camera sees nothing
    points: Floats = field(default_factory=lambda: np.empty((0, 3)))  # of other scatters
    radii: Floats = field(default_factory=lambda: np.empty(0))  # (k,) distances to keep from them
    hulls: Floats = field(default_factory=lambda: np.empty((0, 3)))  # corners of convex shapes
    hull_counts: Ints = field(default_factory=lambda: np.empty(0, np.int32))  # (h,) of each shape
    # Meshes and segments (s, 2, 3) that a distance is measured to; a point is a segment too.
    targets: tuple[tuple[Floats, Ints], ...] = ()
    lines: Floats = field(default_factory=lambda: np.empty((0, 2, 3)))

    def arrays(self) -> list[NDArray[Any]]:
        """All arrays, for digests."""
        meshes = [
            array for mesh in (*self.obstacles, *self.hiding, *self.targets) for array in mesh
        ]
        single: list[NDArray[Any] | None] = [self.uv, self.image, self.camera]
        single += [self.points, self.radii, self.lines, self.hulls, self.hull_counts]
        for number, picture in self.tiles:
            single += [np.array([number]), picture]
        return [array for array in (*single, *meshes) if array is not None]


@dataclass(frozen=True)
class SurfaceArrays:
    """One frame of a surface object."""

    name: str  # of the object, for messages
    vertices: Floats  # (v, 3) in world space
    faces: Ints  # (m, 3), triangulated as of this frame
    topology: str  # digest of the polygons' corners; independent of how quads are cut
    matrix: Floats = field(default_factory=lambda: np.eye(4))  # (4, 4) own space to world space
    # Values by name: (v,) of the vertices, (m, 1) of the faces or (m, 3) of the faces' corners.
    weights: dict[str, Floats] = field(default_factory=dict)
    around: Surroundings = field(default_factory=Surroundings)
    rest: Floats | None = None  # (v, 3) the vertices on the rest shape, if points are bound to it
    # Face corners (m, 3) of the mesh at the corners of the triangles; None: 0, 1, 2 and so on.
    loops: Ints | None = None
    # Shading normals (c, 3) of the mesh's face corners in world space, where there are flat faces,
    # sharp edges or custom normals; None: those of the vertices, smooth everywhere. They are always
    # there where the object is sheared or scaled by several factors, with lengths to interpolate.
    normals: Floats | None = None
    rest_parts: int = 1  # number of equal ranges of faces that may overlap there: rest.py
    time: float = 0.0  # frame of the animation, with its fraction
    # Vertices (v, 3) on other frames of a bake, on which places have to be seen from outside too.
    poses: tuple[Floats, ...] = ()
    # Digests of values that do not belong to vertices; independent of how quads are cut.
    digests: dict[str, str] = field(default_factory=dict)

    @cached_property
    def face_corners(self) -> Ints:
        """Face corners (m, 3) of the mesh at the corners of the triangles."""
        if self.loops is not None:
            return self.loops
        return np.arange(self.faces.size, dtype=np.int32).reshape(-1, 3)

    @property
    def parts(self) -> Ints:
        """Part (m,) of the rest shape that each face is in."""
        count = len(self.faces)
        found = np.arange(count, dtype=np.int64) * self.rest_parts // max(count, 1)
        return found.astype(np.int32)

    @cached_property
    def fingerprint(self) -> str:
        """Digest of topology, positions, normals, weights and surroundings."""
        digest = hashlib.blake2b(self.topology.encode(), digest_size=16)
        digest.update(self.vertices.tobytes())
        if self.normals is not None:
            digest.update(self.normals.tobytes())
        for name, values in self.weights.items():
            digest.update(name.encode())
            digest.update(values.tobytes())
        for array in self.around.arrays():
            digest.update(array.tobytes())
        return digest.hexdigest()


def is_sheared(matrix: Floats) -> bool:
    """Whether an object's space is sheared, mirrored or scaled by different factors."""
    axes = matrix[:3, :3]
    products = axes.T @ axes
    size = products[0, 0]
    off = np.abs(products - size * np.eye(3)).max()
    return bool(off > _SHEAR * size or np.linalg.det(axes) < 0.0)


def turn_of(matrix: Floats) -> Floats:
    """The axes of an object (3, 3) as columns, without its scale."""
    left, _, right = np.linalg.svd(matrix[:3, :3])
    found: Floats = left @ right
    return found


def topology_digest(vertex_count: int, corners: Ints, starts: Ints) -> str:
    """Digest of a polygon mesh without its positions."""
    digest = hashlib.blake2b(str(vertex_count).encode(), digest_size=16)
    digest.update(corners.tobytes())
    digest.update(starts.tobytes())
    return digest.hexdigest()


def normals_of(corners: Floats) -> Floats:
    """Unit normals (n, 3) of triangles (n, 3, 3); 0 without an area."""
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(across, axis=1, keepdims=True)
    found: Floats = across / np.where(lengths > 0.0, lengths, 1.0)
    return found


def check_same_topology(
    first: SurfaceArrays, later: SurfaceArrays, when: str, remedy: str = REATTACH
) -> None:
    """ScatterError unless both frames have the same polygons; `remedy` is the advice in it."""
    if first.topology == later.topology:
        return
    before, after = len(first.vertices), len(later.vertices)
    detail = f"{after} vertices, was {before}" if before != after else "other faces"
    raise ScatterError(
        f"Surface '{first.name}' changes its topology at {when} ({detail}): "
        f"points can only be carried over frames with the same faces. {remedy}"
    )


def is_reordered(one: SurfaceArrays, other: SurfaceArrays) -> bool:
    """Whether two surfaces have the same number of vertices and faces, at the same places."""
    if one.vertices.shape != other.vertices.shape or one.faces.shape != other.faces.shape:
        return False
    extent = float(np.abs(one.vertices).max(initial=0.0))
    apart = np.abs(np.sort(one.vertices, axis=0) - np.sort(other.vertices, axis=0))
    return bool(apart.max(initial=0.0) <= _SHEAR * extent)


def check_unchanged(read: SurfaceArrays, now: SurfaceArrays) -> None:
    """ChangedError unless the current surface is the one that was read."""
    if read.fingerprint != now.fingerprint:
        raise ChangedError(
            f"Surface '{read.name}' changed while it was being optimized: nothing was written"
        )
