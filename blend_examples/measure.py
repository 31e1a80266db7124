# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of a baked scatter, taken from what the file stores and what Blender plays back."""

from __future__ import annotations

import math
from dataclasses import dataclass

import bpy
import numpy as np

from addon.blender.scatter.key_stores import read_baked


@dataclass
class Keys:
    """Baked bindings: F keys of n points, each on a triangle of surface vertices."""

    ids: np.ndarray  # (n,)
    corners: np.ndarray  # (F, n, 3) vertex indices
    barycentric: np.ndarray  # (F, n, 3)

    def positions(self, key: int, vertices: np.ndarray) -> np.ndarray:
        """Points (n, 3) of a key on the surface with these vertices (v, 3)."""
        return np.einsum("nk,nkd->nd", self.barycentric[key], vertices[self.corners[key]])

    def normals(self, key: int, vertices: np.ndarray) -> np.ndarray:
        a, b, c = np.moveaxis(vertices[self.corners[key]], 1, 0)
        return np.cross(b - a, c - a)

    def kept(self, key: int, vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
        """Which points (n,) lie within half a spacing, on the surface, of where key - 1 rides.

        The other side of a thin wall is near, yet far along the surface: where the normals
        disagree, the way there has to lie within half a spacing too.
        """
        here, ridden = self.positions(key, vertices), self.positions(key - 1, vertices)
        reach = 0.5 * hexagonal_spacing(vertices, triangles, len(self.ids))
        kept = np.linalg.norm(here - ridden, axis=1) < reach
        facing = (self.normals(key, vertices) * self.normals(key - 1, vertices)).sum(axis=1)
        for i in np.flatnonzero(kept & (facing <= 0)):
            near = np.linalg.norm(vertices - ridden[i], axis=1) < reach
            kept[i] = joined(near, triangles, self.corners[key - 1][i], self.corners[key][i])
        return kept


def read_attribute(mesh: bpy.types.Mesh, name: str) -> np.ndarray:
    attribute = mesh.attributes[name]
    vector = attribute.data_type == "FLOAT_VECTOR"
    kind = np.int32 if attribute.data_type == "INT" else np.float32
    values = np.empty(len(attribute.data) * (3 if vector else 1), dtype=kind)
    attribute.data.foreach_get("vector" if vector else "value", values)
    return values.reshape(-1, 3) if vector else values


def read_keys(scatter: bpy.types.Object) -> Keys:
    ids = read_attribute(scatter.data, "id")
    baked = read_baked(scatter)
    bindings = [baked.binding(frame, len(ids))[0] for frame in range(baked.frame_count)]
    return Keys(
        ids,
        np.stack([binding.corners for binding in bindings]),
        np.stack([binding.barycentric for binding in bindings]),
    )


def surface_now(surface: bpy.types.Object) -> tuple[np.ndarray, np.ndarray]:
    """World positions (v, 3) of the evaluated surface's vertices, and its triangles (m, 3)."""
    evaluated = surface.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    flat = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", flat)
    mesh.calc_loop_triangles()
    triangles = np.empty(3 * len(mesh.loop_triangles), dtype=np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    evaluated.to_mesh_clear()
    world = np.array(surface.matrix_world)
    vertices = flat.reshape(-1, 3).astype(np.float64) @ world[:3, :3].T + world[:3, 3]
    return vertices, triangles.reshape(-1, 3)


def hexagonal_spacing(vertices: np.ndarray, triangles: np.ndarray, count: int) -> float:
    """Distance of neighbors if count points were packed as well as can be."""
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    return math.sqrt(2 * area / (math.sqrt(3) * count))


def joined(near: np.ndarray, triangles: np.ndarray, start: np.ndarray, goal: np.ndarray) -> bool:
    """Whether the surface's part with near vertices (v,) leads from some of start to goal."""
    near[start] = near[goal] = True
    part = triangles[near[triangles].all(axis=1)]
    reached = np.zeros(len(near), dtype=bool)
    reached[start] = True
    before = 0
    while before < np.count_nonzero(reached):
        before = int(np.count_nonzero(reached))
        reached[part[reached[part].any(axis=1)]] = True
    return bool(reached[goal].any())


def instances_now(scatter: bpy.types.Object) -> np.ndarray:
    """World positions (n, 3) of the instances as Blender evaluates them."""
    instances = bpy.context.evaluated_depsgraph_get().object_instances
    places = [
        tuple(one.matrix_world.translation)
        for one in instances
        if one.is_instance and one.parent.original == scatter
    ]
    return np.array(places).reshape(-1, 3)


@dataclass
class Stability:
    """How a bake behaves over time."""

    kept: float  # share of (instance, frame) with the same id that moved less than half a spacing
    slide_mean: float  # movement against the surface per frame, in spacings
    slide_max: float
    changed_faces: float  # share of (instance, frame) that passed to another triangle
    playback_error: float  # largest distance of an instance from its key, over the spacing


def stability(scatter: bpy.types.Object, surface: bpy.types.Object, frames: range) -> Stability:
    """Compares each key with the one before it, carried along by the surface to the same frame."""
    keys = read_keys(scatter)
    if len(np.unique(keys.ids)) != len(keys.ids) or len(keys.corners) != len(frames):
        raise ValueError(
            f"{scatter.name}: {len(keys.corners)} keys of {len(keys.ids)} points with "
            f"{len(np.unique(keys.ids))} ids do not fit {len(frames)} frames"
        )
    slides, kept, changed, errors = [], [], [], []
    for key, frame in enumerate(frames):
        bpy.context.scene.frame_set(frame)
        vertices, triangles = surface_now(surface)
        spacing = hexagonal_spacing(vertices, triangles, len(keys.ids))
        here = keys.positions(key, vertices)
        errors.append(np.linalg.norm(instances_now(scatter) - here, axis=1).max() / spacing)
        if key == 0:
            continue
        slide = np.linalg.norm(here - keys.positions(key - 1, vertices), axis=1) / spacing
        kept.append(keys.kept(key, vertices, triangles))
        slides.append(slide)
        before, after = np.sort(keys.corners[key - 1]), np.sort(keys.corners[key])
        changed.append((before != after).any(axis=1))
    return Stability(
        kept=float(np.mean(kept)),
        slide_mean=float(np.mean(slides)),
        slide_max=float(np.max(slides)),
        changed_faces=float(np.mean(changed)),
        playback_error=float(np.max(errors)),
    )
