# SPDX-License-Identifier: GPL-3.0-or-later
"""Files as other programs write them, by the package and by the command line."""

import json
import pickle
import struct
import sys

import dapple3d as dapple
import numpy as np
import pytest
from command_line import done, refused
from dapple3d.cli import points
from dapple3d.extras import gltf
from gltf_scene import HALVES, SQUARE, TYPES, Scene

FLOOR = [(0, 0), (3, 0), (3, 3), (2, 3), (2, 1), (1, 1), (1, 3), (0, 3)]  # with a notch
CORNERS = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
SIDES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


def floor_text(suffix):
    """The floor as one polygon, as OBJ, OFF or PLY; in OBJ with texture coordinates."""
    places = [f"{x} {y} 0" for x, y in FLOOR]
    if suffix == ".obj":
        lines = [f"v {place}" for place in places] + [f"vt {x / 3} {y / 3}" for x, y in FLOOR]
        return "\n".join([*lines, "f " + " ".join(f"{k}/{k}" for k in range(1, 9))]) + "\n"
    polygon = "8 0 1 2 3 4 5 6 7"
    if suffix == ".off":
        return "\n".join(["OFF", "8 1 0", *places, polygon]) + "\n"
    header = "ply\nformat ascii 1.0\nelement vertex 8\n"
    header += "".join(f"property float {axis}\n" for axis in "xyz")
    header += "element face 1\nproperty list uchar int vertex_indices\nend_header"
    return "\n".join([header, *places, polygon]) + "\n"


@pytest.mark.parametrize("suffix", [".obj", ".off", ".ply"])
def test_nothing_stands_in_the_notch_of_a_floor(tmp_path, suffix):
    path = tmp_path / f"floor{suffix}"
    path.write_text(floor_text(suffix))
    assert dapple.Surface(*dapple.read_mesh(path)).area == pytest.approx(7)
    done("sample", path, tmp_path / "out.npz", "-n", 1000)
    x, y, _ = np.load(tmp_path / "out.npz")["positions"].T
    assert np.count_nonzero((x > 1) & (x < 2) & (y > 1)) == 0


def test_a_polygon_keeps_its_texture_coordinates_and_its_number(tmp_path):
    path = tmp_path / "floor.obj"
    path.write_text(floor_text(".obj"))
    mesh = dapple.read_mesh(path)
    np.testing.assert_allclose(mesh.uv * 3, mesh.vertices[mesh.faces][:, :, :2])
    assert mesh.polygons.tolist() == [0] * 6
    assert mesh.normals is None
    assert mesh.colors is None
    for other in (pickle.loads(pickle.dumps(mesh)),):
        np.testing.assert_array_equal(other.uv, mesh.uv)
        np.testing.assert_array_equal(other.faces, mesh.faces)


def test_a_mesh_is_a_pair(tmp_path, mesh):
    path = tmp_path / "mesh.ply"
    dapple.write_mesh(path, *mesh)
    vertices, faces = found = dapple.read_mesh(path)
    assert vertices is found.vertices
    assert faces is found.faces
    assert len(found) == 2


@pytest.mark.parametrize("coding", ["utf-8-sig", "utf-16"])
@pytest.mark.parametrize("end", ["\n", "\r", "\r\n"])
@pytest.mark.parametrize("suffix", [".obj", ".off", ".ply"])
def test_text_of_any_system(tmp_path, suffix, coding, end):
    path = tmp_path / f"floor{suffix}"
    path.write_bytes(floor_text(suffix).replace("\n", end).encode(coding))
    done("sample", path, tmp_path / "out.csv", "-n", 50)
    assert dapple.Surface(*dapple.read_mesh(path)).area == pytest.approx(7)


def test_an_stl_loses_no_triangle(tmp_path):
    vertices, faces = np.array(CORNERS, float), np.array(SIDES)[:, [[0, 1, 2], [0, 2, 3]]]
    path = tmp_path / "cube.stl"
    dapple.write_mesh(path, vertices, faces.reshape(-1, 3))
    content = path.read_bytes()
    path.write_bytes(content[:80] + struct.pack("<I", 5) + content[84:])
    assert len(dapple.read_mesh(path).faces) == 12
    path.write_bytes(content[:80] + struct.pack("<I", 20) + content[84:])
    said = refused("sample", path, tmp_path / "out.csv", "-n", 10)
    assert f"{path}: is not an STL file, or is cut off: it declares 20 triangles" in said


