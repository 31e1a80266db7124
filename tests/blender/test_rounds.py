# SPDX-License-Identifier: GPL-3.0-or-later
"""Random rounds of strokes, settings, renders, undo and redo with Auto Update on.

DAPPLE_ROUNDS says how many; a few by default.
"""

import os
import random

import addon_host
import bpy
import numpy as np
import pytest
import scenes

ROUNDS = int(os.environ.get("DAPPLE_ROUNDS", "12"))
NAME = "Sphere Scatter"


def scatter():
    return bpy.data.objects[NAME]


def stroke(chance):
    surface = scatter().dapple.surface
    first = chance.randrange(200)
    group = surface.vertex_groups["Grass"]
    group.add(range(first, first + 40), chance.choice([0.0, 0.3, 1.0]), "REPLACE")
    surface.data.update()


def setting(chance):
    settings = scatter().dapple
    name, value = chance.choice(
        [
            ("count", chance.randrange(40, 120)),
            ("points_per_area", chance.uniform(4.0, 10.0)),
            ("amount", chance.choice(["COUNT", "PER_AREA"])),
            ("seed", chance.randrange(3)),
            ("quality", chance.choice(["DRAFT", "NATURAL", "FINE"])),
            ("forward", chance.choice(["NONE", "X"])),
            ("keep_points", chance.random() < 0.8),
        ]
    )
    setattr(settings, name, value)


def density(chance):
    settings = scatter().dapple.density
    settings.use_height = chance.random() < 0.5
    settings.height_from = chance.uniform(-0.6, 0.0)
    settings.use_noise = chance.random() < 0.3
    settings.noise_strength = chance.uniform(0.2, 0.8)


def instances(chance):
    """What is solved from nothing of this."""
    settings = scatter().dapple
    settings.fit, settings.scale = chance.choice([0.0, 1.0]), chance.uniform(0.5, 2.0)
    settings.display_as = chance.choice(["INSTANCES", "BOUNDS"])


def obstacle(chance):
    bpy.data.objects["Stone"].location.y = chance.uniform(-1.0, 1.0)


def shape(chance):
    surface = scatter().dapple.surface
    surface.data.vertices[chance.randrange(200)].co *= chance.uniform(0.9, 1.1)
    surface.data.update()


def scale(chance):
    scatter().dapple.surface.scale.x = chance.uniform(0.8, 1.5)


def undo(_chance):
    if bpy.ops.ed.undo.poll():
        bpy.ops.ed.undo()


def redo(_chance):
    if bpy.ops.ed.redo.poll():
        bpy.ops.ed.redo()


def optimize(_chance):
    scenes._activate(scatter())
    assert bpy.ops.dapple.optimize("EXEC_DEFAULT", True) == {"FINISHED"}


def render(_chance):
    """While an update may be under way."""
    assert bpy.ops.render.render() == {"FINISHED"}


CHANGES = (
    *(stroke, stroke, setting, setting, density, obstacle, shape, scale),
    *(instances, optimize, render),
)


def prepared():
    surface = scenes.sphere()
    surface.vertex_groups.new(name="Grass").add(range(300), 1.0, "REPLACE")
    stones = bpy.data.collections.new("Stones")
    bpy.context.scene.collection.children.link(stones)
    stone = scenes.sphere(location=(1.0, 0.0, 0.0), scale=(0.2, 0.2, 0.2))
    stone.name = "Stone"
    stones.objects.link(stone)
    obj = scenes.scattered(surface, count=80)
    _small_renders()
    obj.dapple.auto_update_choice = "ON"
    obj.dapple.density.attribute, obj.dapple.density.obstacles = "Grass", stones


def _small_renders():
    scene = bpy.context.scene
    scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(scene.camera)
    scene.render.engine, scene.cycles.samples = "CYCLES", 1
    scene.render.resolution_x = scene.render.resolution_y = 16


def check(live):
    """Nothing is out of date, and every point that is counted is there, once, on the surface."""
    obj = scatter()
    assert not live.watcher.trouble(obj)
    assert addon_host.part("blender.status.staleness").stale_reason(obj, bpy.context) == ""
    ids = addon_host.part("blender.data.points").point_columns_of(obj)["id"]
    found = scenes.positions(obj)
    assert len(ids) == len(np.unique(ids)) == len(found) == obj.dapple.report.count
    if obj.dapple.amount == "COUNT":
        assert len(found) == obj.dapple.count
    assert np.isfinite(found).all()
    assert obj.dapple.report.measured
    assert not scenes.node_warnings(obj)


@pytest.mark.parametrize("seed", range(2))
def test_after_whatever_the_points_are_those_of_what_is_there(live, seed):
    chance = random.Random(seed)
    prepared()
    bpy.ops.ed.undo_push(message="Prepared")
    live.settle()
    for number in range(ROUNDS):
        for _ in range(chance.randrange(1, 4)):
            change = chance.choice(CHANGES)
            change(chance)
            bpy.ops.ed.undo_push(message=f"{number} {change.__name__}")
            for _ in range(chance.randrange(30)):  # an update may be under way
                live.look()
                live.clock.now += 0.1
        for _ in range(chance.randrange(3)):
            chance.choice([undo, undo, redo])(chance)
            if chance.random() < 0.5:
                live.look()
        live.settle()
        check(live)
