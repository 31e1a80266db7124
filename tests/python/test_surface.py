# SPDX-License-Identifier: GPL-3.0-or-later
import dapple3d as dapple
import numpy as np
import pytest
from checks import check_array
from shapes import bent, grid


def test_returns_its_arrays(mesh):
    vertices, faces = mesh
    density = np.linspace(0, 2, len(vertices))
    surface = dapple.Surface(vertices, faces, density)
    check_array(surface.vertices, np.float64, vertices.shape)
    check_array(surface.faces, np.int32, faces.shape)
    check_array(surface.density, np.float64, density.shape)
    np.testing.assert_array_equal(surface.vertices, vertices)
    np.testing.assert_array_equal(surface.faces, faces)
    np.testing.assert_array_equal(surface.density, density)
    assert dapple.Surface(vertices, faces).density is None


def test_measures_area_and_mass():
    vertices, faces = grid(5)
    surface = dapple.Surface(vertices, faces, vertices[:, 0])
    assert surface.area == pytest.approx(1, rel=1e-14)
    assert surface.capacity == pytest.approx(0.5, rel=1e-14)
    assert surface.spacing(50) == pytest.approx(np.sqrt(2 / (np.sqrt(3) * 50)))


def test_counts_samples_of_a_spacing():
    vertices, faces = grid(5)
    surface = dapple.Surface(vertices, faces)
    assert surface.count(surface.spacing(50)) == 50
    assert surface.count(0.1) == round(2 / (np.sqrt(3) * 0.01))
    assert surface.count(100) == 1
    half = surface.with_density(4.0 * vertices[:, 0])
    assert half.count(0.1) == round(1 / (np.sqrt(3) * 0.01))


@pytest.mark.parametrize("spacing", [0.0, -1.0, np.nan, np.inf, 1e-9])
def test_refuses_a_spacing_that_is_none(spacing):
    vertices, faces = grid(5)
    with pytest.raises(ValueError, match="spacing is "):
        dapple.Surface(vertices, faces).count(spacing)


@pytest.mark.parametrize("dtype", [np.int8, np.int16, np.int32, np.int64, np.uint16, np.uint64])
def test_takes_any_integers(dtype):
    vertices, faces = grid(2)
    np.testing.assert_array_equal(dapple.Surface(vertices, faces.astype(dtype)).faces, faces)


@pytest.mark.parametrize("dtype", [np.float32, np.float64, np.int32])
def test_takes_any_numbers(dtype):
    vertices, faces = grid(1)
    np.testing.assert_array_equal(dapple.Surface(vertices.astype(dtype), faces).vertices, vertices)


def test_takes_lists_and_strided_arrays():
    vertices, faces = grid(3)
    expected = dapple.Surface(vertices, faces)
    for v, f in [
        (vertices.tolist(), faces.tolist()),
        (np.asfortranarray(vertices), np.asfortranarray(faces)),
        (np.repeat(vertices, 2, axis=0)[::2], faces[::-1][::-1]),
        (np.column_stack([vertices, vertices])[:, 3:], faces),
    ]:
        surface = dapple.Surface(v, f)
        np.testing.assert_array_equal(surface.vertices, expected.vertices)
        np.testing.assert_array_equal(surface.faces, expected.faces)


def test_keeps_its_own_copy():
    vertices, faces = grid(2)
    density = np.ones(len(vertices))
    surface = dapple.Surface(vertices, faces, density)
    vertices[:], faces[:], density[:] = 7, 0, 9
    assert surface.area == pytest.approx(1)
    assert surface.vertices.max() == 1
    assert surface.faces.max() == 8
    assert surface.density.max() == 1


def test_leaves_its_arguments_alone():
    vertices, faces = grid(2)
    before = vertices.copy(), faces.copy()
    dapple.sample(dapple.Surface(vertices, faces), 20)
    np.testing.assert_array_equal(vertices, before[0])
    np.testing.assert_array_equal(faces, before[1])


