# SPDX-License-Identifier: GPL-3.0-or-later
"""The surface of a bake with its density: built where a topology begins, and rebuilt when an input
of the density has changed.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from ..density.counts import shrunk
from ..density.masked_surface import MaskedSurface, masked_surface_of
from ..density.outside import is_decided_on_all_frames, is_decided_on_each_frame
from ..density.terms import has_mask, names_of
from ..settings.values import DensitySettings, Settings, materials_of
from ..solve.class_counts import clearances
from ..surface.arrays import Floats, Ints, SurfaceArrays, Surroundings
from ..surface.records import Placed
from ..surface.sources import value_roles

_OF_THE_WORLD = ("slope", "height", "aspect", "distance")  # masks by position in the world
_AROUND = {
    "uv": ("uv",),
    "image": ("image",),
    "camera": ("camera",),
    "others": ("points", "radii", "hulls", "hull_counts"),
    "targets": ("lines",),
}


class MaskedSurfaces:
    """Builds the surface with its density on demand and reads no more of a frame than needed."""

    def __init__(
        self, bound: SurfaceArrays, settings: Settings, first: MaskedSurface | None = None
    ) -> None:
        self._settings = settings
        self.moving: set[str] = set()  # roles of inputs that have changed on some frame
        self.begin(bound, first)

    def begin(self, bound: SurfaceArrays, first: MaskedSurface | None = None) -> None:
        """Start a new topology, of which the first surface may be known."""
        self.bound = self.laid = bound  # laid: the frame of the current density
        self._first = first
        self._now: MaskedSurface | None = None

    def follow(self, frame: SurfaceArrays) -> Iterator[Any]:
        """Use the density of a frame if it differs; yields its inputs for digests."""
        roles = moved(self.laid, frame, self._settings)
        if not roles:
            return
        self.moving.update(roles)
        self.laid, self._now = with_faces(frame, self.bound), None
        yield from arrays_of(frame)

    @property
    def first(self) -> MaskedSurface:
        """The surface at the start of the topology."""
        if self._first is None:
            self._first = masked_surface_of(self.bound, self._settings)
        return self._first

    @property
    def now(self) -> MaskedSurface:
        """The surface with the current density."""
        if self._now is None:
            self._now = self._built_on(self.laid, self.bound, self.first)
        return self._now

    def of(self, laid: SurfaceArrays, bound: SurfaceArrays) -> MaskedSurface:
        """The surface with the density of one frame and the topology of another."""
        if bound is not self.bound:
            return self._built_on(laid, bound, masked_surface_of(bound, self._settings))
        return self.now if laid is self.laid else self._built_on(laid, bound, self.first)

    def on_original(self, masked: MaskedSurface, samples: Any, vertices: Floats) -> Any:
        """Samples of a surface with its density, on the faces that were read, in a frame.

        On an edge that folds a sample is hidden or not by rounding, so it leaves the edge. Where
        all frames decide what is outside, an edge that folds on this frame alone counts too.
        """
        at_frame = is_decided_on_all_frames(self._settings.density)
        return masked.to_original(samples, vertices if at_frame else None)

    def with_clearance(self, placed: Placed, vertices: Floats, classes: Ints) -> Placed:
        """Add the clearance (n,) of each point in a frame; 0 for points that do not exist there."""
        count = len(placed.faces)
        there = np.ones(count, dtype=bool) if placed.faded is None else placed.faded < 1.0
        places = placed.binding.positions(vertices)[there]
        found = np.zeros(count)
        sized = shrunk(self._settings, self.first.surface)
        found[there] = clearances(places, classes[:count][there], sized)
        return replace(placed, clearance=found)

    @property
    def radii(self) -> Floats:
        """Radius of each object type."""
        sized = shrunk(self._settings, self.first.surface)
        return np.array([kind.radius for kind in sized.object_types])

    def _built_on(
        self, laid: SurfaceArrays, bound: SurfaceArrays, first: MaskedSurface
    ) -> MaskedSurface:
        if laid is bound:
            return first
        return masked_surface_of(laid, self._settings, like=first, first=bound, like_arrays=bound)


def may_move(settings: Settings) -> bool:
    """Whether a density has inputs that can change between frames."""
    density = settings.density
    nearby = density.image or density.use_camera_view or density.avoid_collection
    values = names_of(settings) or materials_of(density)
    each_frame = is_decided_on_each_frame(density)
    return bool(values or nearby or each_frame or _masks(density))


def moved(before: SurfaceArrays, now: SurfaceArrays, settings: Settings) -> list[str]:
    """Roles of the inputs that differ between two frames with the same faces; see sources.py."""
    values = value_roles(settings).items()
    found = [role for role, name in values if not _same(before.weights[name], now.weights[name])]
    found += _moved_around(before.around, now.around)
    if is_of_the_world(settings.density, now.around):
        found += [] if np.array_equal(before.vertices, now.vertices) else ["shape"]
    return found


def with_faces(frame: SurfaceArrays, bound: SurfaceArrays) -> SurfaceArrays:
    """A frame whose polygons are cut as when the points were bound."""
    return replace(
        frame, faces=bound.faces, loops=bound.loops, rest=bound.rest, rest_parts=bound.rest_parts
    )


def arrays_of(frame: SurfaceArrays) -> list[Any]:
    """Everything that is compared of a frame besides its shape, for digests."""
    return [*frame.weights.values(), *frame.around.arrays()]


def _masks(density: DensitySettings) -> list[str]:
    return [name for name in _OF_THE_WORLD if has_mask(density, name)]


def is_of_the_world(density: DensitySettings, around: Surroundings) -> bool:
    """Whether a density changes when its surface moves."""
    avoided = around.obstacles or len(around.points) or len(around.hulls)
    nearby = around.camera is not None or avoided
    return bool(nearby or is_decided_on_each_frame(density) or _masks(density))


def _moved_around(before: Surroundings, now: Surroundings) -> list[str]:
    found = [
        role
        for role, names in _AROUND.items()
        if not all(_same(getattr(before, name), getattr(now, name)) for name in names)
    ]
    for role in ("obstacles", "hiding", "targets"):
        if not _same_meshes(getattr(before, role), getattr(now, role)):
            found.append(role)
    if len(before.tiles) != len(now.tiles) or not all(
        one[0] == other[0] and _same(one[1], other[1])
        for one, other in zip(before.tiles, now.tiles, strict=True)
    ):
        found.append("image")
    return found


def _same_meshes(before: Any, now: Any) -> bool:
    return len(before) == len(now) and all(
        _same(one, other)
        for mesh, later in zip(before, now, strict=True)
        for one, other in zip(mesh, later, strict=True)
    )


def _same(before: Any, now: Any) -> bool:
    return before is now or (
        before is not None and now is not None and bool(np.array_equal(before, now))
    )
