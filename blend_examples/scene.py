# SPDX-License-Identifier: GPL-3.0-or-later
"""What the still examples share: options, the add-on, a studio, saving, and a dump of the scene."""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import bpy
import dapple3d as dapple
import numpy as np
from numpy.typing import NDArray

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

import addon  # noqa: E402  (the add-on as it lies in the repository)
from blend_examples.studio import add_floor, add_light, aim, set_render, use_nodes  # noqa: E402

Vector = Sequence[float]
HAZE, SKY = (0.60, 0.67, 0.74), (0.26, 0.44, 0.72)


def options(text: str, count: int, of: str) -> argparse.ArgumentParser:
    """The options that every example takes."""
    parser = argparse.ArgumentParser(description=text.splitlines()[0])
    parser.add_argument("--count", type=int, default=count, help=of)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--width", type=int, default=720, help="of the picture; 0: none is made")
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "examples")
    return parser


def begin() -> None:
    """An empty file."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.preferences.filepaths.save_version = 0  # no second file beside the first


def run(make: Callable[[], None]) -> None:
    """Make an example with the add-on."""
    addon.register()
    try:
        make()
    finally:
        addon.unregister()  # a class that is still registered at exit can hang Blender


def mesh_object(name: str, vertices: Any, faces: Any, smooth: bool = True) -> bpy.types.Object:
    """A mesh of plain arrays, in the scene."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(np.asarray(vertices).tolist(), [], [list(map(int, face)) for face in faces])
    if smooth:
        mesh.shade_smooth()
    made = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(made)
    return made


def hidden(thing: bpy.types.Object) -> bpy.types.Object:
    """Of this object only the instances are to be seen."""
    thing.hide_render = thing.hide_viewport = True
    return thing


def grid(
    name: str, size: float, cells: int, around: float = 0.0
) -> tuple[bpy.types.Object, NDArray[np.float64]]:
    """A flat square around the origin, and its vertices (v, 3).

    around: so far beyond the square it goes on, in ever larger cells.
    """
    line = np.linspace(-size / 2, size / 2, cells + 1)
    if around:
        beyond = size / 2 + around * np.linspace(0.0, 1.0, 15)[1:] ** 2
        line = np.concatenate([-beyond[::-1], line, beyond])
        cells = len(line) - 1
    x, y = np.meshgrid(line, line)
    vertices = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    low = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    faces = np.column_stack([low, low + 1, low + cells + 2, low + cells + 1])
    return mesh_object(name, vertices, faces), vertices


def move_vertices(thing: bpy.types.Object, vertices: NDArray[np.float64]) -> None:
    thing.data.vertices.foreach_set("co", vertices.astype(np.float32).ravel())
    thing.data.update()


def surface_of(mesh: bpy.types.Mesh) -> dapple.Surface:
    """The loop triangles of a mesh as they stand."""
    mesh.calc_loop_triangles()
    vertices = np.empty(3 * len(mesh.vertices), np.float32)
    faces = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.vertices.foreach_get("co", vertices)
    mesh.loop_triangles.foreach_get("vertices", faces)
    return dapple.Surface(vertices.reshape(-1, 3), faces.reshape(-1, 3))


def paint(thing: bpy.types.Object, name: str, values: NDArray[np.float64]) -> None:
    """A float attribute on the vertices."""
    attribute = thing.data.attributes.new(name, "FLOAT", "POINT")
    attribute.data.foreach_set("value", values.astype(np.float32))


def scatter(
    surface: bpy.types.Object, count: int, seed: int, *others: bpy.types.Object
) -> bpy.types.Object:
    """A scatter of the add-on over the surface, or over it and others as one."""
    bpy.ops.object.select_all(action="DESELECT")
    for one in (surface, *others):
        one.select_set(True)
    bpy.context.view_layer.objects.active = surface
    bpy.ops.dapple.add_scatter(count=count, seed=seed)
    return bpy.context.object


def add_class(made: bpy.types.Object, name: str, **values: Any) -> None:
    """One more class of a scatter."""
    bpy.ops.dapple.edit_object_types(action="ADD")
    kind = made.dapple.object_types[-1]
    kind.name = name
    for key, value in values.items():
        setattr(kind, key, value)


