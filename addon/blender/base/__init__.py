# SPDX-License-Identifier: GPL-3.0-or-later
"""What all features need: texts, times, jobs, meshes as arrays."""

from pathlib import Path

FOLDER = Path(__file__).resolve().parents[2]
PACKAGE = __package__.removesuffix(".blender.base")
