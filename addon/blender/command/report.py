# SPDX-License-Identifier: GPL-3.0-or-later
"""The report of a command, for a program to read."""

import json
from pathlib import Path
from typing import Any

import bpy

from ...core.base.atomic_file import part_of, replacing
from ...core.base.native import missing, package

FORMAT = 1  # another number where a program that reads reports would not understand it


def write_report(path: Path, verb: str, facts: dict[str, Any]) -> None:
    """Write what was done; OSError where that fails."""
    report = {
        "format": FORMAT,
        "command": verb,
        "file": bpy.data.filepath,
        "dapple": "" if missing() else package().__version__,
        "blender": bpy.app.version_string,
        **facts,
    }
    path = path.absolute()
    with replacing(path, part_of(path)) as part:
        part.write_text(json.dumps(report, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
