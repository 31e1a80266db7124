# SPDX-License-Identifier: GPL-3.0-or-later
"""A new object that shows a remesh; the old one is hidden and stays as it is."""

from dataclasses import dataclass
from functools import partial
from typing import Any

import bpy

from ..base.all_or_nothing import once_done
from ..base.object_handles import ObjectHandle
from ..scatter.linked_data import open_collections
from ..scatter.local_views import into_local_views
from .writing import replace_mesh

_TRANSFORM = (
    *("rotation_mode", "location", "rotation_euler", "rotation_quaternion"),
    *("rotation_axis_angle", "scale", "delta_location", "delta_rotation_euler"),
    *("delta_rotation_quaternion", "delta_scale"),
)
_PARENT = ("parent", "parent_type", "parent_bone", "parent_vertices", "matrix_parent_inverse")
_DEFORMING = {"ARMATURE", "LATTICE", "CURVE"}


@dataclass(frozen=True)
class Remeshed:
    """An object and what is known of its new mesh: NewMesh, MovingMesh or MeshSequence."""

    obj: ObjectHandle
    figures: Any


def show_mesh(obj: bpy.types.Object, made: bpy.types.Mesh) -> bpy.types.Object:
    """Give an object a new mesh. A curve, text or metaball cannot have one: a new object has it,
    which moves alike. Returns the object with the mesh.
    """
    if obj.type == "MESH":
        replace_mesh(obj, made)
        return obj
    new = object_instead(obj, made)
    made.name = new.name
    _move_alike(new, obj)
    return new


def object_instead(obj: bpy.types.Object, mesh: bpy.types.Mesh) -> bpy.types.Object:
    """A new object with a mesh in the collections of an old one, which is hidden."""
    new = bpy.data.objects.new(f"{obj.name} Remeshed", mesh)
    for collection in open_collections(obj) or [bpy.context.scene.collection]:
        collection.objects.link(new)
    # Only what is visible can be hidden.
    once_done(partial(_show_instead, ObjectHandle(obj), ObjectHandle(new)))
    return new


def _show_instead(obj: ObjectHandle, made: ObjectHandle) -> None:
    """Hide the old object, and select the new one if the artist has waited for it."""
    old, new, active = obj.get(), made.get(), bpy.context.object
    waited = active in (old, None) and bpy.context.mode == "OBJECT"
    into_local_views(old, new)  # before the old one is hidden there, too
    old.hide_render = True
    old.select_set(False)
    old.hide_set(True)
    if waited:
        new.select_set(True)
        bpy.context.view_layer.objects.active = new


def _move_alike(new: bpy.types.Object, obj: bpy.types.Object) -> None:
    """Give a new object the place of an old one, and its motion."""
    for name in (*_PARENT, *_TRANSFORM):
        setattr(new, name, getattr(obj, name))
    deform_by_no_parent(new)  # the mesh contains what its parent does
    for constraint in obj.constraints:
        new.constraints.copy(constraint)
    animation = obj.animation_data
    if animation is None:
        return
    made = new.animation_data_create()
    for driver in animation.drivers:
        made.drivers.from_existing(src_driver=driver)
    if animation.action is not None:
        made.action = animation.action
        if hasattr(animation, "action_slot"):  # since Blender 4.4
            made.action_slot = animation.action_slot


def deform_by_no_parent(obj: bpy.types.Object) -> None:
    """Let the parent of an object move it, but no longer deform it."""
    if obj.parent_type in _DEFORMING:
        inverse = obj.matrix_parent_inverse.copy()  # Blender resets it
        obj.parent_type = "OBJECT"
        obj.matrix_parent_inverse = inverse
