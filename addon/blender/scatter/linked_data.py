# SPDX-License-Identifier: GPL-3.0-or-later
"""Linked and shared data-blocks: which can be written, and which mesh to write to."""

import bpy

from ..base.translation import Translate, translated


def read_only(obj: bpy.types.Object, translate: Translate = translated) -> str:
    """Why changes of an object would not be saved; empty if they would."""
    if obj.library is not None:
        return translate(
            "'{name}' is linked from '{file}': make it local, make a library override, or "
            "edit that file",
            name=obj.name,
            file=bpy.path.basename(obj.library.filepath),
        )
    if obj.override_library is not None and obj.override_library.is_system_override:
        return translate(
            "'{name}' is a library override that is not editable: make it editable first",
            name=obj.name,
        )
    return ""


def is_in_view_layer(obj: bpy.types.Object) -> bool:
    """Whether an object is in the current view layer; a linked one may have the same name."""
    shown = bpy.context.view_layer.objects
    found = shown.get(obj.name)
    return found == obj or (found is not None and obj in list(shown))


def own_mesh(obj: bpy.types.Object) -> bpy.types.Mesh:
    """The mesh to write an object's points to. A mesh that is shared with a linked duplicate or
    comes from another file is copied first.
    """
    mesh = obj.data
    if mesh.library is not None or mesh.users - mesh.use_fake_user > 1:
        obj.data = mesh.copy()
    return obj.data


def open_collections(obj: bpy.types.Object) -> list[bpy.types.Collection]:
    """The collections of an object that another object can be linked to."""
    return [one for one in obj.users_collection if not (one.library or one.override_library)]
