# SPDX-License-Identifier: GPL-3.0-or-later
"""Keep Points: a solution from the one before, so that points stay and little moves.

Where it is known what has changed, only the points there are relaxed, and all others keep every
byte. A count that is exact then asks for points elsewhere too: these come and go over the whole
surface, as do all where nothing is known of the solution before.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.native import named, package
from ..density.ground import Ground, ground_of, shares
from ..settings.values import Settings
from ..surface.arrays import Floats, Ints, SurfaceArrays
from ..surface.binding import binding_of, samples_of
from ..surface.frames import carried, pointing, shading
from ..surface.records import Binding, Columns, own_random
from .class_counts import classes_of, rooms, sampled, shrunk, wanted_counts
from .figures import Details, details_of
from .locked import Locked
from .solve import Scattered, Solved, point_columns, report_of

KEEPING = {"count", "per_area", "density", "forward"}  # settings that may be others than before
_SAME = 1e-5  # of a surface's extent: vertices that are moved by less are where they were
_SPARE_POINTS, _SPARE = 2, 0.001  # points by area that may be missing, in all and as a share
_EFFORT = ("evaluations", "milliseconds", "converged")  # figures that are no measure of points
_OVERLAP = ("worst_overlap", "overlap_first", "overlap_second")
_ROUGH = 5e-4  # tolerance of classes while they are shown before their counts are right
_HANDFUL = 3  # points that come or go at a place without many others giving way
_RINGS = 3.0  # spacings around those points, within which others make room for them
_YIELDS = 0.015  # of its area, by which a point gives way to others that come or go
_FEW = 0.02  # of the points that move, which may be too many or too few where they are
_TRIES = 4  # to have no point where the density is 0
_STRANDED = 0.5  # of all points: where more have no density any more, all are placed anew
_MOST = 1.0  # of all points: where more have to come from elsewhere, all are placed anew
_MANY = 0.05  # of all points: where more have to come from elsewhere, all are moved at once


@dataclass(frozen=True)
class Before:
    """The points as they are stored, and their solution where it is remembered."""

    binding: Binding
    columns: Columns
    solved: Solved | None = None
    touched: Floats | None = None  # (k, 3) where points were placed, in the surface's own space


def keeps(settings: Settings, changed: list[str], same_faces: bool) -> bool:
    """Whether points can be kept at all: on the same faces, of the same classes and seed."""
    return same_faces and KEEPING.issuperset(changed)


def kept(
    before: Before, arrays: SurfaceArrays, settings: Settings, context: Any, locked: Locked | None
) -> Scattered:
    """The points relaxed where something has changed.

    They may be more or fewer than the exact count asks for: see is_whole. They are not measured.

    Raises:
        ScatterError: more points are locked than there shall be.
    """
    arrays = _cut_alike(before.solved, arrays)
    with named(arrays.name):
        like = before.solved.ground if before.solved else None
        ground = ground_of(arrays, settings, context, like)
        if locked is not None:
            locked.of_classes(wanted_counts(ground, settings))  # an error if they are more
        given, changed = _given(before, arrays, ground, settings)
        touched = _touched(before, arrays, ground)
        if settings.classes:
            changed = np.union1d(changed, touched).astype(np.int32)
            solved = fine = _classes_relaxed(ground, given, changed, settings, context, locked)
        elif len(touched) and not len(changed):
            solved = _evened_around(ground, given, touched, settings, context, locked)
            solved = _off_nothing(ground, solved, settings, context, locked)
            fine = _with_ids_of(given, solved, ground)
        else:
            changed = np.union1d(changed, touched).astype(np.int32)
            solved = _relaxed(ground, given, changed, settings, context, locked)
            solved = fine = _off_nothing(ground, solved, settings, context, locked)
        found = _scattered(before, arrays, ground, given, fine, settings, locked)
        effort = {name: getattr(report_of(solved.report), name) for name in _EFFORT}
    return replace(found, report=replace(found.report, **effort))


def as_placed(solved: Solved, before: Ints, binding: Binding, ids: Ints, classes: Ints) -> Solved:
    """A solution of points with the ids `before`, with the points that are there once some were
    placed by hand: those that were not keep all that is known of them.
    """
    ground, coarse = solved.ground, solved.ground.to_original(solved.samples)
    found = samples_of(binding, ground.original, ids, classes)
    if not len(before) or not len(ids):
        return replace(solved, samples=ground.from_original(found))
    faces, weights = found.faces.copy(), found.barycentric.copy()
    order = np.argsort(before)
    rows = order[np.minimum(np.searchsorted(before, ids, sorter=order), len(order) - 1)]
    same = before[rows] == ids
    same &= np.abs(coarse.positions[rows] - found.positions).max(axis=1) <= _SAME * _extent(solved)
    faces[same], weights[same] = coarse.faces[rows[same]], coarse.barycentric[rows[same]]
    samples = package().Samples(ground.original, faces, weights, ids=ids, classes=classes)
    return replace(solved, samples=ground.from_original(samples))


def _extent(solved: Solved) -> float:
    return float(np.ptp(solved.arrays.vertices, axis=0).max(initial=0.0))


def is_whole(scattered: Scattered, before: Before | None = None) -> bool:
    """Whether there are as many points as there have to be: exactly, or about so many by area.

    By area, those that were placed or removed by hand may be too many or too few.
    """
    solved, settings = scattered.solved, scattered.settings
    assert solved is not None
    if settings.per_area and before is not None and before.touched is not None:
        return True
    there = np.bincount(solved.samples.classes, minlength=max(len(settings.classes), 1))
    for count, wanted in zip(there, wanted_counts(solved.ground, settings), strict=True):
        spare = max(_SPARE_POINTS, _SPARE * wanted) if settings.per_area else 0
        if abs(count - wanted) > spare:
            return False
    return True


def evened(before: Scattered, context: Any, locked: Locked | None) -> Scattered:
    """The points with the exact count, even over the whole surface."""
    solved, settings = before.solved, before.settings
    assert solved is not None
    ground, arrays = solved.ground, solved.arrays
    with named(arrays.name):
        if settings.classes:
            fine = _with_counts(ground, solved.samples, settings, context, locked)
        else:
            fine = _resampled(ground, solved.samples, settings, context, locked)
            fine = _off_nothing(ground, fine, settings, context, locked)
        stored = Before(before.binding, before.columns, solved)
        found = _scattered(stored, arrays, ground, solved.samples, fine, settings, locked)
    spent = before.report.milliseconds + found.report.milliseconds
    return replace(found, report=replace(found.report, milliseconds=spent))


def measured(scattered: Scattered, context: Any) -> Scattered:
    """With the figures of all points."""
    solved = scattered.solved
    assert solved is not None
    ground, samples = solved.ground, solved.samples
    with named(solved.arrays.name):
        weight = scattered.settings.capacity_weight
        found = report_of(
            package().analyze(ground.surface, samples, capacity_weight=weight, context=context)
        )
        density = ground.density_at(samples)
        gaps = details_of(samples, density).gaps
    effort = {name: getattr(scattered.report, name) for name in (*_EFFORT, *_OVERLAP)}
    report = replace(found, doubled_faces=ground.original.doubled_faces, **effort)
    return replace(scattered, report=report, details=Details(gaps=gaps))


def _cut_alike(solved: Solved | None, arrays: SurfaceArrays) -> SurfaceArrays:
    """With quads cut along the same diagonals as before, which may be others once they are bent.

    A picture and values of face corners lie on the triangles as they were read.
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


