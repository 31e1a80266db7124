# SPDX-License-Identifier: GPL-3.0-or-later
"""Add Hair Guides: even beginnings, roots on the surface, attached as Blender's own hair."""

import addon_host
import bpy
import numpy as np
import pytest
import scenes
from scipy.spatial import cKDTree


def guides(obj, **options):
    """Hair object that the operator makes of a scatter."""
    scenes.activate(obj)
    assert bpy.ops.dapple.add_hair_guides(**options) == {"FINISHED"}
    return bpy.context.object


def column(curves, name, kind, width=1):
    attribute = curves.attributes[name]
    values = np.empty(len(attribute.data) * width, dtype=kind)
    attribute.data.foreach_get("vector" if width > 1 else "value", values)
    return values.reshape(-1, width) if width > 1 else values


def world_points(obj, curves=None):
    """Points (n, k, 3) of curves in world space, of hair or of its evaluated curves."""
    curves = curves or obj.data
    matrix = np.array(obj.matrix_world, dtype=np.float64)
    local = column(curves, "position", np.float32, 3).astype(np.float64)
    placed = local @ matrix[:3, :3].T + matrix[:3, 3]
    return placed.reshape(len(curves.curves), -1, 3)


def deformed(obj):
    """The same as Surface Deform places them."""
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return world_points(obj, evaluated.data)


def off_surface(surface, places):
    """Largest distance to the evaluated surface, relative to its size."""
    import dapple3d

    mesh = surface.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    mesh.calc_loop_triangles()
    faces = np.array([one.vertices for one in mesh.loop_triangles])
    vertices = scenes.world_vertices(surface)
    found = dapple3d.project(dapple3d.Surface(vertices, faces), places)
    return np.max(found.distances) / scenes.size(vertices)


def stored(obj, name, kind=np.float32):
    values = np.empty(len(obj.data.vertices), dtype=kind)
    obj.data.attributes[name].data.foreach_get("value", values)
    return values


def suzanne(**place):
    bpy.ops.mesh.primitive_monkey_add(**place)
    return bpy.context.object


def cube():
    bpy.ops.mesh.primitive_cube_add()
    return bpy.context.object


def test_guides_are_attached_as_empty_hair_is():
    surface = cube()
    made = guides(scenes.scattered(surface, 30))
    scenes.activate(surface)
    assert bpy.ops.object.curves_empty_hair_add() == {"FINISHED"}
    own = bpy.context.object
    for name in ("parent", "parent_type", "matrix_parent_inverse", "matrix_world"):
        assert getattr(made, name) == getattr(own, name), name
    assert (made.data.surface, made.data.surface_uv_map) == (surface, own.data.surface_uv_map)
    assert [one.type for one in made.modifiers] == [one.type for one in own.modifiers]
    groups = [[one.bl_idname for one in obj.modifiers[0].node_group.nodes] for obj in (made, own)]
    assert groups[0] == groups[1]
    assert surface.add_rest_position_attribute
    assert made.data.surface_uv_map == "UVMap"


def test_curves_are_in_the_progressive_order_with_ids():
    obj = scenes.scattered(scenes.sphere(), 100)
    order = np.argsort(stored(obj, "dapple_rank"))
    ids = stored(obj, "id", np.int32)[order]
    places = scenes.positions(obj)[order]
    for count in (0, 7, 1000):
        made = guides(obj, count=count, points=5)
        taken = min(count or 100, 100)
        assert (column(made.data, "dapple_id", np.int32) == ids[:taken]).all()
        points = world_points(made)
        assert points.shape == (taken, 5, 3)
        assert np.allclose(points[:, 0], places[:taken], atol=1e-6)


def nearest(points, normals):
    """The smallest distance of two points that are not on two sides of a thin part, as an ear."""
    near = cKDTree(points).query_pairs(np.ptp(points), output_type="ndarray")
    one, other = near[np.einsum("ki,ki->k", *normals[near.T]) > -0.5].T
    return np.linalg.norm(points[one] - points[other], axis=1).min()


@pytest.mark.parametrize("made", [suzanne, scenes.sphere])
def test_every_beginning_is_even(made):
    """Nearest distances of the first m roots, relative to those of m hexagonal cells."""
    surface = made()
    hair = guides(scenes.scattered(surface, 500), count=500)
    roots, tips = world_points(hair)[:, 0], world_points(hair)[:, -1]
    normals = (tips - roots) / np.linalg.norm(tips - roots, axis=1)[:, None]
    area = sum(one.area for one in surface.data.polygons)
    for count, least in ((5, 0.5), (50, 0.5), (500, 0.4)):
        spacing = np.sqrt(2.0 / np.sqrt(3.0) * area / count)
        near = nearest(roots[:count], normals[:count])
        assert near > least * spacing, (count, near / spacing)


