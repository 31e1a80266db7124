# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh with Blender's defaults can be scattered on, optimized, baked and rendered at once."""

import addon_host
import bpy
import numpy as np
import probe
import pytest
import scenes

dapple = pytest.importorskip("dapple3d")
NEAR = 1e-3  # spacings


pytestmark = pytest.mark.usefixtures("engine")


@pytest.fixture
def tracked(monkeypatch):
    """Every result of the tracker during the test's bakes."""
    seen = []
    baker = addon_host.part("core.bake.baker").Baker
    advance = baker.advance

    def noting(self, context):
        advance(self, context)
        seen.append((self.last, self.tracker.samples))

    monkeypatch.setattr(baker, "advance", noting)
    return seen


def body(frames=4, modifier=None):
    """The tube of scenes.tail with a shape key that bulges it, subdivided as Blender proposes."""
    surface = scenes.tail(frames=frames)
    surface.modifiers.remove(surface.modifiers["Subdivision"])
    if modifier:
        modifier(surface)
    added = surface.modifiers.new("Subdivision", "SUBSURF")
    assert (added.levels, added.render_levels) == (1, 2)
    surface.shape_key_add(name="Basis")
    bulge = surface.shape_key_add(name="Bulge")
    for point in bulge.data:
        point.co.x *= 1.0 + 0.5 * np.sin(point.co.z)
        point.co.y += 0.2 * np.sin(2.0 * point.co.z)
    for frame, value in ((1, 0.0), (frames, 1.0)):
        bulge.value = value
        bulge.keyframe_insert("value", frame=frame)
    bpy.context.scene.frame_set(1)
    scenes.activate(surface)
    return surface


def as_seen(surface, depsgraph):
    """The surface with its rest shape as a depsgraph has it."""
    rest = addon_host.part("blender.surface.mesh").read_rest(surface, depsgraph)
    return probe.triangles(surface, depsgraph), rest


def image(places, seen, part=slice(None)):
    """Where places of the rest shape are on a surface, of which only some faces are looked at."""
    arrays, rest = seen
    faces = arrays.faces[part]
    found = dapple.project(dapple.Surface(rest, faces), places)
    return np.einsum("nk,nkd->nd", found.barycentric, arrays.vertices[faces[found.faces]])


def stale(obj):
    return addon_host.part("blender.freshness.staleness").stale_reason(obj, bpy.context)


def test_blenders_own_subdivision_with_armature_and_shape_keys_needs_no_setting(tracked):
    surface = body()
    assert bpy.ops.dapple.add_scatter(count=200) == {"FINISHED"}
    obj = bpy.context.object
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert obj.dapple.baked_keys == len(tracked) == 4
    slides = 0.0
    for frame, (binding, samples) in enumerate(tracked, 1):
        bpy.context.scene.frame_set(frame)
        spacing = samples.report.spacing
        assert np.abs(scenes.positions(obj) - samples.positions).max() < NEAR * spacing
        assert stale(obj) == ""
        assert scenes.node_warnings(obj) == []
        places = binding.positions(as_seen(surface, bpy.context.evaluated_depsgraph_get())[1])
        seen = probe.render(obj, frame, read=as_seen)
        assert seen["mode"] == "RENDER"
        assert seen["surface_vertices"] == 1634
        expected = image(places, seen["surface"])
        assert np.abs(seen["positions"] - expected).max() < NEAR * spacing
        slides = max(slides, np.abs(expected - samples.positions).max() / spacing)
    assert 0.0 < slides < 0.5  # the finer surface is close to the coarse one, but not equal


def test_between_frames_the_render_mixes_both_keys_on_its_own_surface(tracked):
    surface = body()
    obj = scenes.scattered(surface)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    rest = as_seen(surface, bpy.context.evaluated_depsgraph_get())[1]
    seen = probe.render(obj, 2, 0.25, read=as_seen)
    before, after = (image(tracked[k][0].positions(rest), seen["surface"]) for k in (1, 2))
    spacing = tracked[1][1].report.spacing
    assert np.abs(before - after).max() > 10 * NEAR * spacing
    expected = 0.75 * before + 0.25 * after
    assert np.abs(seen["positions"] - expected).max() < NEAR * spacing


