# SPDX-License-Identifier: GPL-3.0-or-later
"""A newt with a skeleton: mesh, armature, vertex weights and a looping animation, all from numbers.

The body is a tube of octagonal rings along x (the nose at +x, z up) out of which four legs grow; a
subdivision modifier after the armature rounds it. Lengths are in meters.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import bmesh
import bpy
import numpy as np
from mathutils import Matrix, Vector

SIDES = 8
SUBDIVISION = 3
EYE_RADIUS = 0.21

# Along the body from the tip of the tail: x, half width, half height, height of the center.
RINGS = [
    (-3.15, 0.07, 0.07, 0.20),
    (-2.80, 0.15, 0.14, 0.20),
    (-2.30, 0.22, 0.21, 0.24),
    (-1.80, 0.28, 0.26, 0.31),
    (-1.35, 0.35, 0.31, 0.40),
    (-0.95, 0.42, 0.37, 0.50),
    (-0.50, 0.52, 0.45, 0.57),
    (-0.10, 0.56, 0.49, 0.60),
    (0.30, 0.54, 0.48, 0.62),
    (0.70, 0.47, 0.42, 0.66),
    (1.00, 0.40, 0.37, 0.74),
    (1.30, 0.50, 0.42, 0.80),
    (1.65, 0.60, 0.44, 0.82),
    (2.00, 0.53, 0.36, 0.79),
    (2.25, 0.30, 0.22, 0.74),
]

# Name: parent, head, tail. The spine runs both ways from the hips.
BONES = {
    "hips": (None, (-0.55, 0, 0.57), (0.00, 0, 0.60)),
    "chest": ("hips", (0.00, 0, 0.60), (0.95, 0, 0.70)),
    "head": ("chest", (0.95, 0, 0.70), (2.30, 0, 0.80)),
    "tail.1": ("hips", (-0.55, 0, 0.57), (-1.25, 0, 0.42)),
    "tail.2": ("tail.1", (-1.25, 0, 0.42), (-1.90, 0, 0.30)),
    "tail.3": ("tail.2", (-1.90, 0, 0.30), (-2.50, 0, 0.22)),
    "tail.4": ("tail.3", (-2.50, 0, 0.22), (-3.20, 0, 0.20)),
}
SPINE = ["tail.4", "tail.3", "tail.2", "tail.1", "hips", "chest", "head"]

# Name: the ring a leg starts behind, its side of the body, how far the foot reaches forward.
LEGS = {
    "leg.hind.L": (5, 1, -0.16),
    "leg.hind.R": (5, -1, -0.16),
    "leg.fore.L": (8, 1, 0.22),
    "leg.fore.R": (8, -1, 0.22),
}


@dataclass
class Cage:
    """The control mesh, with the bone weights of each vertex."""

    vertices: list[tuple[float, float, float]] = field(default_factory=list)
    faces: list[tuple[int, ...]] = field(default_factory=list)
    weights: list[dict[str, float]] = field(default_factory=list)

    def add(self, position: tuple[float, float, float], weights: dict[str, float]) -> int:
        self.vertices.append(position)
        self.weights.append(weights)
        return len(self.vertices) - 1


def spine_weights(x: float) -> dict[str, float]:
    """Shares of the two bones whose middles enclose x, linear between them."""
    middles = [(BONES[name][1][0] + BONES[name][2][0]) / 2 for name in SPINE]
    right = int(np.clip(np.searchsorted(middles, x), 1, len(SPINE) - 1))
    share = (x - middles[right - 1]) / (middles[right] - middles[right - 1])
    share = float(np.clip(share, 0.0, 1.0))
    return {SPINE[right - 1]: 1.0 - share, SPINE[right]: share}


def add_ring(cage: Cage, ring: tuple[float, float, float, float]) -> list[int]:
    x, width, height, center = ring
    turns = [2 * math.pi * (side + 0.5) / SIDES for side in range(SIDES)]
    weights = spine_weights(x)
    return [
        cage.add((x, width * math.cos(turn), center + height * math.sin(turn)), weights)
        for turn in turns
    ]


def add_leg(cage: Cage, name: str, opening: list[int]) -> None:
    """Grows a leg out of the four vertices of a missing face: shin, ankle, foot."""
    _, side, reach = LEGS[name]
    corners = np.array([cage.vertices[i] for i in opening])
    center = corners.mean(axis=0)
    body = cage.weights[opening[0]]
    # Offset of the section's center from the opening, its size, and the leg bone's share.
    sections = [
        ((0.3 * reach, 0.26 * side, 0.02), 0.86, 0.5),
        ((0.8 * reach, 0.46 * side, -0.11), 0.70, 1.0),
        ((1.0 * reach + 0.05, 0.53 * side, 0.08 - center[2]), 0.90, 1.0),
    ]
    ring = opening
    for offset, size, share in sections:
        weights = {bone: value * (1 - share) for bone, value in body.items()} | {name: share}
        places = center + np.array(offset) + size * (corners - center)
        grown = [cage.add((float(p[0]), float(p[1]), float(p[2])), weights) for p in places]
        cage.faces += [(ring[k], ring[(k + 1) % 4], grown[(k + 1) % 4], grown[k]) for k in range(4)]
        ring = grown
    cage.faces.append(tuple(ring))


def build_cage() -> Cage:
    cage = Cage()
    rings = [add_ring(cage, ring) for ring in RINGS]
    # A leg takes the place of the face that points down and out: 6 on the left, 4 on the right.
    legs = {(ring, 6 if side > 0 else 4): name for name, (ring, side, _) in LEGS.items()}
    for i in range(len(rings) - 1):
        for side in range(SIDES):
            after = (side + 1) % SIDES
            quad = [rings[i][side], rings[i][after], rings[i + 1][after], rings[i + 1][side]]
            if (i, side) in legs:
                add_leg(cage, legs[i, side], quad)
            else:
                cage.faces.append(tuple(quad))
    cage.faces.append(tuple(reversed(rings[0])))
    cage.faces.append(tuple(rings[-1]))
    return cage


def build_armature() -> bpy.types.Object:
    data = bpy.data.armatures.new("Newt Skeleton")
    armature = bpy.data.objects.new("Newt Skeleton", data)
    bpy.context.scene.collection.objects.link(armature)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    for name, (parent, head, tail) in BONES.items():
        add_bone(data, name, parent, head, tail)
    for name, (ring, side, reach) in LEGS.items():
        x = (RINGS[ring][0] + RINGS[ring + 1][0]) / 2
        parent = "hips" if "hind" in name else "chest"
        add_bone(data, name, parent, (x, 0.35 * side, 0.4), (x + reach, 0.8 * side, 0.08))
    bpy.ops.object.mode_set(mode="OBJECT")
    for bone in armature.pose.bones:
        bone.rotation_mode = "XYZ"
    return armature


def add_bone(
    data: bpy.types.Armature,
    name: str,
    parent: str | None,
    head: tuple[float, float, float],
    tail: tuple[float, float, float],
) -> None:
    bone = data.edit_bones.new(name)
    bone.head, bone.tail = head, tail
    bone.align_roll(Vector((0, 0, 1)))
    # A stretched spine must not fatten the head, the tail and the legs.
    bone.inherit_scale = "NONE"
    if parent:
        bone.parent = data.edit_bones[parent]


def build_body(armature: bpy.types.Object) -> bpy.types.Object:
    cage = build_cage()
    mesh = bpy.data.meshes.new("Newt")
    mesh.from_pydata(cage.vertices, [], cage.faces)
    mesh.shade_smooth()
    body = bpy.data.objects.new("Newt", mesh)
    bpy.context.scene.collection.objects.link(body)
    for vertex, weights in enumerate(cage.weights):
        for bone, weight in weights.items():
            group = body.vertex_groups.get(bone) or body.vertex_groups.new(name=bone)
            group.add([vertex], weight, "REPLACE")
    body.parent = armature
    body.modifiers.new("Skin", "ARMATURE").object = armature
    subdivision = body.modifiers.new("Round", "SUBSURF")
    subdivision.levels = subdivision.render_levels = SUBDIVISION
    return body


def eye_mesh() -> bpy.types.Mesh:
    """A ball with radius 1 whose pole looks along z; the faces about the pole are the pupil."""
    mesh = bpy.data.meshes.new("Eye")
    ball = bmesh.new()
    bmesh.ops.create_uvsphere(ball, u_segments=32, v_segments=24, radius=1)
    for face in ball.faces:
        face.material_index = int(face.calc_center_median().normalized().z > 0.72)
        face.smooth = True
    ball.to_mesh(mesh)
    ball.free()
    return mesh


def build_eyes(armature: bpy.types.Object, materials: list[bpy.types.Material]) -> None:
    mesh = eye_mesh()
    for material in materials:
        mesh.materials.append(material)
    for side in (1, -1):
        eye = bpy.data.objects.new("Eye", mesh)
        bpy.context.scene.collection.objects.link(eye)
        gaze = Vector((0.62, 0.76 * side, 0.26))
        place = Matrix.LocRotScale(
            (1.72, 0.40 * side, 1.12), gaze.to_track_quat("Z", "Y"), (EYE_RADIUS,) * 3
        )
        eye.parent, eye.parent_type, eye.parent_bone = armature, "BONE", "head"
        # A bone's children start at its tail.
        bone = armature.data.bones["head"]
        tail = bone.matrix_local @ Matrix.Translation((0, bone.length, 0))
        eye.matrix_parent_inverse = tail.inverted()
        eye.matrix_basis = place


# A pose: for each bone its pitch, yaw (degrees, about its own x and z) and length.
Pose = dict[str, tuple[float, float, float]]
REACH: Pose = {
    "hips": (0, 0, 1.22),
    "chest": (0, 0, 1.28),
    "head": (-4, 0, 1),
    "tail.1": (0, 0, 1.2),
    "tail.2": (0, 0, 1.2),
    "tail.3": (0, 0, 1.2),
}
LEFT: Pose = {
    "hips": (0, -6, 0.95),
    "chest": (0, 34, 0.95),
    "head": (0, 30, 1),
    "tail.1": (0, -34, 1),
    "tail.2": (0, -30, 1),
    "tail.3": (0, -26, 1),
    "tail.4": (0, -26, 1),
}
RIGHT: Pose = {bone: (pitch, -yaw, length) for bone, (pitch, yaw, length) in LEFT.items()}
LOOK_UP: Pose = {
    "hips": (4, 0, 0.9),
    "chest": (26, 10, 0.92),
    "head": (16, 16, 1),
    "tail.1": (-4, 22, 1),
    "tail.2": (-2, 34, 1),
    "tail.3": (4, 42, 1),
    "tail.4": (6, 42, 1),
}
# The poses of one loop, evenly over the frame range: which diagonal pair of legs is forward, and
# where along x the creature stands.
LOOP = [(LEFT, 1, -0.4), (REACH, -1, -0.45), (RIGHT, 1, 0.3), (LOOK_UP, 0, 0.0), (LEFT, 1, -0.4)]


def animate(armature: bpy.types.Object, first: int, last: int) -> None:
    for index, (pose, stride, place) in enumerate(LOOP):
        frame = first + (last - first) * index / (len(LOOP) - 1)
        armature.location.x = place
        armature.keyframe_insert("location", frame=frame)
        for bone in armature.pose.bones:
            pitch, yaw, length = pose.get(bone.name, (0, 0, 1))
            if bone.name in LEGS:
                yaw = 16 * stride * (1 if bone.name in ("leg.fore.L", "leg.hind.R") else -1)
                yaw *= LEGS[bone.name][1]
            thin = 1 / math.sqrt(length)
            bone.rotation_euler = (math.radians(pitch), 0, math.radians(yaw))
            bone.scale = (thin, length, thin)
            bone.keyframe_insert("rotation_euler", frame=frame)
            bone.keyframe_insert("scale", frame=frame)
