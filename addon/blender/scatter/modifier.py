# SPDX-License-Identifier: GPL-3.0-or-later
"""The modifier that plays a scatter back: its node group and its inputs.

Inputs that the artist edits in the modifier tab are copied to the panel, so that the panel does not
overwrite them. The last inputs of each modifier are remembered during the session; inputs that
differ from them and from the panel were edited.
"""

import math
from dataclasses import dataclass
from typing import Any

import bpy

from ...core.settings.display_table import DISPLAY_AS, WHERE
from ...nodes import (
    DETAIL_INPUTS,
    GROUP_NAME,
    INPUTS,
    INSTANCE_INPUTS,
    ensure_group,
    get_input,
    has_input,
    input_name,
    input_names,
    is_current,
    set_input,
    version_of,
)
from ..base.handlers import Evaluation, Subscriber
from ..base.quiet import is_quiet
from ..base.translation import english
from .linked_data import read_only
from .object import is_fluid, is_scatter, settings_reason
from .placed_objects import weights_text

_WEIGHTS, _UV_MAP = "Weights", "Color UV Map"
_DISPLAYS = [name for name, *_ in DISPLAY_AS]
_SINGLE = 1e-6  # relative precision of Blender's numbers
_known: dict[int, dict[str, Any]] = {}  # inputs by the scatter's session_uid


def scatter_modifier(obj: bpy.types.Object) -> bpy.types.NodesModifier | None:
    """The modifier that plays the scatter back."""
    for modifier in obj.modifiers:
        if modifier.type == "NODES" and version_of(modifier.node_group) > 0:
            return modifier
    return None


def ensure_modifier(obj: bpy.types.Object) -> bpy.types.NodesModifier:
    """The modifier with the current node group."""
    modifier = scatter_modifier(obj)
    if modifier is None:
        modifier = obj.modifiers.new(GROUP_NAME, "NODES")
    # A linked group that is current stays: overrides save changes of a linked modifier only.
    if not is_current(modifier.node_group, len(obj.dapple.object_types), _is_detailed(obj)):
        _exchange_group(obj, modifier)
        write_instance_inputs(obj)
    return modifier


def _exchange_group(obj: bpy.types.Object, modifier: bpy.types.NodesModifier) -> None:
    """Give a modifier the group that the scatter needs now; common inputs keep their values."""
    before = _inputs(modifier)
    modifier.node_group = ensure_group(len(obj.dapple.object_types), _is_detailed(obj))
    for name, value in before.items():
        if has_input(modifier, name):
            set_input(modifier, name, value)
    write_surface_inputs(obj, modifier)


def _is_detailed(obj: bpy.types.Object) -> bool:
    """Whether fewer points are shown at a distance, in the viewport or in renders."""
    return any(getattr(obj.dapple, setting.name) for setting in WHERE)


def _inputs(modifier: bpy.types.NodesModifier) -> dict[str, Any]:
    """Inputs that do not depend on the number of object types; none if there is no group."""
    if modifier.node_group is None:
        return {}
    names = [name for name, kind in INPUTS if kind != "NodeSocketGeometry"]
    return {name: get_input(modifier, name) for name in names if has_input(modifier, name)}


def write_inputs(obj: bpy.types.Object) -> None:
    """Set all inputs of the node group from the scatter's properties."""
    write_surface_inputs(obj, ensure_modifier(obj))
    write_instance_inputs(obj)


def write_surface_inputs(obj: bpy.types.Object, modifier: bpy.types.NodesModifier) -> None:
    """Set the inputs of the node group that describe the binding."""
    set_input(modifier, "Surface", obj.dapple.surface)
    set_input(modifier, "Surface Vertices", obj.dapple.surface_vertices)
    set_input(modifier, "Rest Binding", obj.dapple.attached_to == "REST")
    set_input(modifier, "Rest Parts", obj.dapple.attached_parts)
    set_input(modifier, "Rest Vertices", _rest_vertices(obj))
    set_input(modifier, "Spacing", obj.dapple.report.spacing)


def _rest_vertices(obj: bpy.types.Object) -> int:
    """Number of vertices of a surface on which points are played by faces, which is faster and
    gives the same result; 0: never.

    If the artist chose the rest position, modifiers may make other faces with as many vertices.
    """
    surface, topologies = obj.dapple.surface, obj.dapple.surface_topology.split()
    by_itself = obj.dapple.attach_to == "AUTO" and surface is not None and not is_fluid(surface)
    return obj.dapple.surface_vertices if by_itself and len(topologies) == 1 else 0


def write_instance_inputs(obj: bpy.types.Object) -> None:
    """Set the inputs of the node group that describe the instances."""
    modifier = scatter_modifier(obj)
    if modifier is None:
        return
    if _lacks_inputs(obj, modifier):
        _exchange_group(obj, modifier)
    for linked in linked_inputs(obj, modifier):
        set_input(modifier, linked.name, linked.value())
    if has_input(modifier, _UV_MAP):
        set_input(modifier, _UV_MAP, _uv_map(obj) if obj.dapple.color_image else "")
    for index, kind in _kinds(obj):
        if has_input(modifier, input_name(_WEIGHTS, index)):
            set_input(modifier, input_name(_WEIGHTS, index), weights_text(kind))
    obj.update_tag()


