# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's Distribute Points on Faces (Poisson) on each frame: who is still there on the next?

The node starts anew on every frame, so its points have no identity; a point counts as kept where it
lies within half a spacing of one of the frame before that rode along. Needs bpy and runs in a
process of its own: python -m benchmarks.tracking.blender_points IN.npz OUT.npz
"""

from __future__ import annotations

import contextlib
import itertools
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import dapple3d as dapple
import numpy as np
from numpy.typing import NDArray

from benchmarks.tracking.animations import Animation
from benchmarks.tracking.implicit import Array
from benchmarks.tracking.scatter_node import ScatterNode

TIMEOUT = 900  # seconds; a bpy process can hang at exit


@dataclass(frozen=True)
class Scattered:
    """The points (n, 3) of each frame, and what they cost."""

    points: list[Array]
    milliseconds: list[float]


def scattered(animation: Animation, count: int, advances: int) -> Scattered | None:
    """The node's points on the first frame and after each advance; None where there is no bpy."""
    frames = animation.frames[[0, *animation.order(advances)]]
    with tempfile.TemporaryDirectory() as folder:
        given, made = Path(folder, "in.npz"), Path(folder, "out.npz")
        np.savez(given, faces=animation.faces, frames=frames, count=count)
        module = "benchmarks.tracking.blender_points"
        command = [sys.executable, "-m", module, str(given), str(made)]
        # Where it hangs at exit, what counts is whether the points were written.
        with contextlib.suppress(subprocess.TimeoutExpired):
            subprocess.run(command, timeout=TIMEOUT, capture_output=True, check=False)
        if not made.is_file():
            return None
        with np.load(made) as stored:
            points = np.split(stored["points"], stored["ends"][:-1])
            return Scattered(points, stored["milliseconds"].tolist())


@dataclass(frozen=True)
class Met:
    """Points of a frame beside those of the frame before that rode along, in spacings."""

    slide: Array  # (n, 3): from the nearest of those
    of: NDArray[np.int64]  # (n,): which one that is
    new: NDArray[np.bool_]  # (n,): it is farther than half a spacing


def met(animation: Animation, found: Scattered) -> list[Met]:
    """Of each advance."""
    order = [0, *animation.order(len(found.points) - 1)]
    first = dapple.Surface(animation.frames[0], animation.faces)
    result = []
    for k, (before, now) in enumerate(itertools.pairwise(found.points)):
        old, new = (animation.frames[frame] for frame in order[k : k + 2])
        places = dapple.project(first.deformed(old), before)
        corners = new[animation.faces[places.faces]]
        ridden = np.einsum("nk,nkd->nd", places.barycentric, corners)
        of = _nearest(now, ridden)
        slide = (now - ridden[of]) / first.deformed(new).spacing(len(now))
        result.append(Met(slide, of, np.linalg.norm(slide, axis=1) > 0.5))
    return result


def replaced(found: Scattered, meetings: list[Met]) -> dict[str, list[float]]:
    """Of each advance the share of points replaced, their number, slide, jerk, milliseconds."""
    slides = [one.slide for one in meetings]
    before = [np.zeros_like(found.points[0]), *slides]
    jerks = [one.slide - was[one.of] for was, one in zip(before, meetings, strict=False)]
    return {
        "replaced": [float(one.new.mean()) for one in meetings],
        "count": [float(len(one.new)) for one in meetings],
        "slide_mean": [float(np.linalg.norm(slide, axis=1).mean()) for slide in slides],
        "jerk_mean": [float(np.linalg.norm(jerk, axis=1).mean()) for jerk in jerks],
        "milliseconds": found.milliseconds[1:],
    }


def _nearest(points: Array, others: Array) -> NDArray[np.int64]:
    """For each of points (n, 3) which of the others is nearest."""
    parts = [
        np.linalg.norm(part[:, None] - others, axis=2).argmin(axis=1)
        for part in np.array_split(points, 1 + len(points) // 200)
        if len(part)
    ]
    return np.concatenate(parts)


def _main(given: str, made: str) -> None:
    import bpy

    with np.load(given) as stored:
        faces, frames, count = stored["faces"], stored["frames"], int(stored["count"])
    node = ScatterNode(bpy, frames[0], faces, dapple.Surface(frames[0], faces).area, count)
    points, milliseconds = [], []
    for frame in frames:
        began = time.perf_counter()
        points.append(node.points(frame))
        milliseconds.append(1000 * (time.perf_counter() - began))
    ends = np.cumsum([len(one) for one in points])
    np.savez(made, points=np.vstack(points), ends=ends, milliseconds=milliseconds)


if __name__ == "__main__":
    _main(*sys.argv[1:])
