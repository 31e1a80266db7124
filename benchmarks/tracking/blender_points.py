# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's Distribute Points on Faces (Poisson) on each frame: who is still there on the next?

The node starts anew on every frame, so its points have no identity; a point counts as kept where it
lies within half a spacing of one of the frame before that rode along. Needs bpy and runs in a
process of its own: python -m benchmarks.tracking.blender_points IN.npz OUT.npz
"""

from __future__ import annotations

import contextlib
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import dapple3d as dapple
import numpy as np

from benchmarks.tracking.animations import Animation
from benchmarks.tracking.implicit import Array
from benchmarks.tracking.scatter_node import ScatterNode

TIMEOUT = 900  # seconds; a bpy process can hang at exit


def replaced(animation: Animation, count: int, advances: int) -> dict[str, list[float]] | None:
    """Of each advance the share of points replaced, the number of points and the milliseconds.

    None where there is no bpy.
    """
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
            milliseconds = stored["milliseconds"].tolist()
    surface = dapple.Surface(animation.frames[0], animation.faces)
    shares = []
    for before, after, old, new in zip(points, points[1:], frames, frames[1:], strict=False):
        found = dapple.project(surface.deformed(old), before)
        corners = new[animation.faces[found.faces]]
        ridden = np.einsum("nk,nkd->nd", found.barycentric, corners)
        reach = 0.5 * surface.deformed(new).spacing(len(after))
        shares.append(float(np.mean(_nearest(after, ridden) > reach)))
    counts = [float(len(one)) for one in points[1:]]
    return {"replaced": shares, "count": counts, "milliseconds": milliseconds[1:]}


def _nearest(points: Array, others: Array) -> Array:
    """Distances (n,) of points (n, 3) to the nearest of the others."""
    parts = [
        np.linalg.norm(part[:, None] - others, axis=2).min(axis=1)
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
