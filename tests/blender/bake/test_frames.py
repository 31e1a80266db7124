# SPDX-License-Identifier: GPL-3.0-or-later
"""Tangent frames and parallel transport, in numpy alone."""

import itertools

import addon_host
import numpy as np
import pytest
from dapple3d.density import vertex_normals


@pytest.fixture
def frames():
    return addon_host.part("core.surface.frames")


@pytest.fixture
def records():
    return addon_host.part("core.surface.records")


def great_circle(start, end, steps):
    """Unit vectors (steps + 1, 3) from start to end, which are perpendicular."""
    angle = np.linspace(0.0, np.pi / 2.0, steps + 1)[:, None]
    return np.cos(angle) * np.array(start, float) + np.sin(angle) * np.array(end, float)


def test_transport_around_an_octant_turns_by_its_area(frames):
    x, y, z = np.eye(3)
    path = np.concatenate([great_circle(a, b, 50) for a, b in ((x, y), (y, z), (z, x))])
    direction = y[None, :]
    for normal, other in itertools.pairwise(path):
        direction = frames.transport(direction, normal[None, :], other[None, :])
    assert np.allclose(direction, z, atol=1e-9)  # a quarter turn: the area of an octant


def test_transport_keeps_directions_when_normals_agree(frames):
    normal, direction = np.array([[0.0, 0.0, 1.0]]), np.array([[0.6, 0.8, 0.0]])
    assert np.allclose(frames.transport(direction, normal, normal), direction, atol=1e-15)


def test_transport_to_the_opposite_normal_is_finite_and_tangent(frames):
    normal, direction = np.array([[0.0, 0.0, 1.0]]), np.array([[1.0, 0.0, 0.0]])
    moved = frames.transport(direction, normal, -normal)
    assert np.isfinite(moved).all()
    assert abs(moved[0, 2]) < 1e-12


def plane(n=6):
    """Vertices and faces of a square grid cut along alternating diagonals."""
    x, y = np.meshgrid(np.arange(n, dtype=float), np.arange(n, dtype=float))
    vertices = np.column_stack([x.ravel(), y.ravel(), np.zeros(n * n)])
    faces = []
    for row in range(n - 1):
        for col in range(n - 1):
            a = row * n + col
            b, c, d = a + 1, a + n + 1, a + n
            flip = (row + col) % 2
            faces += [(a, b, d), (b, c, d)] if flip else [(c, d, a), (a, b, c)]
    return vertices, np.array(faces, dtype=np.int32)


def test_a_key_in_another_triangle_keeps_the_direction(frames, records):
    vertices, faces = plane()
    count = len(faces)
    rng = np.random.Generator(np.random.PCG64(3))
    before = records.Binding(
        faces, rng.dirichlet((1, 1, 1), count), rng.uniform(-np.pi, np.pi, count)
    )
    after = records.Binding(
        faces[rng.permutation(count)], rng.dirichlet((1, 1, 1), count), np.zeros(count)
    )
    bent = vertices + [0.0, 0.0, 1.0] * (0.5 * vertices[:, :1])  # tilted, still flat
    normals = frames.smooth(bent, faces)
    carried = frames.carried(before, after, bent, normals)
    old = frames.frames(before, bent, normals).direction(before.angle)
    new = frames.frames(carried, bent, normals).direction(carried.angle)
    assert np.allclose(new, old, atol=1e-12)
    assert np.ptp(carried.angle - before.angle) > 1.0  # angles had to change


def test_a_key_in_the_same_triangle_keeps_its_angle(frames, records):
    vertices, faces = plane()
    here = records.Binding(faces, np.full((len(faces), 3), 1 / 3), np.full(len(faces), 0.7))
    normals = frames.smooth(vertices, faces)
    assert np.allclose(frames.carried(here, here, vertices, normals).angle, 0.7, atol=1e-12)


def test_vertex_normals_do_not_depend_on_how_quads_are_cut():
    cube = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    one = [(q[0], q[1], q[2]) for q in quads] + [(q[0], q[2], q[3]) for q in quads]
    other = [(q[0], q[1], q[3]) for q in quads] + [(q[1], q[2], q[3]) for q in quads]
    expected = (cube - 0.5) / np.sqrt(0.75)
    for faces in (one, other):
        found = vertex_normals(cube, np.array(faces, dtype=np.int32))
        assert np.allclose(found, expected, atol=1e-12)


def test_faces_are_found_by_their_corners_in_any_order(records):
    binding = addon_host.part("core.surface.binding")
    faces = np.array([(0, 1, 2), (2, 3, 0), (3, 4, 5)], dtype=np.int32)
    corners = np.array([(5, 3, 4), (2, 1, 0), (0, 1, 3), (0, 2, 3)], dtype=np.int32)
    assert binding.faces_with_corners(corners, faces).tolist() == [2, 0, -1, 1]


def test_own_random_depends_on_seed_id_and_stream(records):
    ids = np.arange(20_000, dtype=np.int32)
    numbers = records.own_random(5, ids, 0)
    assert abs(numbers.mean() - 0.5) < 0.01
    assert np.histogram(numbers, 10, (0, 1))[0].min() > 1_800
    assert (numbers == records.own_random(5, ids[::-1], 0)[::-1]).all()
    assert abs(np.corrcoef(numbers, records.own_random(6, ids, 0))[0, 1]) < 0.03
    assert abs(np.corrcoef(numbers, records.own_random(5, ids, 1))[0, 1]) < 0.03


def test_a_broken_record_is_named(records):
    errors = addon_host.part("core.base.errors")
    corners = np.array([(0, 1, 2), (1, 2, 9)], dtype=np.int32)
    binding = records.Binding(corners, np.full((2, 3), 1 / 3), np.zeros(2))
    with pytest.raises(errors.ScatterError, match=r"dapple_v2\[1\] is 9, but .* 5 vertices"):
        records.check_binding(binding, 5, "Fur")
    weights = np.array([(1.0, 0.0, 0.0), (np.nan, 0.0, 1.0)])
    binding = records.Binding(corners, weights, np.zeros(2))
    with pytest.raises(errors.ScatterError, match=r"dapple_barycentric\[1\] is not finite"):
        records.check_binding(binding, 10, "Fur")


def test_at_a_tip_a_direction_does_not_swing_around_the_normal(frames, records):
    """There normals point along the edges: as they sway past them, nothing turns by more."""
    vertices, corners = np.array([[0.0, 0, 0], [0, 0, 1], [0.3, 0, 0]]), np.array([[0, 1, 2]])
    binding = records.Binding(corners.astype(np.int32), np.full((1, 3), 1 / 3), np.zeros(1))
    sway = np.radians(np.arange(-6.0, 6.5, 1.0))
    ways = np.column_stack([np.sin(sway), -np.sin(0.1 + 0 * sway), np.cos(sway)])
    shown = [
        frames.frames(binding, vertices, frames.Normals(np.tile(way, (3, 1)))).axes(np.zeros(1))[0]
        for way in ways
    ]
    for one, other in itertools.pairwise(shown):
        turn = np.degrees(np.arccos(np.clip((np.trace(one.T @ other) - 1.0) / 2.0, -1.0, 1.0)))
        assert turn < 3.0
