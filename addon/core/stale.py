# SPDX-License-Identifier: GPL-3.0-or-later
"""Does what is stored still fit what is there? Settings by name, motion by sketches.

A sketch of a surface is a few sums of its vertices with random signs: cheap to take, small to
keep for each frame, and some sum changes by about 1 / sqrt(v) of what a vertex moves. It is taken
in the object's own axes, with its scale: a bake fits an object that was moved or turned as a whole.
"""

import json
from dataclasses import asdict

import numpy as np

from .records import own_random
from .settings import Settings
from .surface import Floats, SurfaceArrays

SKETCH_SUMS = 3
# Settings that older files do not have: they were solved without.
_ADDED = ("classes", "density", "forward", "per_area")
_VERTICES = 4096  # so many are looked at, evenly spread over their indices
_TOLERANCE = 1e-5  # of the sketched vertices' extent: evaluation on another machine may differ


def settings_text(settings: Settings) -> str:
    """Settings as they are stored with a result."""
    return json.dumps(asdict(settings), sort_keys=True)


def changed_settings(stored: str, now: Settings) -> list[str]:
    """Names of the settings that are not as stored, in words."""
    try:
        before = json.loads(stored)
    except ValueError:
        before = {}
    if not isinstance(before, dict):
        before = {}
    values, defaults = (json.loads(settings_text(one)) for one in (now, Settings()))
    for name in _ADDED:
        before.setdefault(name, defaults[name])
    if isinstance(before["density"], dict):
        before["density"] = defaults["density"] | before["density"]
    return [
        name.replace("_", " ")
        for name in asdict(now)
        if name not in before or before[name] != values[name]
    ]


def sketch(surface: SurfaceArrays) -> Floats:
    """Sums (SKETCH_SUMS, 3) of the vertices."""
    seen = _seen(surface)
    ids = np.arange(len(seen), dtype=np.int32)
    signs = [np.where(own_random(0, ids, k) < 0.5, -1.0, 1.0) for k in range(SKETCH_SUMS)]
    return np.array(signs) @ seen / np.sqrt(max(len(seen), 1))


def moved(stored: Floats, surface: SurfaceArrays) -> bool:
    """Whether a surface is not the one that was sketched."""
    extent = float(np.linalg.norm(np.ptp(_seen(surface), axis=0)))
    return not np.abs(sketch(surface) - stored).max() <= _TOLERANCE * extent


def _seen(surface: SurfaceArrays) -> Floats:
    """Some of the vertices, relative to the object's origin and turned back by its rotation."""
    count = len(surface.vertices)
    chosen = np.unique(np.linspace(0, count - 1, min(count, _VERTICES)).astype(np.int64))
    left, _, right = np.linalg.svd(surface.matrix[:3, :3])
    return (surface.vertices[chosen] - surface.matrix[:3, 3]) @ (left @ right)
