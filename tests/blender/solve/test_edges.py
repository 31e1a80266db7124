# SPDX-License-Identifier: GPL-3.0-or-later
"""Points along edges of a surface."""

import math

import addon_host
import bpy
import numpy as np
import pytest
import scenes


def cube(size=2.0):
    """Active cube."""
    bpy.ops.mesh.primitive_cube_add(size=size)
    return bpy.context.object


def grid(parts=4, size=4.0):
    """Active flat grid."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=parts, y_subdivisions=parts, size=size)
    return bpy.context.object


def on_edges(surface, count, **settings):
    """A scatter along the edges of a surface."""
    return along_edges(scenes.scattered(surface, count=10), count, **settings)


def along_edges(obj, count, **settings):
    """A scatter, moved to the edges of its surface."""
    obj.dapple.scatter_on, obj.dapple.count = "EDGES", count
    for name, value in settings.items():
        setattr(obj.dapple, name, value)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    return obj


def places(obj):
    return scenes.positions(obj)


def axes(obj):
    """Unit X and Z axes of the instances."""
    matrices = scenes.instance_matrices(obj)[:, :3, :3]
    found = matrices / np.linalg.norm(matrices, axis=1, keepdims=True)
    return found[:, :, 0], found[:, :, 2]


def test_points_are_evenly_on_all_edges_of_a_cube():
    found = places(on_edges(cube(), 60))
    assert len(found) == 60
    on = np.isclose(np.abs(found), 1.0, atol=1e-5).sum(axis=1)
    assert (on == 2).all()
    free = np.sort(np.abs(found).min(axis=1))
    assert free == pytest.approx(np.repeat([0.0, 0.4, 0.8], [12, 24, 24]), abs=1e-5)


def test_edges_begin_with_fewer_points():
    """A thousand of them made the twelve edges of a cube solid lines."""
    cube()
    assert bpy.ops.dapple.add_scatter() == {"FINISHED"}
    obj = bpy.context.object
    obj.dapple.scatter_on = "EDGES"
    assert obj.dapple.count == 100
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert len(places(obj)) == 100
    obj.dapple.scatter_on = "SURFACE"
    assert obj.dapple.count == 1000
    obj.dapple.scatter_on = "EDGES"
    assert obj.dapple.count == 100


@pytest.mark.parametrize("count", [30, 100, 1000])
def test_a_chosen_number_of_points_stays(count):
    obj = scenes.scattered(cube(), count=count)
    for where in ("EDGES", "SURFACE", "EDGES"):
        obj.dapple.scatter_on = where
        assert obj.dapple.count == count


@pytest.mark.parametrize("count", [30, 100, 1000])
def test_a_number_that_is_chosen_on_edges_stays(count):
    obj = scenes.scattered(cube(), count=10)
    obj.dapple.property_unset("count")
    obj.dapple.scatter_on = "EDGES"
    obj.dapple.count = count
    for where in ("SURFACE", "EDGES"):
        obj.dapple.scatter_on = where
        assert obj.dapple.count == count


def test_files_and_undo_know_that_no_number_was_chosen(tmp_path):
    obj = scenes.scattered(cube(), count=10)
    obj.dapple.property_unset("count")
    bpy.ops.ed.undo_push(message="Before")
    obj.dapple.scatter_on = "EDGES"
    bpy.ops.ed.undo_push(message="Edges")
    bpy.ops.ed.undo()
    assert bpy.context.object.dapple.count == 1000
    bpy.ops.ed.redo()
    assert bpy.context.object.dapple.count == 100
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "edges.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "edges.blend"))
    bpy.context.object.dapple.scatter_on = "SURFACE"
    assert bpy.context.object.dapple.count == 1000


def test_going_to_edges_and_back_names_that_alone():
    """Ten settings were listed as changed that nobody had touched."""
    obj = scenes.scattered(cube(), count=60)
    obj.dapple.symmetry = "X"
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    obj.dapple.scatter_on = "EDGES"
    assert reason(obj) == "Settings were changed (Scatter On): optimize again"
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    obj.dapple.scatter_on = "SURFACE"
    assert reason(obj) == "Settings were changed (Scatter On): optimize again"


def test_until_it_is_solved_the_panel_tells_of_the_points_that_are_there():
    """Those on edges were said to have an area variation of 0 %."""
    obj = scenes.scattered(cube(), count=60)
    lines = addon_host.part("blender.solve.results_panel")
    obj.dapple.scatter_on = "EDGES"
    assert "of ideal" in lines.result_lines(obj, bpy.context)[0][0]
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    on_edges = lines.result_lines(obj, bpy.context)[0][0]
    assert on_edges.startswith("60 instances, 40 cm apart")
    obj.dapple.scatter_on = "SURFACE"
    assert lines.result_lines(obj, bpy.context)[0][0] == "60 instances, 40 cm apart"
    assert not any("Area" in text for text, _ in lines.figure_lines(obj))


def test_things_stand_between_the_faces_and_follow_the_edge():
    obj = on_edges(cube(), 60)
    found, (ahead, normal) = places(obj), axes(obj)
    along = np.abs(found).argmin(axis=1)
    rows = np.arange(60)
    assert np.abs(ahead[rows, along]) == pytest.approx(1.0, abs=1e-5)
    outward = np.where(np.isclose(np.abs(found), 1.0, atol=1e-5), np.sign(found), 0.0)
    assert (normal * outward).sum(axis=1) / math.sqrt(2.0) == pytest.approx(1.0, abs=1e-5)


def test_posts_stand_upright_along_a_border():
    obj = on_edges(grid(), 32, edge_creases=False)
    found, (ahead, normal) = places(obj), axes(obj)
    assert np.abs(found[:, :2]).max(axis=1) == pytest.approx(2.0, abs=1e-5)
    assert normal[:, 2] == pytest.approx(1.0, abs=1e-5)
    assert np.abs(ahead[:, :2]).max(axis=1) == pytest.approx(1.0, abs=1e-5)


def marked(surface, mark, chosen):
    """Mark the edges of a mesh whose two ends meet a condition."""
    mesh = surface.data
    for edge in mesh.edges:
        if all(chosen(mesh.vertices[k].co) for k in edge.vertices):
            setattr(edge, mark, True)
    return surface


ONLY = {"edge_creases": False, "edge_borders": False}


@pytest.mark.parametrize(
    ("mark", "setting"), [("use_seam", "edge_seams"), ("use_edge_sharp", "edge_sharp")]
)
def test_marked_edges_alone(mark, setting):
    surface = marked(grid(), mark, lambda place: abs(place.x - 1.0) < 1e-6)
    found = places(on_edges(surface, 8, **ONLY, **{setting: True}))
    assert found[:, 0] == pytest.approx(1.0, abs=1e-6)
    assert np.sort(found[:, 1]) == pytest.approx(np.linspace(-1.75, 1.75, 8), abs=1e-5)


def test_borders_of_materials():
    surface = grid()
    for name in ("Lawn", "Path", "Lawn"):
        surface.data.materials.append(bpy.data.materials.get(name) or bpy.data.materials.new(name))
    for polygon in surface.data.polygons:
        x = polygon.center.x
        polygon.material_index = 0 if x < -1.0 else 2 if x < 0.0 else 1
    found = places(on_edges(surface, 8, **ONLY, edge_materials=True))
    assert found[:, 0] == pytest.approx(0.0, abs=1e-6)


def test_marked_edges_where_faces_are_cut_for_a_mask():
    surface = marked(grid(), "use_seam", lambda place: abs(place.x) < 1e-6)
    obj = scenes.scattered(surface, count=10)
    density = obj.dapple.density
    density.use_height, density.height_max = True, 1.0
    density.use_noise, density.noise_strength = True, 0.5
    for name, value in {**ONLY, "edge_seams": True, "scatter_on": "EDGES", "count": 40}.items():
        setattr(obj.dapple, name, value)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    found = places(obj)
    assert len(found) == 40
    assert found[:, 0] == pytest.approx(0.0, abs=1e-5)
    assert np.ptp(found[:, 1]) > 3.5


def test_more_points_where_a_vertex_group_has_more_weight():
    surface = grid(8)
    group = surface.vertex_groups.new(name="Half")
    for vertex in surface.data.vertices:
        group.add([vertex.index], 1.0 if vertex.co.x > 0.1 else 0.25, "REPLACE")
    obj = scenes.scattered(surface, count=10)
    obj.dapple.density.attribute = "Half"
    for name, value in {"scatter_on": "EDGES", "count": 200, "edge_creases": False}.items():
        setattr(obj.dapple, name, value)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    right = (places(obj)[:, 0] > 0.6).sum()
    assert right > 2.5 * (places(obj)[:, 0] < -0.6).sum()


def test_points_per_area_have_the_distance_that_they_have_on_a_surface():
    distance = math.sqrt(2.0 / (math.sqrt(3.0) * 100.0))
    obj = on_edges(cube(), 1, amount="PER_AREA", points_per_area=100.0)
    assert len(places(obj)) == round(24.0 / distance)
    assert obj.dapple.report.spacing == pytest.approx(distance, rel=0.01)


def test_corners_have_points_if_wanted():
    found = places(on_edges(cube(), 56, edge_corners=True))
    assert np.isclose(np.abs(found), 1.0, atol=1e-5).all(axis=1).sum() == 8


def test_natural_distances_vary():
    obj = on_edges(grid(), 32, edge_creases=False, edge_spacing="NATURAL")
    found = places(obj)
    side = np.sort(found[np.isclose(found[:, 0], 2.0, atol=1e-5), 1])
    assert 0.05 < np.diff(side).std() / np.diff(side).mean() < 0.5


def test_object_types_take_turns():
    obj = scenes.scattered(cube(), count=10)
    for count in (30, 10):
        assert bpy.ops.dapple.edit_object_types(action="ADD") == {"FINISHED"}
        kind = obj.dapple.object_types[-1]
        kind.use_count, kind.count = True, count
    obj.dapple.scatter_on = "EDGES"
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    mesh_arrays = addon_host.part("blender.base.mesh_arrays")
    kinds = mesh_arrays.read_columns(obj.data, {"dapple_object_type": "INT"})["dapple_object_type"]
    assert np.bincount(kinds).tolist() == [30, 10]
    assert np.diff(np.flatnonzero(kinds == 1)).tolist() == [4] * 9


def test_they_follow_the_surface_without_a_bake():
    surface = cube()
    surface.shape_key_add(name="Basis")
    key = surface.shape_key_add(name="Wide")
    key.value = 0.0  # 1 in Blender 5
    for point in key.points:
        point.co.x *= 2.0
    obj = on_edges(surface, 60)
    before = places(obj)
    key.value = 1.0
    bpy.context.view_layer.update()
    assert places(obj) == pytest.approx(before * (2.0, 1.0, 1.0), abs=1e-5)


def test_shading_and_mirroring_keep_the_directions():
    surface = cube()
    surface.scale.x = -1.0
    surface.data.polygons.foreach_set("use_smooth", [True] * 6)
    bpy.context.view_layer.update()
    obj = on_edges(surface, 60)
    found, (ahead, normal) = places(obj), axes(obj)
    outward = np.where(np.isclose(np.abs(found), 1.0, atol=1e-5), np.sign(found), 0.0)
    assert (normal * outward).sum(axis=1).min() > 1.1  # smooth: at corners it is the diagonal
    assert np.abs(ahead[np.arange(60), np.abs(found).argmin(axis=1)]).min() > 0.8


def test_things_turn_at_random_unless_they_are_aligned():
    turned, _ = axes(on_edges(grid(), 32, edge_creases=False, align_to_edges=False))
    assert np.abs(turned[:, :2]).max(axis=1).min() < 0.9


def test_a_bake_and_a_preview_are_not_needed():
    on_edges(cube(), 60)
    for operator in (bpy.ops.dapple.bake, bpy.ops.dapple.live_preview):
        with pytest.raises(RuntimeError, match="stay on them while the surface deforms"):
            operator()


def reason(obj):
    return addon_host.part("blender.freshness.staleness").stale_reason(obj, bpy.context)


def test_reattach_leaves_it_to_optimize():
    obj = on_edges(cube(), 60)
    before = axes(obj)
    with pytest.raises(RuntimeError, match="Optimize puts its points on the edges of the present"):
        bpy.ops.dapple.reattach()
    assert np.array_equal(axes(obj), before)
    scenes.activate(obj.dapple.surface)
    assert bpy.ops.dapple.remesh(count=200) == {"FINISHED"}
    scenes.activate(obj)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert (np.isclose(np.abs(places(obj)), 1.0, atol=1e-5).sum(axis=1) == 2).all()


def failing(surface, message, **settings):
    obj = scenes.scattered(surface, count=10)
    before = places(obj)
    for name, value in {"scatter_on": "EDGES", **settings}.items():
        setattr(obj.dapple, name, value)
    with pytest.raises(RuntimeError, match=message):
        bpy.ops.dapple.optimize()
    assert np.array_equal(places(obj), before)
    return obj


def test_errors_name_the_surface_and_the_edges():
    failing(cube(), "No kind of edge is chosen .* turn on one of Creases, Borders", **ONLY)
    failing(scenes.sphere(), r"Surface 'Sphere' has no such edges: Borders", edge_creases=False)
    failing(cube(), "has no such edges: Seams", **ONLY, edge_seams=True)
    failing(
        scenes.sphere(),
        r"no such edges: Creases, Borders \(Crease Angle is 60 degrees\)",
        edge_angle=math.radians(60.0),
    )
    failing(cube(), "count is 5: there are 8 corners", edge_corners=True, count=5)


def test_densities_of_object_types_are_refused():
    surface = cube()
    surface.vertex_groups.new(name="Rare").add([0], 1.0, "REPLACE")
    obj = scenes.scattered(surface, count=10)
    assert bpy.ops.dapple.edit_object_types(action="ADD") == {"FINISHED"}
    obj.dapple.object_types[0].density, obj.dapple.scatter_on = "Rare", "EDGES"
    with pytest.raises(RuntimeError, match="Object type 1 has a density of its own, 'Rare'"):
        bpy.ops.dapple.optimize()


def test_locked_points_are_refused():
    obj = scenes.scattered(cube(), count=10)
    bpy.ops.dapple.lock_points(lock=True, every=True)
    obj.dapple.scatter_on = "EDGES"
    with pytest.raises(
        RuntimeError, match=r"Points on edges cannot be locked \(10 are\): unlock all"
    ):
        bpy.ops.dapple.optimize()


def test_marking_an_edge_makes_the_result_out_of_date():
    surface = marked(grid(), "use_seam", lambda place: abs(place.x - 1.0) < 1e-6)
    obj = on_edges(surface, 8, **ONLY, edge_seams=True)
    assert reason(obj) == ""
    marked(surface, "use_seam", lambda place: abs(place.x) < 1e-6)
    surface.data.update()
    bpy.context.view_layer.update()
    assert "Edges of 'Grid' were marked or unmarked" in reason(obj)


def test_settings_of_edges_do_not_matter_on_a_surface():
    obj = scenes.scattered(cube(), count=10)
    obj.dapple.edge_seams, obj.dapple.edge_angle = True, 1.0
    assert reason(obj) == ""
    obj.dapple.scatter_on = "EDGES"
    assert "Scatter On" in reason(obj)


def test_the_result_names_the_distance_in_the_unit_of_the_scene():
    lines = addon_host.part("blender.solve.results_panel").result_lines
    obj = on_edges(cube(), 60)
    bpy.context.scene.unit_settings.system = "METRIC"
    assert lines(obj, bpy.context)[0][0].startswith("60 instances, 40 cm apart")
    bpy.context.scene.unit_settings.scale_length = 10.0
    assert lines(obj, bpy.context)[0][0].startswith("60 instances, 4 m apart")
    bpy.context.scene.unit_settings.system = "NONE"
    assert lines(obj, bpy.context)[0][0].startswith("60 instances, 0.4 apart")


def test_texts_have_edges_and_bare_curves_have_no_faces():
    bpy.ops.object.text_add()
    bpy.context.object.data.extrude = 0.2
    assert len(places(on_edges(bpy.context.object, 100))) == 100
    bpy.ops.curve.primitive_bezier_circle_add()
    curve = bpy.context.object
    obj = scenes.scattered(cube(), count=10)
    obj.dapple.surface, obj.dapple.scatter_on = curve, "EDGES"
    with pytest.raises(RuntimeError, match=r"Surface 'B.zierCircle' has no faces"):
        bpy.ops.dapple.optimize()


def test_marks_of_several_objects_that_are_one_surface():
    first, second = grid(), grid()
    second.location.x = 10.0
    for one in (first, second):
        marked(one, "use_seam", lambda place: abs(place.x) < 1e-6)
        one.select_set(True)
    assert bpy.ops.dapple.add_scatter(count=10) == {"FINISHED"}
    obj = along_edges(bpy.context.object, 16, **ONLY, edge_seams=True)
    found = places(obj)
    assert np.sort(np.round(found[:, 0])).tolist() == [0.0] * 8 + [10.0] * 8
