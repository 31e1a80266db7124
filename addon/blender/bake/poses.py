# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the frames of a bake before it begins, where places have to be seen on all of them."""

from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from ...core.base.native import named
from ...core.base.steps import Task
from ...core.density.masked_surface import MaskedSurface, masked_surface_of
from ...core.density.outside import is_decided_on_all_frames
from ...core.settings.values import Settings
from ...core.surface.arrays import Floats, SurfaceArrays
from ..base.object_handles import ObjectHandle
from .frames import Read, StableOrder, read_frame

_READING, _LOOKING = 0.1, 0.1  # shares of the progress


@dataclass
class Poses:
    """The poses of a surface, and its first frame with what they leave of the density."""

    first: SurfaceArrays
    masked: MaskedSurface | None = None
    by_topology: dict[str, tuple[Floats, ...]] = field(default_factory=dict)
    progress: float = 0.0  # share of the bake that is done


def read_poses(
    handle: ObjectHandle,
    steady: StableOrder,
    arrays: SurfaceArrays,
    settings: Settings,
    frames: range,
    read_first: Read,
    kind: str,
) -> Any:
    """The Poses of a bake whose first frame is known, in steps; shows that frame again."""
    if not is_decided_on_all_frames(settings.density):
        return Poses(arrays)
    found: dict[str, list[Floats]] = {arrays.topology: [arrays.vertices]}
    for frame in frames:
        read = partial(read_frame, handle, steady.surface, frame, kind)
        now = steady.next(arrays, read)
        known = found.setdefault(now.topology, [])
        if len(now.faces) and not (known and np.array_equal(known[-1], now.vertices)):
            known.append(now.vertices)
        share = _READING * (frame - frames.start) / len(frames)
        yield Task(lambda _: None, share, share)
    read_first()
    by_topology = {topology: tuple(vertices) for topology, vertices in found.items()}
    first = replace(arrays, poses=by_topology[arrays.topology][1:])
    masked = yield Task(partial(_masked, first, settings), _READING, _READING + _LOOKING)
    return Poses(first, masked, by_topology, _READING + _LOOKING)


def _masked(first: SurfaceArrays, settings: Settings, worker: Any) -> MaskedSurface:
    with named(first.name):
        return masked_surface_of(first, settings, worker)
