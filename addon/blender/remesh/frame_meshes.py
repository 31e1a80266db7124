# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that a bake writes while it goes on, and which nothing shows before it ends."""

from collections.abc import Iterator
from contextlib import contextmanager

import bpy

from ...core.base.errors import ScatterError
from ...core.remesh import NewMesh
from ..base.object_handles import ObjectHandle
from .shown import Shown, read_shown, shown_copy
from .writing import write_new


def mesh_of_frame(handle: ObjectHandle, number: int, new: NewMesh, before: Shown) -> bpy.types.Mesh:
    """The new mesh of a frame with the data of the shown one.

    Raises:
        ScatterError: the frame shows something else than before.
    """
    check_same(handle, number, before)
    with shown_copy(handle.get()) as old:
        return write_new(old, new)


def check_same(handle: ObjectHandle, number: int, before: Shown) -> None:
    """Show a frame; ScatterError if it shows something else than before."""
    if not read_shown(handle, number).is_like(before):
        name = handle.get().name
        raise ScatterError(f"'{name}' was edited in the meantime: nothing was written")


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
