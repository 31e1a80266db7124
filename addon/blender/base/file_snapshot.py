# SPDX-License-Identifier: GPL-3.0-or-later
"""The state of a file before an operator, to be restored if the operator fails.

It contains the objects that the operator works on and those that their properties of this add-on
name, with their properties, modifiers and points. New data-blocks are removed. Data-blocks that an
operator deletes are deleted last (all_or_nothing.py), so none has to be created again.
"""

from collections.abc import Iterable, Iterator
from contextlib import suppress
from typing import Any

import bmesh
import bpy
import numpy as np

from ...nodes import inputs_of, restore_inputs
from .property_snapshot import Properties, custom_of, is_group, plain, restore_custom
from .quiet import quiet

_LISTS = (
    *("objects", "meshes", "node_groups", "materials", "collections", "images", "scenes"),
    *("cameras", "lights", "actions", "armatures", "curves", "hair_curves", "texts", "brushes"),
)
# Properties of an object that follow from others, or that nothing here changes.
_LEFT = {"matrix_world", "matrix_local", "matrix_basis", "dimensions", "name", "asset_data", "tag"}
_LEFT |= {"active_material", "active_material_index", "active_shape_key_index", "lightgroup"}
_LEFT |= {"is_runtime_data", "use_extra_user", "active_selection_set"}
_TOOLS = ("mesh_select_mode",)
_RENDER = ("simplify_subdivision", "simplify_subdivision_render")
# Types of mesh attributes: name of the field, numpy's type, numbers per element.
_FIELDS: dict[str, tuple[str, Any, int]] = {
    "FLOAT": ("value", np.float32, 1),
    "INT": ("value", np.int32, 1),
    "INT8": ("value", np.int32, 1),
    "BOOLEAN": ("value", np.bool_, 1),
    "FLOAT_VECTOR": ("vector", np.float32, 3),
    "FLOAT2": ("vector", np.float32, 2),
    "FLOAT_COLOR": ("color", np.float32, 4),
    "BYTE_COLOR": ("color", np.float32, 4),
    "QUATERNION": ("value", np.float32, 4),
    "FLOAT4X4": ("value", np.float32, 16),
    "INT32_2D": ("value", np.int32, 2),
    "INT16_2D": ("value", np.int32, 2),
}


class FileSnapshot:
    """The state of the objects that an operator works on."""

    def __init__(self, context: bpy.types.Context, objects: Iterable[bpy.types.Object]) -> None:
        self._known = {block.session_uid for block in _blocks()}
        self._copies: list[bpy.types.Mesh] = []
        self._view = _View()
        written = [*filter(None, [context.object]), *objects]
        found = _reached(written)
        self._objects = [_Object(obj, obj in written) for obj in found]

    def forget(self) -> None:
        """Free the copies; nothing is to be restored."""
        for one in self._objects:
            one.forget()

    def restore(self) -> None:
        """Restore the state; this does not count as a change of the artist."""
        with quiet():
            self._view.leave_mode()
            for one in self._objects:
                one.restore()
            self._view.restore()
            self.forget()
            new = [block for block in _blocks() if block.session_uid not in self._known]
            bpy.data.batch_remove(new)
            self._view.restore_mode()


def _blocks() -> Iterator[bpy.types.ID]:
    for name in _LISTS:
        yield from getattr(bpy.data, name)


def _reached(objects: Iterable[bpy.types.Object]) -> list[bpy.types.Object]:
    """Objects and those that their properties of add-ons name, each once."""
    found: dict[int, bpy.types.Object] = {}
    waiting = list(objects)
    while waiting:
        obj = waiting.pop()
        if obj.session_uid in found:
            continue
        found[obj.session_uid] = obj
        for name in _groups(obj):
            waiting += _named(getattr(obj, name))
    return list(found.values())


def _groups(obj: bpy.types.Object) -> list[str]:
    """Names of an object's property groups that were set."""
    names = [prop.identifier for prop in obj.bl_rna.properties if is_group(prop)]
    return [name for name in names if obj.is_property_set(name)]


def _named(group: bpy.types.PropertyGroup) -> list[bpy.types.Object]:
    found: list[bpy.types.Object] = []
    for prop in group.bl_rna.properties:
        if prop.type not in {"POINTER", "COLLECTION"}:
            continue
        value = getattr(group, prop.identifier)
        if isinstance(value, bpy.types.Object):
            found.append(value)
        elif is_group(prop):
            for one in value if prop.type == "COLLECTION" else [value]:
                found += _named(one)
    return found


class _View:
    """Active object, mode, selection, frame, cursor and some settings of the scene."""

    def __init__(self) -> None:
        context = bpy.context
        scene, self._layer = context.scene, context.view_layer
        self._scene, self._active = scene, self._layer.objects.active
        self._mode = self._active.mode if self._active is not None else "OBJECT"
        self._selected = {obj.session_uid for obj in self._layer.objects.selected}
        self._time = scene.frame_current, scene.frame_subframe
        self._cursor = tuple(scene.cursor.location)
        self._values = [
            (owner, {name: plain(getattr(owner, name)) for name in names})
            for owner, names in (
                (context.tool_settings, _TOOLS),
                (scene.render, _RENDER),
                (scene, _own_names(scene)),
            )
        ]

    def leave_mode(self) -> None:
        """Go to Object Mode, where data can be written."""
        active = self._layer.objects.active
        if active is not None and active.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")

    def restore(self) -> None:
        layer, scene = self._layer, self._scene
        if layer.objects.active != self._active:
            layer.objects.active = self._active
        for obj in layer.objects:
            selected = obj.session_uid in self._selected
            if obj.select_get(view_layer=layer) != selected:
                obj.select_set(selected, view_layer=layer)
        if (scene.frame_current, scene.frame_subframe) != self._time:
            scene.frame_set(self._time[0], subframe=self._time[1])
        if tuple(scene.cursor.location) != self._cursor:
            scene.cursor.location = self._cursor
        for owner, values in self._values:
            for name, value in values.items():
                if plain(getattr(owner, name)) != value:
                    setattr(owner, name, value)

    def restore_mode(self) -> None:
        if self._active is not None and self._active.mode != self._mode:
            bpy.ops.object.mode_set(mode=self._mode)


