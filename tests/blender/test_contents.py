# SPDX-License-Identifier: GPL-3.0-or-later
"""A result fits no more when what it was solved from has other contents, whatever their names."""

import math

import addon_host
import bpy
import numpy as np
import pytest
import scenes


def reason(obj):
    bpy.context.view_layer.update()
    return addon_host.part("blender.status.staleness").stale_reason(obj, bpy.context)


def note(obj):
    bpy.context.view_layer.update()
    return addon_host.part("blender.status.staleness").verdict(obj, bpy.context).note


def linked(obj, collection=None):
    (collection or bpy.context.scene.collection).objects.link(obj)
    return obj


def weighed(surface, name="Grass"):
    group = surface.vertex_groups.new(name=name)
    group.add(range(len(surface.data.vertices)), 0.5, "REPLACE")
    group.add(range(40), 1.0, "REPLACE")
    return group


def colored(surface, name="Moss"):
    attribute = surface.data.attributes.new(name, "FLOAT", "POINT")
    attribute.data.foreach_set("value", np.linspace(0.5, 1.0, len(attribute.data)))
    return attribute


def picture(name="Picture"):
    image = bpy.data.images.new(name, 4, 4)
    pixels = np.linspace(0.5, 1.0, 64, dtype=np.float32).reshape(-1, 4)
    pixels[:, 3] = 1.0
    image.pixels.foreach_set(pixels.ravel())
    return image