def test_deforms(mesh, dense):
    moved = bent(mesh[0], 1.0)
    carried = dense.deformed(moved)
    fresh = dapple.Surface(moved, mesh[1], dense.density)
    np.testing.assert_array_equal(carried.vertices, moved)
    np.testing.assert_array_equal(carried.faces, mesh[1])
    np.testing.assert_array_equal(carried.density, dense.density)
    assert carried.area == pytest.approx(fresh.area, rel=1e-14)
    assert carried.capacity == pytest.approx(fresh.capacity, rel=1e-14)


@pytest.mark.parametrize(
    ("place", "shape"), [("vertices", (25,)), ("faces", (32,)), ("corners", (32, 3))]
)
def test_takes_a_density_at(place, shape):
    vertices, faces = grid(4)
    density = np.random.default_rng(1).random(shape)
    surface = dapple.Surface(vertices, faces, density, density_at=place)
    check_array(surface.density, np.float64, shape)
    np.testing.assert_array_equal(surface.density, density)
    assert surface.density_at == place
    corners = {"vertices": lambda: density[faces], "faces": lambda: density[:, None]}
    expected = corners.get(place, lambda: density)().mean(axis=1).sum() / 32
    assert surface.capacity == pytest.approx(expected, rel=1e-13)
    other = surface.deformed(2 * vertices)
    assert other.density_at == place
    assert other.capacity == pytest.approx(4 * expected, rel=1e-13)


def test_exchanges_its_density(surface):
    steps = (np.arange(len(surface.faces)) % 3).astype(float)
    stepped = surface.with_density(steps, density_at="faces")
    np.testing.assert_array_equal(stepped.density, steps)
    np.testing.assert_array_equal(stepped.vertices, surface.vertices)
    assert surface.density is None
    plain = stepped.with_density(None)
    assert plain.density is None
    assert plain.capacity == surface.capacity


def test_ends_only_on_faces_with_density(surface):
    """Three sectors of the torus with the densities 0, 1 and 2."""
    middles = surface.vertices[surface.faces].mean(axis=1)
    angle = np.arctan2(middles[:, 1], middles[:, 0]) % (2 * np.pi)
    steps = np.floor(angle * 1.5 / np.pi)
    samples = dapple.sample(surface.with_density(steps, density_at="faces"), 300)
    assert steps[samples.faces].min() == 1
    assert np.count_nonzero(steps[samples.faces] == 2) == pytest.approx(200, abs=4)


@pytest.mark.parametrize(
    ("place", "density", "match"),
    [
        ("faces", np.ones(25), "density.*25.*32 faces"),
        ("corners", np.ones(96), r"density.*\(96,\)"),
        ("corners", np.ones((25, 3)), "density.*75.*96 corners"),
        ("corners", np.ones((0, 3)), "density"),
        ("corners", np.where(np.arange(96) == 17, -2, 1).reshape(32, 3), r"density\[5, 2\].*-2"),
        ("faces", np.zeros(32), "density"),
        ("edges", np.ones(56), "density_at.*edges.*corners"),
    ],
)
def test_refuses_a_density_at(place, density, match):
    vertices, faces = grid(4)
    with pytest.raises(ValueError, match=match):
        dapple.Surface(vertices, faces, density, density_at=place)
    with pytest.raises(ValueError, match=match):
        dapple.Surface(vertices, faces).with_density(density, density_at=place)


def test_topology(surface):
    topology = surface.topology
    assert (topology.components, topology.genus, topology.closed) == (1, 1, True)
    assert (topology.border_edges, topology.border_loops, topology.nonmanifold_edges) == (0, 0, 0)
    flat = dapple.Surface(*grid(3)).topology
    assert (flat.closed, flat.manifold, flat.border_edges, flat.border_loops) == (
        False,
        True,
        12,
        1,
    )


