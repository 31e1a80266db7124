# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets: settings of a scatter under a name, as JSON files that can be read and mailed.

Data-blocks (surface, objects, pictures) are not in them. Object types are, without their objects.
"""

import json
import re
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

from ..base.errors import ScatterError
from .tables import GROUPS
from .values import ClassSettings, DensitySettings, Settings

SCHEMA = 1
DEFAULT = "Default"  # the preset that new scatters begin with
NAMES = {
    group: tuple(setting.name for setting in GROUPS[group] if setting.in_presets)
    for group in ("", "density", "tiles")
}
CLASSES = "object_types"  # the group that is a list; not there: types stay as they are
CLASS_NAMES = ("name", *(setting.name for setting in GROUPS[CLASSES] if setting.in_presets))
Values = dict[str, Any]  # by group, then by name; of object types a list of such


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
    """Read a preset without names that this version does not know."""
    path = _path(folder, name)
    try:
        stored = json.loads(path.read_text())
        if not isinstance(stored["settings"], dict) or stored["schema"] > SCHEMA:
            raise ValueError(f"schema {stored['schema']} is not known")
        groups = stored["settings"]
        found: Values = {
            group: _known(groups.get(group, {}), names) for group, names in NAMES.items()
        }
        if groups.get(CLASSES):
            found[CLASSES] = [_known(own, CLASS_NAMES) for own in groups[CLASSES]]
        return found
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
    return replace(
        settings,
        density=DensitySettings(**values.get("density", {})),
        object_types=tuple(map(_type_with, values.get(CLASSES, ()))),
    )


def _type_with(own: dict[str, Any]) -> ClassSettings:
    """An object type without objects: bounds give it no radius."""
    defaults = {setting.name: setting.default for setting in GROUPS[CLASSES]}
    values = {name: own.get(name, default) for name, default in defaults.items()}
    radius = 0.0 if values["radius_from_bounds"] else values["radius"]
    return ClassSettings(
        count=values["count"] if values["use_count"] else 0,
        weight=0.0 if values["use_count"] else values["weight"],
        density=values["density"],
        radius=radius,
        borders=values["borders"],
        max_clearance=radius,
        shrinks=values["radius_from_bounds"] and values["fit_to_spacing"] == 1.0,
    )


def _known(stored: dict[str, Any], names: tuple[str, ...]) -> dict[str, Any]:
    """The settings of a group that this version knows."""
    if not isinstance(stored, dict):
        raise TypeError(f"{stored!r} holds no settings")
    return {name: stored[name] for name in names if name in stored}


def _path(folder: Path, name: str) -> Path:
    if not re.fullmatch(r"[\w][\w .,+()-]*", name) or name != name.strip() or name.endswith("."):
        raise ScatterError(
            f"A preset cannot be called '{name}': its name may have letters, digits, spaces and "
            ". , + ( ) -"
        )
    return folder / f"{name}.json"