def camera():
    made = linked(bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera")))
    made.location = (0.0, 0.0, 2.0)
    bpy.context.scene.camera = made
    return made


def obstacle():
    mesh = bpy.data.meshes.new("Stone")
    mesh.from_pydata([(0, 0, 2), (1, 0, 2), (0, 1, 2), (0, 0, 3)], [], [(0, 1, 2), (0, 1, 3)])
    collection = bpy.data.collections.new("Stones")
    bpy.context.scene.collection.children.link(collection)
    return linked(bpy.data.objects.new("Stone", mesh), collection)


def solved(surface, **density):
    obj = scenes.scattered(surface)
    for name, value in density.items():
        setattr(obj.dapple.density, name, value)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert reason(obj) == note(obj) == ""
    return obj


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
    bpy.ops.dapple.edit_classes(action="ADD")
    obj.dapple.classes[0].density = "Grass"
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
    obj = solved(scenes.sphere(), use_camera=True)
    yield obj
    made.location.x = 0.5
    yield "The camera was moved or changed"


def zoomed_camera():
    made = camera()
    obj = solved(scenes.sphere(), use_camera=True)
    yield obj
    made.data.lens = 70.0
    yield "The camera was moved or changed"


def moved_obstacle():
    stone = obstacle()
    obj = solved(scenes.sphere(), obstacles=bpy.data.collections["Stones"])
    yield obj
    stone.location.z = -1.5
    yield "Avoided objects were moved or changed"


def reshaped_obstacle():
    stone = obstacle()
    obj = solved(scenes.sphere(), obstacles=bpy.data.collections["Stones"])
    yield obj
    stone.data.vertices[3].co.z = 1.0
    yield "Avoided objects were moved or changed"


def another_obstacle():
    obstacle()
    obj = solved(scenes.sphere(), obstacles=bpy.data.collections["Stones"])
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
    scenes._activate(surface)
    assert bpy.ops.dapple.add(count=60) == {"FINISHED"}
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
    scenes._activate(surface)
    assert bpy.ops.dapple.add(count=60, bind_to="REST") == {"FINISHED"}
    yield bpy.context.object
    surface.data.clear_geometry()
    yield "Surface 'Sphere': has no faces"


def rest_position_off():
    surface = scenes.sphere()
    scenes._activate(surface)
    assert bpy.ops.dapple.add(count=60, bind_to="REST") == {"FINISHED"}
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
    scenes._activate(obj)
    assert getattr(bpy.ops.dapple, operator)() == {"FINISHED"}
    assert reason(obj) == note(obj) == ""
    assert np.abs(scenes.positions(obj) - before).max() > 1e-3


def test_names_alone_change_nothing():
    surface, stone, image, made = scenes.sphere(), obstacle(), picture(), camera()
    group = weighed(surface)
    obj = solved(
        surface,
        attribute="Grass",
        image=image,
        use_camera=True,
        obstacles=bpy.data.collections["Stones"],
    )
    named = (surface, surface.data, stone, image, made, obj, obj.data)
    for one in (*named, bpy.data.collections["Stones"], bpy.context.scene):
        one.name = f"Other {one.name}"
        assert reason(obj) == note(obj) == "", one.name
    surface.data.uv_layers[0].name = "Other map"
    assert reason(obj) == ""
    group.name = "Lawn"
    assert "no attribute or vertex group 'Grass'" in reason(obj)
    obj.dapple.density.attribute = "Lawn"
    assert reason(obj) == ""


def test_settings_without_effect_change_nothing():
    obj = solved(scenes.sphere())
    density = obj.dapple.density
    density.slope_from, density.height_to, density.camera_margin = 0.3, 7.0, 0.5
    density.obstacle_margin, density.uv_map = 0.2, "UVMap"
    obj.dapple.stickiness, obj.dapple.key_every, obj.dapple.fade_frames = 4.0, 3, 5
    assert reason(obj) == ""
    assert scenes.node_warnings(obj) == []


@pytest.mark.parametrize("scale", [(1, 1, 1), (-1, 2, 0.5)])
def test_a_scene_that_is_moved_as_a_whole_fits(scale):
    surface, stone, made = scenes.sphere(scale=scale), obstacle(), camera()
    above = linked(bpy.data.objects.new("Above", None))
    for one in (surface, stone, made):
        one.parent = above
    obj = solved(surface, use_camera=True, obstacles=bpy.data.collections["Stones"])
    above.location, above.rotation_euler = (3, -40, 5), (1, 2, 3)
    assert reason(obj) == ""
    stone.location.x = 1e-3
    assert "Avoided objects" in reason(obj)


def test_a_scale_that_is_applied_fits():
    surface = scenes.sphere(scale=(1.0, 2.0, 0.5), rotation=(0.3, 0.4, 0.5))
    obj = solved(surface)
    scenes._activate(surface)
    assert bpy.ops.object.transform_apply(location=False, rotation=False) == {"FINISHED"}
    assert reason(obj) == note(obj) == ""
    bpy.ops.object.origin_set(type="GEOMETRY_ORIGIN", center="BOUNDS")
    assert reason(obj) == note(obj) == ""


def test_another_scatter_to_keep_off_is_solved_anew():
    surface = scenes.sphere()
    other = scenes.scattered(scenes.sphere(location=(0, 0, 1)))
    collection = bpy.data.collections.new("Others")
    bpy.context.scene.collection.children.link(collection)
    collection.objects.link(other)
    obj = solved(surface, obstacles=collection, obstacle_margin=0.1)
    other.dapple.seed = 5
    assert reason(obj) == ""
    scenes._activate(other)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert reason(obj) == "Avoided objects were moved or changed: optimize again"


def test_contents_are_compared_after_saving_and_opening(tmp_path):
    surface = scenes.sphere()
    weighed(surface)
    image = picture()
    image.pack()
    solved(surface, attribute="Grass", image=image)
    path = str(tmp_path / "solved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    obj = bpy.data.objects["Sphere Scatter"]
    assert reason(obj) == note(obj) == ""
    bpy.data.objects["Sphere"].vertex_groups["Grass"].add([3], 0.0, "REPLACE")
    assert "Values of 'Grass'" in reason(obj)


def test_on_another_frame_what_moves_is_told_apart_from_what_was_changed():
    surface = scenes.tail(frames=4)
    group = weighed(surface)
    obj = solved(surface, attribute="Grass")
    bpy.context.scene.frame_set(4)
    assert reason(obj) == ""
    assert note(obj) == (
        "Differs from frame 1, where the points were optimized: shape of the surface"
    )
    group.add([100], 0.25, "REPLACE")
    assert "Values of 'Grass'" in reason(obj)


def moving_camera():
    made = camera()
    for frame, place in ((1, 0.0), (4, 1.0)):
        made.location.x = place
        made.keyframe_insert("location", frame=frame)
    return made


def test_a_bake_knows_what_moves():
    surface = scenes.tail(frames=4)
    group, made = weighed(surface), moving_camera()
    bpy.context.scene.frame_set(1)
    obj = solved(surface, attribute="Grass", use_camera=True)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    for frame in (1, 2, 3, 4):
        bpy.context.scene.frame_set(frame)
        assert reason(obj) == note(obj) == ""
    group.add([100], 0.25, "REPLACE")
    assert reason(obj) == "Values of 'Grass' were changed: bake again"
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert reason(obj) == ""
    made.animation_data_clear()
    made.location = (0.5, 0.0, 9.0)
    bpy.context.scene.frame_set(1)
    assert reason(obj) == "The camera was moved or changed: bake again"
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert reason(obj) == ""


@pytest.mark.parametrize(
    ("name", "value"), [("count", 40), ("seed", 3), ("repulsion_weight", 1.0), ("forward", "X")]
)
def test_a_bake_takes_the_settings_that_are_shown(name, value):
    bpy.context.scene.frame_end = 2
    surface = scenes.tail(frames=2)
    obj = scenes.scattered(surface)
    setattr(obj.dapple, name, value)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert reason(obj) == ""
    expected = scenes.positions(obj)
    scenes._activate(surface)
    other = scenes.scattered(surface)
    setattr(other.dapple, name, value)
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert len(expected) == len(scenes.positions(other)) == (40 if name == "count" else 60)
    assert (scenes.positions(other) == expected).all()
    scenes._activate(obj)
    assert bpy.ops.dapple.clear_bake() == {"FINISHED"}
    assert reason(obj) == ""
    assert len(scenes.positions(obj)) == len(expected)


def test_a_bake_keeps_points_that_were_bound_again():
    surface = scenes.tail(frames=2)
    bpy.context.scene.frame_end = 2
    obj = scenes.scattered(surface)
    obj.data.vertices[3].co.z += 0.3
    assert bpy.ops.dapple.rebind() == {"FINISHED"}
    assert reason(obj) == ""
    before = scenes.positions(obj)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    moved = np.linalg.norm(scenes.positions(obj) - before, axis=1)
    assert moved.max() < 0.5 * obj.dapple.report.spacing


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("key_every", 2, "Keyframe Interval"),
        ("bake_smoothing", "LOOP", "Smoothing"),
        ("count_over_time", "KEEP_DENSITY", "Population, Fade Duration"),
        ("stickiness", 3.0, "Stickiness"),
    ],
)
def test_settings_of_the_bake_alone_ask_for_another_bake(name, value, words):
    bpy.context.scene.frame_end = 3
    obj = scenes.scattered(scenes.tail(frames=3))
    ids = [one.value for one in obj.data.attributes["id"].data]
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    setattr(obj.dapple, name, value)
    said = f"Settings were changed ({words}): bake again"
    assert reason(obj) == said
    assert scenes.node_warnings(obj) == [said]
    places = [tuple(vertex.co) for vertex in obj.data.vertices]
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert reason(obj) == ""
    assert [tuple(one.co) for one in obj.data.vertices][: len(ids)] == places
    assert bpy.ops.dapple.clear_bake() == {"FINISHED"}
    assert reason(obj) == ""


