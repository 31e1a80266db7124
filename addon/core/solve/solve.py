# SPDX-License-Identifier: GPL-3.0-or-later
"""One frame solved: calls of the native package with arrays, results as bindings."""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.errors import ScatterError
from ..base.native import named, package
from ..density.counts import shrunk
from ..density.masked_surface import MaskedSurface, masked_surface_of, shares
from ..settings.values import Settings
from ..surface.arrays import Floats, Ints, SurfaceArrays
from ..surface.binding import binding_of, bound_nearest
from ..surface.frames import carried, frames, pointing, shading
from ..surface.records import Binding, Columns, own_random, unbound
from .class_counts import clearances, sampled
from .edges import bound_on_edges, counts_on_edges, dealt, sampled_on_edges
from .figures import Details, details_of
from .locked import Locked, kept_ids, rows_of
from .small_parts import small_parts
from .symmetric import on_original, paired_ranks, sampled_in_pairs

_AT_BORDER = 0.5  # length of the direction away from neighbors at a straight border


@dataclass(frozen=True)
class Report:
    """Figures of a result that the panel shows."""

    count: int = 0
    spacing: float = 0.0
    alpha_min: float = 0.0
    alpha_mean: float = 0.0
    capacity_variation: float = 0.0
    whole_count_variation: float = 0.0  # share caused by integer counts on separate parts
    thin_share: float = 0.0  # share of the points on parts thinner than the spacing
    doubled_faces: int = 0  # faces of the surface that do not count
    small_parts: int = 0  # parts of the surface that are too small for a whole point
    evaluations: int = 0
    milliseconds: float = 0.0
    converged: bool = False
    key_error_max: float = 0.0  # error on frames without a keyframe, in spacings; see keys.py
    key_error_mean: float = 0.0
    worst_overlap: float = 0.0  # largest overlap of instances with radii; 0 if none overlap
    overlap_first: int = -1  # ids of these two points
    overlap_second: int = -1
    overlap_frame: int = 0  # the frame of a bake with this overlap
    overlap_between: bool = False  # whether that frame is no keyframe
    type_overlaps: str = ""  # of each object type in a bake; see overlaps.py
    measured: bool = True  # whether spacing and areas belong to the current points

    def of_ids(self, ids: Ints) -> "Report":
        """The report with ids instead of the rows that the native package returns."""
        rows = (self.overlap_first, self.overlap_second)
        first, second = (int(ids[row]) if 0 <= row < len(ids) else -1 for row in rows)
        return replace(self, overlap_first=first, overlap_second=second)


@dataclass(frozen=True)
class Scattered:
    """A solved scatter, ready to be stored."""

    positions: Floats
    binding: Binding
    columns: Columns  # named as in POINT_ATTRIBUTES, ADDED_ATTRIBUTES and MIRROR_ATTRIBUTES
    report: Report
    details: Details = field(default_factory=Details)
    settings: Settings = field(default_factory=Settings)  # that it was solved with
    capacity: float = 0.0  # integral of the density over the surface
    solved: "Solved | None" = None  # input of the next incremental solution


@dataclass(frozen=True)
class Solved:
    """A solution as objects of the native package."""

    arrays: SurfaceArrays
    masked: MaskedSurface
    samples: Any  # dapple.Samples of the ground


def scatter(
    arrays: SurfaceArrays,
    settings: Settings,
    context: Any,
    locked: Locked | None = None,
    masked: MaskedSurface | None = None,
) -> Scattered:
    """Scatter points over the current surface, around locked ones, or along its edges. The surface
    with its density may be known.
    """
    if settings.on_edges:
        return _scatter_on_edges(arrays, settings, context, locked, masked)
    with named(arrays.name):
        masked = masked or masked_surface_of(arrays, settings)
        if settings.in_pairs:
            pairs = sampled_in_pairs(masked, arrays, settings, context, locked)
            fine, mirror = pairs.samples, pairs.mirror
            samples = on_original(masked, pairs, arrays, settings.symmetry)
        else:
            fine, mirror = sampled(masked, settings, context, locked), None
            samples = masked.to_original(fine)
        ranks = package().progressive_ranks(fine.positions, fine.classes)
    ids = samples.ids if locked is None else kept_ids(locked, samples.classes)
    columns = point_columns(ids, samples.classes, settings.seed)
    if locked is not None:
        columns["dapple_locked"][rows_of(locked, samples.classes)] = True
    if mirror is not None:
        columns["dapple_mirror"], ranks = ids[mirror], paired_ranks(ranks, mirror)
    density = masked.density_at(fine)
    columns["dapple_density"] = shares(masked, density)
    columns["dapple_rank"] = (ranks + 0.5) / max(len(ranks), 1)
    sized = shrunk(settings, masked.surface)
    columns["dapple_clearance"] = clearances(fine.positions, samples.classes, sized)
    binding = pointing(binding_of(samples, arrays), arrays, settings.forward)
    columns["dapple_apart"] = apart(fine.positions, binding, arrays)
    positions = np.asarray(samples.positions)
    report = replace(
        report_of(fine.report).of_ids(ids), doubled_faces=masked.original.doubled_faces
    )
    if report.whole_count_variation > 0.0:  # there are several parts
        report = replace(report, small_parts=len(small_parts(masked, len(ids))))
    details = details_of(fine, density)
    capacity, solved = float(masked.surface.capacity), Solved(arrays, masked, fine)
    return Scattered(positions, binding, columns, report, details, settings, capacity, solved)


