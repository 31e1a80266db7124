# SPDX-License-Identifier: GPL-3.0-or-later
"""Live preview: points follow a surface as far as a time budget allows."""

import threading
from typing import Any

import numpy as np

from .bake import Start
from .binding import placed_of, samples_of
from .errors import StoppedError
from .frames import carried
from .ground import Ground
from .kinds import tracked
from .native import package
from .records import Binding
from .solve import named
from .surface import Floats, SurfaceArrays, check_same_topology


class Follower:
    """Re-optimises points for one shape of a surface after another, none of it kept."""

    def __init__(self, surface: SurfaceArrays, start: Start) -> None:
        self.binding = start.binding
        self.riding = False  # the last shape took longer than its budget
        self._first = surface
        self._seen: Floats = surface.vertices
        with named(surface.name):
            self._ground = Ground(surface, start.settings)
            samples = samples_of(start.binding, self._ground.original, start.ids, start.classes)
            self._tracker = tracked(self._ground, self._ground.there(samples), start.settings)

    @property
    def topology(self) -> str:
        """Of the surface that is followed."""
        return self._first.topology

    def follow(self, surface: SurfaceArrays, budget: float) -> Binding | None:
        """The binding for this shape, found within so many seconds.

        None if the shape is the last one or the time was not enough: then the points ride on
        the binding that they have. ScatterError if the topology is another one.
        """
        check_same_topology(self._first, surface, "this moment")
        if np.array_equal(surface.vertices, self._seen):
            return None
        self._seen = surface.vertices
        samples = self._advanced(surface.vertices, budget)
        self.riding = samples is None
        if samples is None:
            return None
        after = placed_of(samples, self._first.faces).binding
        self.binding = carried(self.binding, after, surface.vertices, self._first.faces)
        return self.binding

    def _advanced(self, vertices: Floats, budget: float) -> Any:
        """The tracker's samples; None, and the tracker as it was, if the time is over."""
        context = package().Context()
        alarm = threading.Timer(budget, context.cancel)
        alarm.start()
        try:
            with named(self._first.name):
                fine = self._ground.vertices(vertices)
                return self._ground.back(self._tracker.advance(fine, context=context))
        except StoppedError:
            return None
        finally:
            alarm.cancel()
