# SPDX-License-Identifier: GPL-3.0-or-later
"""dapple3d.remesh: meshes made of the cells of sites."""

import pickle

import dapple3d as dapple
import numpy as np
import pytest
import shapes


def cube() -> dapple.Surface:
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))]
    return dapple.Surface(corners, np.array(faces))


def edges_of(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Edges, the lower vertex first, and the number of triangles of each."""
    sides = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    return np.unique(sides, axis=0, return_counts=True)


def test_has_the_vertices_that_were_asked_for():
    made = dapple.remesh(dapple.Surface(*shapes.torus(24, 12)), 500)
    assert len(made) == made.report.vertices == 500
    assert made.report.euler == 0
    assert made.report.flaws == made.report.nonmanifold_edges == made.report.flipped == 0
    assert set(edges_of(made.faces)[1]) == {2}


def test_vertices_lie_where_their_faces_say():
    surface = dapple.Surface(*shapes.torus(24, 12))
    made = dapple.remesh(surface, 300)
    corners = surface.vertices[surface.faces[made.source_faces]]
    found = (corners * made.barycentric[:, :, None]).sum(axis=1)
    np.testing.assert_allclose(found, made.vertices, atol=1e-12)


def test_a_cube_keeps_its_corners_and_its_volume():
    made = dapple.remesh(cube(), 400)
    assert (made.features == 2).sum() == made.report.corners == 8
    a, b, c = np.moveaxis(made.vertices[made.faces], 1, 0)
    assert abs((a * np.cross(b, c)).sum() / 6 - 1) < 1e-12


def test_eight_vertices_make_a_cube():
    made = dapple.remesh(cube(), 8)
    assert len(made) == 8
    assert len(made.faces) == 12


def test_faces_of_the_result_form_a_surface_again():
    made = dapple.remesh(cube(), 300)
    again = dapple.remesh(dapple.Surface(made.vertices, made.faces), 200)
    assert len(again) == 200
    assert again.report.corners == 8


def test_marked_edges_stay():
    vertices, faces = shapes.grid(4)
    surface = dapple.Surface(vertices, faces)
    middle = np.flatnonzero(np.isclose(vertices[:, 0], np.median(vertices[:, 0])))
    order = middle[np.argsort(vertices[middle, 1])]
    rows = np.stack([order[:-1], order[1:]], axis=1)
    made = dapple.remesh(surface, 200, edges=rows)
    beyond = made.vertices[made.faces, 0] - vertices[middle[0], 0]
    beyond[np.abs(beyond) < 1e-9] = 0
    assert not ((beyond > 0).any(axis=1) & (beyond < 0).any(axis=1)).any()


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"edges": [[0, 99]]}, r"edges\[0\] is \(0, 99\): no face has this edge"),
        ({"edges": [0, 1]}, "edges has the shape"),
        ({"feature_angle": 181}, "feature_angle is 181"),
        ({"max_distance": -0.1}, "max_distance is -0.1"),
        ({"max_distance": float("nan")}, "max_distance is nan"),
        ({"non_manifold": "gone"}, "non_manifold is 'gone'"),
        ({"count": 0}, "count is 0"),
    ],
)
def test_names_what_is_wrong(given, message):
    with pytest.raises(ValueError, match=message):
        dapple.remesh(cube(), **{"count": 50, **given})


def test_vertices_are_added_until_the_mesh_is_near():
    surface = dapple.Surface(*shapes.torus(48, 24))
    coarse = dapple.remesh(surface, 60)
    near = dapple.remesh(surface, 60, max_distance=0.02)
    assert coarse.report.distance == 0.0
    assert len(coarse) == 60 < len(near) < 600
    assert near.report.distance <= 0.02
    found = dapple.project(dapple.Surface(near.vertices, near.faces), surface.vertices)
    assert found.distances.max() <= 0.02
    assert near.report.flaws == 0
    assert near.report.euler == 0


def test_a_distance_that_cannot_be_reached_is_told():
    surface = dapple.Surface(*shapes.torus(48, 24))
    mesh = dapple.remesh(surface, 20, max_distance=1e-12)
    assert len(mesh) > 20
    assert mesh.report.distance > 1e-12
    assert mesh.report.flaws == 0


def half_flat():
    """A torus of which one half is flat, with sharp rims."""
    vertices, faces = shapes.torus(60, 30)
    vertices[:, 2] *= np.where(vertices[:, 0] > 0.0, 1.0, 0.25)
    return vertices, faces


def test_adapts_to_the_surface():
    surface = dapple.Surface(*half_flat())
    even = dapple.remesh(surface, 300, feature_angle=180)
    adapted = dapple.remesh(surface, 300, feature_angle=180, adaptive=True)
    assert even.density is None
    assert adapted.density.shape == (len(surface.faces), 3)
    assert not adapted.density.flags.writeable
    assert len(adapted) == 300
    found = dapple.project(dapple.Surface(adapted.vertices, adapted.faces), surface.vertices)
    assert found.distances.max() <= adapted.report.distance + 1e-12
    again = pickle.loads(pickle.dumps(adapted))
    np.testing.assert_array_equal(again.density, adapted.density)
    assert pickle.loads(pickle.dumps(even)).density is None


def test_a_moving_mesh_keeps_what_it_is_adapted_to():
    vertices, faces = half_flat()
    surface = dapple.Surface(vertices, faces)

    def distances(mesh):
        """The largest on each frame: a single one depends on where a few vertices happen to be."""
        tracker = dapple.MeshTracker(surface, mesh)
        for k in range(12):
            bent = vertices * (1.0 + 0.1 * k, 1.0, 1.0)
            moved = dapple.Surface(tracker.advance(bent).vertices, mesh.faces)
            yield dapple.project(moved, bent).distances.max()

    adapted = dapple.remesh(surface, 600, adaptive=True, feature_angle=180)
    even = dapple.remesh(surface, 600, feature_angle=180)
    found = np.mean(list(distances(adapted)))
    assert found < 2.0 * adapted.report.distance
    assert found < 0.9 * np.mean(list(distances(even)))


def test_stops_when_cancelled():
    context = dapple.Context()
    context.cancel()
    with pytest.raises(dapple.Cancelled):
        dapple.remesh(cube(), 50, context=context)


def test_tells_its_report_as_a_dict():
    report = dapple.remesh(cube(), 50).report
    figures = report.to_dict()
    assert figures["vertices"] == report.vertices
    assert figures["profile"] == report.profile
    assert abs(sum(report.profile.values()) - report.seconds) < 1e-6
