# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces that are parented, mirrored, modified, hidden, deleted or in other modes."""

import addon_host
import bmesh
import bpy
import numpy as np
import probe
import pytest
import scenes

dapple = pytest.importorskip("dapple3d")


def arrays_of(surface):
    reading = addon_host.part("blender.surface.mesh")
    return reading.read_mesh(surface)


def fits(surface, obj, count=60):
    """All instances are on the surface and point outward."""
    found, arrays = scenes.positions(obj), arrays_of(surface)
    assert len(found) == count
    nearest = dapple.project(dapple.Surface(arrays.vertices, arrays.faces), found)
    assert nearest.distances.max() < 1e-5 * scenes.size(arrays.vertices)
    corners = arrays.vertices[arrays.faces[nearest.faces]]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    up = scenes.instance_matrices(obj)[:, :3, 2]
    assert np.einsum("nd,nd->n", normals, up).min() > 0.0
    assert scenes.node_warnings(obj) == []
    return True


def reason(obj):
    return addon_host.part("blender.freshness.staleness").stale_reason(obj, bpy.context)


def of_mesh(*data):
    mesh = bpy.data.meshes.new("Drawn")
    mesh.from_pydata(*data)
    obj = bpy.data.objects.new("Drawn", mesh)
    bpy.context.collection.objects.link(obj)
    return obj


def parent(scale):
    made = bpy.data.objects.new("Parent", None)
    bpy.context.collection.objects.link(made)
    made.scale, made.rotation_euler, made.location = scale, (1.0, 0.2, 0.3), (4.0, 5.0, 6.0)
    return made


@pytest.mark.parametrize("scale", [(1, 3, 0.5), (-1, 3, 0.5)])
def test_a_surface_under_a_parent_that_shears_it(scale):
    above = parent(scale)
    surface = scenes.sphere(rotation=(0.5, 0.6, 0.7), scale=(1, 1, 2))
    surface.parent = above
    bpy.context.view_layer.update()
    obj = scenes.scattered(surface)
    assert fits(surface, obj)
    # the scatter itself may be a child of the surface
    obj.parent, obj.location = surface, (1, 1, 1)
    bpy.context.view_layer.update()
    assert fits(surface, obj)
    above.rotation_euler = (0.1, 0.2, 0.9)
    bpy.context.view_layer.update()
    assert fits(surface, obj)
    assert reason(obj) == ""
    for action in (bpy.ops.dapple.optimize, bpy.ops.dapple.reattach, bpy.ops.dapple.bake):
        assert action() == {"FINISHED"}
        assert fits(surface, obj)


MODIFIERS = {
    "ARRAY": {},
    "BEVEL": {},
    "DECIMATE": {"ratio": 0.5},
    "MIRROR": {"use_axis": (True, False, True)},
    "REMESH": {"voxel_size": 0.2},
    "SOLIDIFY": {"thickness": 0.1},
    "SUBSURF": {"levels": 2, "render_levels": 2},
    "TRIANGULATE": {},
}


@pytest.mark.parametrize("kind", MODIFIERS)
def test_a_modified_surface_is_taken_as_it_looks(kind):
    surface = scenes.sphere(scale=(1, 1, 1.5))
    modifier = surface.modifiers.new(kind, kind)
    for name, value in MODIFIERS[kind].items():
        setattr(modifier, name, value)
    obj = scenes.scattered(surface)
    assert fits(surface, obj)
    assert reason(obj) == ""


LOOSE = (
    [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (9, 9, 9), (9, 9, 8), (0, 0, 7)],
    [(4, 5)],
    [(0, 1, 2, 3)],
)
CONCAVE = ([(0, 0, 0), (4, 0, 0), (4, 4, 0), (2, 1, 0), (0, 4, 0)], [], [(0, 1, 2, 3, 4)])


@pytest.mark.parametrize("data", [LOOSE, CONCAVE])
def test_loose_parts_get_no_points_and_concave_faces_are_kept_to(data):
    surface = of_mesh(*data)
    assert fits(surface, scenes.scattered(surface))


