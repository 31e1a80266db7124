# SPDX-License-Identifier: GPL-3.0-or-later
"""Points in pairs of mirror images."""

import bpy
import numpy as np
import pytest
import scenes


def monkey():
    """Active Suzanne."""
    bpy.ops.mesh.primitive_monkey_add()
    return bpy.context.object


def paired(surface, count, axis="X", **settings):
    """A symmetric scatter on a surface."""
    obj = scenes.scattered(surface, count=10)
    obj.dapple.symmetry, obj.dapple.count = axis, count
    for name, value in settings.items():
        setattr(obj.dapple, name, value)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    return obj


def column(obj, name):
    attribute = obj.data.attributes[name]
    values = np.empty(len(obj.data.vertices), dtype=np.float32 if "rank" in name else np.int32)
    attribute.data.foreach_get("value", values)
    return values


def mirrored(obj):
    """Row of each point's mirror image."""
    ids, images = column(obj, "id"), column(obj, "dapple_mirror")
    rows = np.argsort(ids)[np.searchsorted(np.sort(ids), images)]
    assert (rows[rows] == np.arange(len(ids))).all()
    return rows


@pytest.mark.parametrize("count", [399, 400, 401, 403])
def test_points_on_suzanne_are_mirror_images(count):
    obj = paired(monkey(), count)
    found, rows = scenes.positions(obj), mirrored(obj)
    assert len(found) == count
    assert np.abs(found[rows] * [-1, 1, 1] - found).max() < 3e-6
    assert 0 < (rows == np.arange(count)).sum() < 40


def test_the_plane_goes_through_the_origin_along_a_local_axis():
    bpy.ops.mesh.primitive_cube_add(location=(3.0, 1.0, 2.0), rotation=(0.4, 0.3, 0.8))
    surface = bpy.context.object
    surface.scale = (1.0, 2.0, 0.5)
    bpy.context.view_layer.update()
    matrix = np.array(surface.matrix_world.inverted())
    obj = paired(surface, 150, "Y")
    own = scenes.positions(obj) @ matrix[:3, :3].T + matrix[:3, 3]
    assert np.abs(own[mirrored(obj)] * [1, -1, 1] - own).max() < 1e-5


def test_every_beginning_of_the_order_is_symmetric():
    obj = paired(monkey(), 200)
    rows, ranks = mirrored(obj), column(obj, "dapple_rank")
    order = np.argsort(ranks)
    for shown in (50, 121):
        kept = set(order[:shown].tolist())
        assert sum(int(rows[row]) not in kept for row in kept) <= 1


def test_pairs_stay_while_the_surface_deforms():
    surface = monkey()
    obj = paired(surface, 100)
    before = column(obj, "dapple_mirror")
    surface.modifiers.new("Bend", "SIMPLE_DEFORM")
    bpy.context.view_layer.update()
    assert (column(obj, "dapple_mirror") == before).all()


def test_turned_off_nothing_is_left_of_the_pairs():
    obj = paired(monkey(), 60)
    obj.dapple.symmetry = "NONE"
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert "dapple_mirror" not in obj.data.attributes


def test_a_density_counts_with_its_mirror_image():
    surface = monkey()
    group = surface.vertex_groups.new(name="Left")
    group.add([v.index for v in surface.data.vertices if v.co.x > -1e-6], 1.0, "REPLACE")
    obj = scenes.scattered(surface, count=10)
    obj.dapple.density.attribute = "Left"
    obj.dapple.symmetry, obj.dapple.count = "X", 120
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    found = scenes.positions(obj)
    assert (found[:, 0] > 1e-5).sum() == (found[:, 0] < -1e-5).sum() > 40


def refused(words):
    with pytest.raises(RuntimeError, match=words):
        bpy.ops.dapple.optimize()


def test_what_cannot_be_mirrored_is_refused():
    obj = scenes.scattered(monkey(), count=40)
    obj.dapple.symmetry = "Y"
    refused(r"'Suzanne'.*, Symmetry Y: surface is not symmetric: .* vertices\[")
    obj.dapple.symmetry = "X"
    assert bpy.ops.dapple.edit_object_types(action="ADD") == {"FINISHED"}
    refused("one object type")


def test_locked_points_are_refused():
    obj = scenes.scattered(monkey(), count=10)
    bpy.ops.dapple.lock_points(lock=True, every=True)
    obj.dapple.symmetry = "X"
    refused(r"With Symmetry points cannot be locked \(10 are\): unlock all")