def _given(
    before: Before, arrays: SurfaceArrays, ground: Ground, settings: Settings
) -> tuple[Any, Ints]:
    """dapple.Samples of the ground that are there, and the faces on which something changed."""
    solved, everything = before.solved, np.arange(len(ground.surface.faces), dtype=np.int32)
    ids, classes = before.columns["id"], before.columns["dapple_class"]
    if solved is None or not np.array_equal(solved.arrays.faces, arrays.faces):
        samples = samples_of(before.binding, ground.original, ids, classes)
        return ground.from_original(samples), everything
    vertices = _in_pose(solved.arrays, arrays)
    if not (ground.is_cut or solved.ground.is_cut):
        surface = solved.ground.surface.deformed(vertices)
        changed: Ints = package().changed_faces(surface, ground.surface)
        for name in _densities(settings):
            other = solved.ground.corner_density(name) != ground.corner_density(name)
            changed = np.union1d(changed, np.flatnonzero(other.any(axis=1))).astype(np.int32)
        samples = solved.samples
        if vertices is not solved.arrays.vertices or not np.array_equal(samples.ids, ids):
            places = (samples.faces, samples.barycentric)
            samples = package().Samples(surface, *places, ids=ids, classes=classes)
        return samples, changed
    coarse = solved.ground.to_original(solved.samples)
    places = (coarse.faces, coarse.barycentric)
    samples = package().Samples(ground.original, *places, ids=ids, classes=classes)
    old = replace(solved.arrays, vertices=vertices)
    return ground.from_original(samples), _changed_pieces(
        solved.ground, old, ground, arrays, settings
    )


