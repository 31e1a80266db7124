# SPDX-License-Identifier: GPL-3.0-or-later
"""A coral reef: five kinds of corals over eight rocks as one surface, each even by itself.

Run through `blend_examples/run.sh reef`, which sets everything up.
"""

from __future__ import annotations

import math

import bpy
import numpy as np
from mathutils import Vector, noise
from numpy.typing import NDArray

from blend_examples.scene import (
    add_class,
    begin,
    fade_into_haze,
    finish,
    grid,
    hidden,
    mesh_object,
    move_vertices,
    options,
    run,
    scatter,
)
from blend_examples.studio import Color, aim, color_by_chance, material, set_render, use_nodes

_WATER: Color = (0.015, 0.19, 0.30)
_CLEAR, _DIM = 3.2, 10.5  # distances in which the water hides nothing, and everything
_ROCKS = (  # x, y, z, radius
    *(
        (-1.7, 0.9, 0.0, 1.25),
        (0.1, 1.7, -0.05, 1.35),
        (1.9, 0.7, -0.1, 1.2),
        (0.3, 0.1, -0.35, 0.85),
    ),
    *(
        (-0.8, -0.6, -0.35, 0.6),
        (1.2, -0.7, -0.3, 0.6),
        (-2.9, 2.2, 0.1, 1.3),
        (3.1, 2.3, 0.1, 1.4),
    ),
)
_PINKS = [(0.4, (0.85, 0.16, 0.24)), (0.75, (0.90, 0.34, 0.30)), (1.0, (0.75, 0.12, 0.42))]
_YELLOWS = [(0.6, (0.95, 0.62, 0.10)), (1.0, (0.90, 0.42, 0.08))]
_PURPLES = [(0.5, (0.34, 0.12, 0.55)), (1.0, (0.20, 0.18, 0.62))]
_GREENS = [(0.5, (0.20, 0.50, 0.22)), (1.0, (0.45, 0.60, 0.16))]
_WHITES = [(0.5, (0.85, 0.80, 0.70)), (1.0, (0.75, 0.62, 0.55))]
Array = NDArray[np.float64]


def under_water(made: bpy.types.Material) -> bpy.types.Material:
    """The farther from the camera, the more like the water."""
    return fade_into_haze(made, _CLEAR, _DIM, _WATER)


def rock(k: int, x: float, y: float, z: float, radius: float) -> bpy.types.Object:
    """A lump with ledges."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4, radius=1.0, location=(x, y, z))
    made = bpy.context.object
    made.name = f"Rock {k}"
    for vertex in made.data.vertices:
        place = 1.3 * vertex.co + Vector((7.0 * k, 0.0, 0.0))
        rough = noise.noise(place) + 0.5 * noise.noise(2.3 * place) + 0.25 * noise.noise(5 * place)
        vertex.co *= radius * (1.0 + 0.28 * rough)
        vertex.co.z *= 0.9
    made.data.shade_smooth()
    made.data.materials.append(bpy.data.materials["Rock"])
    return made


def seabed() -> bpy.types.Object:
    made, vertices = grid("Sand", 9.0, 60, 30.0)
    x, y = vertices[:, 0], vertices[:, 1]
    ripples = 0.02 * np.sin(9.0 * y + 2.0 * np.sin(1.1 * x)) + 0.12 * np.sin(0.8 * x) * np.cos(y)
    vertices[:, 2] = -0.55 + ripples
    move_vertices(made, vertices)
    made.data.materials.append(under_water(material("Sand", (0.62, 0.54, 0.38), 0.9)))
    return made


def swept(
    name: str, lines: list[Array], sides: int, colors: list[tuple[float, Color]]
) -> bpy.types.Object:
    """Round branches along lines (n, 4) of points and radii, closed at their ends."""
    turns = np.linspace(0.0, 2.0 * np.pi, sides, endpoint=False)
    vertices: list[Array] = []
    faces: list[tuple[int, ...]] = []
    for line in lines:
        along = line[-1, :3] - line[0, :3]
        side = np.cross(along, (0.3, 1.0, 0.2))
        side /= np.linalg.norm(side)
        other = np.cross(along / np.linalg.norm(along), side)
        base = sum(len(one) for one in vertices)
        circle = np.cos(turns)[:, None] * side + np.sin(turns)[:, None] * other
        vertices.append(np.vstack([place[:3] + place[3] * circle for place in line]))
        for row in range(len(line) - 1):
            for k in range(sides):
                low, after = base + row * sides, (k + 1) % sides
                faces.append((low + k, low + after, low + sides + after, low + sides + k))
        top = base + (len(line) - 1) * sides
        faces.append(tuple(range(top, top + sides)))
    made = mesh_object(name, np.vstack(vertices), faces)
    made.data.materials.append(under_water(color_by_chance(name, "id", "INSTANCER", colors, 0.5)))
    return hidden(made)


def staghorn() -> bpy.types.Object:
    """Branches that fork three times, about 1 high and wide."""
    random = np.random.default_rng(3)
    lines: list[Array] = []

    def grow(start: Array, direction: Array, length: float, radius: float, left: int) -> None:
        end = start + length * direction
        middle = (start + end) / 2
        radii = (radius, 0.85 * radius, 0.7 * radius if left else 0.35 * radius)
        lines.append(np.column_stack([np.vstack([start, middle, end]), radii]))
        for _ in range(3 if left else 0):
            bent = direction + random.normal(0.0, 0.48, 3) + (0.0, 0.0, 0.15)
            grow(end, bent / np.linalg.norm(bent), 0.78 * length, 0.72 * radius, left - 1)

    for k in range(5):
        turn = 2.4 * k
        lean = np.array([0.6 * math.cos(turn), 0.6 * math.sin(turn), 1.0])
        grow(np.zeros(3), lean / np.linalg.norm(lean), 0.32, 0.06, 2)
    return swept("Staghorn", lines, 6, _PINKS)


def tubes() -> bpy.types.Object:
    """A bundle of open tubes."""
    lines = []
    for k in range(7):
        turn, out = 2.4 * k, 0.07 * math.sqrt(k)
        foot = np.array([out * math.cos(turn), out * math.sin(turn), 0.0])
        high = 0.85 - 0.07 * k
        tip = 2.2 * foot + (0.0, 0.0, high)
        rows = [(*foot, 0.05), (*(0.5 * (foot + tip)), 0.085), (*tip, 0.10)]
        rows += [(*tip, 0.075), (*(tip - (0.0, 0.0, 0.25)), 0.05)]
        lines.append(np.array(rows))
    return swept("Tubes", lines, 12, _YELLOWS)


def brain() -> bpy.types.Object:
    """A dome with furrows, of radius 1."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=1.0)
    made = bpy.context.object
    made.name = made.data.name = "Brain"
    for vertex in made.data.vertices:
        place = 2.2 * vertex.co
        warped = place + 0.9 * Vector(noise.noise_vector(1.1 * place))
        furrow = abs(math.sin(7.0 * warped.x + 5.0 * warped.y + 4.0 * warped.z))
        vertex.co *= 0.93 + 0.07 * furrow
        vertex.co.z = 0.75 * vertex.co.z
    made.data.shade_smooth()
    made.data.materials.append(
        under_water(color_by_chance("Brain", "id", "INSTANCER", _GREENS, 0.6))
    )
    return hidden(made)