def _scatter_on_edges(
    arrays: SurfaceArrays,
    settings: Settings,
    context: Any,
    locked: Locked | None,
    masked: MaskedSurface | None,
) -> Scattered:
    """Scatter points along edges.

    Raises:
        ScatterError: points are locked, or as sampled_on_edges.
    """
    if locked is not None:
        raise ScatterError(
            f"Points on edges cannot be locked ({len(locked.ids):,} are): unlock all"
        )
    with named(arrays.name):
        masked = masked or masked_surface_of(arrays, settings)
        lines = sampled_on_edges(masked, arrays, settings, context)
        fine, tangents = lines.samples, np.asarray(lines.tangents)
        classes = dealt(counts_on_edges(len(fine), settings))
        samples = masked.to_original(fine)
        ranks = package().progressive_ranks(fine.positions, classes)
    columns = point_columns(samples.ids, classes, settings.seed)
    if settings.align_to_edges:
        columns["dapple_turn"] = np.zeros(len(classes))
    columns["dapple_density"] = shares(masked, masked.density_at(fine))
    columns["dapple_rank"] = (ranks + 0.5) / max(len(ranks), 1)
    columns["dapple_clearance"] = clearances(fine.positions, classes, settings)
    binding = pointing(bound_on_edges(samples, tangents, arrays), arrays, settings.forward)
    columns["dapple_apart"] = apart(fine.positions, binding, arrays)
    report = replace(
        report_of(fine.report), converged=True, doubled_faces=masked.original.doubled_faces
    )
    positions, capacity = np.asarray(samples.positions), float(masked.surface.capacity)
    return Scattered(positions, binding, columns, report, Details(), settings, capacity)


def point_columns(ids: Ints, classes: Ints, seed: int) -> Columns:
    """Columns that depend on a point's id but not on its place."""
    return {
        "id": ids,
        "dapple_object_type": classes,
        "dapple_density": np.ones(len(ids)),
        "dapple_scale": own_random(seed, ids, 0),
        "dapple_turn": own_random(seed, ids, 1) * 2.0 * np.pi,
        "dapple_rank": own_random(seed, ids, 4),
        "dapple_clearance": np.zeros(len(ids)),
        "dapple_apart": np.zeros((len(ids), 3)),
        "dapple_locked": np.zeros(len(ids), dtype=bool),
    }


def apart(points: Floats, binding: Binding, surface: SurfaceArrays) -> Floats:
    """Directions (n, 3) away from the neighbors, in the axes of each point; 1 long at a border."""
    away = np.einsum(
        "nd,ndk->nk",
        package().away_from_neighbors(points),
        frames(binding, surface.vertices, shading(surface)).axes(binding.angle),
    )
    away[:, 2] = 0.0
    away /= np.maximum(np.linalg.norm(away, axis=1), _AT_BORDER)[:, None]
    found: Floats = away
    return found


def with_own_ids(columns: Columns, new: NDArray[np.bool_], seed: int) -> Columns:
    """Point columns in which new points have new ids."""
    first = int(np.max(columns["id"], initial=-1)) + 1
    ids = np.arange(first, first + int(new.sum()), dtype=np.int32)
    own = point_columns(ids, columns["dapple_object_type"][new], seed)
    joined = {name: values.copy() for name, values in columns.items()}
    for name, values in joined.items():
        values[new] = own[name]
    return joined


def nearest_binding(points: Floats, surface: SurfaceArrays) -> Binding:
    """Binding of points (n, 3) to the nearest places of a surface; errors name it."""
    with named(surface.name):
        return bound_nearest(points, surface)


def report_of(report: Any) -> Report:
    """The figures of a dapple.Report that are shown."""
    names = ("count", "spacing", "alpha_min", "alpha_mean", "capacity_variation", "evaluations")
    shown = {
        name: getattr(report, name) for name in (*names, "whole_count_variation", "thin_share")
    }
    first, second = report.overlapping
    return Report(
        milliseconds=1000.0 * report.seconds,
        converged=report.converged,
        worst_overlap=report.worst_overlap,
        overlap_first=first,
        overlap_second=second,
        **shown,
    )


@dataclass(frozen=True)
class Attached:
    """All points of a scatter, some of them edited by hand."""

    binding: Binding
    positions: Floats  # (n, 3) in world space, unchanged where not edited
    edited: Floats  # (k, 3) new and previous places of edited points


def attached(
    before: Binding,
    positions: Floats,
    placed: NDArray[np.bool_],
    surface: SurfaceArrays,
    forward: str = "NONE",
) -> Attached:
    """Attach the edited points, which are at positions (n, 3), to the nearest places of a surface.

    Points that were attached before keep their directions as far as the normals allow.
    """
    moved, places = placed & ~unbound(before), positions.copy()
    left, found = before.rows_at(moved), before
    if placed.any():
        nearest = nearest_binding(positions[placed], surface)
        found = found.with_rows(placed, nearest)
        places[placed] = nearest.positions(surface.vertices)
    if moved.any():
        now = carried(left, found.rows_at(moved), surface.vertices, shading(surface))
        found = found.with_rows(moved, now)
    if placed.any():
        found = found.with_rows(placed, pointing(found.rows_at(placed), surface, forward))
    edited = np.concatenate([places[placed], left.positions(surface.vertices)])
    return Attached(found, places, edited)