def _in_pose(before: SurfaceArrays, now: SurfaceArrays) -> Floats:
    """The previous vertices where they are once the object was moved or turned as a whole."""
    if np.array_equal(before.matrix, now.matrix):
        return before.vertices
    motion = now.matrix @ np.linalg.inv(before.matrix)
    linear = motion[:3, :3]
    if not np.allclose(linear.T @ linear, np.eye(3), atol=_SAME):
        return before.vertices
    moved = before.vertices @ linear.T + motion[:3, 3]
    extent = np.ptp(now.vertices, axis=0).max(initial=0.0)
    same = np.abs(moved - now.vertices).max(axis=1) <= _SAME * extent
    found: Floats = np.where(same[:, None], now.vertices, moved)
    return found


def _densities(settings: Settings) -> list[str]:
    """Names of the values that multiply the densities of object types."""
    return sorted({kind.density for kind in settings.classes if kind.density})


def _changed_pieces(
    before: Ground, old: SurfaceArrays, ground: Ground, arrays: SurfaceArrays, settings: Settings
) -> Ints:
    """Pieces of cut faces where there is another density or shape than before."""
    names = _densities(settings)
    now = _pieces(ground, arrays, names)
    same = np.isin(now, _pieces(before, old, names))
    alike = (old.vertices == arrays.vertices).all(axis=1)[arrays.faces].all(axis=1)
    alike &= (before.own_density == ground.own_density).all(axis=1)
    for name in names:
        alike &= (_of_faces(old, name) == _of_faces(arrays, name)).all(axis=1)
    parents = before.pieces[0][~_is_plain(before)]
    alike[parents] = False
    same |= _is_plain(ground) & alike[ground.pieces[0]]  # it is merely cut otherwise
    return np.flatnonzero(~same).astype(np.int32)


def _of_faces(arrays: SurfaceArrays, name: str) -> Floats:
    """Values (m, 3) at the corners of the faces."""
    values = arrays.weights[name]
    found: Floats = values[arrays.faces] if values.ndim == 1 else values
    return np.broadcast_to(found, arrays.faces.shape)


def _is_plain(ground: Ground) -> NDArray[np.bool_]:
    """Which pieces (m,) have the density that the face had before it was cut."""
    parents, corners = ground.pieces
    values = np.einsum("mkc,mc->mk", corners, ground.own_density[parents])
    found: NDArray[np.bool_] = np.isclose(ground.corner_density(), values, atol=0.0).all(axis=1)
    return found


def _pieces(ground: Ground, arrays: SurfaceArrays, names: list[str]) -> NDArray[np.uint64]:
    """Numbers (m,) that are the same where a piece lies at the same place of the same face that was
    read, with the same density of all and of object types with values of these names.
    """
    parents, corners = ground.pieces
    count = len(parents)
    places = arrays.vertices[arrays.faces[parents]].reshape(count, 9)
    densities = [ground.corner_density(name) for name in ("", *names)]
    rows = np.concatenate([corners.reshape(count, 9), places, *densities], axis=1)
    bits = (rows + 0.0).view(np.uint64)  # there is a -0.0 too
    odd = 2 * np.random.default_rng(1).integers(2**62, size=1 + bits.shape[1], dtype=np.uint64) + 1
    mixed = parents.astype(np.uint64) * odd[0]
    for column, factor in zip(bits.T, odd[1:], strict=True):
        mixed = (mixed ^ column) * factor
        mixed ^= mixed >> np.uint64(29)
    return mixed


def _relaxed(
    ground: Ground,
    given: Any,
    changed: Ints,
    settings: Settings,
    context: Any,
    locked: Locked | None,
) -> Any:
    wanted = _wanted(ground, settings)
    everything = len(changed) == len(ground.surface.faces)
    if not len(changed) and wanted == len(given):
        return given
    if locked is None and _stranded(ground, given) > _STRANDED:
        return sampled(ground, settings, context)
    if everything or not len(changed) or not len(given):
        return _resampled(ground, given, settings, context, locked)
    coming = 0.0 if settings.per_area else _coming(ground, given, changed)
    if locked is None and coming > _MOST * wanted:
        return sampled(ground, settings, context)
    if coming > _MANY * wanted:
        return _resampled(ground, given, settings, context, locked)
    options = {"locked": _rows(given, locked), "context": context, **settings.sample_options()}
    found = package().relax(ground.surface, given, changed, **options)
    missing = abs(len(found) - wanted)
    if missing and missing <= _FEW * np.count_nonzero(~_stays(given, found)):
        return package().relax(ground.surface, given, changed, count=wanted, **options)
    return found


