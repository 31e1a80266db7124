# SPDX-License-Identifier: GPL-3.0-or-later
"""glTF files: what is written is read back, by another library too, and obeys the rules."""

import base64
import json
from pathlib import Path

import numpy as np
import pytest
from dapple3d import instances
from dapple3d.extras import _gltf_files, _gltf_prototypes, _spaces, gltf
from dapple3d.instances import Instances, Mesh, Reference, Scatter

EXTENSION = "EXT_mesh_gpu_instancing"
TRIANGLE = Mesh(np.array([[0.0, 0, 0], [1, 0, 0], [0, 0, 2]]), np.array([[0, 1, 2]]))


@pytest.fixture
def whole() -> Instances:
    random = np.random.default_rng(0)
    return Instances(
        random.normal(size=(50, 3)),
        instances.orientations(random.normal(size=(50, 3))),
        random.uniform(0.5, 2, (50, 3)),
        ids=np.arange(50) + 7,
        classes=np.arange(50) % 3,
    )


def by_id(found: Instances) -> dict[str, np.ndarray]:
    order = np.argsort(found.ids)
    return {name: values[order] for name, values in found.arrays().items()}


def rounded(values: np.ndarray) -> np.ndarray:
    return values.astype(np.float32) if values.dtype.kind == "f" else values


@pytest.mark.parametrize("suffix", gltf.SUFFIXES)
@pytest.mark.parametrize("up", ["Y", "Z"])
def test_all_arrays_come_back(tmp_path, whole, suffix, up):
    path = tmp_path / f"points{suffix}"
    gltf.write(path, whole, up=up)
    found = by_id(gltf.read(path, up=up))
    assert found.keys() == whole.arrays().keys()
    for name, values in whole.arrays().items():
        np.testing.assert_array_equal(found[name], rounded(values), name)


def test_points_alone_stand_upright(tmp_path):
    gltf.write(tmp_path / "points.glb", Instances(np.array([[1.0, 2, 3]])), meters_per_unit=0.01)
    found = gltf.read(tmp_path / "points.glb")
    np.testing.assert_allclose(found.positions, [[0.01, 0.02, 0.03]], rtol=1e-7)
    assert found.orientations.tolist() == [[1, 0, 0, 0]]
    assert found.scales.tolist() == [[1, 1, 1]]
    assert found.ids is None
    assert gltf.read(tmp_path / "points.glb", up="Y").positions.tolist() == [
        [np.float32(0.01), np.float32(0.03), np.float32(-0.02)]
    ]


@pytest.mark.parametrize("suffix", gltf.SUFFIXES)
def test_another_library_reads_the_same(tmp_path, whole, suffix):
    pygltflib = pytest.importorskip("pygltflib", reason="pygltflib is not installed")
    path = tmp_path / f"points{suffix}"
    gltf.write(path, whole, up="Y", prototypes=[TRIANGLE] * 3)
    found = pygltflib.GLTF2().load(str(path))
    assert found.extensionsUsed == found.extensionsRequired == [EXTENSION]
    blob = found.binary_blob() if suffix == ".glb" else data_of(found.buffers[0].uri)
    assert found.buffers[0].byteLength == len(blob)
    (root,) = found.scenes[found.scene].nodes
    nodes = [found.nodes[k] for k in found.nodes[root].children]
    assert [found.meshes[node.mesh].primitives[0].attributes.POSITION for node in nodes]
    for k, node in enumerate(nodes):
        here = whole.classes == k
        attributes = node.extensions[EXTENSION]["attributes"]
        values = {name: array_of(found, blob, number) for name, number in attributes.items()}
        np.testing.assert_array_equal(values["TRANSLATION"], rounded(whole.positions[here]))
        np.testing.assert_array_equal(values["SCALE"], rounded(whole.scales[here]))
        np.testing.assert_array_equal(
            values["ROTATION"][:, 3], rounded(whole.orientations[here, 0])
        )
        np.testing.assert_array_equal(values["_ID"][:, 0], whole.ids[here])


def data_of(uri: str) -> bytes:
    return base64.b64decode(uri.partition(",")[2])


def array_of(found, blob: bytes, number: int) -> np.ndarray:
    accessor = found.accessors[number]
    view = found.bufferViews[accessor.bufferView]
    width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor.type]
    assert accessor.componentType == 5126
    assert view.byteOffset % 4 == 0
    assert view.byteLength == 4 * width * accessor.count
    values = np.frombuffer(blob, "<f4", width * accessor.count, view.byteOffset)
    return values.reshape(-1, width)


def tree_of(path: Path) -> dict:
    return json.loads(path.read_text())


