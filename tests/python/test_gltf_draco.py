# SPDX-License-Identifier: GPL-3.0-or-later
"""glTF files whose meshes Draco compressed."""

import json
import sys

import dapple3d as dapple
import numpy as np
import pytest
from command_line import done
from dapple3d.extras import _gltf_files as files
from dapple3d.extras import gltf
from dapple3d.instances import Instances, Reference
from gltf_scene import HALVES, SQUARE, Scene

draco = pytest.importorskip("DracoPy", reason="DracoPy is not installed")

EXTENSION = "KHR_draco_mesh_compression"
MANY = 2**32 - 1
COUNT = 12  # vertices along a side of the hill
WIDTHS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}
UNSIGNED = {np.dtype("u1"): 5121, np.dtype("u2"): 5123, np.dtype("f4"): 5126}
WAYS = {
    "sequential": {"compression_level": 0},
    "edgebreaker": {"compression_level": 1},
    "valence": {"compression_level": 10},
    "in order": {"preserve_order": True},
    "metadata": {"create_metadata": True},
}


def hill():
    """Vertices, faces and attributes of the vertices, in the types that glTF wants."""
    x, y = (values.ravel() for values in np.meshgrid(*[np.linspace(0, 1, COUNT)] * 2))
    vertices = np.column_stack([x, y, x * (1 - x) * y * (1 - y)])
    k = np.arange(COUNT**2).reshape(COUNT, COUNT)
    a, b, c, d = (part.ravel() for part in (k[:-1, :-1], k[:-1, 1:], k[1:, 1:], k[1:, :-1]))
    faces = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    normals = np.column_stack([x - 0.5, y - 0.5, np.ones(COUNT**2)])
    return vertices, faces, {
        "TEXCOORD_0": np.column_stack([x, y]),
        "NORMAL": normals / np.linalg.norm(normals, axis=1)[:, None],
        "COLOR_0": np.column_stack([255 * x, 255 * y, 0 * x]).astype(np.uint8),
    }  # fmt: skip


def compressed(vertices, faces, attributes=None, others=None, **way):
    """A scene of one mesh, and its compressed bytes; `others` are attributes by name."""
    attributes, others = attributes or {}, others or {}
    numbers = {name: 50 + k for k, name in enumerate(others)}
    block = draco.encode(
        np.asarray(vertices, np.float64), np.asarray(faces, np.uint32),
        tex_coord=attributes.get("TEXCOORD_0"), normals=attributes.get("NORMAL"),
        colors=attributes.get("COLOR_0"),
        generic_attributes={numbers[name]: values for name, values in others.items()} or None,
        **{"quantization_bits": 20} | way,
    )  # fmt: skip
    kinds = {0: "POSITION", 1: "NORMAL", 2: "COLOR_0", 3: "TEXCOORD_0"}
    for one in draco.decode(block).attributes:
        if one["attribute_type"] in kinds:
            numbers[kinds[one["attribute_type"]]] = one["unique_id"]
    scene = Scene()
    entries = {}
    positions = np.zeros((len(vertices), 3), "f4")
    for name, values in {"POSITION": positions, **attributes, **others}.items():
        kind = UNSIGNED.get(values.dtype, 5126)
        more = {"normalized": True} if name == "COLOR_0" else {}
        entries[name] = scene.add(
            "accessors", componentType=kind, count=len(values), type=WIDTHS[values.shape[1]], **more
        )
    indices = scene.add("accessors", componentType=5125, count=3 * len(faces), type="SCALAR")
    extension = {"bufferView": scene.view(np.frombuffer(block, np.uint8)), "attributes": numbers}
    primitive = {"attributes": entries, "indices": indices, "extensions": {EXTENSION: extension}}
    scene.add("meshes", primitives=[primitive])
    scene.add("nodes", mesh=0)
    scene.tree |= {"extensionsUsed": [EXTENSION], "extensionsRequired": [EXTENSION]}
    return scene


def with_block(scene, block):
    """The scene with another compressed block."""
    scene.blob = b""
    scene.tree["bufferViews"] = []
    scene.view(np.frombuffer(block, np.uint8))
    return scene


def primitive_of(scene):
    return scene.tree["meshes"][0]["primitives"][0]


def accessor_of(scene, name="POSITION"):
    return scene.tree["accessors"][primitive_of(scene)["attributes"][name]]


