# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh as it was read, and the arrays that a worker makes from it, without Blender.

Reading has to be done in the main thread, where it blocks the artist; the rest does not.
"""

import hashlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.errors import ScatterError
from .arrays import Floats, Ints, SurfaceArrays, Surroundings, topology_digest
from .records import mixed
from .sources import digest_of

Singles = NDArray[np.float32]


@dataclass(frozen=True)
class RawMesh:
    """A mesh in its own space."""

    name: str  # of the object, for messages
    positions: Singles  # (v, 3)
    corners: Ints  # (c,) vertices of the polygons' corners, polygon after polygon
    starts: Ints  # (p,) first corner of each polygon
    cut: Ints | None = None  # (m, 3) corners of triangles; None: polygons have at most 4 corners
    matrix: Floats = field(default_factory=lambda: np.eye(4))  # own space to world space
    is_fluid: bool = False  # a metaball; its faces change whenever something moves
    # Unit normals (c, 3) of the corners, or (p, 3) of the polygons where all of them are flat;
    # None: those of the vertices, smooth everywhere.
    normals: Singles | None = None
    time: float = 0.0  # frame of the animation, with its fraction

    def same_place(self, other: "RawMesh") -> bool:
        """Whether both have the same vertex positions."""
        alike = np.array_equal(self.matrix, other.matrix)
        return alike and np.array_equal(self.positions, other.positions)

    def same_faces(self, other: "RawMesh") -> bool:
        """Whether both have the same polygons."""
        if self.is_fluid and not np.array_equal(self.positions, other.positions):
            return False
        alike = len(self.positions) == len(other.positions)
        return alike and np.array_equal(self.corners, other.corners)

    @cached_property
    def topology(self) -> str:
        """Digest of the polygons."""
        found = topology_digest(len(self.positions), self.corners, self.starts)
        if not self.is_fluid:
            return found
        digest = hashlib.blake2b(found.encode(), digest_size=16)
        digest.update(self.positions.astype(np.float64).tobytes())
        return digest.hexdigest()

    @cached_property
    def vertices(self) -> Floats:
        """Positions (v, 3) in world space."""
        found: Floats = self.positions @ self.matrix[:3, :3].T + self.matrix[:3, 3]
        return found

    def world_normals(self) -> Floats | None:
        """Shading normals (c, 3) of the corners in world space; None: smooth everywhere."""
        if self.normals is None:
            return None
        return world_normals(self.normals, self.matrix, sizes(self.starts, len(self.corners)))

    @cached_property
    def solid(self) -> tuple[Floats, Ints]:
        """Vertices and triangles in world space."""
        found = surface_of_raw(self)
        return found.vertices, found.faces

    @property
    def is_mirrored(self) -> bool:
        """Whether its matrix mirrors, so that its stored faces point inward in the world."""
        return bool(np.linalg.det(self.matrix[:3, :3]) < 0.0)


def world_normals(normals: Singles, matrix: Floats, totals: Ints) -> Floats:
    """Normals (c, 3) in world space, of corners or of polygons with totals (p,) corners.

    They are transformed by the cofactors of the matrix, which exist for a scale of 0 too. They are
    unit vectors in the object's own space, where normals are interpolated.
    """
    x, y, z = matrix[:3, :3].T
    cofactors = np.array([np.cross(y, z), np.cross(z, x), np.cross(x, y)])
    if np.dot(x, cofactors[0]) < 0.0:  # a mirrored surface still faces outward
        cofactors = -cofactors
    found: Floats = normals @ (cofactors / max(float(np.linalg.norm(cofactors, 2)), 1e-300))
    return np.repeat(found, totals, axis=0) if len(found) == len(totals) else found


def sizes(starts: Ints, corner_count: int) -> Ints:
    """Corners (p,) of each polygon."""
    return np.diff(np.append(starts, np.int32(corner_count))).astype(np.int32)


def triangle_corners(mesh: RawMesh) -> Ints:
    """Corners (m, 3) of the triangles that Blender cuts the polygons into.

    Polygons that lie on each other corner by corner are cut like the first of them: doubled faces
    are only recognized if their triangles are the same.
    """
    cut = _blenders_cut(mesh) if mesh.cut is None else mesh.cut
    return cut_alike(mesh.positions, mesh.corners, mesh.starts, cut)


def _blenders_cut(mesh: RawMesh) -> Ints:
    """Triangles of polygons with at most four corners."""
    extra = sizes(mesh.starts, len(mesh.corners)) - 3  # triangles beside the first
    first = np.cumsum(extra + 1) - extra - 1
    found = np.empty((len(mesh.starts) + int(extra.sum()), 3), dtype=np.int32)
    found[first] = mesh.starts[:, None] + np.arange(3, dtype=np.int32)
    quads, begins = first[extra > 0], mesh.starts[extra > 0, None]
    other = _bent_inward(mesh.positions[mesh.corners[begins + np.arange(4)]])
    found[quads[other]] = begins[other] + np.array([0, 1, 3], dtype=np.int32)
    rest = np.where(other[:, None], np.array([1, 2, 3]), np.array([0, 2, 3]))
    found[quads + 1] = begins + rest
    return found


def cut_alike(positions: Singles, corners: Ints, starts: Ints, cut: Ints) -> Ints:
    """Corners (m, 3) of triangles in which polygons that lie on others are cut alike.

    positions (v, 3) of vertices, corners (c,) vertices, starts (p,) first corners of polygons.
    """
    totals = sizes(starts, len(corners))
    firsts, others = _on_each_other(positions[corners], starts, totals)
    if not len(firsts):
        return cut
    found = cut.copy()
    begins = np.cumsum(totals - 2) - (totals - 2)  # first triangle of each polygon
    for total in np.unique(totals[firsts]):
        own, other = (these[totals[firsts] == total] for these in (firsts, others))
        steps, rows = (np.arange(count, dtype=np.int32) for count in (total, total - 2))
        there, here = (positions[corners[starts[these, None] + steps]] for these in (own, other))
        same = (there[:, :, None] == here[:, None]).all(axis=3)  # (k, corner there, corner here)
        alike = same.any(axis=2).all(axis=1)
        own, other, same = own[alike], other[alike], same[alike]
        local = cut[begins[own, None] + rows] - starts[own, None, None]
        like = np.take_along_axis(same.argmax(axis=2), local.reshape(len(own), -1), axis=1)
        like = like.reshape(local.shape)
        turned = _are_turned(there[alike], here[alike])
        like[turned] = like[turned, :, ::-1]
        found[begins[other, None] + rows] = starts[other, None, None] + like
    return found


def _on_each_other(
    places: Singles, starts: Ints, totals: Ints
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Pairs of polygons with more than three corners that may have all corners in common."""
    large = np.flatnonzero(totals > 3)
    none = np.empty(0, dtype=np.int64)
    if len(large) < 2:
        return none, none
    sums = np.add.reduceat(_numbers_of(places), starts)[large]
    ordered = np.sort(sums)
    if not (ordered[1:] == ordered[:-1]).any():
        return none, none
    _, first, group = np.unique(sums, return_index=True, return_inverse=True)
    firsts = large[first[group.reshape(-1)]]
    pairs = (firsts != large) & (totals[firsts] == totals[large])
    return firsts[pairs], large[pairs]