def test_meshes_obey_the_rules(tmp_path, whole):
    gltf.write(tmp_path / "points.gltf", whole, prototypes=[TRIANGLE] * 3)
    tree = tree_of(tmp_path / "points.gltf")
    primitive = tree["meshes"][0]["primitives"][0]
    places, corners = (
        tree["accessors"][k] for k in (primitive["attributes"]["POSITION"], primitive["indices"])
    )
    assert (places["min"], places["max"]) == ([0, 0, 0], [1, 2, 0])  # its z is glTF's y
    assert (corners["componentType"], corners["count"]) == (5125, 3)
    views = [tree["bufferViews"][accessor["bufferView"]] for accessor in (places, corners)]
    assert [view["target"] for view in views] == [34962, 34963]
    assert tree["asset"]["version"] == "2.0"


def test_meshes_without_a_material_are_no_metal(tmp_path, plants, whole):
    """Metal is black where there is nothing to reflect."""
    shapes = [TRIANGLE, Reference(plants, "leaf"), Mesh(2 * TRIANGLE.vertices, TRIANGLE.faces)]
    for prototypes in (shapes, ()):
        gltf.write(tmp_path / "points.gltf", whole, prototypes=prototypes)
        tree = tree_of(tmp_path / "points.gltf")
        plain = {"pbrMetallicRoughness": {"metallicFactor": 0.0}}
        used = [tree["materials"][mesh["primitives"][0]["material"]] for mesh in tree["meshes"]]
        own = [one == plain for one in used]
        assert own == [True, False, True] if prototypes else own == [True] * 3
        assert tree["materials"].count(plain) == 1


def test_classes_without_points_have_no_node(tmp_path, whole):
    two = Instances(whole.positions, classes=2 * (whole.classes > 0))
    gltf.write(tmp_path / "points.gltf", two)
    assert len(tree_of(tmp_path / "points.gltf")["nodes"]) == 3
    assert sorted(set(gltf.read(tmp_path / "points.gltf").classes)) == [0, 2]


@pytest.mark.parametrize("scales", [None, np.empty((0, 3))])
def test_no_points_are_a_scene_without_meshes(tmp_path, scales):
    gltf.write(tmp_path / "points.gltf", Instances(np.empty((0, 3)), scales=scales))
    assert tree_of(tmp_path / "points.gltf")["nodes"] == [{"name": "points"}]


def test_balls_are_round_and_face_outwards(tmp_path):
    ball = _gltf_prototypes.ball(2.0)
    a, b, c = ball.vertices[ball.faces].swapaxes(0, 1)
    np.testing.assert_allclose(np.linalg.norm(ball.vertices, axis=1), 2.0)
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6
    assert len(ball.faces) == 128
    assert (volumes > 0).all()
    assert 0.9 < volumes.sum() / (4 / 3 * np.pi * 8) < 1


@pytest.fixture
def plants(tmp_path) -> Path:
    """Two nodes, one below the other and turned; a material with a picture beside the file."""
    gltf.write(tmp_path / "plants.gltf", Instances(np.zeros((1, 3))), prototypes=[TRIANGLE], up="Y")
    tree = tree_of(tmp_path / "plants.gltf")
    quarter = [0.0, np.sqrt(0.5), 0.0, np.sqrt(0.5)]  # about y
    tree["nodes"] = [
        {"name": "fern", "children": [1]},
        {"name": "leaf", "mesh": 0, "translation": [1, 2, 3], "rotation": quarter},
        {"name": "pot", "mesh": 0, "matrix": [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 5, 6, 7, 1]},
    ]
    tree["scenes"] = [{"nodes": [0, 2]}]
    tree["images"] = [{"uri": "green.png"}]
    tree["samplers"] = [{}]
    tree["textures"] = [{"source": 0, "sampler": 0}]
    green = {"baseColorTexture": {"index": 0}}
    tree["materials"] = [{"pbrMetallicRoughness": green, "extras": {"index": 9}}]
    tree["meshes"][0]["primitives"][0]["material"] = 0
    del tree["extensionsUsed"], tree["extensionsRequired"]
    (tmp_path / "plants.gltf").write_text(json.dumps(tree))
    return tmp_path / "plants.gltf"


def corners_of(path: Path) -> np.ndarray:
    """All corners of all instances of triangles, y up, as a viewer has them."""
    document = _gltf_files.load(path)
    found = []
    for node in document.tree["nodes"]:
        if "mesh" in node:
            primitive = document.tree["meshes"][node["mesh"]]["primitives"][0]
            corners = document.array(primitive["attributes"]["POSITION"])
            attributes = node["extensions"][EXTENSION]["attributes"]
            place, turn, scale = (
                document.array(attributes[name]) for name in ("TRANSLATION", "ROTATION", "SCALE")
            )
            axes = _spaces.rotation_matrices(np.roll(turn, 1, axis=1)) * scale[:, None]
            found.append(np.einsum("nij,kj->nki", axes, corners) + place[:, None])
    return np.concatenate(found)