def test_a_property_of_the_faces_of_a_ply_is_a_density(tmp_path):
    path = tmp_path / "floor.ply"
    path.write_text(
        "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\n"
        "property float z\nelement face 2\nproperty list uchar int vertex_indices\n"
        "property float fur\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 0 0\n2 1 0\n"
        "4 0 1 2 3 0\n4 1 4 5 2 1\n"
    )
    done("sample", path, tmp_path / "out.csv", "-n", 60, "--density", "fur", "--attributes")
    found = points.text.read_csv(tmp_path / "out.csv")
    assert found["x"].min() >= 1
    assert set(found["polygon"]) == {1}
    assert set(found["fur"]) == {1}


PLACES = [(0.5, 0.5), (0.25, 0.75), (0.125, 0.5)]


@pytest.mark.parametrize(
    "text",
    [
        "x;y\n0.5;0.5\n0.25;0.75\n0.125;0.5\n",
        "x\ty\n0.5\t0.5\n0.25\t0.75\n0.125\t0.5\n",
        "X,Y\r0.5,0.5\r0.25,0.75\r0.125,0.5\r",
        "x;y\n0,5;0,5\n0,25;0,75\n0,125;0,5\n",
        "sep=;\nX;Y\n0,5;0,5\n0,25;0,75\n0,125;0,5\n",
        "x;y;\n0.5;0.5;\n0.25;0.75;\n0.125;0.5;\n",
        "0,5\t0,5\n0,25\t0,75\n0,125\t0,5\n",
        "\ufeff//X,Y\n0.5,0.5\n0.25,0.75\n0.125,0.5\n",
    ],
)
@pytest.mark.parametrize("coding", ["utf-8", "utf-16"])
def test_tables_as_spreadsheets_write_them(tmp_path, text, coding):
    path = tmp_path / "table.csv"
    path.write_bytes(text.encode(coding))
    np.testing.assert_array_equal(points.read_points(path).positions, PLACES)


@pytest.mark.parametrize("word", ["1,234.5", "1,234,567", "0,5"])
def test_a_comma_that_could_mean_anything_is_refused(tmp_path, word):
    path = tmp_path / "table.csv"
    path.write_text(f"x;y\n0.5;{word}\n1;1\n")
    assert f"line 2 holds no number: '{word}'" in refused("analyze", path)


def test_names_of_columns_in_capitals(tmp_path):
    path = tmp_path / "table.csv"
    path.write_text("X,Y,Z,ID,Class\n0,0,1,7,1\n")
    found = points.read_points(path)
    assert found.ids.tolist() == [7]
    assert found.classes.tolist() == [1]


def test_points_of_a_ply_with_faces_before_its_vertices(tmp_path):
    path = tmp_path / "points.ply"
    path.write_text(
        "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\n"
        "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "property int64 id\nend_header\n3 0 1 2\n0 0 0 4\n1 0 0 5\n0 1 0 6\n"
    )
    found = points.read_points(path)
    assert found.ids.tolist() == [4, 5, 6]
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes().replace(b"\n", b"\r"))
    np.testing.assert_array_equal(points.read_points(path).positions, found.positions)


@pytest.mark.parametrize("head", ["OFF3 0 0\n", "OFF 3 0 0\n", "\ufeffOFF\r3 0 0\r"])
def test_points_of_an_off_with_its_counts_in_the_first_line(tmp_path, head):
    path = tmp_path / "points.off"
    path.write_text(f"{head}0 0 0\n1 0 0\n0 1 0\n", newline="")
    assert len(points.read_points(path).positions) == 3


# Attributes


