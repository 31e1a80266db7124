# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames that are solved together, so that motion is smooth in time and loops close."""

from dataclasses import dataclass
from typing import Any, ClassVar

from .bake import Baker
from .errors import ScatterError
from .kinds import check_one_class
from .native import package
from .solve import named
from .surface import SurfaceArrays


@dataclass
class TogetherBaker(Baker):
    """Holds the frames back until solve() is called; none is kept in files before."""

    remedy: ClassVar[str] = "Set Smoothing to Forward"
    closed: bool = False  # the last frame leads back to the first

    def __post_init__(self) -> None:
        super().__post_init__()
        check_one_class(self.start.settings, "Smoothing over all frames")
        self._held: list[SurfaceArrays] = []

    @property
    def done(self) -> int:
        """Frames that are held or solved."""
        return max(len(self._held), len(self.reports))

    def advance(self, context: Any) -> None:
        """Hold the frame back."""
        self._held.append(self._now)

    def solve(self, context: Any) -> None:
        """Solve all frames that are held."""
        if not self._held:
            raise ScatterError(f"Surface '{self.bound.name}': there is no frame to solve")
        with named(self.bound.name):
            samples = self._begin()
            options = self.start.settings.tracker_options()
            options["stickiness"] = max(options["stickiness"], 1.0)
            ground = self._ground
            frames = [ground.vertices(frame.vertices) for frame in self._held]
            found = package().track_window(
                ground.surface, frames, samples, closed=self.closed, context=context, **options
            )
        for frame, solved in zip(self._held, found[1:], strict=True):
            self._now = frame
            self._add(self._solved_of(ground.back(solved), settled=True))
