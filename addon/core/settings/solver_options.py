# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of the native package that an artist sets, as settings.

Name, type, default, range and whether they change the solution are those of the package's own
table, read when the add-on is enabled. Here are the words of Blender's interface where they differ,
and narrower ranges. An option that has no words here is called by its name, and its tooltip is its
documentation. Without the package there are no options.
"""

import math
from typing import Any

from ..base.errors import MissingPackageError
from ..base.native import package
from .descriptors import Changes, Choices, Kind, Setting

_KINDS = {"float": Kind.NUMBER, "int": Kind.WHOLE, "bool": Kind.SWITCH, "str": Kind.CHOICE}
_MOST = 2**31 - 1  # of a whole number in Blender
_WORDS: dict[str, dict[str, Any]] = {
    "seed": {
        "label": "Seed",
        "tooltip": "Seed of the random start; each seed gives another scatter",
        "soft_high": 10_000,
    },
    "capacity_weight": {
        "label": "Area Uniformity",
        "tooltip": "How strongly the areas of the points are made equal, at the expense of "
        "regular spacing",
        "soft_high": 100.0,
    },
    "repulsion_weight": {
        "label": "Separation",
        "tooltip": "How strongly close neighbors are pushed apart",
        "soft_high": 10.0,
    },
    "tolerance": {
        "label": "Tolerance",
        "tooltip": "Stop when the relative decrease of the energy falls below this value; "
        "smaller is more regular",
        "low": 1e-9,
        "high": 1.0,
        "precision": 7,
    },
    "max_evaluations": {
        "label": "Max Iterations",
        "tooltip": "Stop after this many evaluations of the energy",
        "soft_high": 1000,
    },
    "stickiness": {
        "label": "Stickiness",
        "tooltip": "How firmly points stick to their place on the deforming surface; with higher "
        "values they slide less and are less even",
        "soft_high": 100.0,
    },
}
# Identifier, label and description, as Blender lists choices.
QUALITIES = [
    ("DRAFT", "Draft", "Quick preview: even, with a few close pairs"),
    ("NATURAL", "Natural", "Even, without a visible pattern, like grass or pebbles"),
    ("FINE", "Fine", "More even than Natural and slightly more regular, in twice the time"),
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
    "REGULAR": {"capacity_weight": 5.0, "tolerance": 5e-5, "max_evaluations": 400},
    "HONEYCOMB": {"capacity_weight": 0.0, "tolerance": 1e-4, "max_evaluations": 600},
}
CUSTOM = ("CUSTOM", "Custom", "Settings in Advanced that match no other quality")
_SINGLE = 1e-6  # relative precision of Blender's numbers


def _basic(verb: str) -> dict[str, Any]:
    """The options of a function that every interface has, by name."""
    try:
        rows = package().option_table(verb)
    except MissingPackageError:
        return {}
    return {row.name: row for row in rows if row.level == "basic"}


def _setting(row: Any, changes: Changes) -> Setting:
    made: dict[str, Any] = {
        "label": _title(row.name),
        "tooltip": _tooltip(row),
        "low": row.min,
        "high": row.max if row.type == "float" or row.max is None else min(row.max, _MOST),
        "choices": _choices(row),
        "changes": changes if row.changes_solution else Changes.NOTHING,
    }
    return Setting(row.name, _KINDS[row.type], row.default, **(made | _WORDS.get(row.name, {})))


def has_own_words(option: Setting) -> bool:
    """Whether an option is called otherwise in Blender than in the package."""
    return option.name in _WORDS


def _title(name: str) -> str:
    return name.replace("_", " ").title()


def _tooltip(row: Any) -> str:
    """Without a full stop, as Blender adds one."""
    unit = f" In {row.unit}." if row.unit else ""
    return f"{row.documentation}{unit}".removesuffix(".")


def _choices(row: Any) -> Choices:
    return tuple((choice, _title(choice), "") for choice in row.choices)


_SAMPLE, _TRACKER = _basic("sample"), _basic("Tracker")
SAMPLE = tuple(_setting(row, Changes.SOLUTION) for row in _SAMPLE.values())
MOTION = tuple(_setting(row, Changes.BAKE) for name, row in _TRACKER.items() if name not in _SAMPLE)
EVENNESS = tuple(setting for setting in SAMPLE if setting.name != "seed")
# Options that trackers receive too: all except those with a different default for a motion.
TRACKED = tuple(
    name
    for name, row in _TRACKER.items()
    if name not in _SAMPLE or _SAMPLE[name].default == row.default
)


def quality_settings(name: str) -> dict[str, Any]:
    """The values of a preset; options that it does not name have their defaults."""
    return {setting.name: setting.default for setting in EVENNESS} | _PRESETS[name]


def quality_of(values: dict[str, Any]) -> str:
    """The name of the preset that has these values; CUSTOM if there is none."""
    for name, *_ in QUALITIES:
        wanted = quality_settings(name)
        if all(_same(values.get(key), one) for key, one in wanted.items()):
            return name
    return CUSTOM[0]


def _same(value: float | None, wanted: float) -> bool:
    return value is not None and math.isclose(value, wanted, rel_tol=_SINGLE)