def _own_names(scene: bpy.types.Scene) -> list[str]:
    """Properties of scenes that add-ons have registered, without groups."""
    plain = [prop for prop in scene.bl_rna.properties if prop.is_runtime and not prop.is_readonly]
    return [prop.identifier for prop in plain if prop.type not in {"POINTER", "COLLECTION"}]


class _Object:
    """One object: properties, modifiers, vertex groups and points."""

    def __init__(self, obj: bpy.types.Object, written: bool) -> None:
        self._obj = obj
        self._hidden = _hidden(obj)
        self._own = Properties(obj, _LEFT, groups=False)
        self._groups = {name: Properties(getattr(obj, name)) for name in _groups(obj)}
        self._keys = custom_of(obj)
        self._modifiers = [_Modifier(one) for one in obj.modifiers]
        self._vertex_groups = {group.name for group in obj.vertex_groups}
        self._active_group = obj.vertex_groups.active_index
        other = obj.type != "MESH" and obj.data is not None
        self._data = Properties(obj.data, _LEFT, groups=False) if other else None
        mesh = obj.data if obj.type == "MESH" else None
        self._points = None
        if mesh is not None and mesh.library is None and (written or not len(mesh.polygons)):
            self._points = _Points(obj, mesh)

    def restore(self) -> None:
        obj = self._obj
        for name in _groups(obj):
            if name in self._groups:
                self._groups[name].restore()
            else:
                obj.property_unset(name)
        self._own.restore()
        self._restore_modifiers()  # update functions of the properties may have written them
        restore_custom(obj, self._keys)
        for group in [one for one in obj.vertex_groups if one.name not in self._vertex_groups]:
            obj.vertex_groups.remove(group)
        if len(obj.vertex_groups) and obj.vertex_groups.active_index != self._active_group:
            obj.vertex_groups.active_index = self._active_group
        if _hidden(obj) not in (None, self._hidden):
            obj.hide_set(self._hidden)
        if self._data is not None:
            self._data.restore()
        if self._points is not None:
            self._points.restore()

    def forget(self) -> None:
        if self._points is not None:
            self._points.forget()

    def _restore_modifiers(self) -> None:
        names = {one.name for one in self._modifiers}
        for modifier in [one for one in self._obj.modifiers if one.name not in names]:
            self._obj.modifiers.remove(modifier)
        for one in self._modifiers:
            modifier = self._obj.modifiers.get(one.name)
            if modifier is not None:
                one.restore(modifier)


def _hidden(obj: bpy.types.Object) -> bool | None:
    """Whether an object is hidden by its eye icon; None if it is not in the view layer."""
    with suppress(RuntimeError):
        return bool(obj.hide_get())
    return None


class _Modifier:
    def __init__(self, modifier: bpy.types.Modifier) -> None:
        self.name = modifier.name
        self._own = Properties(modifier, {"name", "is_active"}, groups=False)
        is_group = modifier.type == "NODES" and modifier.node_group is not None
        self._inputs = inputs_of(modifier) if is_group else {}

    def restore(self, modifier: bpy.types.Modifier) -> None:
        self._own.restore(modifier)
        if self._inputs and inputs_of(modifier) != self._inputs:
            restore_inputs(modifier, self._inputs)


class _Points:
    """The geometry and the custom properties of a mesh."""

    def __init__(self, obj: bpy.types.Object, mesh: bpy.types.Mesh) -> None:
        self._obj, self._mesh, self._keys = obj, mesh, custom_of(mesh)
        self._edited = self._copy = None
        if obj.mode == "EDIT":
            self._edited = bmesh.from_edit_mesh(mesh).copy()
        elif mesh.shape_keys is None:
            self._copy = mesh.copy()

    def restore(self) -> None:
        mesh = self._mesh
        restore_custom(mesh, self._keys)
        if self._edited is not None:
            self._edited.to_mesh(mesh)
        elif self._copy is not None and _content(mesh) != _content(self._copy):
            edited = bmesh.new()
            edited.from_mesh(self._copy)
            edited.to_mesh(mesh)
            edited.free()
        else:
            return
        mesh.update()
        mesh.update_tag()
        self._obj.update_tag()

    def forget(self) -> None:
        if self._edited is not None:
            self._edited.free()
        if self._copy is not None:
            bpy.data.meshes.remove(self._copy)
        self._edited = self._copy = None


def _content(mesh: bpy.types.Mesh) -> dict[str, Any]:
    """Everything that distinguishes a mesh, without its normals."""
    found: dict[str, Any] = {"edges": [tuple(edge.vertices) for edge in mesh.edges]}
    found["faces"] = [tuple(face.vertices) for face in mesh.polygons]
    for attribute in mesh.attributes:
        field, kind, width = _FIELDS.get(attribute.data_type, ("", None, 0))
        values = np.empty(len(attribute.data) * width, dtype=kind)
        if field:
            attribute.data.foreach_get(field, values)
        key = (attribute.data_type, attribute.domain, len(attribute.data))
        found[f"attribute {attribute.name}"] = (*key, values.tobytes())
    return found
