# SPDX-License-Identifier: GPL-3.0-or-later
"""A character as it is shown now, beside its remeshed copies."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix, Vector

from benchmarks.remesh.picture import STEP, add_lines, render, set_scene
from benchmarks.rigs.character import Part, world_mesh

SIZE = 520  # pixels of one body
SAMPLES = 32


def draw(path: Path, objects: Sequence[bpy.types.Object], parts: Sequence[Part]) -> None:
    """Render the objects, and their copies with each share of the triangles beside them."""
    path.parent.mkdir(parents=True, exist_ok=True)
    shares = list(dict.fromkeys(part.share for part in parts))
    bodies = [list(objects), *([p.new for p in parts if p.share == share] for share in shares)]
    corners = np.concatenate([world_mesh(obj)[0] for obj in objects])
    low, high = corners.min(axis=0), corners.max(axis=0)
    fit = Matrix.Scale(1 / (high - low).max(), 4) @ Matrix.Translation(Vector(-0.5 * (low + high)))
    for obj in bpy.data.objects:
        obj.hide_render = True
    made = []
    for k, body in enumerate(bodies):
        shift = Matrix.Translation((STEP * k, 0.0, 0.0)) @ fit
        made += [_still(obj, shift) for obj in body]
    set_scene(len(bodies))
    render(str(path.resolve()), SIZE * len(bodies), SIZE, SAMPLES)
    for still in made:
        bpy.data.meshes.remove(still.data)


def _still(obj: bpy.types.Object, shift: Matrix) -> bpy.types.Object:
    """An object as it is shown now, with its edges."""
    graph = bpy.context.evaluated_depsgraph_get()
    shown = obj.evaluated_get(graph)
    mesh = bpy.data.meshes.new_from_object(shown, preserve_all_data_layers=True, depsgraph=graph)
    still = bpy.data.objects.new("Still", mesh)
    still.matrix_world = shift @ shown.matrix_world
    bpy.context.scene.collection.objects.link(still)
    add_lines(still)
    return still
