# SPDX-License-Identifier: GPL-3.0-or-later
"""No point stays where the density is 0, whatever is painted while points follow by themselves."""

import random

import addon_host
import bpy
import numpy as np
import pytest
import scenes


def stranded(obj):
    """Ids of points that are not locked and stand where the vertex group of the density is 0."""
    meshio, records = (
        addon_host.part("blender.base.mesh_arrays"),
        addon_host.part("core.surface.records"),
    )
    types = {**records.ROW_ATTRIBUTES, "id": "INT", "dapple_locked": "BOOLEAN"}
    columns = meshio.read_columns(obj.data, types)
    surface = obj.dapple.surface
    group = surface.vertex_groups[obj.dapple.density.attribute].index
    weights = np.zeros(len(surface.data.vertices))
    for vertex in surface.data.vertices:
        for one in vertex.groups:
            if one.group == group:
                weights[vertex.index] = one.weight
    corners = np.column_stack([columns[f"dapple_v{k}"] for k in range(3)])
    found = np.einsum("nk,nk->n", columns["dapple_barycentric"], weights[corners])
    return columns["id"][(found == 0.0) & ~columns["dapple_locked"]].tolist()


def gradient(surface, middle, none, full):
    """Paint a gradient around a place: exactly 0 nearer than none, 1 farther than full."""
    away = np.linalg.norm(scenes.world_vertices(surface) - middle, axis=1)
    weights = np.clip((away - none) / (full - none), 0.0, 1.0)
    for vertex in np.flatnonzero(away < full).tolist():
        surface.vertex_groups["Grass"].add([vertex], float(weights[vertex]), "REPLACE")
    surface.data.update()


def refilled(surface, middle, radius, weight):
    away = np.linalg.norm(scenes.world_vertices(surface) - middle, axis=1)
    near = np.flatnonzero(away < radius).tolist()
    surface.vertex_groups["Grass"].add(near, weight, "REPLACE")
    surface.data.update()


def painted(live, amount, locked, count):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24)
    surface = bpy.context.object
    group = surface.vertex_groups.new(name="Grass")
    group.add(range(len(surface.data.vertices)), 1.0, "REPLACE")
    obj = scenes.scattered(surface, count=count)
    obj.dapple.auto_update_mode, obj.dapple.keep_points = "ON", True
    obj.dapple.amount, obj.dapple.points_per_area = amount, count / 12.0
    obj.dapple.density.attribute = "Grass"
    live.settle()
    if locked:
        obj.data.vertices.foreach_set("select", np.arange(len(obj.data.vertices)) < locked)
        obj.data.update()
        assert bpy.ops.dapple.lock_points() == {"FINISHED"}
        live.settle()
    return surface, obj


@pytest.mark.sampled(2)
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("locked", [0, 5])
@pytest.mark.parametrize("amount", ["COUNT", "PER_AREA"])
def test_no_point_is_left_where_nothing_may_be(live, amount, locked, seed):
    chance = random.Random(seed)
    surface, obj = painted(live, amount, locked, 1000)
    for number in range(20):
        direction = np.array([chance.gauss(0.0, 1.0) for _ in range(3)])
        middle = direction / np.linalg.norm(direction)
        if chance.random() < 0.7:
            none = chance.uniform(0.1, 0.5)
            gradient(surface, middle, none, none + chance.uniform(0.05, 0.6))
        else:
            refilled(surface, middle, chance.uniform(0.2, 0.6), chance.choice([0.0, 0.3, 1.0]))
        live.settle()
        assert not live.watcher.trouble(obj)
        left = stranded(obj)
        assert left == [], f"seed {seed}, stroke {number}: points {left} stand where nothing may"
        ids = addon_host.part("blender.scatter.points").point_columns_of(obj)["id"]
        assert len(set(ids.tolist())) == len(ids)
        if amount == "COUNT":
            assert len(ids) == 1000