def _kinds(obj: bpy.types.Object) -> list[tuple[int | None, bpy.types.PropertyGroup]]:
    """The object types with their indices; without object types the scatter's own settings."""
    return list(enumerate(obj.dapple.object_types)) or [(None, obj.dapple)]


def _lacks_inputs(obj: bpy.types.Object, modifier: bpy.types.NodesModifier) -> bool:
    """Whether the group lacks an input that the settings need."""
    detailed, known = _is_detailed(obj), input_names(modifier)
    other = detailed != (DETAIL_INPUTS[0][0] in known)
    other = other or (obj.dapple.display_as != "INSTANCES" and "Display" not in known)
    colored = obj.dapple.color_attribute or obj.dapple.color_image is not None
    other = other or (bool(colored) and _UV_MAP not in known)
    return other or any(_lacks_own(known, kind, index) for index, kind in _kinds(obj))


def _uv_map(obj: bpy.types.Object) -> str:
    """Name of the UV map of the color image: by default the one that the surface is rendered with,
    or the first of its parts that has one.
    """
    surface = obj.dapple.surface
    if obj.dapple.color_uv_map or surface is None:
        return str(obj.dapple.color_uv_map)
    parts = [surface, *(one.object for one in surface.dapple.joined.entries)]
    layers = [getattr(part.data, "uv_layers", ()) for part in parts if part is not None]
    return next((one.name for part in layers for one in part if one.active_render), "")


def _lacks_own(known: set[str], kind: bpy.types.PropertyGroup, index: int | None) -> bool:
    """Whether the group lacks an input of an object type that differs from its default."""
    if weights_text(kind) and input_name(_WEIGHTS, index) not in known:
        return True
    numbers = [name for name, socket in INSTANCE_INPUTS if socket == "NodeSocketFloat"]
    return any(
        getattr(kind, property_name(name)) != kind.bl_rna.properties[property_name(name)].default
        for name in numbers
        if input_name(name, index) not in known
    )


def property_name(label: str) -> str:
    """The property of one of INSTANCE_INPUTS."""
    return label.lower().replace(" ", "_")


@dataclass(frozen=True)
class LinkedInput:
    """An input of the node group that shows a property of the panel."""

    name: str
    owner: bpy.types.PropertyGroup
    property: str

    def value(self) -> Any:
        """The value of the property, as the input takes it."""
        return _to_input(self.property, getattr(self.owner, self.property))

    def take_over(self, value: Any) -> None:
        """Set the property to a value of the input."""
        setattr(self.owner, self.property, _from_input(self.property, value))


def linked_inputs(obj: bpy.types.Object, modifier: bpy.types.NodesModifier) -> list[LinkedInput]:
    """The inputs of the node group that are linked to properties."""
    found = [
        LinkedInput("Hidden", obj.dapple, "viewport_share"),
        LinkedInput("Display", obj.dapple, "display_as"),
        LinkedInput("Lean Object", obj.dapple, "lean_object"),
        LinkedInput("Color Attribute", obj.dapple, "color_attribute"),
        LinkedInput("Color Image", obj.dapple, "color_image"),
    ]
    found += [LinkedInput(name, obj.dapple, property_name(name)) for name, _ in DETAIL_INPUTS]
    for index, kind in _kinds(obj):
        found += [
            LinkedInput(input_name(name, index), kind, property_name(name))
            for name, _ in INSTANCE_INPUTS
        ]
    known = input_names(modifier)
    return [one for one in found if one.name in known]


def _to_input(name: str, value: Any) -> Any:
    if name == "viewport_share":
        return 1.0 - value
    return _DISPLAYS.index(value) if name == "display_as" else value


def _from_input(name: str, value: Any) -> Any:
    if name == "viewport_share":
        return 1.0 - value
    return _DISPLAYS[min(max(value, 0), len(_DISPLAYS) - 1)] if name == "display_as" else value


def write_warning(obj: bpy.types.Object) -> None:
    """Set the warning of the modifier, which it shows if settings have changed since the result."""
    modifier = scatter_modifier(obj)
    if modifier is not None and has_input(modifier, "Warning"):
        set_input(modifier, "Warning", settings_reason(obj, english))
        obj.update_tag()


def _updated(evaluation: Evaluation) -> None:
    if is_quiet():
        return
    for obj, update in evaluation.objects():
        if update.geometry and is_scatter(obj):
            _take_over(obj)


def _take_over(obj: bpy.types.Object) -> None:
    """Copy edited inputs to the panel."""
    modifier = scatter_modifier(obj)
    if modifier is None:
        return
    found = [(linked, get_input(modifier, linked.name)) for linked in linked_inputs(obj, modifier)]
    before = _known.get(obj.session_uid, {})
    _known[obj.session_uid] = {linked.name: _remembered(value) for linked, value in found}
    if read_only(obj):
        return
    for linked, value in found:
        now = _remembered(value)
        edited = not _same(before.get(linked.name, now), now)
        if edited and not _same(_remembered(linked.value()), now):
            linked.take_over(value)


def _remembered(value: Any) -> Any:
    """A value that stays valid after an undo: the session_uid of a data-block."""
    return ("", value.session_uid) if isinstance(value, bpy.types.ID) else value


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=_SINGLE)
    return bool(one == other)


SUBSCRIBER = Subscriber(updated=_updated, before_load=_known.clear, disabled=_known.clear)
