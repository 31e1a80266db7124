# SPDX-License-Identifier: GPL-3.0-or-later
"""Small scenes for tests, and their evaluated data."""

import math

import bpy
import numpy as np


def sphere(scale=(1.0, 1.0, 1.0), location=(0.0, 0.0, 0.0), rotation=(0.0, 0.0, 0.0)):
    """Active UV sphere object."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=12, location=location)
    obj = bpy.context.object
    obj.scale, obj.rotation_euler = scale, rotation
    bpy.context.view_layer.update()
    return obj


def tail(levels=1, render_levels=1, frames=6):
    """Active tube, skinned to two bones that bend and stretch it, then subdivided."""
    rig = _rig()
    obj = _tube()
    obj.modifiers.new("Armature", "ARMATURE").object = rig
    weigh(obj)
    subdivision = obj.modifiers.new("Subdivision", "SUBSURF")
    subdivision.levels, subdivision.render_levels = levels, render_levels
    _animate(rig.pose.bones["tip"], frames)
    bpy.context.scene.frame_end = frames
    bpy.context.scene.frame_set(1)
    activate(obj)
    return obj


def _tube(sides=12, rings=9, length=4.0):
    turn = np.arange(sides) * 2.0 * math.pi / sides
    circle = np.column_stack([0.5 * np.cos(turn), 0.5 * np.sin(turn)])
    heights = np.linspace(0.0, length, rings)
    vertices = np.column_stack([np.tile(circle, (rings, 1)), np.repeat(heights, sides)])
    faces = [
        (r * sides + s, r * sides + t, (r + 1) * sides + t, (r + 1) * sides + s)
        for r in range(rings - 1)
        for s, t in zip(range(sides), [*range(1, sides), 0], strict=True)
    ]
    caps = [tuple(reversed(range(sides))), tuple(range((rings - 1) * sides, rings * sides))]
    mesh = bpy.data.meshes.new("Tail")
    mesh.from_pydata(vertices.tolist(), [], faces + caps)
    return _link(bpy.data.objects.new("Tail", mesh))


def _rig():
    rig = _link(bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig")))
    activate(rig)
    bpy.ops.object.mode_set(mode="EDIT")
    root = rig.data.edit_bones.new("root")
    root.head, root.tail = (0, 0, 0), (0, 0, 2)
    tip = rig.data.edit_bones.new("tip")
    tip.head, tip.tail, tip.parent = (0, 0, 2), (0, 0, 4), root
    bpy.ops.object.mode_set(mode="OBJECT")
    return rig


def weigh(obj):
    root, tip = obj.vertex_groups.new(name="root"), obj.vertex_groups.new(name="tip")
    for vertex in obj.data.vertices:
        share = min(max((vertex.co.z - 1.0) / 2.0, 0.0), 1.0)
        root.add([vertex.index], 1.0 - share, "REPLACE")
        tip.add([vertex.index], share, "REPLACE")


def _animate(bone, frames):
    bone.rotation_mode = "XYZ"
    for frame, angle, stretch in ((1, 0.0, 1.0), (frames, 1.2, 1.5)):
        bone.rotation_euler, bone.scale = (angle, 0.0, 0.0), (1.0, stretch, 1.0)
        bone.keyframe_insert("rotation_euler", frame=frame)
        bone.keyframe_insert("scale", frame=frame)


def _link(obj):
    bpy.context.collection.objects.link(obj)
    return obj


def collection_of(*objects):
    """A new collection in the scene."""
    made = bpy.data.collections.new("Things")
    bpy.context.scene.collection.children.link(made)
    for obj in objects:
        made.objects.link(obj)
    return made


def activate(obj):
    for other in bpy.context.selected_objects:
        other.select_set(False)
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj


def scattered(surface, count=60):
    """Scatter object on a surface, made by its operator."""
    activate(surface)
    assert bpy.ops.dapple.add_scatter(count=count) == {"FINISHED"}
    return bpy.context.object


def instance_matrices(obj, depsgraph=None):
    """World matrices (n, 4, 4) of an object's instances, in the order of its points."""
    depsgraph = depsgraph or bpy.context.evaluated_depsgraph_get()
    matrices = [
        np.array(instance.matrix_world, dtype=np.float64)
        for instance in depsgraph.object_instances
        if instance.is_instance and instance.parent.original == obj
    ]
    return np.array(matrices).reshape(-1, 4, 4)


def positions(obj, depsgraph=None):
    """World positions (n, 3) of an object's instances."""
    return instance_matrices(obj, depsgraph)[:, :3, 3]


def rotations(obj):
    """Rotation matrices (n, 3, 3) of an object's instances, without scale."""
    linear = instance_matrices(obj)[:, :3, :3]
    return linear / np.linalg.norm(linear, axis=1, keepdims=True)


def world_vertices(surface):
    """Evaluated vertices (v, 3) in world space."""
    evaluated = surface.evaluated_get(bpy.context.evaluated_depsgraph_get())
    local = np.empty(3 * len(evaluated.data.vertices), dtype=np.float32)
    evaluated.data.vertices.foreach_get("co", local)
    matrix = np.array(evaluated.matrix_world, dtype=np.float64)
    return local.reshape(-1, 3).astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]


def shown(obj):
    """Vertices and triangles in world space, as they are shown now."""
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    mesh.calc_loop_triangles()
    faces = np.array([triangle.vertices[:] for triangle in mesh.loop_triangles])
    places = np.array([(evaluated.matrix_world @ vertex.co)[:] for vertex in mesh.vertices])
    evaluated.to_mesh_clear()
    return places, faces


def size(vertices):
    """Diagonal of the bounding box."""
    return float(np.linalg.norm(np.ptp(vertices, axis=0)))


def node_warnings(obj):
    """Warnings that the node group shows now."""
    bpy.context.evaluated_depsgraph_get()
    return [warning.message for warning in obj.modifiers[0].node_warnings]


def snapshot():
    """The state that a failing operator must not change."""
    return {
        "frame": (bpy.context.scene.frame_current, bpy.context.scene.frame_subframe),
        "active": bpy.context.object,
        "selected": list(bpy.context.selected_objects),
        **{
            name: sorted(item.name for item in getattr(bpy.data, name))
            for name in ("objects", "meshes", "node_groups", "scenes", "images", "collections")
        },
        "modifiers": {
            (obj.name, modifier.name): {
                prop.identifier: getattr(modifier, prop.identifier)
                for prop in modifier.bl_rna.properties
                if prop.type in {"BOOLEAN", "INT", "ENUM"} and prop.identifier != "is_active"
            }
            for obj in bpy.data.objects
            for modifier in obj.modifiers
            if modifier.type != "NODES"
        },
        "points": {
            mesh.name: repr([tuple(vertex.co) for vertex in mesh.vertices])
            for mesh in bpy.data.meshes
        },
    }


def curves(owner):
    """Animation curves of a datablock, in Blender's older and newer layered actions."""
    action = owner.animation_data.action
    if hasattr(action, "fcurves"):
        return list(action.fcurves)
    bags = (strip.channelbags for layer in action.layers for strip in layer.strips)
    return [curve for group in bags for bag in group for curve in bag.fcurves]
