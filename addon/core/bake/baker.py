# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake: points carried through the frames of a deforming surface, stored as keyframes.

Frames that a stopped bake has solved from the same input are read from its files. The tracker is
set to the last of them before the next frame is solved, so the result has the same bytes as a bake
without a stop.
"""

from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from ..base.errors import ScatterError
from ..base.native import named, package
from ..density.counts import values_of
from ..density.masked_surface import MaskedSurface
from ..settings.values import Settings
from ..solve.class_counts import resumed_on, tracked
from ..solve.small_parts import small_parts
from ..solve.solve import Report, report_of
from ..surface.arrays import REATTACH, Floats, Ints, SurfaceArrays, check_same_topology
from ..surface.binding import attached_to, rebound, samples_of
from ..surface.frames import carried, shading
from ..surface.records import Binding, Placed
from ..surface.rest import Shape, off_borders, rebound_at_rest
from .disc_pushes import Places, allowed_on, pushed_apart
from .keys import Baked, Keyframes
from .masked_surfaces import MaskedSurfaces
from .overlaps import Overlaps, discs_at
from .sidecar import Fingerprint, Sidecar, Solved
from .tilt import TiltTracker


@dataclass(frozen=True)
class Start:
    """The bound scatter that a bake starts from."""

    binding: Binding
    ids: Ints
    classes: Ints
    settings: Settings


@dataclass
class Baker:
    """Solves one frame after another: call enter(), then take() or advance(), until all are done.

    If changes() returns True, call cross() before enter().
    """

    remedy = REATTACH  # advice in the error about a changed topology
    at_seam = True  # bind again at the moment when the topology changes, between two frames
    is_empty = False  # whether the last frame had no faces and therefore no points

    bound: SurfaceArrays  # first frame of the current topology
    start: Start
    keyframes: Keyframes
    sidecar: Sidecar | None = None
    first: int = 1  # number of the first frame
    reattach: bool = False  # whether to bind again at a new topology; else an error
    follows: bool = False  # whether the density is evaluated in each frame
    fits: bool = False  # whether keyframes store the clearance of the points
    reports: list[Report] = field(default_factory=list)
    taken: int = 0  # frames read from the sidecar
    trouble: str = ""  # why frames cannot be stored in the sidecar
    fingerprint: str = ""  # fingerprint of all frames so far
    reoptimized_reason: str = ""  # why the points were optimized again first
    masked: MaskedSurface | None = None  # the first frame with its density, if it is known
    poses: dict[str, tuple[Floats, ...]] = field(default_factory=dict)  # by topology; see arrays.py

    def __post_init__(self) -> None:
        start = self.start
        first = self.bound
        read = [*first.weights.values(), *first.around.arrays(), *first.poses]
        self._chain = Fingerprint(start.settings, start.binding, (start.ids, start.classes, *read))
        self._now = self.bound
        self.begin, self.first_surface = start.binding, self.bound  # as the points are stored
        self.topologies = [self.bound.topology]
        self.last = start.binding
        self.tilts = TiltTracker()
        self._shape: Shape | None = None  # of the topology, where points are bound to its rest
        self._begin_samples: Any = None  # of the start, on the topology's faces
        self.tracker: Any = None
        self.masked_surfaces = MaskedSurfaces(self.bound, start.settings, self.masked)
        self._stands_on: Any = None  # the ground of the tracker
        self._begun = 0  # frames before the topology begins
        self._density_since = -1  # frames before the density is another
        self._tracked = 0  # number of frames that the tracker has processed
        self._overlaps: Overlaps | None = None  # where object types have a radius
        if any(kind.radius > 0.0 for kind in start.settings.object_types):
            self._overlaps = Overlaps(len(start.settings.object_types))
            self.keyframes.played = partial(self._note_overlaps, between=True)
        self._solved: Solved  # the last frame that is done, and its vertices
        self._vertices: Floats

    @property
    def done(self) -> int:
        """Number of frames that are solved or held back until more frames follow."""
        return len(self.reports)

    @property
    def share(self) -> tuple[float, float]:
        """Progress of the bake before and after the next frame, in [0, 1]."""
        return self.done / self.keyframes.count, (self.done + 1) / self.keyframes.count

    def changes(self, frame: SurfaceArrays) -> bool:
        """Whether the next frame has a different topology; ScatterError if that is not allowed."""
        if not self.reattach:
            check_same_topology(self.bound, frame, f"frame {self.first + self.done}", self.remedy)
        return frame.topology != self.bound.topology

    def cross(self, before: SurfaceArrays, after: SurfaceArrays) -> None:
        """Bind to a new topology: to the nearest places, or to the same places of the rest shape.

        Both arguments are the surface, just before and just after the change. They are whole frames
        if at_seam is off, and any moments if there is a rest shape.
        """
        after = self._with_poses(after)
        before = replace(before, faces=self.bound.faces, loops=self.bound.loops)
        last, tilts, self.tilts = self.last, self.tilts, TiltTracker()
        if after.rest is None:
            with named(after.name):
                self.last = rebound(last, before, after)
            if self.at_seam:
                tilts.cross(last, before, self.last, after)
                self.tilts = tilts
        else:
            after = replace(after, rest_parts=self.bound.rest_parts)
            before = replace(self.bound, vertices=before.vertices, normals=before.normals)
            self.last = rebound_at_rest(last, before, after)
        self._chain.add(before)
        self._note_bound(after)
        self.start = replace(self.start, binding=self.last)
        self.bound, self._tracked, self._shape, self._begin_samples = after, self.done, None, None
        self.masked_surfaces.begin(after)
        self._begun = self._density_since = self.done
        self.topologies.append(after.topology)

    def _with_poses(self, bound: SurfaceArrays) -> SurfaceArrays:
        return replace(bound, poses=self.poses.get(bound.topology, ()))

    def _note_bound(self, bound: SurfaceArrays) -> None:
        """Add a new topology to the fingerprint."""
        self._chain.add(bound)
        for array in (*bound.weights.values(), *bound.around.arrays(), *bound.poses):
            self._chain.note_array(array)

    @property
    def now(self) -> SurfaceArrays:
        """The surface of the frame that was entered last."""
        return self._now

    def enter(self, frame: SurfaceArrays) -> None:
        """Enter the next frame."""
        check_same_topology(self.bound, frame, f"frame {self.first + self.done}")
        self._now = frame
        self.fingerprint = self._chain.add(frame)
        if self.follows:
            laid = self.masked_surfaces.laid
            for array in self.masked_surfaces.follow(frame):
                self._chain.note_array(array)
            if laid is not self.masked_surfaces.laid:
                self._density_since = self.done
                self._chain.note("followed")
                self.fingerprint = self._chain.now()

    def vanish(self, frame: SurfaceArrays) -> None:
        """Enter a frame without faces. Only PopulationBaker can continue after it."""
        raise ScatterError(f"Surface '{frame.name}' has no faces at frame {frame.time:g}")

    def appear(self, bound: SurfaceArrays) -> None:
        """Continue when faces come back after frames without any."""

    def take(self) -> bool:
        """Read the frame from the sidecar; returns False if it has to be solved."""
        if self.sidecar is None:
            return False
        number, points = self.first + self.done, len(self.start.ids)
        solved = self.sidecar.load(number, self.fingerprint, points, self.bound)
        if solved is None:
            return False
        self.taken += 1
        self._add(solved)
        return True

    def advance(self, context: Any) -> None:
        """Solve the frame."""
        with named(self.bound.name):
            tracker, masked = self._ready_tracker()
            samples = tracker.advance(masked.vertices(self._now.vertices), context=context)
        # Stored samples differ from the solved ones by rounding, so the tracker continues from
        # them.
        there = self.masked_surfaces.on_original(masked, samples, self._now.vertices)
        solved = self._solved_of(there, tracker.settled)
        stays = np.array_equal(solved.placed.binding.barycentric, there.barycentric)
        self._tracked = self.done + 1 if stays and not masked.is_cut else -1
        self._keep(solved, self.first + self.done, self.fingerprint)
        self._add(solved)

    def finish(self, context: Any) -> None:
        """Solve the frames that are still held back at the end of a topology."""

    def report(self) -> Report:
        """The worst spacing, variation and overlap of all frames, and the mean cost of a frame."""
        every = self.reports
        reports = [report for report in every if report.count] or every
        count = max(len(reports), 1)
        return replace(
            reports[-1],
            **self._overlap_figures(),
            alpha_min=min(report.alpha_min for report in reports),
            alpha_mean=sum(report.alpha_mean for report in reports) / count,
            capacity_variation=max(report.capacity_variation for report in reports),
            whole_count_variation=max(report.whole_count_variation for report in reports),
            thin_share=max(report.thin_share for report in reports),
            small_parts=self._small_parts(),
            evaluations=round(sum(report.evaluations for report in reports) / count),
            milliseconds=sum(report.milliseconds for report in reports) / count,
            converged=all(report.converged for report in reports),
            key_error_max=self.keyframes.error.largest,
            key_error_mean=self.keyframes.error.mean,
        )

    def _overlap_figures(self) -> dict[str, Any]:
        """The figures of the report that tell where discs overlap."""
        if self._overlaps is None:
            return {}
        largest = self._overlaps.largest
        first, second = largest.ids
        return {
            "worst_overlap": largest.share,
            "overlap_first": first,
            "overlap_second": second,
            "overlap_frame": largest.frame,
            "overlap_between": largest.between,
            "type_overlaps": self._overlaps.text(),
        }

    def _small_parts(self) -> int:
        count = max(report.count for report in self.reports)
        several = any(report.whole_count_variation > 0.0 for report in self.reports)
        return len(small_parts(self.masked_surfaces.first, count)) if several else 0

    def baked(self) -> Baked:
        """The keyframes of all frames."""
        return self.keyframes.packed()

    def _ready_tracker(self) -> tuple[Any, Any]:
        """The tracker at the last frame that is done, and its surface."""
        if self.tracker is None:
            self.tracker = self._new_tracker()
        masked = self.masked_surfaces.now
        if masked is not self._stands_on:
            self._go_over_to(masked)
        if self._tracked < self.done and self._density_since < self.done:
            vertices = masked.vertices(self._vertices)
            samples = self._there(masked, self._solved)
            self.tracker.resume(vertices, samples, settled=self._solved.settled)
        self._tracked = self.done
        return self.tracker, masked

    @property
    def _topology_begins(self) -> bool:
        """Whether the next frame is the first one after a change of the faces."""
        return self.done == self._begun and self.bound is not self.first_surface

    def _new_tracker(self) -> Any:
        """A tracker at the start of the bake, which defines the evenness of all frames."""
        start = self.start
        masked = self.masked_surfaces.of(self.first_surface, self.first_surface)
        samples = samples_of(self.begin, masked.original, start.ids, start.classes)
        self._stands_on = masked
        return tracked(masked, masked.from_original(samples), start.settings)

    def _begin(self) -> Any:
        """Samples on the surface at the start of the topology."""
        self._stands_on = self.masked_surfaces.first
        return self._started(self._stands_on)

    def _started(self, masked: Any) -> Any:
        """Samples at the start of the topology, on a surface with its faces."""
        start = self.start
        if self._begin_samples is None:
            original = self.masked_surfaces.first.original
            who = (start.ids, start.classes)
            self._begin_samples = samples_of(start.binding, original, *who)
        return masked.from_original(self._begin_samples)

    def _go_over_to(self, masked: Any) -> None:
        """Move the tracker to another surface, at the last frame."""
        samples = started = self._started(masked)
        vertices = self.bound.vertices
        if self.done > self._begun:
            samples, vertices = self._there(masked, self._solved), self._vertices
        settings = self.start.settings
        crossed = self._topology_begins
        resumed_on(self.tracker, masked, vertices, (samples, started), settings, crossed)
        self._stands_on = masked

    def _solved_of(self, samples: Any, settled: bool) -> Solved:
        """Samples of the frame, with the directions carried over from the last frame."""
        vertices, normals = self._now.vertices, shading(self._now, self.bound.faces)
        places = Places(np.asarray(samples.faces, dtype=np.int32), samples.barycentric)
        placed = self._placed_at(self._apart(places, (self.all_ids, self.classes)))
        turned = carried(self.last, placed.binding, vertices, normals)
        tilt = self.tilts.next(self.last, turned, vertices, normals)
        doubled = self.masked_surfaces.first.original.doubled_faces
        report = replace(report_of(samples.report), doubled_faces=doubled)
        return Solved(Placed(placed.faces, turned, tilt=tilt), report, settled)

    def _placed_at(self, places: Places) -> Placed:
        return Placed(places.faces, attached_to(self.bound, places.faces, places.barycentric))

    def _apart(self, places: Places, who: tuple[Ints, Ints]) -> Places:
        """Places of points, with these ids and types, where their discs do not overlap."""
        if self._overlaps is None:
            return places
        masked, vertices, placed = self._stands_on, self._now.vertices, self._placed_at(places)
        points = placed.binding.positions(vertices)
        discs = discs_at(points, placed, vertices, self.masked_surfaces.radii, who)
        allowed = allowed_on(masked, who[1], values_of(self.start.settings))
        return pushed_apart(discs, places, lambda: masked.original.deformed(vertices), allowed)

    def _there(self, masked: Any, solved: Solved) -> Any:
        """Exactly the samples of a solved frame, on a surface."""
        placed, start = solved.placed, self.start
        weights = placed.binding.barycentric
        samples = package().Samples(
            masked.original, placed.faces, weights, ids=start.ids, classes=start.classes
        )
        return masked.from_original(samples)

    def _keep(self, solved: Solved, number: int, fingerprint: str, *, ahead: bool = False) -> None:
        """Store a frame so that a stopped bake can continue from it."""
        if self.sidecar is None:
            return
        try:
            self.sidecar.store(number, fingerprint, solved, ahead=ahead)
        except OSError as error:
            self.trouble = f"Frames cannot be kept in '{self.sidecar.folder}': {error.strerror}"
            self.sidecar = None

    def _distinct(self, placed: Placed) -> Placed:
        """The points, moved slightly off the borders of their faces if there is a rest shape.

        ScatterError if a point moved to a place whose rest position is ambiguous.
        """
        if self.bound.rest is None:
            return placed
        placed = replace(placed, binding=off_borders(placed.binding, self.bound.rest))
        binding = placed.binding
        if placed.faded is not None:
            binding = binding.rows_at(placed.faded < 1.0)
        if self._shape is None:
            self._shape = Shape(self.bound)
        other = self._shape.elsewhere(binding, self._now.vertices)
        if other is not None:
            raise ScatterError(f"Frame {self.first + len(self.reports)}: {other}")
        return placed

    @property
    def all_ids(self) -> Ints:
        """Ids of all rows of a frame."""
        return self.start.ids

    @property
    def classes(self) -> Ints:
        """Object types of all rows of a frame."""
        return self.start.classes

    def _add(self, solved: Solved) -> None:
        placed = self._distinct(solved.placed)
        self._solved, self._vertices = solved, self._now.vertices
        self.last = solved.placed.binding
        self.reports.append(solved.report)
        spacing = solved.report.spacing
        normals = shading(self._now, self.bound.faces)
        self.tilts.add(solved.placed.tilt, self._vertices, normals, spacing)
        if self.fits:
            placed = self.masked_surfaces.with_clearance(placed, self._vertices, self.classes)
        self.keyframes.add(placed, self.bound, self._now, spacing)
        points = placed.binding.positions(self._vertices)
        self._note_overlaps(len(self.reports) - 1, points, placed, self._vertices)

    def _note_overlaps(
        self,
        frame: int,
        points: Floats,
        placed: Placed,
        vertices: Floats,
        *,
        between: bool = False,
    ) -> None:
        """Measure how far discs overlap in a frame, counted from 0."""
        if self._overlaps is not None:
            radii, who = self.masked_surfaces.radii, (self.all_ids, self.classes)
            discs = discs_at(points, placed, vertices, radii, who)
            self._overlaps.add(discs, self.first + frame, between=between)
