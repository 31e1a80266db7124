# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings that had another name before: files and presets of that time are still read."""

from collections.abc import MutableMapping
from typing import Any

RENAMED = {"tiles": {"colour_by": "color_by"}}  # by group: the old name, the new one


def rename(group: str, stored: MutableMapping[str, Any]) -> None:
    """Store what a group of settings holds under old names under the new ones."""
    for old, new in RENAMED.get(group, {}).items():
        if old in stored:
            value = stored.pop(old)
            if new not in stored:
                stored[new] = value
