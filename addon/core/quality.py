# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets of evenness against regularity: more steps and less lambda make more pattern."""

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
