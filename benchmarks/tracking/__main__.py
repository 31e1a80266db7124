# SPDX-License-Identifier: GPL-3.0-or-later
"""Judges samples on deforming bodies and holds the figures against the goals."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path

import dapple3d as dapple

from benchmarks.tracking import new_faces, report
from benchmarks.tracking.animations import FACES, GENERATED, LENGTH, Animation, load
from benchmarks.tracking.blender_points import met, replaced, scattered
from benchmarks.tracking.changing import CHANGING
from benchmarks.tracking.contenders import CONTENDERS, WINDOW
from benchmarks.tracking.film import TRAIL, Take, taken, taken_by_node, write_film, write_strip
from benchmarks.tracking.flow import least_flow
from benchmarks.tracking.metrics import STEADY, Run, play

SHARED = ["elephant", "greenman"]
SHARED_SITES = {"greenman": 700}  # 356 faces: twice as many sites as faces
QUICK = ["bend", "arm", "metaballs"]
FILMED = {
    "ride": "riding",
    "paper": "the paper's way",
    "dapple": "Dapple",
    "calm": "Dapple, calmer",
}
NODE = "Blender's Poisson disks"


def main() -> None:
    options = _options()
    options.out.mkdir(parents=True, exist_ok=True)
    runs: list[Run] = []
    blender: dict[str, dict[str, list[float]]] = {}
    for animation in _animations(options):
        sites = min(options.sites, SHARED_SITES.get(animation.name, options.sites))
        _introduce(animation, sites)
        if options.pictures:
            report.draw_frames(animation, options.out / f"{animation.name}.png")
        runs += _play_all(animation, sites, options)
        if options.blender and (found := scattered(animation, sites, animation.period)):
            blender[animation.name] = replaced(found, met(animation, found))
        if options.film:
            _film(animation, sites, options)
        _store(runs, blender, options)
    if runs:
        print("\n" + report.table(runs), "\n\nFrames that miss a goal:\n", sep="\n")
        print(report.misses(runs))
    if blender:
        print("\nDistribute Points on Faces, Poisson:\n", report.replaced_table(blender), sep="\n")
    _play_new_faces(options)


def _play_new_faces(options: argparse.Namespace) -> None:
    """Bodies whose faces change, among those that were asked for."""
    found: list[new_faces.NewFaces] = []
    for name in (name for name in options.animations if name in CHANGING):
        body = CHANGING[name](options.frames, options.faces)
        run, shown = new_faces.play(body, options.sites, options.seed)
        found += [new_faces.nearest(body, options.sites, options.seed), run]
        new_faces.draw_strip(shown, options.out / f"{name}.png")
        if options.json:
            rows = [asdict(one) for one in found]
            options.json.with_stem(f"{options.json.stem}_faces").write_text(json.dumps(rows))
    if found:
        print("\nBodies whose faces change:\n", new_faces.table(found), sep="\n")


def _store(
    runs: list[Run], blender: dict[str, dict[str, list[float]]], options: argparse.Namespace
) -> None:
    """After each animation, so that a run that is ended early leaves what it has."""
    report.draw_curves(runs, options.out / "curves.png")
    report.draw_smoothness(runs, blender, options.out / "smoothness.png")
    if options.json:
        stored = {"sites": options.sites, "runs": [asdict(run) for run in runs], "blender": blender}
        options.json.write_text(json.dumps(stored, indent=1))


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="benchmarks/tracking/run.sh",
        description=__doc__,
        formatter_class=argparse.ArgumentDefaultsHelpFormatter,
    )
    known = [*GENERATED, *SHARED, *CHANGING]
    parser.add_argument(
        "--animations",
        nargs="+",
        choices=known,
        default=known,
        metavar="NAME",
        help="of " + ", ".join(known),
    )
    parser.add_argument(
        "--contenders",
        nargs="+",
        choices=[*CONTENDERS, WINDOW],
        metavar="NAME",
        help="of " + ", ".join([*CONTENDERS, WINDOW]),
    )
    parser.add_argument("--frames", type=int, default=LENGTH, help="of a generated loop")
    parser.add_argument("--faces", type=int, default=FACES, help="of a generated body, about")
    parser.add_argument("--sites", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--loops", type=int, default=1, help="of each animation")
    parser.add_argument(
        "--drift",
        nargs="*",
        choices=known,
        default=["bend", "walk"],
        metavar="NAME",
        help=f"animations looped for {STEADY} frames, by those that go from frame to frame",
    )
    parser.add_argument("--blender", action="store_true", help="also Blender's own scatter node")
    parser.add_argument("--pictures", action="store_true", help="draw frames of each animation")
    parser.add_argument("--film", action="store_true", help="films of two seconds, and strips")
    parser.add_argument("--quick", action="store_true", help="two short animations, 500 sites")
    parser.add_argument("--shared", type=Path, help="folder with meshes/anim_*: real animations")
    parser.add_argument("--json", type=Path, help="write every frame's figures there")
    parser.add_argument("--out", type=Path, default=Path("build/tracking"), help="of pictures")
    options = parser.parse_args()
    options.contenders = options.contenders or [*CONTENDERS, WINDOW]
    if options.quick:
        options.animations, options.drift = QUICK, []
        options.frames, options.faces, options.sites = 24, 3000, 500
    if min(options.frames, options.faces, options.sites, options.loops) < 1:
        parser.error("--frames, --faces, --sites and --loops must be at least 1")
    return options


def _animations(options: argparse.Namespace) -> Iterator[Animation]:
    for name in options.animations:
        if name in CHANGING:
            continue
        if name in GENERATED:
            yield GENERATED[name](options.frames, options.faces)
            continue
        found = load(options.shared, name) if options.shared else None
        if found:
            yield found
        else:
            print(f"{name}: skipped, --shared does not give it")


def _introduce(animation: Animation, sites: int) -> None:
    motion = animation.largest_motion
    print(
        f"{animation.name}: {len(animation.faces)} faces, {len(animation.frames)} frames, "
        f"{sites} sites; a vertex moves {100 * motion:.1f} % of the size in a frame at most"
        + (": fast" if motion > 0.02 else ""),
    )
    slide, jerk = least_flow(animation, sites)
    if slide > 0:
        print(
            f"  the least flow that keeps the density slides {slide:.3f} spacings a frame, "
            f"jerk {jerk:.3f}: {jerk / slide:.2f} of it",
            flush=True,
        )


def _film(animation: Animation, sites: int, options: argparse.Namespace) -> None:
    """What each contender looks like: a film, and a strip around the middle of the animation."""
    surface = dapple.Surface(animation.frames[0], animation.faces)
    start = dapple.sample(surface, sites, seed=options.seed, threads=1)
    takes: list[Take] = []
    if found := scattered(animation, sites, animation.period):
        takes.append(taken_by_node(animation, found, met(animation, found), NODE))
    takes += [taken(animation, start, name, title) for name, title in FILMED.items()]
    write_film(animation, takes, options.out / f"film_{animation.name}.webp")
    middle = max(animation.period // 2, TRAIL)
    write_strip(animation, takes, middle, options.out / f"trails_{animation.name}.png")


def _play_all(animation: Animation, sites: int, options: argparse.Namespace) -> list[Run]:
    surface = dapple.Surface(animation.frames[0], animation.faces)
    start = dapple.sample(surface, sites, seed=options.seed, threads=1)
    advances = animation.period
    runs = [
        play(animation, start, name, advances * (1 if name == WINDOW else options.loops))
        for name in options.contenders
    ]
    if animation.name in options.drift:
        lasting = [name for name in options.contenders if name not in ("ride", WINDOW)]
        runs += [play(animation, start, name, STEADY) for name in lasting]
    return runs


if __name__ == "__main__":
    main()
