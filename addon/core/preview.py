# SPDX-License-Identifier: GPL-3.0-or-later
"""Live preview: points follow a surface as far as a time budget allows."""

import threading
from dataclasses import replace
from typing import Any

import numpy as np

from .bake.baker import Start
from .base.errors import StoppedError
from .base.native import named
from .density.masked_surface import masked_surface_of
from .solve.class_counts import tracked
from .surface.arrays import Floats, SurfaceArrays, check_same_topology
from .surface.binding import placed_of, samples_of
from .surface.frames import carried, shading
from .surface.records import Binding


class Follower:
    """Re-optimizes points for one shape of a surface after another, none of it kept."""

    def __init__(self, surface: SurfaceArrays, start: Start, context: Any = None) -> None:
        self.binding = start.binding
        self.over_budget = False  # the last shape took longer than its budget
        self._first = surface
        self._seen: Floats = surface.vertices
        with named(surface.name):
            self._ground = masked_surface_of(surface, start.settings, context)
            samples = samples_of(start.binding, self._ground.original, start.ids, start.classes)
            self._tracker = tracked(
                self._ground, self._ground.from_original(samples), start.settings
            )

    @property
    def topology(self) -> str:
        """Topology of the followed surface."""
        return self._first.topology

    def check(self, surface: SurfaceArrays) -> None:
        """ScatterError if a surface has another topology."""
        check_same_topology(self._first, surface, "this moment")

    def follow(
        self, vertices: Floats, budget: float, context: Any, normals: Floats | None = None
    ) -> Binding | None:
        """The binding for this shape with these shading normals, found within so many seconds.

        None if the shape is the last one or the time was not enough: then the points keep
        the binding that they have. StoppedError if it was canceled before.
        """
        if np.array_equal(vertices, self._seen):
            return None
        samples = self.advanced(vertices, budget, context)
        self._seen = vertices
        self.over_budget = samples is None
        if samples is None:
            return None
        after = placed_of(samples, self._first).binding
        shaded = shading(replace(self._first, vertices=vertices, normals=normals))
        self.binding = carried(self.binding, after, vertices, shaded)
        return self.binding

    def advanced(self, vertices: Floats, budget: float, context: Any) -> Any:
        """The tracker's samples; None if the time is over, with an unchanged tracker."""
        alarm = _Alarm(budget, context)
        try:
            with named(self._first.name):
                fine = self._ground.vertices(vertices)
                return self._ground.to_original(self._tracker.advance(fine, context=context))
        except StoppedError:
            if not alarm.rang:
                raise
            return None
        finally:
            alarm.stop()


class _Alarm:
    """Cancels a context after so many seconds."""

    def __init__(self, seconds: float, context: Any) -> None:
        self.rang, self._context = False, context
        self._timer = threading.Timer(seconds, self._ring)
        self._timer.daemon = True
        self._timer.start()

    def _ring(self) -> None:
        self.rang = True
        self._context.cancel()

    def stop(self) -> None:
        """Stop the alarm."""
        self._timer.cancel()
