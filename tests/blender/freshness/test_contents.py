# SPDX-License-Identifier: GPL-3.0-or-later
"""A result is out of date when the contents of its inputs have changed, whatever their names."""

import math

import bpy
import numpy as np
import pytest
import scenes
from contents import camera, colored, linked, note, obstacle, picture, reason, solved, weighed


def painted_weights():
    surface = scenes.sphere()
    group = weighed(surface)
    obj = solved(surface, attribute="Grass")
    yield obj
    group.add([100], 0.25, "REPLACE")
    yield "Values of 'Grass' were changed"


def painted_attribute():
    surface = scenes.sphere()
    colored(surface)
    obj = solved(surface, attribute="Moss")
    yield obj
    surface.data.attributes["Moss"].data[5].value = 0.1
    yield "Values of 'Moss' were changed"


def painted_class():
    surface = scenes.sphere()
    group = weighed(surface)
    obj = scenes.scattered(surface)
    bpy.ops.dapple.edit_object_types(action="ADD")
    obj.dapple.object_types[0].density = "Grass"
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    yield obj
    group.add([100], 0.25, "REPLACE")
    yield "Values of 'Grass' were changed"


def painted_picture():
    image = picture()
    obj = solved(scenes.sphere(), image=image)
    yield obj
    image.pixels[12] = 0.0
    yield "Image 'Picture' was changed"


def another_picture():
    obj = solved(scenes.sphere(), image=picture())
    yield obj
    other = picture("Other")
    other.pixels[0] = 0.0
    obj.dapple.density.image = other
    yield "Image 'Other' was changed"


def moved_texture():
    surface = scenes.sphere()
    obj = solved(surface, image=picture())
    yield obj
    surface.data.uv_layers[0].uv[7].vector = (0.3, 0.3)
    yield "UV map of 'Sphere' was changed"


def moved_camera():
    made = camera()
    obj = solved(scenes.sphere(), use_camera_view=True)
    yield obj
    made.location.x = 0.5
    yield "The camera was moved or changed"


def zoomed_camera():
    made = camera()
    obj = solved(scenes.sphere(), use_camera_view=True)
    yield obj
    made.data.lens = 70.0
    yield "The camera was moved or changed"


def moved_obstacle():
    stone = obstacle()
    obj = solved(scenes.sphere(), avoid_collection=bpy.data.collections["Stones"])
    yield obj
    stone.location.z = -1.5
    yield "Avoided objects were moved or changed"


def reshaped_obstacle():
    stone = obstacle()
    obj = solved(scenes.sphere(), avoid_collection=bpy.data.collections["Stones"])
    yield obj
    stone.data.vertices[3].co.z = 1.0
    yield "Avoided objects were moved or changed"


def another_obstacle():
    obstacle()
    obj = solved(scenes.sphere(), avoid_collection=bpy.data.collections["Stones"])
    yield obj
    copy = bpy.data.objects["Stone"].copy()
    copy.location.x = 1.0
    linked(copy, bpy.data.collections["Stones"])
    yield "Avoided objects were moved or changed"


def stretched():
    surface = scenes.sphere()
    yield solved(surface)
    surface.scale.x = 3.0
    yield "Surface 'Sphere' has another shape or scale than before"


def scaled():
    surface = scenes.sphere()
    yield solved(surface)
    surface.scale = (2.0, 2.0, 2.0)
    yield "Surface 'Sphere' has another shape or scale than before"


def sheared():
    surface = scenes.sphere(rotation=(0.4, 0.5, 0.6))
    above = linked(bpy.data.objects.new("Above", None))
    surface.parent = above
    yield solved(surface)
    above.scale.z = 2.0
    yield "Surface 'Sphere' has another shape or scale than before"


def sculpted():
    surface = scenes.sphere()
    yield solved(surface)
    surface.data.vertices[17].co *= 1.2
    yield "Surface 'Sphere' has another shape or scale than before"


def scaled_at_rest_with_other_levels():
    surface = scenes.tail(levels=1, render_levels=2)
    scenes.activate(surface)
    assert bpy.ops.dapple.add_scatter(count=60) == {"FINISHED"}
    yield bpy.context.object
    surface.modifiers["Subdivision"].levels = 2
    assert reason(bpy.context.object) == ""
    surface.scale.x = 2.0
    yield "Surface 'Tail' has another shape or scale than before"


