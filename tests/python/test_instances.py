# SPDX-License-Identifier: GPL-3.0-or-later
"""What stands at points: checks, turns and velocities."""

import numpy as np
import pytest
from dapple3d import instances
from dapple3d.instances import Instances


def turned(turns: np.ndarray, vector: tuple[float, float, float]) -> np.ndarray:
    """The vector turned by unit quaternions w, x, y, z."""
    real, imaginary = turns[:, :1], turns[:, 1:]
    twice = 2 * np.cross(imaginary, np.broadcast_to(vector, imaginary.shape))
    return vector + real * twice + np.cross(imaginary, twice)


@pytest.fixture
def normals() -> np.ndarray:
    vectors = np.random.default_rng(0).normal(size=(200, 3))
    return np.vstack([vectors, np.eye(3), -np.eye(3), [[1e-9, 0, -1]]])


def unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def test_instances_stand_along_normals_by_the_shortest_turn(normals):
    turns = instances.orientations(normals)
    np.testing.assert_allclose(np.linalg.norm(turns, axis=1), 1)
    np.testing.assert_allclose(turned(turns, (0, 0, 1)), unit(normals), atol=1e-8)
    np.testing.assert_allclose(turns[:, 3], 0)  # no turn about the z axis
    assert (turns[:, 0] >= 0).all()


def test_the_x_axis_points_along_tangents(normals):
    tangents = np.random.default_rng(1).normal(size=normals.shape)
    turns = instances.orientations(normals, tangents)
    np.testing.assert_allclose(turned(turns, (0, 0, 1)), unit(normals), atol=1e-12)
    x = turned(turns, (1, 0, 0))
    across = np.cross(unit(normals), tangents)
    np.testing.assert_allclose(np.einsum("ij,ij->i", x, across), 0, atol=1e-12)
    assert (np.einsum("ij,ij->i", x, tangents) > 0).all()
    assert (turns[:, 0] >= 0).all()


def test_in_a_world_with_y_up_the_y_axis_stands_along_normals(normals):
    turns = instances.orientations(normals, up="Y")
    np.testing.assert_allclose(turned(turns, (0, 1, 0)), unit(normals), atol=1e-8)
    np.testing.assert_allclose(turns[:, 2], 0)
    tangents = np.random.default_rng(1).normal(size=normals.shape)
    turns = instances.orientations(normals, tangents, up="Y")
    np.testing.assert_allclose(turned(turns, (0, 1, 0)), unit(normals), atol=1e-12)
    assert (np.einsum("ij,ij->i", turned(turns, (1, 0, 0)), tangents) > 0).all()


def rolling(frames: int) -> list[Instances]:
    """Normals that go around in circles, two of them through straight down; ids in other rows."""
    found = []
    for angle in np.linspace(0, 2 * np.pi, frames):
        head = np.array([np.sin(angle), 0, np.cos(angle)])
        side = np.array([np.cos(angle), np.sin(angle), 0.1])
        rows = {4: head, 9: side, 2: np.array([0, np.sin(angle), np.cos(angle)])}
        order = sorted(rows, key=lambda number: number * len(found) % 5)
        normals = np.array([rows[number] for number in order])
        found.append(Instances(normals, normals=normals, ids=np.array(order)))
    return found


@pytest.mark.parametrize("up", ["Y", "Z"])
def test_nothing_spins_while_normals_move(up):
    frames = instances.along_normals(rolling(73), up=up)
    axis = (0, 1, 0) if up == "Y" else (0, 0, 1)
    step = np.radians(5)
    last = None
    for frame in frames:
        np.testing.assert_allclose(turned(frame.orientations, axis), unit(frame.normals), atol=1e-9)
        rows = frame.orientations[np.argsort(frame.ids)]
        if last is not None:
            cosines = np.abs(np.einsum("ij,ij->i", rows, last)).clip(0, 1)
            assert (2 * np.arccos(cosines) < 1.01 * step).all()
        last = rows


def test_orientations_that_are_known_stay():
    known = Instances(np.zeros((1, 3)), [[0.6, 0, 0.8, 0]], normals=[[0, 1, 0]])
    assert instances.along_normals([known, known])[1].orientations.tolist() == [[0.6, 0, 0.8, 0]]
    nothing = Instances(np.zeros((1, 3)))
    assert instances.along_normals([nothing])[0].orientations is None


