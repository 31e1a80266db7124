# SPDX-License-Identifier: GPL-3.0-or-later
"""What the pictures of the manual show: a meadow with things to put on it, and a newt."""

from __future__ import annotations

import math

import bpy
import numpy as np
from numpy.typing import NDArray

from blend_examples import newt, studio

FRAMES = 16
Array = NDArray[np.float64]
Profile = list[tuple[float, float]]


def meadow(size: float = 8.0, cells: int = 80) -> bpy.types.Object:
    """Low hills."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=cells, y_subdivisions=cells, size=size)
    ground = bpy.context.object
    ground.name = ground.data.name = "Meadow"
    vertices = places(ground)
    x, y = vertices[:, 0], vertices[:, 1]
    vertices[:, 2] = 0.35 * np.sin(0.9 * x) * np.cos(0.8 * y) + 0.12 * np.sin(2.1 * x + 1.7 * y)
    ground.data.vertices.foreach_set("co", vertices.astype(np.float32).ravel())
    ground.data.shade_smooth()
    ground.data.materials.append(studio.material("Meadow", (0.30, 0.36, 0.17), 1.0))
    return ground


def places(thing: bpy.types.Object) -> Array:
    """Vertices (v, 3)."""
    flat = np.empty(3 * len(thing.data.vertices), np.float32)
    thing.data.vertices.foreach_get("co", flat)
    return flat.reshape(-1, 3).astype(np.float64)


def things() -> dict[str, bpy.types.Object]:
    """What is scattered; out of sight."""
    pine = [(0.03, 0.0), (0.03, 0.15), (0.17, 0.13), (0.07, 0.36), (0.13, 0.34), (0.0, 0.70)]
    rock = [(0.9, -0.3), (1.0, 0.1), (0.7, 0.5), (0.3, 0.66), (0.0, 0.68)]
    flower = [(0.02, 0.0), (0.02, 0.3), (0.10, 0.42), (0.04, 0.38), (0.0, 0.36)]
    made = {
        "Pine": turned("Pine", pine, 9, (0.10, 0.34, 0.16)),
        "Rock": turned("Rock", rock, 7, (0.45, 0.42, 0.40)),
        "Flower": turned("Flower", flower, 8, (0.95, 0.62, 0.10)),
    }
    for thing in made.values():
        thing.location = (0.0, 0.0, -60.0)
    return made


def turned(name: str, profile: Profile, sides: int, color: studio.Color) -> bpy.types.Object:
    """A profile (radius, height) turned about z."""
    turns = [2 * math.pi * side / sides for side in range(sides)]
    vertices = [(r * math.cos(t), r * math.sin(t), z) for r, z in profile for t in turns]
    faces = [
        (low + side, low + (side + 1) % sides, low + sides + (side + 1) % sides, low + sides + side)
        for low in range(0, sides * (len(profile) - 1), sides)
        for side in range(sides)
    ]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    mesh.materials.append(studio.material(name, color, 0.8))
    made = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(made)
    return made


def creature() -> tuple[bpy.types.Object, bpy.types.Object]:
    """The newt of the examples in a scene of its own, and a stud."""
    bpy.ops.scene.new(type="EMPTY")
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, FRAMES
    armature = newt.build_armature()
    body = newt.build_body(armature)
    body.data.materials.append(studio.material("Skin", studio.BODY, 0.45))
    newt.build_eyes(armature, studio.eye_materials())
    newt.animate(armature, 1, FRAMES)
    armature.hide_set(True)
    stud = studio.build_stud()
    stud.data.materials[1].diffuse_color = (0.30, 0.75, 0.50, 1.0)
    stud.hide_viewport, stud.location = False, (0.0, 0.0, -60.0)
    scene.frame_set(1)
    return body, stud
