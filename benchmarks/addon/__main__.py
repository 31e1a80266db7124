# SPDX-License-Identifier: GPL-3.0-or-later
"""How long the add-on takes: playback, a redraw, node groups, reading a surface, enabling, strokes.

What is compared is measured in turns, so that a busy machine slows all of it alike.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np

import addon
from addon.blender.surface.reading import read
from addon.core.settings.values import DensitySettings, Settings
from addon.nodes import ensure_group
from benchmarks.addon.against import compared
from benchmarks.addon.following import CASES, measure_following
from benchmarks.addon.playback import (
    DISPLAYED,
    OWN,
    measure_listing,
    measure_playback,
    swelling_sphere,
)
from benchmarks.addon.redraw import measure_redraw

PLAYBACK_GOAL, GROUP_GOAL, READING_GOAL, REDRAW_GOAL = 0.008, 0.1, 0.5, 0.001  # seconds
_PARTS = ["playback", "redraw", "groups", "reading", "enabling", "following"]
_MOST_CLASSES = 8
_ENABLE = """
import os, time, bpy
begin = time.perf_counter()
import addon
addon.register()
print(time.perf_counter() - begin, flush=True)
os._exit(0)
"""


def main() -> None:
    options = _options()
    parts: dict[str, Callable[[argparse.Namespace], None]] = {
        "playback": _playback,
        "redraw": _redraw,
        "groups": _groups,
        "reading": _reading,
        "enabling": _enabling,
        "following": _following,
    }
    for name, part in parts.items():
        if options.only in (None, name):
            _empty_file()
            part(options)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="benchmarks/addon/run.sh",
        description=__doc__,
        formatter_class=argparse.ArgumentDefaultsHelpFormatter,
    )
    parser.add_argument("--sites", type=int, default=100_000)
    parser.add_argument("--faces", type=int, default=1_000_000, help="triangles that are read")
    parser.add_argument("--rounds", type=int, default=8, help="turns of each measurement")
    parser.add_argument("--turns", type=int, default=5, help="turns with another checkout")
    parser.add_argument("--only", choices=_PARTS)
    parser.add_argument("--moved", action="store_true", help="play on a turned surface elsewhere")
    parser.add_argument("--flat", action="store_true", help="play on a surface with flat faces")
    parser.add_argument(
        "--against",
        type=Path,
        help="checkout whose add-on is measured in turns: playback, redraw and following",
    )
    return parser.parse_args()


def _empty_file() -> None:
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)


def _playback(options: argparse.Namespace) -> None:
    surface = swelling_sphere(options.moved, options.flat)
    taken = measure_playback(surface, options.sites, options.rounds, options.against)
    alone, shaded = taken.pop("alone"), taken.pop("its normals")
    print(f"a frame with {options.sites} points, on a surface of 40,962 vertices")
    print(
        f"  the surface alone {_ms(alone.wall)}, with its normals, which a window draws, "
        f"{_ms(shaded.wall)}, {_ms(shaded.cpu)} of all processors"
    )
    for name, found in taken.items():
        more = found.wall - alone.wall
        judged = f"; {_judged(more, PLAYBACK_GOAL)}" if name in OWN else ""
        print(
            f"  {name}: {_ms(more)} more, {_ms(found.wall - shaded.wall)} over the surface with "
            f"its normals, {_ms(found.cpu - shaded.cpu)} of all processors{judged}"
        )
    _empty_file()
    listed = measure_listing(swelling_sphere(), options.sites, options.rounds)
    frames = {name: taken[name].cpu - shaded.cpu for name in listed}
    print(
        f"  processor time of a frame, and of a redraw that goes through its instances; {OWN[0]} 1"
    )
    for name in DISPLAYED:
        frame, redraw = (found[name] / found[OWN[0]] for found in (frames, listed))
        both = (frames[name] + listed[name]) / (frames[OWN[0]] + listed[OWN[0]])
        print(f"    {name}: frame {frame:.2f}, redraw {redraw:.2f}, together {both:.2f}")


def _redraw(options: argparse.Namespace) -> None:
    if options.against:
        numbers = options.sites, options.faces, options.rounds
        _compare(options, "redraw", "measure_redraw", *numbers)
        return
    taken = measure_redraw(options.sites, options.faces, options.rounds)
    print(f"the panels of {options.sites} points on {options.faces} triangles")
    for name, time_taken in taken.items():
        goal = f", {_judged(time_taken, REDRAW_GOAL)}" if name.endswith("redraw") else ""
        print(f"  {name}: {1000.0 * time_taken:.3f} ms{goal}")


def _groups(options: argparse.Namespace) -> None:
    first = []
    for _ in range(options.rounds):
        _empty_file()
        first.append(_timed(ensure_group))
    print(f"the first node group of a file: {_ms(float(np.median(first)))}")
    for classes in range(1, _MOST_CLASSES + 1):
        taken = []
        for _ in range(options.rounds):
            taken.append(_timed(ensure_group, classes))
            bpy.data.node_groups.remove(ensure_group(classes))
        median = float(np.median(taken))
        print(f"  for {classes} classes: {_ms(median)}, {_judged(median, GROUP_GOAL)}")


def _reading(options: argparse.Namespace) -> None:
    side = max(round((options.faces / 2) ** 0.5), 1)
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=side, y_subdivisions=side)
    surface = bpy.context.object
    group = surface.vertex_groups.new(name="Group")
    group.add(range(len(surface.data.vertices)), 0.5, "REPLACE")
    for domain in ("POINT", "FACE", "CORNER"):
        surface.data.attributes.new(domain, "FLOAT", domain)
    names = {
        "nothing": "",
        "a vertex group": "Group",
        "an attribute of vertices": "POINT",
        "an attribute of faces": "FACE",
        "an attribute of face corners": "CORNER",
    }
    taken: dict[str, list[float]] = {name: [] for name in names}
    for _ in range(options.rounds):
        for name, asked in names.items():
            settings = Settings(density=DensitySettings(attribute=asked))
            taken[name].append(_timed(read, surface, settings))
    median = float(np.median(taken.pop("nothing")))
    print(f"reading {2 * side * side} triangles: {_ms(median)}, {_judged(median, READING_GOAL)}")
    for name, times in taken.items():
        print(f"  with {name}: {_ms(float(np.median(times)))}")


def _enabling(options: argparse.Namespace) -> None:
    """In processes of their own: a module is imported once."""
    taken = []
    for _ in range(min(options.rounds, 5)):
        command = [sys.executable, "-c", _ENABLE]
        done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=120)
        taken.append(float(done.stdout.split()[-1]))
    print(f"enabling the add-on: {_ms(float(np.median(taken)))}")


def _following(options: argparse.Namespace) -> None:
    """The times include the pause after a change."""
    for sites, faces, types, goal in CASES:
        if sites > options.sites:
            continue
        if options.against:
            print(f"a stroke with {sites} points of {types} object types on {faces} triangles")
            numbers = sites, faces, options.rounds, types
            _compare(options, "following", "measure_following", *numbers)
            continue
        _empty_file()
        taken = measure_following(sites, faces, options.rounds, types)
        shown, done = taken.pop("points"), taken.pop("all")
        kinds = f" of {types} object types" if types > 1 else ""
        print(f"a stroke with {sites} points{kinds} on {faces} triangles: {_judged(shown, goal)}")
        print(f"  new points after {_ms(shown)}, all measured after {_ms(done)}")
        for name, seconds in taken.items():
            print(f"    {name}: {_ms(seconds)}")


def _compare(options: argparse.Namespace, module: str, name: str, *numbers: int) -> None:
    found = compared(options.against, options.turns, module, name, *numbers)
    for label, (here, there) in found.items():
        print(f"  {label}: {_ms(here)}, there {_ms(there)}, ratio {here / there:.2f}")


def _timed(work: Callable[..., object], *arguments: object) -> float:
    begin = time.perf_counter()
    work(*arguments)
    return time.perf_counter() - begin


def _ms(seconds: float) -> str:
    return f"{1000.0 * seconds:.{1 if seconds >= 0.01 else 3}f} ms"


def _judged(seconds: float, goal: float) -> str:
    return f"goal {_ms(goal)}: {'met' if seconds < goal else 'missed'}"


if __name__ == "__main__":
    addon.register()
    main()
    addon.unregister()
    sys.stdout.flush()
    os._exit(0)
