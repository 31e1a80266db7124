# SPDX-License-Identifier: GPL-3.0-or-later
"""A figure of balls cut open, with points everywhere and outside alone: docs/images/outside.webp.

build/venv/bin/python benchmarks/outside/picture.py OUT.webp
"""

import sys
from pathlib import Path

import bpy
import dapple3d as dapple
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from benchmarks.outside.__main__ import EDGE, figure
from benchmarks.remesh.lines_picture import SAMPLES, add_balls, add_body
from benchmarks.remesh.picture import STEP, render, set_scene

COUNT = 1500
SIZE = 3.4  # of the figure, which becomes 1
MIDDLE = np.array([0.0, 0.0, 0.25])
SLAB = 0.02  # points nearer than that to the cut are shown too


def main(out: str) -> None:
    """
    Args:
        out: the picture, as WebP.
    """
    bpy.ops.wm.read_factory_settings(use_empty=True)
    vertices, faces = figure()
    vertices = vertices - MIDDLE
    surface = dapple.Surface(vertices, faces)
    refined = dapple.refine_outside(surface, EDGE * surface.spacing(COUNT))
    behind = vertices[faces].mean(axis=1)[:, 1] > 0.0
    for k, solved in enumerate((surface, refined.surface)):
        positions = dapple.sample(solved, COUNT).positions
        shift = np.array([k * STEP, 0.0, 0.0])
        add_body(vertices / SIZE + shift, faces[behind])
        add_balls(positions[positions[:, 1] > -SLAB] / SIZE + shift)
    set_scene(2)
    render(out, 1000, 480, SAMPLES)


if __name__ == "__main__":
    main(*sys.argv[1:])
