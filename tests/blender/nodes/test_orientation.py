# SPDX-License-Identifier: GPL-3.0-or-later
"""The node group that computes rotations, beside arithmetic in double precision."""

import itertools
import math

import addon_host
import bpy
import numpy as np
import pytest

pytestmark = pytest.mark.empty_file  # the node groups are built here

AXES = np.array([v for v in itertools.product((-1.0, 0.0, 1.0), repeat=3) if any(v)])


def rotations(normals, aheads, turns, side=1.0):
    """Rotation matrices (n, 3, 3) that the group gives."""
    units = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    mesh = bpy.data.meshes.new("Rows")
    mesh.vertices.add(len(normals))
    for name, kind, rows in (
        ("normal", "FLOAT_VECTOR", units),
        ("ahead", "FLOAT_VECTOR", aheads),
        ("turn", "FLOAT", turns),
    ):
        layer = mesh.attributes.new(name, kind, "POINT")
        key = "value" if kind == "FLOAT" else "vector"
        layer.data.foreach_set(key, np.asarray(rows, dtype=np.float32).ravel())
    obj = bpy.data.objects.new("Rows", mesh)
    bpy.context.scene.collection.objects.link(obj)
    obj.modifiers.new("Nodes", "NODES").node_group = _tree(side)
    bpy.context.view_layer.update()
    found = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.attributes["rotation"]
    return np.array([_matrix(row.value) for row in found.data])


def _tree(side):
    builder, groups = addon_host.part("nodes.builder"), addon_host.part("nodes.builder")
    geometry = [("Geometry", "NodeSocketGeometry")]
    tree = builder.new_group("Chain", geometry, geometry)
    b = builder.Builder(tree)
    feeds = [b.attribute(name, "FLOAT_VECTOR") for name in ("normal", "ahead")]
    standing = addon_host.part("nodes.orientation").ORIENTATION
    node = groups.inner(b, standing, *feeds, b.attribute("turn", "FLOAT"), side)
    b.output("Geometry", b.store(b.input("Geometry"), "rotation", node.outputs[0], "QUATERNION"))
    return tree


def _matrix(quaternion):
    w, x, y, z = np.array(quaternion, dtype=np.float64)
    assert abs(w * w + x * x + y * y + z * z - 1.0) < 1e-5
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def expected(normals, aheads, turns, side=1.0):
    z = side * normals / np.linalg.norm(normals, axis=1, keepdims=True)
    x = aheads - np.einsum("nd,nd->n", z, aheads)[:, None] * z
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    cosine, sine = np.cos(turns)[:, None], np.sin(turns)[:, None]
    x = cosine * x + sine * np.cross(z, x)
    return np.stack([x, np.cross(z, x), z], axis=2)


def rows():
    """All directions along and between the axes, nearly those, and any."""
    random = np.random.Generator(np.random.PCG64(0))
    near = AXES + random.normal(0.0, 1e-5, AXES.shape)
    normals = np.concatenate([AXES, near, random.normal(0.0, 1.0, (100, 3))]).astype(np.float32)
    pairs = [(n, a) for n in normals for a in AXES if np.linalg.norm(np.cross(n, a)) > 0.1]
    normals, aheads = (np.array(one, dtype=np.float64) for one in zip(*pairs, strict=True))
    turns = np.tile([0.0, 1.0, -math.pi, math.pi, 7.0, -3.0, 2 * math.pi], len(pairs))
    return normals, aheads, turns[: len(pairs)].astype(np.float32).astype(np.float64)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_rotations_are_those_of_double_precision(side, size):
    normals, aheads, turns = rows()
    found = rotations(normals / size, size * aheads, turns, side)
    assert np.abs(found - expected(normals, aheads, turns, side)).max() < 1e-5


def test_without_a_direction_ahead_z_is_still_along_the_normal():
    aheads = np.concatenate([np.zeros_like(AXES), AXES, -2.0 * AXES])
    normals = np.tile(AXES, (3, 1))
    found = rotations(normals, aheads, np.full(len(normals), 0.5))
    units = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    assert np.abs(found[:, :, 2] - units).max() < 1e-5


def test_without_a_normal_there_is_a_rotation():
    found = rotations(np.zeros_like(AXES), AXES, np.zeros(len(AXES)))
    assert np.isfinite(found).all()
