# SPDX-License-Identifier: GPL-3.0-or-later
"""Node groups as assets: contents of the file, a Blender without the add-on, the preferences."""

import json
import types
from pathlib import Path

import addon_host
import bpy
import child
import nodes_text
import numpy as np
import pytest
import scenes
from test_panels import Layout

ROOT = Path(__file__).resolve().parents[3]
KINDS = ("Bound Point", "Instances", "Level of Detail", "Points", "Rest Point", "Scatter")
NAMES = [f"Dapple {name}" for name in KINDS]
NAMES += ["Dapple Viewport"]

WRITE = """
sys.path.insert(0, arguments[0])
from pathlib import Path
from scripts import assets
assets.main(Path(arguments[1]))
"""

# Each group is placed behind others, on another object whose mesh has the points of a scatter.
USED = """
import json
import numpy as np
import mathutils
import scenes

bpy.ops.wm.open_mainfile(filepath=arguments[0])
assert not hasattr(bpy.types.Object, "dapple")
with bpy.data.libraries.load(arguments[1], assets_only=True) as (found, wanted):
    wanted.node_groups = list(found.node_groups)
groups = dict(zip(found.node_groups, wanted.node_groups))
given = json.loads(arguments[2])
expected = np.load(arguments[3])


def shown(kind, build):
    tree = bpy.data.node_groups.new("Chain", "GeometryNodeTree")
    for side in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=side, socket_type="NodeSocketGeometry")

    def node(kind, **feeds):
        new = tree.nodes.new("GeometryNodeGroup" if kind in groups else kind)
        if kind in groups:
            new.node_tree = groups[kind]
        for name, feed in feeds.items():
            socket = new.inputs[name.replace("_", " ")]
            if isinstance(feed, bpy.types.NodeSocket):
                tree.links.new(feed, socket)
            else:
                socket.default_value = feed
        return new

    def attribute(name, kind):
        new = node("GeometryNodeInputNamedAttribute", Name=name)
        new.data_type = kind
        return next(socket for socket in new.outputs if socket.enabled)

    cloud = node("GeometryNodeMeshToPoints", Mesh=node("NodeGroupInput").outputs[0]).outputs[0]
    last = build(node, attribute, cloud).outputs[0]
    tree.links.new(last, node("NodeGroupOutput").inputs[0])
    host = bpy.data.objects.new("Host", bpy.data.objects[given[kind]["scatter"]].data)
    host.location = (1, 2, 3)
    host.modifiers.new("Chain", "NODES").node_group = tree
    bpy.context.scene.collection.objects.link(host)
    bpy.context.scene.frame_set(2, subframe=0.5)
    return host


def inputs(kind):
    objects = {name: bpy.data.objects[value] for name, value in given[kind]["objects"].items()}
    return {**objects, **given[kind]["plain"]}


def bound(kind, geometry, node):
    return node("Dapple Points", Geometry=geometry, **inputs(kind))


def vertices(kind, build):
    host = shown(
        kind,
        lambda node, attribute, cloud: node(
            "GeometryNodePointsToVertices", Points=build(node, attribute, cloud).outputs[0]
        ),
    )
    return host, host.evaluated_get(bpy.context.evaluated_depsgraph_get()).data


def said(name, positions, kind, part="positions"):
    print(name, np.abs(positions - expected[f"{kind}_{part}"]).max())


def check(name, kind, build):
    host, mesh = vertices(kind, build)
    said(name, scenes.world_vertices(host), kind)
    if "rotation" in mesh.attributes:
        turns = np.empty(4 * len(mesh.vertices), np.float32)
        mesh.attributes["rotation"].data.foreach_get("value", turns)
        matrices = [mathutils.Quaternion(turn).to_matrix() for turn in turns.reshape(-1, 4)]
        said(f"{name} (rotations)", np.array(matrices), kind, "rotations")


def placed(node, attribute, surface, kind, **feeds):
    info = node("GeometryNodeObjectInfo", Object=inputs(kind)["Surface"])
    info.transform_space = "RELATIVE"
    return node(surface, Surface=info.outputs["Geometry"], **feeds).outputs["Position"]


def bound_point(node, attribute, cloud):
    weights = node("ShaderNodeSeparateXYZ")
    weights.id_data.links.new(attribute("dapple_barycentric", "FLOAT_VECTOR"), weights.inputs[0])
    corners = {f"V{k}": attribute(f"dapple_v{k}", "INT") for k in range(3)}
    corners |= {f"W{k}": weights.outputs[k] for k in range(3)}
    position = placed(node, attribute, "Dapple Bound Point", "bound", **corners)
    return node("GeometryNodeSetPosition", Geometry=cloud, Position=position)


def rest_point(node, attribute, cloud):
    rest = {"Rest": attribute("dapple_rest", "FLOAT_VECTOR")}
    rest["Ahead"] = attribute("dapple_ahead", "FLOAT_VECTOR")
    position = placed(node, attribute, "Dapple Rest Point", "rest", **rest)
    return node("GeometryNodeSetPosition", Geometry=cloud, Position=position)


def scatter(node, attribute, cloud):
    return node("Dapple Scatter", Geometry=cloud, **inputs("baked"))


def instances(node, attribute, cloud):
    return node("Dapple Instances", Points=bound("baked", cloud, node).outputs[0])


for kind in ("baked", "bound", "rest", "rest baked"):
    check("Dapple Points", kind, lambda node, attribute, cloud: bound(kind, cloud, node))
check("Dapple Bound Point", "bound", bound_point)
check("Dapple Rest Point", "rest", rest_point)
for name, build in (("Dapple Scatter", scatter), ("Dapple Instances", instances)):
    host = shown("baked", build)
    said(name, scenes.positions(host), "baked")
    said(f"{name} (rotations)", scenes.rotations(host), "baked", "rotations")
half = lambda node, attribute, cloud: node(
    "Dapple Viewport", Points=bound("bound", cloud, node).outputs[0], Hidden=0.5
)
_, mesh = vertices("bound", half)
print("Dapple Viewport", abs(len(mesh.vertices) - 0.5 * len(expected["bound_positions"])) / 100)
scene = bpy.context.scene
scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
scene.collection.objects.link(scene.camera)
scene.camera.location.z = 100.0
near = {"Detail_Full_Until": 1.0, "Detail_Minimum": 0.25}
near |= {"Detail_Outside_View": 1.0, "Detail_Fade": 0.0}
fewer = lambda node, attribute, cloud: node(
    "Dapple Level of Detail", Points=bound("bound", cloud, node).outputs[0], **near
)
_, mesh = vertices("bound", fewer)
off = abs(len(mesh.vertices) - 0.25 * len(expected["bound_positions"])) / 100
print("Dapple Level of Detail", off)
"""


