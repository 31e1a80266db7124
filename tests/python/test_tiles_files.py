# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces that are read from files piece by piece."""

import pickle

import dapple3d as dapple
import numpy as np
import pytest
import shapes
from dapple3d.extras.distributed import HeightField, open_surface, sample_tiles, streams
from test_tiles import TILE, contents, gathered, hills, whole

HEIGHTS = np.array(hills(60, 80).heights)
WEIGHTS = np.linspace(1.0, 2.0, HEIGHTS.size).reshape(HEIGHTS.shape)


def write_tiff(path, heights, **given):
    rasterio = pytest.importorskip("rasterio")
    place = rasterio.Affine(2.0, 0.0, 500.0, 0.0, -3.0, 900.0)
    profile = {"driver": "GTiff", "count": 1, "dtype": "float64", "transform": place, **given}
    rows, columns = heights.shape
    with rasterio.open(path, "w", height=rows, width=columns, **profile) as file:
        file.write(heights, 1)
    return path


def same(first, second):
    """Whether two surfaces are read as the same faces."""
    a, b = whole(first), whole(second)
    values = zip(vars(a).values(), vars(b).values(), strict=True)
    return all(np.array_equal(x, y) for x, y in values)


def part(surface):
    return surface.read((10.0, 30.0), (20.0, 45.0))


def test_heights_of_npy_are_those_of_the_array(tmp_path):
    np.save(tmp_path / "hills.npy", HEIGHTS)
    np.save(tmp_path / "trees.npy", WEIGHTS)
    found = open_surface(
        tmp_path / "hills.npy", tmp_path, density=tmp_path / "trees.npy", step=(0.5, 2.0)
    )
    assert same(found, HeightField(HEIGHTS, (0.5, 2.0), density=WEIGHTS))


def test_heights_that_are_no_real_numbers_are_refused(tmp_path):
    np.save(tmp_path / "heights.npy", np.zeros((9, 9), complex))
    with pytest.raises(ValueError, match=r"heights\.npy: holds complex128: real numbers"):
        open_surface(tmp_path / "heights.npy", tmp_path / "work")


def test_heights_of_zarr_are_those_of_the_array(tmp_path):
    zarr = pytest.importorskip("zarr")
    zarr.save_array(tmp_path / "hills.zarr", HEIGHTS)
    assert same(open_surface(tmp_path / "hills.zarr", tmp_path), HeightField(HEIGHTS))


def test_a_group_of_zarr_brings_its_density(tmp_path):
    zarr = pytest.importorskip("zarr")
    zarr.save_group(tmp_path / "hills.zarr", heights=HEIGHTS, density=WEIGHTS)
    found = open_surface(tmp_path / "hills.zarr", tmp_path)
    assert same(found, HeightField(HEIGHTS, density=WEIGHTS))


def test_a_geotiff_says_where_it_is_and_what_is_missing(tmp_path):
    heights = HEIGHTS.copy()
    heights[10:20, 30:40] = -9999.0
    path = write_tiff(tmp_path / "hills.tif", heights, nodata=-9999.0)
    heights[10:20, 30:40] = np.nan
    wanted = HeightField(heights, (2.0, -3.0), (501.0, 898.5))
    assert same(open_surface(path, tmp_path), wanted)


def test_a_geotiff_in_degrees_is_refused(tmp_path):
    path = write_tiff(tmp_path / "world.tif", HEIGHTS, crs="EPSG:4326")
    with pytest.raises(ValueError, match=r"world\.tif: is in degrees"):
        open_surface(path, tmp_path)


def test_a_turned_geotiff_is_refused(tmp_path):
    rasterio = pytest.importorskip("rasterio")
    turned = rasterio.Affine.rotation(30.0)
    path = write_tiff(tmp_path / "turned.tif", HEIGHTS, transform=turned)
    with pytest.raises(ValueError, match=r"turned\.tif: is turned"):
        open_surface(path, tmp_path)


