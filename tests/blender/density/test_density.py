# SPDX-License-Identifier: GPL-3.0-or-later
"""Density of a scatter: attributes, vertex groups, colors, shape; in bakes and for classes."""

import math

import addon_host
import bpy
import numpy as np
import pytest
import scenes


def heights(surface):
    """Heights of the vertices, from 0 to 1."""
    z = np.array([v.co.z for v in surface.data.vertices])
    return (z - z.min()) / np.ptp(z)


def with_attribute(surface, name, values, kind="FLOAT", domain="POINT"):
    attribute = surface.data.attributes.new(name, kind, domain)
    field = "color" if "COLOR" in kind else "value"
    attribute.data.foreach_set(field, np.asarray(values).ravel())
    return surface


def optimized(obj, **density):
    for name, value in density.items():
        setattr(obj.dapple.density, name, value)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    return scenes.positions(obj)


def share_above(points, z=0.0):
    return float((points[:, 2] > z).mean())


def linear_share():
    """Of a density (1 + z) / 2 on the unit sphere, what lies above z = 0: 3/4."""
    return 0.75


@pytest.mark.parametrize("domain", ["POINT", "FACE", "CORNER"])
def test_an_attribute_of_any_domain_is_followed(domain):
    surface = scenes.sphere()
    values = heights(surface)
    mesh = surface.data
    if domain == "FACE":
        values = np.array([values[list(p.vertices)].mean() for p in mesh.polygons])
    if domain == "CORNER":
        values = np.array([values[loop.vertex_index] for loop in mesh.loops])
    with_attribute(surface, "Grass", values, domain=domain)
    found = optimized(scenes.scattered(surface, count=300), attribute="Grass")
    assert share_above(found) == pytest.approx(linear_share(), abs=0.03)


def test_a_vertex_group_a_color_and_a_truth_value_are_densities():
    surface = scenes.sphere()
    group = surface.vertex_groups.new(name="Fur")
    for vertex, weight in zip(surface.data.vertices, heights(surface), strict=True):
        group.add([vertex.index], float(weight), "REPLACE")
    shades = np.repeat(heights(surface)[:, None], 4, axis=1)
    with_attribute(surface, "Paint", shades, "FLOAT_COLOR")
    with_attribute(surface, "Top", heights(surface) > 0.5, "BOOLEAN")
    obj = scenes.scattered(surface, count=300)
    assert share_above(optimized(obj, attribute="Fur")) == pytest.approx(0.75, abs=0.03)
    assert share_above(optimized(obj, attribute="Paint")) == pytest.approx(0.75, abs=0.03)
    assert share_above(optimized(obj, attribute="Top"), -0.01) == 1.0


def test_blocked_areas_thin_by_what_is_left():
    blocked, next_ring = 0.75, 0.26  # the density falls from one ring of vertices to the next
    surface = scenes.sphere()
    upper = np.where(heights(surface) > 0.5, 1.0, 0.0)
    with_attribute(surface, "Top", upper, "FLOAT")
    with_attribute(surface, "Some", blocked * upper, "FLOAT")
    with_attribute(surface, "Over", 3.0 * upper, "FLOAT")
    with_attribute(surface, "Below", upper - 0.5, "FLOAT")
    obj = scenes.scattered(surface, count=300)
    full = share_above(optimized(obj), 0.2)
    kept = share_above(optimized(obj, blocked_areas="Some"), 0.2)
    left = (1.0 - blocked) * full
    assert kept == pytest.approx(left / (1.0 - blocked * full), abs=0.06)
    for name in ("Top", "Over"):
        assert share_above(optimized(obj, blocked_areas=name), next_ring) == 0.0
    assert share_above(optimized(obj, attribute="Top", blocked_areas="Some"), -0.01) == 1.0
    with pytest.raises(RuntimeError, match=r"'Below' is -0\.5 at vertex"):
        optimized(obj, blocked_areas="Below")


def test_an_attribute_that_geometry_nodes_make_is_a_density():
    builder = addon_host.part("nodes.builder")
    surface = scenes.sphere()
    geometry = [("Geometry", "NodeSocketGeometry")]
    tree = builder.new_group("Make", geometry, geometry)
    b = builder.Builder(tree)
    place = b.node("ShaderNodeSeparateXYZ", b.out("GeometryNodeInputPosition")).outputs["X"]
    above = b.compare("GREATER_THAN", place, 0.0, "FLOAT")
    b.output("Geometry", b.store(b.input("Geometry"), "Made", above, "FLOAT"))
    surface.modifiers.new("Make", "NODES").node_group = tree
    found = optimized(scenes.scattered(surface, count=100), attribute="Made")
    assert found[:, 0].min() > -0.3


