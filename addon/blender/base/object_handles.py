# SPDX-License-Identifier: GPL-3.0-or-later
"""Handles of objects: the artist may delete or rename an object while background work runs."""

import bpy

from ...core.base.errors import ScatterError


class ObjectHandle:
    """Finds an object again; unlike a reference it stays valid after an undo."""

    def __init__(self, obj: bpy.types.Object) -> None:
        self.uid, self.name = obj.session_uid, obj.name

    def get(self) -> bpy.types.Object:
        """The object; ScatterError if it is gone."""
        named = bpy.data.objects.get(self.name)  # a search through all objects is slow
        if named is not None and named.session_uid == self.uid:
            return named
        for obj in bpy.data.objects:
            if obj.session_uid == self.uid:
                return obj
        raise ScatterError(f"Object '{self.name}' was removed in the meantime: nothing was written")
