# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames of one scene with and without its scatters, in turns."""

from __future__ import annotations

import importlib
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import bpy
import numpy as np
from mathutils import Vector

from addon import nodes
from addon.blender.surface.mesh import read_mesh
from addon.nodes.builder import Builder, Socket, new_group
from benchmarks.bake.made_up import add_bake, add_scatter

OWN = ("bound", "baked", "baked, between keys")  # cases that play back a scatter
# Cases of the first one with other settings; a tenth is about what a landscape keeps.
DISPLAYED: dict[str, dict[str, Any]] = {
    "bound, as bounds": {"display_as": "BOUNDS"},
    "bound, as points": {"display_as": "POINTS"},
    "bound, all near the camera": {"detail_in_viewport": True, "detail_full_until": 100.0},
    "bound, most far": {
        "detail_in_viewport": True,
        "detail_full_until": 1.0,
        "detail_minimum": 0.1,
    },
}
_FRAMES = range(2, 10)
_AREA = 4.0 * np.pi * 1.1**2  # of the sphere, half swollen


@dataclass(frozen=True)
class Taken:
    """Median seconds of a frame: on the clock, and of the processors together."""

    wall: float
    cpu: float


@dataclass(frozen=True)
class _Case:
    shown: bpy.types.Object | None
    part: float = 0.0  # of a frame
    draws: bool = True  # what a window draws, the normals of the surface, is read too


def measure_listing(surface: bpy.types.Object, sites: int, rounds: int) -> dict[str, float]:
    """Seconds to go through all instances, as each redraw and each render does."""
    scatters = _scatters(surface, sites, nodes, "") | _displayed(surface, sites)
    taken: dict[str, list[float]] = {name: [] for name in (OWN[0], *DISPLAYED)}
    for frame in range(1, 1 + rounds):
        bpy.context.scene.frame_set(frame)
        for name, times in taken.items():
            for other in scatters.values():
                if other.shown:
                    other.shown.hide_viewport = other.shown != scatters[name].shown
            depsgraph = bpy.context.evaluated_depsgraph_get()
            begin = time.process_time()
            len(depsgraph.object_instances)
            times.append(time.process_time() - begin)
    return {name: float(np.median(times)) for name, times in taken.items()}


def measure_playback(
    surface: bpy.types.Object, sites: int, rounds: int, against: Path | None = None
) -> dict[str, Taken]:
    """What a frame takes: nothing on the surface, nothing but its normals read, scatters.

    "between keys" plays a bake half a frame on, where two keys are mixed; whole frames look at one.
    Another checkout gives node groups to compare with. Points that follow each other are near each
    other, as those of the solver are.
    """
    cases = {"alone": _Case(None, draws=False), "its normals": _Case(None)}
    cases |= _scatters(surface, sites, nodes, "")
    cases |= _displayed(surface, sites)
    if against is not None:
        cases |= _scatters(surface, sites, _other_nodes(against), ", other groups")
    for method in ("RANDOM", "POISSON"):
        cases[f"Blender's {method.lower()}"] = _Case(_distributed(surface, sites, method))
    return _in_turns(cases, surface, rounds)


def _in_turns(cases: dict[str, _Case], surface: bpy.types.Object, rounds: int) -> dict[str, Taken]:
    taken: dict[str, list[tuple[float, float]]] = {name: [] for name in cases}
    for _ in range(rounds):
        for name, case in cases.items():
            for other in cases.values():
                if other.shown:
                    other.shown.modifiers[0].show_viewport = other.shown == case.shown
            _frame(1, case, surface)
            taken[name] += [_frame(frame, case, surface) for frame in _FRAMES]
    return {name: Taken(*np.median(times, axis=0).tolist()) for name, times in taken.items()}


def _frame(frame: int, case: _Case, surface: bpy.types.Object) -> tuple[float, float]:
    begin, used = time.perf_counter(), time.process_time()
    bpy.context.scene.frame_set(frame, subframe=case.part)
    if case.draws:
        _normals(surface)
    return time.perf_counter() - begin, time.process_time() - used


def _normals(surface: bpy.types.Object) -> object:
    evaluated = surface.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return evaluated.data.vertex_normals[0].vector