def test_a_surface_that_lost_its_faces_is_named():
    surface = scenes.sphere()
    scenes.scattered(surface)
    surface.data.clear_geometry()
    surface.data.vertices.add(3)
    before = scenes.snapshot()
    for action in (bpy.ops.dapple.optimize, bpy.ops.dapple.reattach):
        with pytest.raises(RuntimeError, match="Surface 'Sphere' has no faces at frame 1"):
            action()
        assert scenes.snapshot() == before


def nodes_on(surface, *kinds):
    """A node group of these nodes one behind the other, as a modifier."""
    group = bpy.data.node_groups.new("Nodes", "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        group.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    before = group.nodes.new("NodeGroupInput").outputs[0]
    made = []
    for kind in kinds:
        node = group.nodes.new(kind)
        group.links.new(before, node.inputs[0])
        before = node.outputs[0]
        made.append(node)
    group.links.new(before, group.nodes.new("NodeGroupOutput").inputs[0])
    surface.modifiers.new("Nodes", "NODES").node_group = group
    return group, made


def test_points_follow_a_bare_curve_once_it_has_the_faces_that_the_message_asks_for():
    bpy.ops.curve.primitive_bezier_curve_add()
    curve = bpy.context.object
    with pytest.raises(RuntimeError, match="it is a bare curve: give it a little Extrude"):
        bpy.ops.dapple.add_scatter(count=20)
    assert bpy.context.object == curve
    curve.data.extrude = 0.001
    assert bpy.ops.dapple.add_scatter(count=20) == {"FINISHED"}
    found = scenes.positions(bpy.context.object)
    found = found[np.argsort(found[:, 0])]
    gaps = np.linalg.norm(np.diff(found, axis=0), axis=1)
    assert gaps.std() < 0.02 * gaps.mean()


def test_a_surface_of_instances_says_what_to_do():
    surface = scenes.sphere()
    obj = scenes.scattered(surface)
    nodes_on(surface, "GeometryNodeGeometryToInstance")
    before = scenes.snapshot()
    words = "Surface 'Sphere' has no faces at frame 1, only instances: add Realize Instances"
    with pytest.raises(RuntimeError, match=words):
        bpy.ops.dapple.optimize()
    assert scenes.snapshot() == before
    surface.modifiers.clear()
    nodes_on(surface, "GeometryNodeGeometryToInstance", "GeometryNodeRealizeInstances")
    bpy.ops.dapple.optimize()
    assert fits(surface, obj)


@pytest.mark.parametrize("topology", ["STOP", "REATTACH"])
def test_a_frame_of_a_bake_without_faces_is_named(topology):
    surface = scenes.sphere()
    obj = scenes.scattered(surface)
    obj.dapple.new_topology = topology
    group, (delete,) = nodes_on(surface, "GeometryNodeDeleteGeometry")
    time, later = group.nodes.new("GeometryNodeInputSceneTime"), group.nodes.new("ShaderNodeMath")
    later.operation = "GREATER_THAN"
    later.inputs[1].default_value = 2.5
    group.links.new(time.outputs["Frame"], later.inputs[0])
    group.links.new(later.outputs[0], delete.inputs["Selection"])
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, 4
    with pytest.raises(RuntimeError, match="Surface 'Sphere' has no faces at frame 3"):
        bpy.ops.dapple.bake()


def test_a_scatter_is_no_surface():
    surface = scenes.sphere()
    first, second = scenes.scattered(surface), scenes.scattered(surface)
    before = scenes.snapshot()
    for wrong in (first, second):
        second.dapple.surface = wrong
        for name in ("optimize", "reattach", "bake", "make_tiles", "live_preview"):
            with pytest.raises(RuntimeError, match=f"'{wrong.name}' of '{second.name}' is a scat"):
                getattr(bpy.ops.dapple, name)()
    assert scenes.snapshot() == before
    second.dapple.surface = surface
    assert bpy.ops.dapple.optimize() == {"FINISHED"}


def test_two_scatters_on_one_surface_are_solved_one_by_one():
    surface = scenes.sphere()
    first, second = scenes.scattered(surface), scenes.scattered(surface)
    expected = scenes.positions(first)
    second.dapple.count = 30
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert fits(surface, second, 30)
    assert (scenes.positions(first) == expected).all()


def test_a_scatter_without_any_extent_is_refused_before_something_is_lost():
    obj = scenes.scattered(scenes.tail(frames=2))
    bpy.context.scene.frame_end = 2
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    obj.scale.x = 0.0
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError, match="'Tail Scatter' has a scale of 0"):
        bpy.ops.dapple.optimize()
    assert obj.dapple.baked_keys == 2