def test_islands_are_parted_where_there_is_no_density():
    vertices, faces = grid(6)
    both = (
        np.vstack([vertices, vertices + np.array([3.0, 0.0, 0.0])]),
        np.vstack([faces, faces + len(vertices)]),
    )
    islands = dapple.Surface(*both).islands
    check_array(islands, np.int32, (2 * len(faces),))
    np.testing.assert_array_equal(islands, np.repeat([0, 1], len(faces)))
    middle = vertices[faces].mean(axis=1)[:, 0]
    density = np.where(np.abs(middle - np.ptp(vertices[:, 0]) / 2) < 0.2, 0.0, 1.0)
    parted = dapple.Surface(vertices, faces, density, density_at="faces").islands
    assert set(parted.tolist()) == {-1, 0, 1}
    np.testing.assert_array_equal(parted < 0, density == 0.0)


@pytest.mark.parametrize(("value", "text"), [(np.nan, "nan"), (np.inf, "inf"), (-np.inf, "-inf")])
def test_names_the_first_bad_vertex(value, text):
    vertices, faces = grid(4)
    vertices[17, 1] = vertices[20, 0] = value
    with pytest.raises(dapple.SurfaceError, match=rf"vertices\[17\].*{text}"):
        dapple.Surface(vertices, faces)


@pytest.mark.parametrize("index", [-1, 25, 2**31 - 1, -(2**31)])
def test_names_the_first_bad_face(index):
    vertices, faces = grid(4)
    faces[6, 2] = faces[9, 0] = index
    with pytest.raises(dapple.SurfaceError, match=rf"faces\[6\].*{index}"):
        dapple.Surface(vertices, faces)


@pytest.mark.parametrize("index", [2**31, 2**32, 2**32 + 1, -(2**31) - 1])
def test_refuses_indices_that_do_not_fit(index):
    """They must not wrap round to a valid index."""
    vertices, faces = grid(4)
    wide = faces.astype(np.int64)
    wide[6, 2] = index
    with pytest.raises(ValueError, match="faces"):
        dapple.Surface(vertices, wide)


@pytest.mark.parametrize(("value", "text"), [(np.nan, "nan"), (np.inf, "inf"), (-0.25, "-0.25")])
def test_names_the_first_bad_density(value, text):
    vertices, faces = grid(4)
    density = np.ones(25)
    density[11] = density[13] = value
    with pytest.raises(dapple.SurfaceError, match=rf"density\[11\].*{text}"):
        dapple.Surface(vertices, faces, density)


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"vertices": np.zeros((4, 2))}, r"vertices.*\(4, 2\)"),
        ({"vertices": np.zeros(12)}, r"vertices.*\(12,\)"),
        ({"vertices": np.array([["a", "b", "c"]])}, "vertices"),
        ({"vertices": np.zeros((4, 3), complex)}, "vertices"),
        ({"faces": np.zeros((4, 4), int)}, r"faces.*\(4, 4\)"),
        ({"faces": np.zeros((4, 3))}, "faces.*integer"),
        ({"faces": np.zeros((0, 3), int)}, "faces"),
        ({"density": np.ones((25, 1))}, r"density.*\(25, 1\)"),
        ({"density": np.ones(24)}, "density.*24.*25"),
        ({"density": np.ones(0)}, "density"),
        ({"density": np.zeros(25)}, "density"),
        ({"vertices": np.zeros((25, 3))}, "area"),
    ],
)
def test_refuses(change, match):
    vertices, faces = grid(4)
    arguments = {"vertices": vertices, "faces": faces, "density": None} | change
    with pytest.raises(ValueError, match=match):
        dapple.Surface(**arguments)


@pytest.mark.parametrize("value", [None, "grid", object(), [[0, 1], [2]]])
def test_refuses_what_is_no_array(value):
    _, faces = grid(4)
    with pytest.raises(ValueError, match="vertices"):
        dapple.Surface(value, faces)


def test_refuses_to_deform_badly(surface):
    vertices = surface.vertices.copy()
    with pytest.raises(dapple.SurfaceError, match=f"{len(vertices) - 1}.*{len(vertices)}"):
        surface.deformed(vertices[1:])
    vertices[3, 0] = np.nan
    with pytest.raises(dapple.SurfaceError, match=r"vertices\[3\].*nan"):
        surface.deformed(vertices)