def _classes_relaxed(
    ground: Ground,
    given: Any,
    changed: Ints,
    settings: Settings,
    context: Any,
    locked: Locked | None,
) -> Any:
    """Several classes where something has changed; anew where that is everywhere."""
    if len(changed) == len(ground.surface.faces) or not len(given):
        return sampled(ground, settings, context, locked)
    if locked is None and _stranded(ground, given) > _STRANDED:
        return sampled(ground, settings, context)
    options = settings.sample_options()
    options["tolerance"] = max(options.get("tolerance", 0.0), _ROUGH)
    return package().relax(
        ground.surface,
        given,
        changed,
        classes=classes_of(ground, settings, wanted_counts(ground, settings)),
        free_counts=True,
        locked=_rows(given, locked),
        context=context,
        **options,
    )


def _with_counts(
    ground: Ground, given: Any, settings: Settings, context: Any, locked: Locked | None
) -> Any:
    """Several classes, each with its count and even over the whole surface."""
    return package().relax(
        ground.surface,
        given,
        [],
        classes=classes_of(ground, settings, wanted_counts(ground, settings)),
        locked=_rows(given, locked),
        context=context,
        **settings.sample_options(),
    )


def _stranded(ground: Ground, given: Any) -> float:
    """Share of the points that are where the density is 0 now."""
    if not len(given):
        return 0.0
    return float((ground.corner_density()[given.faces] == 0.0).all(axis=1).mean())


def _off_nothing(
    ground: Ground, found: Any, settings: Settings, context: Any, locked: Locked | None
) -> Any:
    """The points without those where the density is 0, and others in their place; locked ones stay
    anywhere.
    """
    for _ in range(_TRIES):
        left = ground.density_at(found) == 0.0
        left[_rows(found, locked)] = False
        if not left.any():
            return found
        who = {"ids": found.ids[~left], "classes": found.classes[~left]}
        places = found.faces[~left], found.barycentric[~left]
        rest = package().Samples(ground.surface, *places, **who)
        found = _resampled(ground, rest, settings, context, locked)
    return found


def _coming(ground: Ground, given: Any, changed: Ints) -> float:
    """About how many more points the changed faces need to be as dense as all others."""
    corners = ground.surface.vertices[ground.surface.faces]
    sides = corners[:, 1:] - corners[:, :1]
    areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    capacities = areas * ground.corner_density().mean(axis=1)
    inside = np.count_nonzero(np.isin(given.faces, changed))
    capacity = float(capacities[changed].sum())
    rest = float(capacities.sum()) - capacity
    return capacity / rest * (len(given) - inside) - inside if rest > 0.0 else float(len(given))


def _touched(before: Before, arrays: SurfaceArrays, ground: Ground) -> Ints:
    """Faces at which points were placed, moved or removed by hand."""
    if before.touched is None or not len(before.touched):
        return np.empty(0, dtype=np.int32)
    places = before.touched @ arrays.matrix[:3, :3].T + arrays.matrix[:3, 3]
    return np.unique(package().project(ground.surface, places).faces).astype(np.int32)


def _evened_around(
    ground: Ground,
    given: Any,
    faces: Ints,
    settings: Settings,
    context: Any,
    locked: Locked | None,
) -> Any:
    """As many points as there are, even around these faces.

    Points come and go there first: neighbors alone would leave a ring where several were removed.
    Then as many go or come, if they are many among so many around that each gives way by little.
    """

    def relaxed(samples: Any, where: Ints, count: int | None, rows: Ints) -> Any:
        options = settings.sample_options()
        return package().relax(
            ground.surface, samples, where, count=count, locked=rows, context=context, **options
        )

    found = relaxed(given, faces, None, _rows(given, locked))
    spare = abs(len(found) - len(given))
    if not spare:
        return found
    away = _away(ground, found, faces)
    nearest = np.argsort(away)[: round(spare / _YIELDS) if spare > _HANDFUL else 0]
    reach = away[nearest].max(initial=0.0) + _RINGS * found.report.spacing
    stay = np.union1d(_rows(found, locked), np.flatnonzero(away > reach)).astype(np.int32)
    around = np.union1d(faces, found.faces[nearest]).astype(np.int32)
    return relaxed(found, around, len(given), stay)


def _away(ground: Ground, samples: Any, faces: Ints) -> Floats:
    """Distances (n,) of samples from the nearest of these faces."""
    middles = ground.surface.vertices[ground.surface.faces[faces]].mean(axis=1)
    ways = [np.linalg.norm(samples.positions - one, axis=1) for one in middles]
    found: Floats = np.min(ways, axis=0)
    return found


