# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of faces and of face corners: a face of density 0 has no points, whatever asks for it."""

import math

import addon_host
import bpy
import numpy as np
import pytest
import scenes
from face_scenes import FLAT, choose, cube, on_top, optimized, with_materials

TYPES = ("FLOAT", "INT", "INT8", "BOOLEAN", "FLOAT_COLOR", "BYTE_COLOR")


_NUMPY = {"BOOLEAN": bool, "INT": np.int32, "INT8": np.int32}


def stairs(steps=5):
    """Boxes of an array that rises: treads 0.4 deep, 0.2 apart."""
    bpy.ops.mesh.primitive_cube_add(size=1.0)
    obj = bpy.context.object
    for vertex in obj.data.vertices:
        vertex.co.x, vertex.co.y, vertex.co.z = (
            vertex.co.x * 0.4,
            vertex.co.y * 1.5,
            vertex.co.z * 0.2,
        )
    modifier = obj.modifiers.new("Array", "ARRAY")
    modifier.count, modifier.relative_offset_displace = steps, (1.0, 0.0, 1.0)
    return obj


def with_faces(surface, name, chosen, kind="FLOAT", domain="FACE", full=1.0):
    """An attribute that is full on the polygons that are chosen by their middles, 0 elsewhere."""
    mesh = surface.data
    wanted = np.array([full if chosen(one.center) else 0.0 for one in mesh.polygons])
    if domain == "CORNER":
        wanted = np.repeat(wanted, [one.loop_total for one in mesh.polygons])
    attribute = mesh.attributes.new(name, kind, domain)
    if "COLOR" in kind:
        rows = np.repeat(wanted[:, None], 4, axis=1).astype(np.float32)
        attribute.data.foreach_set("color", rows.ravel())
    else:
        attribute.data.foreach_set("value", wanted.astype(_NUMPY.get(kind, float)))
    mesh.update()
    return surface


def is_top(center):
    return center[2] > 0.9


@pytest.mark.parametrize("domain", ["FACE", "CORNER"])
@pytest.mark.parametrize("kind", TYPES)
def test_all_points_are_on_the_face_that_has_the_attribute(kind, domain):
    surface = with_faces(cube(), "Grass", is_top, kind, domain)
    obj = scenes.scattered(surface, count=300)
    assert on_top(optimized(obj, attribute="Grass")) == 300


@pytest.mark.parametrize("domain", ["FACE", "CORNER"])
def test_no_point_is_on_a_blocked_face(domain):
    surface = with_faces(cube(), "Road", is_top, domain=domain, full=1.0)
    found = optimized(scenes.scattered(surface, count=300), blocked_areas="Road")
    assert len(found) == 300
    assert on_top(found) == 0


@pytest.mark.parametrize("domain", ["FACE", "CORNER"])
def test_points_per_area_count_the_faces_of_full_density_alone(domain):
    surface = with_faces(cube(), "Grass", is_top, domain=domain)
    obj = scenes.scattered(surface, count=30)
    obj.dapple.amount, obj.dapple.points_per_area = "PER_AREA", 100.0
    found = optimized(obj, attribute="Grass")
    assert len(found) == on_top(found) == 400


@pytest.mark.parametrize("domain", ["FACE", "CORNER"])
def test_an_object_type_has_points_on_the_faces_of_its_own_density_alone(domain):
    surface = with_faces(cube(), "Flowers", is_top, domain=domain)
    with_faces(surface, "Stones", lambda center: center[2] < -0.9, domain=domain)
    obj = scenes.scattered(surface, count=300)
    for name in ("Flowers", "", "Stones"):
        bpy.ops.dapple.edit_object_types(action="ADD")
        obj.dapple.object_types[-1].density = name
    found = optimized(obj)
    meshio = addon_host.part("blender.base.mesh_arrays")
    kinds = meshio.read_columns(obj.data, {"dapple_object_type": "INT"})["dapple_object_type"]
    assert np.bincount(kinds).tolist() == [100, 100, 100]
    assert on_top(found[kinds == 0]) == 100
    assert (found[kinds == 2, 2] < -1.0 + FLAT).all()


def test_values_of_vertices_faces_and_corners_are_multiplied():
    surface = with_faces(cube(), "Grass", lambda center: center[2] > -0.5)
    with_faces(surface, "Road", lambda center: center[0] > 0.9, domain="CORNER")
    upper = [1.0 if vertex.co.y > 0.0 else 0.0 for vertex in surface.data.vertices]
    surface.data.attributes.new("Slowly", "FLOAT", "POINT").data.foreach_set("value", upper)
    obj = scenes.scattered(surface, count=300)
    found = optimized(obj, attribute="Grass", blocked_areas="Road")
    assert (found[:, 2] > -1.0 + FLAT).all()
    assert (found[:, 0] < 1.0 - FLAT).all()
    bpy.ops.dapple.edit_object_types(action="ADD")
    obj.dapple.object_types[-1].density = "Slowly"
    found = optimized(obj)
    assert (found[:, 2] > -1.0 + FLAT).all()
    assert (found[:, 0] < 1.0 - FLAT).all()
    assert (found[:, 1] > -1.0 + FLAT).all()


