# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension itself: the name of its package, and its folder."""

from pathlib import Path

FOLDER = Path(__file__).resolve().parents[2]
PACKAGE = __package__.removesuffix(".blender.base")
