# SPDX-License-Identifier: GPL-3.0-or-later
"""A type checker knows the settings of the add-on."""

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
CODE = """
from dataclasses import replace

import bpy
from addon.core.settings.values import ClassSettings, DensitySettings, Settings, TileSettings

settings = Settings({keyword}=5, object_types=(ClassSettings(count=3),))
print(settings.{name}, settings.density.{of_density}, TileSettings().grout + 1.0)
print(replace(settings, {keyword}=7), settings.object_types[0].radius, DensitySettings().materials)


def of(obj: bpy.types.Object, context: bpy.types.Context) -> float:
    weight: float = context.object.dapple.object_types[0].weight
    return obj.dapple.{of_object} * obj.dapple.density.{of_density} + weight
"""


def errors(keyword="count", name="merge_doubled", of_density="slope_min", of_object="scale"):
    """What mypy says of a module that uses settings by these names."""
    code = CODE.format(keyword=keyword, name=name, of_density=of_density, of_object=of_object)
    command = [sys.executable, "-m", "mypy", "--no-error-summary", "-c", code]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True).stdout


@pytest.mark.skipif(importlib.util.find_spec("mypy") is None, reason="mypy is not installed")
def test_a_misspelled_setting_is_refused_by_mypy():
    assert errors() == ""
    assert '"Settings" has no attribute "merge_double"' in errors(name="merge_double")
    assert '"DensitySettings" has no attribute "slope_form"' in errors(of_density="slope_form")
    misspelled = errors(of_object="sclae", of_density="slope_form")
    assert '"DAPPLE_PG_scatter" has no attribute "sclae"' in misspelled
    assert '"DAPPLE_PG_density" has no attribute "slope_form"' in misspelled
    told = errors(keyword="counts")
    assert 'Unexpected keyword argument "counts" for "Settings"' in told
    assert 'Unexpected keyword argument "counts" for "replace"' in told