def test_what_is_edited_counts_before_edit_mode_is_left():
    surface = scenes.sphere()
    obj = scenes.scattered(surface)
    bpy.context.view_layer.objects.active = surface
    bpy.ops.object.mode_set(mode="EDIT")
    edited = bmesh.from_edit_mesh(surface.data)
    for vertex in edited.verts:
        vertex.co.x *= 3.0
    bmesh.update_edit_mesh(surface.data)
    assert np.ptp(arrays_of(surface).vertices[:, 0]) > 5.9
    assert fits(surface, obj)
    for name in ("add_scatter", "optimize", "bake", "reattach", "make_tiles", "clear_bake"):
        assert not getattr(bpy.ops.dapple, name).poll()
    below = [vertex for vertex in edited.verts if vertex.co.z > 0.1]
    bmesh.ops.delete(edited, geom=below, context="VERTS")
    bmesh.update_edit_mesh(surface.data)
    assert reason(obj).startswith("Attached to 266 vertices, the surface has 1")
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert fits(surface, obj)


@pytest.mark.parametrize("mode", ["SCULPT", "WEIGHT_PAINT", "VERTEX_PAINT"])
def test_a_surface_that_is_sculpted_or_painted_can_be_scattered_on(mode):
    surface = scenes.sphere()
    obj = scenes.scattered(surface)
    bpy.context.view_layer.objects.active = surface
    bpy.ops.object.mode_set(mode=mode)
    assert not bpy.ops.dapple.add_scatter.poll()
    bpy.context.view_layer.objects.active = obj
    obj.dapple.count = 40
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert fits(surface, obj, 40)
    assert surface.mode == mode


def test_a_scatter_in_edit_mode_keeps_its_bake():
    obj = scenes.scattered(scenes.tail(frames=2))
    bpy.context.scene.frame_end = 2
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    bpy.ops.object.mode_set(mode="EDIT")
    for name in ("optimize", "bake", "reattach", "make_tiles", "clear_bake", "select_overlap"):
        assert not getattr(bpy.ops.dapple, name).poll()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert len(scenes.positions(obj)) == 60


def hidden(surface):
    surface.hide_set(True)


def switched_off(surface):
    surface.hide_viewport = True


def excluded(surface):
    collection = bpy.data.collections.new("Aside")
    bpy.context.scene.collection.children.link(collection)
    collection.objects.link(surface)
    bpy.context.scene.collection.objects.unlink(surface)
    bpy.context.view_layer.layer_collection.children["Aside"].exclude = True


@pytest.mark.parametrize("aside", [hidden, switched_off, excluded])
def test_a_surface_that_is_not_shown_is_a_surface_all_the_same(aside):
    surface = scenes.tail(frames=3)
    bpy.context.scene.frame_end = 3
    obj = scenes.scattered(surface)
    surface.name = "Renamed"
    aside(surface)
    obj.dapple.count = 30
    for action in (bpy.ops.dapple.optimize, bpy.ops.dapple.reattach, bpy.ops.dapple.bake):
        assert action() == {"FINISHED"}
        bpy.context.scene.frame_set(2)
        assert fits(surface, obj, 30)
        assert reason(obj) == ""


def test_a_surface_that_was_deleted_is_said():
    surface = scenes.sphere()
    obj = scenes.scattered(surface)
    scenes.activate(surface)
    assert bpy.ops.object.delete() == {"FINISHED"}
    assert reason(obj) == "Surface 'Sphere' was deleted or is in no collection: choose another one"
    obj.dapple.surface = scenes.sphere()
    scenes.activate(obj)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert reason(obj) == ""


