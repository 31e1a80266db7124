# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets of evenness against regularity: more steps and less lambda make more pattern."""

import math
from typing import Any

from .solver_options import EVENNESS

# Name, label, what it looks like: as Blender lists choices.
QUALITIES = [
    ("DRAFT", "Draft", "Quick preview: even, with a few close pairs"),
    ("NATURAL", "Natural", "Even without any pattern, like grass or pebbles"),
    ("FINE", "Fine", "More even than Natural and slightly more regular, at twice the time"),
    (
        "REGULAR",
        "Regular",
        "Nearly the same distance between neighbors, like scales or cobblestones",
    ),
    ("HONEYCOMB", "Honeycomb", "Patches of hexagons, as far as the surface allows"),
]
_PRESETS: dict[str, dict[str, Any]] = {
    "DRAFT": {"tolerance": 5e-4, "max_evaluations": 30},
    "NATURAL": {},
    "FINE": {"tolerance": 1e-5},
    "REGULAR": {"capacity_weight": 5.0, "tolerance": 2e-6, "max_evaluations": 400},
    "HONEYCOMB": {"capacity_weight": 0.0, "tolerance": 1e-6, "max_evaluations": 600},
}


def quality_settings(name: str) -> dict[str, Any]:
    """What the preset of that name sets; the rest of these are at their defaults."""
    return {setting.name: setting.default for setting in EVENNESS} | _PRESETS[name]


CUSTOM = ("CUSTOM", "Custom", "Settings in Advanced that are those of no other quality")
_SINGLE = 1e-6  # relative precision of Blender's numbers


def quality_of(values: dict[str, Any]) -> str:
    """The name of the preset that has these values; CUSTOM if there is none."""
    for name, *_ in QUALITIES:
        wanted = quality_settings(name)
        if all(_same(values.get(key), one) for key, one in wanted.items()):
            return name
    return CUSTOM[0]


def _same(value: float | None, wanted: float) -> bool:
    return value is not None and math.isclose(value, wanted, rel_tol=_SINGLE)
