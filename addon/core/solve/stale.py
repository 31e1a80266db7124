# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares what is stored with the current state: settings by value, motion by sketches.

A sketch of a surface consists of a few sums of its vertices with random signs: quick to compute,
small to store for each frame, and some sum changes by about 1 / sqrt(v) of a vertex's motion. It is
computed in the object's own axes, with its scale, so moving the object as a whole does not
invalidate a bake.
"""

import json
from dataclasses import asdict, dataclass
from functools import cache
from typing import Any

import numpy as np

from ..settings.density_table import DENSITY
from ..settings.descriptors import DATA_BLOCKS, Changes, Kind
from ..settings.edge_table import EDGES, ON_EDGES
from ..settings.solver_options import MOTION, SAMPLE
from ..settings.symmetry_table import SYMMETRY
from ..settings.values import BakeSettings, ClassSettings, Settings
from ..surface.arrays import Floats, SurfaceArrays, turn_of
from ..surface.records import own_random

SKETCH_SUMS = 3
# Options that do not change a solution.
_APART = [one.name for one in (*SAMPLE, *MOTION) if one.changes is not Changes.SOLUTION]
_NAMES = [setting.name for setting in DENSITY if setting.kind in {Kind.VALUES, *DATA_BLOCKS}]
_COMPARED_ELSEWHERE = [setting.name for setting in DENSITY if setting.kind is Kind.UV_MAP]
_UNDER = {setting.name: setting.under for setting in DENSITY if setting.under}
_OF_PLACES = [setting.name for setting in (*EDGES[1:], *SYMMETRY)]  # by Scatter On
_VERTICES = 4096  # number of sketched vertices, evenly spread over their indices
_TOLERANCE = 1e-5  # relative to the extent, as machines evaluate a little differently


def settings_text(settings: Settings | BakeSettings) -> str:
    """Settings as text that is stored with a result."""
    return json.dumps(_plain(settings), sort_keys=True)


def changed_settings(stored: str, now: Settings) -> list[str]:
    """Names of the settings of the solution that differ from the stored ones.

    For names of data in the file only presence is compared; sources.py compares the content.
    Settings that have no effect are ignored.
    """
    before, defaults = _read(stored), _defaults()
    if "count" in before:  # a missing setting is newer than the file: it had its default
        before = defaults | before
        if isinstance(before["density"], dict):
            before["density"] = defaults["density"] | before["density"]
    wanted = {name: value for name, value in _plain(now).items() if name not in _APART}
    known, wanted = _of_effect(before), _of_effect(wanted)
    if known.get("scatter_on") != wanted["scatter_on"]:  # which changes what has an effect
        wanted |= {name: known.get(name) for name in _OF_PLACES}
    return [name for name, value in wanted.items() if name not in before or known[name] != value]


def was_on_edges(stored: str) -> bool:
    """Whether the points of a result are on edges."""
    return bool(_read(stored).get("scatter_on") == ON_EDGES)


def changed_baking(stored: str, now: BakeSettings) -> list[str]:
    """Names of the settings of the bake alone that differ from the stored ones."""
    before = _read(stored)
    return [name for name, value in _plain(now).items() if name in before and before[name] != value]


def _read(stored: str) -> dict[str, Any]:
    try:
        values = json.loads(stored)
    except (ValueError, RecursionError):
        return {}
    if not isinstance(values, dict):
        return {}
    return _rounded(values)


def _plain(settings: Settings | BakeSettings) -> dict[str, Any]:
    """Settings as values for JSON."""
    values: dict[str, Any] = _rounded(json.loads(json.dumps(asdict(settings))))
    return values


@cache
def _defaults() -> dict[str, Any]:
    """The settings of a new scatter, which are not to be changed."""
    return _plain(Settings())


def _rounded(value: Any) -> Any:
    """Numbers rounded to the single precision of Blender's properties."""
    if isinstance(value, dict):
        return {name: _rounded(one) for name, one in value.items()}
    if isinstance(value, list):
        return [_rounded(one) for one in value]
    return float(np.float32(value)) if isinstance(value, float) else value


def _of_effect(values: dict[str, Any]) -> dict[str, Any]:
    """The values that affect a solution: no names, no count beside points per area, ..."""
    found = dict(values)
    if found.get("per_area"):
        found["count"] = 0
    if found.get("scatter_on") != ON_EDGES:
        found |= {setting.name: None for setting in EDGES[1:]}
    else:
        found |= {setting.name: None for setting in SYMMETRY}
    if isinstance(found.get("density"), dict):
        found["density"] = _terms(found["density"])
    if isinstance(found.get("object_types"), list):
        found["object_types"] = [_solved_class(one) for one in found["object_types"]]
    return found


def _terms(density: dict[str, Any]) -> dict[str, Any]:
    found = dict(density)
    for name in _NAMES:
        found[name] = bool(found[name])
    for name, switch in _UNDER.items():
        if not found[switch] or name in _COMPARED_ELSEWHERE:
            found[name] = None
    return found


def _solved_class(kind: Any) -> Any:
    """The values of an object type that affect a solution."""
    if not isinstance(kind, dict):
        return kind
    own = asdict(ClassSettings()) | kind  # a missing setting is newer than the file
    del own["max_clearance"]
    more = {"density": bool(kind.get("density")), "shrinks": bool(kind.get("shrinks"))}
    return own | more


def sketch(surface: SurfaceArrays) -> Floats:
    """The sketch: sums (SKETCH_SUMS, 3) of the vertices."""
    seen = _seen(surface)
    ids = np.arange(len(seen), dtype=np.int32)
    signs = [np.where(own_random(0, ids, k) < 0.5, -1.0, 1.0) for k in range(SKETCH_SUMS)]
    return np.array(signs) @ seen / np.sqrt(max(len(seen), 1))


@dataclass(frozen=True)
class Sketched:
    """A surface for moved() without its arrays."""

    sums: Floats
    extent: float


def sketched(surface: SurfaceArrays) -> Sketched:
    """The part of a surface that moved() compares."""
    seen = _seen(surface)
    extent = float(np.linalg.norm(np.ptp(seen, axis=0))) if len(seen) else 0.0
    return Sketched(sketch(surface), extent)


def moved(stored: Floats, surface: SurfaceArrays | Sketched) -> bool:
    """Whether a surface differs from the sketched one."""
    now = surface if isinstance(surface, Sketched) else sketched(surface)
    return not np.abs(now.sums - stored).max() <= _TOLERANCE * now.extent


def _seen(surface: SurfaceArrays) -> Floats:
    """Some of the vertices, relative to the object's origin and without its rotation."""
    count = len(surface.vertices)
    chosen = np.unique(np.linspace(0, count - 1, min(count, _VERTICES)).astype(np.int64))
    return (surface.vertices[chosen] - surface.matrix[:3, 3]) @ turn_of(surface.matrix)