@pytest.mark.parametrize("domain", ["FACE", "CORNER"])
def test_face_values_hold_on_a_mirrored_object_and_on_faces_of_many_corners(domain):
    bpy.ops.mesh.primitive_cylinder_add(vertices=9)
    surface = with_faces(bpy.context.object, "Grass", is_top, domain=domain)
    surface.scale = (-1.0, 2.0, 1.0)
    bpy.context.view_layer.update()
    obj = scenes.scattered(surface, count=200)
    assert on_top(optimized(obj, attribute="Grass")) == 200


def test_corner_values_fall_off_within_a_face():
    surface = cube()
    mesh = surface.data
    attribute = mesh.attributes.new("Shade", "FLOAT", "CORNER")
    top = next(one for one in mesh.polygons if is_top(one.center))
    for loop in top.loop_indices:
        place = mesh.vertices[mesh.loops[loop].vertex_index].co
        attribute.data[loop].value = 1.0 if place.x > 0.0 else 0.0
    found = optimized(scenes.scattered(surface, count=400), attribute="Shade")
    assert on_top(found) == 400
    assert (found[:, 0] > 0.0).mean() == pytest.approx(0.75, abs=0.03)


def test_face_values_pass_modifiers():
    surface = with_faces(cube(), "Grass", is_top)
    surface.modifiers.new("Subdivision", "SUBSURF").levels = 2
    surface.modifiers["Subdivision"].subdivision_type = "SIMPLE"
    obj = scenes.scattered(surface, count=300)
    assert on_top(optimized(obj, attribute="Grass")) == 300


def test_face_values_of_parts_count_on_a_joined_surface():
    first = with_faces(cube(), "Grass", is_top)
    bpy.ops.mesh.primitive_cube_add(location=(5.0, 0.0, 0.0))
    second = with_faces(bpy.context.object, "Grass", is_top)
    first.select_set(True)
    second.select_set(True)
    bpy.context.view_layer.objects.active = first
    assert bpy.ops.dapple.add_scatter(count=200) == {"FINISHED"}
    found = optimized(bpy.context.object, attribute="Grass")
    assert on_top(found) == 200
    assert (found[:, 0] > 2.5).sum() == 100


def test_slope_has_no_points_on_the_walls_of_a_cube():
    found = optimized(scenes.scattered(cube(), count=300), use_slope=True)
    assert on_top(found) == 300


def test_slope_has_points_on_the_treads_of_stairs_alone():
    obj = scenes.scattered(stairs(), count=300)
    found = optimized(obj, use_slope=True, slope_max=math.radians(45))
    heights = 0.1 + 0.2 * np.arange(5)
    assert len(found) == 300
    assert np.abs(found[:, 2, None] - heights).min(axis=1).max() < FLAT


def test_slope_finds_walls_alone():
    obj = scenes.scattered(cube(), count=300)
    found = optimized(obj, use_slope=True, slope_min=math.radians(80), slope_max=math.radians(100))
    assert (np.abs(found[:, 2]) < 1.0 - FLAT).all()


def test_the_colors_of_a_density_end_at_the_edges_of_faces():
    obj = scenes.scattered(with_faces(cube(), "Grass", is_top), count=50)
    optimized(obj, attribute="Grass")
    overlay = addon_host.part("blender.density.overlay")
    overlay.start(obj)
    places, colors = (one.reshape(-1, 3, one.shape[1]) for one in overlay.triangles())
    overlay.stop()
    top = (places[:, :, 2] > 0.99).all(axis=1)
    assert top.sum() == 2
    assert (colors[top, :, 0] > 0.9).all(), "yellow"
    assert (colors[~top, :, 0] < 0.2).all(), "dark"


@pytest.mark.parametrize("lift", [0.0, 0.1, 123.4])
def test_a_sharp_height_has_no_points_on_the_walls_below_a_floor(lift):
    surface = cube()
    surface.location.z = lift
    bpy.context.view_layer.update()
    obj = scenes.scattered(surface, count=300)
    found = optimized(
        obj, use_height=True, height_min=lift + 1.0, height_max=lift + 2.0, height_falloff=0.0
    )
    assert on_top(found - [0.0, 0.0, lift]) == 300


