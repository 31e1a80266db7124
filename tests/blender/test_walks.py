# SPDX-License-Identifier: GPL-3.0-or-later
"""Random walks over operators and properties at the ends of their ranges, on scales of 0, hidden
scatters and edited points too. Whatever is refused is refused in a sentence and changes nothing.

DAPPLE_WALKS says how many, DAPPLE_STEPS how long each is, DAPPLE_FIRST with which seed they begin.
"""

import os
import random

import addon_host
import bpy
import numpy as np
import pytest
import scenes
import whole_file
from test_no_density import gradient, stranded

pytestmark = pytest.mark.empty_file  # the node groups are built here

WALKS = int(os.environ.get("DAPPLE_WALKS", "6"))
STEPS = int(os.environ.get("DAPPLE_STEPS", "12"))
FIRST = int(os.environ.get("DAPPLE_FIRST", "0"))
NAME = "Sphere Scatter"
# Operators that only take time, or that are tested separately below.
_LEFT = {
    "count",
    "points_per_area",
    "per_area",
    "max_evaluations",
    "fade_duration",
    "window_sweeps",
}
_OPERATORS = (
    *("optimize", "reattach", "bake", "clear_bake", "make_tiles", "live_preview", "show_density"),
    *("edit_points", "finish_editing_points", "place_point", "add_point", "move_point"),
    *(
        "remove_point",
        "spray_points",
        "lock_points",
        "edit_object_types",
        "select_overlap",
        "select_overlapping",
        "select_small_parts",
        "solo_scatter",
        "copy_scatter",
    ),
    *("paint_density", "paint_blocked_areas", "finish_painting", "mark_asset", "match_subdivision"),
    *(
        "delete_keyframes",
        "export_points",
        "discard_unfinished_bake",
        "remove_material",
        "select_surface",
    ),
)


def scatter():
    return bpy.data.objects[NAME]


def prepared():
    surface = scenes.sphere()
    surface.vertex_groups.new(name="Grass").add(range(300), 1.0, "REPLACE")
    obj = scenes.scattered(surface, 40)
    obj.dapple.density.attribute = "Grass"
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, 2
    return obj


def an_operator(chance, folder):
    name = chance.choice(_OPERATORS)
    if bpy.context.mode != "OBJECT" and chance.random() < 0.5:  # more operators work in object mode
        name = "finish_painting" if bpy.context.mode == "PAINT_WEIGHT" else "finish_editing_points"
    place = tuple(chance.choice([0.0, 1.0, -1e6, 1e6, chance.uniform(-1, 1)]) for _ in range(3))
    given = {
        "place_point": {"location": place},
        "add_point": {"location": place, "object_type": chance.choice([0, 1, 100])},
        "move_point": {"location": place, "id": chance.choice([0, 3, 10**6])},
        "remove_point": {"id": chance.choice([0, 5, 10**6])},
        "spray_points": {
            "stroke": [{"name": "", "location": place, "pressure": 1.0}],
            **{"spacing": chance.choice([0.3, 1.0]), "remove": chance.random() < 0.3},
        },
        "lock_points": {"lock_points": chance.random() < 0.5, "every": chance.random() < 0.5},
        "edit_object_types": {"action": chance.choice(["ADD", "ADD", "REMOVE", "UP", "DOWN"])},
        "delete_keyframes": {"action": chance.choice(["OPTIMIZE", "REATTACH"])},
        "export_points": {"filepath": str(folder / chance.choice(["a.csv", "a.npz", "no/a.csv"]))},
        "match_subdivision": {"use": chance.choice(["RENDER", "VIEWPORT"])},
        "remove_material": {"index": chance.choice([0, 100])},
    }
    return call(name, given.get(name, {}))


def call(name, properties):
    """Call an operator if its poll allows it; returns what it did."""
    if bpy.context.mode == "OBJECT":
        scenes.activate(scatter())
    operator, before = getattr(bpy.ops.dapple, name), None
    if not operator.poll():
        return f"{name} gray"
    before = whole_file.everything()
    try:
        operator("EXEC_DEFAULT", **properties)
    except RuntimeError as error:
        said = str(error)
        assert "failed, nothing was changed" not in said, f"{name} {properties}: {said}"
        assert said.count("\n") == 1, said
        changed = whole_file.differences(before)
        assert changed == {}, f"{name} {properties}: {said} {changed}"
        return f"{name} refused: {said.strip()}"
    return f"{name} {properties}"


