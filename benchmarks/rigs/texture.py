# SPDX-License-Identifier: GPL-3.0-or-later
"""How well a texture stays in its place."""

from __future__ import annotations

from typing import Any

import bpy
import dapple3d as dapple
import numpy as np
from numpy.typing import NDArray

from addon.blender.base.mesh_arrays import corner_vertices, read_points, triangle_corners
from benchmarks.rigs.character import Part

OTHER = 0.1  # difference of colors in 0..1 that is seen
Array = NDArray[Any]


def other_colors(part: Part) -> float:
    """Share of the new surface where the texture differs from that at the nearest place of the old
    one.
    """
    image = image_of(part.old)
    if image is None or not part.old.data.uv_layers:
        return 0.0
    old, new = part.old.data, part.new.data
    places, areas = _middles(new)
    surface = dapple.Surface(read_points(old), corner_vertices(old)[triangle_corners(old)])
    below = dapple.project(surface, places)
    there = (_uvs(old)[below.faces] * np.asarray(below.barycentric)[:, :, None]).sum(axis=1)
    here = _uvs(new).mean(axis=1)
    apart = np.abs(_colors(image, here) - _colors(image, there)).max(axis=1) > OTHER
    return float(areas[apart].sum() / areas.sum())


def image_of(obj: bpy.types.Object) -> bpy.types.Image | None:
    """The first image of its materials."""
    for material in obj.data.materials:
        if material and material.node_tree:
            for node in material.node_tree.nodes:
                if node.type == "TEX_IMAGE" and node.image:
                    return node.image
    return None


def _middles(mesh: bpy.types.Mesh) -> tuple[Array, Array]:
    corners = read_points(mesh)[corner_vertices(mesh)[triangle_corners(mesh)]]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return corners.mean(axis=1), np.linalg.norm(across, axis=1)


def _uvs(mesh: bpy.types.Mesh) -> Array:
    """Texture coordinates (t, 3, 2) of the corners of triangles."""
    values = np.empty(2 * len(mesh.loops), np.float32)
    mesh.uv_layers.active.uv.foreach_get("vector", values)
    return values.reshape(-1, 2)[triangle_corners(mesh)]


def _colors(image: bpy.types.Image, uvs: Array) -> Array:
    width, height = image.size
    pixels = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(pixels)
    columns, rows = np.floor(np.mod(uvs, 1.0) * (width, height)).astype(int).T
    return pixels.reshape(height, width, 4)[rows, columns, :3]
