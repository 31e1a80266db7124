# SPDX-License-Identifier: GPL-3.0-or-later
"""A knight in scale armor who runs: every scale keeps its place on him, and they stay even.

Run through `blend_examples/run.sh knight`, which sets everything up.
"""

from __future__ import annotations

import math
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix, Vector

from blend_examples.creature import select
from blend_examples.scales import scale
from blend_examples.scene import (
    begin,
    build_studio,
    finish,
    mesh_object,
    options,
    paint,
    run,
    scatter,
)
from blend_examples.studio import Color, color_by_chance, material

FRAMES = 16  # of one stride, which ends as it began
_STEEL = [(0.55, (0.46, 0.48, 0.52)), (0.85, (0.30, 0.32, 0.36)), (1.0, (0.62, 0.44, 0.16))]
_PLATE: Color = (0.40, 0.42, 0.46)
_CLOTH: Color = (0.30, 0.02, 0.03)
# Joints of the right half: where they are, and the half widths of the body there. He faces -y.
_MIDDLE = {
    "hips": ((0.0, 0.0, 1.00), (0.19, 0.14)),
    "waist": ((0.0, 0.0, 1.20), (0.165, 0.12)),
    "chest": ((0.0, 0.0, 1.46), (0.22, 0.15)),
    "neck": ((0.0, 0.0, 1.68), (0.085, 0.085)),
    "head": ((0.0, -0.02, 1.86), (0.12, 0.12)),
}
_SIDE = {
    "shoulder": ("chest", (0.27, 0.0, 1.56), (0.105, 0.105)),
    "elbow": ("shoulder", (0.50, 0.02, 1.30), (0.075, 0.075)),
    "wrist": ("elbow", (0.70, -0.02, 1.06), (0.055, 0.055)),
    "hand": ("wrist", (0.77, -0.04, 0.97), (0.06, 0.045)),
    "thigh": ("hips", (0.125, 0.0, 0.90), (0.13, 0.13)),
    "knee": ("thigh", (0.15, -0.01, 0.52), (0.085, 0.085)),
    "ankle": ("knee", (0.16, 0.03, 0.12), (0.06, 0.06)),
    "toe": ("ankle", (0.17, -0.17, 0.055), (0.065, 0.045)),
}
# Bones from joint to joint; sides are added to the names of the lower ones.
_SPINE = (("spine", "hips", "waist"), ("ribs", "waist", "chest"), ("skull", "neck", "head"))
_LIMBS = (
    ("arm", "shoulder", "elbow"),
    ("forearm", "elbow", "wrist"),
    ("leg", "thigh", "knee"),
    ("shin", "knee", "ankle"),
    ("foot", "ankle", "toe"),
)
_PARENTS = {"ribs": "spine", "skull": "ribs", "arm": "ribs", "leg": "spine"}
_PARENTS |= {"forearm": "arm", "shin": "leg", "foot": "shin"}


def joints() -> dict[str, Vector]:
    found = {name: Vector(place) for name, (place, _) in _MIDDLE.items()}
    for side, sign in ((".L", 1), (".R", -1)):
        for name, (_, (x, y, z), _) in _SIDE.items():
            found[name + side] = Vector((sign * x, y, z))
    return found


def build_body() -> bpy.types.Object:
    """A skin over the joints."""
    places = joints()
    rows = list(places)
    links = list(zip(list(_MIDDLE), list(_MIDDLE)[1:], strict=False))
    sizes = {name: size for name, (_, size) in _MIDDLE.items()}
    for side in (".L", ".R"):
        for name, (parent, _, size) in _SIDE.items():
            links.append((parent if parent in _MIDDLE else parent + side, name + side))
            sizes[name + side] = size
    mesh = bpy.data.meshes.new("Knight")
    pairs = [(rows.index(a), rows.index(b)) for a, b in links]
    mesh.from_pydata([places[name] for name in rows], pairs, [])
    made = bpy.data.objects.new("Knight", mesh)
    bpy.context.scene.collection.objects.link(made)
    select(made)
    made.modifiers.new("Skin", "SKIN")
    for name, vertex in zip(rows, mesh.skin_vertices[0].data, strict=True):
        vertex.radius, vertex.use_root = sizes[name], name == "hips"
    made.modifiers.new("Round", "SUBSURF").levels = 2
    for name in ("Skin", "Round"):
        bpy.ops.object.modifier_apply(modifier=name)
    made.data.shade_smooth()
    return made


def build_armature() -> bpy.types.Object:
    data = bpy.data.armatures.new("Skeleton")
    made = bpy.data.objects.new("Skeleton", data)
    bpy.context.scene.collection.objects.link(made)
    select(made)
    bpy.ops.object.mode_set(mode="EDIT")
    places = joints()
    bones = [(name, start, end) for name, start, end in _SPINE]
    for side in (".L", ".R"):
        bones += [(n + side, a + side, b + side) for n, a, b in _LIMBS]
    for name, start, end in bones:
        bone = data.edit_bones.new(name)
        bone.head, bone.tail = places[start], places[end]
        bone.align_roll(Vector((0, -1, 0)))  # so that it bends about its own x
        stem, _, side = name.partition(".")
        parent = _PARENTS.get(stem)
        if parent:
            bone.parent = data.edit_bones.get(f"{parent}.{side}") or data.edit_bones.get(parent)
    bpy.ops.object.mode_set(mode="OBJECT")
    for bone in made.pose.bones:
        bone.rotation_mode = "XYZ"
    return made


