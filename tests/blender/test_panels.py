# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels in every state. Blender in background mode has no layout, so a replacement checks all
names.
"""

import types

import addon_host
import bpy
import pytest
import scenes

ICONS = bpy.types.UILayout.bl_rna.functions["label"].parameters["icon"].enum_items.keys()


class Layout:
    """Checks that the names which panels show exist, and records the texts."""

    def __init__(self, shown):
        self.shown = shown

    def row(self, **_):
        return type(self)(self.shown)

    column = box = split = row

    def label(self, text="", icon="NONE", icon_value=0, translate=True):
        assert icon in ICONS
        assert icon_value >= 0
        self.shown.append(text)

    def icon(self, block):
        assert isinstance(block, bpy.types.ID)
        return 0  # Blender without a window returns 0

    def prop(self, data, name, text=None, icon="NONE", **_):
        assert name in data.bl_rna.properties, f"{data} has no {name}"
        assert icon in ICONS
        self.shown.append(name)

    def operator(
        self,
        name,
        text="",
        text_ctxt="",
        icon="NONE",
        icon_value=0,
        depress=False,
        translate=True,
        emboss=True,
    ):
        assert icon in ICONS
        assert icon_value >= 0
        group, verb = name.split(".")
        kind = getattr(getattr(bpy.ops, group), verb).get_rna_type()
        self.shown.append(name)
        return types.SimpleNamespace(**{p.identifier: None for p in kind.properties})

    def prop_search(self, data, name, source, listed):
        assert listed in source.bl_rna.properties
        self.prop(data, name)

    def template_icon(self, icon_value, scale):
        assert icon_value >= 0  # 0 where Blender has no window
        self.shown.append("picture")

    def menu(self, name, text="", icon="NONE"):
        assert icon in ICONS
        kind = getattr(bpy.types, name)
        kind.draw(types.SimpleNamespace(layout=self), bpy.context)

    def progress(self, factor, text):
        assert 0.0 <= factor <= 1.0
        self.shown.append(text)

    def separator(self, factor=1.0):
        assert factor >= 0.0

    def popover(self, panel, text="", icon="NONE"):
        assert icon in ICONS
        assert hasattr(bpy.types, panel)
        self.shown.append(text)

    def operator_menu_enum(self, name, field):
        assert hasattr(self.operator(name), field)

    def template_list(self, kind, _, data, name, active_data, active):
        assert active in active_data.bl_rna.properties
        kind = addon_host.part("blender.main_panel").DAPPLE_UL_object_types
        for index, item in enumerate(getattr(data, name)):
            draw = types.SimpleNamespace()
            kind.draw_item(draw, bpy.context, self, data, item, 0, active_data, active, index)


def drawn(layout=Layout):
    """All texts that panels show for the active object."""
    ui, shown = addon_host.part("blender.main_panel"), []
    for kind in ui.CLASSES:
        if issubclass(kind, bpy.types.Panel) and getattr(kind, "poll", lambda _: True)(bpy.context):
            panel = types.SimpleNamespace(layout=layout(shown))
            if hasattr(kind, "draw_header_preset"):
                kind.draw_header_preset(panel, bpy.context)
            kind.draw(panel, bpy.context)
    return shown


def test_a_surface_is_offered_a_scatter_and_a_new_mesh():
    scenes.sphere()
    assert drawn() == ["dapple.add_scatter", "dapple.remesh"]


def test_a_text_is_offered_both_too():
    bpy.ops.object.text_add()
    assert drawn() == ["dapple.add_scatter", "dapple.remesh"]
    bpy.ops.object.light_add()
    assert "dapple.remesh" not in drawn()


def test_a_scatter_shows_its_settings_and_its_result():
    scenes.scattered(scenes.sphere())
    shown = drawn()
    for name in (
        "count",
        "seed",
        "instance",
        "collection",
        "align_to_normal",
        "attribute",
        "curvature",
    ):
        assert name in shown
    for name in ("dapple.optimize", "dapple.make_tiles", "dapple.bake", "quality"):
        assert name in shown
    assert "points_per_area" not in shown
    assert "% of ideal, up to date" in " ".join(shown)


def test_what_is_instanced_comes_before_the_solver():
    scenes.scattered(scenes.sphere())
    kinds = addon_host.part("blender.main_panel").SUB_PANELS
    titles = [kind.bl_label for kind in kinds if hasattr(kind, "bl_parent_id")]
    assert titles[:4] == ["Instances", "Amount", "Density", "Placement"]
    assert titles[-4:] == ["Animation", "Tiles", "Hair", "Advanced"]
    shown = drawn()
    assert shown.index("instance") < shown.index("count") < shown.index("capacity_weight")


def test_pictures_tell_of_the_result_and_of_the_settings():
    obj = scenes.scattered(scenes.sphere(), count=60)
    details = addon_host.part("core.solve.figures")
    told = details.details_from(obj.dapple.report.details)
    assert sum(told.gaps) == 60
    assert told.energies[-1] < told.energies[0]
    nearest = (0.5 + max(range(details.BINS), key=told.gaps.__getitem__)) / details.BINS
    assert nearest * details.FARTHEST == pytest.approx(obj.dapple.report.alpha_mean, abs=0.1)
    assert drawn().count("picture") == 3
    assert details.details_from("older") == details.Details()


def test_pictures_show_what_they_are_of():
    pictures, of = (
        addon_host.part("core.pictures"),
        addon_host.part("core.settings.values").Settings,
    )
    even, patterned = (
        pictures.pattern(60, settings.sample_options())
        for settings in (of(), of(capacity_weight=0.0, tolerance=1e-6))
    )
    assert not (even == patterned).all()
    falling = pictures.curve([3.0, 1.0, 0.0])[:, :, 3] == 1.0
    top, bottom = falling[len(falling) // 2 :], falling[: len(falling) // 2]
    half = falling.shape[1] // 2
    assert top[:, :half].sum() > 3 * top[:, half:].sum()
    assert bottom[:, half:].sum() > bottom[:, :half].sum()
    bars = pictures.bars([0, 5, 10, 0])
    heights = (bars[:, :, 3] == 1.0).sum(axis=0)
    quarter = len(heights) // 4
    assert heights[:quarter].max() < 0.1 * heights.max()
    assert heights[quarter : 2 * quarter].max() == pytest.approx(heights.max() / 2, abs=3)
    assert pictures.curve([]).shape == pictures.bars([]).shape == (*pictures.SIZE, 4)


def test_what_is_switched_on_is_shown():
    obj = scenes.scattered(scenes.sphere())
    assert "slope_min" not in drawn()
    obj.dapple.density.use_slope = obj.dapple.density.use_height = True
    obj.dapple.amount = "PER_AREA"
    shown = drawn()
    assert {"slope_min", "slope_max", "height_falloff", "points_per_area"} <= set(shown)
    assert "count" not in shown


def test_classes_show_how_many_points_each_gets():
    obj = scenes.scattered(scenes.sphere(), count=90)
    for share in (2.0, 1.0):
        bpy.ops.dapple.edit_object_types(action="ADD")
        obj.dapple.object_types[-1].weight = share
    shown = drawn()
    assert {"~60", "~30", "use_count", "weight", "radius", "density"} <= set(shown)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert {"60", "30"} <= set(drawn())
    obj.dapple.object_types[0].use_count, obj.dapple.object_types[0].count = True, 200
    assert drawn().count("?") == 2, "they ask for more than there are"


def test_an_overlap_can_be_selected():
    obj = scenes.scattered(scenes.sphere())
    assert "dapple.select_overlap" not in drawn()
    obj.dapple.report.worst_overlap = 0.25
    assert "Max overlap 25 %" in drawn()
    obj.dapple.report.worst_overlap = 0.004  # below the limit for a warning
    assert {text for text in drawn() if "overlap" in text} == {"dapple.select_overlapping"}


def test_more_evaluations_are_asked_for_only_where_they_ran_out():
    obj = scenes.scattered(scenes.tail(frames=3), count=30)
    report = obj.dapple.report
    report.converged, report.evaluations = False, obj.dapple.max_evaluations
    assert "Tolerance not reached: increase Max Iterations" in " ".join(drawn())
    report.evaluations = 12
    assert "Tolerance not reached: no step improves the result" in " ".join(drawn())
    assert "increase Max Iterations" not in " ".join(drawn())


@pytest.mark.parametrize("mode", ["KEEP_COUNT", "KEEP_DENSITY"])
def test_a_baked_scatter(mode):
    obj = scenes.scattered(scenes.tail(frames=3), count=30)
    obj.dapple.population = mode
    bpy.ops.dapple.bake()
    shown = drawn()
    assert "Baked: frames 1 to 3" in shown
    obj.dapple.report.converged = False  # frames have their own evaluation limit
    assert not [line for line in drawn() if "Max Iterations" in line]
    assert ("fade_duration" in shown) == (mode == "KEEP_DENSITY")


def test_a_body_with_other_faces_in_the_render_is_reported_in_one_sentence():
    scenes.tail(levels=1, render_levels=2)
    shown = drawn()
    assert "dapple.add_scatter" in shown
    scenes.scattered(bpy.context.object)
    shown = " ".join(drawn())
    assert (
        "Viewport and renders have different faces: points are attached to the rest position"
        in shown
    )
    assert "dapple.match_subdivision" in shown
    assert "Viewport and renders differ" not in shown


def test_what_is_said_leaves_room_for_its_cross(monkeypatch):
    scenes.scattered(scenes.sphere())
    labels = addon_host.part("blender.base.sidebars")
    work = addon_host.part("blender.base.operator_jobs")
    monkeypatch.setattr(
        work, "notes", lambda _: [("INFO", "points are attached to what is there " * 9)]
    )
    shown = drawn()
    said = shown[: shown.index("dapple.hide_message")]
    assert len(said) > 3
    assert max(map(labels.width_of, said)) <= labels.line_width("INFO") - labels.BUTTON


def test_no_label_comes_first_where_a_bar_may_have_been():
    """The mouse was over the bar, and what was said after it looked like a bar."""

    class Marked(Layout):
        def separator(self, factor=1.0):
            self.shown.append(f"separator {factor}")

    scenes.scattered(scenes.sphere())
    assert drawn(Marked)[0] == "separator 0.0"