def _numbers_of(positions: Singles) -> NDArray[np.uint64]:
    """A number (v,) for each position, whose sums identify polygons.

    Opposite sides of a cube differ only in signs, which plain sums of positions would miss.
    """
    bits = np.ascontiguousarray(positions + np.float32(0.0)).view(np.uint32).astype(np.uint64)
    found = np.zeros(len(bits), dtype=np.uint64)
    for axis in range(3):
        found = mixed(found + bits[:, axis] + np.uint64(0x9E3779B97F4A7C15))
    return found


def _are_turned(there: Singles, here: Singles) -> NDArray[np.bool_]:
    """Whether polygons (k, n, 3) have the same corners in the opposite order."""
    there, here = (
        np.cross(p - p[:, :1], np.roll(p, -1, axis=1) - p[:, :1]).sum(axis=1) for p in (there, here)
    )
    found: NDArray[np.bool_] = np.einsum("kd,kd->k", there, here) < 0.0
    return found


def _bent_inward(corners: Singles) -> NDArray[np.bool_]:
    """Quads (q, 4, 3) whose diagonal from the first to the third corner lies outside."""
    second, third, fourth = (corners[:, k] - corners[:, 0] for k in (1, 2, 3))
    sides = np.cross(second, third), np.cross(fourth, third)
    found: NDArray[np.bool_] = np.einsum("qd,qd->q", *sides) > 0.0
    return found