@pytest.fixture
def colored(tmp_path):
    """Two quads with texture coordinates, colors and a number for each vertex."""
    path = tmp_path / "colored.ply"
    rows = [f"{x} {y} 0 {x / 2} {y} {255 * (x > 1)} 0 51 {x + y}" for y in (0, 1) for x in range(3)]
    path.write_text(
        "ply\nformat ascii 1.0\nelement vertex 6\n"
        + "".join(f"property float {name}\n" for name in ("x", "y", "z", "s", "t"))
        + "".join(f"property uchar {name}\n" for name in ("red", "green", "blue"))
        + "property double wet\nelement face 2\nproperty list uchar int vertex_indices\n"
        "property int part\nend_header\n" + "\n".join(rows) + "\n4 0 1 4 3 7\n4 1 2 5 4 9\n"
    )
    return path


@pytest.mark.parametrize("suffix", [".npz", ".csv", ".ply"])
def test_points_carry_the_attributes_of_the_mesh(tmp_path, colored, suffix):
    out = tmp_path / f"out{suffix}"
    done("sample", colored, out, "-n", 40, "--attributes")
    found = points.read_points(out)
    x, y, _ = found.positions.T
    np.testing.assert_allclose(found.uv, np.column_stack([x / 2, y]), atol=1e-12)
    np.testing.assert_array_equal(found.polygons, (x > 1).astype(int))
    coarse = 1 / 255 if suffix == ".ply" else 1e-6
    np.testing.assert_allclose(found.colors[:, 0], np.clip(x - 1, 0, 1), atol=coarse)
    np.testing.assert_allclose(found.colors[:, 2:], [[0.2, 1.0]] * 40, atol=coarse)
    if suffix != ".npz":
        read = points.ply.read if suffix == ".ply" else points.text.read_csv
        columns = read(out)
    else:
        columns = dict(np.load(out))
    np.testing.assert_allclose(columns["wet"], x + y, atol=1e-12)
    np.testing.assert_array_equal(columns["part"], np.where(x > 1, 9, 7))


@pytest.mark.parametrize("suffix", [".obj", ".off"])
def test_formats_with_less_room_carry_texture_coordinates_and_colors(tmp_path, colored, suffix):
    out = tmp_path / f"out{suffix}"
    done("sample", colored, out, "-n", 40, "--attributes")
    found = points.read_points(out)
    x, y, _ = found.positions.T
    np.testing.assert_allclose(found.uv, np.column_stack([x / 2, y]), atol=1e-12)
    np.testing.assert_allclose(found.colors[:, 0], np.clip(x - 1, 0, 1), atol=1e-6)


def test_points_carry_the_arrays_of_an_npz(tmp_path):
    vertices = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    arrays = {"uv": vertices[faces][:, :, :2], "wind": vertices, "part": np.array([4, 6])}
    np.savez(tmp_path / "mesh.npz", vertices=vertices, faces=faces, **arrays, other=np.ones(9))
    done("sample", tmp_path / "mesh.npz", tmp_path / "out.npz", "-n", 30, "--attributes")
    found = np.load(tmp_path / "out.npz")
    np.testing.assert_allclose(found["uv"], found["positions"][:, :2], atol=1e-12)
    np.testing.assert_allclose(found["wind"], found["positions"], atol=1e-12)
    np.testing.assert_array_equal(found["part"], np.array([4, 6])[found["faces"]])
    assert "other" not in found
    done("sample", tmp_path / "mesh.npz", tmp_path / "out.csv", "-n", 30, "--attributes")
    assert "wind_2" in (tmp_path / "out.csv").read_text()


def test_a_mesh_without_attributes_says_so(tmp_path, mesh):
    np.savez(tmp_path / "mesh.npz", vertices=mesh[0], faces=mesh[1])
    out = tmp_path / "out.npz"
    said = refused("sample", tmp_path / "mesh.npz", out, "-n", 30, "--attributes")
    assert "mesh.npz: has no texture coordinates, colors, polygons or other attributes" in said
    assert not out.exists()


# glTF


