# SPDX-License-Identifier: GPL-3.0-or-later
"""What a density reads on each frame of a bake: whether it is another than on a frame before.

Noise, border and curvature belong to the surface and ride with it. Heights, slopes, distances and
what is avoided are of the world: they are others wherever the surface moves.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from ..density.terms import has_mask, names_of
from ..settings.values import DensitySettings, Settings, materials_of
from ..surface.arrays import SurfaceArrays, Surroundings
from ..surface.sources import value_roles

_OF_THE_WORLD = ("slope", "height", "aspect", "distance")  # masks
_AROUND = {
    "uv": ("uv",),
    "image": ("image",),
    "camera": ("camera",),
    "others": ("points", "radii"),
    "targets": ("lines",),
}


def may_move(settings: Settings) -> bool:
    """Whether a density takes anything that can be another on a later frame."""
    density = settings.density
    beside = density.image or density.use_camera or density.obstacles
    values = names_of(settings) or materials_of(density)
    return bool(values or beside or _masks(density))


def moved(before: SurfaceArrays, now: SurfaceArrays, settings: Settings) -> list[str]:
    """Roles of what is another now, as sources.py names them; of two frames with the same faces."""
    values = value_roles(settings).items()
    found = [role for role, name in values if not _same(before.weights[name], now.weights[name])]
    found += _moved_around(before.around, now.around)
    if is_of_the_world(settings.density, now.around):
        found += [] if np.array_equal(before.vertices, now.vertices) else ["shape"]
    return found


def with_faces(frame: SurfaceArrays, bound: SurfaceArrays) -> SurfaceArrays:
    """A frame whose polygons are cut as where the points were bound."""
    return replace(
        frame, faces=bound.faces, loops=bound.loops, rest=bound.rest, rest_parts=bound.rest_parts
    )


def arrays_of(frame: SurfaceArrays) -> list[Any]:
    """All that is compared of a frame beside its shape, for digests."""
    return [*frame.weights.values(), *frame.around.arrays()]


def _masks(density: DensitySettings) -> list[str]:
    return [name for name in _OF_THE_WORLD if has_mask(density, name)]


def is_of_the_world(density: DensitySettings, around: Surroundings) -> bool:
    """Whether a density is another where its surface moves."""
    beside = around.camera is not None or around.obstacles or len(around.points)
    return bool(beside or _masks(density))


def _moved_around(before: Surroundings, now: Surroundings) -> list[str]:
    found = [
        role
        for role, names in _AROUND.items()
        if not all(_same(getattr(before, name), getattr(now, name)) for name in names)
    ]
    for role in ("obstacles", "targets"):
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
