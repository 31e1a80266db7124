# SPDX-License-Identifier: GPL-3.0-or-later
"""How far instances turn against the surface they stand on, from one baked frame to the next.

The surface turns an instance as it turns the triangle under it. What is added because the instance
slid to another place is bounded: over a crease it leans, and straightens frame by frame.
"""

from __future__ import annotations

import argparse

import dapple3d as dapple
import numpy as np

from addon.core.bake.baker import Baker, Start
from addon.core.bake.keys import Keyframes
from addon.core.bake.tilt import rotations
from addon.core.settings.values import Settings
from addon.core.surface.arrays import SurfaceArrays
from addon.core.surface.binding import binding_of
from addon.core.surface.frames import Normals, frames, smooth
from addon.core.surface.records import Placed
from benchmarks.tracking.animations import GENERATED, Animation

GOAL = 10.0  # degrees a frame


def main() -> None:
    options = _options()
    print(f"{options.sites} sites; degrees a frame against the surface: largest, 99.9 %, mean")
    for name in options.animations:
        turns = turns_of(GENERATED[name](options.frames, options.faces), options.sites)
        largest = float(turns.max())
        print(
            f"  {name:8} {largest:6.2f} {np.quantile(turns, 0.999):6.2f} {turns.mean():6.3f}"
            f"  {'met' if largest < GOAL else 'missed'}",
            flush=True,
        )


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.bake.turns",
        description=__doc__,
        formatter_class=argparse.ArgumentDefaultsHelpFormatter,
    )
    parser.add_argument("--animations", nargs="+", choices=list(GENERATED), default=list(GENERATED))
    parser.add_argument("--frames", type=int, default=96)
    parser.add_argument("--faces", type=int, default=12_000)
    parser.add_argument("--sites", type=int, default=2000)
    return parser.parse_args()


def turns_of(animation: Animation, sites: int) -> np.ndarray:
    """Degrees (frames - 1, sites) that instances turn against the surface."""
    baker, turns, before = _baker(animation, sites), [], None
    for vertices in animation.frames:
        baker.enter(SurfaceArrays(animation.name, vertices, animation.faces, ""))
        baker.advance(dapple.Context())
        after = Placed(np.zeros(0, np.int32), baker.last, tilt=baker.tilts.tilt)
        if before is not None:
            turns.append(_between(before, after, vertices, animation.faces))
        before = after
    return np.array(turns)


def _baker(animation: Animation, sites: int) -> Baker:
    first = SurfaceArrays(animation.name, animation.frames[0], animation.faces, "")
    samples = dapple.sample(dapple.Surface(first.vertices, first.faces), sites)
    binding = binding_of(samples, first)
    start = Start(binding, samples.ids, samples.classes, Settings(count=sites))
    return Baker(first, start, Keyframes(len(animation.frames)))


def _between(before: Placed, after: Placed, vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Angles (n,) in degrees between what both keys make of instances on one surface."""
    normals = smooth(vertices, faces)
    one, other = (_axes(each, vertices, normals) for each in (before, after))
    trace = np.einsum("nij,nij->n", one, other)
    return np.degrees(np.arccos(np.clip((trace - 1.0) / 2.0, -1.0, 1.0)))


def _axes(placed: Placed, vertices: np.ndarray, normals: Normals) -> np.ndarray:
    own = frames(placed.binding, vertices, normals).axes(placed.binding.angle)
    return own if placed.tilt is None else own @ rotations(placed.tilt)


if __name__ == "__main__":
    main()