def area_of(path):
    return dapple.Surface(*dapple.read_mesh(path)).area


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
def test_gltf_nodes_stand_where_their_parents_put_them(tmp_path, suffix):
    scene = Scene()
    mesh = scene.mesh(SQUARE, HALVES)
    child = scene.add("nodes", mesh=mesh, translation=[0, 0, 1])
    root = scene.add("nodes", children=[child], scale=[2, 2, 2], translation=[5, 0, 0])
    scene.add("nodes", mesh=mesh, matrix=[-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 3, 0, 1])
    path = scene.save(tmp_path / f"scene{suffix}", roots=(root, 2))
    found = dapple.read_mesh(path)
    assert found.faces.shape == (4, 3)
    assert area_of(path) == pytest.approx(5)
    np.testing.assert_allclose(found.vertices[0], [5, -2, 0])  # y up becomes z up
    np.testing.assert_allclose(found.vertices[5], [-1, 0, 3])
    triangles = found.vertices[found.faces]
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    assert (normals[:, 1] < 0).all()  # matrices that mirror are included
    done("sample", path, tmp_path / "out.glb", "-n", 30)
    assert gltf.read(tmp_path / "out.glb").positions[:, 1].min() == pytest.approx(-2)


def test_gltf_without_a_scene_has_all_its_nodes(tmp_path):
    scene = Scene()
    scene.add("nodes", mesh=scene.mesh(SQUARE, HALVES))
    path = scene.save(tmp_path / "scene.gltf")
    tree = json.loads(path.read_text())
    path.write_text(json.dumps({name: tree[name] for name in tree if "scene" not in name}))
    assert area_of(path) == pytest.approx(1)


@pytest.mark.parametrize(
    ("mode", "indices"), [(4, [0, 1, 2, 0, 2, 3]), (5, [0, 1, 3, 2]), (6, [0, 1, 2, 3])]
)
def test_gltf_has_lists_strips_and_fans(tmp_path, mode, indices):
    scene = Scene()
    scene.add("nodes", mesh=scene.mesh(SQUARE, indices, mode=mode))
    found = dapple.read_mesh(scene.save(tmp_path / "scene.glb"))
    triangles = found.vertices[found.faces]
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    np.testing.assert_allclose(normals, [[0, -1, 0]] * 2, atol=1e-12)


def test_gltf_triangles_without_indices_and_lines_beside_them(tmp_path):
    scene = Scene()
    mesh = scene.mesh(np.array(SQUARE)[np.ravel(HALVES)])
    lines = scene.tree["meshes"][mesh]["primitives"]
    lines.append({"attributes": {"POSITION": scene.array(SQUARE)}, "mode": 1})
    scene.add("nodes", mesh=mesh)
    assert area_of(scene.save(tmp_path / "scene.glb")) == pytest.approx(1)


def test_gltf_buffers_in_files_beside_it(tmp_path):
    scene = Scene()
    scene.add("nodes", mesh=scene.mesh(SQUARE, HALVES))
    path = scene.save(tmp_path / "scene.gltf", buffer={"uri": "a%20file.bin"})
    assert f"{path}: could not be read as glTF" in refused(
        "sample", path, tmp_path / "o.csv", "-n9"
    )
    (tmp_path / "a file.bin").write_bytes(scene.blob)
    assert area_of(path) == pytest.approx(1)
    tree = json.loads(path.read_text())
    tree["buffers"].insert(0, {"byteLength": 3, "uri": "data:;base64,AAAA"})
    for view in tree["bufferViews"]:
        view["buffer"] = 1
    path.write_text(json.dumps(tree))
    assert area_of(path) == pytest.approx(1)


def test_gltf_keeps_texture_coordinates_normals_and_colors(tmp_path):
    scene = Scene()
    attributes = {
        "TEXCOORD_0": scene.array([[0, 1], [1, 1], [1, 0], [0, 0]]),
        "NORMAL": scene.array([[0, 0.6, 0.8]] * 4),
        "COLOR_0": scene.array([[255, 0, 51, 255]] * 4, "u1", normalized=True),
    }
    scene.add("nodes", mesh=scene.mesh(SQUARE, HALVES, attributes=attributes))
    scene.add("nodes", mesh=scene.mesh(SQUARE, HALVES), translation=[0, 0, 2])
    found = dapple.read_mesh(scene.save(tmp_path / "scene.glb", roots=(0, 1)))
    np.testing.assert_allclose(found.uv[:2, :, 1], found.vertices[found.faces][:2, :, 2])
    np.testing.assert_allclose(found.normals[:2], [[[0, -0.8, 0.6]] * 3] * 2, atol=1e-7)
    np.testing.assert_allclose(found.colors[:2], [[[1, 0, 0.2, 1]] * 3] * 2, atol=1e-6)
    assert (found.uv[2:] == 0).all()
    assert (found.normals[2:] == 0).all()
    assert (found.colors[2:] == 1).all()


