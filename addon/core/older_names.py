# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings that had another name before: files and presets of that time are still read."""

from collections.abc import MutableMapping
from typing import Any

from .tables import GROUPS

_FIGURES = {
    "capacity_spread": "capacity_variation",
    "whole_count_spread": "whole_count_variation",
}
# By group, "" being the scatter itself: the old name, the new one.
RENAMED = {
    **{
        group: {setting.older: setting.name for setting in settings if setting.older}
        for group, settings in GROUPS.items()
        if group != "classes"  # a list
    },
    "report": _FIGURES,
    "solved": _FIGURES,
}


def rename(group: str, stored: MutableMapping[str, Any]) -> None:
    """Store what a group of settings holds under old names under the new ones."""
    for old, new in RENAMED.get(group, {}).items():
        if old in stored:
            value = stored.pop(old)
            if new not in stored:
                stored[new] = value
