# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames that are solved together, so that motion is smooth in time and loops close.

They are solved in pieces, as in dapple3d.track_pieces: each piece begins before the previous one
ends, and the overlapping frames are solved again with the next piece. A piece also ends where the
topology changes. A piece of a stopped bake is used if it is complete: its finished frames and the
overlapping ones, from which the next piece continues.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

from ..base.native import named, package
from ..solve.class_counts import of_classes
from ..solve.solve import report_of
from ..surface.arrays import SurfaceArrays
from ..surface.binding import placed_of
from .baker import Baker
from .sidecar import Solved

PIECE, OVERLAP = 50, 12  # frames solved at once, and how many of them overlap the next piece
_READING = 0.2  # share of the progress for reading


class _Held(NamedTuple):
    """A frame that is not solved yet."""

    surface: SurfaceArrays
    fingerprint: str  # of all frames up to it


@dataclass
class WindowBaker(Baker):
    """Collects frames until a piece of them can be solved; finish() solves the rest."""

    closed: bool = False  # the last frame leads back to the first

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.closed:
            self.reattach, self.remedy = False, "Set Smoothing to Forward"
        self.held: list[_Held] = []
        self._ahead: list[Solved] = []

    @property
    def done(self) -> int:
        """Number of frames that are collected or solved."""
        return len(self.reports) + len(self.held)

    @property
    def share(self) -> tuple[float, float]:
        """Progress of the bake before and after the next frame."""
        more = PIECE - OVERLAP if self._is_full(len(self.held) + 1) else 0
        return self._progress(), self._progress(1, more)

    def take(self) -> bool:
        """Whether nothing has to be solved now: the piece is not full, or was solved before."""
        self.held.append(_Held(self._now, self.fingerprint))
        return not self._is_full(len(self.held)) or self._take(PIECE, PIECE - OVERLAP)

    def advance(self, context: Any) -> None:
        """Solve the piece that this frame completes."""
        self._solve(PIECE, PIECE - OVERLAP, context)

    def finish(self, context: Any) -> None:
        """Read or solve all collected frames."""
        count = len(self.held)
        if count and not self._take(count, count):
            self._solve(count, count, context)

    def _is_full(self, count: int) -> bool:
        """Whether this many frames form a piece and at least a whole piece remains."""
        return count == 2 * PIECE - OVERLAP

    def _progress(self, read: int = 0, solved: int = 0) -> float:
        done = _READING * (self.done + read) + (1.0 - _READING) * (len(self.reports) + solved)
        return done / self.keyframes.count

    def _take(self, count: int, done: int) -> bool:
        """Read a piece from the sidecar; returns False if it has to be solved."""
        if self.sidecar is None:
            return False
        fingerprint, begin = self._piece(count, done), self.first + len(self.reports)
        points, bound = len(self.start.ids), self.bound
        found = []
        for k in range(count):
            solved = self.sidecar.load(begin + k, fingerprint, points, bound, ahead=k >= done)
            if solved is None:
                return False
            found.append(solved)
        for held, solved in zip(self.held[:done], found[:done], strict=True):
            self._now = held.surface
            self._add(solved)
        self.taken += done
        self._release(found[done:], done, fingerprint)
        return True

    def _solve(self, count: int, done: int, context: Any) -> None:
        """Solve a piece of `count` frames, of which the first `done` are final."""
        fingerprint, begin = self._piece(count, done), self.first + len(self.reports)
        samples = self._samples_on(count, done, context)
        bound, ahead = self.bound, samples[done:]
        left = [Solved(placed_of(one, bound), report_of(one.report)) for one in ahead]
        for k, solved in enumerate(left):  # the last written files complete the piece
            self._keep(solved, begin + done + k, fingerprint, ahead=True)
        for k in range(done):
            self._now = self.held[k].surface
            solved = self._solved_of(samples[k], settled=True)
            self._keep(solved, begin + k, fingerprint)
            self._add(solved)
        self._release(left, done, fingerprint)

    def _samples_on(self, count: int, done: int, context: Any) -> list[Any]:
        """Samples of the frames of a piece, on the original faces."""
        with named(self.bound.name):
            tracker, masked = self._ready_tracker()
            frames = [masked.vertices(one.surface.vertices) for one in self.held[:count]]
            found = tracker.advance(frames, done, context=context)
            surfaces = [one.surface.vertices for one in self.held[:count]]
            on_original = self.masked_surfaces.on_original
            return [on_original(masked, *one) for one in zip(found, surfaces, strict=True)]

    def _piece(self, count: int, done: int) -> str:
        """Fingerprint of a piece."""
        begin, closes = len(self.reports), self.closed and done == count
        return f"{self.held[count - 1].fingerprint} {begin} {done} {count} {closes}"

    def _release(self, ahead: list[Solved], done: int, fingerprint: str) -> None:
        """Remove finished frames from the collection."""
        self._ahead, self.fingerprint = ahead, fingerprint
        del self.held[:done]

    def cross(self, before: SurfaceArrays, after: SurfaceArrays) -> None:
        """Begin the next piece with a new tracker."""
        super().cross(before, after)
        self.tracker = None

    def _ready_tracker(self) -> tuple[Any, Any]:
        """The tracker at the last frame that is done, and its surface."""
        if self.tracker is None:
            self.tracker = self._new_tracker()
        masked = self.masked_surfaces.first  # animated inputs are not followed
        if self._tracked < len(self.reports):
            vertices = masked.vertices(self._vertices)
            ahead = [self._there(masked, one) for one in self._ahead]
            self.tracker.resume(vertices, self._there(masked, self._solved), ahead)
        return self.tracker, masked

    def _new_tracker(self) -> Any:
        samples, settings = self._begin(), self.start.settings
        masked = self.masked_surfaces.first
        options = settings.tracker_options() | of_classes(masked, samples, settings)
        options["stickiness"] = max(options["stickiness"], 1.0)
        return package().WindowTracker(masked.surface, samples, closed=self.closed, **options)
