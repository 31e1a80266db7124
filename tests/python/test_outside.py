# SPDX-License-Identifier: GPL-3.0-or-later
"""Outside only: no point where nothing can see it, and even spacing across joints of parts."""

import json
import pickle

import dapple3d as dapple
import numpy as np
import pytest
from checks import check_array, check_samples
from command_line import done, run
from dapple3d import density
from dapple3d.cli import points
from mask_checks import CUBE, CUBE_FACES

COUNT = 400
SHIFT = np.array([1.1, 0.1, 0.05])


def ball():
    """An octahedron, cut and blown up to a radius of 1."""
    corners = np.vstack([np.eye(3), -np.eye(3)])
    ends = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]
    cut = dapple.refine_edges(dapple.Surface(corners, ends), 0.1).surface
    return cut.vertices / np.linalg.norm(cut.vertices, axis=1, keepdims=True), cut.faces


def two_balls():
    """Balls that are stuck into each other."""
    vertices, faces = ball()
    return np.vstack([vertices, vertices + SHIFT]), np.vstack([faces, faces + len(vertices)])


def is_hidden(positions, slack=0.01):
    nearest = np.minimum(
        np.linalg.norm(positions, axis=1), np.linalg.norm(positions - SHIFT, axis=1)
    )
    return nearest < 1.0 - slack


@pytest.fixture(scope="module")
def surface():
    return dapple.Surface(*two_balls())


@pytest.fixture(scope="module")
def refined(surface):
    return dapple.refine_outside(surface, 0.1 * surface.spacing(COUNT))


def test_measures_the_exposure_of_faces_and_of_places(surface):
    of_faces = dapple.exposure(surface)
    check_array(of_faces, np.float64, (len(surface.faces),))
    centers = surface.vertices[surface.faces].mean(axis=1)
    assert (of_faces[is_hidden(centers, 0.03)] == 0.0).all()
    assert (of_faces[np.abs(centers[:, 0] - SHIFT[0] / 2) > 1.2] > 0.9).all()
    some = np.array([3, 70, 500], dtype=np.int32)
    of_places = dapple.exposure(surface, some, np.full((3, 3), 1 / 3))
    np.testing.assert_array_equal(of_places, of_faces[some])


def test_a_cube_within_a_cube_is_hidden():
    surface = dapple.Surface(
        np.vstack([CUBE, 0.5 * CUBE]), np.vstack([CUBE_FACES, CUBE_FACES + len(CUBE)])
    )
    np.testing.assert_array_equal(dapple.exposure(surface), np.repeat([1.0, 0.0], 12))


