# SPDX-License-Identifier: GPL-3.0-or-later
"""The legend of colors in the corner of a 3D View: a color ramp with the values of its ends."""

from typing import Any

import blf
import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from ...core.density.colors import Singles, ramp

WIDTH, HEIGHT = 180.0, 12.0  # pixels of the ramp, before the scale of the interface
EDGE, GAP, LETTER = 20.0, 5.0, 12.0
_FONT = 0


def draw(title: str, low: str, high: str, scale: float) -> None:
    """Draw the legend in the current region, at its lower left, right of the toolbar. `scale` is
    that of the interface.
    """
    left, bottom = _toolbar() + EDGE * scale, EDGE * scale
    blf.size(_FONT, LETTER * scale)
    above = bottom + (LETTER + GAP) * scale
    _strip(left, above, scale)
    width = blf.dimensions(_FONT, high)[0]
    _text(low, left, bottom)
    _text(high, left + max(WIDTH * scale - width, 0.0), bottom)
    _text(title, left, above + (HEIGHT + GAP) * scale)


def strip(width: float, height: float) -> tuple[Singles, Singles]:
    """Corners (k, 2) of the triangles of a color ramp at the origin, and their colors (k, 4)."""
    steps, colors = ramp()
    low = np.column_stack([steps * width, np.zeros(len(steps))])
    high = low + np.array([0.0, height])
    corners, shades = [], []
    for k in range(len(steps) - 1):
        corners += [low[k], low[k + 1], high[k + 1], low[k], high[k + 1], high[k]]
        shades += [colors[j] for j in (k, k + 1, k + 1, k, k + 1, k)]
    return np.array(corners, dtype=np.float32), np.array(shades, dtype=np.float32)


def _strip(left: float, bottom: float, scale: float) -> None:
    places, colors = strip(WIDTH * scale, HEIGHT * scale)
    content: dict[str, Any] = {
        "pos": places + np.array([left, bottom], np.float32),
        "color": colors,
    }
    shader = gpu.shader.from_builtin("SMOOTH_COLOR")
    batch_for_shader(shader, "TRIS", content).draw(shader)


def _text(text: str, left: float, bottom: float) -> None:
    """Draw white text with a shadow, readable on any background."""
    blf.enable(_FONT, blf.SHADOW)
    blf.shadow(_FONT, 5, 0.0, 0.0, 0.0, 0.9)
    blf.color(_FONT, 1.0, 1.0, 1.0, 1.0)
    blf.position(_FONT, left, bottom, 0.0)
    blf.draw(_FONT, text)
    blf.disable(_FONT, blf.SHADOW)


def _toolbar() -> float:
    """Pixels that the toolbar covers at the left of the region."""
    area = bpy.context.area
    if area is None or not bpy.context.preferences.system.use_region_overlap:
        return 0.0
    covering = [one for one in area.regions if one.type == "TOOLS" and one.alignment == "LEFT"]
    return float(sum(one.width for one in covering if one.width > 1))