def test_prototypes_of_other_files_stand_in_their_place(tmp_path, plants):
    turn = instances.orientations([[1.0, 2, 3], [0, 1, 0]])
    found = Instances(np.array([[1.0, 0, 0], [0, 5, 0]]), turn, np.full((2, 3), 3.0))
    gltf.write(tmp_path / "points.glb", found, up="Y", prototypes=[Reference(plants)])
    leaf = np.array([[1, 2, 3], [1, 2, 2], [3, 2, 3]])  # x became -z, z became x
    pot = 2 * TRIANGLE.vertices + [5, 6, 7]
    axes = 3 * _spaces.rotation_matrices(turn)
    expected = [
        [axes[k] @ corner + found.positions[k] for corner in part]
        for part in (leaf, pot)
        for k in range(2)
    ]
    np.testing.assert_allclose(corners_of(tmp_path / "points.glb"), expected, atol=1e-5)
    np.testing.assert_array_equal(gltf.read(tmp_path / "points.glb").classes, [0, 0])


def test_what_prototypes_need_comes_along_once(tmp_path, plants, whole):
    (tmp_path / "shots").mkdir()
    named = [Reference(plants, "leaf"), TRIANGLE, Reference(plants, "pot")]
    gltf.write(tmp_path / "shots" / "points.gltf", whole, prototypes=named)
    tree = tree_of(tmp_path / "shots" / "points.gltf")
    assert len(tree["meshes"]) == 2
    assert [node["mesh"] for node in tree["nodes"] if "mesh" in node] == [0, 1, 0]
    assert tree["images"] == [{"uri": "../plants.gltf".replace("plants.gltf", "green.png")}]
    assert tree["materials"][0]["extras"] == {"index": 9}
    gltf.write(tmp_path / "points.gltf", whole, prototypes=[TRIANGLE, TRIANGLE, named[0]])
    tree = tree_of(tmp_path / "points.gltf")
    primitive = tree["meshes"][2]["primitives"][0]
    held = [
        tree["accessors"][k] for k in (primitive["attributes"]["POSITION"], primitive["indices"])
    ]
    assert [accessor["count"] for accessor in held] == [3, 3]
    assert tree["materials"][primitive["material"]]["extras"] == {"index": 9}
    corners = corners_of(tmp_path / "points.gltf")
    assert len(corners) == 50
    assert np.isfinite(corners).all()


def test_what_gltf_cannot_hold_is_refused(tmp_path, plants, whole):
    out = tmp_path / "points.glb"
    slanted = tmp_path / "slanted.gltf"
    tree = tree_of(plants)
    tree["nodes"][1]["rotation"] = [0.6, 0, 0, 0.8]
    slanted.write_text(json.dumps(tree))
    uneven = Instances(np.zeros((1, 3)), scales=[[1.0, 2, 3]])
    with pytest.raises(ValueError, match=r"scales\[0\] differs along the axes, and the prototype"):
        gltf.write(out, uneven, prototypes=[Reference(slanted)])
    with pytest.raises(ValueError, match=r"ids\[0\] is 16777217: glTF holds whole numbers up to"):
        gltf.write(out, Instances(np.zeros((1, 3)), ids=[2**24 + 1]))
    with pytest.raises(ValueError, match="grass has 2 frames: glTF holds one"):
        gltf.write_scatters(out, [Scatter("grass", [whole, whole])])
    with pytest.raises(ValueError, match="has no node 'tree'"):
        gltf.write(out, whole, prototypes=[Reference(plants, "tree")] * 3)
    with pytest.raises(ValueError, match=r"positions\[0\] is no 32-bit float: \[1e\+40"):
        gltf.write(out, Instances(np.full((1, 3), 1e40)))
    with pytest.raises(ValueError, match=r"points.usd: a glTF file ends with .glb, .gltf"):
        gltf.write(tmp_path / "points.usd", whole)
    with pytest.raises(ValueError, match="up is 'X': Y or Z is needed"):
        gltf.write(out, whole, up="X")
    with pytest.raises(ValueError, match="meters_per_unit is -1: a number > 0"):
        gltf.write(out, whole, meters_per_unit=-1)
    assert not out.exists()


def test_compressed_prototypes_are_refused(tmp_path, plants, whole):
    tree = tree_of(plants) | {"extensionsUsed": ["EXT_meshopt_compression"]}
    plants.write_text(json.dumps(tree))
    with pytest.raises(ValueError, match="uses EXT_meshopt_compression, which cannot be taken"):
        gltf.write(tmp_path / "points.glb", whole, prototypes=[Reference(plants)] * 3)


