# SPDX-License-Identifier: GPL-3.0-or-later
"""A bake with constant density: points appear where the surface grows and vanish where it shrinks.

Every point that ever exists has a row in every keyframe, in the order of appearance, so instances
keep their identity. `faded` of a row is 0 for a point that exists and 1 for one that does not exist
yet or any more. On frames without faces all points are faded out; when faces come back, new points
appear at the previous density.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..base.errors import ScatterError
from ..base.native import named, package
from ..density.masked_surface import MaskedSurface, masked_surface_of
from ..solve.class_counts import of_classes, sampled
from ..solve.solve import Report, point_columns, report_of
from ..surface.arrays import Floats, Ints, SurfaceArrays
from ..surface.binding import attached_to, faces_with_corners, samples_of
from ..surface.frames import carried, shading
from ..surface.records import Binding, Columns, Placed, joined
from .baker import Baker
from .disc_pushes import Places
from .sidecar import Solved
from .tilt import TiltTracker


@dataclass(frozen=True)
class Born:
    """Points that appear during a bake, at their first places."""

    binding: Binding  # their binding to the first topology
    positions: Floats  # (k, 3) in world space
    columns: Columns  # named as in POINT_ATTRIBUTES and ADDED_ATTRIBUTES


@dataclass(frozen=True)
class _FramePoints:
    """Points of a frame on its topology: first those that stay, then those that vanish."""

    ids: Ints
    classes: Ints
    faces: Ints
    barycentric: Floats
    fade: Floats


@dataclass
class PopulationBaker(Baker):
    """A baker whose points appear and vanish.

    The file of a frame stores the existing points instead of rows, and the state of the population;
    see dapple.Population.state.
    """

    at_seam = False  # the package maps the points to the new faces
    fade: int = 12  # frames in which a point fades in or out

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.start.settings.object_types:  # the package supports them on constant faces only
            self.reattach, self.remedy = False, "Set Population to Keep Count"
        self._chain.note(f"population, {self.fade}")
        self.ids = np.asarray(self.start.ids, dtype=np.int32)
        self._population: Any = None
        self._stands = 0  # number of frames that the population has processed
        self._masked_then: MaskedSurface | None = None  # surface of the last frame
        self._bound_then = self._laid_then = self.bound
        self._there_then: _FramePoints
        self._state: Columns = {}
        self._faces = np.zeros(0, dtype=np.int32)  # faces of all rows so far
        self._births: list[tuple[Binding, Floats, Ints]] = []  # bindings, positions and classes
        self._restarts = False  # whether the next frame follows frames without faces
        self._began: tuple[SurfaceArrays, _FramePoints] | None = None  # the last such frame

    def vanish(self, frame: SurfaceArrays) -> None:
        """Enter a frame without faces, and so without points."""
        self.fingerprint = self._chain.add(frame)
        nothing = np.zeros(0, dtype=np.int32)
        kept = Solved(Placed(nothing, attached_to(self.bound, nothing, np.zeros((0, 3)))), Report())
        self._keep(kept, self.first + self.done, self.fingerprint)
        faces = self._faces if len(self._faces) else np.zeros(len(self.ids), dtype=np.int32)
        rows = Placed(faces, self.last, np.ones(len(self.ids)))
        self.keyframes.add_empty(rows, self.bound, frame)
        self.reports.append(kept.report)
        self.topologies.append(frame.topology)
        self.is_empty = True
        if not len(self._faces):  # the initial points have not appeared yet
            self._stands = self.done

    def appear(self, bound: SurfaceArrays) -> None:
        """Continue when faces come back: new points appear on them."""
        self.is_empty = False
        if not len(self._faces):
            return
        bound = self._with_poses(replace(bound, rest_parts=self.bound.rest_parts))
        self._note_bound(bound)
        self.bound, self._restarts, self._shape = bound, True, None
        self.masked_surfaces.begin(bound)
        self._faces = np.full(len(self.ids), _largest_face(bound), dtype=np.int32)
        middle = np.full((len(self.ids), 3), 1.0 / 3.0)
        self.last, self.tilts = attached_to(bound, self._faces, middle), TiltTracker()
        self.topologies.append(bound.topology)

    def cross(self, before: SurfaceArrays, after: SurfaceArrays) -> None:
        """Bind all rows to the new topology, including those of points that do not exist."""
        super().cross(before, after)
        self._faces = faces_with_corners(self.last.corners, after.faces)

    def take(self) -> bool:
        """Read the frame from the sidecar; returns False if it has to be solved."""
        if self.sidecar is None:
            return False
        number = self.first + self.done
        kept = self.sidecar.load(number, self.fingerprint, None, self.bound)
        there = None if kept is None else _points_of(kept)
        if kept is None or there is None:
            return False
        self.taken += 1
        self._masked_then = None
        if self._restarts:
            self._population, self._stands = None, -1
        self._note(there, kept)
        return True

    def advance(self, context: Any) -> None:
        """Solve the frame."""
        with named(self.bound.name):
            samples, report = self._next(context)
            masked, vertices = self.masked_surfaces.now, self._now.vertices
            now = self.masked_surfaces.on_original(masked, samples, vertices)
        solved = _FramePoints(now.ids, now.classes, now.faces, now.barycentric, now.fade)
        there = self._whole_apart(solved)
        kept = self._kept(there, report_of(report), self._population.state)
        self._keep(kept, self.first + self.done, self.fingerprint)
        # Stored samples differ from the solved ones by rounding, so the population continues from
        # them.
        stays = there is solved and not self.masked_surfaces.now.is_cut
        self._stands = self.done + 1 if stays else -1
        self._masked_then = self.masked_surfaces.now
        self._note(there, kept)

    def _whole_apart(self, there: _FramePoints) -> _FramePoints:
        """The points, of which those that neither appear nor vanish do not overlap."""
        whole = np.flatnonzero(there.fade == 1.0)
        places = Places(np.asarray(there.faces, dtype=np.int32), there.barycentric)
        some = places.at(whole)
        pushed = self._apart(some, (there.ids[whole], there.classes[whole]))
        if pushed is some:
            return there
        places = places.changed(whole, pushed)
        return replace(there, faces=places.faces, barycentric=places.barycentric)

    def _kept(self, there: _FramePoints, report: Report, state: Columns) -> Solved:
        faces = np.asarray(there.faces, dtype=np.int32)
        binding = attached_to(self.bound, faces, there.barycentric)
        more = {**state, "ids": there.ids, "classes": there.classes}
        return Solved(Placed(faces, binding), report, bool(state["settled"]), more)

    def _note(self, there: _FramePoints, kept: Solved) -> None:
        """Store a finished frame."""
        self._there_then, self._state = there, kept.more
        self._bound_then, self._laid_then = self.bound, self.masked_surfaces.laid
        if self._restarts:
            self._restarts, self._began = False, (self.bound, there)
        self._add(Solved(self._rows(there), kept.report))

    def _next(self, context: Any) -> tuple[Any, Any]:
        """dapple.Samples of the next frame, and their dapple.Report."""
        if self._restarts:
            return self._restarted(context)
        samples = self._ready().advance(self._surface(), context=context)
        return samples, samples.report

    def _restarted(self, context: Any) -> tuple[Any, Any]:
        """New points at the previous density, all of which fade in."""
        surface = self._surface()
        density, first = float(self._state["densities"][0]), int(self._state["next_id"])
        count = max(1, round(density * surface.capacity))
        requested = replace(self.start.settings, count=count, per_area=0.0)
        requested = replace(requested, seed=requested.seed + first)
        found = sampled(self.masked_surfaces.now, requested, context)
        ids = np.arange(first, first + count, dtype=np.int32)
        masked = self.masked_surfaces.now  # as stored, like in a bake that is continued
        kept = masked.to_original(
            package().Samples(surface, found.faces, found.barycentric, ids=ids)
        )
        stored = package().Samples(masked.original, kept.faces, kept.barycentric, ids=ids)
        samples = masked.from_original(stored)
        self._population = self._population_of(self.masked_surfaces.now, samples)
        begun = {"fades": np.full(count, 1.0 / self.fade), "densities": np.array([density])}
        state = self._population.state | begun
        self._population.resume(surface, self._population.samples, state)
        return self._population.samples, found.report

    def _ready(self) -> Any:
        """The population at the last frame that is done."""
        if self._population is None:
            self._population = self._new_population()
        if self._stands < self.done:
            masked = self._masked_then or self.masked_surfaces.of(self._laid_then, self._bound_then)
            self._stands_on = masked
            there = masked.from_original(_samples(masked, self._there_then))
            surface = masked.surface.deformed(masked.vertices(self._vertices))
            who = {"ids": there.ids, "classes": there.classes}
            points = package().Samples(surface, there.faces, there.barycentric, **who)
            self._population.resume(surface, points, self._state)
            self._stands = self.done
        return self._population

    def _new_population(self) -> Any:
        """A population at the start of the bake or after frames without faces."""
        if self._began is not None:
            bound, there = self._began
            masked = masked_surface_of(bound, self.start.settings)
            return self._population_of(masked, masked.from_original(_samples(masked, there)))
        masked, start = self.masked_surfaces.of(self.first_surface, self.first_surface), self.start
        samples = samples_of(self.begin, masked.original, start.ids, start.classes)
        if self._laid_then is self.first_surface:
            self._masked_then = masked
        self._stands_on = masked
        return self._population_of(masked, masked.from_original(samples))

    def _population_of(self, masked: MaskedSurface, samples: Any) -> Any:
        settings = self.start.settings
        options = settings.tracker_options() | of_classes(masked, samples, settings)
        return package().Population(masked.surface, samples, fade=self.fade, **options)

    def _surface(self) -> Any:
        """Vertices of the frame's surface, or a dapple.Surface if its faces have changed."""
        masked = self.masked_surfaces.now
        if masked is self._stands_on:
            return masked.vertices(self._now.vertices)
        self._stands_on = masked
        return masked.surface

    def born(self) -> Born | None:
        """The points that did not exist at the start."""
        first = len(self.start.ids)
        ids = self.ids[first:]
        if not len(ids):
            return None
        bindings, places, classes = zip(*self._births, strict=True)
        columns = point_columns(ids, np.concatenate(classes), self.start.settings.seed)
        return Born(joined(list(bindings)), np.concatenate(places), columns)

    def _rows(self, samples: Any) -> Placed:
        """The samples as rows: known ids at their own rows, followed by new ones."""
        order = {int(one): row for row, one in enumerate(self.ids)}
        new = np.array([one not in order for one in samples.ids.tolist()], dtype=bool)
        self._appear(samples, new)
        for one in self.ids[len(order) :].tolist():
            order[one] = len(order)
        rows = np.array([order[one] for one in samples.ids.tolist()], dtype=np.int64)
        faded = np.ones(len(self.ids))
        faces, weights = self._faces.copy(), self.last.barycentric.copy()
        faces[rows], weights[rows], faded[rows] = (
            samples.faces,
            samples.barycentric,
            1.0 - samples.fade,
        )
        self._faces = faces
        after = attached_to(self.bound, faces, weights)
        vertices, normals = self._now.vertices, shading(self._now, self.bound.faces)
        turned = carried(self.last, after, vertices, normals)
        return Placed(faces, turned, faded, self.tilts.next(self.last, turned, vertices, normals))

    @property
    def all_ids(self) -> Ints:
        """Ids of all rows of a frame."""
        return self.ids

    @property
    def classes(self) -> Ints:
        """Object types of all rows of a frame."""
        return np.concatenate([self.start.classes, *(born for _, _, born in self._births)])

    def _appear(self, samples: Any, new: Any) -> None:
        """Add rows for new ids at their first places."""
        if not len(self._faces):
            self._faces = _faces_at_start(samples, self.ids)
        if not new.any():
            return
        faces = np.asarray(samples.faces, dtype=np.int32)[new]
        binding = attached_to(self.bound, faces, np.asarray(samples.barycentric)[new])
        first = self.bound is self.first_surface
        stored = binding if first else _first_row(self.begin, len(faces))
        classes = np.asarray(samples.classes, dtype=np.int32)[new]
        self._births.append((stored, binding.positions(self._now.vertices), classes))
        self._faces = np.concatenate([self._faces, faces])
        self.ids = np.concatenate([self.ids, np.asarray(samples.ids, dtype=np.int32)[new]])
        self.last = joined([self.last, binding])


