# SPDX-License-Identifier: GPL-3.0-or-later
"""Points carried over to a surface that has changed, and where it has changed."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.native import package
from ..density.counts import values_of
from ..density.masked_surface import MaskedSurface
from ..settings.values import Settings
from ..surface.arrays import Floats, Ints, SurfaceArrays
from ..surface.binding import samples_of
from ..surface.records import Binding, Columns
from .solve import Solved

SAME_PLACE = 1e-5  # relative to the extent: vertices that move less have not moved


@dataclass(frozen=True)
class PreviousResult:
    """The stored points, and their solution if it is still in memory."""

    binding: Binding
    columns: Columns
    solved: Solved | None = None
    edited: Floats | None = None  # (k, 3) where points were placed, in the surface's own space


def cut_alike(solved: Solved | None, arrays: SurfaceArrays) -> SurfaceArrays:
    """The surface with quads cut along the same diagonals as before, even if they bent since.

    Images and values of face corners belong to the original triangles.
    """
    laid = arrays.around.uv is not None or any(map(_is_of_corners, arrays.weights.values()))
    if solved is None or laid or arrays.topology != solved.arrays.topology:
        return arrays
    mirrored = np.linalg.det(arrays.matrix[:3, :3]) * np.linalg.det(solved.arrays.matrix[:3, :3])
    if mirrored < 0.0:
        return arrays
    return replace(arrays, faces=solved.arrays.faces, loops=solved.arrays.loops)


def _is_of_corners(values: Floats) -> bool:
    return values.ndim == 2 and values.shape[1] == 3


def carried_points(
    before: PreviousResult, arrays: SurfaceArrays, masked: MaskedSurface, settings: Settings
) -> tuple[Any, Ints]:
    """dapple.Samples of the existing points on the surface, and the faces that changed."""
    solved, everything = before.solved, np.arange(masked.face_count, dtype=np.int32)
    ids, classes = before.columns["id"], before.columns["dapple_object_type"]
    if solved is None or not np.array_equal(solved.arrays.faces, arrays.faces):
        samples = samples_of(before.binding, masked.original, ids, classes)
        return masked.from_original(samples), everything
    vertices = _in_pose(solved.arrays, arrays)
    if not (masked.is_cut or solved.masked.is_cut):
        surface = solved.masked.surface
        if vertices is not solved.arrays.vertices:
            surface = surface.deformed(vertices)
        changed: Ints = package().changed_faces(surface, masked.surface)
        for name in _values(settings):
            other = solved.masked.corner_density(name) != masked.corner_density(name)
            changed = np.union1d(changed, np.flatnonzero(other.any(axis=1))).astype(np.int32)
        samples = solved.samples
        if vertices is not solved.arrays.vertices or not np.array_equal(samples.ids, ids):
            places = (samples.faces, samples.barycentric)
            samples = package().Samples(surface, *places, ids=ids, classes=classes)
        return samples, changed
    coarse = solved.masked.to_original(solved.samples)
    places = (coarse.faces, coarse.barycentric)
    samples = package().Samples(masked.original, *places, ids=ids, classes=classes)
    old = replace(solved.arrays, vertices=vertices)
    return masked.from_original(samples), _changed_pieces(
        solved.masked, old, masked, arrays, settings
    )


def _in_pose(before: SurfaceArrays, now: SurfaceArrays) -> Floats:
    """The previous vertices, moved by the rigid motion of the object."""
    if np.array_equal(before.matrix, now.matrix):
        return before.vertices
    motion = now.matrix @ np.linalg.inv(before.matrix)
    linear = motion[:3, :3]
    if not np.allclose(linear.T @ linear, np.eye(3), atol=SAME_PLACE):
        return before.vertices
    moved = before.vertices @ linear.T + motion[:3, 3]
    extent = np.ptp(now.vertices, axis=0).max(initial=0.0)
    same = np.abs(moved - now.vertices).max(axis=1) <= SAME_PLACE * extent
    found: Floats = np.where(same[:, None], now.vertices, moved)
    return found


def _values(settings: Settings) -> list[str]:
    """Names of the values that object types have their densities from."""
    return sorted(set(values_of(settings)) - {""})


def _densities(settings: Settings) -> list[str]:
    """Names of the values that multiply the densities of object types."""
    return sorted({kind.density for kind in settings.object_types if kind.density})


def _changed_pieces(
    before: MaskedSurface,
    old: SurfaceArrays,
    masked: MaskedSurface,
    arrays: SurfaceArrays,
    settings: Settings,
) -> Ints:
    """Refined faces whose density or shape changed."""
    names = _densities(settings)
    own = _values(settings)
    now = _pieces(masked, arrays, own)
    same = np.isin(now, _pieces(before, old, own))
    alike = (old.vertices == arrays.vertices).all(axis=1)[arrays.faces].all(axis=1)
    alike &= (before.own_density == masked.own_density).all(axis=1)
    for name in names:
        alike &= (_of_faces(old, name) == _of_faces(arrays, name)).all(axis=1)
    parents = before.pieces[0][~_is_plain(before, settings)]
    alike[parents] = False
    same |= _is_plain(masked, settings) & alike[masked.pieces[0]]  # only the refinement differs
    return np.flatnonzero(~same).astype(np.int32)


def _of_faces(arrays: SurfaceArrays, name: str) -> Floats:
    """Values (m, 3) at the corners of the faces."""
    values = arrays.weights[name]
    found: Floats = values[arrays.faces] if values.ndim == 1 else values
    return np.broadcast_to(found, arrays.faces.shape)


def _is_plain(masked: MaskedSurface, settings: Settings) -> NDArray[np.bool_]:
    """Which refined faces (m,) have the density of their original face, for all classes."""
    parents, corners = masked.pieces
    values = np.einsum("mkc,mc->mk", corners, masked.own_density[parents])
    found: NDArray[np.bool_] = np.isclose(masked.corner_density(), values, atol=0.0).all(axis=1)
    for name, kind in zip(values_of(settings), settings.object_types, strict=True):
        if name != kind.density:
            own = masked.corner_density(name) == masked.corner_density(kind.density)
            found &= own.all(axis=1)
    return found


def _pieces(masked: MaskedSurface, arrays: SurfaceArrays, names: list[str]) -> NDArray[np.uint64]:
    """Numbers (m,) that are equal for refined faces with the same place and densities."""
    parents, corners = masked.pieces
    count = len(parents)
    places = arrays.vertices[arrays.faces[parents]].reshape(count, 9)
    densities = [masked.corner_density(name) for name in ("", *names)]
    rows = np.concatenate([corners.reshape(count, 9), places, *densities], axis=1)
    bits = (rows + 0.0).view(np.uint64)  # removes -0.0
    odd = 2 * np.random.default_rng(1).integers(2**62, size=1 + bits.shape[1], dtype=np.uint64) + 1
    mixed = parents.astype(np.uint64) * odd[0]
    for column, factor in zip(bits.T, odd[1:], strict=True):
        mixed = (mixed ^ column) * factor
        mixed ^= mixed >> np.uint64(29)
    return mixed


def edited_faces(before: PreviousResult, arrays: SurfaceArrays, masked: MaskedSurface) -> Ints:
    """Faces at which points were added, moved or removed by hand."""
    if before.edited is None or not len(before.edited):
        return np.empty(0, dtype=np.int32)
    places = before.edited @ arrays.matrix[:3, :3].T + arrays.matrix[:3, 3]
    return np.unique(package().project(masked.surface, places).faces).astype(np.int32)
