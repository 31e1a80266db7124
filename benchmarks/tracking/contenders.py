# SPDX-License-Identifier: GPL-3.0-or-later
"""Ways to carry samples to the next frame, all with the same face."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import dapple3d as dapple
import numpy as np

from benchmarks.tracking.implicit import Array
from benchmarks.tracking.paper import minimize


@dataclass(frozen=True)
class Step:
    """The samples of a frame, and what they cost."""

    surface: dapple.Surface
    samples: dapple.Samples
    evaluations: int  # of the energy
    parts: int = 1  # that the frame was split into


class Contender(Protocol):
    """Goes from frame to frame."""

    def advance(self, vertices: Array) -> Step: ...


class Ride:
    """The samples stay on their faces: nothing is optimized."""

    def __init__(self, surface: dapple.Surface, samples: dapple.Samples) -> None:
        self.surface, self.samples = surface, samples

    def advance(self, vertices: Array) -> Step:
        self.surface = self.surface.deformed(vertices)
        self.samples = carried(self.surface, self.samples)
        return Step(self.surface, self.samples, 0)


class Paper:
    """The paper's way (5.4): each frame is minimized to the tolerance by plain L-BFGS, warm."""

    def __init__(self, surface: dapple.Surface, samples: dapple.Samples) -> None:
        self.surface, self.samples = surface, samples

    def advance(self, vertices: Array) -> Step:
        self.surface = self.surface.deformed(vertices)
        start = carried(self.surface, self.samples)
        faces, barycentric, evaluations = minimize(self.surface, start.positions, start.faces)
        self.samples = dapple.Samples(self.surface, faces, barycentric, ids=start.ids)
        return Step(self.surface, self.samples, evaluations)


class Dapple:
    """dapple.Tracker as it comes."""

    def __init__(self, surface: dapple.Surface, samples: dapple.Samples) -> None:
        self._tracker = self.tracker(surface, samples)

    def tracker(self, surface: dapple.Surface, samples: dapple.Samples) -> dapple.Tracker:
        return dapple.Tracker(surface, samples, threads=1)

    def advance(self, vertices: Array) -> Step:
        samples = self._tracker.advance(vertices)
        report = samples.report
        return Step(self._tracker.surface, samples, report.evaluations, report.parts)


class Smoothed(Dapple):
    """A Tracker whose neighbors slide alike, and whose samples return to the first pattern."""

    def tracker(self, surface: dapple.Surface, samples: dapple.Samples) -> dapple.Tracker:
        return dapple.Tracker(surface, samples, slide_smoothing=0.015, threads=1)


class Calm(Dapple):
    """A Tracker whose samples return to the first pattern slowly, and are held a little."""

    def tracker(self, surface: dapple.Surface, samples: dapple.Samples) -> dapple.Tracker:
        return dapple.Tracker(surface, samples, pattern_strength=0.2, stickiness=0.1, threads=1)


class Alike(Dapple):
    """A Tracker whose samples return to the first pattern slowly, and slide as neighbors do."""

    def tracker(self, surface: dapple.Surface, samples: dapple.Samples) -> dapple.Tracker:
        return dapple.Tracker(
            surface, samples, pattern_strength=0.3, slide_smoothing=0.03, threads=1
        )


class Window:
    """dapple.track_window over all frames of a loop, of which the last is the first again."""

    def __init__(
        self, surface: dapple.Surface, samples: dapple.Samples, frames: Sequence[Array]
    ) -> None:
        self.surface = surface
        solved = dapple.track_window(surface, samples, frames[:-1], closed=True, threads=1)
        self._left = [*solved[1:], solved[0]]

    def advance(self, vertices: Array) -> Step:
        self.surface = self.surface.deformed(vertices)
        samples = self._left.pop(0)
        return Step(self.surface, samples, samples.report.evaluations)


CONTENDERS: dict[str, Callable[[dapple.Surface, dapple.Samples], Contender]] = {
    "ride": Ride,
    "paper": Paper,
    "dapple": Dapple,
    "smoothed": Smoothed,
    "calm": Calm,
    "alike": Alike,
}


WINDOW = "window"  # knows the frames beforehand


def entered(
    name: str, surface: dapple.Surface, samples: dapple.Samples, frames: Sequence[Array]
) -> Contender:
    """The contender of a name, ready to advance to these frames."""
    if name == WINDOW:
        return Window(surface, samples, frames)
    return CONTENDERS[name](surface, samples)


def carried(surface: dapple.Surface, samples: dapple.Samples) -> dapple.Samples:
    """The samples on the same places of their faces, on another frame's surface."""
    return dapple.Samples(surface, samples.faces, samples.barycentric, ids=np.asarray(samples.ids))
