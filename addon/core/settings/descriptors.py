# SPDX-License-Identifier: GPL-3.0-or-later
"""Descriptions of settings, from which properties, presets, checks and docs are made."""

from dataclasses import dataclass
from enum import Enum, auto
from typing import Any


class Kind(Enum):
    """The type of a setting."""

    NUMBER = auto()
    WHOLE = auto()
    SWITCH = auto()
    CHOICE = auto()
    VALUES = auto()  # the name of an attribute or vertex group
    UV_MAP = auto()  # the name of one
    OBJECT = auto()
    SURFACE = auto()  # an object that points can be on
    IMAGE = auto()
    COLLECTION = auto()
    MATERIALS = auto()  # several


class Changes(Enum):
    """The results that a change of a setting makes stale."""

    NOTHING = auto()
    INSTANCES = auto()  # the instances, which are updated at once
    SOLUTION = auto()
    BAKE = auto()  # the bake alone, not the solution that it begins with
    INDIRECTLY = auto()  # the solution, by way of a field that other settings make too


DATA_BLOCKS = frozenset({Kind.OBJECT, Kind.SURFACE, Kind.IMAGE, Kind.COLLECTION, Kind.MATERIALS})
Choices = tuple[tuple[Any, ...], ...]  # as Blender lists them: name, label, tooltip (and number)


@dataclass(frozen=True)
class Setting:
    """One setting of a group: a line of the table of that group."""

    name: str
    kind: Kind
    default: Any  # of a data-block its name, ""; of several their names, ()
    label: str
    tooltip: str
    changes: Changes = Changes.SOLUTION
    low: float | None = None
    high: float | None = None
    soft_low: float | None = None  # where sliders end
    soft_high: float | None = None
    precision: int | None = None
    unit: str = "NONE"
    subtype: str = "NONE"
    choices: Choices = ()
    own_words: bool = False  # Blender translates these words as something else
    under: str = ""  # the setting without which it has no effect
    field: str = ""  # in core/settings/values.py, where it has another name there

    @property
    def in_presets(self) -> bool:
        """Whether presets have it: data-blocks belong to a file."""
        return self.kind not in DATA_BLOCKS

    @property
    def field_name(self) -> str:
        """Its name in core/settings/values.py."""
        return self.field or self.name


Settings = tuple[Setting, ...]