def test_a_face_of_no_density_gets_no_points_while_points_are_kept(live):
    surface = with_faces(cube(), "Road", is_top)
    obj = scenes.scattered(surface, count=300)
    optimized(obj)
    obj.dapple.auto_update_mode = "ON"
    obj.dapple.density.blocked_areas = "Road"
    assert live.settle() > 0
    assert on_top(scenes.positions(obj)) == 0
    assert len(scenes.positions(obj)) == 300
    values = [0.0 if is_top(one.center) else 1.0 for one in surface.data.polygons]
    surface.data.attributes["Road"].data.foreach_set("value", values)
    surface.data.update()
    assert live.settle() > 0
    assert on_top(scenes.positions(obj)) == 300


def test_an_attribute_on_edges_is_refused_in_a_sentence():
    surface = cube()
    surface.data.attributes.new("Rim", "FLOAT", "EDGE")
    obj = scenes.scattered(surface, count=50)
    obj.dapple.density.attribute = "Rim"
    said = "attribute 'Rim' is on the domain Edge: a density is one on Vertex, Face or Face Corner"
    with pytest.raises(RuntimeError, match=said):
        bpy.ops.dapple.optimize()


@pytest.mark.parametrize(
    ("domain", "said"), [("FACE", "'Grass' is -1 at face 2"), ("CORNER", "-1 at face corner 8")]
)
def test_a_value_that_is_no_density_is_named_where_it_is(domain, said):
    surface = cube()
    values = np.ones(6 if domain == "FACE" else 24)
    values[2 if domain == "FACE" else 8] = -1.0
    surface.data.attributes.new("Grass", "FLOAT", domain).data.foreach_set("value", values)
    obj = scenes.scattered(surface, count=50)
    obj.dapple.density.attribute = "Grass"
    with pytest.raises(RuntimeError, match=said):
        bpy.ops.dapple.optimize()


def test_the_number_of_a_material_is_no_density():
    surface = with_materials(cube(), lambda center: int(is_top(center)))
    obj = scenes.scattered(surface, count=50)
    weights = addon_host.part("blender.surface.values")
    assert "material_index" not in weights.weight_names(surface)
    obj.dapple.density.attribute = "material_index"
    with pytest.raises(RuntimeError, match="is the number of a material and no density"):
        bpy.ops.dapple.optimize()


def test_values_of_faces_and_corners_are_of_their_triangles():
    bpy.ops.mesh.primitive_cylinder_add(vertices=7)
    surface = bpy.context.object
    for domain in ("FACE", "CORNER"):
        with_faces(surface, domain, is_top, domain=domain)
    surface.scale = (-1.0, 1.0, 2.0)
    bpy.context.view_layer.update()
    with_materials(surface, lambda center: int(is_top(center)))
    obj = scenes.scattered(surface, count=20)
    density = obj.dapple.density
    density.attribute, density.blocked_areas, density.use_material = "FACE", "CORNER", True
    choose(obj, "Grass")
    settings = addon_host.part("blender.scatter.object").settings_of(obj)
    found = addon_host.part("blender.surface.reading").read(surface, settings, obj)
    assert sorted(found.weights) == ["CORNER", "FACE", "material_index"]
    for name, values in found.weights.items():
        assert values.shape == (len(found.faces), 3 if name == "CORNER" else 1)
    assert sorted(found.digests) == sorted(found.weights)


def test_the_panel_says_that_values_of_faces_were_changed():
    stale = addon_host.part("blender.freshness.staleness").stale_reason
    surface = with_faces(cube(), "Grass", is_top)
    obj = scenes.scattered(surface, count=50)
    optimized(obj, attribute="Grass")
    assert stale(obj, bpy.context) == ""
    surface.data.attributes["Grass"].data[0].value = 1.0
    surface.data.update()
    assert stale(obj, bpy.context) == "Values of 'Grass' were changed: optimize again"


def in_frames(obj, frames):
    found = []
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        found.append(scenes.positions(obj))
    return found


