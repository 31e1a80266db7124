# SPDX-License-Identifier: GPL-3.0-or-later
"""Grounds, a body that bends, and things to avoid, as an artist has them."""

from __future__ import annotations

import math
from typing import Any

import bpy
import numpy as np

FRAMES = 20


def empty() -> None:
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.context.scene.frame_end = FRAMES


def grid(cells: int = 60, size: float = 2.0) -> Any:
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=cells, y_subdivisions=cells, size=size)
    return bpy.context.object


def monkey(levels: int = 2) -> Any:
    bpy.ops.mesh.primitive_monkey_add()
    obj = bpy.context.object
    obj.modifiers.new("Subdivision", "SUBSURF").levels = levels
    return obj


def cube(size: float, location: tuple[float, float, float]) -> Any:
    bpy.ops.mesh.primitive_cube_add(size=size, location=location)
    return bpy.context.object


def collection_of(*objects: Any) -> Any:
    made = bpy.data.collections.new("Things")
    bpy.context.scene.collection.children.link(made)
    for obj in objects:
        made.objects.link(obj)
    return made


def active(obj: Any) -> Any:
    for other in bpy.context.selected_objects:
        other.select_set(False)
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj
    return obj


def scatter(surface: Any, count: int) -> Any:
    active(surface)
    bpy.ops.dapple.add_scatter(count=count)
    return bpy.context.object


def add_types(obj: Any, *kinds: tuple[int, float]) -> None:
    """Object types with an exact count and a radius; 0 counts share the rest."""
    for count, radius in kinds:
        active(obj)
        bpy.ops.dapple.edit_object_types(action="ADD")
        kind = obj.dapple.object_types[-1]
        kind.use_count, kind.count, kind.radius = count > 0, max(count, 1), radius
        thing = cube(0.01, (9.0, 9.0, 9.0))
        thing.name = f"Thing {len(obj.dapple.object_types) - 1}"
        kind.instance = thing
    active(obj)


def radii_of(obj: Any, names: list[str]) -> np.ndarray:
    """Radii (n,) of instances by the names of their objects."""
    known = {kind.instance.name: kind.radius for kind in obj.dapple.object_types}
    return np.array([known[name] for name in names])


def body(levels: int = 2) -> Any:
    """A tube that is skinned to two bones, bends and is stretched."""
    rig = _rig()
    obj = _tube()
    obj.modifiers.new("Armature", "ARMATURE").object = rig
    root, tip = obj.vertex_groups.new(name="root"), obj.vertex_groups.new(name="tip")
    for vertex in obj.data.vertices:
        share = min(max((vertex.co.z - 1.0) / 2.0, 0.0), 1.0)
        root.add([vertex.index], 1.0 - share, "REPLACE")
        tip.add([vertex.index], share, "REPLACE")
    obj.modifiers.new("Subdivision", "SUBSURF").levels = levels
    bone = rig.pose.bones["tip"]
    bone.rotation_mode = "XYZ"
    for frame, angle, stretch in ((1, 0.0, 1.0), (FRAMES // 2, 1.2, 1.4), (FRAMES, 0.0, 1.0)):
        bone.rotation_euler, bone.scale = (angle, 0.0, 0.0), (1.0, stretch, 1.0)
        bone.keyframe_insert("rotation_euler", frame=frame)
        bone.keyframe_insert("scale", frame=frame)
    bpy.context.scene.frame_set(1)
    return active(obj)


def moving(obj: Any, *keys: tuple[int, tuple[float, float, float]]) -> Any:
    for frame, place in keys:
        obj.location = place
        obj.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(1)
    return obj


def threshold_group(height: float, step: float) -> Any:
    """A node group that stores "Above": 1 above a height that rises by so much a frame."""
    group = bpy.data.node_groups.new("Above", "GeometryNodeTree")
    for into in ("INPUT", "OUTPUT"):
        group.interface.new_socket("Geometry", in_out=into, socket_type="NodeSocketGeometry")
    nodes, link = group.nodes.new, group.links.new
    begin, end = nodes("NodeGroupInput"), nodes("NodeGroupOutput")
    time, place = nodes("GeometryNodeInputSceneTime"), nodes("GeometryNodeInputPosition")
    split, line, above = (
        nodes("ShaderNodeSeparateXYZ"),
        nodes("ShaderNodeMath"),
        nodes("ShaderNodeMath"),
    )
    store = nodes("GeometryNodeStoreNamedAttribute")
    line.operation, above.operation = "MULTIPLY_ADD", "GREATER_THAN"
    line.inputs[1].default_value, line.inputs[2].default_value = step, height
    store.inputs["Name"].default_value = "Above"
    link(time.outputs["Frame"], line.inputs[0])
    link(place.outputs[0], split.inputs[0])
    link(split.outputs["X"], above.inputs[0])
    link(line.outputs[0], above.inputs[1])
    link(begin.outputs[0], store.inputs["Geometry"])
    link(above.outputs[0], store.inputs["Value"])
    link(store.outputs[0], end.inputs[0])
    return group


def _rig() -> Any:
    rig = _linked(bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig")))
    active(rig)
    bpy.ops.object.mode_set(mode="EDIT")
    root = rig.data.edit_bones.new("root")
    root.head, root.tail = (0, 0, 0), (0, 0, 2)
    tip = rig.data.edit_bones.new("tip")
    tip.head, tip.tail, tip.parent = (0, 0, 2), (0, 0, 4), root
    bpy.ops.object.mode_set(mode="OBJECT")
    return rig


def _tube(sides: int = 12, rings: int = 9, length: float = 4.0) -> Any:
    turn = np.arange(sides) * 2.0 * math.pi / sides
    circle = np.column_stack([0.5 * np.cos(turn), 0.5 * np.sin(turn)])
    heights = np.linspace(0.0, length, rings)
    vertices = np.column_stack([np.tile(circle, (rings, 1)), np.repeat(heights, sides)])
    faces = [
        (
            r * sides + s,
            r * sides + (s + 1) % sides,
            (r + 1) * sides + (s + 1) % sides,
            (r + 1) * sides + s,
        )
        for r in range(rings - 1)
        for s in range(sides)
    ]
    caps = [tuple(reversed(range(sides))), tuple(range((rings - 1) * sides, rings * sides))]
    mesh = bpy.data.meshes.new("Body")
    mesh.from_pydata(vertices.tolist(), [], faces + caps)
    return _linked(bpy.data.objects.new("Body", mesh))


def _linked(obj: Any) -> Any:
    bpy.context.collection.objects.link(obj)
    return obj