def tipped_over():
    surface = scenes.sphere()
    yield solved(surface, use_slope=True)
    surface.rotation_euler.x = 1.0
    yield "Surface 'Sphere' was rotated or moved, and the density depends on it"


def lifted():
    surface = scenes.sphere()
    yield solved(surface, use_height=True)
    surface.location.z = 0.3
    yield "Surface 'Sphere' was rotated or moved, and the density depends on it"


def not_a_number():
    surface = scenes.sphere()
    yield solved(surface)
    surface.data.vertices[17].co.x = math.nan
    yield "Surface 'Sphere': vertices[17] is not finite: [nan, "


def no_geometry():
    surface = scenes.sphere()
    yield solved(surface)
    surface.data.clear_geometry()
    yield "Attached to 266 vertices, the surface has 0"


def no_faces_at_rest():
    surface = scenes.sphere()
    scenes.activate(surface)
    assert bpy.ops.dapple.add_scatter(count=60, attach_to="REST") == {"FINISHED"}
    yield bpy.context.object
    surface.data.clear_geometry()
    yield "Surface 'Sphere': has no faces"


def rest_position_off():
    surface = scenes.sphere()
    scenes.activate(surface)
    assert bpy.ops.dapple.add_scatter(count=60, attach_to="REST") == {"FINISHED"}
    yield bpy.context.object
    surface.add_rest_position_attribute = False
    yield "Rest Position of 'Sphere' is off"


def no_surface_at_all():
    obj = solved(scenes.sphere())
    yield obj
    obj.dapple.surface = linked(bpy.data.objects.new("Nothing", None))
    yield "Surface 'Nothing' is not a mesh, curve, text or metaball"


def points_moved_by_hand():
    obj = solved(scenes.sphere())
    yield obj
    obj.data.vertices[3].co.x += 0.2
    yield "Points were edited by hand: reattach them, or lock them and optimize"


def bindings_edited_by_hand():
    obj = solved(scenes.sphere())
    yield obj
    obj.data.attributes["dapple_v1"].data[7].value = 99_999
    yield "Points were edited by hand: reattach them, or lock them and optimize"


def another_surface():
    surface = scenes.sphere()
    obj = solved(surface)
    yield obj
    other = linked(surface.copy())
    other.name, other.location.x = "Other", 5.0
    obj.dapple.surface = other
    yield "The points are on 'Sphere', not on 'Other'"


CHANGES = [
    painted_weights,
    painted_attribute,
    painted_class,
    painted_picture,
    another_picture,
    moved_texture,
    moved_camera,
    zoomed_camera,
    moved_obstacle,
    reshaped_obstacle,
    another_obstacle,
    stretched,
    scaled,
    sheared,
    sculpted,
    scaled_at_rest_with_other_levels,
    tipped_over,
    lifted,
    not_a_number,
    no_geometry,
    no_faces_at_rest,
    rest_position_off,
    no_surface_at_all,
    points_moved_by_hand,
    bindings_edited_by_hand,
    another_surface,
]


@pytest.mark.parametrize("change", CHANGES)
def test_what_a_solution_depends_on_is_compared_by_content(change):
    steps = change()
    obj = next(steps)
    assert reason(obj) == ""
    said = next(steps)
    assert said in reason(obj)


MENDED = {
    painted_weights,
    painted_attribute,
    painted_picture,
    moved_camera,
    moved_obstacle,
    stretched,
    tipped_over,
    another_surface,
}


@pytest.mark.parametrize("operator", ["optimize", "bake"])
@pytest.mark.parametrize("change", sorted(MENDED, key=lambda one: one.__name__))
def test_solving_again_makes_it_fit(change, operator):
    bpy.context.scene.frame_end = 2
    steps = change()
    obj = next(steps)
    before = scenes.positions(obj)
    next(steps)
    bpy.context.view_layer.update()
    scenes.activate(obj)
    assert getattr(bpy.ops.dapple, operator)() == {"FINISHED"}
    assert reason(obj) == note(obj) == ""
    assert np.abs(scenes.positions(obj) - before).max() > 1e-3