def said_of(scene, folder):
    path = scene.save(folder / "scene.glb")
    with pytest.raises(dapple.FileError, match=r"scene\.glb: could not be read as glTF: ") as said:
        dapple.read_mesh(path)
    return str(said.value).partition("as glTF: ")[2]


@pytest.mark.parametrize("suffix", gltf.SUFFIXES)
@pytest.mark.parametrize("way", WAYS)
def test_a_compressed_mesh_is_the_plain_one(tmp_path, way, suffix):
    vertices, faces, attributes = hill()
    path = compressed(vertices, faces, attributes, **WAYS[way]).save(tmp_path / f"scene{suffix}")
    found = dapple.read_mesh(path)
    assert len(found.faces) == len(faces)
    assert len(found.vertices) == len(vertices)
    # z is up: what was (x, y, z) is (x, -z, y)
    x, z = (found.vertices[found.faces][:, :, k] for k in (0, 2))
    np.testing.assert_allclose(
        found.vertices[:, 1],
        -np.prod([found.vertices[:, k] * (1 - found.vertices[:, k]) for k in (0, 2)], axis=0),
        atol=1e-5,
    )
    areas = 0.5 * np.cross(*(np.diff(np.stack([x, z], -1), axis=1).swapaxes(0, 1)))
    np.testing.assert_allclose(areas, 0.5 / (COUNT - 1) ** 2, rtol=1e-3)  # none is turned over
    np.testing.assert_allclose(found.uv, np.stack([x, 1 - z], -1), atol=1e-5)
    colors = np.floor(255 * np.stack([x, z], -1) + 1e-3) / 255
    np.testing.assert_allclose(found.colors[..., :2], colors, atol=1e-5)
    slope = np.stack([x - 0.5, -np.ones_like(x), z - 0.5], -1)
    slope /= np.linalg.norm(slope, axis=-1, keepdims=True)
    np.testing.assert_allclose(found.normals, slope, atol=1e-4)
    done("sample", path, tmp_path / "out.csv", "-n", 20)


def test_skinned_meshes_stand_as_their_joints_do(tmp_path):
    joints = np.array([[0, 0, 0, 0], [0, 0, 0, 0], [1, 0, 0, 0], [1, 0, 0, 0]], np.uint16)
    weights = np.array([[1, 0, 0, 0]] * 4, np.float32)
    scene = compressed(SQUARE, HALVES, others={"JOINTS_0": joints, "WEIGHTS_0": weights})
    scene.tree["nodes"][0]["skin"] = 0
    scene.add("skins", joints=[1, 2])
    scene.add("nodes", translation=[0, 0, 0])
    scene.add("nodes", translation=[0, 2, 0])
    found = dapple.read_mesh(scene.save(tmp_path / "scene.glb", roots=(0, 1, 2)))
    assert sorted(np.round(found.vertices[:, 2], 4)) == [0, 0, 3, 3]


def test_nodes_share_a_compressed_mesh(tmp_path):
    scene = compressed(SQUARE, HALVES)
    scene.add("nodes", mesh=0, translation=[2, 0, 0])
    found = dapple.read_mesh(scene.save(tmp_path / "scene.glb", roots=(0, 1)))
    assert dapple.Surface(*found).area == pytest.approx(2, rel=1e-4)


def test_compressed_integers_are_dequantized(tmp_path):
    # gltfpack and others quantize first
    scene = compressed(32767 * np.array(SQUARE), HALVES, quantization_bits=16)
    accessor_of(scene).update(componentType=5122, normalized=True)
    primitive_of(scene)["extensions"][EXTENSION]["attributes"] = {"POSITION": 0}
    block = draco.encode(32767 * np.array(SQUARE), np.array(HALVES, np.uint32))
    found = dapple.read_mesh(with_block(scene, block).save(tmp_path / "scene.glb"))
    assert dapple.Surface(*found).area == pytest.approx(1)


@pytest.mark.parametrize("change", [{"mode": 5}, {"indices": None}])
def test_compressed_triangles_need_no_list_of_indices(tmp_path, change):
    # a strip is compressed as triangles too
    scene = compressed(*hill()[:2])
    primitive_of(scene).update(change)
    if primitive_of(scene)["indices"] is None:
        del primitive_of(scene)["indices"]
    else:
        scene.tree["accessors"][primitive_of(scene)["indices"]]["count"] = 5
    found = dapple.read_mesh(scene.save(tmp_path / "scene.glb"))
    assert len(found.faces) == 2 * (COUNT - 1) ** 2


