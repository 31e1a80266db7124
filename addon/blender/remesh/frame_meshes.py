# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that a bake writes while it goes on, and which nothing shows before it ends."""

from collections.abc import Iterator
from contextlib import contextmanager

import bpy

from ...core.base.errors import ScatterError
from ...core.remesh import NewMesh
from ..base.object_handles import ObjectHandle
from ..base.times import show_time
from .shown import Shown, read_shown, shown_copy
from .writing import write_new


def mesh_of_frame(handle: ObjectHandle, number: int, new: NewMesh, before: Shown) -> bpy.types.Mesh:
    """The new mesh of a frame with the data of the shown one.

    Raises:
        ScatterError: the frame shows something else than before.
    """
    show_time(bpy.context.scene, number)
    return mesh_now(handle.get(), new, before)


def mesh_now(obj: bpy.types.Object, new: NewMesh, before: Shown) -> bpy.types.Mesh:
    """The same of the current frame."""
    check_same(obj, before)
    with shown_copy(obj) as old:
        return write_new(old, new)


def check_same(obj: bpy.types.Object, before: Shown) -> None:
    """ScatterError if the current frame shows something else than before."""
    if not read_shown(obj).is_like(before):
        raise ScatterError(f"'{obj.name}' was edited in the meantime: nothing was written")


class UnusedMeshes:
    """The meshes of the frames so far, which nothing uses yet: Blender does not save such ones."""

    def __init__(self) -> None:
        self._uids: list[int] = []  # an undo would make references invalid

    def add(self, mesh: bpy.types.Mesh) -> None:
        """The mesh of the next frame."""
        self._uids.append(mesh.session_uid)

    def all(self, name: str) -> list[bpy.types.Mesh]:
        """All meshes in the order of the frames; ScatterError if one was removed."""
        found = self._found()
        if len(found) < len(self._uids):
            raise ScatterError(f"'{name}': a mesh was removed in the meantime: nothing was written")
        return [found[uid] for uid in self._uids]

    @contextmanager
    def removed_if_unused(self) -> Iterator[None]:
        """Remove those that no object uses afterward."""
        try:
            yield
        finally:
            bpy.data.batch_remove([mesh for mesh in self._found().values() if not mesh.users])

    def _found(self) -> dict[int, bpy.types.Mesh]:
        wanted = set(self._uids)
        return {mesh.session_uid: mesh for mesh in bpy.data.meshes if mesh.session_uid in wanted}
