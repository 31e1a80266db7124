# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's module: mypy knows the add-on's properties of objects, all else is Any."""

from typing import Any

from . import types as types

def __getattr__(name: str) -> Any: ...