def test_plain_arrays_beside_compressed_ones_need_no_library(tmp_path, monkeypatch):
    scene = compressed(SQUARE, HALVES)
    plain = Scene.mesh(scene, SQUARE, HALVES)
    extensions = primitive_of(scene)["extensions"]
    scene.tree["meshes"][plain]["primitives"][0]["extensions"] = extensions
    scene.tree["meshes"].pop(0)
    del scene.tree["extensionsRequired"]
    monkeypatch.setitem(sys.modules, "DracoPy", None)
    found = dapple.read_mesh(scene.save(tmp_path / "scene.glb"))
    np.testing.assert_array_equal(found.vertices[:, [0, 2]], np.array(SQUARE)[:, :2])


def test_compressed_meshes_show_instances(tmp_path):
    vertices, faces, attributes = hill()
    plant = compressed(vertices, faces, attributes).save(tmp_path / "plant.glb")
    gltf.write(tmp_path / "points.gltf", Instances(np.eye(3)), prototypes=[Reference(plant)])
    text = (tmp_path / "points.gltf").read_text()
    assert EXTENSION not in text
    document = files.load(tmp_path / "points.gltf")
    primitive = document.tree["meshes"][0]["primitives"][0]
    assert len(document.array(primitive["indices"])) == 3 * len(faces)
    for name in ("POSITION", *attributes):
        entry = document.tree["accessors"][primitive["attributes"][name]]
        assert document.tree["bufferViews"][entry["bufferView"]].get("byteStride", 4) % 4 == 0
    wanted = attributes["TEXCOORD_0"][np.lexsort(attributes["TEXCOORD_0"].T)]
    found = document.array(primitive["attributes"]["TEXCOORD_0"])
    np.testing.assert_allclose(found[np.lexsort(np.round(found, 4).T)], wanted, atol=1e-5)
    colors = document.array(primitive["attributes"]["COLOR_0"])
    np.testing.assert_allclose(colors, np.floor(255 * np.column_stack([found, 0 * found[:, 0]])
                                                + 1e-3) / 255, atol=1e-5)  # fmt: skip


def test_prototypes_say_what_to_install(tmp_path, monkeypatch):
    plant = compressed(SQUARE, HALVES).save(tmp_path / "plant.glb")
    monkeypatch.setitem(sys.modules, "DracoPy", None)
    with pytest.raises(ValueError, match=r'plant\.glb: its .* pip install "dapple3d\[draco\]"'):
        gltf.write(tmp_path / "points.glb", Instances(np.eye(3)), prototypes=[Reference(plant)])


def vary(number):
    """A number as Draco writes it, 7 bits a byte."""
    found = bytearray()
    while number >= 0x80:
        found.append(number & 0x7F | 0x80)
        number >>= 7
    return bytes([*found, number])


def head(method, *numbers):
    """The beginning of a mesh of the version that glTF has."""
    return b"DRACO" + bytes([2, 2, 1, method, 0, 0]) + b"".join(map(vary, numbers))


@pytest.mark.parametrize("way", ["sequential", "edgebreaker"])
@pytest.mark.parametrize(("name", "count"), [("indices", 9), ("indices", 3), ("POSITION", 5)])
def test_other_counts_than_those_of_the_accessors_are_refused(tmp_path, way, name, count):
    scene = compressed(SQUARE, HALVES, **WAYS[way])
    number = primitive_of(scene)["indices"] if name == "indices" else 0
    scene.tree["accessors"][number]["count"] = count
    said = said_of(scene, tmp_path)
    if name == "indices":
        assert said == f"its Draco data promises 2 triangles for {count} indices"
    elif way == "sequential":
        assert said == "its Draco data promises 4 vertices for 5"
    else:
        assert said == "its Draco data has 4 POSITION, its accessors 5 and 5"


@pytest.mark.parametrize(
    "start",
    [head(0, 400_000_000, 600_000_000), head(1, 0, 600_000_000, 400_000_000)],
    ids=["sequential", "edgebreaker"],
)
@pytest.mark.parametrize("agree", [True, False])
def test_vast_counts_are_refused_before_anything_is_allocated(tmp_path, start, agree):
    scene = with_block(compressed(SQUARE, HALVES), start + bytes(100))
    if agree:
        accessor_of(scene)["count"] = 600_000_000
        scene.tree["accessors"][primitive_of(scene)["indices"]]["count"] = 1_200_000_000
    said = said_of(scene, tmp_path)
    assert said.startswith("its Draco data promises 400000000 triangles")
    assert said.endswith(f"in {len(start) + 100} bytes" if agree else "for 6 indices")