def test_a_bake_on_a_newly_chosen_surface_plays_there():
    surface = scenes.tail(frames=2)
    bpy.context.scene.frame_end = 2
    obj = scenes.scattered(surface)
    other = linked(surface.copy())
    other.location.x = 10.0
    bpy.context.view_layer.update()
    obj.dapple.surface = other
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert reason(obj) == ""
    assert scenes.positions(obj)[:, 0].min() > 5.0


def damaged(name, store, value):
    def damage(obj):
        read = addon_host.part("nodes").get_input
        data = read(obj.modifiers[0], store).data
        data.attributes[name].data[2].value = value
        data.update_tag()

    return damage


@pytest.mark.parametrize(
    ("damage", "said"),
    [
        (damaged("dapple_face", "Keys", 99_999), "dapple_face[2] is 99999, there are "),
        (damaged("dapple_v1", "Triangles", -4), "dapple_v1[2] is -4, there are 410"),
        (damaged("dapple_v1", "Triangles", 410), "dapple_v1[2] is 410, there are 410"),
        (damaged("dapple_key", "Frames", 77), "dapple_key[2] is 77, there are 4"),
    ],
)
def test_keys_with_bad_indices_are_said(damage, said):
    scenes.tail(frames=4)
    obj = scenes.scattered(bpy.context.object)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    damage(obj)
    assert reason(obj).startswith(f"The keyframes are damaged: {said}")
    assert reason(obj).endswith(": bake again")
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert reason(obj) == ""