@pytest.mark.parametrize("longest", [0.3, 10.0])
def test_where_faces_lie_on_each_other_only_the_first_part_has_samples(longest):
    """Two cubes with their tops and bottoms in the same planes."""
    parts, offset = [], np.array([0.5, 0.37, 0.0])
    for place, edge in ((0.0 * offset, longest), (offset, 0.83 * longest)):
        cut = dapple.refine_edges(dapple.Surface(CUBE + place, CUBE_FACES), edge).surface
        parts.append((cut.vertices, cut.faces))
    (one, faces), (other, more) = parts
    surface = dapple.Surface(np.vstack([one, other]), np.vstack([faces, more + len(one)]))
    refined = dapple.refine_outside(surface, 0.1 * surface.spacing(COUNT))
    overlap = (2.0 - offset[0]) * (2.0 - offset[1])
    sides = 2.0 * (2.0 * (4.0 + offset[0] + offset[1]))
    assert refined.surface.capacity == pytest.approx(2.0 * (8.0 - overlap) + sides, rel=2e-3)
    samples = refined.to_original(dapple.sample(refined.surface, COUNT))
    spacing = refined.surface.spacing(COUNT)
    covered = dapple.exposure(surface, samples.faces, samples.barycentric) == 0.0
    # Nothing is cut exactly where a face ends within another one in its plane.
    within = 1.0 - np.abs(samples.positions[covered, :2]).max(axis=1)
    assert (np.abs(within) < 0.03 * spacing).all()
    assert covered.sum() < 4
    distances = dapple.nearest_distances(samples.positions) / spacing
    assert np.sort(distances)[COUNT // 50] > 0.5  # near the end of such a face some are nearer


def test_samples_lie_on_the_outer_skin_and_keep_apart_across_the_joint(surface, refined):
    assert refined.resolved
    fine = dapple.sample(refined.surface, COUNT)
    samples = refined.to_original(fine)
    check_samples(surface, samples)
    assert not is_hidden(samples.positions).any()
    assert (dapple.exposure(surface, samples.faces, samples.barycentric) > 0.0).all()
    assert fine.report.capacity_variation < 0.02
    spacing = refined.surface.spacing(COUNT)
    assert dapple.nearest_distances(samples.positions).min() > 0.5 * spacing


def test_parts_are_followed_when_they_move(surface, refined):
    moved = surface.vertices.copy()
    moved[len(moved) // 2 :] += [0.05, 0.0, 0.0]
    samples = dapple.sample(refined.surface, COUNT)
    tracker = dapple.Tracker(refined.surface, samples)
    later = refined.deformed(moved).to_original(tracker.advance(refined.vertices(moved)))
    check_samples(dapple.Surface(moved, surface.faces), later)


def test_a_refinement_is_pickled_with_its_joints(refined):
    again = pickle.loads(pickle.dumps(refined))
    samples = dapple.sample(refined.surface, 50)
    for one, other in (
        (again.surface.vertices, refined.surface.vertices),
        (again.vertices(refined.original.vertices), refined.surface.vertices),
        (again.to_original(samples).positions, refined.to_original(samples).positions),
    ):
        np.testing.assert_array_equal(one, other)


def test_points_on_two_bodies_keep_apart_on_the_walls_of_a_groove():
    """Two boards that cross at an acute angle; also on a surface that was pickled."""
    board, other = CUBE * [1.0, 0.5, 0.1], CUBE * [0.9, 0.5, 0.08]
    cos, sin = np.cos(0.5), np.sin(0.5)
    other = other @ np.array([[cos, 0, -sin], [0, 1, 0], [sin, 0, cos]]) + [0.1, 0.03, 0.02]
    surface = dapple.Surface(
        np.vstack([board, other]), np.vstack([CUBE_FACES, CUBE_FACES + len(CUBE)])
    )
    refined = dapple.refine_outside(surface, 0.1 * surface.spacing(600))
    spacing = np.sqrt(2.0 * refined.surface.capacity / (np.sqrt(3.0) * 600))
    for solved in (refined.surface, pickle.loads(pickle.dumps(refined.surface))):
        found = dapple.sample(solved, 600)
        assert found.report.converged
        assert found.report.capacity_variation < 0.02
        samples = refined.to_original(
            dapple.Samples(refined.surface, found.faces, found.barycentric)
        )
        first = samples.faces < len(CUBE_FACES)
        apart = samples.positions[first][:, None] - samples.positions[~first]
        assert np.linalg.norm(apart, axis=2).min() >= 0.6 * spacing


def test_masks_go_with_it(surface):
    left = density.Height(density.Range(high=0.0), 2.0)
    masked = density.MaskedSurface(surface, [left], count=COUNT, outside=0.05)
    samples = masked.to_original(dapple.sample(masked.surface, COUNT))
    assert not is_hidden(samples.positions).any()
    assert samples.positions[:, 2].max() <= 1e-9


def test_a_painted_density_needs_no_second_look(surface):
    """What is hidden depends on the shape alone, and is the same as anew."""
    first = density.MaskedSurface(surface, count=COUNT, outside=0.05)
    values = 1.0 + surface.vertices[:, 2] ** 2
    painted = surface.with_density(values)
    again = density.MaskedSurface(painted, count=COUNT, outside=0.05, like=first)
    anew = density.MaskedSurface(painted, count=COUNT, outside=0.05)
    np.testing.assert_array_equal(again.surface.vertices, anew.surface.vertices)
    np.testing.assert_array_equal(again.corner_density(), anew.corner_density())
    corners = again.surface.vertices[again.surface.faces]
    there = again.corner_density()
    assert (there[is_hidden(corners.mean(axis=1), 0.02)] == 0.0).all()
    seen = there.min(axis=1) > 0.0
    on_vertices = 1.0 + corners[seen][:, :, 2] ** 2
    np.testing.assert_allclose(there[seen], on_vertices, rtol=0.05)
    again.to_original(dapple.sample(again.surface, COUNT))


def test_what_is_hidden_at_rest_stays_hidden(surface):
    moved = surface.vertices + np.array([0.0, 0.0, 1.0])
    moved[len(moved) // 2 :] += [3.0, 0.0, 0.0]
    apart = surface.deformed(moved)
    masked = density.MaskedSurface(apart, count=COUNT, outside=0.05, rest=surface.vertices)
    samples = masked.to_original(dapple.sample(masked.surface, COUNT))
    check_samples(apart, samples)
    back = dapple.Samples(surface, samples.faces, samples.barycentric)
    assert not is_hidden(back.positions).any()


def test_a_deformed_body_keeps_the_skin_of_its_rest_position(surface, monkeypatch):
    """Its spacing differs, but what is hidden is not looked for on each frame anew."""
    first = density.MaskedSurface(surface, count=COUNT, outside=0.05)
    longer = surface.deformed(surface.vertices * [1.0, 1.0, 1.5])
    rest = surface.vertices
    monkeypatch.setattr(density.masked, "refine_outside", None)
    masked = density.MaskedSurface(longer, count=COUNT, outside=0.05, like=first, rest=rest)
    for one, other in zip(masked.pieces, first.pieces, strict=True):
        np.testing.assert_array_equal(one, other)
    np.testing.assert_array_equal(masked.corner_density(), first.corner_density())


def with_second_at(surface, offset):
    """The balls while the second one is elsewhere."""
    moved = surface.vertices.copy()
    moved[len(moved) // 2 :] += offset
    return moved


def test_in_several_poses_only_what_is_seen_in_all_is_left(surface):
    poses = [with_second_at(surface, (-0.4, 0.0, 0.0)), with_second_at(surface, (0.0, 0.8, 0.0))]
    refined = dapple.refine_outside(surface, 0.1 * surface.spacing(COUNT), poses=poses)
    samples = refined.to_original(dapple.sample(refined.surface, COUNT))
    check_samples(surface, samples)
    for pose in (surface.vertices, *poses):
        there = surface.deformed(pose)
        assert (dapple.exposure(there, samples.faces, samples.barycentric) > 0.0).all()


def test_masks_take_poses_and_know_them_again(surface):
    poses = [surface.vertices, with_second_at(surface, (-0.4, 0.0, 0.0))]
    given = {"count": COUNT, "outside": 0.05, "poses": poses}
    first = density.MaskedSurface(surface, **given)
    assert (
        first.surface.capacity
        < density.MaskedSurface(surface, count=COUNT, outside=0.05).surface.capacity
    )
    later = surface.deformed(with_second_at(surface, (-0.2, 0.0, 0.0)))
    again = density.MaskedSurface(later, **given, like=first, rest=surface.vertices)
    np.testing.assert_array_equal(again.corner_density(), first.corner_density())
    samples = again.to_original(dapple.sample(again.surface, COUNT))
    check_samples(later, samples)
    with pytest.raises(ValueError, match=r"poses\[1\] has the shape"):
        density.MaskedSurface(surface, count=COUNT, outside=0.05, poses=[poses[0], np.eye(3)])


def test_what_a_pose_leaves_may_differ_from_rest(surface):
    """One pose alone decides instead of the rest."""
    pose = with_second_at(surface, (5.0, 0.0, 0.0))
    masked = density.MaskedSurface(surface, count=COUNT, outside=0.05, poses=[pose])
    assert masked.surface.capacity == pytest.approx(surface.area)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"edge": 0.1, "poses": [np.zeros((2, 3))]}, r"poses\[0\] has 2 entries"),
        ({"edge": 0.1, "poses": [np.zeros((2, 2))]}, r"poses\[0\]"),
        ({"edge": 0.0}, "edge is 0"),
        ({"edge": np.nan}, "edge is nan"),
        ({"edge": 0.1, "openness": 1.5}, r"openness is 1\.5: it must be in 0\.\.1"),
        ({"edge": 0.1, "openness": np.nan}, "openness is nan"),
        ({"edge": 0.1, "max_faces": 0}, "max_faces is 0"),
    ],
)
def test_refuses_options_out_of_range(surface, given, message):
    with pytest.raises(ValueError, match=message):
        dapple.refine_outside(surface, **given)


