# SPDX-License-Identifier: GPL-3.0-or-later
"""Remesh with Dapple of curves, surfaces, texts and metaballs: a new object has the mesh."""

import bakes
import bpy
import dapple3d as dapple
import numpy as np
import pytest
import scenes


def metaball():
    bpy.ops.object.metaball_add(type="BALL", radius=2.0)


def tube():
    bpy.ops.curve.primitive_bezier_circle_add(radius=2.0)
    bpy.context.object.data.bevel_depth = 0.3


def nurbs():
    bpy.ops.surface.primitive_nurbs_surface_sphere_add()


def text():
    bpy.ops.object.text_add()
    bpy.context.object.data.body = "Sod"
    bpy.context.object.data.extrude = 0.2


KINDS = [metaball, tube, nurbs, text]


def made_by(make):
    """The active object of a type, moved, turned and scaled."""
    make()
    obj = bpy.context.object
    obj.location, obj.rotation_euler.z, obj.scale.x = (3.0, 1.0, 0.0), 0.5, 2.0
    obj.data.materials.append(bpy.data.materials.new("Jade"))
    bpy.context.view_layer.update()
    return obj


def away_from(old, places):
    """The largest distance of places from triangles."""
    return dapple.project(dapple.Surface(*old), places).distances.max()


@pytest.mark.parametrize("make", KINDS)
def test_a_new_object_has_the_mesh(make, capfd):
    obj = made_by(make)
    before, collections = scenes.shown(obj), obj.users_collection
    assert bpy.ops.dapple.remesh(count=400) == {"FINISHED"}
    assert f"'{obj.name}': " in capfd.readouterr().out
    made = bpy.context.object
    assert (made.name, made.type) == (f"{obj.name} Remeshed", "MESH")
    assert made.select_get()
    assert made.users_collection == collections
    assert obj.hide_get()
    assert obj.hide_render
    assert not obj.select_get()
    places, _ = scenes.shown(made)
    assert len(places) > 380
    assert away_from(before, places) < 1e-3
    assert {len(one.vertices) for one in made.data.polygons} == {3}
    assert [one.name for one in made.data.materials] == ["Jade"]
    assert not made.data.validate()
    np.testing.assert_allclose(made.matrix_world, obj.matrix_world, atol=1e-6)


def test_the_new_object_moves_as_the_old_one():
    obj = made_by(text)
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.collection.objects.link(parent)
    parent.location.y = 2.0
    obj.parent = parent
    obj.constraints.new("LIMIT_LOCATION").min_z, obj.constraints[0].use_min_z = 1.0, True
    for frame, place in ((1, 0.0), (5, 4.0)):
        obj.location.x = place
        obj.keyframe_insert("location", frame=frame)
    obj.driver_add("scale", 2).driver.expression = "frame"
    bpy.context.scene.frame_set(2)
    assert bpy.ops.dapple.remesh(count=300) == {"FINISHED"}
    made = bpy.context.object
    for frame in (2, 4):
        bpy.context.scene.frame_set(frame)
        parent.location.z = frame
        bpy.context.view_layer.update()
        np.testing.assert_allclose(made.matrix_world, obj.matrix_world, atol=1e-6)
        assert away_from(scenes.shown(obj), scenes.shown(made)[0]) < 1e-3


def test_modifiers_are_contained():
    obj = made_by(tube)
    modifier = obj.modifiers.new("Array", "ARRAY")
    modifier.relative_offset_displace = (2.0, 0.0, 0.0)
    before = scenes.shown(obj)
    assert bpy.ops.dapple.remesh(count=600) == {"FINISHED"}
    made = bpy.context.object
    assert len(made.modifiers) == 0
    np.testing.assert_allclose(np.ptp(scenes.shown(made)[0], 0), np.ptp(before[0], 0), rtol=0.05)


def test_a_parent_that_deforms_does_not_bend_the_new_mesh():
    """It bends meshes, and the new one looks like the text already."""
    obj = made_by(text)
    bpy.ops.object.add(type="LATTICE")
    lattice = bpy.context.object
    lattice.scale = (20.0, 20.0, 20.0)
    lattice.data.points[7].co_deform.z += 0.2
    bpy.context.view_layer.update()
    obj.parent, obj.parent_type = lattice, "LATTICE"
    obj.matrix_parent_inverse = lattice.matrix_world.inverted()
    scenes.activate(obj)
    before = scenes.shown(obj)
    assert bpy.ops.dapple.remesh(count=300) == {"FINISHED"}
    made = bpy.context.object
    assert (made.parent, made.parent_type) == (lattice, "OBJECT")
    assert away_from(before, scenes.shown(made)[0]) < 1e-3


