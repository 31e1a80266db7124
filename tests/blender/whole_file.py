# SPDX-License-Identifier: GPL-3.0-or-later
"""The contents of a file as comparable text, which a failing operator must not change."""

import bpy
import numpy as np

_LISTS = ("objects", "meshes", "node_groups", "collections", "materials", "scenes", "images")
_LISTS += ("hair_curves",)
_FIELDS = {
    "FLOAT": ("value", np.float32, 1),
    "INT": ("value", np.int32, 1),
    "INT8": ("value", np.int32, 1),
    "BOOLEAN": ("value", np.bool_, 1),
    "FLOAT_VECTOR": ("vector", np.float32, 3),
    "FLOAT2": ("vector", np.float32, 2),
    "FLOAT_COLOR": ("color", np.float32, 4),
    "BYTE_COLOR": ("color", np.float32, 4),
    "INT32_2D": ("value", np.int32, 2),
    "INT16_2D": ("value", np.int32, 2),
}
_VOLATILE = {
    "rna_type",
    "is_updated",
    "is_evaluated",
    "session_uid",
    "original",
    "tag",
    "dimensions",
}


def everything():
    """Lines that describe the file, the selection and the modes."""
    bpy.context.view_layer.update()
    found = {f"bpy.data.{name}": sorted(_names(getattr(bpy.data, name))) for name in _LISTS}
    for obj in bpy.data.objects:
        found[f"object {obj.name}"] = values(obj)
        found[f"object {obj.name} mode"] = obj.mode
        found[f"object {obj.name} keys"] = custom(obj)
        found[f"object {obj.name} groups"] = (
            [group.name for group in obj.vertex_groups],
            obj.vertex_groups.active_index,
        )
        for modifier in obj.modifiers:
            found[f"object {obj.name} modifier {modifier.name}"] = values(modifier)
            found[f"object {obj.name} inputs {modifier.name}"] = custom(modifier)
    for mesh in bpy.data.meshes:
        found[f"mesh {mesh.name}"] = content(mesh)
        found[f"mesh {mesh.name} keys"] = custom(mesh)
    for collection in [*bpy.data.collections, *(one.collection for one in bpy.data.scenes)]:
        found[f"collection {collection.name}"] = (
            _names(collection.objects),
            _names(collection.children),
            collection.hide_viewport,
            collection.hide_render,
        )
    for scene in bpy.data.scenes:
        found[f"scene {scene.name}"] = values(scene), custom(scene), values(scene.cursor)
        found[f"scene {scene.name} render"] = values(scene.render)
    layer = bpy.context.view_layer
    found["active"] = getattr(layer.objects.active, "name", None)
    found["selected"] = sorted(_names(layer.objects.selected))
    found["hidden"] = sorted(one.name for one in layer.objects if one.hide_get())
    found["select mode"] = tuple(bpy.context.tool_settings.mesh_select_mode)
    return {name: repr(one) for name, one in found.items()}


def differences(before):
    """Lines that have changed."""
    now = everything()
    names = [name for name in before.keys() | now.keys() if before.get(name) != now.get(name)]
    return {name: _apart(before.get(name) or "", now.get(name) or "") for name in sorted(names)}


def _apart(before, now):
    """Both texts from shortly before where they part."""
    at = next((k for k, pair in enumerate(zip(before, now, strict=False)) if pair[0] != pair[1]), 0)
    return before[max(at - 20, 0) : at + 70], now[max(at - 20, 0) : at + 70]


def _names(blocks):
    return [one.name_full for one in blocks]


def values(struct, inside=True):
    """Properties of a struct, with those of property groups inside."""
    found = {}
    for prop in struct.bl_rna.properties:
        name = prop.identifier
        if name in _VOLATILE or (prop.is_readonly and prop.type not in {"POINTER", "COLLECTION"}):
            continue
        value = getattr(struct, name)
        if isinstance(value, bpy.types.PropertyGroup):
            found[name] = values(value) if struct.is_property_set(name) else "unset"
        elif isinstance(value, bpy.types.ID):
            found[name] = value.name_full
        elif prop.type == "COLLECTION":
            group = prop.fixed_type.base == bpy.types.PropertyGroup.bl_rna
            found[name] = [values(one) for one in value] if group else len(value)
        elif prop.type != "POINTER":
            found[name] = plain(value)
            if isinstance(struct, bpy.types.PropertyGroup):
                found[f"{name} set"] = struct.is_property_set(name)
    return found


def plain(value):
    if hasattr(value, "name_full"):
        return value.name_full
    if hasattr(value, "to_dict"):
        return {key: plain(one) for key, one in value.to_dict().items()}
    if isinstance(value, set):
        return sorted(value)
    if isinstance(value, str) or not hasattr(value, "__len__"):
        return value
    return [plain(one) for one in value]


def custom(block):
    registered = {prop.identifier for prop in block.bl_rna.properties}
    if isinstance(block, bpy.types.Modifier) and block.type != "NODES":
        return {}
    return {key: plain(block[key]) for key in sorted(set(block.keys()) - registered)}


def content(mesh):
    found = {"edges": [tuple(edge.vertices) for edge in mesh.edges]}
    found["faces"] = [(*face.vertices, face.material_index) for face in mesh.polygons]
    found["materials"] = [one and one.name for one in mesh.materials]
    for attribute in sorted(mesh.attributes, key=lambda one: one.name):
        field, kind, width = _FIELDS.get(attribute.data_type, ("", np.int32, 0))
        stored = np.empty(len(attribute.data) * width, dtype=kind)
        if field:
            attribute.data.foreach_get(field, stored)
        found[attribute.name] = (attribute.data_type, attribute.domain, stored.tobytes())
    return found
