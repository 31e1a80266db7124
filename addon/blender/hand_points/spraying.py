# SPDX-License-Identifier: GPL-3.0-or-later
"""A stroke of the spray brush over the surface of a scatter."""

from dataclasses import dataclass

import bpy
import numpy as np

from ...core.base.errors import ScatterError
from ...core.solve.solve import nearest_binding
from ...core.spray import Adding, Brush, Contact, Removing
from ...core.surface.arrays import Floats
from ...core.surface.frames import shading
from ...core.surface.records import unbound
from ..base.mesh_arrays import read_points, to_world
from ..scatter.object import surface_of
from ..surface.current_binding import binding_now
from ..surface.reading import read
from .picking import Pixels, Rays, contact_at
from .single_points import add_points, remove_points

_OFF = 1e-3  # relative to the radius: places farther away are projected in world space
_STEP = 0.25  # relative to the radius: distance from one dab to the next
_MOST_STEPS = 64  # between two events of the mouse


@dataclass(frozen=True)
class Dab:
    """One touch of the brush."""

    place: Floats  # (3,) in world space
    pressure: float = 1.0


class Stroke:
    """A stroke that adds points of an object type or removes points. Nothing is written before
    `write`.

    Raises:
        ScatterError: the points cannot be edited.
    """

    def __init__(self, obj: bpy.types.Object, brush: Brush, remove: bool) -> None:
        surface = surface_of(obj)
        self.rays, self.brush = Rays(surface), brush
        self._arrays, seed = read(surface), obj.dapple.seed
        binding = binding_now(obj, surface, self._arrays)
        places, blank = binding.positions(self._arrays.vertices), unbound(binding)
        places[blank] = to_world(obj, read_points(obj.data))[blank]
        self._work: Adding | Removing
        if remove:
            normals = shading(self._arrays).at(binding)
            self._work = Removing(places, normals, brush, seed)
        else:
            self._work = Adding(places, brush, seed, self.rays.between)

    @property
    def places(self) -> Floats:
        """Places (k, 3) of the points that are added or removed."""
        return self._work.places

    def dab(self, dab: Dab) -> None:
        """Touch the place of the surface that is nearest to that of the dab."""
        contact = self._contact(dab.place)
        if contact is not None:
            self._work.dab(contact, dab.pressure)

    def write(self, obj: bpy.types.Object, kind: int) -> int:
        """Add or remove the points; returns their number."""
        if not len(self.places):
            return 0
        if isinstance(self._work, Removing):
            remove_points(obj, np.flatnonzero(self._work.chosen).tolist())
        else:
            add_points(obj, self.places, kind)
        return len(self.places)

    def _contact(self, place: Floats) -> Contact | None:
        found = self.rays.nearest(place)
        if found is None or np.linalg.norm(found.place - place) <= _OFF * self.brush.radius:
            return found
        nearest = nearest_binding(place[None], self._arrays).positions(self._arrays.vertices)
        return self.rays.nearest(nearest[0])


class Pen:
    """Follows the mouse with a stroke, with dabs at even distances on the surface."""

    def __init__(self, context: bpy.types.Context, stroke: Stroke) -> None:
        self.stroke, self.dabs = stroke, list[Dab]()
        self._region, self._view = context.region, context.region_data
        self._last: tuple[Floats, Dab] | None = None  # pixel and dab; None: beside the surface

    def to(self, at: Pixels, pressure: float) -> None:
        """Go on to a pixel of the region."""
        end, now = np.array(at, dtype=np.float64), self._dab_at(at, pressure)
        if now is None:
            self._last = None
        elif self._last is None:
            self._touch(end, now)
        else:
            begin, before = self._last
            for share in self._shares(before, now):
                between = begin + share * (end - begin)
                part = before.pressure + share * (pressure - before.pressure)
                self._touch(between, self._dab_at((between[0], between[1]), part))

    def _dab_at(self, at: Pixels, pressure: float) -> Dab | None:
        """A dab with the numbers that an operator stores, in single precision."""
        found = contact_at(self._region, self._view, at, self.stroke.rays)
        if found is None:
            return None
        return Dab(found.place.astype(np.float32).astype(np.float64), float(np.float32(pressure)))

    def _shares(self, before: Dab, now: Dab) -> Floats:
        """How far the dabs on the way to a place are, from 0 to 1."""
        brush = self.stroke.brush
        step = _STEP * max(brush.radius_at(now.pressure), brush.gap)
        count = min(int(np.linalg.norm(now.place - before.place) / step), _MOST_STEPS)
        return np.linspace(0.0, 1.0, count + 1)[1:]

    def _touch(self, at: Floats, dab: Dab | None) -> None:
        if dab is not None:
            self.stroke.dab(dab)
            self.dabs.append(dab)
            self._last = at, dab


def spacing_of(obj: bpy.types.Object) -> float:
    """The spacing of the points of a scatter in world units.

    Raises:
        ScatterError: it never had points.
    """
    spacing = float(obj.dapple.report.spacing)
    if not spacing > 0.0:
        raise ScatterError(f"Scatter '{obj.name}' has no points yet: optimize it first")
    return spacing
