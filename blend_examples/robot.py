# SPDX-License-Identifier: GPL-3.0-or-later
"""An old robot of many parts: rivets along its panels, and plants where the sky sees it.

Run through `blend_examples/run.sh robot`, which sets everything up.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import bpy
import numpy as np
from mathutils import Euler, Matrix, Vector

# isort: split
import bmesh  # there once bpy is

from blend_examples.meadow import flower, soil, tuft
from blend_examples.scene import (
    add_class,
    begin,
    build_outdoors,
    finish,
    grid,
    hidden,
    move_vertices,
    options,
    paint,
    run,
    scatter,
)
from blend_examples.studio import Color, color_by_chance, material

_PAINT: Color = (0.70, 0.36, 0.05)
_CREAM: Color = (0.72, 0.66, 0.50)
_IRON: Color = (0.10, 0.10, 0.11)
_MOSS = [(0.5, (0.10, 0.20, 0.02)), (0.85, (0.19, 0.30, 0.03)), (1.0, (0.33, 0.38, 0.06))]
_SHARP = math.radians(30)
_RIM = 0.07  # from the edges of a panel to its rivets
Parts = list[bpy.types.Object]


def rusty(name: str, color: Color) -> bpy.types.Material:
    """Paint that comes off in spots."""
    made = material(name, color, 0.55)
    nodes, links = made.node_tree.nodes, made.node_tree.links
    noise, ramp = nodes.new("ShaderNodeTexNoise"), nodes.new("ShaderNodeValToRGB")
    noise.inputs["Scale"].default_value, noise.inputs["Detail"].default_value = 3.5, 9.0
    dark = [0.35 * c for c in color]
    stops = ((0.38, (0.13, 0.045, 0.014)), (0.43, dark), (0.45, color))
    ramp.color_ramp.elements.new(0.5)
    for element, (at, tint) in zip(ramp.color_ramp.elements, stops, strict=True):
        element.position, element.color = at, (*tint, 1)
    links.new(nodes.new("ShaderNodeTexCoord").outputs["Object"], noise.inputs["Vector"])
    links.new(noise.outputs["Fac"], ramp.inputs["Fac"])
    links.new(ramp.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])
    return made


def part(name: str, made: bmesh.types.BMesh, look: str, place: Matrix) -> bpy.types.Object:
    mesh = bpy.data.meshes.new(name)
    made.to_mesh(mesh)
    made.free()
    mesh.shade_smooth()
    mesh.set_sharp_from_angle(angle=_SHARP)
    mesh.materials.append(bpy.data.materials[look])
    thing = bpy.data.objects.new(name, mesh)
    thing.matrix_world = place
    bpy.context.scene.collection.objects.link(thing)
    return thing


def at(place: Any, turn: Any = (0, 0, 0)) -> Matrix:
    """Of a part: its middle, and its rotation in degrees."""
    angles = Euler([math.radians(angle) for angle in turn])
    return Matrix.Translation(Vector(place)) @ angles.to_matrix().to_4x4()


def box(name: str, size: Any, look: str, place: Matrix, panels: bool = True) -> bpy.types.Object:
    """A box with round edges; the rims of its panels are seams."""
    made = bmesh.new()
    bmesh.ops.create_cube(made, size=1.0)
    bmesh.ops.scale(made, vec=size, verts=made.verts)
    wide = 0.12 * min(size)
    bmesh.ops.bevel(made, geom=made.edges[:], offset=wide, segments=3, profile=0.5, affect="EDGES")
    if panels:
        sides = sorted(made.faces, key=lambda face: -face.calc_area())[:6]
        rims = bmesh.ops.inset_individual(made, faces=sides, thickness=_RIM, use_even_offset=True)
        for face in sides:
            for edge in face.edges:
                edge.seam = True
        assert rims["faces"]
    return part(name, made, look, place)


def tube(name: str, radius: float, length: float, look: str, place: Matrix) -> bpy.types.Object:
    """A cylinder; two rings of rivets go around it."""
    made = bmesh.new()
    rows = [
        (0.0, -0.5),
        (0.8, -0.5),
        (1.0, -0.42),
        (1.0, -0.3),
        (1.0, 0.3),
        (1.0, 0.42),
        (0.8, 0.5),
    ]
    line = [made.verts.new((r * radius, 0.0, z * length)) for r, z in [*rows, (0.0, 0.5)]]
    edges = [made.edges.new(pair) for pair in pairwise(line)]
    bmesh.ops.spin(
        made, geom=[*line, *edges], axis=(0, 0, 1), cent=(0, 0, 0), steps=28, angle=2 * math.pi
    )
    bmesh.ops.remove_doubles(made, verts=made.verts, dist=1e-5)
    bmesh.ops.recalc_face_normals(made, faces=made.faces)
    for edge in made.edges:
        heights = {round(v.co.z / length, 3) for v in edge.verts}
        edge.seam = heights in ({-0.3}, {0.3})
    return part(name, made, look, place)


def ball(name: str, radius: float, place: Any) -> bpy.types.Object:
    made = bmesh.new()
    bmesh.ops.create_uvsphere(made, u_segments=24, v_segments=12, radius=radius)
    return part(name, made, "Iron", at(place))


def build_robot() -> Parts:
    """It stands in the meadow and looks down at it."""
    head = at((0.04, -0.14, 3.10), (14, 0, 10))
    made = [
        box("Hips", (0.95, 0.62, 0.40), "Cream", at((0, 0, 1.28))),
        tube("Waist", 0.26, 0.5, "Iron", at((0, 0, 1.55))),
        box("Chest", (1.35, 0.85, 1.10), "Paint", at((0, 0, 2.20))),
        box("Plate", (0.80, 0.12, 0.55), "Cream", at((0, -0.43, 2.28))),
        box("Pack", (0.95, 0.40, 0.85), "Cream", at((0, 0.55, 2.30))),
        tube("Neck", 0.17, 0.4, "Iron", at((0, -0.05, 2.80))),
        box("Head", (0.82, 0.66, 0.60), "Paint", head),
        box("Brow", (0.90, 0.30, 0.12), "Cream", head @ at((0, -0.26, 0.24)), panels=False),
    ]
    for side, name in ((-1, "Right"), (1, "Left")):
        made += [
            tube(f"{name} Ear", 0.16, 0.22, "Iron", head @ at((0.44 * side, 0, 0), (0, 90, 0))),
            *arm(name, side, 20 if side > 0 else 62),
            *leg(name, side, 0.10 * side),
        ]
    return made


def arm(name: str, side: int, lift: float) -> Parts:
    """Lifted forward by an angle at the elbow."""
    shoulder = Vector((0.92 * side, 0.0, 2.48))
    elbow = shoulder + Vector((0.10 * side, 0.02, -0.72))
    fore = at(elbow, (lift - 90, 0, 0))
    return [
        ball(f"{name} Shoulder", 0.27, shoulder),
        tube(f"{name} Arm", 0.16, 0.6, "Paint", at((shoulder + elbow) / 2, (0, -8 * side, 0))),
        ball(f"{name} Elbow", 0.18, elbow),
        box(f"{name} Forearm", (0.34, 0.72, 0.34), "Paint", fore @ at((0, -0.42, 0))),
        box(f"{name} Hand", (0.26, 0.26, 0.2), "Iron", fore @ at((0, -0.86, 0)), panels=False),
    ]


def leg(name: str, side: int, forward: float) -> Parts:
    x = 0.30 * side
    return [
        tube(f"{name} Thigh", 0.17, 0.45, "Iron", at((x, 0, 0.98))),
        ball(f"{name} Knee", 0.18, (x, -0.02, 0.78)),
        box(f"{name} Shin", (0.38, 0.42, 0.62), "Paint", at((x, 0, 0.42))),
        box(f"{name} Foot", (0.46, 0.80, 0.24), "Cream", at((x, -0.16 - forward, 0.10))),
    ]


def add_eyes() -> None:
    """Lamps; they are no part of the surface."""
    glow = material("Glow", (0.3, 0.9, 1.0), 0.2)
    shader = glow.node_tree.nodes["Principled BSDF"]
    shader.inputs["Emission Color"].default_value = (0.10, 0.75, 1.0, 1)
    shader.inputs["Emission Strength"].default_value = 0.9
    head = bpy.data.objects["Head"].matrix_world
    for x in (-0.18, 0.18):
        tube("Socket", 0.15, 0.10, "Iron", head @ at((x, -0.33, 0.04), (90, 0, 0)))
        tube("Eye", 0.10, 0.06, "Glow", head @ at((x, -0.37, 0.04), (90, 0, 0)))


def rivet() -> bpy.types.Object:
    bpy.ops.mesh.primitive_uv_sphere_add(segments=12, ring_count=8, radius=0.02)
    made = bpy.context.object
    for vertex in made.data.vertices:
        vertex.co.z *= 0.6
    made.data.shade_smooth()
    made.data.materials.append(material("Rivet", (0.30, 0.25, 0.19), 0.35))
    return hidden(made)


def moss() -> bpy.types.Object:
    """A soft lump of radius 1."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, radius=1.0)
    made = bpy.context.object
    made.name = made.data.name = "Moss"
    places = np.array([v.co for v in made.data.vertices])
    waves = np.sin(places @ np.array([[7.1, 2.3], [-3.0, 6.3], [4.4, 5.0]])).sum(axis=1)
    places *= (1.0 + 0.10 * waves)[:, None]
    places[:, 2] = 0.45 * places[:, 2] + 0.1
    move_vertices(made, places)
    made.data.shade_smooth()
    made.data.materials.append(color_by_chance("Moss", "id", "INSTANCER", _MOSS, 0.9))
    return hidden(made)