def test_things_are_turned_as_they_are_on_faces():
    surface = body()
    at_rest = scenes.scattered(surface)
    surface.modifiers["Subdivision"].render_levels = 1
    on_faces = scenes.scattered(surface)
    surface.modifiers["Subdivision"].render_levels = 2
    on_faces.dapple.attach_to = "FACES"
    kinds = []
    for obj in (on_faces, at_rest):
        scenes.activate(obj)
        surface.modifiers["Subdivision"].render_levels = 1 if obj == on_faces else 2
        assert bpy.ops.dapple.bake() == {"FINISHED"}
        kinds.append(obj.dapple.attached_to)
    assert kinds == ["FACES", "REST"]
    for frame, part in ((1, 0.0), (2, 0.0), (2, 0.5), (4, 0.0)):
        bpy.context.scene.frame_set(frame, subframe=part)
        assert np.abs(scenes.rotations(at_rest) - scenes.rotations(on_faces)).max() < 1e-3
        apart = np.abs(scenes.positions(at_rest) - scenes.positions(on_faces)).max()
        assert apart < NEAR * at_rest.dapple.report.spacing


def test_the_viewport_looks_at_faces_and_not_at_the_rest_shape():
    surface = body()
    obj = scenes.scattered(surface)
    for attach_to, faces in (("AUTO", True), ("REST", False)):
        obj.dapple.attach_to = attach_to
        assert bpy.ops.dapple.bake() == {"FINISHED"}
        bpy.context.scene.frame_set(3)
        before = scenes.positions(obj)
        surface.add_rest_position_attribute = False
        bpy.context.view_layer.update()
        assert (np.abs(scenes.positions(obj) - before).max() < 1e-6) == faces
        surface.add_rest_position_attribute = True
        bpy.context.scene.frame_set(1)


def test_the_panel_says_why_points_hold_on_to_the_rest_position():
    surface = body()
    note = addon_host.part("blender.scatter.object").rest_note
    obj = scenes.scattered(surface)
    assert note(obj) == (
        "Viewport and renders have different faces: points are attached to the rest position"
    )
    surface.modifiers["Subdivision"].render_levels = 1
    assert note(scenes.scattered(surface)) == ""


def mirrored(surface):
    """Half of the mesh, and Mirror makes the other, as bodies are modeled."""
    mesh = surface.data
    verts = np.array([vertex.co for vertex in mesh.vertices])
    kept = [p.vertices[:] for p in mesh.polygons if verts[list(p.vertices)][:, 0].max() < 1e-6]
    assert 0 < len(kept) < len(mesh.polygons)
    mesh.clear_geometry()
    mesh.from_pydata(verts.tolist(), [], kept)
    scenes.weigh(surface)
    surface.modifiers.new("Mirror", "MIRROR")
    surface.modifiers.move(1, 0)


def test_a_mirrored_body_needs_no_setting_either(tracked):
    surface = body(modifier=mirrored)
    obj = scenes.scattered(surface, count=200)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert obj.dapple.attached_to == "REST"
    sides = 0
    for frame, (_, samples) in enumerate(tracked, 1):
        bpy.context.scene.frame_set(frame)
        spacing = samples.report.spacing
        assert np.abs(scenes.positions(obj) - samples.positions).max() < NEAR * spacing
        seen = probe.render(obj, frame, read=as_seen)
        assert np.abs(seen["positions"] - samples.positions).max() < 0.5 * spacing
        sides = (samples.positions[:, 0] > 0).sum()
    assert 80 < sides < 120