def test_a_worker_gets_the_path_and_not_the_heights(tmp_path):
    np.save(tmp_path / "hills.npy", HEIGHTS)
    found = open_surface(tmp_path / "hills.npy", tmp_path)
    sent = pickle.dumps(found)
    assert len(sent) < 1_000
    assert same(pickle.loads(sent), found)


def test_tiles_of_a_file_have_the_bytes_of_those_of_the_array(tmp_path):
    np.save(tmp_path / "hills.npy", HEIGHTS)
    sample_tiles(tmp_path / "hills.npy", tmp_path / "a", 4_000, tile=TILE)
    sample_tiles(HeightField(HEIGHTS), tmp_path / "b", 4_000, tile=TILE)
    assert contents(tmp_path / "a") == contents(tmp_path / "b")


@pytest.fixture
def mesh(tmp_path, monkeypatch):
    """A long torus in a file, and what its faces are; chunks and buckets are small."""
    monkeypatch.setattr(streams, "ROWS", 100)
    monkeypatch.setattr("dapple3d.extras.distributed.meshes.BUCKET", 50)
    vertices, faces = shapes.torus()
    return vertices * [1.0, 3.0, 1.0], faces.astype(np.int32)


def write_npz(path, vertices, faces):
    np.savez(path.with_suffix(".npz"), vertices=vertices, faces=faces)
    return path.with_suffix(".npz")


def write_small_npz(path, vertices, faces):
    np.savez_compressed(path.with_suffix(".npz"), vertices=vertices, faces=faces.astype(np.int64))
    return path.with_suffix(".npz")


def write_native(suffix):
    def write(path, vertices, faces):
        dapple.write_mesh(path.with_suffix(suffix), vertices, faces)
        return path.with_suffix(suffix)

    return write


def write_big_ply(path, vertices, faces):
    """Big-endian, with a property that nobody asked for before and behind the corners."""
    header = (
        "ply\nformat binary_big_endian 1.0\n"
        f"element vertex {len(vertices)}\nproperty double x\nproperty uchar red\n"
        "property double y\nproperty double z\n"
        f"element face {len(faces)}\nproperty short group\n"
        "property list uchar int vertex_indices\nproperty float quality\nend_header\n"
    )
    points = np.zeros(len(vertices), [("x", ">f8"), ("red", "u1"), ("y", ">f8"), ("z", ">f8")])
    for k, name in enumerate("xyz"):
        points[name] = vertices[:, k]
    rows = np.zeros(len(faces), [("g", ">i2"), ("n", "u1"), ("c", ">i4", 3), ("q", ">f4")])
    rows["n"], rows["c"] = 3, faces
    path.with_suffix(".ply").write_bytes(header.encode() + points.tobytes() + rows.tobytes())
    return path.with_suffix(".ply")


@pytest.mark.parametrize(
    "write",
    [write_npz, write_small_npz, write_native(".ply"), write_native(".obj"), write_big_ply],
    ids=["npz", "compressed npz", "ply", "obj", "big-endian ply"],
)
def test_faces_of_a_file_are_those_of_the_mesh(mesh, tmp_path, write):
    vertices, faces = mesh
    found = open_surface(write(tmp_path / "torus", vertices, faces), tmp_path / "sorted")
    patch = whole(found)
    assert found.face_count == len(faces)
    assert found.axes == (1, 0)
    assert patch.ids.tolist() == list(range(len(faces)))
    assert np.array_equal(patch.corners(), vertices[faces])


def test_a_part_of_a_mesh_has_all_faces_in_its_middle_and_few_others(mesh, tmp_path):
    vertices, faces = mesh
    found = open_surface(write_npz(tmp_path / "torus", vertices, faces), tmp_path / "sorted")
    patch = found.read((0.0, 1.0), (0.0, 1.0))
    middles = vertices[faces].mean(axis=1)
    inside = np.flatnonzero(((middles[:, :2] >= 0.0) & (middles[:, :2] < 1.0)).all(axis=1))
    assert set(inside) <= set(patch.ids)
    assert len(patch.ids) < len(faces) / 3


