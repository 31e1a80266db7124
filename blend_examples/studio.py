# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials, the stud that is scattered, lights, camera and render settings of the example."""

from __future__ import annotations

import math
from collections.abc import Sequence

import bpy
from mathutils import Vector

Color = tuple[float, float, float]
BODY: Color = (0.012, 0.055, 0.075)
RIM: Color = (0.02, 0.20, 0.22)
# Colors of the studs' tips by id, and the share of the ids up to which each is used.
TIPS: list[tuple[float, Color]] = [
    (0.55, (0.18, 0.66, 0.50)),
    (0.88, (0.62, 0.82, 0.42)),
    (1.00, (1.00, 0.32, 0.10)),
]
# Radius and height along the profile of a stud with radius 1; the first rings are its rim.
STUD = [(1.0, -0.25), (1.0, 0.10), (0.84, 0.20), (0.62, 0.22), (0.52, 0.46), (0.28, 0.66)]
STUD_TIP = 0.72
STUD_RIM_RINGS = 3
STUD_SIDES = 14


def use_nodes(block: bpy.types.Material | bpy.types.World) -> None:
    """Gives it a node tree; from Blender 5.0 on it has one from the start."""
    if bpy.app.version < (5, 0):
        block.use_nodes = True


def material(name: str, color: Color, roughness: float) -> bpy.types.Material:
    made = bpy.data.materials.new(name)
    use_nodes(made)
    shader = made.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*color, 1)
    shader.inputs["Roughness"].default_value = roughness
    made.diffuse_color = (*color, 1)
    return made


def color_by_chance(
    name: str,
    attribute: str,
    kind: str,
    colors: list[tuple[float, Color]],
    roughness: float = 0.3,
) -> bpy.types.Material:
    """A random one of the colors, by an attribute: who keeps its number keeps its color.

    kind is the attribute's type, GEOMETRY or INSTANCER; colors are as TIPS.
    """
    made = material(name, colors[0][1], roughness)
    nodes, links = made.node_tree.nodes, made.node_tree.links
    number = nodes.new("ShaderNodeAttribute")
    number.attribute_type, number.attribute_name = kind, attribute
    noise = nodes.new("ShaderNodeTexWhiteNoise")
    noise.noise_dimensions = "1D"
    ramp = nodes.new("ShaderNodeValToRGB")
    ramp.color_ramp.interpolation = "CONSTANT"
    starts = [0.0] + [end for end, _ in colors[:-1]]
    while len(ramp.color_ramp.elements) < len(colors):
        ramp.color_ramp.elements.new(1.0)
    for element, start, (_, color) in zip(ramp.color_ramp.elements, starts, colors, strict=True):
        element.position, element.color = start, (*color, 1)
    links.new(number.outputs["Fac"], noise.inputs["W"])
    links.new(noise.outputs["Value"], ramp.inputs["Fac"])
    links.new(ramp.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])
    return made


def build_stud(tips: list[tuple[float, Color]] = TIPS) -> bpy.types.Object:
    """A knob on a rim, turned about z, radius 1; it stands on z = 0."""
    turns = [2 * math.pi * side / STUD_SIDES for side in range(STUD_SIDES)]
    vertices = [(r * math.cos(t), r * math.sin(t), z) for r, z in STUD for t in turns]
    vertices.append((0.0, 0.0, STUD_TIP))
    faces: list[tuple[int, ...]] = []
    for ring in range(len(STUD) - 1):
        for side in range(STUD_SIDES):
            after = (side + 1) % STUD_SIDES
            low, high = ring * STUD_SIDES, (ring + 1) * STUD_SIDES
            faces.append((low + side, low + after, high + after, high + side))
    top = (len(STUD) - 1) * STUD_SIDES
    faces += [(top + s, top + (s + 1) % STUD_SIDES, len(vertices) - 1) for s in range(STUD_SIDES)]
    mesh = bpy.data.meshes.new("Stud")
    mesh.from_pydata(vertices, [], faces)
    mesh.shade_smooth()
    mesh.materials.append(material("Stud rim", RIM, 0.5))
    mesh.materials.append(color_by_chance("Stud tip", "id", "INSTANCER", tips))
    for index, face in enumerate(mesh.polygons):
        face.material_index = int(index >= STUD_RIM_RINGS * STUD_SIDES)
    stud = bpy.data.objects.new("Stud", mesh)
    bpy.context.scene.collection.objects.link(stud)
    # Only its instances are to be seen.
    stud.hide_render = stud.hide_viewport = True
    return stud


def eye_materials() -> list[bpy.types.Material]:
    return [
        material("Eye", (0.95, 0.78, 0.30), 0.08),
        material("Pupil", (0.004, 0.004, 0.006), 0.05),
    ]


def aim(thing: bpy.types.Object, place: Sequence[float], target: Sequence[float]) -> None:
    thing.location = place
    direction = Vector(target) - Vector(place)
    thing.rotation_euler = direction.to_track_quat("-Z", "Y").to_euler()


def add_light(name: str, place: Sequence[float], size: float, power: float, tint: Color) -> None:
    data = bpy.data.lights.new(name, "AREA")
    data.size, data.energy, data.color = size, power, tint
    light = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(light)
    aim(light, place, (0, 0, 0.5))


def add_floor() -> None:
    """A plane that bends up behind the creature, so that no horizon shows."""
    profile = [(-14.0, 0.0), (5.0, 0.0)]
    bend = [(5 + 4 * math.sin(a), 4 - 4 * math.cos(a)) for a in (0.25, 0.5, 0.8, 1.1, 1.4, 1.57)]
    line = profile + bend + [(9.0, 20.0)]
    vertices = [(x, y, z) for y, z in line for x in (-30.0, 30.0)]
    faces = [(2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2) for i in range(len(line) - 1)]
    mesh = bpy.data.meshes.new("Floor")
    mesh.from_pydata(vertices, [], faces)
    mesh.shade_smooth()
    mesh.materials.append(material("Floor", (0.84, 0.54, 0.29), 0.9))
    floor = bpy.data.objects.new("Floor", mesh)
    floor.location.z = -0.02
    bpy.context.scene.collection.objects.link(floor)


def build_studio(width: int, height: int) -> None:
    scene = bpy.context.scene
    add_floor()
    add_light("Key", (3.5, -4.5, 6.5), 1.4, 520, (1.0, 0.95, 0.88))
    add_light("Fill", (-6.0, -4.0, 3.0), 5.0, 120, (0.80, 0.90, 1.0))
    add_light("Back", (-2.0, 5.0, 5.0), 3.0, 260, (1.0, 0.90, 0.78))
    world = bpy.data.worlds.new("World")
    use_nodes(world)
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.75, 0.72, 0.70, 1)
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.35
    scene.world = world
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.lens = 57
    scene.collection.objects.link(camera)
    aim(camera, (4.6, -6.4, 4.6), (-0.3, 0.0, 0.42))
    scene.camera = camera
    set_render(scene, width, height)


def set_render(scene: bpy.types.Scene, width: int, height: int) -> None:
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = 16
    scene.cycles.use_denoising = True
    scene.cycles.max_bounces = 3
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.use_persistent_data = True
    scene.render.image_settings.file_format = "PNG"
    scene.view_settings.view_transform = "Standard"