def test_points_are_previewed_too():
    preview = addon_host.part("blender.display.preview")
    surface = body(frames=6)
    obj = scenes.scattered(surface)
    obj.dapple.preview_budget = 60_000
    bpy.context.scene.frame_set(6)
    riding = scenes.positions(obj)
    bpy.context.scene.frame_set(1)
    assert bpy.ops.dapple.live_preview() == {"FINISHED"}
    for frame in (3, 6):
        bpy.context.scene.frame_set(frame)
        preview.tick()
    assert preview.note(obj) == "Points are kept even"
    assert np.abs(scenes.positions(obj) - riding).max() > 0.01
    surface.modifiers["Subdivision"].levels = 2  # the faces change: the work continues
    bpy.context.view_layer.update()
    preview.tick()
    assert preview.is_on(obj)
    assert len(scenes.positions(obj)) == 60
    assert bpy.ops.dapple.live_preview() == {"FINISHED"}


def test_faces_that_change_in_every_frame_are_baked(tracked):
    surface = scenes.tail(frames=4)
    remesh = surface.modifiers.new("Decimate", "DECIMATE")
    for frame, ratio in ((1, 1.0), (4, 0.7)):
        remesh.ratio = ratio
        remesh.keyframe_insert("ratio", frame=frame)
    bpy.context.scene.frame_set(1)
    obj = scenes.scattered(surface)
    assert obj.dapple.attached_to == "FACES"
    with pytest.raises(RuntimeError, match="changes its topology at frame 2"):
        bpy.ops.dapple.bake()
    tracked.clear()
    obj.dapple.attach_to = "REST"
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    assert obj.dapple.attached_to == "REST"
    stored = addon_host.part("blender.scatter.key_stores").read_baked(obj)
    assert len(set(stored.frames["dapple_vertices"])) > 1
    before = None
    for frame in np.arange(1.0, 4.1, 0.25):
        bpy.context.scene.frame_set(int(frame), subframe=frame % 1.0)
        shown = scenes.positions(obj)
        assert stale(obj) == ""
        if frame % 1.0 == 0.0:
            samples = tracked[int(frame) - 1][1]
            assert np.abs(shown - samples.positions).max() < NEAR * samples.report.spacing
        if before is not None:
            assert np.linalg.norm(shown - before, axis=1).max() < 0.6
        before = shown


def test_bind_to_is_fulfilled_by_bake_and_is_no_complaint_any_more():
    surface = scenes.tail(frames=3)
    obj = scenes.scattered(surface)
    for attach_to in ("REST", "FACES"):
        obj.dapple.attach_to = attach_to
        assert "Attach To" in stale(obj)
        assert bpy.ops.dapple.bake() == {"FINISHED"}
        assert obj.dapple.attached_to == attach_to
        assert stale(obj) == ""
        assert scenes.node_warnings(obj) == []
        assert len(scenes.positions(obj)) == 60


def test_a_failed_operator_leaves_rest_position_off():
    bpy.ops.mesh.primitive_grid_add()
    surface = bpy.context.object
    # the rim has no thickness at rest
    surface.modifiers.new("Solidify", "SOLIDIFY").thickness = 0.5
    obj = scenes.scattered(surface)
    obj.dapple.attach_to = "REST"
    before = scenes.snapshot()
    for operator in ("optimize", "reattach", "bake"):
        with pytest.raises(RuntimeError, match="has the rest position of another place"):
            getattr(bpy.ops.dapple, operator)()
        assert scenes.snapshot() == before
        assert not surface.add_rest_position_attribute


def test_a_stopped_bake_leaves_rest_position_off():
    surface = scenes.tail(frames=3)
    obj = scenes.scattered(surface)
    obj.dapple.attach_to = "REST"
    baking = addon_host.part("blender.bake.steps")
    running = baking.bake_steps(bpy.context, 1, 3)
    next(running)
    assert surface.add_rest_position_attribute
    running.close()
    assert not surface.add_rest_position_attribute
    assert obj.dapple.attached_to == "FACES"


def test_a_failed_add_leaves_no_scatter_and_no_node_group(monkeypatch):
    scenes.sphere()
    writing, errors = (
        addon_host.part("blender.solve.session_solutions"),
        addon_host.part("core.base.errors"),
    )
    before = scenes.snapshot()

    def fails(*_):
        raise errors.ScatterError("It cannot be written")

    monkeypatch.setattr(writing, "write_scattered", fails)
    with pytest.raises(RuntimeError, match="cannot be written"):
        bpy.ops.dapple.add_scatter(count=30)
    assert scenes.snapshot() == before


