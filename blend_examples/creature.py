# SPDX-License-Identifier: GPL-3.0-or-later
"""Animates a newt, scatters studs over it with the add-on, bakes, renders and reports.

Run through blend_examples/run.sh, which sets everything up first.
"""

from __future__ import annotations

import argparse
import ctypes
import json
import math
import os
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path

import bpy

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

import addon  # noqa: E402  (the add-on as it lies in the repository)
from blend_examples import measure, newt, studio  # noqa: E402
from blend_examples.sheet import contact_sheet  # noqa: E402

PANELS = 4
STUD_SIZE = 0.46  # radius of a stud in spacings


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="blend_examples/run.sh", description=__doc__)
    parser.add_argument(
        "--frames", type=int, default=48, help="frames of the animation (4 or more)"
    )
    parser.add_argument("--count", type=int, default=1500, help="number of studs")
    parser.add_argument("--seed", type=int, default=0, help="another seed, another scatter")
    parser.add_argument("--width", type=int, default=640, help="width of one picture in pixels")
    parser.add_argument("--out", type=Path, default=ROOT / "build/examples", help="output folder")
    given = parser.parse_args()
    if given.frames < PANELS:
        parser.error(f"--frames {given.frames}: the contact sheet shows {PANELS}")
    if given.count < 1:
        parser.error(f"--count {given.count}: at least one stud is needed")
    return given


def say(text: str) -> None:
    print(text, flush=True)


@contextmanager
def stage(text: str) -> Iterator[None]:
    say(f"== {text}")
    start = time.perf_counter()
    yield
    say(f"   {time.perf_counter() - start:.1f} s")


@contextmanager
def quiet() -> Iterator[None]:
    """Keeps Blender's own lines off the terminal: they are written below Python's stdout."""
    sys.stdout.flush()
    kept = os.dup(1)
    with open(os.devnull, "w") as sink:
        os.dup2(sink.fileno(), 1)
    try:
        yield
    finally:
        ctypes.CDLL(None).fflush(None)  # or C would write its lines after all
        os.dup2(kept, 1)
        os.close(kept)


@contextmanager
def frames_shown(last: int) -> Iterator[None]:
    """Says which frame Blender has come to."""

    def show(scene: bpy.types.Scene, *_: object) -> None:
        if scene.frame_current % 4 == 0 or scene.frame_current == last:
            say(f"   frame {scene.frame_current} of {last}")

    bpy.app.handlers.frame_change_post.append(show)
    try:
        yield
    finally:
        bpy.app.handlers.frame_change_post.remove(show)


def build_scene(frames: range, width: int) -> tuple[bpy.types.Object, bpy.types.Object]:
    """The newt in its studio; the body and the stud."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.preferences.filepaths.save_version = 0  # no creature.blend1
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = frames[0], frames[-1]
    armature = newt.build_armature()
    body = newt.build_body(armature)
    body.data.materials.append(studio.material("Skin", studio.BODY, 0.45))
    newt.build_eyes(armature, studio.eye_materials())
    newt.animate(armature, frames[0], frames[-1])
    studio.build_studio(width, width * 5 // 8)
    scene.frame_set(frames[0])
    return body, studio.build_stud()


def select(obj: bpy.types.Object) -> None:
    bpy.ops.object.select_all(action="DESELECT")
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj


def figures(scatter: bpy.types.Object) -> dict[str, float]:
    report = scatter.dapple.report
    names = (
        "count",
        "alpha_min",
        "alpha_mean",
        "capacity_variation",
        "evaluations",
        "milliseconds",
    )
    return {name: getattr(report, name) for name in names}


def scatter_studs(
    body: bpy.types.Object, stud: bpy.types.Object, count: int, seed: int
) -> bpy.types.Object:
    select(body)
    bpy.ops.dapple.add_scatter(count=count, seed=seed)
    scatter = bpy.context.view_layer.objects.active
    scatter.dapple.instance = stud
    scatter.dapple.scale = STUD_SIZE * scatter.dapple.report.spacing
    return scatter


def render(frames: range, folder: Path) -> dict[int, Path]:
    """Pictures of PANELS frames, evenly over the range."""
    scene = bpy.context.scene
    chosen = [frames[len(frames) * k // PANELS] for k in range(PANELS)]
    pictures = {}
    for index, frame in enumerate(chosen):
        say(f"   frame {frame} ({index + 1} of {PANELS})")
        pictures[frame] = folder / f"{frame:04d}.png"
        scene.frame_set(frame)
        scene.render.filepath = str(pictures[frame])
        with quiet():
            bpy.ops.render.render(write_still=True)
    return pictures


def percent(share: float) -> str:
    """Rounded down: 100 % means all."""
    return f"{math.floor(1e4 * share) / 100:g} %"


def lines_of(report: dict[str, dict[str, float]]) -> list[str]:
    first, later, steady = report["first_frame"], report["all_frames"], report["over_time"]
    return [
        f"count            {first['count']:.0f}",
        f"alpha min        {first['alpha_min']:.3f} on the first frame, "
        f"{later['alpha_min']:.3f} on the worst",
        f"alpha mean       {first['alpha_mean']:.3f} on the first frame, "
        f"{later['alpha_mean']:.3f} over all",
        f"area variation  {first['capacity_variation']:.4f} on the first frame, "
        f"{later['capacity_variation']:.4f} on the worst",
        f"first frame      {first['evaluations']:.0f} evaluations, {first['milliseconds']:.0f} ms",
        f"later frames     {later['evaluations']:.0f} evaluations, "
        f"{later['milliseconds']:.0f} ms each",
        f"kept             {percent(steady['kept'])} "
        "(same id, moved less than half a spacing on the surface)",
        f"movement         {steady['slide_mean']:.4f} spacings a frame, "
        f"{steady['slide_max']:.3f} at most",
        f"changed faces    {100 * steady['changed_faces']:.1f} % a frame",
        f"playback error   {steady['playback_error']:.1e} spacings",
    ]


def make(given: argparse.Namespace) -> None:
    frames = range(1, given.frames + 1)
    given.out.mkdir(parents=True, exist_ok=True)
    with stage("the newt and its studio"):
        body, stud = build_scene(frames, given.width)
    with stage(f"scattering {given.count} studs on frame {frames[0]}"):
        scatter = scatter_studs(body, stud, given.count, given.seed)
        first = figures(scatter)
    with stage(f"baking frames {frames[0]} to {frames[-1]}"), frames_shown(frames[-1]):
        select(scatter)
        bpy.ops.dapple.bake()
        later = figures(scatter)
    with stage("measuring what was baked"):
        steady = measure.stability(scatter, body, frames)
    report = {"first_frame": first, "all_frames": later, "over_time": asdict(steady)}
    with stage("rendering"), tempfile.TemporaryDirectory() as folder:
        pictures = render(frames, Path(folder))
        caption = (
            f"{given.count} studs, {given.frames} frames: {percent(steady.kept)} keep their place"
        )
        contact_sheet(pictures, caption, given.out / "creature.png")
    scene_file = given.out / "creature.blend"
    with quiet():
        bpy.ops.wm.save_as_mainfile(filepath=str(scene_file), compress=True, check_existing=False)
    (given.out / "creature.json").write_text(json.dumps(report, indent=2) + "\n")
    say("== report")
    for line in lines_of(report):
        say(f"   {line}")
    say(f"== {given.out}: creature.png, creature.blend, creature.json")


def main() -> None:
    given = arguments()
    addon.register()
    try:
        make(given)
    finally:
        # A class that is still registered at exit can hang Blender.
        addon.unregister()


if __name__ == "__main__":
    main()
