# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties are made from the tables of settings, options of the native package among them."""

import addon_host
import bpy
import child
import pytest
import scenes

WITH_AN_OPTION_MORE = """
import tempfile, types
import dapple3d
row = types.SimpleNamespace(
    name="damping", type="float", default=0.25, min=0.0, max=1.0, unit="spacings", choices=[],
    level="basic", documentation="Share of a step that is held back.", changes_solution=True,
)
known = dapple3d.option_table
dapple3d.option_table = lambda verb: [*known(verb), row]
given = []
def taking(solve, seen):
    def taken(*arguments, damping, **options):
        if isinstance(arguments[0], dapple3d.Surface):
            seen.append(damping)
        return solve(*arguments, **options)
    return taken
dapple3d.sample = taking(dapple3d.sample, given)
import addon_host
addon_host.add_repository(addon_host.Path(tempfile.mkdtemp()))
addon_host.enable()
import scenes, test_panels
obj = scenes.scattered(scenes.sphere())
prop = obj.dapple.bl_rna.properties["damping"]
print(prop.name, prop.hard_min, prop.hard_max, prop.default, prop.is_overridable)
print(prop.description)
print("damping" in test_panels.drawn(test_panels.Layout))
obj.dapple.damping = 0.5
print(addon_host.part("blender.scatter.object").settings_reason(obj))
bpy.ops.dapple.optimize()
print(given, addon_host.part("blender.scatter.object").settings_reason(obj) == "")
print(addon_host.part("blender.presets.stored").values_of(obj)[""]["damping"])
addon_host.disable()
"""


def groups():
    """The settings of each group, and its type."""
    own = bpy.types.Object.bl_rna.properties["dapple"].fixed_type.properties
    for group, settings in addon_host.part("core.settings.tables").GROUPS.items():
        yield settings, own[group].fixed_type.properties if group else own


def test_an_option_more_needs_no_line_of_the_add_on():
    said = child.run(WITH_AN_OPTION_MORE).splitlines()
    assert said[-6:] == [
        "Damping 0.0 1.0 0.25 True",
        "Share of a step that is held back. In spacings",
        "True",
        "Settings were changed (Damping): optimize again",
        "[0.25, 0.5] True",
        "0.5",
    ]


def test_properties_are_as_the_tables_say():
    count = 0
    for settings, shown in groups():
        for setting in settings:
            prop = shown[setting.name]
            assert (prop.name, prop.description) == (setting.label, setting.tooltip)
            if prop.type in ("INT", "FLOAT"):
                assert prop.default == pytest.approx(setting.default, rel=1e-6)
                assert setting.low is None or prop.hard_min == pytest.approx(setting.low)
                assert setting.high is None or prop.hard_max == pytest.approx(setting.high)
            count += 1
    assert count >= 60


def test_every_property_of_a_setting_stays_still():
    """Update functions do not run during playback."""
    for settings, shown in groups():
        for setting in settings:
            assert shown[setting.name].type == "POINTER" or not shown[setting.name].is_animatable


def test_a_name_that_no_setting_has_is_an_error():
    """A misspelled name was set without a word, and nothing happened."""
    settings = scenes.scattered(scenes.sphere()).dapple
    for group in (settings, settings.density, settings.object_types.add()):
        with pytest.raises(AttributeError, match="cuont"):
            group.cuont = 5
    groups = [
        one
        for one in addon_host.part("blender.settings.properties").CLASSES
        if issubclass(one, bpy.types.PropertyGroup)
    ]
    assert len(groups) > 5
    assert all("__dict__" not in dir(one) for one in groups)