@pytest.mark.parametrize(
    "content", [b"glTF", b"{", b"[]", b"glTF\x02\0\0\0\xff\0\0\0\xff\0\0\0JSON{", b"\xff\xfe"]
)
def test_broken_files_are_named(tmp_path, content):
    (tmp_path / "points.glb").write_bytes(content)
    with pytest.raises(ValueError, match=r"points\.glb: could not be read as glTF"):
        gltf.read(tmp_path / "points.glb")


@pytest.mark.parametrize(
    ("place", "value"),
    [
        (("accessors",), []),
        (("accessors", -1, "count"), None),
        (("accessors", -1, "type"), "x"),
        (("accessors", -1, "bufferView"), 2**64),
        (("bufferViews", -1, "byteOffset"), None),
        (("bufferViews", -1, "byteOffset"), 10**6),
        (("nodes", 0), 5),
        (("nodes", 0, "extensions"), 5),
        (("nodes", 0, "extensions", EXTENSION), "x"),
        (("nodes", 0, "extensions", EXTENSION, "attributes"), {}),
        (("buffers", 0), 5),
    ],
)
def test_wrong_entries_are_named(tmp_path, whole, place, value):
    path = tmp_path / "points.gltf"
    gltf.write(path, whole)
    tree = json.loads(path.read_text())
    *way, last = place
    within = tree
    for key in way:
        within = within[key]
    within[last] = value
    path.write_text(json.dumps(tree))
    with pytest.raises(ValueError, match=r"points\.gltf: could not be read as glTF"):
        gltf.read(path)


@pytest.mark.parametrize(
    "change",
    [
        {"nodes": [{"mesh": 0, "children": [0]}]},
        {"nodes": [{"mesh": "x"}]},
        {"nodes": [{"mesh": 0, "matrix": [1, 2, 3]}]},
        {"nodes": 5},
        {"extensionsUsed": [5]},
        {"bufferViews": [5]},
    ],
)
def test_prototypes_with_wrong_entries_are_named(tmp_path, plants, whole, change):
    tree = {"scenes": [{"nodes": [0]}], "scene": 0, "nodes": [{"mesh": 0}]}
    plants.write_text(json.dumps(tree_of(plants) | tree | change))
    with pytest.raises(ValueError, match=rf"{plants.name}: could not be read as glTF"):
        gltf.write(tmp_path / "points.glb", whole, prototypes=[Reference(plants)] * 3)


def test_files_without_instances_are_named(tmp_path, plants):
    with pytest.raises(ValueError, match=f"has no node with {EXTENSION}"):
        gltf.read(plants)
    with pytest.raises(FileNotFoundError):
        gltf.read(tmp_path / "none.glb")


def test_several_scatters_share_a_file(tmp_path, whole):
    scatters = [Scatter("grass", [whole]), Scatter("trees", [whole], [TRIANGLE] * 3)]
    gltf.write_scatters(tmp_path / "points.gltf", scatters)
    tree = tree_of(tmp_path / "points.gltf")
    roots = [tree["nodes"][k] for k in tree["scenes"][0]["nodes"]]
    assert [node["name"] for node in roots] == ["grass", "trees"]
    assert [len(node["children"]) for node in roots] == [3, 3]
    assert len(gltf.read(tmp_path / "points.gltf")) == 100


def test_a_prototype_of_a_file_with_an_index_without_a_vertex_is_named(tmp_path, plants, whole):
    gltf.write(tmp_path / "leaf.glb", Instances(np.zeros((1, 3))), prototypes=[TRIANGLE])
    document = _gltf_files.load(tmp_path / "leaf.glb")
    indices = document.tree["meshes"][0]["primitives"][0]["indices"]
    start = document.tree["bufferViews"][document.tree["accessors"][indices]["bufferView"]]
    document.blob[start["byteOffset"] + 4] = 9
    (tmp_path / "wrong.glb").write_bytes(_gltf_files.encoded(document, ".glb"))
    with pytest.raises(ValueError, match=r"wrong\.glb: .*index 1 of mesh 0 is 9: there are 3"):
        gltf.write(tmp_path / "p.glb", whole, prototypes=[Reference(tmp_path / "wrong.glb")] * 3)


def test_a_class_of_a_large_number_needs_no_more_than_one_node(tmp_path):
    gltf.write(tmp_path / "p.gltf", Instances(np.eye(3), classes=[0, 7, 2**31 - 1]))
    assert len(tree_of(tmp_path / "p.gltf")["nodes"]) == 4
    assert gltf.read(tmp_path / "p.gltf").classes.tolist() == [0, 7, 2**31 - 1]
