# SPDX-License-Identifier: GPL-3.0-or-later
"""Instances that slide over a crease lean, and straighten a little in every frame."""

import itertools
import math

import addon_host
import bpy
import numpy as np
import pytest
import scenes


def part(name):
    return addon_host.part(f"core.{name}")


def turn_between(one, other):
    """Angles (n,) between orthonormal axes (n, 3, 3)."""
    trace = np.einsum("nij,nij->n", one, other)
    return np.arccos(np.clip((trace - 1.0) / 2.0, -1.0, 1.0))


def roof():
    """Two squares that meet in a right angle along y, each with vertices of its own."""
    ridge, left, right = [[0, 0, 1], [0, 1, 1]], [[-1, 0, 0], [-1, 1, 0]], [[1, 0, 0], [1, 1, 0]]
    one = [left[0], ridge[0], ridge[1], left[1]]
    other = [ridge[0], right[0], right[1], ridge[1]]
    faces = np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]], np.int32)
    return np.array(one + other, dtype=float), faces


def bound(faces, row, weights):
    records = part("surface.records")
    return records.Binding(faces[[row]], np.array([weights]), np.zeros(1))


def test_rotation_vectors_come_back():
    lean = part("bake.tilt")
    vectors = np.random.default_rng(1).normal(size=(200, 3))
    vectors *= (np.linspace(0, 3.1, 200) / np.linalg.norm(vectors, axis=1))[:, None]
    matrices = lean.rotations(vectors)
    np.testing.assert_allclose(np.linalg.det(matrices), 1)
    np.testing.assert_allclose(lean.rotation_vectors(matrices), vectors, atol=1e-7)


def test_half_a_turn_is_not_taken_for_none():
    lean = part("bake.tilt")
    vectors = math.pi * np.array(
        [[1, 0, 0], [0, 1, 0], [0, 0, 1], [0.6, 0, 0.8], [0.36, 0.48, 0.8]]
    )
    found = lean.rotation_vectors(lean.rotations(vectors))
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), math.pi)
    np.testing.assert_allclose(lean.rotations(found), lean.rotations(vectors), atol=1e-12)


def test_over_a_ridge_a_thing_turns_by_no_more_than_the_limit_and_rights_itself():
    lean, frames, keys = part("bake.tilt"), part("surface.frames"), part("bake.keys")
    vertices, faces = roof()
    left, right = bound(faces, 0, [0.1, 0.2, 0.7]), bound(faces, 2, [0.3, 0.1, 0.6])
    normals = frames.smooth(vertices, faces)
    placed = [keys.Placed(np.zeros(1, np.int32), left)]
    leaned, last = None, left
    for _ in range(12):
        turned = frames.carried(last, right, vertices, normals)
        leaned = lean.new_tilts(last, leaned, turned, vertices, normals)
        placed.append(keys.Placed(np.zeros(1, np.int32), turned, tilt=leaned))
        last = turned
    shown = []
    for one in placed:
        own = frames.frames(one.binding, vertices, normals).axes(one.binding.angle)
        shown.append(own if one.tilt is None else own @ lean.rotations(one.tilt))
    steps = np.degrees([turn_between(a, b)[0] for a, b in itertools.pairwise(shown)])
    assert steps.max() == pytest.approx(9.5, abs=1e-6)
    assert steps.sum() == pytest.approx(90, abs=1e-6)
    assert steps[-1] == pytest.approx(0, abs=1e-6)
    assert placed[-1].tilt is None


def test_where_a_fold_flips_the_normal_an_instance_turns_little_more_than_its_neighbors():
    lean = part("bake.tilt")
    random = np.random.default_rng(3)
    places, then = random.uniform(0.0, 10.0, (400, 3)) * [1, 1, 0], np.tile(np.eye(3), (400, 1, 1))
    turned = lean.rotations(np.tile(np.radians([0.0, 7.0, 0.0]), (400, 1)))
    alone = turned.copy()
    alone[[17, 230]] = lean.rotations(np.radians([[0.0, 170.0, 0.0], [80.0, 0.0, 0.0]]))
    found = lean.steadied(lean.Shown(then, 0.5), alone, places)
    degrees = np.degrees(turn_between(found, turned))
    np.testing.assert_allclose(np.delete(degrees, [17, 230]), 0.0, atol=1e-5)
    assert degrees.max() < 45.0
    assert lean.steadied(lean.Shown(then, 0.5), turned, places) is turned


def test_where_nothing_flips_nothing_leans():
    surface = scenes.sphere()
    bpy.ops.object.shade_smooth()
    for frame, size in ((1, 1.0), (6, 1.3)):
        surface.scale.z = size
        surface.keyframe_insert("scale", frame=frame)
    scenes.scattered(surface, count=100)
    bpy.ops.dapple.bake()
    keys = bpy.data.objects["Sphere Scatter Keys"].data
    assert "dapple_tilt" not in keys.attributes


