# SPDX-License-Identifier: GPL-3.0-or-later
"""Detects changes that the artist made to a scatter during work on it, which are not
overwritten.
"""

from typing import Any

import bpy

from ...core.base.errors import ScatterError
from ...core.surface.sources import digest_of
from ..base.mesh_arrays import read_points
from ..base.object_handles import ObjectHandle
from ..scatter.linked_data import is_in_view_layer
from ..scatter.object import bake_settings_of, settings_of


def points_now(obj: bpy.types.Object) -> Any:
    """A token of the current points, to be compared later."""
    return digest_of([read_points(obj.data)]), obj.dapple.locked_count, obj.dapple.baked_keys


def check_writable(obj: bpy.types.Object) -> None:
    """ScatterError where the artist does something with a scatter that hinders writing it."""
    if not is_in_view_layer(obj):
        raise ScatterError(f"Scatter '{obj.name}' is not in the view layer that is shown")
    if obj.mode != "OBJECT":
        raise ScatterError(f"Scatter '{obj.name}' is not in Object Mode: nothing was written")


def check_points_kept(obj: bpy.types.Object, before: Any, work: str = "solved") -> None:
    """The same, also if the points have changed."""
    check_writable(obj)
    if points_now(obj) != before:
        raise ScatterError(f"Scatter '{obj.name}' changed while it was {work}: nothing was written")


class ConcurrentEdits:
    """The points and settings at the start of a bake."""

    def __init__(self, scatter: ObjectHandle) -> None:
        self.scatter, obj = scatter, scatter.get()
        self.points, self.settings = points_now(obj), self._settings(obj)

    def check(self) -> None:
        """ScatterError if they have changed."""
        obj = self.scatter.get()
        check_points_kept(obj, self.points, "baked")
        if self._settings(obj) != self.settings:
            raise ScatterError(
                f"Settings of scatter '{obj.name}' changed while it was baked: nothing was written"
            )

    @staticmethod
    def _settings(obj: bpy.types.Object) -> Any:
        surface = obj.dapple.surface
        uid = surface.session_uid if surface is not None else 0
        return settings_of(obj), bake_settings_of(obj), uid