def add_rivets(parts: Parts, count: int, seed: int) -> int:
    made = scatter(parts[0], count, seed, *parts[1:])
    settings = made.dapple
    settings.scatter_on = "EDGES"
    settings.edge_creases = settings.edge_borders = False
    settings.edge_seams = True
    bpy.ops.dapple.optimize()
    settings.instance = rivet()
    return int(settings.report.count)


def add_plants(parts: Parts, count: int, seed: int) -> int:
    """Moss in patches on what faces up and sees the sky; grass and flowers among it."""
    lump, fern, petals = moss(), tuft("Fern", 7, 0.2, 0.16), flower()
    made = scatter(parts[0], count, seed, *parts[1:])
    settings = made.dapple
    density = settings.density
    density.use_slope, density.slope_max, density.slope_falloff = True, 0.6, 0.5
    density.use_outside, density.openness = True, 0.25
    density.use_noise, density.noise_size, density.noise_min = True, 0.7, 0.45
    common = {"random_scale_down": 0.6, "random_tilt": 0.25}
    add_class(made, "Moss", instance=lump, weight=0.74, scale=0.06, **common)
    add_class(made, "Grass", instance=fern, weight=0.17, **common)
    add_class(made, "Flowers", instance=petals, weight=0.09, align_to_normal=0.4, **common)
    bpy.ops.dapple.optimize()
    return int(settings.report.count)