@pytest.mark.parametrize("randomness", [0.0, 1.0])
def test_a_baked_lean_is_played(randomness):
    surface = scenes.sphere()
    obj = scenes.scattered(surface, count=40)
    obj.dapple.random_turn = randomness
    points, writing, reading = (
        addon_host.part(f"blender.{name}")
        for name in ("scatter.points", "scatter.key_writing", "surface.mesh")
    )
    arrays = reading.read_mesh(surface)
    binding, _ = points.read_binding(obj, len(arrays.vertices))
    faces = part("surface.binding").faces_with_corners(binding.corners, arrays.faces)
    corners, loops = arrays.faces[faces], arrays.face_corners[faces]
    order = np.argmax(corners[:, None, :] == binding.corners[:, :, None], axis=1)
    weights = np.take_along_axis(binding.barycentric, order, axis=1)
    binding = part("surface.records").Binding(corners, weights, np.linspace(0, 6, 40), loops)
    vectors = np.random.default_rng(2).uniform(-0.6, 0.6, (40, 3))
    keyframes = part("bake.keys").Keyframes(2)
    for lean in (None, vectors):
        placed = part("surface.records").Placed(faces, binding, tilt=lean)
        keyframes.add(placed, arrays, arrays, 0.1)
    writing.write_baked(obj, keyframes.packed(), 1, part("solve.solve").Report(count=40))
    normals = part("surface.frames").shading(arrays)
    own = part("surface.frames").frames(binding, arrays.vertices, normals).axes(binding.angle)
    turn = np.empty(40, np.float32)
    obj.data.attributes["dapple_turn"].data.foreach_get("value", turn)
    about = part("bake.tilt").rotations(np.outer(randomness * turn, [0, 0, 1]))
    for frame, expected in ((1, own), (2, own @ part("bake.tilt").rotations(vectors))):
        bpy.context.scene.frame_set(frame)
        found = scenes.instance_matrices(obj)[:, :3, :3]
        found = found / np.linalg.norm(found, axis=1, keepdims=True)
        assert np.degrees(turn_between(found, expected @ about)).max() < 1.0
    bpy.context.scene.frame_set(1, subframe=0.5)
    half = scenes.instance_matrices(obj)[:, :3, :3]
    half = half / np.linalg.norm(half, axis=1, keepdims=True)
    between = own @ part("bake.tilt").rotations(0.5 * vectors) @ about
    assert np.degrees(turn_between(half, between)).max() < 1.5


def test_a_frame_with_leans_comes_back_from_its_file(tmp_path):
    sidecar, keys, records = part("bake.sidecar"), part("bake.keys"), part("surface.records")
    faces = np.array([[0, 1, 2]], np.int32)
    binding = records.Binding(faces[[0, 0]], np.full((2, 3), 1 / 3), np.zeros(2))
    lean = np.array([[0.1, -0.2, 0.0], [0.0, 0.0, math.pi / 7]])
    placed = keys.Placed(np.zeros(2, np.int32), binding, tilt=lean)
    files = sidecar.Sidecar(tmp_path / "work")
    files.store(4, "mark", sidecar.Solved(placed, part("solve.solve").Report()))
    surface = part("surface.arrays").SurfaceArrays("Triangle", np.eye(3), faces, "same")
    found = files.load(4, "mark", 2, surface)
    np.testing.assert_array_equal(found.placed.tilt, lean)
    assert files.load(4, "mark", 3, surface) is None


def test_leans_are_packed_with_rows_that_appear_later():
    keys = part("bake.keys")
    np.testing.assert_array_equal(keys.padded(np.ones((1, 3)), 3), [[1] * 3, [0] * 3, [0] * 3])
    assert keys.padded(np.zeros((0, 3)), 2).shape == (2, 3)


def test_a_bake_with_births_bounds_its_turns_too(monkeypatch):
    """With a limit that every slide exceeds, all rows of all keys have a lean."""
    monkeypatch.setattr(part("bake.tilt"), "LIMIT", 1e-9)
    obj = scenes.scattered(scenes.tail(), count=60)
    obj.dapple.population = "KEEP_DENSITY"
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    keys = addon_host.part("blender.scatter.key_stores").stored_object(obj, "Keys").data
    assert len(keys.attributes["dapple_tilt"].data) == len(keys.vertices)
    assert len(keys.vertices) == obj.dapple.baked_keys * len(obj.data.vertices)
    bpy.context.scene.frame_set(4)
    assert len(scenes.instance_matrices(obj)) >= 60
