# SPDX-License-Identifier: GPL-3.0-or-later
"""Keep Points: a solution that starts from the previous one, so that few points move.

If it is known what has changed, only the points near changes are relaxed and all others keep every
byte. If the count is exact, points must then appear or vanish elsewhere as well: they do so over
the whole surface. Without knowledge of the previous solution all points may move.
"""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.native import named, package
from ..density.counts import shrunk
from ..density.masked_surface import MaskedSurface, masked_surface_of, shares
from ..settings.values import Settings
from ..surface.arrays import Ints, SurfaceArrays
from ..surface.binding import binding_of, samples_of
from ..surface.frames import carried, pointing, shading
from ..surface.records import Binding, own_random
from .carried_points import SAME_PLACE, PreviousResult, carried_points, cut_alike, edited_faces
from .class_counts import clearances, wanted_counts
from .figures import Details, details_of
from .locked import Locked
from .relaxation import Relaxer, locked_rows, old_rows, staying
from .small_parts import small_parts
from .solve import Scattered, Solved, apart, point_columns, report_of

KEEPING = {"count", "per_area", "density", "forward"}  # settings that may have changed
_SPARE_POINTS, _SPARE = 2, 0.001  # tolerated deviation of points per area: absolute and relative
_EFFORT = ("evaluations", "milliseconds", "converged")  # figures that do not depend on the points
_OVERLAP = ("worst_overlap", "overlap_first", "overlap_second")


def keeps(settings: Settings, changed: list[str], same_faces: bool) -> bool:
    """Whether points can be kept: same faces, object types and seed. Points on edges are made anew,
    which is quick, and so are mirror images, which would not stay symmetric.
    """
    anew = settings.on_edges or settings.in_pairs
    return same_faces and not anew and KEEPING.issuperset(changed)


def kept(
    before: PreviousResult,
    arrays: SurfaceArrays,
    settings: Settings,
    context: Any,
    locked: Locked | None,
) -> Scattered:
    """Relax the points near changes.

    Their number may differ from the exact count: see is_whole. They are not measured.

    Raises:
        ScatterError: more points are locked than there should be.
    """
    arrays = cut_alike(before.solved, arrays)
    with named(arrays.name):
        like, like_arrays = None, None
        if before.solved:
            like, like_arrays = before.solved.masked, before.solved.arrays
        masked = masked_surface_of(arrays, settings, context, like, like_arrays=like_arrays)
        if locked is not None:
            locked.of_classes(wanted_counts(masked, settings))  # ScatterError if too many
        given, changed = carried_points(before, arrays, masked, settings)
        edited = edited_faces(before, arrays, masked)
        relaxer = Relaxer(masked, settings, context, locked)
        if len(edited) and not len(changed) and not settings.object_types:
            solved = relaxer.evened_around(given, edited)
            fine = _with_ids_of(given, solved, masked)
        else:
            changed = np.union1d(changed, edited).astype(np.int32)
            solved = fine = relaxer.relaxed(given, changed)
        found = _scattered(before, arrays, masked, given, fine, settings, locked)
        effort = {name: getattr(report_of(solved.report), name) for name in _EFFORT}
    return replace(found, report=replace(found.report, **effort))


def as_placed(solved: Solved, before: Ints, binding: Binding, ids: Ints, classes: Ints) -> Solved:
    """A solution of the points `before`, updated for points that were edited by hand.

    Points that were not edited keep everything that is known of them.
    """
    masked, coarse = solved.masked, solved.masked.to_original(solved.samples)
    found = samples_of(binding, masked.original, ids, classes)
    if not len(before) or not len(ids):
        return replace(solved, samples=masked.from_original(found))
    faces, weights = found.faces.copy(), found.barycentric.copy()
    order = np.argsort(before)
    rows = order[np.minimum(np.searchsorted(before, ids, sorter=order), len(order) - 1)]
    same = before[rows] == ids
    same &= np.abs(coarse.positions[rows] - found.positions).max(axis=1) <= SAME_PLACE * _extent(
        solved
    )
    faces[same], weights[same] = coarse.faces[rows[same]], coarse.barycentric[rows[same]]
    samples = package().Samples(masked.original, faces, weights, ids=ids, classes=classes)
    return replace(solved, samples=masked.from_original(samples))


def _extent(solved: Solved) -> float:
    return float(np.ptp(solved.arrays.vertices, axis=0).max(initial=0.0))


def is_whole(scattered: Scattered, before: PreviousResult | None = None) -> bool:
    """Whether the number of points is right: exactly, or approximately for points per area.

    For points per area, edits by hand may add or remove points.
    """
    solved, settings = scattered.solved, scattered.settings
    assert solved is not None
    if settings.per_area and before is not None and before.edited is not None:
        return True
    there = np.bincount(solved.samples.classes, minlength=max(len(settings.object_types), 1))
    for count, wanted in zip(there, wanted_counts(solved.masked, settings), strict=True):
        spare = max(_SPARE_POINTS, _SPARE * wanted) if settings.per_area else 0
        if abs(count - wanted) > spare:
            return False
    return True