def bent_grid(frames=5):
    """A grid of 8 by 8 faces that shape keys bend, flat where x < 0 in its own space."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=8, y_subdivisions=8, size=2.0)
    surface = bpy.context.object
    surface.shape_key_add(name="Basis")
    key = surface.shape_key_add(name="Bent")
    for place, vertex in zip(key.data, surface.data.vertices, strict=True):
        place.co.x = vertex.co.x * (1.0 + 0.8 * max(vertex.co.x, 0.0))
        place.co.z = 0.5 * vertex.co.x * vertex.co.y
    for frame, value in ((1, 0.0), (frames, 1.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    bpy.context.scene.frame_end = frames
    bpy.context.scene.frame_set(1)
    return surface


@pytest.mark.parametrize("domain", ["FACE", "CORNER"])
@pytest.mark.parametrize("population", ["KEEP_COUNT", "KEEP_DENSITY"])
def test_a_bake_has_no_point_on_a_face_of_no_density(domain, population):
    surface = with_faces(bent_grid(), "Grass", lambda center: center[0] > 0.0, domain=domain)
    obj = scenes.scattered(surface, count=150)
    obj.dapple.population = population
    optimized(obj, attribute="Grass")
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    for found in in_frames(obj, range(1, 6)):
        assert found[:, 0].min() > -FLAT


def test_a_bake_keeps_to_a_material():
    surface = with_materials(bent_grid(), lambda center: int(center[0] > 0.0))
    obj = scenes.scattered(surface, count=100)
    choose(obj, "Grass")
    optimized(obj, use_material=True)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    for found in in_frames(obj, range(1, 6)):
        assert found[:, 0].min() > -FLAT
    stale = addon_host.part("blender.freshness.staleness").stale_reason
    assert stale(obj, bpy.context) == ""


def test_a_bend_that_cuts_quads_otherwise_does_not_change_corner_values():
    surface = with_faces(bent_grid(), "Grass", lambda center: center[0] > 0.0, domain="CORNER")
    obj = scenes.scattered(surface, count=60)
    optimized(obj, attribute="Grass")
    contents = addon_host.part("blender.freshness.content_changes")
    present = addon_host.part("blender.freshness.scene_snapshot").SceneSnapshot
    for frame in (1, 5):
        bpy.context.scene.frame_set(frame)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        said, _ = contents.contents(obj, present().sources(obj, depsgraph))
        assert not [one for one in said if "Grass" in one]


def melting(frames=4):
    """A grid that nodes cut finer by the frame, with an attribute on the faces where x > 0."""
    builder = addon_host.part("nodes.builder")
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=4, y_subdivisions=4, size=2.0)
    surface = with_faces(bpy.context.object, "Grass", lambda center: center[0] > 0.0)
    modifier = surface.modifiers.new("Subdivision", "SUBSURF")
    modifier.subdivision_type = "SIMPLE"
    for frame in range(1, frames + 1):
        modifier.levels = modifier.render_levels = 1 + frame % 2
        modifier.keyframe_insert("levels", frame=frame)
        modifier.keyframe_insert("render_levels", frame=frame)
    for curve in scenes.curves(surface):
        for point in curve.keyframe_points:
            point.interpolation = "CONSTANT"
    bpy.context.scene.frame_end = frames
    bpy.context.scene.frame_set(1)
    assert builder is not None
    return surface


@pytest.mark.parametrize("population", ["KEEP_COUNT", "KEEP_DENSITY"])
def test_new_faces_of_no_density_get_no_points_in_a_bake(population):
    surface = melting()
    obj = scenes.scattered(surface, count=100)
    obj.dapple.new_topology, obj.dapple.population = "REATTACH", population
    obj.dapple.attach_to = "FACES"
    optimized(obj, attribute="Grass")
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    for found in in_frames(obj, range(1, 5)):
        assert found[:, 0].min() > -FLAT


def wandering(frames=5):
    """A grid whose nodes store a belt of density 1 that moves along x with the frame."""
    surface = melting(frames)
    surface.data.attributes.remove(surface.data.attributes["Grass"])
    builder = addon_host.part("nodes.builder")
    geometry = [("Geometry", "NodeSocketGeometry")]
    tree = builder.new_group("Belt", geometry, geometry)
    b = builder.Builder(tree)
    place = b.node("ShaderNodeSeparateXYZ", b.out("GeometryNodeInputPosition")).outputs["X"]
    frame = tree.nodes.new("GeometryNodeInputSceneTime").outputs["Frame"]
    edge = b.number("MULTIPLY_ADD", frame, 0.25, -1.0)
    made = b.compare("GREATER_THAN", place, edge, "FLOAT")
    store = tree.nodes.new("GeometryNodeStoreNamedAttribute")
    store.domain, store.data_type = "FACE", "FLOAT"
    store.inputs["Name"].default_value = "Grass"
    tree.links.new(b.input("Geometry"), store.inputs["Geometry"])
    value = next(one for one in store.inputs if one.name == "Value" and one.enabled)
    tree.links.new(made, value)
    b.output("Geometry", store.outputs[0])
    surface.modifiers.new("Belt", "NODES").node_group = tree
    return surface


@pytest.mark.parametrize("population", ["KEEP_COUNT", "KEEP_DENSITY"])
def test_points_leave_faces_that_have_no_density_once_the_faces_change(population):
    surface = wandering()
    obj = scenes.scattered(surface, count=100)
    obj.dapple.new_topology, obj.dapple.population = "REATTACH", population
    obj.dapple.attach_to = "FACES"
    optimized(obj, attribute="Grass")
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    for frame, found in zip(range(1, 6), in_frames(obj, range(1, 6)), strict=True):
        edge = 0.25 * frame - 1.0
        assert found[:, 0].min() > edge - 0.25 - FLAT, frame
