# SPDX-License-Identifier: GPL-3.0-or-later
"""What scripts/spelling.py takes for a British spelling."""

import importlib.util
from pathlib import Path

import pytest

_PATH = Path(__file__).parents[2] / "scripts" / "spelling.py"
_SPEC = importlib.util.spec_from_file_location("spelling", _PATH)
spelling = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(spelling)


@pytest.mark.parametrize(
    ("line", "found"),
    [
        ("bpy.ops.dapple.optimise()", "optimise"),
        ("_COLOURS = order_of_neighbours", "COLOUR"),
        ("class NormalisedValue:", "Normalise"),
        ("analysed along the center", "analysed"),
        ("analyses of a realistic, modeled emphasis, fulfilled and programmed", ""),
        ('return {"CANCELLED"}', ""),
    ],
)
def test_british_spellings_are_found(line, found):
    assert spelling.british(line) == found


@pytest.mark.parametrize(
    ("line", "found"),
    [
        ("passes forwards and backwards", "forwards"),
        ("BACKWARDS, as what of it is left", "BACKWARDS"),
        ("no handler hears of it", "hears"),
        ("go forward, toward the surface", ""),
    ],
)
def test_withdrawn_words_are_found(line, found):
    assert spelling.withdrawn(line) == found
