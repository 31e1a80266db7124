# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces whose modifiers order the same faces otherwise from one evaluation to the next, as a
Boolean may where faces touch: they are evaluated again until the order is the one that is known.
"""

from collections.abc import Callable
from dataclasses import dataclass

import bpy

from ...core.surface.arrays import SurfaceArrays, check_unchanged, is_reordered
from ..base.object_handles import Held
from ..scatter.object import is_fluid

_TRIES = 8
Read = Callable[[], SurfaceArrays]  # evaluates and reads a frame once more


@dataclass
class Steady:
    """Reads the frames of a bake in one order of faces, wherever they come in that too."""

    surface: Held

    def first(self, obj: bpy.types.Object, read: Read) -> SurfaceArrays:
        """The first frame, in the order to which the points of a scatter are attached."""
        arrays, known = read(), obj.dapple.surface_topology.split()
        if not known or obj.dapple.bound_to != "FACES":
            return arrays
        return self._in_order(arrays, known[0], obj.dapple.surface_vertices, read)

    def next(self, bound: SurfaceArrays, read: Read) -> SurfaceArrays:
        """A frame, in the order of one before."""
        return self._in_order(read(), bound.topology, len(bound.vertices), read)

    def check(self, before: SurfaceArrays, read: Read) -> None:
        """ChangedError unless a surface is still the one that was read, in whatever order."""
        now = self.next(before, read)
        if now.topology == before.topology or not is_reordered(before, now):
            check_unchanged(before, now)

    def _in_order(
        self, first: SurfaceArrays, known: str, vertices: int, read: Read
    ) -> SurfaceArrays:
        arrays = first
        if len(first.vertices) != vertices or is_fluid(self.surface.get()):
            return first
        for _ in range(_TRIES):
            if arrays.topology == known:
                return arrays
            self._evaluate_again()
            arrays, before = read(), arrays
            if arrays.topology == before.topology or not is_reordered(first, arrays):
                break  # the order does not change by itself
        return arrays if arrays.topology == known else first

    def _evaluate_again(self) -> None:
        self.surface.get().update_tag(refresh={"DATA"})
        bpy.context.view_layer.update()
