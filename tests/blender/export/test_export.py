# SPDX-License-Identifier: GPL-3.0-or-later
"""Export: every instance is in the file, in its place, and other programs find it there."""

import csv
import json
import re
import sys

import addon_host
import bpy
import child
import numpy as np
import pytest
import scenes
from mathutils import Matrix
from test_object_types import with_classes

pytestmark = pytest.mark.usefixtures("addon")

IMPORTED = """
import json
bpy.ops.wm.read_factory_settings(use_empty=True)
path = arguments[0]
if path.endswith(".glb"):
    import addon_utils
    addon_utils.enable("io_scene_gltf2")
    bpy.ops.import_scene.gltf(filepath=path)
else:
    bpy.ops.wm.usd_import(filepath=path)
found = []
for frame in json.loads(arguments[1]):
    bpy.context.scene.frame_set(frame)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    matrices = [
        [list(row) for row in one.matrix_world]
        for one in depsgraph.object_instances
        if one.object.type == "MESH" and (one.is_instance or path.endswith(".glb"))
    ]
    found.append(matrices)
print("FOUND", json.dumps(found))
"""


def part(name):
    return addon_host.part(f"blender.export.{name}")


@pytest.fixture
def needs_usd(needs_exporter):
    needs_exporter(".usd")


@pytest.fixture
def needs_gltf(needs_exporter):
    needs_exporter(".glb")


@pytest.fixture
def needs_godot(needs_exporter):
    needs_exporter(".tscn")


def solid(name, size=0.1):
    bpy.ops.mesh.primitive_cube_add(size=size, location=(5, 5, 5))
    obj = bpy.context.object
    obj.name = name
    green = bpy.data.materials.new(f"{name} Green")
    green.use_nodes = True
    obj.data.materials.append(green)
    return obj


@pytest.fixture
def trees():
    """A scatter of two kinds of trees on a tail that moves."""
    obj = scenes.scattered(scenes.tail(frames=4), count=60)
    obj.dapple.collection = scenes.collection_of(solid("Pine"), solid("Oak"))
    obj.dapple.random_scale_down = 0.5
    return obj


def shown(obj, frames):
    found = []
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        found.append(scenes.instance_matrices(obj))
    return found


def imported(path, frames):
    """Matrices of the instances on each frame in another Blender."""
    said = child.run(IMPORTED, path, json.dumps(frames))
    line = next(line for line in said.splitlines() if line.startswith("FOUND"))
    return [np.array(one).reshape(-1, 4, 4) for one in json.loads(line.removeprefix("FOUND"))]


def check_same_places(found, expected, tolerance):
    """Compare places in any order."""
    assert len(found) == len(expected)
    gaps = np.linalg.norm(found[:, None, :3, 3] - expected[None, :, :3, 3], axis=2)
    nearest = gaps.argmin(axis=1)
    assert sorted(nearest) == list(range(len(expected)))
    assert np.allclose(found, expected[nearest], atol=tolerance)


@pytest.mark.usefixtures("needs_usd")
@pytest.mark.parametrize("suffix", [".usda", ".usdc"])
def test_another_blender_has_every_instance_in_place(tmp_path, trees, suffix):
    path, frames = tmp_path / f"trees{suffix}", [1, 2, 4]
    expected = shown(trees, frames)
    written = part("points").export_points(path, [trees], [1, 2, 3, 4])
    assert (written.files, written.instances, written.skewed) == ([path], 60, 0)
    for one, there in zip(imported(path, frames), expected, strict=True):
        check_same_places(one, there, 2e-3)  # the importer reads 16-bit orientations


@pytest.mark.usefixtures("needs_gltf")
def test_another_blender_has_every_instance_of_gltf_in_place(tmp_path, trees):
    path = tmp_path / "trees.glb"
    (expected,) = shown(trees, [3])
    part("points").export_points(path, [trees])
    (found,) = imported(path, [1])
    matrices = [one for one in found if not np.allclose(one, np.eye(4))]
    check_same_places(np.array(matrices), expected, 1e-5)


SECTION = re.compile(r"\[(\w+)([^\n]*)\]\n((?:[^\n\[][^\n]*\n)*)")