def _points_of(kept: Solved) -> _FramePoints | None:
    """The points of a stored frame, if it belongs to a population."""
    more, placed = kept.more, kept.placed
    for name, kind in {"ids": "i4", "classes": "i4", "fades": "f8"}.items():
        if name not in more or more[name].dtype != kind or more[name].shape != placed.faces.shape:
            return None
    weights = placed.binding.barycentric
    return _FramePoints(more["ids"], more["classes"], placed.faces, weights, more["fades"])


def _samples(masked: MaskedSurface, there: _FramePoints) -> Any:
    """dapple.Samples of the faces that were read."""
    who = {"ids": there.ids, "classes": there.classes}
    return package().Samples(masked.original, there.faces, there.barycentric, **who)


def _largest_face(surface: SurfaceArrays) -> int:
    a, b, c = (surface.vertices[surface.faces[:, k]] for k in range(3))
    return int(np.argmax(np.linalg.norm(np.cross(b - a, c - a), axis=1)))


def _first_row(binding: Binding, count: int) -> Binding:
    """Copies of the first row, for points of later topologies; they are never shown here."""
    return binding.rows_at(np.zeros(count, dtype=np.int64))


def _faces_at_start(samples: Any, ids: Ints) -> Ints:
    """Faces of the first rows in the first frame, in which every point still exists."""
    of = dict(zip(samples.ids.tolist(), samples.faces.tolist(), strict=True))
    missing = [one for one in ids.tolist() if one not in of]
    if missing:
        raise ScatterError(f"Point {missing[0]} vanished on the first frame: optimize the scatter")
    return np.array([of[one] for one in ids.tolist()], dtype=np.int32)