def surface_of_raw(
    mesh: RawMesh,
    values: Iterable["RawValues"] = (),
    around: Surroundings | None = None,
    uv: Singles | None = None,
    like: SurfaceArrays | None = None,
) -> SurfaceArrays:
    """The surface in world space; uv (c, 2) are texture coordinates of the corners.

    Polygons are cut like those of another surface, `like`, if they equal those.

    Raises:
        ScatterError: values cannot be a density.
    """
    if like is not None and (like.loops is None or like.topology != mesh.topology):
        like = None
    cut = _cut(mesh) if like is None or like.loops is None else like.loops
    around = Surroundings() if around is None else around
    if uv is not None:
        around = replace(around, uv=np.ascontiguousarray(uv[cut], dtype=np.float64))
    weights, digests = placed_values(mesh.name, values, mesh.starts, cut)
    return SurfaceArrays(
        mesh.name,
        mesh.vertices,
        np.ascontiguousarray(mesh.corners[cut]) if like is None else like.faces,
        mesh.topology,
        mesh.matrix,
        weights,
        around,
        loops=np.ascontiguousarray(cut),
        normals=mesh.world_normals(),
        time=mesh.time,
        digests=digests,
    )


def _cut(mesh: RawMesh) -> Ints:
    """Corners (m, 3) of the triangles, facing outward."""
    cut = triangle_corners(mesh)
    return cut[:, ::-1] if mesh.is_mirrored else cut


def unmoved(mesh: RawMesh, before: SurfaceArrays | None) -> SurfaceArrays | None:
    """An earlier reading of the same mesh at the same place, whose triangles are the same."""
    if before is None or before.topology != mesh.topology:
        return None
    same = np.array_equal(before.matrix, mesh.matrix)
    return before if same and np.array_equal(before.vertices, mesh.vertices) else None


def outline_of_raw(mesh: RawMesh) -> SurfaceArrays:
    """The surface without triangles and values."""
    none = np.empty((0, 3), dtype=np.int32)
    return SurfaceArrays(
        mesh.name, mesh.vertices, none, mesh.topology, mesh.matrix, loops=none, time=mesh.time
    )


@dataclass(frozen=True)
class RawValues:
    """Numbers (k,) or colors (k, 4) of a mesh's vertices, polygons or polygons' corners."""

    name: str
    domain: str  # POINT, FACE or CORNER
    values: NDArray[Any]

    def numbers(self, surface: str) -> Floats:
        """The values (k,) that multiply a density; colors count by their brightness.

        Raises:
            ScatterError: a value is negative or not finite.
        """
        found = np.asarray(self.values, dtype=np.float64)
        if found.ndim == 2:
            found = found[:, :3].mean(axis=1)
        wrong = ~(np.isfinite(found) & (found >= 0.0))
        if wrong.any():
            first = int(np.argmax(wrong))
            raise ScatterError(
                f"Surface '{surface}': '{self.name}' is {found[first]:.6g} at "
                f"{_PLACES[self.domain]} {first}; a density must be finite and not negative"
            )
        return found