@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (2.0, 0.5, -3.0), (-1.0, 1.0, 1.0)])
@pytest.mark.parametrize("made", [cube, suzanne])
def test_guides_stand_on_an_object_of_any_scale(made, scale):
    surface = made()
    surface.scale, surface.rotation_euler, surface.location = scale, (0.3, 0.2, 0.1), (3, -2, 1)
    bpy.context.view_layer.update()
    obj = scenes.scattered(surface, 80)
    hair = guides(obj, length=0.2, points=6)
    points = world_points(hair)
    assert off_surface(surface, points[:, 0]) < 1e-6
    steps = np.diff(points, axis=1)
    assert np.allclose(np.linalg.norm(steps, axis=2), 0.2 / 5, rtol=1e-4)
    order = np.argsort(stored(obj, "dapple_rank"))
    along = scenes.rotations(obj)[order][:, :, 2]
    assert np.allclose(steps[:, 2] / (0.2 / 5), along, atol=1e-4)
    assert np.allclose(deformed(hair), points, atol=1e-5)


@pytest.mark.parametrize("size", [0.02, 2.0, 180.0])
def test_the_length_fits_the_surface_unless_it_is_given(size):
    bpy.ops.mesh.primitive_cube_add(size=size)
    points = world_points(guides(scenes.scattered(bpy.context.object, 10)))
    lengths = np.linalg.norm(points[:, -1] - points[:, 0], axis=1)
    assert np.allclose(lengths, 0.1 * np.sqrt(3.0) * size, rtol=1e-4)


def test_texture_coordinates_are_those_at_the_roots():
    surface = cube()
    hair = guides(scenes.scattered(surface, 60))
    layer, mesh = surface.data.uv_layers.active.uv, surface.data
    mesh.calc_loop_triangles()
    given = column(hair.data, "surface_uv_coordinate", np.float32, 2)
    for uv, root in zip(given, world_points(hair)[:, 0], strict=True):
        offs = []
        for face in mesh.loop_triangles:
            corners = np.array([mesh.vertices[k].co for k in face.vertices], dtype=np.float64)
            weights = np.linalg.lstsq(
                np.vstack([corners.T, np.ones(3)]), np.append(root, 1.0), rcond=None
            )[0]
            if weights.min() > -1e-6 and np.linalg.norm(weights @ corners - root) < 1e-6:
                offs.append(weights @ [layer[k].vector for k in face.loops] - uv)
        assert np.linalg.norm(offs, axis=1).min() < 1e-6


def test_guides_follow_a_surface_that_deforms():
    surface = scenes.tail(levels=0, render_levels=0)
    surface.modifiers.remove(surface.modifiers["Subdivision"])
    unwrap(surface)
    obj = scenes.scattered(surface, 60)
    bpy.context.scene.frame_set(4)  # made while it is bent
    hair = guides(obj)
    order = np.argsort(stored(obj, "dapple_rank"))
    for frame in (1, 4, 6):
        bpy.context.scene.frame_set(frame)
        roots = deformed(hair)[:, 0]
        assert np.allclose(roots, scenes.positions(obj)[order], atol=2e-5), frame
    assert np.abs(roots - world_points(hair)[:, 0]).max() > 0.5


def unwrap(surface):
    scenes.activate(surface)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.uv.lightmap_pack()
    bpy.ops.object.mode_set(mode="OBJECT")


def test_guides_of_a_subdivided_surface_stand_on_the_shown_one():
    surface = scenes.tail(levels=2, render_levels=2)
    unwrap(surface)
    surface.modifiers["Subdivision"].uv_smooth = "NONE"
    obj = scenes.scattered(surface, 60)
    hair = guides(obj)
    order = np.argsort(stored(obj, "dapple_rank"))
    for frame in (1, 6):
        bpy.context.scene.frame_set(frame)
        roots = deformed(hair)[:, 0]
        assert off_surface(surface, roots) < 1e-5
        away = np.linalg.norm(roots - scenes.positions(obj)[order], axis=1)
        assert away.max() < 0.02 * scenes.size(scenes.world_vertices(surface)), away.max()


def test_overlapping_texture_coordinates_are_reported(capfd):
    surface = cube()
    obj = scenes.scattered(surface, 30)
    guides(obj)
    assert "Unwrap" not in capfd.readouterr().out
    scenes.activate(surface)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.uv.reset()  # each face fills the map
    bpy.ops.object.mode_set(mode="OBJECT")
    hair = guides(obj)
    assert "30 guides do not follow the surface" in capfd.readouterr().out
    assert len(hair.data.curves) == 30


def without_uv(surface, obj):
    surface.data.uv_layers.remove(surface.data.uv_layers[0])


def without_points(surface, obj):
    obj.data.clear_geometry()


def other_faces(surface, obj):
    surface.modifiers.new("Subdivision", "SUBSURF")