@pytest.mark.parametrize("of", ["vertices", "faces"])
def test_a_density_of_a_mesh_stays_at_its_place(mesh, tmp_path, of):
    vertices, faces = mesh
    values = np.arange(len(vertices if of == "vertices" else faces), dtype=float)
    np.savez(tmp_path / "torus.npz", vertices=vertices, faces=faces, density=values)
    patch = open_surface(tmp_path / "torus.npz", tmp_path / "sorted").read((0.0, 1.0), (0.0, 1.0))
    assert patch.density_at == of
    wanted = values[faces] if of == "vertices" else values[:, None].repeat(3, 1)
    assert np.array_equal(patch.corner_densities(), wanted[patch.ids])


def test_a_density_of_a_ply_is_its_property(mesh, tmp_path):
    vertices, faces = mesh
    path = write_native(".ply")(tmp_path / "torus", vertices, faces)
    text = path.read_bytes().replace(b"property double z", b"property double density")
    header, _, rows = text.partition(b"end_header\n")
    header = header.replace(
        b"property double density", b"property double z\nproperty double density"
    )
    points = np.frombuffer(rows[: 24 * len(vertices)], "<f8").reshape(-1, 3)
    points = np.column_stack([points, np.arange(len(vertices))])
    path.write_bytes(header + b"end_header\n" + points.tobytes() + rows[24 * len(vertices) :])
    patch = whole(open_surface(path, tmp_path / "sorted"))
    assert patch.density.tolist() == list(range(len(vertices)))


def test_a_body_is_cut_into_tiles_too(tmp_path):
    vertices, faces = shapes.torus(200, 100)
    path = write_npz(tmp_path / "torus", vertices, faces)
    tiles = sample_tiles(path, tmp_path / "out", 8_000, tile=TILE)
    assert tiles.shape == (2, 2)
    assert gathered(tiles, "ids").tolist() == list(range(8_000))
    surface = dapple.Surface(vertices, faces)
    points = dapple.Samples(surface, gathered(tiles, "faces"), gathered(tiles, "barycentric"))
    assert np.array_equal(points.positions, gathered(tiles, "positions"))
    report = dapple.analyze(surface, points)
    assert report.alpha_min > 0.55
    assert report.capacity_variation < 0.015


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"vertices": np.zeros((4, 2))}, r"'vertices' has the shape \(4, 2\): \(n, 3\) in C order"),
        (
            {"vertices": np.asfortranarray(np.zeros((4, 3)))},
            r"'vertices' has the shape \(4, 3\) in Fortran",
        ),
        ({"vertices": np.full((4, 3), np.nan)}, r"vertices\[0\] is not finite"),
        ({"faces": np.array([[0, 1, 2], [0, 1, 9]])}, r"faces\[1\] is \[0, 1, 9\]: there are 4"),
        ({"density": np.ones(5)}, "'density' has 5 numbers, but there are 4 vertices and 2 faces"),
        ({"density": np.array([1.0, np.inf])}, r"density\[1\] is inf: it must be finite and >= 0"),
        ({"density": np.array([1.0, 1, 1, -2])}, r"density\[3\] is -2: it must be finite and >= 0"),
        ({"vertices": np.zeros((4, 3), complex)}, "'vertices' holds complex128: real numbers"),
        ({"faces": None}, "has no array 'faces', only vertices"),
    ],
)
def test_what_is_wrong_with_a_mesh_is_said_by_name(tmp_path, change, message):
    arrays = {"vertices": np.eye(4, 3), "faces": np.array([[0, 1, 2], [0, 1, 3]])} | change
    given = {name: values for name, values in arrays.items() if values is not None}
    np.savez(tmp_path / "mesh.npz", **given)
    with pytest.raises(ValueError, match=rf"mesh\.npz: {message}"):
        open_surface(tmp_path / "mesh.npz", tmp_path / "sorted")
    assert not (tmp_path / "sorted").exists()


