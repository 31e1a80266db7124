# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading a surface in the frame that is shown, or in another one."""

from collections.abc import Iterator
from contextlib import contextmanager

import bpy

from ...core.settings import Settings
from ...core.surface import SurfaceArrays
from ..base.held import Held
from ..base.times import show_time
from .bound import with_rest
from .surface_mesh import read_surface
from .surroundings import read_with


def read(
    surface: bpy.types.Object,
    settings: Settings | None = None,
    own: bpy.types.Object | None = None,
) -> SurfaceArrays:
    """The surface; with settings, also what they take from it and from beside their scatter."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    if settings is None:
        return read_surface(surface, depsgraph)
    return read_with(settings, surface, depsgraph, own)


def at_frame(
    surface: Held,
    frame: int,
    part: float = 0.0,
    settings: Settings | None = None,
    own: Held | None = None,
    kind: str = "FACES",
) -> SurfaceArrays:
    """The surface at a time of the animation, with its rest shape where points are bound to it."""
    show_time(bpy.context.scene, frame + part)
    arrays = read(surface.get(), settings, own.get() if own else None)
    return with_rest(arrays, surface.get()) if kind == "REST" else arrays


@contextmanager
def frame_kept(scene: bpy.types.Scene, show: float | None = None) -> Iterator[None]:
    """Have a scene show the same frame afterwards, and inside the given time, if there is one."""
    frame, subframe = scene.frame_current, scene.frame_subframe
    try:
        if show is not None:
            show_time(scene, show)
        yield
    finally:
        scene.frame_set(frame, subframe=subframe)
