# SPDX-License-Identifier: GPL-3.0-or-later
"""Mark as Asset: a copy of a scatter for any surface.

It has the settings, the object types and their objects, but no points, no bake and no reference to
the original surface, which would otherwise be appended too.
"""

from collections.abc import Iterator

import bpy

from ...core.settings.descriptors import Kind
from ...core.settings.tables import GROUPS
from ...core.surface.records import SCHEMA, SCHEMA_KEY
from ...nodes import get_input, has_input, set_input
from ..scatter.key_stores import STORES

CATALOG = "0d1cf1b0-2a3e-4e0b-8d53-2f6f6b0c9a71"  # as in assets/blender_assets.cats.txt
TAGS = ("scatter", "blue noise")
_PARTS = "dapple_instances"  # custom property: a collection that comes along
_BLOCKS = (Kind.OBJECT, Kind.COLLECTION, Kind.MATERIALS)
_KEPT = {"rna_type", "name", "auto_update", "quality", "density", "tiles"}
_KEPT |= {"object_types", "object_type_index", "weights"}  # lists


def marked(obj: bpy.types.Object) -> bpy.types.Object:
    """A new asset made from a scatter, which is not changed."""
    asset = obj.copy()
    asset.name = f"{obj.name} Asset"
    asset.data = empty_mesh(asset.name)
    _clear_place(asset, obj)
    _clear_result(asset)
    collect_instances(asset)
    asset.asset_mark()
    metadata = asset.asset_data
    metadata.description, metadata.catalog_id = _description(asset), CATALOG
    for tag in TAGS:
        metadata.tags.new(tag, skip_if_exists=True)
    return asset


def empty_mesh(name: str) -> bpy.types.Mesh:
    """The mesh of a scatter without points."""
    mesh = bpy.data.meshes.new(name)
    mesh[SCHEMA_KEY] = SCHEMA
    return mesh


def instanced(obj: bpy.types.Object) -> set[bpy.types.Object]:
    """The objects that a scatter instances."""
    found = set()
    for kind in _kinds(obj):
        found |= {kind.instance} if kind.instance else set()
        found |= set(kind.collection.all_objects) if kind.collection else set()
    return found


def _kinds(obj: bpy.types.Object) -> list[bpy.types.PropertyGroup]:
    """The properties that can have instances: the scatter itself, and its object types."""
    return [obj.dapple, *obj.dapple.object_types]


def _clear_place(asset: bpy.types.Object, obj: bpy.types.Object) -> None:
    """Remove references to the place of the original scatter."""
    gone = {obj.dapple.surface, obj.parent}
    asset.parent = None
    asset.matrix_world.identity()
    asset.animation_data_clear()
    asset.constraints.clear()
    asset.dapple.property_unset("surface")
    asset.dapple.tiles.property_unset("object")
    for setting in (one for one in GROUPS["density"] if one.kind in _BLOCKS):
        asset.dapple.density.property_unset(setting.name)
    for modifier in asset.modifiers:
        for prop in modifier.bl_rna.properties:
            if prop.type == "POINTER" and getattr(modifier, prop.identifier) in gone - {None}:
                setattr(modifier, prop.identifier, None)
        for name in _object_inputs(modifier):
            if name in STORES or get_input(modifier, name) in gone:
                set_input(modifier, name, None)


def _object_inputs(modifier: bpy.types.Modifier) -> Iterator[str]:
    group = modifier.node_group if modifier.type == "NODES" else None
    for item in group.interface.items_tree if group else ():
        is_object = item.item_type == "SOCKET" and item.socket_type == "NodeSocketObject"
        if is_object and has_input(modifier, item.name):
            yield item.name


def _clear_result(asset: bpy.types.Object) -> None:
    """Reset all properties that are not settings, since they describe a result."""
    settings = {setting.name for setting in GROUPS[""]}
    for prop in asset.dapple.bl_rna.properties:
        if prop.identifier not in settings | _KEPT:
            asset.dapple.property_unset(prop.identifier)


def collect_instances(asset: bpy.types.Object) -> None:
    """Put the instanced objects into a hidden collection of the asset.

    When Blender appends an asset, it also appends the collection of an object and puts its objects
    into the scene. So that it finds the hidden collection, all objects are directly in it.
    """
    parts = bpy.data.collections.new(f"{asset.name} Instances")
    parts.hide_viewport = parts.hide_render = True
    for kind in _kinds(asset):
        if kind.collection is not None and kind.collection.name not in parts.children:
            parts.children.link(kind.collection)
    for obj in sorted(instanced(asset), key=lambda one: one.name_full):
        parts.objects.link(obj)
    asset[_PARTS] = parts


def _description(asset: bpy.types.Object) -> str:
    names = sorted(obj.name for obj in instanced(asset))
    more = f" and {len(names) - 3} more" if len(names) > 3 else ""
    return f"Scatters {', '.join(names[:3]) or 'points'}{more} evenly on a surface that you choose"