def evened(before: Scattered, context: Any, locked: Locked | None) -> Scattered:
    """Correct the count and even out the points on the whole surface."""
    solved, settings = before.solved, before.settings
    assert solved is not None
    masked, arrays = solved.masked, solved.arrays
    with named(arrays.name):
        fine = Relaxer(masked, settings, context, locked).with_counts(solved.samples)
        stored = PreviousResult(before.binding, before.columns, solved)
        found = _scattered(stored, arrays, masked, solved.samples, fine, settings, locked)
    spent = before.report.milliseconds + found.report.milliseconds
    return replace(found, report=replace(found.report, milliseconds=spent))


def measured(scattered: Scattered, context: Any) -> Scattered:
    """The result with the figures of all points."""
    solved = scattered.solved
    assert solved is not None
    masked, samples = solved.masked, solved.samples
    with named(solved.arrays.name):
        weight = scattered.settings.capacity_weight
        found = report_of(
            package().analyze(masked.surface, samples, capacity_weight=weight, context=context)
        )
        density = masked.density_at(samples)
        gaps = details_of(samples, density).gaps
    effort = {name: getattr(scattered.report, name) for name in (*_EFFORT, *_OVERLAP)}
    few = len(small_parts(masked, len(samples))) if found.whole_count_variation > 0.0 else 0
    doubled = masked.original.doubled_faces
    report = replace(found, doubled_faces=doubled, small_parts=few, **effort)
    return replace(scattered, report=report, details=Details(gaps=gaps))


def _with_ids_of(given: Any, found: Any, masked: MaskedSurface) -> Any:
    """Samples with the previous ids; new points reuse the ids of removed ones."""
    gone = np.setdiff1d(given.ids, found.ids)
    new = ~np.isin(found.ids, given.ids)
    if not len(gone) or len(gone) != new.sum():
        return found
    ids = found.ids.copy()
    ids[new] = gone
    places = (found.faces, found.barycentric)
    return package().Samples(masked.surface, *places, ids=ids, classes=found.classes)


def _scattered(
    before: PreviousResult,
    arrays: SurfaceArrays,
    masked: MaskedSurface,
    given: Any,
    fine: Any,
    settings: Settings,
    locked: Locked | None,
) -> Scattered:
    """The columns of the samples; points that stay keep all of theirs."""
    samples = masked.to_original(fine)
    old, stays = old_rows(given, fine), staying(given, fine)
    columns = point_columns(samples.ids, samples.classes, settings.seed)
    columns["dapple_locked"][locked_rows(samples, locked)] = True
    columns["dapple_density"] = shares(masked, masked.density_at(fine))
    sized = shrunk(settings, masked.surface)
    columns["dapple_clearance"] = clearances(fine.positions, samples.classes, sized)
    new = own_random(settings.seed, samples.ids, 4)
    columns["dapple_rank"] = np.where(old < 0, new, before.columns["dapple_rank"][old])
    binding = _with_directions(before.binding, binding_of(samples, arrays), old, stays, arrays)
    binding = pointing(binding, arrays, settings.forward)
    columns["dapple_apart"] = apart(fine.positions, binding, arrays)
    report = replace(
        report_of(fine.report).of_ids(samples.ids),
        count=len(samples),
        measured=False,
        doubled_faces=masked.original.doubled_faces,
    )
    solved, capacity = Solved(arrays, masked, fine), float(masked.surface.capacity)
    positions = np.asarray(samples.positions)
    return Scattered(positions, binding, columns, report, Details(), settings, capacity, solved)


def _with_directions(
    before: Binding, after: Binding, old: Ints, stays: NDArray[np.bool_], arrays: SurfaceArrays
) -> Binding:
    """The binding; points that stay keep theirs, others keep their direction while they slide."""
    found = after.with_rows(stays, before.rows_at(old[stays]))
    slid = (old >= 0) & ~stays
    if slid.any():
        was, now = before.rows_at(old[slid]), found.rows_at(slid)
        around = _around([was, now], arrays) if arrays.normals is None else None
        normals = shading(arrays, around)
        found = found.with_rows(slid, carried(was, now, arrays.vertices, normals))
    return found


def _around(bindings: list[Binding], arrays: SurfaceArrays) -> Ints:
    """The faces that determine the normals at bound points."""
    used = np.zeros(len(arrays.vertices), dtype=bool)
    for binding in bindings:
        used[binding.corners] = True
    first, second, third = (used[corner] for corner in np.ascontiguousarray(arrays.faces.T))
    found: Ints = arrays.faces[first | second | third]
    return found
