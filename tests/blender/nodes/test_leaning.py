# SPDX-License-Identifier: GPL-3.0-or-later
"""Leaning: away from neighbors, and along the Z axis of an object."""

import math

import addon_host
import bpy
import numpy as np
import pytest
import scenes


@pytest.fixture
def obj():
    """Instances on a square from -1 to 1 that face in random directions."""
    bpy.ops.mesh.primitive_plane_add(size=2.0)
    return scenes.scattered(bpy.context.object, count=300)


def up(obj):
    """Z axes (n, 3) of the instances."""
    return scenes.rotations(obj)[:, :, 2]


def sun(direction):
    """An object whose Z axis has this direction."""
    lamp = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    bpy.context.collection.objects.link(lamp)
    lamp.rotation_euler = direction
    return lamp


def at_border(places):
    """Points near one side and not near a corner: their outward normals."""
    outward = np.where(np.abs(places) > 0.93, np.sign(places), 0.0)[:, :2]
    single = (np.abs(outward).sum(axis=1) == 1.0) & (np.abs(places).min(axis=1) <= 0.7)
    return single, outward


def test_instances_at_a_border_lean_outward_and_others_hardly(obj):
    assert np.allclose(up(obj), (0.0, 0.0, 1.0), atol=1e-5)
    obj.dapple.lean_apart = 0.5
    places, axes = scenes.positions(obj), up(obj)
    chosen, outward = at_border(places)
    assert chosen.sum() > 20
    sideways = np.einsum("nd,nd->n", axes[chosen, :2], outward[chosen])
    assert sideways.min() > 0.5 * math.sin(0.5)
    angles = np.arccos(np.clip(axes[:, 2], -1.0, 1.0))
    assert angles.max() < 0.5 + 1e-3
    middle = np.abs(places[:, :2]).max(axis=1) < 0.7
    assert angles[middle].mean() < 0.15


def test_they_lean_the_same_way_however_they_are_turned_and_aligned(obj):
    obj.dapple.lean_apart = 0.4
    before = up(obj)
    obj.dapple.random_turn = 0.3
    assert np.allclose(up(obj), before, atol=1e-4)
    obj.dapple.align_to_normal = 0.999999
    assert np.allclose(up(obj), before, atol=1e-3)
    obj.dapple.forward = "X"
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert np.allclose(up(obj), before, atol=1e-3)


def test_instances_lean_to_the_sun_by_a_share(obj):
    obj.dapple.lean_object = sun((0.0, 0.8, 0.0))
    toward = np.array([math.sin(0.8), 0.0, math.cos(0.8)])
    obj.dapple.lean_along = 1.0
    assert np.allclose(up(obj), toward, atol=1e-4)
    obj.dapple.lean_along = 0.5
    assert np.allclose(up(obj), [math.sin(0.4), 0.0, math.cos(0.4)], atol=1e-4)
    obj.dapple.lean_object.rotation_euler = (0.0, -0.8, 0.0)
    assert np.allclose(up(obj), [-math.sin(0.4), 0.0, math.cos(0.4)], atol=1e-4)


def test_each_object_type_leans_by_its_own_amount(obj):
    for lean in (0.0, 1.0):
        assert bpy.ops.dapple.edit_object_types(action="ADD") == {"FINISHED"}
        obj.dapple.object_types[-1].lean_along = lean
    obj.dapple.lean_object = sun((0.0, 0.8, 0.0))
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    leaning = up(obj)[:, 0] > 0.1
    assert leaning.sum() == 150


def test_an_update_and_a_bake_keep_leaning(obj, live):
    obj.dapple.lean_apart = 0.5
    obj.dapple.count = 310
    assert live.settle() == 1
    chosen, outward = at_border(scenes.positions(obj))
    sideways = np.einsum("nd,nd->n", up(obj)[chosen, :2], outward[chosen])
    assert sideways.min() > 0.5 * math.sin(0.5)
    before = up(obj)
    bpy.context.scene.frame_end = 3
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    for frame in (1, 2, 3):
        bpy.context.scene.frame_set(frame)
        assert np.allclose(up(obj), before, atol=2e-2)


def test_points_along_edges_lean_outward_at_corners():
    bpy.ops.mesh.primitive_plane_add(size=2.0)
    obj = scenes.scattered(bpy.context.object, count=40)
    obj.dapple.scatter_on = "EDGES"
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    obj.dapple.lean_apart = 0.5
    to_corner = np.abs(scenes.positions(obj)[:, :2]).min(axis=1)
    lean = np.arccos(np.clip(up(obj)[:, 2], -1.0, 1.0))
    assert lean[to_corner > 0.85].mean() > 3.0 * lean[to_corner < 0.5].mean()


def test_points_of_files_without_it_stand_upright(obj):
    obj.data.attributes.remove(obj.data.attributes["dapple_apart"])
    obj.dapple.lean_apart = 0.5
    assert np.allclose(up(obj), (0.0, 0.0, 1.0), atol=1e-5)


def test_presets_have_the_amounts(obj):
    obj.dapple.lean_apart, obj.dapple.lean_along = 0.3, 0.2
    assert bpy.ops.dapple.save_preset(name="Leaning") == {"FINISHED"}
    obj.dapple.lean_apart = obj.dapple.lean_along = 0.0
    assert bpy.ops.dapple.load_preset(name="Leaning") == {"FINISHED"}
    assert obj.dapple.lean_apart == pytest.approx(0.3)
    assert obj.dapple.lean_along == pytest.approx(0.2)
    assert addon_host.part("blender.scatter.object").settings_reason(obj) == ""