def test_gltf_sparse_accessors(tmp_path):
    scene = Scene()
    mesh = scene.mesh(SQUARE, HALVES)
    sparse = {
        "count": 1,
        "indices": {"bufferView": scene.view(np.array([2], "<u2")), "componentType": 5123},
        "values": {"bufferView": scene.view(np.array([[3, 3, 0]], "<f4"))},
    }
    scene.tree["accessors"][0]["sparse"] = sparse
    scene.add("nodes", mesh=mesh)
    assert area_of(scene.save(tmp_path / "scene.glb")) == pytest.approx(3)


def test_gltf_skinned_meshes_stand_as_their_joints_do(tmp_path):
    scene = Scene()
    attributes = {
        "JOINTS_0": scene.array([[0, 0, 0, 0], [0, 0, 0, 0], [1, 0, 0, 0], [1, 0, 0, 0]], "u1"),
        "WEIGHTS_0": scene.array([[1, 0, 0, 0]] * 4),
    }
    mesh = scene.mesh(SQUARE, HALVES, attributes=attributes)
    inverse = [np.eye(4), np.eye(4)]
    inverse[1][:3, 3] = [0, -1, 0]
    scene.add("skins", joints=[1, 2], inverseBindMatrices=scene.array(
        [np.ravel(one.T) for one in inverse]))  # fmt: skip
    # glTF ignores the transform of skinned nodes
    scene.add("nodes", mesh=mesh, skin=0, translation=[100, 0, 0])
    scene.add("nodes", children=[2])
    scene.add("nodes", translation=[0, 2, 0])
    found = dapple.read_mesh(scene.save(tmp_path / "scene.glb", roots=(0, 1)))
    np.testing.assert_allclose(found.vertices[:, 2], [0, 0, 2, 2])
    np.testing.assert_allclose(found.vertices[:, 0], [0, 1, 1, 0])


@pytest.mark.parametrize("weight", [np.nan, 0.0])
def test_gltf_vertices_without_weights_follow_the_first_joint(tmp_path, weight):
    # FBX2glTF writes NaN, which is zero by zero, where an artist has painted no weights
    scene = Scene()
    attributes = {
        "JOINTS_0": scene.array(np.zeros((4, 4)), "u1"),
        "WEIGHTS_0": scene.array([[1, 0, 0, 0]] * 3 + [[weight] * 4]),
    }
    mesh = scene.mesh(SQUARE, HALVES, attributes=attributes)
    scene.add("skins", joints=[1])
    scene.add("nodes", mesh=mesh, skin=0)
    scene.add("nodes", scale=[100, 100, 100])
    found = dapple.read_mesh(scene.save(tmp_path / "scene.glb", roots=(0, 1)))
    np.testing.assert_allclose(found.vertices[:, [0, 2]], 100 * np.array(SQUARE)[:, :2])


def test_gltf_instances_of_a_mesh_are_there(tmp_path):
    scene = Scene()
    places = scene.array([[0, 0, 0], [3, 0, 0], [6, 0, 0]])
    extensions = {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places}}}
    scene.add("nodes", mesh=scene.mesh(SQUARE, HALVES), extensions=extensions)
    assert area_of(scene.save(tmp_path / "scene.glb")) == pytest.approx(3)