def test_metaballs_are_scattered_baked_and_rendered(tracked):
    bpy.ops.object.metaball_add()
    surface = bpy.context.object
    other = surface.data.elements.new()
    for frame, x in ((1, 0.5), (4, 2.0)):
        other.co.x = x
        other.keyframe_insert("co", frame=frame)
    surface.location, surface.rotation_euler = (1, 2, 3), (0.3, 0.2, 0.1)
    bpy.context.scene.frame_end = 4
    bpy.context.scene.frame_set(1)
    obj = scenes.scattered(surface)
    assert addon_host.part("blender.scatter.object").rest_note(obj).startswith("Metaballs change")
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    for frame, (_, samples) in enumerate(tracked, 1):
        bpy.context.scene.frame_set(frame)
        spacing = samples.report.spacing
        assert np.abs(scenes.positions(obj) - samples.positions).max() < NEAR * spacing
        assert stale(obj) == ""
        coarse = probe.triangles(surface, bpy.context.evaluated_depsgraph_get())
        seen = probe.render(obj, frame, read=probe.triangles)
        fine = seen["surface"]
        assert len(fine.vertices) > 1.5 * len(coarse.vertices)
        native = dapple.Surface(fine.vertices, fine.faces)
        expected = dapple.project(native, samples.positions).positions
        assert np.abs(seen["positions"] - expected).max() < NEAR * spacing


def test_what_needs_the_same_faces_in_all_frames_says_what_does_not():
    bpy.ops.object.metaball_add()
    surface = bpy.context.object
    other = surface.data.elements.new()
    for frame, x in ((1, 0.5), (4, 2.0)):
        other.co.x = x
        other.keyframe_insert("co", frame=frame)
    bpy.context.scene.frame_set(1)
    obj = scenes.scattered(surface)
    obj.dapple.smoothing = "LOOP"
    said = "changes its topology at frame 2.*Set Smoothing to Forward"
    with pytest.raises(RuntimeError, match=said):
        bpy.ops.dapple.bake()


def test_a_metaball_of_another_ones_surface_says_so():
    for _ in range(2):
        bpy.ops.object.metaball_add()
    before = scenes.snapshot()
    with pytest.raises(RuntimeError, match=r"'Mball.001' has no surface of its own"):
        bpy.ops.dapple.add_scatter()
    assert scenes.snapshot() == before


def test_a_bake_with_births_that_cannot_be_written_keeps_the_one_before():
    obj = scenes.scattered(scenes.tail(frames=4))
    obj.dapple.population = "KEEP_DENSITY"
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    count = len(obj.data.vertices)
    assert count > 60
    obj.scale.x = 0.0
    bpy.context.view_layer.update()
    before = scenes.snapshot()
    with pytest.raises(RuntimeError, match="has a scale of 0"):
        bpy.ops.dapple.bake()
    assert scenes.snapshot() == before
    assert (obj.dapple.baked_keys, len(obj.data.vertices)) == (4, count)


def test_a_point_that_slides_to_where_the_rest_shape_means_two_places_ends_the_bake(monkeypatch):
    surface = body()
    scenes.scattered(surface)
    shape = addon_host.part("core.surface.rest").Shape
    elsewhere, asked = shape.elsewhere, []

    def on_the_third_frame(self, *given):
        asked.append(elsewhere(self, *given))
        return asked[-1] if len(asked) < 4 else "point 5 has the rest position of another place"

    monkeypatch.setattr(shape, "elsewhere", on_the_third_frame)
    before = scenes.snapshot()
    with pytest.raises(RuntimeError, match="Frame 3: point 5 has the rest position of another"):
        bpy.ops.dapple.bake()
    assert asked == [None] * 4  # at the start, and after each frame
    assert scenes.snapshot() == before