def without_rest(surface, obj):
    """Other faces, without rest positions, of the same number of vertices as were bound."""
    group = bpy.data.node_groups.new("Ball", "GeometryNodeTree")
    group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    ball = group.nodes.new("GeometryNodeMeshUVSphere")
    sink = group.nodes.new("NodeGroupOutput")
    group.links.new(ball.outputs[0], sink.inputs[0])
    surface.modifiers.new("Ball", "NODES").node_group = group
    scenes.activate(obj)
    obj.dapple.attach_to = "FACES"
    assert bpy.ops.dapple.optimize() == {"FINISHED"}


REFUSED = {
    without_uv: "'Cube' has no UV map.*unwrap it first",
    without_points: "has no points: optimize it first",
    other_faces: "is out of date.*Optimize it first",
    without_rest: "without rest positions",
}


@pytest.mark.parametrize("spoil", REFUSED, ids=lambda one: one.__name__)
def test_what_is_refused_changes_nothing(spoil):
    surface = cube()
    obj = scenes.scattered(surface, 30)
    surface.add_rest_position_attribute = False
    spoil(surface, obj)
    refused(obj, REFUSED[spoil])
    assert not surface.add_rest_position_attribute


def refused(obj, words):
    scenes.activate(obj)
    before = scenes.snapshot(), [one.name for one in bpy.data.hair_curves]
    with pytest.raises(RuntimeError, match=words):
        bpy.ops.dapple.add_hair_guides()
    assert (scenes.snapshot(), [one.name for one in bpy.data.hair_curves]) == before


def test_surfaces_of_several_objects_and_of_other_types_are_refused():
    first, second = cube(), suzanne(location=(4, 0, 0))
    first.select_set(True)
    second.select_set(True)
    assert bpy.ops.dapple.add_scatter(count=30) == {"FINISHED"}
    refused(bpy.context.object, "is made of several objects")
    bpy.ops.object.text_add()
    bpy.context.object.data.extrude = 0.2
    message = "'Text' is a text, and Blender attaches hair to meshes. Object > Convert > Mesh makes"
    refused(scenes.scattered(bpy.context.object, 20), message)


def test_one_undo_removes_the_guides():
    obj = scenes.scattered(cube(), 30)
    surface = obj.dapple.surface.name
    bpy.ops.ed.undo_push(message="Before")
    assert bpy.ops.dapple.add_hair_guides("EXEC_DEFAULT", True, count=5) == {"FINISHED"}
    assert len(bpy.data.hair_curves) == 1
    name = obj.name
    bpy.ops.ed.undo()
    assert len(bpy.data.hair_curves) == 0
    assert bpy.context.object.name == name
    assert not bpy.data.objects[surface].add_rest_position_attribute
    bpy.ops.ed.redo()
    assert len(bpy.data.hair_curves[0].curves) == 5


def test_guides_of_a_scatter_without_changes_to_it():
    obj = scenes.scattered(cube(), 30)
    before = scenes.positions(obj)
    made = guides(obj, count=3)
    assert made.name == f"{obj.name} Hair"
    assert np.array_equal(scenes.positions(obj), before)
    assert not bpy.ops.dapple.add_hair_guides.poll()  # the hair is active


def test_the_only_scatter_of_the_active_surface_is_taken():
    surface = suzanne()
    obj = scenes.scattered(surface, 30)
    hair = guides(surface)
    assert hair.name == f"{obj.name} Hair"
    assert len(hair.data.curves) == 30


def test_one_of_several_scatters_is_chosen():
    surface = suzanne()
    first, second = scenes.scattered(surface, 30), scenes.scattered(surface, 40)
    names = f"'{first.name}', '{second.name}'"
    scenes.activate(surface)
    with pytest.raises(RuntimeError, match=f"has several scatters, {names}: choose one"):
        bpy.ops.dapple.add_hair_guides()
    assert len(guides(surface, scatter=second.name).data.curves) == 40
    scenes.activate(surface)
    with pytest.raises(RuntimeError, match="'Gone' is not a Dapple scatter"):
        bpy.ops.dapple.add_hair_guides(scatter="Gone")


def test_scatters_of_the_active_surface_are_offered():
    surface = suzanne()
    obj = scenes.scattered(surface, 30)
    scenes.scattered(suzanne(location=(4.0, 0.0, 0.0)), 30)
    offered = addon_host.part("blender.hair.operators").scatter_names
    for active in (surface, obj, guides(obj, count=5)):
        scenes.activate(active)
        assert offered(None, bpy.context, "") == [obj.name]
        assert offered(None, bpy.context, "gone") == []


def test_a_surface_without_a_scatter_cannot_have_guides():
    scenes.activate(suzanne())
    assert not bpy.ops.dapple.add_hair_guides.poll()