@pytest.fixture(scope="module")
def assets(tmp_path_factory):
    """The file with the assets."""
    path = tmp_path_factory.mktemp("assets") / "dapple_nodes.blend"
    child.run(WRITE, ROOT, path)
    return path


@pytest.fixture
def appended(assets):
    """The assets in the open file, by name."""
    with bpy.data.libraries.load(str(assets), assets_only=True) as (found, wanted):
        names = list(found.node_groups)
        wanted.node_groups = list(names)
    return dict(zip(names, wanted.node_groups, strict=True))


def catalogs():
    lines = (addon_host.sources() / "assets" / "blender_assets.cats.txt").read_text().splitlines()
    return {line.split(":")[0]: line.split(":")[2] for line in lines if line.count(":") == 2}


def test_each_asset_says_what_it_is_and_its_sockets_what_they_are(assets):
    with bpy.data.libraries.load(str(assets), link=True, assets_only=True) as (found, wanted):
        names = list(found.node_groups)
        wanted.node_groups = list(names)
    assert sorted(names) == NAMES
    for group in wanted.node_groups:
        said = group.asset_data
        assert len(said.description) > 40
        assert said.author
        assert said.license == "CC0-1.0"
        assert len(said.tags) > 0
        assert catalogs()[said.catalog_id] == "Dapple"
        for item in group.interface.items_tree:
            assert item.description, f"no word of {group.name}'s {item.name}"


def test_the_groups_of_the_file_are_those_that_are_built(appended):
    found = {name: nodes_text.dump(group) for name, group in appended.items()}
    assert found == nodes_text.built()


def test_zones_of_the_file_have_both_ends(appended):
    nodes = [node for tree in bpy.data.node_groups for node in tree.nodes]
    begins = [node for node in nodes if hasattr(node, "paired_output")]
    assert begins
    assert all(node.paired_output for node in begins)