@pytest.mark.parametrize("normalized", [True, False])
@pytest.mark.parametrize("dtype", ["i1", "u1", "<i2", "<u2"])
def test_gltf_of_quantized_numbers_is_read(tmp_path, dtype, normalized):
    # KHR_mesh_quantization: the node brings the numbers back, and rows begin at multiples of 4
    scene, most, step = Scene(), np.iinfo(dtype).max, np.dtype(dtype).itemsize
    positions = np.zeros((4, 4), dtype)
    positions[:, :2] = most * np.array(SQUARE)[:, :2]
    normals = np.array([[0, 0, 127, 0]] * 4, "i1")
    corners = np.array(SQUARE)[:, :2] * 65535
    view = scene.view(positions)
    scene.tree["bufferViews"][view]["byteStride"] = 4 * step
    upward = scene.view(normals)
    scene.tree["bufferViews"][upward]["byteStride"] = 4
    rows = {"count": 4, "type": "VEC3"}
    attributes = {
        "POSITION": scene.add("accessors", bufferView=view, componentType=TYPES[dtype],
                              normalized=normalized, **rows),
        "NORMAL": scene.add("accessors", bufferView=upward, componentType=TYPES["i1"],
                            normalized=True, **rows),
        "TEXCOORD_0": scene.array(corners, "<u2", normalized=True),
    }  # fmt: skip
    mesh = scene.mesh(SQUARE, HALVES, attributes=attributes)
    scene.tree["extensionsRequired"] = ["KHR_mesh_quantization"]
    scene.add("nodes", mesh=mesh, scale=[3.0 if normalized else 3.0 / most] * 3)
    found = dapple.read_mesh(scene.save(tmp_path / "scene.glb"))
    np.testing.assert_allclose(found.vertices[:, [0, 2]], 3 * np.array(SQUARE)[:, :2], atol=1e-12)
    normals = found.normals / np.linalg.norm(found.normals, axis=2, keepdims=True)
    np.testing.assert_allclose(normals, np.tile([0.0, -1, 0], (2, 3, 1)), atol=1e-12)
    np.testing.assert_allclose(found.uv[..., 0], np.array(SQUARE)[HALVES][..., 0], atol=1e-12)
    np.testing.assert_allclose(found.uv[..., 1], 1 - np.array(SQUARE)[HALVES][..., 1], atol=1e-12)


def test_gltf_of_draco_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "DracoPy", None)
    scene = Scene()
    mesh = scene.mesh(SQUARE, HALVES)
    extension = {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}}
    scene.tree["meshes"][mesh]["primitives"][0]["extensions"] = extension
    scene.tree["extensionsRequired"] = ["KHR_draco_mesh_compression"]
    scene.add("nodes", mesh=mesh)
    path = scene.save(tmp_path / "scene.glb")
    said = refused("sample", path, tmp_path / "out.csv", "-n", 10)
    assert f"{path}: its meshes are compressed by Draco (KHR_draco_mesh_compression)" in said
    assert said.endswith('needs DracoPy, which is missing: pip install "dapple3d[draco]"\n')


def test_gltf_of_meshoptimizer_says_so(tmp_path):
    # gltfpack gives the buffer that decompression would fill no bytes
    scene = Scene()
    scene.add("nodes", mesh=scene.mesh(SQUARE, HALVES))
    scene.tree["extensionsRequired"] = ["EXT_meshopt_compression"]
    path = scene.save(tmp_path / "scene.gltf")
    tree = json.loads(path.read_text())
    fallback = {"EXT_meshopt_compression": {"fallback": True}}
    tree["buffers"].append({"byteLength": 96, "extensions": fallback})
    path.write_text(json.dumps(tree))
    said = refused("sample", path, tmp_path / "out.csv", "-n", 10)
    assert f"{path}: its meshes are compressed by meshoptimizer (EXT_meshopt_compression)" in said


def test_gltf_of_the_first_version_says_so(tmp_path):
    path = tmp_path / "scene.gltf"
    path.write_text('{"asset": {"version": "1.0"}, "nodes": {"box": {}}, "scenes": {}}')
    said = refused("sample", path, tmp_path / "out.csv", "-n", 10)
    assert f"{path}: is of glTF 1.0, which is not read: save it as glTF 2.0" in said


@pytest.mark.parametrize("content", [b"", b"glTF", b"{}", b"[]", b'{"nodes": [{"children": [0]}]}'])
def test_gltf_that_is_none_is_refused(tmp_path, content):
    path = tmp_path / "scene.gltf"
    path.write_bytes(content)
    with pytest.raises(dapple.FileError, match=r"scene\.gltf"):
        dapple.read_mesh(path)


def test_gltf_with_a_wrong_index_is_refused(tmp_path):
    scene = Scene()
    scene.add("nodes", mesh=scene.mesh(SQUARE, [[0, 1, 9]]))
    with pytest.raises(dapple.FileError, match="an index is 9: there are 4"):
        dapple.read_mesh(scene.save(tmp_path / "scene.glb"))