def a_property(chance, _folder):
    """A setting at an end of its range, or as by default."""
    own = scatter().dapple
    group = chance.choice([own, own, own.density, own.tiles, *own.object_types])
    names = [
        prop
        for prop in group.bl_rna.properties
        if prop.type in {"FLOAT", "INT", "BOOLEAN", "ENUM"}
        and not (prop.is_readonly or getattr(prop, "is_array", False))
        and prop.identifier not in _LEFT
        and not prop.identifier.startswith(("baked", "surface_", "bound", "solved", "locked"))
    ]
    prop = chance.choice(names)
    if prop.type == "BOOLEAN":
        value = chance.random() < 0.5
    elif prop.type == "ENUM":
        value = chance.choice([item.identifier for item in prop.enum_items])
    else:
        value = chance.choice([prop.hard_min, prop.soft_max, prop.default])
    setattr(group, prop.identifier, value)
    return f"{prop.identifier} = {value}"


def a_count(chance, _folder):
    scatter().dapple.count = value = chance.choice([1, 2, 7, 40, 90])
    return f"count = {value}"


def a_scale(chance, _folder):
    obj = chance.choice([scatter(), scatter().dapple.surface or scatter()])
    axis, value = chance.randrange(3), chance.choice([0.0, 1.0, 1.0, -1.0, 1e-20, 1e20])
    obj.scale[axis] = value
    return f"{obj.name}.scale[{axis}] = {value}"


def a_switch(chance, _folder):
    obj, name = scatter(), chance.choice(["hide_viewport", "hide_render", "eye"])
    if name == "eye":
        obj.hide_set(not obj.hide_get())
    else:
        setattr(obj, name, not getattr(obj, name))
    return name


def a_stroke(chance, _folder):
    """And a solution of it: no point is where the density is 0 then."""
    surface = scatter().dapple.surface
    if surface is None or bpy.context.mode != "OBJECT" or surface.scale[:] != (1.0, 1.0, 1.0):
        return "no stroke"
    middle = np.array([chance.gauss(0.0, 1.0) for _ in range(3)])
    gradient(surface, middle / np.linalg.norm(middle), 0.5, chance.uniform(0.6, 1.2))
    said = call("optimize", {})
    if said.startswith("optimize {") and scatter().dapple.density.attribute == "Grass":
        assert stranded(scatter()) == []
    return f"stroke, {said}"


def shown_again(_chance, _folder):
    """Show a scatter, so that operators can work on it."""
    obj = scatter()
    if bpy.context.mode == "OBJECT":
        obj.hide_viewport = False
        obj.hide_set(False)
        for one in filter(None, (obj, obj.dapple.surface)):
            one.scale = (1.0, 1.0, 1.0)
    return "shown again"


MOVES = (
    *([an_operator] * 8),
    *(a_property, a_property, a_property, a_count, a_scale, a_switch, a_stroke, shown_again),
)


def check():
    """Check what must hold after any step."""
    obj = scatter()
    assert not addon_host.part("blender.base.all_or_nothing").is_open()
    if obj.mode != "OBJECT":
        return
    mesh = obj.data
    count = len(mesh.vertices)
    ids = np.empty(count, dtype=np.int32)
    mesh.attributes["id"].data.foreach_get("value", ids)
    assert len(np.unique(ids)) == count
    places = np.empty(3 * count, dtype=np.float32)
    mesh.vertices.foreach_get("co", places)
    assert np.isfinite(places).all()
    assert np.isfinite(scenes.positions(obj)).all()
    if obj.dapple.baked_keys:
        assert addon_host.part("blender.scatter.key_stores").read_baked(obj).frame_count == 2
    elif obj.dapple.report.count:
        assert obj.dapple.report.count == count
    context = bpy.context
    addon_host.part("blender.freshness.staleness").stale_reason(obj, context)


@pytest.mark.parametrize("seed", range(FIRST, FIRST + WALKS))
def test_walks(seed, tmp_path):
    chance, moves_done = random.Random(seed), []
    prepared()
    bpy.ops.ed.undo_push(message="Prepared")
    try:
        for _ in range(STEPS):
            move = chance.choice(MOVES)
            moves_done.append(move.__name__)
            moves_done[-1] = move(chance, tmp_path)
            bpy.context.view_layer.update()
            check()
    except BaseException:
        steps = "\n  ".join(moves_done)
        print(f"To repeat: DAPPLE_FIRST={seed} DAPPLE_WALKS=1 DAPPLE_STEPS={STEPS}\n  {steps}")
        raise
    finally:
        addon_host.part("blender.density.overlay").stop()
        addon_host.part("blender.display.preview").stop_all()