def build_ground(count: int, seed: int) -> int:
    made, vertices = grid("Ground", 11.0, 44, 45.0)
    x, y = vertices[:, 0], vertices[:, 1]
    far = np.clip(np.hypot(x, y) / 11.0 - 0.35, 0.0, None)
    vertices[:, 2] = 0.05 * np.sin(1.9 * x) * np.cos(1.6 * y + 0.4) + 1.3 * far * (
        1.0 + np.sin(0.35 * x + 1.2) * np.cos(0.27 * y)
    )
    move_vertices(made, vertices)
    near = np.clip((5.2 - np.maximum(np.abs(x), np.abs(y))) / 2.0, 0.0, 1.0)
    paint(made, "Cover", np.ones(len(vertices)))
    paint(made, "Grass", near / (1.0 + ((y + 4.0) / 4.5) ** 2))
    made.data.materials.append(soil())
    blades = tuft("Tuft", 22, 0.32, 0.3)
    field = scatter(made, count, seed)
    add_class(
        field,
        "Grass",
        instance=blades,
        density="Grass",
        align_to_normal=0.4,
        random_scale_down=0.5,
        random_tilt=0.25,
    )
    bpy.ops.dapple.optimize()
    return int(field.dapple.report.count)


def main() -> None:
    given = options(__doc__, 2100, "plants").parse_args()
    begin()
    rusty("Paint", _PAINT)
    rusty("Cream", _CREAM)
    material("Iron", _IRON, 0.45)
    parts = build_robot()
    rivets = add_rivets(parts, given.count // 2, given.seed)
    plants = add_plants(parts, given.count, given.seed)
    add_eyes()
    grass = build_ground(5 * given.count // 2, given.seed)
    build_outdoors(given.width, 9 * given.width // 10, (-3.2, -6.6, 2.5), (0.0, 0.0, 1.80), 59)
    finish("robot", given, f"{len(parts)} parts, {rivets} rivets, {plants + grass} plants")


if __name__ == "__main__":
    run(main)