def test_a_normal_that_turns_around_begins_anew():
    frames = [Instances(np.zeros((1, 3)), normals=[[0, 0, z]]) for z in (1, -1)]
    found = instances.along_normals(frames)[1].orientations
    np.testing.assert_allclose(turned(found, (0, 0, 1)), [[0, 0, -1]], atol=1e-12)


def test_what_has_no_direction_is_named():
    with pytest.raises(ValueError, match=r"normals\[1\] has no direction"):
        instances.orientations([[0, 0, 1], [0, 0, 0]])
    with pytest.raises(ValueError, match=r"normals\[0\] has no direction: \[nan"):
        instances.orientations([[np.nan, 0, 1]])
    with pytest.raises(ValueError, match=r"tangents across the normal\[0\]"):
        instances.orientations([[0, 0, 1]], [[0, 0, 2]])
    with pytest.raises(ValueError, match=r"normals has the shape \(3,\): \(n, 3\)"):
        instances.orientations([0, 0, 1])


@pytest.mark.parametrize(
    ("arrays", "said"),
    [
        ({"scales": np.ones((3, 3))}, r"scales is float64 \(3, 3\): numbers \(2, 3\) are needed"),
        ({"ids": np.array(["a", "b"])}, r"ids is str32 \(2,\): numbers \(2,\) are needed"),
        ({"normals": [[0, 0, 1], [np.inf, 0, 0]]}, r"normals\[1\] is not finite: \[inf"),
        ({"classes": [0, -1]}, r"classes\[1\] is not at least 0: -1"),
        ({"ids": [1.5, 1.7]}, r"ids\[0\] is 1\.5: a whole number of 64 bits is needed"),
        ({"ids": [0.0, 1e19]}, r"ids\[1\] is 1e\+19: a whole number of 64 bits"),
        ({"ids": np.array([0, 2**63], np.uint64)}, r"ids\[1\] is 9223372036854775808: a whole"),
        ({"ids": [0, 2.0**63]}, r"ids\[1\] is 9\.223\d*e\+18: a whole number of 64 bits"),
        ({"classes": [0, 2**31 + 5]}, r"classes\[1\] is 2147483653: a whole number of 32 bits"),
        ({"classes": [0, 0.5]}, r"classes\[1\] is 0\.5: a whole number of 32 bits is needed"),
        ({"prototypes": [2.0**31, 0]}, r"prototypes\[0\] is 2147483648\.0: a whole number of 32"),
        ({"prototypes": [0, np.nan]}, r"prototypes\[1\] is not finite: nan"),
        ({"orientations": np.ones((2, 3))}, r"orientations .* \(2, 4\) are needed"),
    ],
)
def test_arrays_that_do_not_belong_together_are_named(arrays, said):
    with pytest.raises(ValueError, match=said):
        Instances(np.zeros((2, 3)), **arrays)


def test_samples_stand_along_their_normals(samples):
    found = instances.of_samples(samples)
    np.testing.assert_array_equal(found.positions, samples.positions)
    np.testing.assert_array_equal(found.ids, samples.ids)
    np.testing.assert_array_equal(found.classes, samples.classes)
    np.testing.assert_allclose(turned(found.orientations, (0, 0, 1)), samples.normals, atol=1e-12)


def test_matrices_become_turns_and_scales(normals):
    random = np.random.default_rng(2)
    turns = instances.orientations(normals, random.normal(size=normals.shape))
    scales = random.uniform(0.1, 3, normals.shape)
    scales[::2] *= -1  # mirrored
    matrices = np.tile(np.eye(4), (len(normals), 1, 1))
    axes = np.stack([turned(turns, tuple(axis)) for axis in np.eye(3)], axis=2)
    matrices[:, :3, :3], matrices[:, :3, 3] = axes * scales[:, None], normals
    found, skewed = instances.of_matrices(matrices, ids=np.arange(len(normals)))
    again = np.stack([turned(found.orientations, tuple(axis)) for axis in np.eye(3)], axis=2)
    np.testing.assert_allclose(again * found.scales[:, None], matrices[:, :3, :3], atol=1e-12)
    np.testing.assert_array_equal(found.positions, normals)
    np.testing.assert_array_equal(found.ids, np.arange(len(normals)))
    assert not skewed.any()