def of_godot(path):
    """Files of meshes in a scene of Godot, and the matrices of their instances, with z up."""
    sections = SECTION.findall(path.read_text())
    files = {
        re.search(r'id="(\w+)"', keys)[1]: path.parent / re.search(r'path="([^"]+)"', keys)[1]
        for kind, keys, _ in sections
        if kind == "ext_resource"
    }
    turn = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
    found = {}
    for _, _, values in [one for one in sections if 'type="MultiMesh"' in one[1]]:
        rows = np.array(re.search(r"PackedFloat32Array\((.*)\)", values)[1].split(","), float)
        matrices = np.tile(np.eye(4), (len(rows) // 12, 1, 1))
        matrices[:, :3] = rows.reshape(-1, 3, 4)
        found[files[re.search(r'ExtResource\("(\w+)"\)', values)[1]]] = turn @ matrices @ turn.T
    return found


@pytest.mark.usefixtures("needs_godot")
def test_every_instance_of_a_scene_of_godot_is_in_place(tmp_path, trees):
    (expected,) = shown(trees, [3])
    path = tmp_path / "trees.tscn"
    bpy.context.scene.unit_settings.scale_length = 0.5
    written = part("points").export_points(path, [trees])
    assert (written.files, written.instances, written.left_out) == ([path], 60, [])
    found = of_godot(path)
    names = [file.name for file in found]
    assert sorted(names) == sorted(f"0_{k}_{name}.obj" for k, name in enumerate(order(names)))
    matrices = np.concatenate(list(found.values()))
    matrices[:, :3, 3] *= 2.0
    check_same_places(matrices, expected, 1e-5)


def order(names):
    """The names of the objects, by their numbers."""
    return [name.removesuffix(".obj").split("_", 2)[2] for name in sorted(names)]


@pytest.mark.usefixtures("needs_godot")
def test_meshes_of_godot_have_their_size_and_materials(tmp_path, trees):
    bpy.data.objects["Oak"].data.transform(Matrix.Diagonal((1, 2, 3, 1)))
    bpy.context.scene.unit_settings.scale_length = 0.5
    part("points").export_points(tmp_path / "trees.tscn", [trees])
    (file,) = (tmp_path / "trees_meshes").glob("*_Oak.obj")
    lines = [line.split() for line in file.read_text().splitlines()]
    corners = np.array([line[1:4] for line in lines if line[:1] == ["v"]], float)
    assert np.allclose(np.ptp(corners, axis=0), [0.05, 0.15, 0.1])
    assert {len(line) for line in lines if line[:1] == ["f"]} == {4}
    assert ["usemtl", "Oak_Green"] in lines
    assert "newmtl Oak_Green" in file.with_suffix(".mtl").read_text()


@pytest.mark.usefixtures("needs_gltf")
def test_gltf_is_written_where_no_window_is_current(tmp_path, trees):
    """As under `blender --command`, where Blender's exporter asks the window for its cursor."""
    window = bpy.context.window_manager.windows[0]
    shown = window.scene
    with bpy.context.temp_override(window=None):
        written = part("points").export_points(tmp_path / "trees.glb", [trees])
    assert written.files == [tmp_path / "trees.glb"]
    assert window.scene == shown
    assert len(bpy.data.scenes) == 1


@pytest.mark.usefixtures("needs_gltf")
def test_what_blenders_exporter_refuses_is_reported(tmp_path, trees, monkeypatch):
    def failing(*_arguments):
        raise KeyError("unknown node")

    monkeypatch.setattr("io_scene_gltf2.blender.exp.export.save", failing)
    error = addon_host.part("core.base.errors").ScatterError
    with pytest.raises(error, match="glTF exporter failed: KeyError: 'unknown node'"):
        part("points").export_points(tmp_path / "trees.glb", [trees])
    assert not list(tmp_path.iterdir())
    assert len(bpy.data.scenes) == 1


@pytest.mark.usefixtures("needs_usd")
def test_the_files_hold_ids_types_materials_and_velocities(tmp_path, trees):
    usd = pytest.importorskip("dapple3d.extras.usd")
    path = tmp_path / "trees.usda"
    bpy.context.scene.render.fps, bpy.context.scene.unit_settings.scale_length = 30, 0.01
    part("points").export_points(path, [trees], [1, 2, 3, 4])
    found = usd.read(path)
    assert (found.fps, found.up) == (30, "Z")
    assert np.isclose(found.meters_per_unit, 0.01)
    assert found.times.tolist() == [1, 2, 3, 4]
    ids = [vertex.value for vertex in trees.data.attributes["id"].data]
    for frame in found.frames:
        assert sorted(frame.ids) == sorted(ids)
        assert set(frame.prototypes) == {0, 1}
    order = np.argsort(found.frames[0].ids)
    again = np.argsort(found.frames[1].ids)
    step = found.frames[1].positions[again] - found.frames[0].positions[order]
    assert np.allclose(found.frames[0].velocities[order], step * found.fps, atol=1e-3)
    text = path.read_text()
    assert text.count("rel material:binding") == 2
    assert all(f"objects/_materials/{name}_Green" in text for name in ("Pine", "Oak"))


def with_picture(folder, packed):
    """A scatter of an object with a picture in its material."""
    obj = scenes.scattered(scenes.sphere(), count=20)
    obj.dapple.instance = thing = solid("Thing")
    picture = bpy.data.images.new("Bark", 8, 8)
    if packed:
        picture.pack()
    else:
        (folder / "source").mkdir()
        picture.filepath_raw, picture.file_format = str(folder / "source/Bark.png"), "PNG"
        picture.save()
    nodes = thing.material_slots[0].material.node_tree
    texture = nodes.nodes.new("ShaderNodeTexImage")
    texture.image = picture
    nodes.links.new(texture.outputs[0], nodes.nodes["Principled BSDF"].inputs["Base Color"])
    return obj


@pytest.mark.usefixtures("needs_godot")
def test_pictures_of_materials_come_along_to_godot(tmp_path):
    obj = with_picture(tmp_path, packed=False)
    part("points").export_points(tmp_path / "thing.tscn", [obj])
    folder = tmp_path / "thing_meshes"
    assert "map_Kd Bark.png" in (folder / "0_0_Thing.mtl").read_text()
    assert (folder / "Bark.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.usefixtures("needs_usd")
@pytest.mark.parametrize("packed", [True, False])
def test_pictures_of_materials_come_along(tmp_path, monkeypatch, packed):
    obj = with_picture(tmp_path, packed)
    monkeypatch.chdir(tmp_path)
    part("points").export_points("thing.usda", [obj])
    assert "@./thing_textures/Bark.png@" in (tmp_path / "thing.usda").read_text()
    assert (tmp_path / "thing_textures/Bark.png").read_bytes().startswith(b"\x89PNG")
    (tmp_path / "full_textures").write_text("a file")
    with pytest.raises(
        addon_host.part("core.base.errors").ScatterError, match="full_textures' could"
    ):
        part("points").export_points("full.usda", [obj])
    assert not (tmp_path / "full.usda").exists()


def test_tables_hold_the_same_in_columns(tmp_path, trees):
    bpy.context.scene.frame_set(2)
    part("points").export_points(tmp_path / "trees.csv", [trees])
    (expected,) = shown(trees, [2])
    with (tmp_path / "trees.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    places = np.array([[float(row[axis]) for axis in "xyz"] for row in rows])
    assert np.allclose(places, expected[:, :3, 3])
    assert {row["object"] for row in rows} == {"Pine", "Oak"}
    scales = np.array([float(row["sx"]) for row in rows])
    assert np.allclose(scales, np.linalg.norm(expected[:, :3, 0], axis=1))
    part("points").export_points(tmp_path / "trees.npz", [trees], [1, 2])
    arrays = np.load(tmp_path / "trees.npz")
    assert arrays["positions"].shape == (2, 60, 3)
    assert arrays["times"].tolist() == [1, 2]
    assert sorted(arrays["names"]) == ["Oak", "Pine"]


def test_object_types_are_reported_and_cones_are_things_too(tmp_path):
    obj = with_classes(scenes.sphere(), {}, {}, count=40)
    obj.dapple.object_types[0].instance = solid("Rock")
    part("points").export_points(tmp_path / "types.npz", [obj])
    arrays = np.load(tmp_path / "types.npz")
    kinds = {vertex.value for vertex in obj.data.attributes["dapple_object_type"].data}
    assert set(arrays["classes"].tolist()) == kinds == {0, 1}
    names = arrays["names"][arrays["prototypes"]]
    assert set(names[arrays["classes"] == 0]) == {"Rock"}
    assert set(names[arrays["classes"] == 1]) == {f"{obj.name} Cone"}


@pytest.mark.usefixtures("needs_gltf")
def test_several_scatters_share_a_scene_but_no_table(tmp_path):
    first = scenes.scattered(scenes.sphere(), count=20)
    second = scenes.scattered(scenes.sphere(location=(3, 0, 0)), count=30)
    written = part("points").export_points(tmp_path / "both.glb", [first, second])
    assert written.instances == 50
    content = (tmp_path / "both.glb").read_bytes()
    assert all(name in content for name in (b'"Sphere_Scatter"', b'"Sphere_001_Scatter"'))
    written = part("points").export_points(tmp_path / "both.csv", [first, second])
    names = ["both.Sphere_Scatter.csv", "both.Sphere_001_Scatter.csv"]
    assert [path.name for path in written.files] == names
    lines = [len(path.read_text().splitlines()) for path in written.files]
    assert lines == [21, 31]


def test_what_only_the_viewport_leaves_out_is_exported(tmp_path, trees):
    trees.dapple.viewport_share, trees.dapple.display_as = 0.3, "BOUNDS"
    written = part("points").export_points(tmp_path / "trees.npz", [trees])
    assert written.instances == 60
    assert sorted(np.load(tmp_path / "trees.npz")["names"]) == ["Oak", "Pine"]
    assert (round(trees.dapple.viewport_share, 6), trees.dapple.display_as) == (0.3, "BOUNDS")


def test_objects_of_a_collection_that_stand_together_have_ids_of_their_own(tmp_path):
    crown, trunk = solid("Crown"), solid("Trunk")
    crown.location, trunk.location = (0, 0, 1), (0, 0, 0)
    whole, outer = scenes.collection_of(crown, trunk), bpy.data.collections.new("Outer")
    bpy.context.scene.collection.children.unlink(whole)
    outer.children.link(whole)
    obj = scenes.scattered(scenes.sphere(), count=25)
    obj.dapple.collection = outer
    part("points").export_points(tmp_path / "trees.npz", [obj])
    arrays = np.load(tmp_path / "trees.npz")
    assert len(arrays["ids"]) == 50
    assert len(set(arrays["ids"].tolist())) == 50
    assert len(set((arrays["ids"] & 0xFFFFFFFF).tolist())) == 25


def test_a_bake_with_points_that_come_and_go(tmp_path):
    surface = scenes.tail(frames=4)
    obj = scenes.scattered(surface, count=40)
    obj.dapple.population = "KEEP_DENSITY"
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    part("points").export_points(tmp_path / "baked.csv", [obj], [1, 2, 3, 4])
    with (tmp_path / "baked.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for frame, expected in zip((1, 2, 3, 4), shown(obj, (1, 2, 3, 4)), strict=True):
        here = [row for row in rows if row["frame"] == str(frame)]
        places = np.array([[float(row[axis]) for axis in "xyz"] for row in here])
        assert np.allclose(places, expected[:, :3, 3], atol=1e-6)
        assert len({row["id"] for row in here}) == len(here)


@pytest.mark.usefixtures("needs_gltf")
def test_nothing_is_left_behind(tmp_path, trees):
    scenes_before = list(bpy.data.scenes)
    before = scenes.snapshot()
    part("points").export_points(tmp_path / "trees.glb", [trees])
    part("points").export_points(tmp_path / "trees.csv", [trees], [1, 2])
    assert scenes.snapshot() == before
    assert list(bpy.data.scenes) == scenes_before
    assert bpy.context.scene == scenes_before[0]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["trees.csv", "trees.glb"]


def test_what_cannot_be_exported_is_said(tmp_path, trees):
    error = addon_host.part("core.base.errors").ScatterError
    export = part("points").export_points
    message = r"'trees.obj' has an unknown file extension; known are .usdc, .usda"
    with pytest.raises(error, match=message):
        export(tmp_path / "trees.obj", [trees])
    with pytest.raises(error, match="none': the folder does not exist"):
        export(tmp_path / "none" / "trees.csv", [trees])
    with pytest.raises(error, match="glTF cannot move instances"):
        export(tmp_path / "trees.glb", [trees], [1, 2])
    with pytest.raises(error, match="a scene of Godot cannot move instances"):
        export(tmp_path / "trees.tscn", [trees], [1, 2])
    (tmp_path / "folder.csv").mkdir()
    with pytest.raises(error, match=r"folder.csv' could not be written"):
        export(tmp_path / "folder.csv", [trees])
    trees.hide_set(True)
    with pytest.raises(error, match="shows no instances: it is hidden in the viewport"):
        export(tmp_path / "trees.csv", [trees])


def test_without_usd_it_is_said_what_to_do(tmp_path, trees, monkeypatch):
    monkeypatch.setitem(sys.modules, "pxr", None)
    monkeypatch.setattr(part("prototypes"), "has_pxr", lambda: False)
    with pytest.raises(addon_host.part("core.base.errors").ScatterError, match="built without USD"):
        part("points").export_points(tmp_path / "trees.usd", [trees])


@pytest.mark.usefixtures("needs_gltf")
def test_the_operator_exports_what_is_selected(tmp_path, trees):
    scenes.activate(trees)
    path = tmp_path / "trees.csv"
    assert bpy.ops.dapple.export_points(filepath=str(path), animation=True) == {"FINISHED"}
    assert len(path.read_text().splitlines()) == 1 + 4 * 60
    assert bpy.ops.dapple.export_points(filepath=str(tmp_path / "trees.glb"), animation=True) == {
        "FINISHED"
    }
    with pytest.raises(RuntimeError, match="has an unknown file extension"):
        bpy.ops.dapple.export_points(filepath=str(tmp_path / "trees.xyz"))
    scenes.activate(trees.dapple.surface)
    assert not bpy.ops.dapple.export_points.poll()


def test_the_menu_of_exports_has_a_line():
    class Layout:
        def operator(self, name, text=""):
            lines.append((name, text))

    class Menu:
        layout = Layout()

    lines = []
    for draw in bpy.types.TOPBAR_MT_file_export._dyn_ui_initialize():
        if draw.__module__.startswith(addon_host.MODULE):
            draw(Menu, bpy.context)
    assert lines == [("dapple.export_points", "Dapple Points (.usd/.glb/.tscn/.csv/.npz)")]
