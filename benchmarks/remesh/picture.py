# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes before and after remeshing, side by side, rendered by Blender: docs/images/remesh.webp.

build/venv/bin/python benchmarks/remesh/picture.py OUT.webp fandisk.ply 1500 30 bunny.ply 3000 0

With `--adaptive fandisk.ply 800 30 bunny.ply 1500 0` after OUT.webp, an even remesh and an adaptive
one: docs/images/remesh_adaptive.webp. With `--sequence 0 5 10` instead, these frames of metaballs,
where triangles that stay from the first to the second and so on are blue:
docs/images/remesh_sequence.webp.
"""

import math
import sys
from pathlib import Path
from typing import Any

import bpy
import dapple3d as dapple
import numpy as np
from numpy.typing import NDArray

SIZE = (1600, 440)
SAMPLES = 64
STEP = 1.15  # from one body to the next; each fits into a cube of 1
LINES = 0.0016  # width of edges


def material(name: str, color: tuple[float, float, float]) -> bpy.types.Material:
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    shader = made.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*color, 1.0)
    shader.inputs["Roughness"].default_value = 0.9
    return made


def upright(vertices: NDArray[np.float64], yaw: float) -> NDArray[np.float64]:
    """Turned so that its y axis points up, around the origin, within a cube of 1."""
    x, y, z = vertices.T
    turned = np.stack(
        [math.cos(yaw) * x + math.sin(yaw) * z, math.sin(yaw) * x - math.cos(yaw) * z, y], axis=1
    )
    low, high = turned.min(axis=0), turned.max(axis=0)
    scaled: NDArray[np.float64] = (turned - 0.5 * (low + high)) / (high - low)[[0, 2]].max()
    return scaled


def add(
    name: str,
    vertices: NDArray[np.float64],
    faces: NDArray[np.int32],
    at: float,
    marked: NDArray[np.bool_] | None = None,
) -> None:
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(np.add(vertices, (at, 0.0, 0.0)).tolist(), [], faces.tolist())
    mesh.materials.append(material("Body", (0.7, 0.7, 0.7)))
    if marked is not None:
        mesh.materials.append(material("Marked", (0.25, 0.45, 0.75)))
        mesh.polygons.foreach_set("material_index", marked.astype(np.int32))
    body = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(body)
    add_lines(body)


def add_lines(body: bpy.types.Object) -> None:
    """Draw the edges of an object."""
    body.data.materials.append(material("Lines", (0.02, 0.02, 0.02)))
    lines = body.modifiers.new("Lines", "WIREFRAME")
    lines.thickness = LINES
    lines.use_replace = False
    lines.use_even_offset = False
    lines.material_offset = len(body.data.materials) - 1


def set_scene(bodies: int) -> None:
    scene = bpy.context.scene
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", STEP * bodies
    camera.location = (0.5 * STEP * (bodies - 1), -4.0, 1.0)
    camera.rotation_euler = (math.atan2(4.0, 1.0), 0.0, 0.0)
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.rotation_euler = 3.0, (math.radians(50), 0.0, math.radians(-35))
    for added in (camera, sun):
        scene.collection.objects.link(added)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (0.8, 0.8, 0.8, 1.0)
    scene.render.engine = "CYCLES"
    scene.view_settings.view_transform = "Standard"


def render(out: str, width: int, height: int, samples: int) -> None:
    """Write the scene as WebP."""
    scene = bpy.context.scene
    scene.cycles.samples = samples
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.image_settings.file_format, scene.render.filepath = "WEBP", out
    bpy.ops.render.render(write_still=True)


def triangles_of(frame: dapple.SequenceMesh) -> list[tuple[int, ...]]:
    """Its triangles by the ids of their vertices, the lowest first."""
    rows = frame.ids[np.asarray(frame.mesh.faces)]
    return [tuple(np.roll(row, -int(row.argmin())).tolist()) for row in rows]


def splash(frame: int) -> dapple.Surface:
    """A row of balls that have flowed together, and a drop that falls into it."""
    data = bpy.data.metaballs.new("Splash")
    data.resolution, data.threshold = 0.07, 0.4
    for x, height, radius in [(0.8 * k, 0.0, 1.0) for k in range(4)] + [(0.6, 2.4, 0.8)]:
        ball = data.elements.new()
        ball.co, ball.radius = (x, 0.0, height - 0.2 * frame * (height > 0)), radius
    body = bpy.data.objects.new("Splash", data)
    bpy.context.scene.collection.objects.link(body)
    graph = bpy.context.evaluated_depsgraph_get()
    mesh = body.evaluated_get(graph).to_mesh()
    mesh.calc_loop_triangles()
    vertices, faces = np.empty(3 * len(mesh.vertices)), np.empty(3 * len(mesh.loop_triangles), int)
    mesh.vertices.foreach_get("co", vertices)
    mesh.loop_triangles.foreach_get("vertices", faces)
    bpy.data.objects.remove(body)
    return dapple.Surface(vertices.reshape(-1, 3), faces.reshape(-1, 3))


def draw_sequence(out: str, frames: list[int]) -> None:
    """Some frames of the splash, remeshed one after another."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    sequence = dapple.MeshSequence(splash(0), 900)
    shown: dict[int, dapple.SequenceMesh] = {0: sequence.first}
    for frame in range(1, max(frames) + 1):
        found = sequence.advance(splash(frame))
        assert found is not None
        shown[frame] = found
    before: set[tuple[int, ...]] = set()
    for place, frame in enumerate(frames):
        triangles = triangles_of(shown[frame])
        stay = np.array([one in before for one in triangles])
        before = set(triangles)
        places = (np.asarray(shown[frame].mesh.vertices) - (1.2, 0.0, 0.9)) / 4.2
        add(f"Frame {frame}", places, np.asarray(shown[frame].mesh.faces), STEP * place, stay)
    set_scene(len(frames))
    render(out, *SIZE, SAMPLES)


def main(out: str, *meshes: str) -> None:
    """
    Args:
        out: the picture, as WebP.
        meshes: a file, a number of vertices and the angle of a turn, once for each mesh.
    """
    if meshes[0] == "--sequence":
        draw_sequence(out, [int(frame) for frame in meshes[1:]])
        return
    bpy.ops.wm.read_factory_settings(use_empty=True)
    adaptive = meshes[0] == "--adaptive"
    meshes = meshes[adaptive:]
    for k in range(0, len(meshes), 3):
        path, count, yaw = Path(meshes[k]), int(meshes[k + 1]), math.radians(float(meshes[k + 2]))
        old: Any = dapple.read_mesh(path)
        surface = dapple.Surface(old.vertices, old.faces)
        new = dapple.remesh(surface, count, adaptive=adaptive)
        if adaptive:
            old = dapple.remesh(surface, count)
        # One scale for both.
        both = upright(np.concatenate([old.vertices, new.vertices]), yaw)
        first = len(old.vertices)
        place = STEP * 2 * (k // 3)
        add(path.stem, both[:first], old.faces, place)
        add(f"{path.stem} remeshed", both[first:], new.faces, place + STEP)
    set_scene(2 * len(meshes) // 3)
    render(out, *SIZE, SAMPLES)


if __name__ == "__main__":
    main(*sys.argv[1:])