def test_undo_removes_the_new_object():
    made_by(metaball)
    bpy.ops.ed.undo_push(message="before")
    before = bakes.blocks()
    assert bpy.ops.dapple.remesh(count=200) == {"FINISHED"}
    bpy.ops.ed.undo_push(message="remesh")
    bpy.ops.ed.undo()
    assert bakes.blocks() == before
    assert bpy.context.object.type == "META"
    assert not bpy.context.object.hide_get()
    bpy.ops.ed.redo()
    assert bpy.context.object.name == "Mball Remeshed"


def test_in_the_background_its_panel_shows_the_message(artist):
    made_by(text)
    bpy.ops.ed.undo_push(message="Before")
    given = {"count": 300, "animation": "KEEP", "frame_start": 1, "frame_end": 6}
    assert artist.press("remesh", **bakes.PRESSED, **given) == {"CANCELLED"}
    bpy.context.scene.frame_set(3)  # the artist looks at another frame
    artist.finish()
    made = bpy.context.object
    assert made.type == "MESH"
    assert "vertices" in artist.said(made)[0][1]
    assert bpy.context.scene.frame_current == 3
    bpy.ops.ed.undo()
    assert bpy.context.object.type == "FONT"


def test_a_text_that_changes_meanwhile_is_left_alone(artist):
    obj = made_by(text)
    given = {"count": 300, "animation": "KEEP", "frame_start": 1, "frame_end": 6}
    artist.press("remesh", **bakes.PRESSED, **given)
    obj.data.body = "Turf"
    artist.finish()
    assert "changed" in artist.said(obj)[0][1]
    assert not obj.hide_get()
    assert bpy.context.object == obj


def test_a_curve_that_is_bent_gets_shape_keys():
    obj = made_by(tube)
    modifier = obj.modifiers.new("Wave", "WAVE")
    modifier.height = 0.5
    bpy.context.scene.frame_set(1)
    old = {}
    for frame in (1, 2, 3):
        bpy.context.scene.frame_set(frame)
        old[frame] = scenes.shown(obj)
    bpy.context.scene.frame_set(1)
    given = {"animation": "SHAPE_KEYS", "frame_start": 1, "frame_end": 3, "count": 400}
    assert bpy.ops.dapple.remesh(**given) == {"FINISHED"}
    made = bpy.context.object
    assert len(made.data.shape_keys.key_blocks) == 3
    assert len(made.modifiers) == 0
    assert len(obj.modifiers) == 1
    assert obj.hide_get()
    for frame in (1, 2, 3):
        bpy.context.scene.frame_set(frame)
        assert away_from(old[frame], scenes.shown(made)[0]) < 1e-3


def test_metaballs_get_a_sequence():
    obj = made_by(metaball)
    bpy.ops.object.metaball_add(type="BALL", radius=2.0)
    other = bpy.context.object
    for frame, place in ((1, 6.0), (3, 4.0)):
        other.location.x = place
        other.keyframe_insert("location", frame=frame)
    scenes.activate(obj)
    given = {"animation": "SEQUENCE", "frame_start": 1, "frame_end": 3, "count": 300}
    assert bpy.ops.dapple.remesh(**given) == {"FINISHED"}
    made = bpy.context.object
    assert made.name == "Mball Remeshed"
    assert [one.name for one in made.data.materials] == ["Jade"]
    for frame in (1, 3):
        bpy.context.scene.frame_set(frame)
        places, faces = scenes.shown(made)
        assert len(places) > 200
        assert len(faces) > 400


def test_a_bare_curve_is_told_what_it_needs():
    bpy.ops.curve.primitive_bezier_curve_add()
    for animation in ("KEEP", "SHAPE_KEYS"):
        with pytest.raises(RuntimeError, match="'BézierCurve' has no faces, it is a bare curve"):
            bpy.ops.dapple.remesh(count=100, animation=animation)
    assert len(bpy.data.objects) == 1


def test_a_metaball_of_a_family_names_the_first():
    metaball()
    metaball()
    assert bpy.context.object.name == "Mball.001"
    with pytest.raises(RuntimeError, match=r"'Mball\.001' has no faces.*the first one"):
        bpy.ops.dapple.remesh(count=100)


def test_an_empty_has_no_mesh():
    bpy.ops.object.empty_add()
    with pytest.raises(RuntimeError, match="Needs an active mesh, curve, text or metaball object"):
        bpy.ops.dapple.remesh(count=100)
