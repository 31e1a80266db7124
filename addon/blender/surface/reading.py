# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading a surface in the frame that is shown, or in another one."""

from collections.abc import Iterator
from contextlib import contextmanager

import bpy

from ...core.base.errors import ScatterError
from ...core.settings.values import Settings
from ...core.surface.arrays import SurfaceArrays, check_unchanged
from ..base.object_handles import Held
from ..base.times import show_time, time_of
from .bound import with_rest
from .surface_mesh import read_surface
from .surroundings import Known, read_with


def read(
    surface: bpy.types.Object,
    settings: Settings | None = None,
    own: bpy.types.Object | None = None,
    may_be_bare: bool = False,
    known: Known | None = None,
) -> SurfaceArrays:
    """The surface; with settings, also what they take from it and from beside their scatter.

    ScatterError where it has no faces, unless it may be bare.
    """
    depsgraph = bpy.context.evaluated_depsgraph_get()
    if settings is None:
        arrays = read_surface(surface, depsgraph)
    else:
        arrays = read_with(settings, surface, depsgraph, own, known)
    if not (len(arrays.faces) or may_be_bare):
        raise ScatterError(_without_faces(surface, depsgraph))
    return arrays


def _without_faces(surface: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> str:
    """That a surface has none now, and what to do where it has instances instead."""
    told = f"Surface '{surface.name}' has no faces at frame {depsgraph.scene.frame_current_final:g}"
    if any(
        one.is_instance and one.parent and one.parent.original == surface
        for one in depsgraph.object_instances
    ):
        return f"{told}, only instances: add Realize Instances at the end of its nodes"
    return told


def at_frame(
    surface: Held,
    frame: int,
    part: float = 0.0,
    settings: Settings | None = None,
    own: Held | None = None,
    kind: str = "FACES",
    may_be_bare: bool = False,
    known: Known | None = None,
) -> SurfaceArrays:
    """The surface at a time of the animation, with its rest shape where points are bound to it."""
    show_time(bpy.context.scene, frame + part)
    arrays = read(surface.get(), settings, own.get() if own else None, may_be_bare, known)
    has_rest = kind == "REST" and len(arrays.faces)
    return with_rest(arrays, surface.get()) if has_rest else arrays


@contextmanager
def as_read(
    arrays: SurfaceArrays,
    surface: Held,
    settings: Settings | None = None,
    own: bpy.types.Object | None = None,
) -> Iterator[None]:
    """Show inside the time at which a surface was read, as the artist may look at another frame;
    ChangedError where it is not the one that was read.
    """
    scene = bpy.context.scene
    if time_of(scene) == arrays.time:
        check_unchanged(arrays, read(surface.get(), settings, own))
        yield
        return
    with frame_kept(scene, show=arrays.time):
        check_unchanged(arrays, read(surface.get(), settings, own))
        yield


@contextmanager
def frame_kept(scene: bpy.types.Scene, show: float | None = None) -> Iterator[None]:
    """Have a scene show the same frame afterward, and inside the given time, if there is one."""
    uid, frame, subframe = scene.session_uid, scene.frame_current, scene.frame_subframe
    try:
        if show is not None:
            show_time(scene, show)
        yield
    finally:
        for same in bpy.data.scenes:  # an undo may have left a reference dangling
            if same.session_uid == uid:
                same.frame_set(frame, subframe=subframe)
