# SPDX-License-Identifier: GPL-3.0-or-later
"""Every (context, message) that the add-on shows: from its RNA types, and from its sources."""

import ast

import addon_host
import bpy

_TEMPLATES = {
    "translated": 0,
    "translate": 0,
    "english": 0,
    "translated_report": 0,
    "translated_count": 1,
}  # first argument
_OPERATORS = {"operator", "operator_menu_enum"}


def shown():
    """All messages that the add-on shows."""
    found = set()
    for kind in classes():
        found |= set(_of_class(kind))
    for kind in _tools():
        found |= {("Operator", kind.bl_label), ("*", kind.bl_description)}
    for path in sorted((addon_host.sources() / "blender").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Call):
                found |= set(_of_call(node))
    return {(context, message) for context, message in found if any(map(str.isalpha, message))}


def classes():
    return [
        *addon_host.part("blender").CLASSES,
        *addon_host.part("blender.settings.properties").CLASSES,
    ]


def _tools():
    """Messages of tools in the toolbar, which are not RNA types and are in no list."""
    kinds = bpy.types.WorkSpaceTool.__subclasses__()
    own = [kind for kind in kinds if kind.__module__.startswith(addon_host.MODULE)]
    return {kind.__name__: kind for kind in own}.values()  # the last ones, if it was enabled again


def _of_class(kind):
    rna = kind.bl_rna
    if issubclass(kind, bpy.types.Operator):
        group, verb = kind.bl_idname.split(".")
        rna = getattr(getattr(bpy.ops, group), verb).get_rna_type()
    if issubclass(kind, bpy.types.Operator | bpy.types.Panel | bpy.types.Menu):
        yield rna.translation_context, kind.bl_label
        yield "*", getattr(kind, "bl_description", kind.__doc__) or ""
        yield "*", getattr(kind, "bl_category", "")
    settings = bpy.types.PropertyGroup | bpy.types.AddonPreferences
    if issubclass(kind, bpy.types.Operator | settings):
        own = [one for one in kind.__mro__ if one.__module__.startswith(addon_host.MODULE)]
        for prop in rna.properties:  # Blender translates its own mixins
            if any(prop.identifier in getattr(one, "__annotations__", ()) for one in own):
                yield from _of_property(prop)


def _of_property(prop):
    if prop.name != prop.identifier:
        yield prop.translation_context, prop.name
    yield "*", prop.description
    for item in getattr(prop, "enum_items", ()):
        yield prop.translation_context, item.name
        yield "*", item.description


def _of_call(call):
    """Templates, and the texts of a layout."""
    if isinstance(call.func, ast.Name) and call.func.id in _TEMPLATES:
        for argument in call.args[_TEMPLATES[call.func.id] :]:
            yield from (("*", text) for text in _literals(argument))
    if isinstance(call.func, ast.Attribute):
        given = {word.arg: word.value for word in call.keywords}
        own = getattr(given.get("text_ctxt"), "id", None) == "OWN"
        context = "Dapple" if own else "Operator" if call.func.attr in _OPERATORS else "*"
        for name in {"text", "heading"} & given.keys() if "translate" not in given else ():
            yield from ((context, text) for text in _literals(given[name]))


def _literals(node):
    """A string, or the two of a choice."""
    if isinstance(node, ast.IfExp):
        yield from (*_literals(node.body), *_literals(node.orelse))
    elif isinstance(node, ast.Constant) and isinstance(node.value, str):
        yield node.value
