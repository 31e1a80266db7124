# SPDX-License-Identifier: GPL-3.0-or-later
"""Fields: factors of the density that know places and nothing of faces.

Each has its values at places, and the faces on which it changes: only these need to be cut.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._native import Surface, seen_from
from .arrays import Flags, Floats, Ints, longest_edges, shaped
from .nearest import Mesh, Nearest
from .noise import bend, noise
from .ranges import Range

INNER = 0.58  # largest distance of a place of a triangle from its corners, in longest edges
_COARSE = 0.25  # of the falloff: a face over which values differ by less needs no cut
_FAR = 1e-9  # relative distance at which an eye is at infinity
_SOFT = 2.0  # factor of the edge length at a sharp change that suffices for a falloff
_INWARD = 0.05  # share of the way from a corner of a face to its center
_ROUNDING = 2.5e-7  # relative, of coordinates in single precision


class Field:
    """A factor of the density at each place.

    coarseness: how much longer the edges of faces may be than at a sharp change.
    rides: whether the field belongs to the surface, and is looked up where that is at rest.
    blocks: whether faces that reach where the field is 0 are cut as `refine_obstacles` does it.
    bounds: whether places where the field is 0 have a border: `MaskedSurface.clear_borders`.
    """

    coarseness: float = 1.0
    rides: bool = False
    blocks: bool = False
    bounds: bool = True

    def values(self, points: Floats) -> Floats:
        """Factors (n,), >= 0, at points (n, 3)."""
        raise NotImplementedError

    def changes(self, points: Floats, faces: Ints) -> Flags:
        """Which faces (m, 3) of vertices (v, 3) may have places with several factors: (m,)."""
        raise NotImplementedError

    def at_corners(self, points: Floats, faces: Ints) -> Floats:
        """Factors (m, 3) at the corners of faces (m, 3) of vertices (v, 3)."""
        return self.values(points)[faces]

    def reach(self, points: Floats, faces: Ints) -> Flags:
        """Which faces (m, 3) of vertices (v, 3) reach where the field is 0: (m,)."""
        found: Flags = (self.values(points) == 0.0)[faces].any(axis=1)
        return found


class RangeField(Field):
    """A field by a range of a quantity, which a subclass computes."""

    def __init__(self, within: Range, rides: bool = False) -> None:
        self._within, self.rides = within, rides
        self.coarseness = _SOFT if within.falloff > 0.0 else 1.0
        self._known: tuple[Floats, Floats] = (np.empty((0, 3)), np.empty(0))

    def at(self, points: Floats) -> Floats:
        """The quantity (n,) at points (n, 3)."""
        raise NotImplementedError

    def beyond(self, longest: Floats) -> Floats:
        """How far the quantity in triangles with these longest edges (m,) may be from its values at
        the corners.
        """
        raise NotImplementedError

    def values(self, points: Floats) -> Floats:
        return self._within.factors(self._looked_up(points))

    def changes(self, points: Floats, faces: Ints) -> Flags:
        values = self._looked_up(points)[faces]
        beyond = self.beyond(longest_edges(points, faces))
        least, most = values.min(axis=1), values.max(axis=1)
        found: Flags = self._within.varies(least - beyond, most + beyond)
        found &= most - least + beyond > _COARSE * self._within.falloff
        return found

    def _looked_up(self, points: Floats) -> Floats:
        """The quantity at places of which many begin with those that were looked up last."""
        places, values = self._known
        count = len(places)
        if not np.array_equal(points[:count], places):
            count = 0
        if count < len(points):
            values = np.concatenate([values[:count], self.at(points[count:])])
            self._known = (points.copy(), values)
        return values[: len(points)]


class Distance(RangeField):
    """A field by the distance to meshes and segments; `border_edges` gives those of a border."""

    def __init__(self, within: Range, nearest: Nearest, *, rides: bool = False) -> None:
        super().__init__(within, rides)
        self._nearest = nearest

    def beyond(self, longest: Floats) -> Floats:
        return INNER * longest

    def at(self, points: Floats) -> Floats:
        return self._nearest.distances(points)


class Clearance(Distance):
    """1 at a distance from segments, 0 on all faces that reach nearer; it rides on the surface.

    The square of a distance minus |x|^2 is the smallest of linear functions, so it is concave. In a
    triangle with a longest edge h and corners at least as far as c, the squared distance is
    therefore at least c^2 - h^2 / 3.
    """

    def __init__(self, segments: Floats, distance: float) -> None:
        super().__init__(Range(low=distance), Nearest((), segments), rides=True)
        self._distance = distance

    def changes(self, points: Floats, faces: Ints) -> Flags:
        farthest = self._looked_up(points)[faces].max(axis=1)
        longest = longest_edges(points, faces)
        farthest += np.where(longest > 0.5 * self._distance, self.beyond(longest), 0.0)
        found: Flags = ~self._is_clear(points, faces) & (farthest >= self._distance)
        return found

    def at_corners(self, points: Floats, faces: Ints) -> Floats:
        clear = self._is_clear(points, faces).astype(np.float64)
        found: Floats = np.broadcast_to(clear[:, None], (len(faces), 3))
        return found

    def _is_clear(self, points: Floats, faces: Ints) -> Flags:
        nearest = self._looked_up(points)[faces].min(axis=1)
        found: Flags = nearest**2 >= self._distance**2 + longest_edges(points, faces) ** 2 / 3.0
        return found


class Noise(RangeField):
    """A field by a noise in patches, whose values are from 0 to 1 and spread evenly.

    Args:
        within: values of the noise with full density.
        size: > 0, of the patches, a length.
        detail: >= 0, how many finer noises are added, each of half the size and half the influence.
        seed: each gives other patches.
        origin: (3,), of the noise.
        axes: (3, 3), orthonormal axes of the noise as columns; None: those of space.
        rides: see `Field`.

    Raises:
        ValueError: naming the argument that is out of its range or has another shape.
    """

    def __init__(
        self,
        within: Range,
        *,
        size: float = 1.0,
        detail: int = 2,
        seed: int = 0,
        origin: ArrayLike = (0.0, 0.0, 0.0),
        axes: ArrayLike | None = None,
        rides: bool = False,
    ) -> None:
        super().__init__(within, rides)
        if not 0.0 < size < np.inf:
            raise ValueError(f"size is {size}: it must be finite and greater than 0")
        if detail < 0:
            raise ValueError(f"detail is {detail}: it must be at least 0")
        self._size, self._detail, self._seed = size, detail, seed
        self._origin = shaped("origin", origin, 3)
        self._axes = np.eye(3) if axes is None else shaped("axes", axes, 3, 3)

    def beyond(self, longest: Floats) -> Floats:
        return bend(longest / self._size, self._detail)

    def at(self, points: Floats) -> Floats:
        places = _along(points - self._origin, self._axes) / self._size
        return noise(places, self._detail, self._seed)


class Height(Field):
    """A field by a range of z.

    Args:
        within: heights with full density.
        largest: |z| of the surface. A sharp end counts as so much farther off as coordinates of
            that size are rounded in single precision: so a floor lies in a range that ends at it.
    """

    def __init__(self, within: Range, largest: float = 0.0) -> None:
        slack = _ROUNDING * largest if within.falloff <= 0.0 else 0.0
        self._within = replace(within, low=within.low - slack, high=within.high + slack)

    def values(self, points: Floats) -> Floats:
        return self._within.factors(points[:, 2])

    def changes(self, points: Floats, faces: Ints) -> Flags:
        z = points[:, 2][faces]
        return self._within.varies(z.min(axis=1), z.max(axis=1))

    def at_corners(self, points: Floats, faces: Ints) -> Floats:
        """Factors of a sharp end as they are inside of each face: the walls below a floor have
        none of what the floor has.
        """
        if self._within.falloff > 0.0:
            return self.values(points)[faces]
        corners = points[faces]
        inside = corners + _INWARD * (corners.mean(axis=1, keepdims=True) - corners)
        return self.values(inside.reshape(-1, 3)).reshape(-1, 3)


class Camera(Field):
    """1 in the view of a camera, 0 elsewhere.

    Without meshes, what hides a place does not count. With them the field is 0 on all faces of
    which a corner or the center is hidden.

    Args:
        clip: (4, 4), the matrix from space to the camera's clip space.
        margin: >= 0, how far the view extends beyond the frame, relative to half the frame.
        meshes: vertices (v, 3) and faces (m, 3) of what hides places, also the surface itself.
        longest: > 0, edges up to which the corners and the center of a face tell what hides it.

    Raises:
        ValueError: clip has another shape, or meshes as `dapple.Surface`.
    """

    bounds = False

    def __init__(
        self,
        clip: ArrayLike,
        margin: float = 0.0,
        meshes: Sequence[Mesh] = (),
        longest: float = np.inf,
    ) -> None:
        clip = shaped("clip", clip, 4, 4)
        x, y, w = clip[0], clip[1], (1.0 + margin) * clip[3]
        self._planes = np.array([w - x, w + x, w - y, w + y, clip[3]])
        self._bodies = [Surface(*mesh) for mesh in meshes]
        self._eye, self._longest = _eye_of(clip), longest
        self._known = np.empty((0, 3)), np.empty(0, dtype=np.uint8)

    def _beyond(self, points: Floats) -> NDArray[np.uint8]:
        """Of each point (n,), the planes that it is beyond, as bits."""
        places, found = self._known
        if np.array_equal(points, places):
            return found
        signed: Floats = points @ self._planes[:, :3].T + self._planes[:, 3]
        found = np.zeros(len(points), dtype=np.uint8)
        for k in range(len(self._planes)):
            found[~(signed[:, k] >= 0.0)] |= np.uint8(1 << k)
        self._known = points.copy(), found
        return found

    def _seen(self, points: Floats) -> Flags:
        """Which points (n,) no mesh hides."""
        found = np.ones(len(points), dtype=bool)
        for body in self._bodies:
            found[found] = seen_from(body, self._eye, points[found])
        return found

    def values(self, points: Floats) -> Floats:
        seen: Flags = self._beyond(points) == 0
        seen[seen] = self._seen(points[seen])
        return seen.astype(np.float64)

    def changes(self, points: Floats, faces: Ints) -> Flags:
        a, b, c = self._beyond(points)[faces.T]
        beyond: Flags = (a & b & c) != 0  # all of them beyond one plane
        found: Flags = ~beyond & ((a | b | c) != 0)
        if self._bodies:
            rows = np.flatnonzero(~beyond & ~found)
            seen = self._seen_of_faces(points, faces[rows])
            mixed = seen.any(axis=1) & ~seen.all(axis=1)
            found[rows] = mixed | (longest_edges(points, faces[rows]) > self._longest)
        return found

    def at_corners(self, points: Floats, faces: Ints) -> Floats:
        inside: Flags = (self._beyond(points) == 0)[faces]
        if self._bodies:
            rows = np.flatnonzero(inside.any(axis=1))
            seen: Flags = np.all(self._seen_of_faces(points, faces[rows]), axis=1)
            inside[rows[~seen]] = False
        return inside.astype(np.float64)

    def _seen_of_faces(self, points: Floats, faces: Ints) -> Flags:
        """Whether the corners and the center of each face are seen (m, 4)."""
        used, place = np.unique(faces, return_inverse=True)
        corners = self._seen(points[used])[place.reshape(-1, 3)]
        centers = self._seen(points[faces].mean(axis=1))
        return np.column_stack([corners, centers])


def _eye_of(clip: Floats) -> Floats:
    """The eye of a camera in homogeneous coordinates (4,): the place that is nowhere in the
    picture.
    """
    rows = clip[[0, 1, 3]]
    minors = [(-1.0) ** k * np.linalg.det(np.delete(rows, k, axis=1)) for k in range(4)]
    eye: Floats = np.array(minors)
    if abs(eye[3]) > _FAR * np.abs(eye[:3]).max(initial=0.0):
        return eye / eye[3]
    eye[3] = 0.0  # parallel rays, toward where depths are smaller
    return -eye if clip[2, :3] @ eye[:3] > 0.0 else eye


def needs_cut(
    fields: Sequence[Field], places: Sequence[Floats], faces: Ints, lengths: Floats, target: float
) -> Flags:
    """Faces (m,) on which some field changes and that are too large for it.

    Args:
        places: the vertices (v, 3) where each field is looked up.
        faces: (m, 3).
        lengths: (m,), their longest edges.
        target: the longest edge that is good at a sharp change.
    """
    found = np.zeros(len(lengths), dtype=bool)
    for field, points in zip(fields, places, strict=True):
        open_ones = np.flatnonzero(~found & (lengths > field.coarseness * target))
        found[open_ones] = field.changes(points, faces[open_ones])
    return found


def _along(places: Floats, axes: Floats) -> Floats:
    """places @ axes, rounded alike on every machine."""
    x, y, z = places.T
    parts = [x * one[0] + y * one[1] + z * one[2] for one in axes.T]
    found: Floats = np.stack(parts, axis=1)
    return found