def fan() -> bpy.types.Object:
    """A flat fan of twigs in the plane y = 0, about 1 high."""
    random = np.random.default_rng(5)
    lines: list[Array] = []

    def grow(x: float, z: float, angle: float, length: float, radius: float) -> None:
        end = (x + length * math.sin(angle), 0.0, z + length * math.cos(angle))
        middle = ((x + end[0]) / 2, 0.015 * random.normal(), (z + end[2]) / 2)
        points = np.array([(x, 0.0, z), middle, end])
        lines.append(np.column_stack([points, (radius, 0.9 * radius, 0.75 * radius)]))
        if length > 0.07:
            for turn in (-0.38, 0.02, 0.36):
                grow(
                    end[0],
                    end[2],
                    angle + turn + 0.08 * random.normal(),
                    0.74 * length,
                    0.72 * radius,
                )

    grow(0.0, 0.0, 0.0, 0.27, 0.03)
    return swept("Fan", lines, 4, _PURPLES)


def anemone() -> bpy.types.Object:
    """A tuft of soft arms, about 1 wide."""
    lines = []
    for k in range(40):
        turn, out = 2.4 * k, math.sqrt(k / 40)
        reach = np.array([math.cos(turn), math.sin(turn), 0.0])
        rows = [
            (*(0.22 * out * reach), 0.0, 0.045),
            (*(0.38 * out * reach), 0.0, 0.04),
            (*(0.52 * out * reach), 0.0, 0.045),
        ]
        line = np.array(
            [
                (r[0], r[1], z, r[-1])
                for r, z in zip(rows, (0.0, 0.25, 0.42 - 0.2 * out), strict=True)
            ]
        )
        lines.append(line)
    return swept("Anemone", lines, 6, _WHITES)


def light_and_camera(width: int, height: int) -> None:
    scene = bpy.context.scene
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.data.angle, sun.data.color = 4.2, 0.05, (0.85, 0.97, 1.0)
    scene.collection.objects.link(sun)
    aim(sun, (-2.5, -2.0, 6.0), (0.0, 0.0, 0.0))
    world = bpy.data.worlds.new("Water")
    use_nodes(world)
    background = world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (*_WATER, 1)
    background.inputs["Strength"].default_value = 1.0
    scene.world = world
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.lens = 36
    scene.collection.objects.link(camera)
    aim(camera, (0.1, -4.6, 1.15), (0.1, 0.4, 0.50))
    scene.camera = camera
    set_render(scene, max(width, 1), max(height, 1))
    scene.cycles.samples = 24


def main() -> None:
    given = options(__doc__, 1050, "corals").parse_args()
    begin()
    under_water(material("Rock", (0.20, 0.11, 0.13), 0.9))
    rocks = [rock(k, *one) for k, one in enumerate(_ROCKS)]
    seabed()
    kinds = [staghorn(), tubes(), brain(), fan(), anemone()]
    made = scatter(rocks[0], given.count, given.seed, *rocks[1:])
    density = made.dapple.density
    density.use_slope, density.slope_max, density.slope_falloff = True, math.radians(75), 0.5
    density.use_height, density.height_min, density.height_falloff = True, -0.35, 0.1
    shares = (
        (0.30, 0.46, 0.5),
        (0.15, 0.46, 0.5),
        (0.09, 0.20, 0.6),
        (0.08, 0.75, 0.4),
        (0.38, 0.24, 0.6),
    )
    for thing, (weight, scale, align) in zip(kinds, shares, strict=True):
        add_class(
            made,
            thing.data.name,
            instance=thing,
            weight=weight,
            scale=scale,
            align_to_normal=align,
            random_scale_down=0.5,
            random_tilt=0.15,
        )
    bpy.ops.dapple.optimize()
    light_and_camera(given.width, 5 * given.width // 8)
    finish("reef", given, f"{int(made.dapple.report.count)} corals on {len(rocks)} rocks")


if __name__ == "__main__":
    run(main)