_PLACES = {"POINT": "vertex", "FACE": "face", "CORNER": "face corner"}


def placed_values(
    surface: str, values: Iterable[RawValues], starts: Ints, cut: Ints
) -> tuple[dict[str, Floats], dict[str, str]]:
    """Values of a surface by name, and digests of those that do not belong to vertices.

    Values are (v,) of vertices, (m, 1) of triangles or (m, 3) of their corners. The digests do not
    depend on how quads are cut. Polygons begin at the corners `starts`; `cut` (m, 3) are corners of
    triangles, polygon after polygon.

    Raises:
        ScatterError: values cannot be a density.
    """
    weights, digests = {}, {}
    for raw in values:
        numbers = raw.numbers(surface)
        if raw.domain == "POINT":
            weights[raw.name] = numbers
            continue
        digests[raw.name] = digest_of([numbers])
        if raw.domain == "CORNER":
            weights[raw.name] = numbers[cut]
        else:
            owners = np.searchsorted(starts, cut[:, 0], side="right") - 1
            weights[raw.name] = numbers[owners][:, None]
    return weights, digests


@dataclass(frozen=True)
class RawImage:
    """Pixels of an image as Blender gives them, row 0 at the bottom."""

    name: str
    pixels: NDArray[np.float32]  # (rows, columns, channels)
    tile: int = 0  # number of a UDIM tile; 0: the image is in one piece


def image_density(images: Sequence[RawImage], channel: str) -> dict[str, Any]:
    """The fields of Surroundings for an image or its UDIM tiles; errors as in shade()."""
    if not images:
        return {}
    if not images[0].tile:
        return {"image": shade(images[0], channel)}
    values = [_values(image, channel) for image in images]
    if not any(one.any() for one in values):
        raise _too_dark(images[0], channel)
    return {"tiles": tuple((image.tile, one) for image, one in zip(images, values, strict=True))}


def shade(image: RawImage, channel: str) -> Floats:
    """The density of an image (rows, columns): brightness times opacity, or a channel.

    Raises:
        ScatterError: there is no such channel, or it cannot be a density.
    """
    values = _values(image, channel)
    if not values.any():
        raise _too_dark(image, channel)
    return values


def _too_dark(image: RawImage, channel: str) -> ScatterError:
    dark = "black" if channel == "BRIGHTNESS" else f"0 in its channel {channel.title()}"
    return ScatterError(f"Image '{image.name}' is {dark} everywhere: no point can be placed")


def _values(image: RawImage, channel: str) -> Floats:
    rows, columns, _ = image.pixels.shape
    values = np.empty((rows, columns))
    for row in range(rows):  # one by one, as all channels in double precision take much memory
        values[row] = _shades(image.pixels[row].astype(np.float64), channel)
    wrong = ~(np.isfinite(values) & (values >= 0.0))
    if wrong.any():
        row, column = np.argwhere(wrong)[0]
        raise ScatterError(
            f"Image '{image.name}' is {values[row, column]:.6g} at pixel ({column}, {row})"
            f"{f' of tile {image.tile}' if image.tile else ''}; a density must be finite and not "
            "negative"
        )
    return values


def _shades(pixels: Floats, channel: str) -> Floats:
    """Densities of pixels (n, channels): one or two are gray, two or four have an opacity."""
    channels = pixels.shape[1]
    has_opacity, is_colored = channels in (2, 4), channels >= 3
    if channel == "ALPHA":
        return pixels[:, -1] if has_opacity else np.ones(len(pixels))
    if channel != "BRIGHTNESS":
        return pixels[:, ("RED", "GREEN", "BLUE").index(channel) if is_colored else 0]
    values: Floats = pixels[:, :3].mean(axis=1) if is_colored else pixels[:, 0]
    return values * pixels[:, -1] if has_opacity else values