def _scatters(
    surface: bpy.types.Object, sites: int, groups: ModuleType, mark: str
) -> dict[str, _Case]:
    """Bound, baked, and baked between keys."""
    arrays = read_mesh(surface)
    bound, baked = (add_scatter(surface, arrays, sites, in_order=True) for _ in range(2))
    add_bake(baked, arrays, sites, _FRAMES.stop, 0.5, in_order=True)
    for scatter in (bound, baked):
        _play_with(scatter.modifiers[0], groups)
    found = (_Case(bound), _Case(baked), _Case(baked, 0.5))
    return {name + mark: case for name, case in zip(OWN, found, strict=True)}


def _displayed(surface: bpy.types.Object, sites: int) -> dict[str, _Case]:
    """Shown in other ways, to a camera that sees all of the surface, ten lengths away."""
    scene = bpy.context.scene
    scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(scene.camera)
    scene.camera.location = surface.location + Vector((0.0, 0.0, 10.0))
    arrays = read_mesh(surface)
    found = {}
    for name, settings in DISPLAYED.items():
        scatter = add_scatter(surface, arrays, sites, in_order=True)
        for setting, value in settings.items():
            setattr(scatter.dapple, setting, value)
        found[name] = _Case(scatter)
    return found


def _play_with(modifier: bpy.types.NodesModifier, groups: ModuleType) -> None:
    """Exchange the node group, its inputs kept."""
    inputs = [*nodes.INPUTS, *nodes.INSTANCE_INPUTS]
    names = [name for name, kind in inputs if kind != "NodeSocketGeometry"]
    before = {name: nodes.get_input(modifier, name) for name in names}
    modifier.node_group = groups.ensure_group()
    for name, value in before.items():
        if groups.has_input(modifier, name):
            groups.set_input(modifier, name, value)


def _other_nodes(checkout: Path) -> Any:
    """The package addon.nodes of another checkout, under another name; its version is another."""
    if not (checkout / "addon" / "nodes").is_dir():
        raise FileNotFoundError(checkout / "addon" / "nodes")
    package = ModuleType("other_addon")  # without what its own module does to Blender
    package.__path__ = [str(checkout / "addon")]
    sys.modules[package.__name__] = package
    module = importlib.import_module(f"{package.__name__}.nodes")
    if module.VERSION == nodes.VERSION:
        raise ValueError(f"node groups of {checkout} have the version of these, {nodes.VERSION}")
    return module


def _distributed(surface: bpy.types.Object, sites: int, method: str) -> bpy.types.Object:
    """As many instances of a cone by Blender's own node."""
    geometry = [("Geometry", "NodeSocketGeometry")]
    tree = new_group(method, geometry, geometry)
    b = Builder(tree)
    info = b.node("GeometryNodeObjectInfo", surface, transform_space="RELATIVE")
    points = b.node("GeometryNodeDistributePointsOnFaces", distribute_method=method)
    b.tree.links.new(info.outputs["Geometry"], points.inputs["Mesh"])
    density = sites / _AREA
    values = {"Density": density, "Density Max": 4.0 * density}
    values["Distance Min"] = float(0.67 / np.sqrt(density))  # gives as many points
    for socket in points.inputs:
        if socket.enabled and socket.name in values:
            socket.default_value = values[socket.name]
    rotation = points.outputs["Rotation"]
    feeds = (points.outputs["Points"], True, _cone(b), False, 0, rotation)
    b.output("Geometry", b.out("GeometryNodeInstanceOnPoints", *feeds))
    obj = bpy.data.objects.new(method, bpy.data.meshes.new(method))
    bpy.context.scene.collection.objects.link(obj)
    obj.modifiers.new(method, "NODES").node_group = tree
    return obj


def _cone(b: Builder) -> Socket:
    cone = b.node("GeometryNodeMeshCone")
    cone.inputs["Vertices"].default_value = 8
    return cone.outputs["Mesh"]


def swelling_sphere(moved: bool = False, flat: bool = False) -> bpy.types.Object:
    """A sphere that a shape key swells; moved, it is turned and not at the origin."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=7)
    surface = bpy.context.object
    if not flat:
        bpy.ops.object.shade_smooth()
    if moved:
        surface.location, surface.rotation_euler = (1, 2, 3), (0.3, 0.2, 0.1)
    surface.shape_key_add(name="Basis")
    key = surface.shape_key_add(name="Swollen")
    places = np.empty(3 * len(key.data), dtype=np.float32)
    key.data.foreach_get("co", places)
    key.data.foreach_set("co", 1.2 * places)
    for frame, value in ((1, 0.0), (_FRAMES.stop, 1.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    return surface
