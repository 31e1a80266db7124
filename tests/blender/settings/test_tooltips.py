# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties, operators and choices say what they are; numbers have a unit and a range."""

import ast

import addon_host
import bpy
import messages
import pytest

WORDS = 3  # fewest words of a sentence
WIDEST = 1e6  # largest range that is useful for dragging
PLAIN = {  # numbers without a unit: counts, factors, indices
    *("count", "points", "points_per_area", "max_evaluations", "evaluations", "noise_detail"),
    *("capacity_weight", "repulsion_weight", "stickiness", "tolerance", "weight", "weight"),
    *("scale", "scale_x", "scale_y", "scale_z"),
    *("seed", "noise_seed", "id", "object_type", "object_type_index", "index"),
    "preview_budget",  # milliseconds, a unit that Blender lacks
}


def types():
    """Class, RNA type and own properties of everything that is registered."""
    for kind in messages.classes():
        rna = kind.bl_rna
        if issubclass(kind, bpy.types.Operator):
            group, verb = kind.bl_idname.split(".")
            rna = getattr(getattr(bpy.ops, group), verb).get_rna_type()
        own = {name for one in kind.__mro__ for name in getattr(one, "__annotations__", ())}
        yield kind, rna, [prop for prop in rna.properties if prop.identifier in own]


def properties():
    """Each of them with its type."""
    return [(kind, prop) for kind, _, own in types() for prop in own]


def named_in_panels():
    """All strings in the sources of panels, names of what they show among them."""
    sources = [*(addon_host.sources() / "blender").rglob("*panel.py")]
    assert len(sources) > 8
    trees = [ast.parse(path.read_text()) for path in sources]
    nodes = [node for tree in trees for node in ast.walk(tree)]
    return {node.value for node in nodes if isinstance(node, ast.Constant)}


def numbers():
    """Those that an artist sees: settings, arguments of operators, figures of the result."""
    tables = addon_host.part("core.settings.tables").GROUPS.values()
    shown = named_in_panels() | {setting.name for table in tables for setting in table}
    for kind, prop in properties():
        is_shown = issubclass(kind, bpy.types.Operator) or prop.identifier in shown
        if prop.type in ("INT", "FLOAT") and is_shown and not prop.is_array:
            yield kind, prop


def complaints(found, fits):
    return [f"{kind.__name__}.{prop.identifier}" for kind, prop in found if not fits(prop)]


def is_sentence(text):
    return len(text.split()) >= WORDS and text[0].isupper() and not text.endswith(".")


def test_every_property_has_a_name_and_a_sentence():
    assert len(properties()) > 150
    assert not complaints(properties(), lambda prop: is_sentence(prop.description))
    assert not complaints(properties(), lambda prop: prop.name not in ("", prop.identifier))


def test_every_button_and_menu_has_a_sentence():
    kinds = bpy.types.Operator | bpy.types.Menu
    buttons = [kind for kind, _, _ in types() if issubclass(kind, kinds)]
    assert len(buttons) > 30
    told = {kind.__name__: getattr(kind, "bl_description", kind.__doc__) for kind in buttons}
    assert not [name for name, text in told.items() if len((text or "").split()) < 2]


def test_every_choice_says_what_it_means():
    found = [
        (kind, prop, item)
        for kind, prop in properties()
        for item in getattr(prop, "enum_items", ())
    ]
    assert len(found) > 50
    silent = [
        f"{kind.__name__}.{prop.identifier}: {item.identifier}"
        for kind, prop, item in found
        if len(item.description.split()) < 2 or item.description == item.name
    ]
    assert not silent


def test_numbers_can_be_dragged():
    """Where sliders end is within what is allowed, and no end is out of reach."""

    def fits(prop):
        ends = (prop.hard_min, prop.soft_min, prop.soft_max, prop.hard_max)
        return list(ends) == sorted(ends) and prop.soft_max - prop.soft_min <= WIDEST

    assert len(list(numbers())) > 80
    assert not complaints(numbers(), fits)
    assert not complaints(numbers(), lambda prop: prop.soft_min <= prop.default <= prop.soft_max)


def test_numbers_have_their_unit():
    """Shares are sliders, and what has no unit is known to have none."""

    def fits(prop):
        is_share = prop.subtype in ("FACTOR", "PERCENTAGE", "TIME")
        return is_share or prop.unit != "NONE" or prop.identifier in PLAIN

    assert not complaints(numbers(), fits)


CALLED = {"LENGTH": ("Distance", "Radius", "Height"), "ROTATION": ("Angle", "Direction as")}


@pytest.mark.parametrize("unit", CALLED)
def test_lengths_and_angles_are_called_so(unit):
    found = [(kind, prop) for kind, prop in numbers() if prop.unit == unit]
    assert len(found) > 5
    named = [
        (kind, prop)
        for kind, prop in numbers()
        if prop.description.startswith(CALLED[unit]) and prop.subtype != "FACTOR"
    ]
    assert not complaints(named, lambda prop: prop.unit == unit)