def _with_ids_of(given: Any, found: Any, ground: Ground) -> Any:
    """As many samples as before with the same ids: new ones take those of which went."""
    gone = np.setdiff1d(given.ids, found.ids)
    new = ~np.isin(found.ids, given.ids)
    if not len(gone) or len(gone) != new.sum():
        return found
    ids = found.ids.copy()
    ids[new] = gone
    places = (found.faces, found.barycentric)
    return package().Samples(ground.surface, *places, ids=ids, classes=found.classes)


def _resampled(
    ground: Ground, given: Any, settings: Settings, context: Any, locked: Locked | None
) -> Any:
    """All points made even, as many as there have to be; none of them stays but the locked ones."""
    options, wanted = settings.sample_options(), _wanted(ground, settings)
    rows = _rows(given, locked)
    return package().resample(
        ground.surface, given, wanted, locked=rows, context=context, **options
    )


def _wanted(ground: Ground, settings: Settings) -> int:
    """Points of one class."""
    return wanted_counts(ground, settings)[0]


def _rows(samples: Any, locked: Locked | None) -> Ints:
    """Rows of the samples that are locked."""
    ids = np.empty(0, dtype=np.int32) if locked is None else locked.ids
    return np.flatnonzero(np.isin(samples.ids, ids)).astype(np.int32)


def _scattered(
    before: Before,
    arrays: SurfaceArrays,
    ground: Ground,
    given: Any,
    fine: Any,
    settings: Settings,
    locked: Locked | None,
) -> Scattered:
    """What is stored of the samples; those that stay keep all that they had."""
    samples = ground.to_original(fine)
    old, stays = _old_rows(given, fine), _stays(given, fine)
    columns = point_columns(samples.ids, samples.classes, settings.seed)
    columns["dapple_locked"][_rows(samples, locked)] = True
    columns["dapple_density"] = shares(ground, ground.density_at(fine))
    sized = shrunk(settings, ground.surface)
    columns["dapple_room"] = rooms(fine.positions, samples.classes, sized)
    new = own_random(settings.seed, samples.ids, 4)
    columns["dapple_rank"] = np.where(old < 0, new, before.columns["dapple_rank"][old])
    binding = _with_directions(before.binding, binding_of(samples, arrays), old, stays, arrays)
    binding = pointing(binding, arrays, settings.forward)
    report = replace(
        report_of(fine.report).of_ids(samples.ids),
        count=len(samples),
        measured=False,
        doubled_faces=ground.original.doubled_faces,
    )
    solved, capacity = Solved(arrays, ground, fine), float(ground.surface.capacity)
    positions = np.asarray(samples.positions)
    return Scattered(positions, binding, columns, report, Details(), settings, capacity, solved)


def _old_rows(given: Any, found: Any) -> Ints:
    """Rows (n,) that samples had before; -1 for new ones."""
    order = np.argsort(given.ids)
    place = np.searchsorted(given.ids, found.ids, sorter=order)
    rows = order[np.minimum(place, len(order) - 1)] if len(order) else np.zeros(len(found), int)
    there = given.ids[rows] == found.ids if len(order) else np.zeros(len(found), bool)
    return np.where(there, rows, -1).astype(np.int32)


def _stays(given: Any, found: Any) -> NDArray[np.bool_]:
    """Which samples (n,) are where they were."""
    rows = _old_rows(given, found)
    there = rows >= 0
    there[there] = (found.positions[there] == given.positions[rows[there]]).all(axis=1)
    return there


def _with_directions(
    before: Binding, after: Binding, old: Ints, stays: NDArray[np.bool_], arrays: SurfaceArrays
) -> Binding:
    """The binding of points that stay is what it was; others keep directions as they slide."""
    found = after.with_rows(stays, before.rows_at(old[stays]))
    slid = (old >= 0) & ~stays
    if slid.any():
        was, now = before.rows_at(old[slid]), found.rows_at(slid)
        normals = shading(arrays, _around([was, now], arrays))
        found = found.with_rows(slid, carried(was, now, arrays.vertices, normals))
    return found


def _around(bindings: list[Binding], arrays: SurfaceArrays) -> Ints:
    """The faces that the normals at bound points depend on."""
    used = np.zeros(len(arrays.vertices), dtype=bool)
    for binding in bindings:
        used[binding.corners] = True
    found: Ints = arrays.faces[used[arrays.faces].any(axis=1)]
    return found