def test_the_same_groups_give_the_same_bytes(assets, tmp_path):
    child.run(WRITE, ROOT, tmp_path / "again.blend")
    assert (tmp_path / "again.blend").read_bytes() == assets.read_bytes()


def inputs_of(obj):
    """Inputs of the modifier of a scatter, to be set on an asset."""
    nodes = addon_host.part("nodes")
    names = [name for name, kind in nodes.INPUTS if kind != "NodeSocketGeometry"]
    values = {name.replace(" ", "_"): nodes.get_input(obj.modifiers[0], name) for name in names}
    objects = {name: one.name for name, one in values.items() if isinstance(one, bpy.types.Object)}
    there = {name: one for name, one in values.items() if name not in objects and one is not None}
    plain = {
        name: one for name, one in there.items() if name not in ("Spacing", "Hidden", "Display")
    }
    return {"scatter": obj.name, "objects": objects, "plain": plain}


def test_without_the_add_on_each_asset_plays_points_behind_other_nodes(assets, tmp_path):
    surface, found, arguments = scenes.tail(frames=3), {}, {}
    for kind in ("baked", "bound", "rest", "rest baked"):
        obj = scenes.scattered(surface, count=60)
        obj.dapple.random_turn = 1.0
        if kind.startswith("rest"):
            obj.dapple.attach_to = "REST"
            assert bpy.ops.dapple.optimize() == {"FINISHED"}
        if kind.endswith("baked"):
            assert bpy.ops.dapple.bake() == {"FINISHED"}
        bpy.context.scene.frame_set(2, subframe=0.5)
        found[f"{kind}_positions"] = scenes.positions(obj)
        found[f"{kind}_rotations"] = scenes.rotations(obj)
        arguments[kind] = inputs_of(obj)
        bpy.context.scene.frame_set(1)
    np.savez(tmp_path / "expected.npz", **found)
    for obj in list(bpy.data.objects):
        for modifier in [one for one in obj.modifiers if one.type == "NODES"]:
            modifier.show_viewport = False
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    files = (tmp_path / "scene.blend", assets, json.dumps(arguments), tmp_path / "expected.npz")
    lines = child.bare(USED, *files).splitlines()
    off = [line.rsplit(" ", 1) for line in lines if line.startswith("Dapple ")]
    assert {name.split(" (")[0] for name, _ in off} == set(NAMES)
    assert max(float(distance) for _, distance in off) < 5e-4, lines


def test_instances_stand_on_points_of_any_others_too(appended):
    surface = scenes.sphere()
    group = appended["Dapple Instances"]
    surface.modifiers.new("Instances", "NODES").node_group = group
    assert len(scenes.positions(surface)) == len(surface.data.vertices)
    sizes = np.linalg.norm(scenes.instance_matrices(surface)[:, :3, 0], axis=1)
    assert np.allclose(sizes, 1.0, atol=1e-6)


READY = {
    "Conifer Forest": {"Conifers"},
    "Grass Meadow": {"Dry Grass", "Flowers", "Grass"},
    "Mushrooms": {"Brown Mushrooms", "Red Mushrooms"},
    "Pebbles": {"Pebbles"},
    "Reptile Scales": {"Scale"},
    "Studs": {"Stud"},
}


def linked(assets):
    """The ready-made scatters, as an asset browser finds them."""
    with bpy.data.libraries.load(str(assets), link=True, assets_only=True) as (found, wanted):
        wanted.objects = list(found.objects)
    return wanted.objects


def test_ready_scatters_say_what_they_are_and_that_they_are_free(assets):
    found = {obj.name: obj for obj in linked(assets)}
    assert found.keys() == READY.keys()
    for obj in found.values():
        said = obj.asset_data
        assert len(said.description) > 20
        assert said.license == "CC0-1.0"
        assert {"scatter", "blue noise"} < {tag.name for tag in said.tags}
        assert catalogs()[said.catalog_id] == "Dapple-Scatters"
        assert tuple(obj.preview.image_size) == (128, 128)
        pixels = np.array(obj.preview.image_pixels_float).reshape(-1, 4)
        assert pixels[:, :3].std() > 0.05
        assert obj.dapple.surface is None
        assert len(obj.data.vertices) == 0


