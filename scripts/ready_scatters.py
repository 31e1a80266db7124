# SPDX-License-Identifier: GPL-3.0-or-later
"""Scatters that ship as assets: what they instance, how, and what an asset browser says of them.

They fit what they instance to the spacing of the points, so that they suit surfaces of any size.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import bpy

from addon.blender.assets.marking import CATALOG, TAGS, collect_instances, empty_mesh
from addon.blender.scatter.modifier import ensure_modifier, write_instance_inputs
from addon.nodes.assets import AUTHOR, LICENSE
from scripts import ready_shapes as shapes
from scripts.ready_shapes import Shape

PREVIEWS = Path(__file__).parent / "previews"
Color = tuple[float, float, float]


@dataclass(frozen=True)
class Look:
    """A material: colors between which each instance has one, and how it shines."""

    name: str
    colors: tuple[Color, Color]
    roughness: float = 0.8
    metallic: float = 0.0


@dataclass(frozen=True)
class Kind:
    """An object type, or all that a scatter has: its shapes, by chance, and its settings."""

    name: str
    shapes: Sequence[Callable[[], Shape]]
    looks: tuple[Look, ...]
    values: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Ready:
    """A scatter."""

    name: str
    description: str
    tags: tuple[str, ...]
    kinds: tuple[Kind, ...]
    values: dict[str, Any]

    @property
    def preview(self) -> Path:
        """Its picture, made by blend_examples/ready.py."""
        return PREVIEWS / f"{self.name.lower().replace(' ', '_')}.png"


_GRASS = Look("Grass", ((0.06, 0.20, 0.015), (0.22, 0.42, 0.05)), 0.7)
_DRY = Look("Dry Grass", ((0.20, 0.26, 0.05), (0.34, 0.34, 0.10)), 0.75)
_PETAL = Look("Petals", ((0.85, 0.75, 0.88), (0.95, 0.90, 0.85)), 0.6)
_MIDDLE = Look("Flower Middle", ((0.90, 0.50, 0.03), (0.95, 0.62, 0.05)), 0.8)
_STONE = Look("Pebble", ((0.16, 0.15, 0.14), (0.50, 0.44, 0.37)), 0.55)
_SCALE = Look("Scale", ((0.012, 0.10, 0.075), (0.06, 0.27, 0.13)), 0.28)
_STEEL = Look("Stud", ((0.80, 0.70, 0.50), (0.86, 0.76, 0.58)), 0.22, 1.0)
_WASHER = Look("Washer", ((0.24, 0.22, 0.21), (0.30, 0.28, 0.26)), 0.4, 1.0)
_NEEDLES = Look("Needles", ((0.012, 0.07, 0.035), (0.06, 0.17, 0.05)), 0.8)
_BARK = Look("Bark", ((0.09, 0.05, 0.025), (0.12, 0.07, 0.04)), 0.9)
_RED = Look("Red Cap", ((0.55, 0.02, 0.01), (0.75, 0.07, 0.015)), 0.35)
_BROWN = Look("Brown Cap", ((0.30, 0.14, 0.05), (0.46, 0.25, 0.10)), 0.5)
_STEM = Look("Stem", ((0.72, 0.66, 0.54), (0.82, 0.77, 0.67)), 0.8)
_DOTS = Look("Dots", ((0.88, 0.85, 0.78), (0.92, 0.90, 0.85)), 0.8)

_UPRIGHT = {"align_to_normal": 0.35, "random_tilt": 0.12}

READY = (
    Ready(
        "Grass Meadow",
        "Three kinds of tufts: much grass, some dry blades, few flowers",
        ("grass", "meadow", "plants"),
        (
            Kind(
                "Grass",
                (partial(shapes.tuft, 1, 16, 1.2), partial(shapes.tuft, 2, 13, 1.5)),
                (_GRASS,),
                {"weight": 1.0, "scale": 1.7, **_UPRIGHT},
            ),
            Kind(
                "Dry Grass",
                (partial(shapes.tuft, 5, 11, 2.0),),
                (_DRY,),
                {"weight": 0.25, "scale": 0.95, **_UPRIGHT},
            ),
            Kind(
                "Flowers",
                (partial(shapes.flower, 3, 3), partial(shapes.flower, 4, 2)),
                (_GRASS, _PETAL, _MIDDLE),
                {"weight": 0.12, "scale": 0.7, **_UPRIGHT},
            ),
        ),
        {"count": 900},
    ),
    Ready(
        "Pebbles",
        "Smooth stones of all grays, close together",
        ("stones", "ground"),
        (
            Kind(
                "Pebbles",
                tuple(
                    partial(shapes.pebble, seed, flat)
                    for seed, flat in ((1, 0.55), (2, 0.7), (3, 0.45), (4, 0.6))
                ),
                (_STONE,),
                {"scale": 1.3, "random_tilt": 0.15},
            ),
        ),
        {"count": 600},
    ),
    Ready(
        "Reptile Scales",
        "Scales that overlap along the Forward Axis: from head to tail of what looks along -Y",
        ("scales", "skin", "creature"),
        (
            Kind(
                "Scale",
                (shapes.plate,),
                (_SCALE,),
                {"scale": 1.85, "random_turn": 0.0, "random_scale_down": 0.05},
            ),
        ),
        {"count": 700, "forward": "Y"},
    ),
    Ready(
        "Studs",
        "Brass domes on washers, all of the same size where the surface is even",
        ("rivets", "studs", "metal"),
        (
            Kind(
                "Stud", (shapes.stud,), (_STEEL, _WASHER), {"scale": 0.8, "random_scale_down": 0.0}
            ),
        ),
        {"count": 350},
    ),
    Ready(
        "Conifer Forest",
        "Upright conifers of three sizes",
        ("trees", "forest", "plants"),
        (
            Kind(
                "Conifers",
                tuple(
                    partial(shapes.conifer, seed, tall, whorls)
                    for seed, tall, whorls in ((1, 4.4, 7), (2, 3.6, 6), (3, 5.2, 8))
                ),
                (_NEEDLES, _BARK),
                {
                    "scale": 1.4,
                    "align_to_normal": 0.0,
                    "random_tilt": 0.04,
                    "random_scale_down": 0.35,
                },
            ),
        ),
        {"count": 250},
    ),
    Ready(
        "Mushrooms",
        "Red caps with white dots, and small brown ones in groups",
        ("mushrooms", "plants", "forest"),
        (
            Kind(
                "Red Mushrooms",
                (
                    partial(shapes.mushroom, 1, [(0.0, 0.0, 1.0, 1.3)], 14),
                    partial(
                        shapes.mushroom, 2, [(0.1, 0.0, 0.85, 1.7), (-0.75, 0.3, 0.4, 0.7)], 11
                    ),
                ),
                (_RED, _STEM, _DOTS),
                {"weight": 1.0, "scale": 0.95, "align_to_normal": 0.5, "random_tilt": 0.2},
            ),
            Kind(
                "Brown Mushrooms",
                (
                    partial(
                        shapes.mushroom,
                        3,
                        [(0.0, 0.2, 0.45, 1.2), (0.5, -0.3, 0.35, 0.8), (-0.5, -0.3, 0.4, 1.0)],
                        0,
                    ),
                ),
                (_BROWN, _STEM),
                {"weight": 1.0, "scale": 0.8, "align_to_normal": 0.5, "random_tilt": 0.2},
            ),
        ),
        {"count": 200},
    ),
)


def build(ready: Ready) -> bpy.types.Object:
    """The asset in the open file."""
    obj = bpy.data.objects.new(ready.name, empty_mesh(ready.name))
    several = len(ready.kinds) > 1
    for kind in ready.kinds:
        owner = obj.dapple.object_types.add() if several else obj.dapple
        if several:
            owner.name = kind.name
        _instance(owner, kind)
        for name, value in {"fit_to_spacing": 1.0, "random_scale_down": 0.3, **kind.values}.items():
            setattr(owner, name, value)
    for name, value in ready.values.items():
        setattr(obj.dapple, name, value)
    ensure_modifier(obj)
    write_instance_inputs(obj)
    collect_instances(obj)
    _mark(obj, ready)
    return obj


def _instance(owner: bpy.types.PropertyGroup, kind: Kind) -> None:
    looks = [_material(look) for look in kind.looks]
    made = [_object(kind.name, shape(), looks) for shape in kind.shapes]
    if len(made) == 1:
        owner.instance = made[0]
        return
    owner.collection = bpy.data.collections.new(kind.name)
    for one in made:
        owner.collection.objects.link(one)


def _object(name: str, shape: Shape, looks: list[bpy.types.Material]) -> bpy.types.Object:
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(shape.vertices, [], shape.faces)
    mesh.polygons.foreach_set("material_index", shape.materials)
    mesh.shade_smooth()
    for look in looks:
        mesh.materials.append(look)
    return bpy.data.objects.new(name, mesh)


def _material(look: Look) -> bpy.types.Material:
    """A color between two for each instance."""
    found = bpy.data.materials.get(look.name)
    if found is not None:
        return found
    made = bpy.data.materials.new(look.name)
    if bpy.app.version < (5, 0):
        made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    chance, ramp = nodes.new("ShaderNodeObjectInfo"), nodes.new("ShaderNodeValToRGB")
    shader = nodes["Principled BSDF"]
    for element, color in zip(ramp.color_ramp.elements, look.colors, strict=True):
        element.color = (*color, 1.0)
    links.new(chance.outputs["Random"], ramp.inputs["Fac"])
    links.new(ramp.outputs["Color"], shader.inputs["Base Color"])
    shader.inputs["Roughness"].default_value = look.roughness
    shader.inputs["Metallic"].default_value = look.metallic
    chance.location, ramp.location = (-600.0, 200.0), (-350.0, 200.0)
    made.diffuse_color = (*look.colors[1], 1.0)
    made.roughness, made.metallic = look.roughness, look.metallic
    return made


def _mark(obj: bpy.types.Object, ready: Ready) -> None:
    obj.asset_mark()
    said = obj.asset_data
    said.description, said.author, said.license = ready.description, AUTHOR, LICENSE
    said.catalog_id = CATALOG
    for tag in (*TAGS, *ready.tags):
        said.tags.new(tag, skip_if_exists=True)
    if ready.preview.is_file():
        _show(obj, ready.preview)


def _show(obj: bpy.types.Object, picture: Path) -> None:
    """Give an asset its picture."""
    image = bpy.data.images.load(str(picture))
    preview = obj.preview_ensure()
    preview.image_size = image.size
    preview.image_pixels_float[:] = image.pixels[:]
    bpy.data.images.remove(image)
