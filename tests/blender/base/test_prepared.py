# SPDX-License-Identifier: GPL-3.0-or-later
"""Values that panels show are computed by a timer, never while drawing."""

import types

import addon_host
import bpy
import pytest
import scenes
import test_panels


@pytest.fixture
def prepared(monkeypatch):
    """As in a window: requested values are computed by the next call of the timer."""
    module = addon_host.part("blender.base.panel_values")
    monkeypatch.setattr(module, "at_once", False)
    yield module
    module.SUBSCRIBER.disabled()


@pytest.fixture
def redrawn(prepared, monkeypatch):
    """Counts redraws of the panels."""
    seen = []
    monkeypatch.setattr(prepared, "redraw", lambda: seen.append(1))
    return seen


COSTLY = {
    "blender.surface.subdivision": ("differences",),
    "blender.object_types.panel": ("count_labels",),
    "blender.solve.figure_images": ("details_from", "settings_of"),
    "core.pictures": ("curve", "bars", "pattern"),
    "core.settings.presets": ("names",),
    "blender.assets.library": ("library", "missing_assets"),
}


@pytest.fixture
def computed(monkeypatch):
    """Names of what was computed, walked or read; pictures that another test had drawn are gone."""
    kept = addon_host.part("blender.solve.figure_images")
    kept.unregister()
    kept.register()
    seen = []
    for module, names in COSTLY.items():
        for name in names:
            noting(monkeypatch, addon_host.part(module), name, seen)
    return seen


def noting(monkeypatch, module, name, seen):
    called = getattr(module, name)
    monkeypatch.setattr(module, name, lambda *given: seen.append(name) or called(*given))


def preferences():
    shown = []
    of = types.SimpleNamespace(layout=test_panels.Layout(shown), remove_library=False)
    of.layout.prop = lambda *_, **__: None
    addon_host.part("blender.preferences").DAPPLE_AP_preferences.draw(of, bpy.context)
    return shown


def test_drawing_computes_walks_and_reads_nothing(prepared, redrawn, computed):
    scenes.scattered(scenes.tail(levels=1, render_levels=2))
    assert bpy.ops.dapple.edit_object_types(action="ADD") == {"FINISHED"}
    computed.clear()
    assert "~60" not in test_panels.drawn()
    preferences()
    assert not computed
    assert prepared.tick() is None
    assert {"differences", "count_labels", "pattern", "curve", "bars", "names"} <= set(computed)
    assert redrawn == [1]
    assert "~60" in test_panels.drawn()
    assert "dapple.match_subdivision" in test_panels.drawn()


def test_nothing_is_redrawn_where_nothing_else_is_found(prepared, redrawn):
    scenes.scattered(scenes.sphere())
    for _ in range(3):
        test_panels.drawn()
        prepared.tick()
    redrawn.clear()
    test_panels.drawn()
    prepared.tick()
    assert not redrawn


def test_what_is_not_asked_for_again_is_not_found_again(prepared, computed):
    scenes.scattered(scenes.sphere())
    test_panels.drawn()
    prepared.tick()
    computed.clear()
    prepared.tick()
    assert not computed


def test_a_changed_setting_is_shown_after_the_next_tick(prepared):
    obj = scenes.scattered(scenes.sphere())
    assert bpy.ops.dapple.edit_object_types(action="ADD") == {"FINISHED"}
    test_panels.drawn()
    prepared.tick()
    obj.dapple.count = 77
    assert "~77" not in test_panels.drawn()
    prepared.tick()
    assert "~77" in test_panels.drawn()


def test_a_menu_has_the_presets_that_the_panel_has_asked_for(prepared):
    scenes.scattered(scenes.sphere())
    test_panels.drawn()
    prepared.tick()
    before = test_panels.drawn().count("dapple.load_preset")
    assert bpy.ops.dapple.save_preset(name="Wide") == {"FINISHED"}
    assert test_panels.drawn().count("dapple.load_preset") == before
    prepared.tick()
    assert test_panels.drawn().count("dapple.load_preset") == before + 1
    assert bpy.ops.dapple.remove_preset(name="Wide") == {"FINISHED"}


def test_an_object_that_is_gone_is_forgotten(prepared):
    obj = scenes.scattered(scenes.sphere())
    test_panels.drawn()
    bpy.data.objects.remove(obj)
    prepared.tick()
    assert prepared.known_objects() == {"Sphere"}


@pytest.mark.parametrize("busy", ["rendering", "solving"])
def test_nothing_is_found_meanwhile(prepared, computed, monkeypatch, busy):
    scenes.scattered(scenes.sphere())
    test_panels.drawn()
    computed.clear()
    with monkeypatch.context() as patch:
        if busy == "rendering":
            patch.setattr(prepared.activity, "is_rendering", lambda: True)
        else:
            patch.setattr(prepared.step_operators, "is_under_way", lambda: True)
        assert prepared.tick() > 0.0
        assert not computed
    assert prepared.tick() is None
    assert computed
