# SPDX-License-Identifier: GPL-3.0-or-later
"""Ordinary Blender objects and modifiers, as artists bring them, and how even each should come out.

Each function leaves its object active; the scene is empty before.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import cos, radians, sin
from typing import Any

import bpy
import numpy as np


@dataclass(frozen=True)
class Case:
    """An object with the figures wanted for it.

    variation: standard deviation over mean of the areas, at most.
    alpha_min: smallest spacing as a share of the hexagonal one, at least.
    evaluations: at most; 0 if nothing is asked.
    attribute: of the density, whose faces of 0 have to stay empty.
    """

    name: str
    make: Callable[[], None]
    variation: float = 0.02
    alpha_min: float = 0.55
    evaluations: int = 0
    points: int = 800
    attribute: str = ""


def _modified(make: Callable[[], None], kind: str, **values: Any) -> Callable[[], None]:
    def build() -> None:
        make()
        modifier = bpy.context.object.modifiers.new(kind.title(), kind)
        for name, value in values.items():
            setattr(modifier, name, value)

    return build


def _of_mesh(operator: str, **values: Any) -> Callable[[], None]:
    def build() -> None:
        getattr(bpy.ops.mesh, f"primitive_{operator}_add")(**values)

    return build


MONKEY = _of_mesh("monkey")
CUBE = _of_mesh("cube")


def _grid(side: int) -> Callable[[], None]:
    return _of_mesh("grid", x_subdivisions=side, y_subdivisions=side)


def _clouds() -> None:
    _grid(200)()
    texture = bpy.data.textures.new("Clouds", "CLOUDS")
    modifier = bpy.context.object.modifiers.new("Displace", "DISPLACE")
    modifier.texture, modifier.strength = texture, 2.0


def _text() -> None:
    bpy.ops.object.text_add()
    bpy.context.object.data.body = "Dapple"
    bpy.context.object.data.extrude = 0.1
    bpy.context.object.data.bevel_depth = 0.02


def _curve() -> None:
    bpy.ops.curve.primitive_bezier_circle_add()
    bpy.context.object.data.bevel_depth = 0.2


def _wires(paths: list[list[tuple[float, float, float]]], radius: float) -> None:
    """A curve with bevel."""
    curve = bpy.data.curves.new("Wires", "CURVE")
    curve.dimensions, curve.bevel_depth, curve.use_fill_caps = "3D", radius, True
    for path in paths:
        spline = curve.splines.new("POLY")
        spline.points.add(len(path) - 1)
        for point, place in zip(spline.points, path, strict=True):
            point.co = (*place, 1.0)
    _link(bpy.data.objects.new("Wires", curve))


def _fence() -> None:
    _wires([[(0.0, y / 10, 0.0), (2.0, y / 10, 0.0)] for y in range(20)], 0.002)


def _rope() -> None:
    turns = [radians(1080 * k / 199) for k in range(200)]
    _wires([[(cos(turn), sin(turn), turn / 12) for turn in turns]], 0.01)


def _ribbon() -> None:
    _of_mesh("plane", size=1.0)()
    bpy.context.object.scale = (4.0, 0.01, 1.0)


def _metaball() -> None:
    bpy.ops.object.metaball_add(type="BALL", radius=1.0)


def _leaves() -> None:
    """300 squares, turned and strewn at random."""
    random = np.random.default_rng(0)
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * 0.1
    turns, _ = np.linalg.qr(random.normal(size=(300, 3, 3)))
    vertices = np.einsum("nij,kj->nki", turns, corners) + random.uniform(-3, 3, (300, 1, 3))
    faces = np.arange(1200).reshape(-1, 4)
    _add_mesh("Leaves", vertices.reshape(-1, 3), faces)


def _room() -> None:
    """A cube of twelve triangles with three walls through its middle."""
    CUBE()
    cube = bpy.context.object
    for turn in ((0, 0, 0), (radians(90), 0, 0), (0, radians(90), 0)):
        bpy.ops.mesh.primitive_plane_add(rotation=turn)
        cube.select_set(True)
        bpy.context.view_layer.objects.active = cube
        bpy.ops.object.join()


def _soup() -> None:
    """A monkey of which every face has vertices of its own, as an STL file has."""
    _modified(MONKEY, "EDGE_SPLIT", split_angle=0.0)()


def _smooth(make: Callable[[], None]) -> Callable[[], None]:
    def build() -> None:
        make()
        bpy.ops.object.shade_smooth()

    return build


def _by_angle() -> None:
    _of_mesh("cylinder")()
    bpy.ops.object.shade_smooth_by_angle()


def _plate() -> None:
    """A square a hundred times as wide as thick."""
    bpy.ops.mesh.primitive_cube_add(scale=(1.0, 1.0, 0.01))


def _stairs() -> None:
    """Eight steps and the wall behind them, one closed body."""
    profile = [(0.0, 0.0)]
    for k in range(8):
        profile += [(0.5 * k, 0.3 * (k + 1)), (0.5 * (k + 1), 0.3 * (k + 1))]
    profile.append((4.0, 0.0))
    count = len(profile)
    vertices = [(x, y, z) for y in (0.0, 2.0) for x, z in profile]
    sides = [tuple(range(count)), tuple(reversed(range(count, 2 * count)))]
    around = [(k, k + count, (k + 1) % count + count, (k + 1) % count) for k in range(count)]
    _add_polygons("Stairs", vertices, [*sides, *around])


def _house() -> None:
    """Walls with a gable roof, one closed body."""
    gable = [(-1.0, 0.0), (1.0, 0.0), (1.0, 1.2), (0.0, 2.2), (-1.0, 1.2)]
    vertices = [(x, y, z) for y in (-1.5, 1.5) for x, z in gable]
    around = [(k + 5, k, (k + 1) % 5, (k + 1) % 5 + 5) for k in range(5)]
    _add_polygons("House", vertices, [(4, 3, 2, 1, 0), (5, 6, 7, 8, 9), *around])


def _palings() -> None:
    """Twenty upright cylinders, a hundred times as long as wide, of eight sides."""
    for k in range(20):
        bpy.ops.mesh.primitive_cylinder_add(
            vertices=8, radius=0.005, depth=1.0, location=(0.1 * k, 0.0, 0.5)
        )
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.object.join()


def _band() -> None:
    """A wavy band two hundred times as long as wide, without thickness."""
    along = np.linspace(0.0, 4.0, 201)
    edges = [np.column_stack([along, np.full(201, y), 0.2 * np.sin(3 * along)]) for y in (0, 0.02)]
    first = np.arange(200)
    faces = np.column_stack([first, first + 1, first + 202, first + 201])
    _add_mesh("Band", np.vstack(edges), faces)


def _doubled_cube() -> None:
    """A cube with each face twice, as two imports on each other leave it."""
    CUBE()
    mesh = bpy.context.object.data
    vertices = [tuple(v.co) for v in mesh.vertices]
    faces = [tuple(p.vertices) for p in mesh.polygons]
    bpy.data.objects.remove(bpy.context.object)
    moved = [tuple(v + 8 for v in face) for face in faces]
    _add_polygons("Doubled", vertices + vertices, faces + moved)


def _two_sided_ground() -> None:
    """A grid whose faces are there in both directions, of the same vertices."""
    _grid(30)()
    mesh = bpy.context.object.data
    vertices = [tuple(v.co) for v in mesh.vertices]
    faces = [tuple(p.vertices) for p in mesh.polygons]
    bpy.data.objects.remove(bpy.context.object)
    _add_polygons("Two Sides", vertices, faces + [face[::-1] for face in faces])


def _masked_cube() -> None:
    """1 on the top of a cube, 0 on all other faces."""
    CUBE()
    mesh = bpy.context.object.data
    values = [float(polygon.normal.z > 0.5) for polygon in mesh.polygons]
    mesh.attributes.new("Top", "FLOAT", "FACE").data.foreach_set("value", values)


def _add_polygons(name: str, vertices: list[Any], faces: list[Any]) -> None:
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    _link(bpy.data.objects.new(name, mesh))


def _link(obj: bpy.types.Object) -> None:
    bpy.context.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)


def _add_mesh(name: str, vertices: np.ndarray, faces: np.ndarray) -> None:
    _add_polygons(name, vertices.tolist(), faces.tolist())


CASES = (
    Case("plane", _of_mesh("plane")),
    Case("cube", CUBE),
    Case("cylinder", _of_mesh("cylinder")),
    Case("cone", _of_mesh("cone")),
    Case("sphere", _of_mesh("uv_sphere")),
    Case("torus", _of_mesh("torus")),
    Case("monkey", MONKEY),
    Case("monkey, array", _modified(MONKEY, "ARRAY", count=3)),
    Case("cube, bevel", _modified(CUBE, "BEVEL", width=0.2)),
    Case("monkey, remesh", _modified(MONKEY, "REMESH", mode="VOXEL", voxel_size=0.08)),
    Case("monkey, decimate", _modified(MONKEY, "DECIMATE", ratio=0.3)),
    Case("curve with bevel", _curve),
    Case("monkey, mirror over itself", _modified(MONKEY, "MIRROR"), 0.02, 0.6),
    Case("monkey, edge split", _modified(MONKEY, "EDGE_SPLIT"), 0.018, 0.58, 25),
    Case("monkey, soup", _soup, 0.018, 0.58, 25),
    Case("monkey, wireframe", _modified(MONKEY, "WIREFRAME"), 0.05, 0.4),
    Case("monkey, solidify 0.02", _modified(MONKEY, "SOLIDIFY", thickness=0.02), 0.015, 0.55, 20),
    Case("plane, screw", _modified(_of_mesh("plane"), "SCREW"), 0.015, 0.55),
    Case(
        "grid 30, solidify 0.005",
        _modified(_grid(30), "SOLIDIFY", thickness=0.005),
        *(0.01, 0.6, 20, 5000),
    ),
    Case("grid 200, displace by clouds", _clouds, 0.02, 0.4),
    Case("text with bevel", _text, 0.015, 0.55, 20),
    Case("300 leaves", _leaves, 0.2, 0.5),
    Case("fence of 20 wires", _fence, 0.01, 0.0, 40, 200),
    Case("rope", _rope, 0.01, 0.0, 40, 100),
    Case("ribbon", _ribbon, 0.01, 0.0, 40, 60),
    Case("metaball", _metaball),
    Case("room", _room, points=2000),
    Case("monkey, smooth", _smooth(MONKEY)),
    Case("cylinder, smooth by angle", _by_angle),
    Case("stairs", _stairs, 0.015, 0.55, 20),
    Case("house", _house, 0.015, 0.55, 20),
    Case("fence of cylinders", _palings, 0.01, 0.0, 40, 200),
    Case("wavy band", _band, 0.01, 0.0, 40, 300),
    Case("plate thinner than the spacing", _plate, 0.01, 0.0, 40, 300),
    Case("cube, each face twice", _doubled_cube),
    Case("ground, both sides", _two_sided_ground, 0.015, 0.6),
    Case("cube, one face by attribute", _masked_cube, 0.015, 0.6, 20, 300, "Top"),
)