def test_a_ply_that_was_cut_off_is_refused(mesh, tmp_path):
    path = write_native(".ply")(tmp_path / "torus", *mesh)
    path.write_bytes(path.read_bytes()[:-100])
    with pytest.raises(ValueError, match=r"torus\.ply: ends too early"):
        open_surface(path, tmp_path / "sorted")


@pytest.mark.parametrize(
    "line", ["property half x", "property list uchar half i", "element vertex -1", "element face x"]
)
def test_a_ply_with_a_wrong_header_is_refused(tmp_path, line):
    path = tmp_path / "wrong.ply"
    path.write_text(f"ply\nformat binary_little_endian 1.0\nelement face 1\n{line}\nend_header\n")
    with pytest.raises(ValueError, match=r"wrong\.ply: line 4 of its header is wrong"):
        open_surface(path, tmp_path / "sorted")


def test_a_property_before_all_elements_is_refused(tmp_path):
    path = tmp_path / "wrong.ply"
    path.write_text("ply\nformat binary_little_endian 1.0\nproperty float x\nend_header\n")
    with pytest.raises(ValueError, match=r"wrong\.ply: line 3 of its header is wrong"):
        open_surface(path, tmp_path / "sorted")


def test_an_npz_whose_array_has_a_wrong_header_is_refused(mesh, tmp_path):
    path = tmp_path / "mesh.npz"
    np.savez(path, vertices=mesh[0], faces=mesh[1])
    content = path.read_bytes().replace(b"'<f8'", b"'<f8''", 1).replace(b" \n", b"\n", 1)
    path.write_bytes(content)
    with pytest.raises(ValueError, match=r"mesh\.npz: "):
        open_surface(path, tmp_path / "sorted")


def binary_ply(path, vertices, polygons, more="", values=()):
    """Faces of any number of corners, each with a float behind it if there are values."""
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n"
        "property float x\nproperty float y\nproperty float z\n"
        f"element face {len(polygons)}\nproperty list uchar int vertex_indices\n{more}end_header\n"
    )
    content = np.asarray(vertices, "<f4").tobytes()
    for k, corners in enumerate(polygons):
        content += bytes([len(corners)]) + np.asarray(corners, "<i4").tobytes()
        content += np.asarray(values[k : k + 1], "<f4").tobytes()
    path.write_bytes(header.encode() + content)


def test_a_binary_ply_of_quads_is_read(tmp_path):
    vertices = [[x, y, 0] for y in range(11) for x in range(11)]
    quads = [[k, k + 1, k + 12, k + 11] for k in range(110) if k % 11 < 10]
    binary_ply(tmp_path / "quads.ply", vertices, quads)
    made = sample_tiles(tmp_path / "quads.ply", tmp_path / "out", 200, tile=2000)
    found = np.concatenate([tile.positions for tile in made.tiles()])
    assert len(found) == 200
    assert found[:, :2].min() > 0
    assert found[:, :2].max() < 10


def test_a_ply_of_quads_and_triangles_is_read(tmp_path):
    vertices = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0]]
    binary_ply(tmp_path / "mixed.ply", vertices, [[0, 1, 2, 3], [1, 4, 2]])
    found = open_surface(tmp_path / "mixed.ply", tmp_path / "sorted")
    assert found.face_count == 3


@pytest.mark.parametrize("corners", [[0, 1, 2], [0, 1, 2, 3]])
def test_a_density_of_the_faces_of_a_ply_is_read(tmp_path, corners):
    path = tmp_path / "dense.ply"
    polygons, values = [corners, [0, 2, 3]], [2.0, 5.0]
    binary_ply(path, np.eye(4, 3), polygons, "property float density\n", values)
    stream = streams.open_stream(path)
    found = np.concatenate(list(stream.density.chunks()))
    assert found.tolist() == [2.0] * (len(corners) - 2) + [5.0]


def test_a_density_that_a_mesh_cannot_take_is_refused(tmp_path):
    with pytest.raises(ValueError, match="is a mesh, which has no step"):
        open_surface(tmp_path / "mesh.npz", tmp_path, step=(1.0, 1.0))
