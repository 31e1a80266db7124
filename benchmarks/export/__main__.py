# SPDX-License-Identifier: GPL-3.0-or-later
"""What is left of a scatter after an export: Blender's own exporters, and Dapple's.

Each file is imported into a Blender of its own; an instance counts if one of the things there is at
its place, turned and as large as it was.
"""

from __future__ import annotations

import argparse
import os
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np

import addon
from benchmarks.compare.tables import table
from benchmarks.export.looking import Look, Things, look
from benchmarks.export.scene import FRAMES, matrices, scattered
from benchmarks.export.ways import WAYS, Way

_HEAD = ("exporter", "in place", "on subdivided", "as", "moving", "ids", "object types", "kB")
_MOST = 0.99  # of the instances
_PLACE, _TURN = 1e-4, 3e-3  # what may differ; 16-bit quaternions are off by so much


@dataclass(frozen=True)
class Kept:
    """What is left: shares of the instances on the first and the last frame, and what else."""

    first: float
    last: float
    kind: str  # of what stands in their places
    look: Look
    kilobytes: float


def main() -> None:
    options = _options()
    addon.register()
    try:
        with tempfile.TemporaryDirectory() as folder:
            ways = [way for way in WAYS if way.name.startswith(options.only)]
            rows = _measured(ways, options.keep or Path(folder))
    finally:
        addon.unregister()
    print(f"Blender {bpy.app.version_string}, {len(rows)} exports\n")
    print(table(_HEAD, rows), flush=True)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="benchmarks/export/run.sh", description=__doc__)
    parser.add_argument("--keep", type=Path, help="leave the files in this folder")
    parser.add_argument("--only", default="", help="exporters whose names begin with this")
    return parser.parse_args()


def _measured(ways: Sequence[Way], folder: Path) -> list[list[str]]:
    found: dict[bool, dict[str, Kept]] = {}
    for subdivided in (False, True):
        scatter = scattered(subdivided)
        expected = [matrices(scatter, frame) for frame in (FRAMES[-1], FRAMES[0])][::-1]
        found[subdivided] = {
            way.name: _kept(way, scatter, expected, folder / f"{k}-{subdivided:d}{way.suffix}")
            for k, way in enumerate(ways)
        }
    return [_row(way, found[False][way.name], found[True][way.name]) for way in ways]


def _kept(way: Way, scatter: bpy.types.Object, expected: list[np.ndarray], path: Path) -> Kept:
    way.export(path, scatter)
    seen = look(path, (FRAMES[0], FRAMES[-1]))
    first, last = (_in_place(*pair) for pair in zip(seen.frames, expected, strict=True))
    kind = _kind(seen.frames[0], first)
    if _in_place(seen.frames[1], expected[1], at_least=2)[0].size:
        kind += ", twice"
    count = len(expected[0])
    kilobytes = path.stat().st_size / 1000
    return Kept(first[0].size / count, last[0].size / count, kind, seen, kilobytes)


def _in_place(
    things: Things, expected: np.ndarray, at_least: int = 1
) -> tuple[np.ndarray, np.ndarray]:
    """Which instances have so many things in their place, and the nearest things of those."""
    gaps = np.linalg.norm(things.matrices[None, :, :3, 3] - expected[:, None, :3, 3], axis=2)
    nearest = gaps.argmin(axis=1)
    turned = np.abs(things.matrices[nearest] - expected)[:, :3, :3].max(axis=(1, 2))
    here = ((gaps < _PLACE).sum(axis=1) >= at_least) & (turned < _TURN)
    return np.flatnonzero(here), nearest[here]


def _kind(things: Things, found: tuple[np.ndarray, np.ndarray]) -> str:
    """What stands in the places, in words."""
    kinds = {things.kinds[k] for k in found[1]}
    meshes = {things.meshes[k] for k in found[1]} - {""}
    if not kinds:
        return "nothing"
    if kinds == {"instance"}:
        return "instances"
    if "EMPTY" in kinds:
        return "empties" if kinds == {"EMPTY"} else "objects and empties"
    return "objects that share meshes" if len(meshes) < len(found[1]) / 2 else "objects"


def _row(way: Way, plain: Kept, subdivided: Kept) -> list[str]:
    moving = "yes" if plain.last > _MOST else "no"
    return [
        way.name,
        _percent(plain.first),
        _percent(subdivided.first),
        plain.kind,
        moving,
        "yes" if plain.look.ids else "no",
        "yes" if plain.look.types else "no",
        f"{plain.kilobytes:.0f}",
    ]


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %"


if __name__ == "__main__":
    main()
    os._exit(0)  # a class that is still registered can hang Blender at exit