def test_operators_are_off_without_a_scatter_or_a_mesh():
    named = {f"{verb}_scatter" for verb in ("copy", "remove", "select", "solo")}
    # these operators receive the objects as arguments
    named |= {"select_surface", "add_over_collection"}
    names = sorted(set(dir(bpy.ops.dapple)) - {"add_asset_library", "remove_preset"} - named)
    assert "optimize" in names
    light = bpy.data.objects.new("Light", bpy.data.lights.new("Light", "POINT"))
    bpy.context.collection.objects.link(light)
    for active in (None, light):
        bpy.context.view_layer.objects.active = active
        assert not [name for name in names if getattr(bpy.ops.dapple, name).poll()]


def test_a_hidden_scatter_is_solved():
    obj = scenes.scattered(scenes.sphere())
    obj.hide_set(True)
    obj.dapple.count = 20
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    obj.hide_set(False)
    assert len(scenes.positions(obj)) == 20


def pipe():
    bpy.ops.curve.primitive_bezier_circle_add()
    bpy.context.object.data.bevel_depth = 0.2
    return bpy.context.object


def title():
    bpy.ops.object.text_add()
    return bpy.context.object


def nurbs():
    bpy.ops.surface.primitive_nurbs_surface_sphere_add()
    return bpy.context.object


@pytest.mark.parametrize("make", [pipe, title, nurbs])
def test_curves_and_texts_are_surfaces_too(make):
    bpy.context.scene.frame_end = 2
    surface = make()
    surface.scale, surface.rotation_euler = (1.0, 1.5, 1.0), (0.4, 0.2, 0.1)
    bpy.context.view_layer.update()
    obj = scenes.scattered(surface)
    obj.dapple.seed = 2
    for action in (bpy.ops.dapple.optimize, bpy.ops.dapple.bake, bpy.ops.dapple.make_tiles):
        assert action() == {"FINISHED"}
        assert fits(surface, obj)
        assert reason(obj) == ""
    surface.location.z = 5.0
    bpy.context.view_layer.update()
    assert fits(surface, obj)
    assert addon_host.part("blender.surface.values").weight_names(surface) == []


@pytest.mark.parametrize(
    ("make", "name"),
    [
        (pipe, "render_resolution_u"),
        (title, "render_resolution_u"),
        (nurbs, "render_resolution_v"),
    ],
)
def test_another_resolution_in_the_render_is_refused_and_matched(make, name):
    surface = make()
    setattr(surface.data, name, 20)
    before = scenes.snapshot()
    data = len(bpy.data.curves)
    with pytest.raises(RuntimeError, match=r"in the render \(Resolution: .*Match Subdivision"):
        bpy.ops.dapple.add_scatter(count=60)
    assert scenes.snapshot() == before
    assert len(bpy.data.curves) == data
    assert bpy.ops.dapple.match_subdivision() == {"FINISHED"}
    obj = scenes.scattered(surface)
    with probe.registered():
        seen = probe.render(obj, 1)
    assert np.abs(seen["positions"] - scenes.positions(obj)).max() < 1e-6


def test_what_is_no_mesh_has_no_rest_position():
    title()
    before = scenes.snapshot()
    with pytest.raises(RuntimeError, match="'Text' is not a mesh and has no rest position"):
        bpy.ops.dapple.add_scatter(attach_to="REST")
    assert scenes.snapshot() == before


def test_metaballs_are_surfaces_too():
    obj = scenes.scattered(scenes.sphere())
    bpy.ops.object.metaball_add()
    obj.dapple.surface = bpy.context.object
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert fits(obj.dapple.surface, obj)
    assert reason(obj) == ""


def test_a_light_is_no_surface():
    obj = scenes.scattered(scenes.sphere())
    obj.dapple.surface = bpy.data.objects.new("Light", bpy.data.lights.new("Light", "POINT"))
    with pytest.raises(RuntimeError, match="'Light' of 'Sphere Scatter' is a light"):
        bpy.ops.dapple.optimize()