def test_refuses_places_that_are_not_on_the_surface(surface):
    with pytest.raises(ValueError, match=r"faces\[1\] is 999999"):
        dapple.exposure(surface, [0, 999999], np.eye(3)[:2])
    with pytest.raises(ValueError, match="go together"):
        dapple.exposure(surface, [0])


def test_is_cancelled(surface):
    context = dapple.Context()
    context.cancel()
    with pytest.raises(dapple.Cancelled):
        dapple.refine_outside(surface, 0.1, context=context)
    with pytest.raises(dapple.Cancelled):
        dapple.exposure(surface, context=context)


def test_on_the_command_line(tmp_path):
    mesh, out, report = tmp_path / "balls.npz", tmp_path / "out.npz", tmp_path / "report.json"
    vertices, faces = two_balls()
    np.savez(mesh, vertices=vertices, faces=faces)
    done("sample", mesh, out, "-n", COUNT, "--outside", "--json", report)
    found = points.read_points(out)
    assert len(found.positions) == COUNT
    assert not is_hidden(found.positions).any()
    assert json.loads(report.read_text())["settings"]["masks"] == {"outside": True}
    done("sample", mesh, out, "-n", COUNT, "--outside", "--openness", "0.8")
    assert found.positions.shape == points.read_points(out).positions.shape
    for wrong, message in (
        (("--openness", "0.5"), "--openness needs --outside"),
        (("--outside", "--openness", "1.5"), "1.5"),
    ):
        outcome = run("sample", mesh, out, "-n", 9, *wrong)
        assert outcome.exit_code == 2
        assert message in outcome.stderr