def bind(body: bpy.types.Object, armature: bpy.types.Object) -> None:
    bpy.ops.object.select_all(action="DESELECT")
    body.select_set(True)
    armature.select_set(True)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.parent_set(type="ARMATURE_AUTO")


def lowest(body: bpy.types.Object) -> float:
    """Height of the lowest vertex in the current pose; boots reach a little deeper."""
    bpy.context.view_layer.update()
    shown = body.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return min((shown.matrix_world @ vertex.co).z for vertex in shown.data.vertices) - 0.02


def swing(part: float) -> dict[str, float]:
    """Angles in degrees of one side at a part of the stride; a leg forward is positive."""
    wave = math.sin(2 * math.pi * part)
    lag = math.sin(2 * math.pi * (part - 0.2))
    return {
        "leg": 12 + 48 * wave,
        "shin": -52 + 46 * lag,
        "foot": 8 * lag,
        "arm": -4 - 46 * wave,
        "forearm": 78 + 12 * wave,
    }


def animate(armature: bpy.types.Object, body: bpy.types.Object) -> None:
    """One foot is on the ground in the middle of each step, none between two."""
    bones = armature.pose.bones
    for key in range(9):
        part, frame = key / 8, 1 + FRAMES * key / 8
        turns = {"spine": (9, 0, 9), "ribs": (8, 0, -18), "skull": (-9, 0, 8)}
        for name, (x, y, twist) in turns.items():
            angle = twist * math.sin(2 * math.pi * part)
            bones[name].rotation_euler = [math.radians(a) for a in (x, angle, y)]
            bones[name].keyframe_insert("rotation_euler", frame=frame)
        for side, shift in ((".L", 0.0), (".R", 0.5)):
            for name, angle in swing(part + shift).items():
                bone = bones[name + side]
                bone.rotation_euler = (math.radians(angle), 0.0, 0.0)
                bone.keyframe_insert("rotation_euler", frame=frame)
        armature.location.z += 0.12 * abs(math.sin(2 * math.pi * part)) - lowest(body)
        armature.keyframe_insert("location", frame=frame)


def worn(armature: bpy.types.Object, bone: str, thing: bpy.types.Object) -> bpy.types.Object:
    """Carried by a bone, from where it is in the rest position."""
    rest = armature.data.bones[bone]
    thing.parent, thing.parent_type, thing.parent_bone = armature, "BONE", bone
    tail = rest.matrix_local @ Matrix.Translation((0, rest.length, 0))  # where children start
    thing.matrix_parent_inverse = tail.inverted()
    return thing


def ball(name: str, place: Any, size: Any, look: str) -> bpy.types.Object:
    bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16, radius=1.0, location=place)
    made = bpy.context.object
    made.name, made.scale = name, size
    made.data.shade_smooth()
    made.data.materials.append(bpy.data.materials[look])
    return made


def block(name: str, place: Any, size: Any, look: str) -> bpy.types.Object:
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=place)
    made = bpy.context.object
    made.name, made.scale = name, size
    made.data.materials.append(bpy.data.materials[look])
    bevel = made.modifiers.new("Bevel", "BEVEL")
    bevel.width, bevel.segments = 0.01, 2
    return made


def plume() -> bpy.types.Object:
    """A crest from the forehead to the neck."""
    turns = np.linspace(-0.4, 2.5, 20)
    rows = []
    for turn in turns:
        out = 0.15 + 0.10 * math.sin((turn + 0.4) / 2.9 * math.pi) ** 0.7
        y, z = -math.cos(turn + 0.5), math.sin(turn + 0.5)
        for x in (-0.012, 0.012):
            rows += [(x, 0.13 * y, 0.15 * z), (2.0 * x, out * y * 1.05, out * z * 1.1)]
    faces = []
    for k in range(len(turns) - 1):
        low, high = 4 * k, 4 * (k + 1)
        faces += [
            (low, low + 1, high + 1, high),
            (low + 2, high + 2, high + 3, low + 3),
            (low + 1, low + 3, high + 3, high + 1),
        ]
    made = mesh_object("Plume", rows, faces)
    made.location = (0.0, -0.02, 1.86)
    made.data.materials.append(bpy.data.materials["Cloth"])
    return made