def test_skewed_matrices_are_reported_and_flat_ones_are_none():
    matrices = np.tile(np.eye(4), (3, 1, 1))
    matrices[1, 0, 1] = 0.1
    matrices[2, 2, 2] = 0.0
    found, skewed = instances.of_matrices(matrices)
    assert skewed.tolist() == [False, True, False]
    assert found.scales[2].tolist() == [1, 1, 0]
    np.testing.assert_allclose(np.linalg.norm(found.orientations, axis=1), 1)


def at(places: dict[int, float]) -> Instances:
    """Points on the x axis by their ids."""
    positions = [[x, 0, 0] for x in places.values()]
    return Instances(np.array(positions), ids=np.array(list(places)))


def test_velocities_lead_to_the_next_frame():
    frames = [at({1: 0.0, 2: 5.0}), at({1: 1.0, 2: 5.0}), at({1: 3.0, 2: 4.0})]
    found = instances.with_velocities(frames, 24)
    x = [frame.velocities[:, 0].tolist() for frame in found]
    assert x == [[24, 0], [48, -24], [48, -24]]


def test_velocities_follow_ids_not_rows():
    frames = [at({7: 0.0, 8: 5.0}), at({9: 2.0, 8: 6.0, 7: 1.0}), at({9: 4.0})]
    found = instances.with_velocities(frames, 10)
    x = [frame.velocities[:, 0].tolist() for frame in found]
    assert x == [[10, 10], [20, 10, 10], [20]]


def test_velocities_that_are_known_stay():
    known = Instances(np.zeros((1, 3)), velocities=np.ones((1, 3)))
    found = instances.with_velocities([known, Instances(np.ones((1, 3)))], 24)
    assert [frame.velocities.tolist() for frame in found] == [[[1, 1, 1]], [[1, 1, 1]]]


@pytest.mark.parametrize(
    ("vertices", "faces", "said"),
    [
        (np.eye(3), [[0, 1, 2], [0, 1, 3]], r"faces\[1\] is \[0, 1, 3\]: there are 3 vertices"),
        (np.eye(3), [[0, 1, -1]], r"faces\[0\] is \[0, 1, -1\]: there are 3 vertices"),
        (np.eye(3), [[0, 1, 1.5]], r"faces\[0\] is 1\.5: a whole number of 32 bits is needed"),
        (np.eye(3), [[0, 1, 2**32]], r"faces\[0\] is 4294967296: a whole number of 32 bits"),
        (np.eye(3), [[0, 1, 2, 2]], r"faces is int64 \(1, 4\): numbers \(n, 3\) are needed"),
        (np.eye(3), [0, 1, 2], r"faces is int64 \(3,\): numbers \(n, 3\) are needed"),
        (np.eye(2), [[0, 1, 1]], r"vertices is float64 \(2, 2\): numbers \(n, 3\)"),
        (np.full((3, 3), np.nan), [[0, 1, 2]], r"vertices\[0\] is not finite: \[nan"),
        ([], [[0, 1, 2]], r"faces\[0\] is \[0, 1, 2\]: there are 0 vertices"),
    ],
)
def test_a_prototype_that_is_no_mesh_is_named(vertices, faces, said):
    with pytest.raises(ValueError, match=said):
        instances.Mesh(np.asarray(vertices), np.asarray(faces))


def test_whole_numbers_of_every_type_stay_exact():
    for kind in (np.int8, np.uint8, np.int32, np.uint64, np.float32, np.float64):
        found = Instances(np.zeros((2, 3)), ids=np.array([0, 100], kind), classes=np.ones(2, kind))
        assert (found.ids.dtype, found.ids.tolist()) == (np.int64, [0, 100])
        assert found.classes.dtype == np.int32
    edge = np.array([-(2**63), 2**63 - 1])
    assert Instances(np.zeros((2, 3)), ids=edge).ids.tolist() == edge.tolist()