def build_studio(
    width: int, height: int, place: Vector, target: Vector, lens: float, floor: bool = True
) -> None:
    """Floor, light and a camera at the place."""
    scene = bpy.context.scene
    if floor:
        add_floor()
    add_light("Key", (3.5, -4.5, 6.0), 1.4, 420, (1.0, 0.95, 0.88))
    add_light("Fill", (-6.0, -4.0, 3.0), 5.0, 130, (0.80, 0.90, 1.0))
    world = bpy.data.worlds.new("World")
    use_nodes(world)
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.75, 0.72, 0.70, 1)
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.35
    scene.world = world
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.lens = lens
    scene.collection.objects.link(camera)
    aim(camera, place, target)
    scene.camera = camera
    set_render(scene, max(width, 1), max(height, 1))
    scene.cycles.samples = 32


def build_outdoors(width: int, height: int, place: Vector, target: Vector, lens: float) -> None:
    """A low sun, a sky that is bright at the horizon, and a camera at the place."""
    scene = bpy.context.scene
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.data.angle, sun.data.color = 5.5, 0.03, (1.0, 0.84, 0.62)
    scene.collection.objects.link(sun)
    aim(sun, (-6.0, 1.5, 4.2), (0.0, 0.0, 0.0))
    scene.world = sky()
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.lens = lens
    scene.collection.objects.link(camera)
    aim(camera, place, target)
    scene.camera = camera
    set_render(scene, max(width, 1), max(height, 1))
    scene.cycles.samples = 16


def sky() -> bpy.types.World:
    """Haze at the horizon, blue above it."""
    world = bpy.data.worlds.new("Sky")
    use_nodes(world)
    nodes, links = world.node_tree.nodes, world.node_tree.links
    up = nodes.new("ShaderNodeSeparateXYZ")
    ramp = nodes.new("ShaderNodeValToRGB")
    for element, at, color in zip(ramp.color_ramp.elements, (0.0, 0.35), (HAZE, SKY), strict=True):
        element.position, element.color = at, (*color, 1)
    links.new(nodes.new("ShaderNodeTexCoord").outputs["Generated"], up.inputs[0])
    links.new(up.outputs["Z"], ramp.inputs["Fac"])
    links.new(ramp.outputs["Color"], nodes["Background"].inputs["Color"])
    return world


def fade_into_haze(
    made: bpy.types.Material, start: float, end: float, haze: Vector = HAZE
) -> bpy.types.Material:
    """Between these distances from the camera a material becomes the haze at the horizon, so that
    no edge shows.
    """
    nodes, links = made.node_tree.nodes, made.node_tree.links
    share, mixed = nodes.new("ShaderNodeMapRange"), nodes.new("ShaderNodeMixShader")
    far, out = nodes.new("ShaderNodeEmission"), nodes["Material Output"].inputs["Surface"]
    share.interpolation_type = "SMOOTHERSTEP"
    share.inputs["From Min"].default_value, share.inputs["From Max"].default_value = start, end
    far.inputs["Color"].default_value = (*haze, 1)
    links.new(nodes.new("ShaderNodeCameraData").outputs["View Distance"], share.inputs["Value"])
    links.new(share.outputs["Result"], mixed.inputs["Fac"])
    links.new(out.links[0].from_socket, mixed.inputs[1])
    links.new(far.outputs["Emission"], mixed.inputs[2])
    links.new(mixed.outputs["Shader"], out)
    return made


def dump() -> dict[str, Any]:
    """What the depsgraph shows: instances by the name of their mesh, and their box."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    shown = [  # read at once: an instance is gone when the next one comes
        (one.object.data.name, tuple(one.matrix_world.translation))
        for one in depsgraph.object_instances
        if one.is_instance and one.object.data
    ]
    names = Counter(name for name, _ in shown)
    places = np.array([place for _, place in shown]).reshape(-1, 3)
    box = [places.min(axis=0), places.max(axis=0)] if len(places) else []
    polygons = sum(len(o.data.polygons) for o in bpy.context.scene.objects if o.type == "MESH")
    return {
        "instances": dict(sorted(names.items())),
        "box": [[round(float(x), 3) for x in row] for row in box],
        "polygons": polygons,
    }


def finish(name: str, given: argparse.Namespace, said: str) -> None:
    """The picture, the .blend and the dump; then one line of figures."""
    given.out.mkdir(parents=True, exist_ok=True)
    scene = bpy.context.scene
    if given.width:
        scene.render.filepath = str(given.out / f"{name}.png")
        bpy.ops.render.render(write_still=True)
    (given.out / f"{name}.json").write_text(json.dumps(dump(), indent=1) + "\n")
    bpy.ops.wm.save_as_mainfile(filepath=str(given.out / f"{name}.blend"), compress=True)
    print(f"{given.out}: {said}")