def equip(armature: bpy.types.Object) -> None:
    """Helmet, gauntlets, boots, shield and sword."""
    worn(armature, "skull", ball("Helmet", (0, -0.02, 1.85), (0.135, 0.15, 0.165), "Plate"))
    worn(armature, "skull", block("Visor", (0, -0.14, 1.87), (0.17, 0.06, 0.022), "Dark"))
    worn(armature, "skull", block("Nose", (0, -0.168, 1.82), (0.022, 0.03, 0.16), "Gold"))
    worn(armature, "skull", ball("Collar", (0, -0.01, 1.70), (0.135, 0.135, 0.045), "Gold"))
    worn(armature, "skull", plume())
    for side, sign in ((".L", 1), (".R", -1)):
        hand = ball("Gauntlet" + side, (0.745 * sign, -0.03, 1.005), (0.062, 0.062, 0.085), "Plate")
        hand.rotation_euler.y = -0.7 * sign
        worn(armature, "forearm" + side, hand)
        worn(
            armature,
            "foot" + side,
            ball("Boot" + side, (0.165 * sign, -0.08, 0.065), (0.075, 0.16, 0.075), "Leather"),
        )
        worn(
            armature,
            "shin" + side,
            ball("Cuff" + side, (0.16 * sign, 0.025, 0.15), (0.085, 0.085, 0.085), "Leather"),
        )
        worn(
            armature,
            "arm" + side,
            ball("Pauldron" + side, (0.285 * sign, 0.0, 1.60), (0.125, 0.125, 0.10), "Plate"),
        )
    arm_with_sword(armature)
    shield = ball("Shield", (0.66, -0.10, 1.16), (0.27, 0.045, 0.27), "Cloth")
    worn(armature, "forearm.L", shield)
    worn(armature, "forearm.L", ball("Boss", (0.66, -0.13, 1.16), (0.07, 0.05, 0.07), "Gold"))


def arm_with_sword(armature: bpy.types.Object) -> None:
    """In the right hand, at a right angle to the forearm."""
    bpy.context.view_layer.update()
    hand = Vector((-0.76, -0.035, 0.98))
    tilt = (
        Matrix.Translation(hand)
        @ Matrix.Rotation(math.radians(62), 4, "X")
        @ Matrix.Rotation(-0.55, 4, "Y")
    )
    for name, at, size, look in (
        ("Blade", (0, 0, 0.52), (0.05, 0.014, 0.82), "Plate"),
        ("Guard", (0, 0, 0.11), (0.20, 0.035, 0.03), "Gold"),
        ("Grip", (0, 0, 0.0), (0.032, 0.032, 0.20), "Leather"),
    ):
        made = block(name, (0, 0, 0), size, look)
        made.matrix_basis = tilt @ Matrix.Translation(at) @ made.matrix_basis
        worn(armature, "forearm.R", made)


def cover(body: bpy.types.Object) -> None:
    """The attribute Armor: no scales under helmet, gauntlets and boots."""
    places = np.array([v.co for v in body.data.vertices])
    free = (places[:, 2] < 1.68) & (places[:, 2] > 0.20) & (np.abs(places[:, 0]) < 0.69)
    paint(body, "Armor", free.astype(float))


def main() -> None:
    given = options(__doc__, 2000, "scales").parse_args()
    begin()
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 1 + FRAMES
    for name, color, rough in (
        *(("Plate", _PLATE, 0.25), ("Gold", (0.62, 0.40, 0.12), 0.3), ("Cloth", _CLOTH, 0.7)),
        *(("Leather", (0.10, 0.05, 0.025), 0.6), ("Dark", (0.01, 0.01, 0.01), 0.8)),
    ):
        look = material(name, color, rough)
        look.node_tree.nodes["Principled BSDF"].inputs["Metallic"].default_value = name in (
            "Plate",
            "Gold",
        )
    body, armature = build_body(), build_armature()
    bind(body, armature)
    cover(body)
    body.data.materials.append(material("Mail", (0.05, 0.05, 0.055), 0.5))
    equip(armature)
    animate(armature, body)
    scene.frame_set(1)
    thing = scale()
    thing.data.materials.clear()
    steel = color_by_chance("Steel", "id", "INSTANCER", _STEEL, 0.3)
    steel.node_tree.nodes["Principled BSDF"].inputs["Metallic"].default_value = 0.9
    thing.data.materials.append(steel)
    made = scatter(body, given.count, given.seed)
    made.dapple.quality = "REGULAR"
    made.dapple.forward, made.dapple.random_turn = "-Z", 0.04
    made.dapple.density.attribute = "Armor"
    made.dapple.instance, made.dapple.scale = thing, 0.78 * made.dapple.report.spacing
    bpy.ops.dapple.optimize()
    made.dapple.scale = 0.8 * made.dapple.report.spacing
    select(made)
    bpy.ops.dapple.bake()
    build_studio(given.width, 9 * given.width // 8, (-2.5, -4.2, 1.5), (0.03, 0.0, 1.12), 64)
    scene.frame_set(5)
    report = made.dapple.report
    finish(
        "knight", given, f"{report.count} scales, area variation {report.capacity_variation:.3f}"
    )


if __name__ == "__main__":
    run(main)
