# SPDX-License-Identifier: GPL-3.0-or-later
"""What a bake costs: bytes that the .blend grows by, plain and compressed, and time of a frame.

The keys are made up, not solved. Bytes of the plain file do not depend on it; those of the
compressed one do.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
from pathlib import Path

import bpy
import numpy as np

import addon
from addon.blender.surface.mesh import read_mesh
from benchmarks.bake.made_up import add_bake, add_scatter

GOAL = 120.0  # MB for 250 frames x 20,000 sites


def main() -> None:
    options = _options()
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    surface = _grid(options.faces)
    arrays = read_mesh(surface)
    scatter = add_scatter(surface, arrays, options.sites)
    before = _sizes()
    add_bake(scatter, arrays, options.sites, options.frames, options.moving)
    after = _sizes()
    rows = options.frames * options.sites
    print(f"{options.frames} frames x {options.sites} sites, {len(arrays.faces)} triangles")
    for name in before:
        grown = after[name] - before[name]
        print(f"  {name}: {grown / 1e6:.1f} MB more, {grown / rows:.1f} bytes a site and frame")
    print(f"  a frame is evaluated in {1000 * _playback(options.frames):.1f} ms")
    if rows == 250 * 20_000:
        print(f"  goal: {GOAL:.0f} MB, {'met' if grown / 1e6 < GOAL else 'missed'}")


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="benchmarks/bake/run.sh",
        description=__doc__,
        formatter_class=argparse.ArgumentDefaultsHelpFormatter,
    )
    parser.add_argument("--frames", type=int, default=250)
    parser.add_argument("--sites", type=int, default=20_000)
    parser.add_argument("--faces", type=int, default=100_000, help="triangles of the surface")
    parser.add_argument("--moving", type=float, default=0.5, help="share of sites that slide")
    return parser.parse_args()


def _grid(faces: int) -> bpy.types.Object:
    side = max(round((faces / 2) ** 0.5), 1)
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=side, y_subdivisions=side)
    return bpy.context.object


def _sizes() -> dict[str, int]:
    with tempfile.TemporaryDirectory() as folder:
        path, sizes = Path(folder, "measured.blend"), {}
        for name, compress in (("compressed", True), ("plain", False)):
            bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=compress, copy=True)
            sizes[name] = path.stat().st_size
    return sizes


def _playback(frames: int) -> float:
    """Median seconds of a frame."""
    taken = []
    for frame in range(1, min(frames, 21)):
        begin = time.perf_counter()
        bpy.context.scene.frame_set(frame)
        bpy.context.evaluated_depsgraph_get().update()
        taken.append(time.perf_counter() - begin)
    return float(np.median(taken))


if __name__ == "__main__":
    addon.register()
    main()
    addon.unregister()
    sys.stdout.flush()
    os._exit(0)
