# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets: settings of a scatter under a name, as JSON files that can be read and mailed.

Data-blocks (surface, objects, pictures) are not in them, nor is the list of classes.
"""

import json
import re
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

from .errors import ScatterError
from .older_names import rename
from .settings import DensitySettings, Settings
from .tables import GROUPS

SCHEMA = 1
DEFAULT = "Default"  # the preset that new scatters begin with
NAMES = {
    group: tuple(setting.name for setting in GROUPS[group] if setting.in_presets)
    for group in ("", "density", "tiles")
}
Values = dict[str, dict[str, Any]]  # by group, then by name


def names(folder: Path) -> list[str]:
    """Presets of a folder, sorted."""
    return sorted(path.stem for path in folder.glob("*.json"))


def store(folder: Path, name: str, values: Values) -> None:
    """Write a preset, over one of the same name; ScatterError for a name that is no file's."""
    path = _path(folder, name)
    folder.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(".part")
    part.write_text(json.dumps({"schema": SCHEMA, "settings": values}, indent=2) + "\n")
    part.replace(path)


def load(folder: Path, name: str) -> Values:
    """Read a preset; names that this version does not know are left out.

    Raises:
        ScatterError: there is none, or it is not one.
    """
    path = _path(folder, name)
    try:
        stored = json.loads(path.read_text())
        if not isinstance(stored["settings"], dict) or stored["schema"] > SCHEMA:
            raise ValueError(f"schema {stored['schema']} is not known")
        for group, own in stored["settings"].items():
            rename(group, own)
        return {
            group: {
                one: stored["settings"].get(group, {})[one]
                for one in known
                if one in stored["settings"].get(group, {})
            }
            for group, known in NAMES.items()
        }
    except FileNotFoundError as error:
        raise ScatterError(f"There is no preset '{name}'") from error
    except (OSError, ValueError, TypeError, KeyError, AttributeError) as error:
        raise ScatterError(f"Preset '{name}' cannot be read from '{path}': {error}") from error


def remove(folder: Path, name: str) -> None:
    """Delete a preset; ScatterError if there is none."""
    try:
        _path(folder, name).unlink()
    except FileNotFoundError as error:
        raise ScatterError(f"There is no preset '{name}'") from error


def settings_with(values: Values) -> Settings:
    """The settings that a scatter with a preset's values has."""
    own = values.get("", {})
    known = {field.name for field in fields(Settings)}
    settings = Settings(**{name: value for name, value in own.items() if name in known})
    if own.get("amount") == "PER_AREA":
        (unset,) = (one.default for one in GROUPS[""] if one.name == "points_per_area")
        settings = replace(settings, per_area=own.get("points_per_area", unset))
    return replace(settings, density=DensitySettings(**values.get("density", {})))


def _path(folder: Path, name: str) -> Path:
    if not re.fullmatch(r"[\w][\w .,+()-]*", name) or name != name.strip() or name.endswith("."):
        raise ScatterError(
            f"A preset cannot be called '{name}': its name may have letters, digits, spaces and "
            ". , + ( ) -"
        )
    return folder / f"{name}.json"