@pytest.mark.parametrize("name", READY)
def test_a_ready_scatter_is_placed(assets, name):
    bpy.ops.wm.append(directory=f"{assets}/Object/", filename=name)
    obj = bpy.data.objects[name]
    surface = scenes.sphere()
    bpy.context.view_layer.objects.active = obj
    obj.dapple.count = 60
    assert bpy.ops.dapple.place_scatter(surface=surface.name) == {"FINISHED"}
    depsgraph = bpy.context.evaluated_depsgraph_get()
    shown = [
        (one.parent.original, one.object.data.name)
        for one in depsgraph.object_instances
        if one.is_instance
    ]
    assert [parent for parent, _ in shown] == 60 * [obj]
    names = {mesh for _, mesh in shown}
    kinds = {kind for kind in READY[name] if any(mesh.startswith(kind) for mesh in names)}
    assert kinds == READY[name]
    visible = [one.name for one in bpy.context.view_layer.objects if one.visible_get()]
    assert sorted(visible) == sorted([name, surface.name])
    for mesh in bpy.data.meshes:
        assert not mesh.validate()


def test_the_same_assets_are_the_same_bytes(assets, tmp_path):
    child.run(WRITE, ROOT, tmp_path / "again.blend")
    assert (tmp_path / "again.blend").read_bytes() == assets.read_bytes()
    assert assets.stat().st_size < 800_000


@pytest.fixture
def library(monkeypatch, assets):
    """The module, with assets in the folder of the add-on; the preferences are restored."""
    module = addon_host.part("blender.assets.library")
    monkeypatch.setattr(module, "FOLDER", assets.parent)
    yield module
    module.remove()


def libraries():
    return [Path(one.path) for one in bpy.context.preferences.filepaths.asset_libraries]


def drawn(**settings):
    shown = []
    preferences = types.SimpleNamespace(layout=Layout(shown), bl_rna=None, **settings)
    preferences.layout.prop = lambda data, name, **_: shown.append(name)
    preferred = addon_host.part("blender.preferences")
    preferred.DAPPLE_AP_preferences.draw(preferences, bpy.context)
    return shown


def test_the_library_is_added_once_and_removed(library, assets, capfd):
    before = libraries()
    assert assets.parent not in before
    assert not bpy.ops.dapple.remove_asset_library.poll()
    assert "dapple.add_asset_library" in drawn()
    assert bpy.ops.dapple.add_asset_library() == {"FINISHED"}
    assert bpy.ops.dapple.add_asset_library() == {"FINISHED"}
    assert "The asset library 'Dapple' already exists" in capfd.readouterr().out
    assert libraries() == [*before, assets.parent]
    assert drawn()[-2:] == ["dapple.remove_asset_library", "remove_library"]
    assert bpy.ops.dapple.remove_asset_library() == {"FINISHED"}
    assert libraries() == before


def test_without_the_file_the_button_says_why(library, tmp_path, monkeypatch):
    monkeypatch.setattr(library, "FOLDER", tmp_path)
    assert not bpy.ops.dapple.add_asset_library.poll()
    assert drawn()[-1].startswith("dapple_nodes.blend is missing: it is only part")
    with pytest.raises(RuntimeError, match=r"dapple_nodes\.blend is missing"):
        bpy.ops.dapple.add_asset_library()
    (tmp_path / "dapple_nodes.blend").write_bytes(b"")
    assert bpy.ops.dapple.add_asset_library.poll()


@pytest.mark.skipif(not addon_host.TESTED_ZIP, reason="a checkout has no assets")
def test_what_is_installed_has_the_file():
    module, before = addon_host.part("blender.assets.library"), libraries()
    assert bpy.ops.dapple.add_asset_library() == {"FINISHED"}
    (added,) = set(libraries()) - set(before)
    module.remove()
    assert {path.name for path in added.iterdir()} >= {"dapple_nodes.blend"}
    assert added.is_relative_to(addon_host.sources())


@pytest.mark.parametrize("asked", [False, True])
def test_disabling_the_add_on_removes_the_library_if_that_was_asked_for(library, assets, asked):
    assert bpy.ops.dapple.add_asset_library() == {"FINISHED"}
    bpy.context.preferences.addons[addon_host.MODULE].preferences.remove_library = asked
    addon_host.disable()
    left = libraries()
    addon_host.enable()
    assert (assets.parent in left) == (not asked)