def test_a_result_of_an_older_version_says_what_is_not_compared():
    obj = solved(scenes.sphere())
    obj.dapple.solved_from = obj.dapple.solved_points = ""
    obj.dapple.surface.scale.x = 3.0
    assert reason(obj) == ""
    assert note(obj) == "Made by an older version: only settings and faces are compared"
    obj.dapple.solved_from = '{"exact": 3}'
    assert note(obj) == "Made by an older version: only settings and faces are compared"


@pytest.mark.parametrize("seen", range(3))
def test_every_vertex_counts_in_a_large_surface(seen):
    sources, surface = addon_host.part("core.sources"), addon_host.part("core.surface")
    random = np.random.Generator(np.random.PCG64(seen))
    vertices = random.normal(size=(50_001, 3))
    none = np.empty((0, 3), dtype=np.int32)
    settings = addon_host.part("core.settings").Settings()
    before = sources.sources_of(surface.SurfaceArrays("Any", vertices, none, "t"), settings)
    before = sources.sources_from(before.text())
    vertices[random.integers(len(vertices))] += 0.01
    now = sources.sources_of(surface.SurfaceArrays("Any", vertices, none, "t"), settings)
    assert sources.differing(before, now) == ["shape"]


def test_a_stopped_bake_of_changed_settings_goes_on_to_the_same_bytes():
    baking, steps = addon_host.part("blender.steps.baking"), addon_host.part("core.steps")
    package = addon_host.part("core.native").package()
    surface, found = scenes.tail(frames=4), []
    for stopped in (False, True):
        obj = scenes.scattered(surface)
        obj.dapple.count = 40
        if stopped:
            going = baking.bake_steps(bpy.context, 1, 4)
            task = next(going)
            for _ in range(5):  # the points, and what two frames take
                task = going.send(task.call(package.Context()))
            going.close()
            assert (len(obj.data.vertices), obj.dapple.baked_keys) == (60, 0)
            assert reason(obj) == "Settings were changed (Count): optimize again"
            assert addon_host.part("blender.status.workfiles").unfinished(obj) == 2
        baker = steps.run_now(baking.bake_steps(bpy.context, 1, 4))
        assert baker.taken == (2 if stopped else 0)
        assert baker.anew == "Settings were changed (Count)"
        assert reason(obj) == ""
        found.append(addon_host.part("blender.data.key_stores").read_baked(obj))
    for name in ("keys", "triangles", "frames"):
        for column, values in getattr(found[0], name).items():
            assert getattr(found[1], name)[column].tobytes() == values.tobytes()
