# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces that lie on each other corner by corner count as one."""

import json

import dapple3d as dapple
import numpy as np
import pytest
import shapes
from command_line import done

WAYS = [(turned, own) for turned in (False, True) for own in (False, True)]
IDS = [f"{'turned' if turned else 'alike'}, {'own' if own else 'shared'}" for turned, own in WAYS]


def doubled(mesh: shapes.Mesh, turned: bool, own_vertices: bool) -> shapes.Mesh:
    """Each face a second time, beginning at another corner."""
    vertices, faces = mesh
    again = np.roll(faces[:, ::-1] if turned else faces, 1, axis=1)
    if own_vertices:
        return np.vstack([vertices, vertices]), np.vstack([faces, again + len(vertices)])
    return vertices, np.vstack([faces, again])


@pytest.mark.parametrize(("turned", "own_vertices"), WAYS, ids=IDS)
def test_of_two_bodies_each_gets_half_of_the_points(mesh, turned, own_vertices):
    twice, (vertices, faces) = doubled(mesh, turned, own_vertices), mesh
    both = np.vstack([twice[0], vertices + np.array([5, 0, 0])])
    surface = dapple.Surface(both, np.vstack([twice[1], faces + len(twice[0])]))
    assert surface.doubled_faces == len(faces)
    positions = dapple.sample(surface, 1200).positions
    assert np.count_nonzero(positions[:, 0] < 2.5) == 600


@pytest.mark.parametrize(("turned", "own_vertices"), WAYS, ids=IDS)
def test_a_double_sided_ground_is_one_ground(turned, own_vertices):
    ground = shapes.grid(20)
    single = dapple.sample(dapple.Surface(*ground), 1000).report
    surface = dapple.Surface(*doubled(ground, turned, own_vertices))
    samples = dapple.sample(surface, 1000)
    assert surface.doubled_faces == len(ground[1])
    assert surface.area == pytest.approx(1.0)
    assert surface.topology.border_loops == 1
    assert samples.report.bond_order == pytest.approx(single.bond_order, abs=0.03)
    assert samples.normals[:, 2].min() > 0.99, "none is upside down"
    assert samples.faces.max() < len(ground[1])


def test_doubled_faces_can_be_kept(mesh):
    surface = dapple.Surface(*doubled(mesh, True, True), merge_doubled=False)
    assert surface.doubled_faces == 0
    assert surface.area == pytest.approx(2 * dapple.Surface(*mesh).area)


def test_without_welding_equal_indices_are_doubled(mesh):
    assert dapple.Surface(*doubled(mesh, True, False), weld=None).doubled_faces == len(mesh[1])
    assert dapple.Surface(*doubled(mesh, True, True), weld=None).doubled_faces == 0


@pytest.mark.parametrize(("turned", "own_vertices"), WAYS, ids=IDS)
def test_points_bound_to_a_doubled_face_are_at_the_same_place(mesh, turned, own_vertices):
    vertices, faces = doubled(mesh, turned, own_vertices)
    surface, count = dapple.Surface(vertices, faces), len(mesh[1])
    chosen = np.arange(count, 2 * count, 7, dtype=np.int32)
    weights = np.random.default_rng(0).dirichlet((1, 1, 1), len(chosen))
    samples = dapple.Samples(surface, chosen, weights)
    wanted = np.einsum("nk,nkd->nd", weights, vertices[faces[chosen]])
    found = np.einsum("nk,nkd->nd", samples.barycentric, vertices[faces[samples.faces]])
    assert (samples.faces == chosen - count).all()
    assert np.abs(found - wanted).max() < 1e-12
    assert np.abs(samples.positions - wanted).max() < 1e-12


def test_nothing_is_projected_onto_a_doubled_face(mesh):
    surface = dapple.Surface(*doubled(mesh, True, True))
    points = np.random.default_rng(0).normal(size=(200, 3))
    assert dapple.project(surface, points).faces.max() < len(mesh[1])


def test_tracking_a_doubled_body_is_tracking_the_body(mesh):
    vertices, faces = doubled(mesh, True, True)
    surface = dapple.Surface(vertices, faces)
    tracker = dapple.Tracker(surface, dapple.sample(surface, 200))
    for time in (0.5, 1.0):
        samples = tracker.advance(shapes.bent(vertices, time))
        assert samples.faces.max() < len(mesh[1])
        assert samples.report.capacity_variation < 0.05


def test_the_command_line_says_how_many_count_once(tmp_path):
    ground = shapes.grid(6)
    dapple.write_mesh(tmp_path / "ground.ply", *doubled(ground, True, True))
    given = ("sample", tmp_path / "ground.ply", tmp_path / "points.npz", "-n", 100)
    found = done(*given, "--json", tmp_path / "report.json")
    assert "72 doubled faces count once" in found.output
    assert json.loads((tmp_path / "report.json").read_text())["input"]["doubled_faces"] == 72
    assert "doubled" not in done(*given, "--keep-doubled").output
