# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading a surface in the current frame or in another one."""

from collections.abc import Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

import bpy

from ...core.base.errors import ScatterError
from ...core.base.steps import PAUSE, Task, run_now
from ...core.density.terms import names_of
from ...core.settings.values import Settings, marks_of, materials_of
from ...core.surface.arrays import SurfaceArrays, check_unchanged
from ...core.surface.mesh_snapshot import RawMesh, RawValues, surface_of_raw, unmoved
from ...core.surface.sources import digest_of
from ..base.object_handles import ObjectHandle
from ..base.times import show_time, time_of
from .current_binding import with_rest
from .mesh import Parts, marked_values, material_values, mesh_parts, value_parts
from .surroundings import Known, Nearby, lasting, nearby_parts


@dataclass
class Read:
    """The data read from a surface and its surroundings."""

    mesh: RawMesh
    values: list[RawValues] = field(default_factory=list)
    nearby: Nearby = field(default_factory=Nearby)
    like: SurfaceArrays | None = None  # the same faces in a previous frame
    still: list[str] = field(default_factory=list)  # values that equal those of `like`
    before: SurfaceArrays | None = None  # an earlier reading, perhaps of the same mesh

    def arrays(self) -> SurfaceArrays:
        """All of it as arrays; called in a worker."""
        around = self.nearby.surroundings()
        still = unmoved(self.mesh, self.before) if self.like is None else None
        like = self.like or still
        found = surface_of_raw(self.mesh, self.values, around, self.nearby.uv, like)
        if self.like is None:
            return found if still is None else replace(found, vertices=still.vertices)
        weights = {name: self.like.weights[name] for name in self.still}
        digests = self.like.digests | found.digests
        return replace(found, weights=weights | found.weights, digests=digests)


def read_parts(
    surface: ObjectHandle,
    settings: Settings | None = None,
    own: ObjectHandle | None = None,
    known: Known | None = None,
) -> Parts:
    """Read a surface in parts, with all that the settings need from it and its surroundings.

    Between two parts Blender handles the artist's events. Only data that Blender must provide is
    read here; a worker makes arrays of it. The scene may change between two parts: the caller
    watches for that and starts again.
    """
    known = known or Known()
    found = Read((yield from mesh_parts(surface, known.mesh)))
    if settings is None:
        return found
    names, density = names_of(settings), settings.density
    if known.arrays is not None:
        found.like = known.like(found.mesh.topology)
    found.still = lasting(surface.get(), names) if found.like is not None else []
    for name in names:
        if name not in found.still:
            found.values.append((yield from value_parts(surface, found.mesh, name)))
    if materials_of(density):
        yield PAUSE
        found.values.append(material_values(surface, found.mesh, materials_of(density)))
    if marks_of(settings):
        yield PAUSE
        found.values.append(marked_values(surface, found.mesh, marks_of(settings)))
    found.nearby = yield from nearby_parts(density, surface, own, found.mesh, known)
    return found


def read_steps(
    surface: ObjectHandle,
    settings: Settings | None = None,
    own: ObjectHandle | None = None,
    known: Known | None = None,
    before: SurfaceArrays | None = None,
) -> Any:
    """The same as arrays. `known` holds data that is not read again in later frames of a bake;
    triangles of an earlier reading, `before`, are not computed again if the mesh is the same.
    """
    read = yield from read_parts(surface, settings, own, known)
    read.before = before
    arrays = yield Task(lambda _: read.arrays())
    if known is not None and settings is not None:
        if read.like is None or known.mesh is None:
            known.mesh = read.mesh
        known.arrays = known.arrays if read.like is not None else arrays
        known.picture = read.nearby.picture
    return arrays


def read(
    surface: bpy.types.Object,
    settings: Settings | None = None,
    own: bpy.types.Object | None = None,
    may_be_empty: bool = False,
    known: Known | None = None,
) -> SurfaceArrays:
    """The same at once; ScatterError if the surface has no faces, unless it may be empty."""
    scatter = ObjectHandle(own) if own is not None else None
    arrays: SurfaceArrays = run_now(read_steps(ObjectHandle(surface), settings, scatter, known))
    if not may_be_empty:
        check_faces(surface, arrays)
    return arrays


def check_faces(surface: bpy.types.Object, arrays: SurfaceArrays) -> None:
    """ScatterError if the surface has no faces."""
    if not len(arrays.faces):
        raise ScatterError(_without_faces(surface, bpy.context.evaluated_depsgraph_get()))


def value_digests(
    obj: bpy.types.Object,
    names: Collection[str],
    materials: Collection[str],
    marks: Collection[str] = (),
) -> dict[str, str]:
    """Digests of values of a surface by name; see SurfaceArrays.digests."""
    if not names and not materials and not marks:
        return {}
    surface = ObjectHandle(obj)
    mesh = run_now(mesh_parts(surface, shaded=False, cut=False))
    found = [run_now(value_parts(surface, mesh, name)) for name in names]
    if materials:
        found.append(material_values(surface, mesh, materials))
    if marks:
        found.append(marked_values(surface, mesh, marks))
    return {raw.name: digest_of([raw.numbers(obj.name)]) for raw in found}


def _without_faces(surface: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> str:
    """Message that a surface has no faces; if it has instances, what to do."""
    text = f"Surface '{surface.name}' has no faces at frame {depsgraph.scene.frame_current_final:g}"
    if any(
        one.is_instance and one.parent and one.parent.original == surface
        for one in depsgraph.object_instances
    ):
        return f"{text}, only instances: add Realize Instances at the end of its nodes"
    if surface.type == "CURVE":
        return (
            f"{text}, it is a bare curve: give it a little Extrude or Bevel Depth below Geometry "
            "in its Data properties, and points follow it at equal distances"
        )
    return text


def at_frame(
    surface: ObjectHandle,
    frame: int,
    part: float = 0.0,
    settings: Settings | None = None,
    own: ObjectHandle | None = None,
    kind: str = "FACES",
    may_be_empty: bool = False,
    known: Known | None = None,
) -> SurfaceArrays:
    """The surface at a time of the animation, with its rest shape if points are bound to it."""
    show_time(bpy.context.scene, frame + part)
    arrays = read(surface.get(), settings, own.get() if own else None, may_be_empty, known)
    has_rest = kind == "REST" and len(arrays.faces)
    return with_rest(arrays, surface.get()) if has_rest else arrays


@contextmanager
def as_read(
    arrays: SurfaceArrays,
    surface: ObjectHandle,
    settings: Settings | None = None,
    own: bpy.types.Object | None = None,
) -> Iterator[None]:
    """Show the time at which a surface was read, as the artist may have changed the frame.

    ChangedError if the surface is not the one that was read.
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
    """Restore the current frame of a scene afterward; show the given time inside, if any."""
    uid, frame, subframe = scene.session_uid, scene.frame_current, scene.frame_subframe
    try:
        if show is not None:
            show_time(scene, show)
        yield
    finally:
        for same in bpy.data.scenes:  # an undo may have invalidated the reference
            if same.session_uid == uid:
                same.frame_set(frame, subframe=subframe)
