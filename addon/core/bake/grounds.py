# SPDX-License-Identifier: GPL-3.0-or-later
"""The ground of a bake: laid where a topology begins, and anew where what its density reads is
another than before.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from ..density.ground import Ground, ground_of
from ..settings.values import Settings
from ..solve.class_counts import shrunk
from ..solve.clearance import rooms
from ..surface.arrays import Floats, Ints, SurfaceArrays
from ..surface.records import Placed
from .over_time import arrays_of, moved, with_faces


class Grounds:
    """Lays grounds when they are asked for; takes no more of a frame than it is told."""

    def __init__(self, bound: SurfaceArrays, settings: Settings) -> None:
        self._settings = settings
        self.moving: set[str] = set()  # roles of what was another on some frame
        self.begin(bound)

    def begin(self, bound: SurfaceArrays) -> None:
        """A topology begins."""
        self.bound = self.laid = bound  # laid: the frame whose density holds
        self._first: Ground | None = None
        self._now: Ground | None = None

    def follow(self, frame: SurfaceArrays) -> Iterator[Any]:
        """Have the density of a frame hold, if it is another; what it is made of, for digests."""
        roles = moved(self.laid, frame, self._settings)
        if not roles:
            return
        self.moving.update(roles)
        self.laid, self._now = with_faces(frame, self.bound), None
        yield from arrays_of(frame)

    @property
    def first(self) -> Ground:
        """Where the topology begins."""
        if self._first is None:
            self._first = ground_of(self.bound, self._settings)
        return self._first

    @property
    def now(self) -> Ground:
        """Of the density that holds."""
        if self._now is None:
            self._now = self._laid_on(self.laid, self.bound, self.first)
        return self._now

    def of(self, laid: SurfaceArrays, bound: SurfaceArrays) -> Ground:
        """Of the density of a frame, on the topology that began at another one."""
        if bound is not self.bound:
            return self._laid_on(laid, bound, ground_of(bound, self._settings))
        return self.now if laid is self.laid else self._laid_on(laid, bound, self.first)

    def with_room(self, placed: Placed, vertices: Floats, classes: Ints) -> Placed:
        """With the room (n,) that each point has on a frame; those that are not there have none."""
        count = len(placed.faces)
        there = np.ones(count, dtype=bool) if placed.gone is None else placed.gone < 1.0
        places = placed.binding.positions(vertices)[there]
        found = np.zeros(count)
        sized = shrunk(self._settings, self.first.surface)
        found[there] = rooms(places, classes[:count][there], sized)
        return replace(placed, room=found)

    def _laid_on(self, laid: SurfaceArrays, bound: SurfaceArrays, first: Ground) -> Ground:
        if laid is bound:
            return first
        return ground_of(laid, self._settings, like=first, first=bound)
