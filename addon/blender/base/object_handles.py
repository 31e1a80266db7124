# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects found again: the artist may delete anything while something is under way."""

import bpy

from ...core.base.errors import ScatterError


class ObjectHandle:
    """A handle of an object across steps, without a reference that an undo would invalidate."""

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
