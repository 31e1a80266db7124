# SPDX-License-Identifier: GPL-3.0-or-later
"""The density as colours: what would be drawn, and when it is computed anew."""

import addon_host
import bpy
import numpy as np
import pytest
import scenes


@pytest.fixture
def overlay():
    return addon_host.part("blender.overlay")


def sloped(**density):
    obj = scenes.scattered(scenes.sphere(), count=40)
    for name, value in density.items():
        setattr(obj.dapple.density, name, value)
    return obj


def wait(overlay):
    """The timer, after nothing has changed for a while."""
    if overlay._shown.changed:
        overlay._shown.changed -= 1.0
    return overlay._tick()


def test_colours_tell_where_points_will_be(overlay):
    obj = sloped(use_height=True, height_from=0.0, height_to=2.0, height_fade=0.0)
    assert bpy.ops.dapple.show_density() == {"FINISHED"}
    assert overlay.is_on(obj)
    positions, colours = overlay.triangles()
    above, below = positions[:, 2] > 0.1, positions[:, 2] < -0.1
    most, none = overlay.coloured(np.array([1.0, 0.0]))
    np.testing.assert_allclose(colours[above], np.tile(most, (above.sum(), 1)))
    np.testing.assert_allclose(colours[below], np.tile(none, (below.sum(), 1)))
    assert bpy.ops.dapple.show_density() == {"FINISHED"}
    assert not overlay.is_on(obj)


def test_colours_follow_settings_and_the_surface(overlay):
    obj = sloped(use_height=True)
    bpy.ops.dapple.show_density()
    before = overlay.triangles()
    obj.dapple.density.height_from = 0.5
    wait(overlay)
    settled = overlay.triangles()
    assert settled[1].shape != before[1].shape or not np.array_equal(settled[1], before[1])
    obj.dapple.surface.location.x = 3.0
    bpy.context.view_layer.update()
    wait(overlay)
    assert overlay.triangles()[0][:, 0].min() > 1.9


def test_the_shown_class_counts(overlay):
    obj = sloped()
    group = obj.dapple.surface.vertex_groups.new(name="Half")
    group.add([v.index for v in obj.dapple.surface.data.vertices if v.co.z > 0], 1.0, "REPLACE")
    bpy.ops.dapple.edit_classes(action="ADD")
    obj.dapple.classes[0].density = "Half"
    bpy.ops.dapple.show_density()
    positions, colours = overlay.triangles()
    assert len(np.unique(colours[positions[:, 2] < -0.2], axis=0)) == 1
    assert len(np.unique(colours, axis=0)) > 1


def test_what_cannot_be_shown_is_told_and_ends(overlay):
    obj = sloped(attribute="Nowhere")
    with pytest.raises(RuntimeError, match="no attribute or vertex group 'Nowhere'"):
        bpy.ops.dapple.show_density()
    assert not overlay.is_on(obj)
    obj.dapple.density.attribute = ""
    bpy.ops.dapple.show_density()
    obj.dapple.density.attribute = "Nowhere"
    assert wait(overlay) is None
    assert not overlay.is_on(obj)
    assert "Nowhere" in overlay.note()


def test_a_scatter_that_is_deleted_and_a_new_file_end_it(overlay):
    obj = sloped()
    bpy.ops.dapple.show_density()
    overlay.touch(obj)
    bpy.data.objects.remove(obj)
    assert wait(overlay) is None
    obj = sloped()
    bpy.ops.dapple.show_density()
    bpy.ops.wm.read_homefile(app_template="", use_factory_startup=True, use_empty=True)
    assert overlay._shown.scatter is None
