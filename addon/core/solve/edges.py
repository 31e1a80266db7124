# SPDX-License-Identifier: GPL-3.0-or-later
"""Points along edges of a surface: creases, borders, marked edges."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..base.errors import ScatterError
from ..base.native import package
from ..density.counts import MOST_POINTS, class_counts
from ..density.masked_surface import MaskedSurface
from ..settings.edge_table import KINDS
from ..settings.tables import SCATTER
from ..settings.values import MARKED, Settings, marks_of
from ..surface.arrays import Floats, Ints, SurfaceArrays, normals_of
from ..surface.binding import binding_of
from ..surface.frames import frames, shading
from ..surface.records import Binding

_PROBES = 2000  # points at which the density along the edges is averaged
_ON_EDGE = 1e-9  # largest weight of the corner opposite to the edge that a point is on
_OPPOSITE = -0.99  # cosine of normals whose mean has no direction


def sampled_on_edges(
    masked: MaskedSurface, arrays: SurfaceArrays, settings: Settings, context: Any
) -> Any:
    """dapple.LineSamples along the edges that the settings ask for.

    Raises:
        ScatterError: no kind of edge is chosen, there is none of them, or an object type has a
            density of its own.
    """
    _check(settings)
    options = _options(masked, arrays, settings)
    corners = settings.edge_corners
    spacing = {"line_spacing": settings.edge_spacing.lower(), "corners": corners}
    try:
        count = _count(masked, settings, options)
        return package().sample_lines(
            masked.surface, count, seed=settings.seed, context=context, **options, **spacing
        )
    except ValueError as error:
        if "has no lines" not in str(error):
            raise
        raise ScatterError(
            f"Surface '{arrays.name}' has no such edges: {_listed(settings)}"
        ) from error


def counts_on_edges(count: int, settings: Settings) -> list[int]:
    """Points of each object type among so many; one number if there are none."""
    return class_counts(replace(settings, count=count)) or [count]


def dealt(counts: list[int]) -> Ints:
    """Classes (n,) of points in a row: as many as asked for, each class spread evenly over it."""
    kinds = np.repeat(np.arange(len(counts), dtype=np.int32), counts)
    places = np.concatenate([(np.arange(count) + 0.5) / max(count, 1) for count in counts])
    return kinds[np.argsort(places, kind="stable")]


def bound_on_edges(samples: Any, tangents: Floats, surface: SurfaceArrays) -> Binding:
    """Binding of dapple.Samples on edges, whose X axis is the tangent (n, 3).

    Z is the mean of the normals of the faces on both sides. For this, the three corners that a
    point is bound to are the ends a and b of its edge in one face and the nearer end once more in
    the other face: with the weights w_a - 1/2, w_b and 1/2, where a is the nearer one, both faces
    have a share of 1/2, and the place is w_a a + w_b b.
    """
    binding = binding_of(samples, surface)
    start, end, on_edge = _edge_ends(binding, tangents, surface)
    binding = _turned_along(binding, tangents, surface)
    other = _other_faces(binding, samples.faces, start, end, surface)
    own, beyond = (
        normals_of(surface.vertices[surface.faces[faces]]) for faces in (samples.faces, other)
    )
    cosines = np.einsum("nd,nd->n", own, beyond)
    rows = np.flatnonzero(on_edge & (other >= 0) & (cosines > _OPPOSITE)).astype(np.int32)
    return binding.with_rows(rows, _between(binding, rows, (start, end), other, surface))


def _check(settings: Settings) -> None:
    if not any(getattr(settings, name) for name in KINDS):
        labels = ", ".join(_labels(KINDS))
        raise ScatterError(f"No kind of edge is chosen to scatter on: turn on one of {labels}")
    for number, kind in enumerate(settings.object_types, start=1):
        if kind.density:
            raise ScatterError(
                f"Object type {number} has a density of its own, '{kind.density}', which points on "
                "edges cannot follow: clear it, or use two scatters"
            )


def _listed(settings: Settings) -> str:
    text = ", ".join(_labels(name for name in KINDS if getattr(settings, name)))
    if settings.edge_creases:
        text += f" (Crease Angle is {math.degrees(settings.edge_angle):.3g} degrees)"
    return text


def _labels(names: Any) -> list[str]:
    labels = {setting.name: setting.label for setting in SCATTER}
    return [labels[name] for name in names]


def _options(masked: MaskedSurface, arrays: SurfaceArrays, settings: Settings) -> dict[str, Any]:
    """Options of dapple.sample_lines that say which lines there are."""
    angle = math.degrees(settings.edge_angle) if settings.edge_creases else 180.0
    found: dict[str, Any] = {"feature_angle": min(angle, 180.0), "borders": settings.edge_borders}
    if marks_of(settings):
        found["edges"] = _marked_edges(masked, arrays)
    return found


def _marked_edges(masked: MaskedSurface, arrays: SurfaceArrays) -> Ints:
    """Vertices (k, 2) of marked edges, on the faces as they were cut for the density."""
    values = arrays.weights[MARKED].astype(np.int64)  # 1 + the other end, at corners: (m, 3)
    others = np.roll(arrays.faces, -1, axis=1)
    # The edge after a corner is that to the next one of the triangle, or, if the polygon's corners
    # run the other way, to the one before it; an edge that is no side of the triangle is neither.
    flags = _is_marked(arrays.faces, others, values)
    parents, corners = masked.pieces
    faces, found = np.asarray(masked.surface.faces), []
    for side in range(3):
        on_side = flags[parents, side, None] & (corners[:, :, (side + 2) % 3] == 0.0)
        for first, second in ((0, 1), (1, 2), (2, 0)):
            both = on_side[:, first] & on_side[:, second]
            found.append(faces[both][:, [first, second]])
    return np.unique(np.sort(np.concatenate(found), axis=1), axis=0).astype(np.int32)


def _is_marked(faces: Ints, others: Ints, values: Any) -> NDArray[np.bool_]:
    """Whether the sides (m, 3) of triangles, from each corner to the next one, are marked."""
    after, before = values == others + 1, np.roll(values, -1, axis=1) == faces + 1
    found: NDArray[np.bool_] = after | before
    return found


def _count(masked: MaskedSurface, settings: Settings, options: dict[str, Any]) -> int:
    """The number of points; for points per area, at the distances that these have on a surface."""
    if not settings.per_area:
        return sum(counts_on_edges(settings.count, settings))
    distance = math.sqrt(2.0 / (math.sqrt(3.0) * settings.per_area))
    uniform = masked.surface.with_density(None)
    probes = package().sample_lines(uniform, _PROBES, **options)
    length = float(probes.lengths.sum() * masked.density_at(probes.samples).mean())
    count = round(length / distance)
    if count > MOST_POINTS:
        raise ScatterError(
            f"{settings.per_area:g} points per area are {count:,} points on these edges: at most "
            f"{MOST_POINTS:,} are possible"
        )
    return sum(counts_on_edges(max(count, 1), settings))


def _turned_along(binding: Binding, tangents: Floats, surface: SurfaceArrays) -> Binding:
    local = frames(binding, surface.vertices, shading(surface))
    return replace(binding, angle=local.angle(tangents))


def _edge_ends(
    binding: Binding, tangents: Floats, surface: SurfaceArrays
) -> tuple[Ints, Ints, NDArray[np.bool_]]:
    """The corners (n,), 0 to 2, at which the edges of points start and end, along the tangents, and
    whether there is an edge.
    """
    corners = surface.vertices[binding.corners]
    sides = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)  # opposite to each corner
    lengths = np.maximum(np.linalg.norm(sides, axis=2), 1e-300)
    along = np.einsum("nkd,nd->nk", sides, tangents) / lengths
    fits = np.where(binding.barycentric <= _ON_EDGE, np.abs(along), -1.0)
    side = fits.argmax(axis=1)
    rows = np.arange(len(side))
    forward = along[rows, side] >= 0.0
    first, second = (side + 1) % 3, (side + 2) % 3
    start, end = np.where(forward, first, second), np.where(forward, second, first)
    return start.astype(np.int32), end.astype(np.int32), fits[rows, side] >= 0.0


def _other_faces(
    binding: Binding, faces: Ints, start: Ints, end: Ints, surface: SurfaceArrays
) -> Ints:
    """The face (n,) on the other side of each point's edge; -1 at a border."""
    rows, total = np.arange(len(faces)), len(surface.vertices)
    ends = np.stack([binding.corners[rows, start], binding.corners[rows, end]], axis=1)
    sides = np.stack([surface.faces, np.roll(surface.faces, -1, axis=1)], axis=2).reshape(-1, 2)
    keys, wanted = (
        one.min(axis=1).astype(np.int64) * total + one.max(axis=1) for one in (sides, ends)
    )
    order = np.argsort(keys, kind="stable")
    begin, after = (np.searchsorted(keys[order], wanted, side=side) for side in ("left", "right"))
    found = np.full(len(faces), -1, dtype=np.int32)
    for step in (0, 1):  # one of the first two faces is not the point's own
        there = begin + step < after
        face = (order[np.minimum(begin + step, len(order) - 1)] // 3).astype(np.int32)
        found = np.where((found < 0) & there & (face != faces), face, found)
    return found.astype(np.int32)


def _between(
    binding: Binding, rows: Ints, ends: tuple[Ints, Ints], other: Ints, surface: SurfaceArrays
) -> Binding:
    """Binding of some points to both faces of their edge."""
    start, end, other = ends[0][rows], ends[1][rows], other[rows]
    own = binding.rows_at(rows)
    each = np.arange(len(rows))
    first, second = own.corners[each, start], own.corners[each, end]
    weights = own.barycentric[each, start], own.barycentric[each, end]
    total = weights[0] + weights[1]
    share = weights[0] / total
    is_first = share >= 0.5
    near = np.where(is_first, first, second)
    there = (surface.faces[other] == near[:, None]).argmax(axis=1)
    loops = surface.face_corners[other, there]
    return Binding(
        np.stack([first, second, near], axis=1),
        np.stack(
            [share - 0.5 * is_first, 1.0 - share - 0.5 * ~is_first, np.full(len(rows), 0.5)], axis=1
        ),
        np.zeros(len(rows)),
        np.stack([own.loops[each, start], own.loops[each, end], loops], axis=1),
    )