def test_slope_and_height_bound_where_points_are():
    obj = scenes.scattered(scenes.sphere(), count=200)
    found = optimized(obj, use_slope=True, slope_max=math.radians(40), slope_falloff=0.0)
    assert found[:, 2].min() > math.cos(math.radians(60))
    found = optimized(
        obj, use_slope=False, use_height=True, height_min=-0.3, height_max=0.2, height_falloff=0.0
    )
    assert found[:, 2].min() > -0.6
    assert found[:, 2].max() < 0.5
    found = optimized(obj, height_min=5.0, height_max=6.0, height_falloff=5.5)
    assert share_above(found) > 0.6, "it fades over the height beside the range"


def test_curvature_gathers_points_where_the_surface_bends():
    bpy.ops.mesh.primitive_cylinder_add(vertices=64, radius=1.0, depth=0.4)
    surface = bpy.context.object
    bevel = surface.modifiers.new("Bevel", "BEVEL")
    bevel.width, bevel.segments = 0.08, 6
    obj = scenes.scattered(surface, count=400)

    def on_rim(points):
        return float((np.hypot(points[:, 0], points[:, 1]) > 0.9).mean())

    before = on_rim(scenes.positions(obj))
    assert on_rim(optimized(obj, curvature=1.0)) > before + 0.15


def test_points_carry_their_density():
    surface = with_attribute(scenes.sphere(), "Grass", heights(scenes.sphere()))
    obj = scenes.scattered(surface, count=200)
    found = optimized(obj, attribute="Grass")
    meshio = addon_host.part("blender.base.mesh_arrays")
    own = meshio.read_columns(obj.data, {"dapple_density": "FLOAT"})["dapple_density"]
    assert np.allclose(own, (found[:, 2] + 1.0) / 2.0, atol=0.03)


def test_each_class_has_a_density_of_its_own():
    surface = scenes.sphere()
    with_attribute(surface, "Up", heights(surface) > 0.55, "BOOLEAN")
    with_attribute(surface, "Down", heights(surface) < 0.45, "BOOLEAN")
    obj = scenes.scattered(surface, count=120)
    for name in ("Up", "Down"):
        bpy.ops.dapple.edit_object_types(action="ADD")
        obj.dapple.object_types[-1].density = name
    found = optimized(obj)
    meshio = addon_host.part("blender.base.mesh_arrays")
    kinds = meshio.read_columns(obj.data, {"dapple_object_type": "INT"})["dapple_object_type"]
    assert found[kinds == 0, 2].min() > -0.1
    assert found[kinds == 1, 2].max() < 0.1
    assert np.bincount(kinds).tolist() == [60, 60]


def test_a_bake_keeps_to_the_density():
    surface = scenes.tail()
    group = surface.vertex_groups.new(name="Fur")
    for vertex in surface.data.vertices:
        group.add([vertex.index], float(vertex.co.z > 2.0), "REPLACE")
    obj = scenes.scattered(surface, count=80)
    optimized(obj, attribute="Fur")
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    depsgraph = bpy.context.evaluated_depsgraph_get()
    for frame in (1, 3, 6):
        bpy.context.scene.frame_set(frame)
        found = scenes.positions(obj)
        mesh = surface.evaluated_get(depsgraph).to_mesh()
        places = np.array([v.co for v in mesh.vertices])
        weight = np.array([sum(g.weight for g in v.groups if g.group == 2) for v in mesh.vertices])
        near = np.argmin(np.linalg.norm(found[:, None] - places[None], axis=2), axis=1)
        assert (weight[near] > 0.0).mean() > 0.9


def test_a_changed_density_is_stale_and_undone_is_fresh():
    stale = addon_host.part("blender.scatter.object").settings_reason
    obj = scenes.scattered(scenes.sphere())
    obj.dapple.density.curvature = 0.5
    assert stale(obj) == "Settings were changed (Density): optimize again"
    obj.dapple.density.curvature = 0.0
    assert stale(obj) == ""


@pytest.mark.parametrize(
    ("values", "said"),
    [
        (None, "Surface 'Sphere' has no attribute or vertex group 'Grass'"),
        (-1.0, "'Grass' is -1 at vertex 0; a density must be finite and not negative"),
        (math.nan, "'Grass' is nan at vertex 0"),
        (0.0, "density"),
    ],
)
def test_a_density_that_cannot_be_is_refused_and_nothing_is_lost(values, said):
    surface = scenes.sphere()
    obj = scenes.scattered(surface, count=50)
    before = scenes.positions(obj)
    if values is not None:
        count = len(surface.data.vertices)
        with_attribute(surface, "Grass", np.full(count, values))
    obj.dapple.density.attribute = "Grass"
    with pytest.raises(RuntimeError, match=said):
        bpy.ops.dapple.optimize()
    assert np.allclose(scenes.positions(obj), before)


def test_names_are_suggested():
    weights = addon_host.part("blender.surface.values")
    surface = scenes.sphere()
    surface.vertex_groups.new(name="Fur")
    with_attribute(surface, "Grass", heights(surface))
    names = weights.weight_names(surface)
    assert {"Fur", "Grass"} <= set(names)
    assert "position" not in names