HEADS = {
    "nothing": (b"", "its Draco data does not begin with DRACO"),
    "other letters": (b"draco" + bytes(50), "its Draco data does not begin with DRACO"),
    "half a version": (b"DRACO\2", "its Draco data ends in its head"),
    "an old version": (b"DRACO\1\1\1\1\0\0", "its Draco data has version 1.1: 2.2 is known"),
    "points": (draco.encode(np.array(SQUARE, float)), "its Draco data holds no mesh"),
    "no counts": (head(0), "its Draco data ends in its head"),
    "a long count": (head(0) + b"\xff" * 9, "its Draco data has a number of more than 32 bits"),
    "no faces": (head(0, 2, 4) + b"\1", "its Draco data cannot be decompressed"),
    "metadata of many": (head(0)[:-1] + b"\x80" + vary(MANY), "its Draco data ends in its head"),
    "many entries": (head(0)[:-1] + b"\x80\0" + vary(MANY), "its Draco data ends in its head"),
    "many groups": (head(0)[:-1] + b"\x80\0\0" + vary(MANY), "its Draco data ends in its head"),
}


@pytest.mark.parametrize("case", HEADS)
def test_what_is_no_data_of_draco_is_refused(tmp_path, case):
    block, said = HEADS[case]
    assert said_of(with_block(compressed(SQUARE, HALVES), block), tmp_path).startswith(said)


@pytest.mark.parametrize("way", WAYS)
def test_data_that_ends_early_is_refused(tmp_path, way):
    block = draco.encode(np.array(SQUARE, float), np.array(HALVES, np.uint32), **WAYS[way])
    for length in range(len(block)):
        scene = with_block(compressed(SQUARE, HALVES), block[:length])
        assert said_of(scene, tmp_path).startswith("its Draco data ")


def lie_about_number(scene):
    primitive_of(scene)["extensions"][EXTENSION]["attributes"]["POSITION"] = 99


def lie_about_width(scene):
    accessor_of(scene)["type"] = "VEC2"


def lie_about_type(scene):
    accessor_of(scene)["componentType"] = 5121


def lie_about_mode(scene):
    primitive_of(scene)["mode"] = 6


def lie_about_length(scene):
    scene.tree["bufferViews"][0]["byteLength"] += 100


def lie_about_uv(scene):
    accessor_of(scene, "TEXCOORD_0")["count"] = 7


@pytest.mark.parametrize(
    ("lie", "said"),
    [
        (lie_about_number, "its Draco data has no attribute 99, which is POSITION"),
        (lie_about_width, "its Draco data has 3 numbers for each of POSITION"),
        (lie_about_type, "its Draco data has POSITION that their accessor cannot hold"),
        (lie_about_mode, "mode is 6: Draco compresses triangles, 4 or 5"),
        (lie_about_length, "its Draco data has "),
        (lie_about_uv, "its Draco data has 4 TEXCOORD_0, its accessors 4 and 7"),
    ],
)
def test_lies_about_the_data_are_refused(tmp_path, lie, said):
    uv = np.array(SQUARE, float)[:, :2]
    scene = compressed(300 * np.array(SQUARE), HALVES, {"TEXCOORD_0": uv})
    lie(scene)
    assert said_of(scene, tmp_path).startswith(said)


def test_a_vertex_that_is_not_there_is_refused(tmp_path):
    # three triangles of four vertices, one of which is the fifth
    block = bytearray(draco.encode(np.array(SQUARE, float), np.array(HALVES, np.uint32),
                                   preserve_order=True))  # fmt: skip
    at = block.index(bytes([0, 1, 2, 0, 2, 3]))
    block[at + 5] = 9
    said = said_of(with_block(compressed(SQUARE, HALVES), bytes(block)), tmp_path)
    assert said.startswith(("its Draco data cannot be decompressed", "an index is 9"))


def test_entries_of_the_extension_that_are_wrong_are_named(tmp_path):
    for change in (
        {"bufferView": 9},
        {"bufferView": None},
        {"attributes": 5},
        {"attributes": {"POSITION": "x"}},
    ):
        scene = compressed(SQUARE, HALVES)
        primitive_of(scene)["extensions"][EXTENSION].update(change)
        said_of(scene, tmp_path)
    scene = compressed(SQUARE, HALVES)
    primitive_of(scene)["extensions"][EXTENSION] = json.loads("[]")
    said_of(scene, tmp_path)
