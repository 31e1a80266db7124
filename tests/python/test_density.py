# SPDX-License-Identifier: GPL-3.0-or-later
"""Densities by shape and surroundings, against other computations of the same."""

import math
import pickle

import dapple3d as dapple
import numpy as np
import pytest
from dapple3d import density
from dapple3d.density import Nearest, Range, border_edges, noise, pictures
from dapple3d.density.noise import bend
from dapple3d.density.orientation import LEVEL
from dapple3d.density.ranges import window
from mask_checks import CUBE, CUBE_FACES, SQUARE, TWO, by_hand, falls, winding
from shapes import grid, torus

RANDOM = np.random.default_rng(7)


def plane() -> dapple.Surface:
    """One square of two triangles: whatever varies, varies within its faces."""
    return dapple.Surface(SQUARE, TWO)


def somewhere(count=500) -> np.ndarray:
    return np.column_stack([RANDOM.uniform(-1.99, 1.99, (count, 2)), np.zeros(count)])


@pytest.mark.parametrize("invert", [False, True])
@pytest.mark.parametrize("strength", [1.0, 0.3])
@pytest.mark.parametrize("fade", [0.0, 0.4])
def test_a_mask_is_full_in_its_range_and_falls_beside_it(invert, strength, fade):
    mask = Range(0.2, 0.7, fade, invert, strength)
    values = np.concatenate([RANDOM.uniform(-1.0, 2.0, 200), [0.2, 0.7]])
    expected = [falls(value, 0.2, 0.7, fade, invert, strength) for value in values]
    np.testing.assert_allclose(mask.factors(values), expected, atol=1e-12)


def test_a_mask_of_full_strength_is_the_window_to_the_last_bit():
    values = RANDOM.uniform(-1.0, 2.0, 10_000)
    found = Range(0.2, 0.7, 0.3).factors(values)
    assert (found == window(values, 0.2, 0.7, 0.3)).all()


def test_faces_on_which_a_mask_falls():
    mask = Range(0.0, 1.0, 0.5)
    for least, most, changes in (
        (0.1, 0.9, False), (1.6, 2.0, False), (0.9, 1.1, True), (-9.0, 9.0, True),
        (-0.4, -0.3, True), (1.2, 1.3, True), (-9.0, -0.6, False),
    ):  # fmt: skip
        assert mask.varies(np.array([least]), np.array([most]))[0] == changes


def test_distances_to_lines_points_and_meshes():
    points = RANDOM.normal(size=(300, 3))
    lines = np.concatenate([winding(), np.array([[[0.5, 1.0, 0.3]] * 2])])
    found = Nearest((), lines).distances(points)
    np.testing.assert_allclose(found, by_hand(points, lines), atol=1e-12)
    away = CUBE * 0.5 + [0.2, 0.1, 0.0]
    found = Nearest([(away, CUBE_FACES)], np.empty((0, 2, 3))).distances(points)
    outside = np.maximum(np.abs(points - [0.2, 0.1, 0.0]) - 0.5, 0.0)
    np.testing.assert_allclose(found, np.linalg.norm(outside, axis=1), atol=1e-12)
    open_mesh = (away, CUBE_FACES[2:])
    found = Nearest([open_mesh], np.empty((0, 2, 3))).distances(np.array([[0.2, 0.1, 0]]))
    assert found == pytest.approx([0.5]), "an open mesh has no inside"


def test_the_nearest_of_several_counts():
    points = RANDOM.normal(size=(100, 3))
    apart = CUBE * 0.1 + [2.0, 0.0, 0.0]
    both = Nearest([(apart, CUBE_FACES), (CUBE * 0.1, CUBE_FACES)], winding())
    outside = [np.maximum(np.abs(points - at) - 0.1, 0.0) for at in ([2.0, 0, 0], [0, 0, 0])]
    expected = np.min([np.linalg.norm(one, axis=1) for one in outside], axis=0)
    expected = np.minimum(expected, by_hand(points, winding()))
    np.testing.assert_allclose(both.distances(points), expected, atol=1e-12)


def test_distances_seen_from_above():
    points = RANDOM.normal(size=(200, 3))
    flat = points * [1.0, 1.0, 0.0]
    found = Nearest((), winding() + np.array([0.0, 0.0, 7.0]), plan=True).distances(points)
    np.testing.assert_allclose(found, by_hand(flat, winding() * [1.0, 1.0, 0.0]), atol=1e-12)
    outside = np.maximum(np.abs(flat) - [0.5, 0.5, 0.0], 0.0)
    for mesh in ((CUBE * 0.5 + [0, 0, 9.0], CUBE_FACES), (CUBE * 0.5, CUBE_FACES[2:])):
        found = Nearest([mesh], np.empty((0, 2, 3)), plan=True).distances(points)
        np.testing.assert_allclose(found, np.linalg.norm(outside, axis=1), atol=1e-9)
    wall = (np.array([[0.0, -1, 0], [0, 1, 0], [0, 1, 3]]), np.array([[0, 1, 2]], dtype=np.int32))
    found = Nearest([wall], np.empty((0, 2, 3)), plan=True).distances(points)
    expected = by_hand(flat, np.array([[[0.0, -1.0, 0.0], [0.0, 1.0, 0.0]]]))
    np.testing.assert_allclose(found, expected, atol=1e-12)


def test_a_line_far_from_the_origin_and_a_line_without_length():
    far = winding() + np.array([1e5, 0.0, 0.0])
    points = RANDOM.normal(size=(50, 3)) + np.array([1e5, 0.0, 0.0])
    np.testing.assert_allclose(Nearest((), far).distances(points), by_hand(points, far), atol=1e-3)
    at = np.zeros((1, 2, 3))
    found = Nearest((), at).distances(np.array([[3.0, 4.0, 0.0]]))
    assert found == pytest.approx([5.0])


def test_a_border_is_that_of_the_surface_whatever_its_seams():
    assert len(border_edges(SQUARE, TWO)) == 4
    assert len(border_edges(CUBE, CUBE_FACES)) == 0
    apart = CUBE[CUBE_FACES].reshape(-1, 3)
    split = np.arange(len(apart), dtype=np.int32).reshape(-1, 3)
    assert len(border_edges(apart, split)) == 0, "split vertices are no border"
    without_top = split[~(apart[split][:, :, 2] == 1.0).all(axis=1)]
    edges = border_edges(apart, without_top)
    assert len(edges) == 4
    assert (edges[:, :, 2] == 1.0).all()


def roof(pitch: float) -> dapple.Surface:
    """Two faces that slope down to the north and to the south from a ridge along x."""
    rise = math.tan(pitch)
    vertices = np.array(
        [[-1, -1, -rise], [1, -1, -rise], [1, 0, 0], [-1, 0, 0], [1, 1, -rise], [-1, 1, -rise]]
    )
    faces = np.array([[0, 1, 2], [0, 2, 3], [3, 2, 4], [3, 4, 5]], dtype=np.int32)
    return dapple.Surface(vertices, faces, sharp_angle=1.0)


def aspect_of(surface: dapple.Surface, angles: Range, direction: float) -> np.ndarray:
    return density.aspect(surface.corner_normals, angles, direction)


def test_aspect_tells_the_sides_of_a_roof_apart():
    mask = Range(0.0, 0.5, 0.0)
    north = aspect_of(roof(0.6), mask, 0.0)
    np.testing.assert_allclose(north, np.repeat([[0.0], [0.0], [1.0], [1.0]], 3, axis=1))
    south = aspect_of(roof(0.6), mask, math.pi)
    np.testing.assert_allclose(south, 1.0 - north)
    assert not aspect_of(roof(0.6), mask, math.pi / 2).any()


@pytest.mark.parametrize(("facing", "direction"), [((1, 0), 90), ((0, 1), 0), ((-1, -1), 225)])
def test_aspect_is_an_angle_on_the_compass(facing, direction):
    """A slope of 45 degrees, whose normal leans to where it faces."""
    x, y = np.array(facing) / np.linalg.norm(facing)
    vertices = SQUARE.copy()
    vertices[:, 2] = -(SQUARE[:, 0] * x + SQUARE[:, 1] * y)
    surface = dapple.Surface(vertices, TWO)
    for off in (0.0, 20.0, -35.0, 120.0):
        found = aspect_of(surface, Range(0.0, 0.2, 1.0), math.radians(direction + off))
        np.testing.assert_allclose(found, falls(math.radians(abs(off)), 0.0, 0.2, 1.0), atol=1e-7)


def test_level_ground_faces_no_direction():
    none = Range(0.0, 0.1, 0.0)
    assert (aspect_of(plane(), none, 0.0) == 1.0).all()
    half = aspect_of(roof(0.5 * LEVEL), none, math.pi / 2)
    eaves = np.array([half[0, 0], half[0, 1], half[3, 1], half[3, 2]])
    np.testing.assert_allclose(eaves, 0.5, atol=1e-6)


SHIFT = (0.317, 0.713, 0.529)


def mixed(word: int) -> int:
    word = ((word ^ (word >> 16)) * 0x7FEB352D) & 0xFFFFFFFF
    word = ((word ^ (word >> 15)) * 0x846CA68B) & 0xFFFFFFFF
    return word ^ (word >> 16)


def noise_by_hand(place, detail: int, seed: int) -> float:
    """The same noise in Python's whole numbers, place by place."""
    primes = (0x8DA6B343, 0xD8163841, 0xCB1AB31F, 0x9E3779B1)
    edges = [(0, 1, 1), (0, 1, -1), (0, -1, 1), (0, -1, -1), (1, 0, 1), (1, 0, -1), (-1, 0, 1)]
    edges += [(-1, 0, -1), (1, 1, 0), (1, -1, 0), (-1, 1, 0), (-1, -1, 0)]
    edges += [(1, 1, 0), (-1, 1, 0), (0, -1, 1), (0, -1, -1)]
    x, y, z = place
    side, up = -0.211324865405187 * (x + y), 0.577350269189626 * z
    turned = [x + side + up, y + side + up, -0.577350269189626 * (x + y) + up]
    total = 0.0
    for octave in range(detail + 1):
        key = mixed((mixed(seed & 0xFFFFFFFF) + octave * primes[3]) & 0xFFFFFFFF)
        at = [(one + shift) * 2.0**octave for one, shift in zip(turned, SHIFT, strict=True)]
        cell = [math.floor(one) for one in at]
        inside = [one - whole for one, whole in zip(at, cell, strict=True)]
        ease = [t * t * t * (t * (t * 6.0 - 15.0) + 10.0) for t in inside]
        sum_of = 0.0
        for corner in np.ndindex(2, 2, 2):
            word, weight = key, 1.0
            for k in range(3):
                word ^= ((cell[k] + corner[k]) * primes[k]) & 0xFFFFFFFF
                weight *= ease[k] if corner[k] else 1.0 - ease[k]
            edge = edges[mixed(word) >> 28]
            toward = sum(edge[k] * (inside[k] - corner[k]) for k in range(3))
            sum_of += weight * toward
        total += 0.5**octave * sum_of
    total = 4.8 * (total / math.sqrt(sum(0.25**k for k in range(detail + 1))))
    return 0.5 + 0.5 * total / math.sqrt(2.0 + total * total)


@pytest.mark.parametrize(("detail", "seed"), [(0, 0), (2, 5), (4, -3)])
def test_noise_is_the_same_bytes_as_computed_in_whole_numbers(detail, seed):
    places = RANDOM.uniform(-40.0, 40.0, (200, 3))
    expected = [noise_by_hand(place, detail, seed) for place in places]
    np.testing.assert_array_equal(noise(places, detail, seed), expected)


def test_noise_is_spread_evenly_and_in_patches():
    places = RANDOM.uniform(-60.0, 60.0, (100_000, 3))
    flat = places * [1.0, 1.0, 0.0]
    for detail in (0, 2, 5):
        for there in (places, flat):
            values = noise(there, detail, 0)
            for share in np.linspace(0.1, 0.9, 9):
                assert (values < share).mean() == pytest.approx(share, abs=0.04)
    near_by, far_off = np.array([[0.01, 0.0, 0.0], [3.0, 0.0, 0.0]])
    near = np.abs(noise(places, 2, 0) - noise(places + near_by, 2, 0))
    far = np.abs(noise(places, 2, 0) - noise(places + far_off, 2, 0))
    assert near.mean() < 0.03 < 0.2 < far.mean()
    assert np.abs(noise(places, 2, 0) - noise(places, 2, 1)).mean() > 0.2
    assert noise(np.empty((0, 3)), 2, 0).shape == (0,)


def test_noise_bends_by_no_more_than_faces_are_cut_for():
    for detail in (0, 3):
        for length in (0.02, 0.1):
            begin = RANDOM.uniform(-40.0, 40.0, (20_000, 3))
            ahead = RANDOM.normal(size=(20_000, 3))
            end = begin + length * ahead / np.linalg.norm(ahead, axis=1)[:, None]
            ends = (noise(begin, detail, 0), noise(end, detail, 0))
            middle = noise(0.5 * (begin + end), detail, 0)
            over = np.maximum(middle - np.maximum(*ends), np.minimum(*ends) - middle)
            assert (over > bend(np.array([length]), detail)[0]).mean() < 0.01


def test_values_are_looked_up_once(monkeypatch):
    field = density.Noise(Range(0.5, 1.0))
    points, asked, at = somewhere(), [], field.at
    monkeypatch.setattr(field, "at", lambda places: asked.append(len(places)) or at(places))
    first = field.values(points[:100])
    more = field.values(points)
    np.testing.assert_array_equal(more[:100], first)
    field.values(points)
    field.values(points[1:])
    assert asked == [100, 400, 499]
    np.testing.assert_array_equal(field.values(points[1:]), more[1:])


def test_faults_of_ranges_are_named():
    for wrong, said in (
        ({"falloff": -0.1}, "falloff is -0.1"), ({"strength": 1.5}, "strength is 1.5"),
        ({"low": math.nan}, "low nan"), ({"falloff": math.inf}, "falloff is inf"),
    ):  # fmt: skip
        with pytest.raises(ValueError, match=said):
            Range(**wrong)
    with pytest.raises(ValueError, match="size is 0"):
        density.Noise(Range(0.5, 1.0), size=0.0)
    with pytest.raises(ValueError, match="detail is -1"):
        density.Noise(Range(0.5, 1.0), detail=-1)
    with pytest.raises(ValueError, match="neither a mesh nor a segment"):
        Nearest()


def test_shapes_of_arrays_are_checked():
    for arguments, said in (
        ({"uv": np.zeros((2, 3))}, r"uv has the shape \(2, 3\): \(2, 3, 2\) is needed"),
        ({"rest": np.zeros((5, 3))}, r"rest has the shape \(5, 3\): \(4, 3\) is needed"),
        ({"values": {"moss": np.ones(3)}}, r"values 'moss' has the shape \(3,\): \(4,\), "),
    ):
        with pytest.raises(ValueError, match=said):
            density.MaskedSurface(plane(), count=9, **arguments)
    with pytest.raises(ValueError, match=r"clip has the shape \(3, 3\): \(4, 4\) is needed"):
        density.Camera(np.eye(3))
    with pytest.raises(ValueError, match=r"segments has the shape \(3,\): \(n, 2, 3\) is needed"):
        Nearest(segments=[0.0, 1.0, 2.0])
    with pytest.raises(ValueError, match=r"origin has the shape \(2,\): \(3,\) is needed"):
        density.Noise(Range(0.5, 1.0), origin=(0.0, 1.0))


def test_factors_multiply_a_density_wherever_they_are():
    vertices, faces = grid(3)
    own = RANDOM.random(len(vertices))
    surface = dapple.Surface(vertices, faces, own)
    on_faces, at_corners = RANDOM.random((len(faces), 1)), RANDOM.random((len(faces), 3))
    found = density.multiplied(surface, on_faces, at_corners)
    assert found.density_at == "corners"
    np.testing.assert_allclose(found.density, own[faces] * on_faces * at_corners)
    assert density.multiplied(surface) is surface
    assert density.multiplied(dapple.Surface(vertices, faces), own).density_at == "vertices"
    with pytest.raises(ValueError, match=r"factor 1 has the shape \(3,\): \(16,\), "):
        density.multiplied(surface, on_faces, np.ones(3))


def test_points_keep_to_a_sharp_range_within_large_faces():
    near = density.Distance(Range(high=0.5), Nearest(segments=winding()))
    masked = density.MaskedSurface(plane(), [near], count=400)
    samples = masked.to_original(dapple.sample(masked.surface, 400))
    assert masked.is_cut
    assert len(samples) == 400
    assert samples.faces.max() < 2, "on the faces that were given"
    spacing = masked.surface.spacing(400)
    assert by_hand(samples.positions, winding()).max() < 0.5 + 0.1 * spacing
    back = masked.to_original(masked.from_original(samples))
    np.testing.assert_allclose(back.positions, samples.positions, atol=1e-12)


def test_a_camera_leaves_out_what_meshes_hide():
    clip = np.diag([1.0, 1.0, -0.1, 1.0])  # looks down, along parallel rays
    cover = CUBE * [0.5, 0.5, 0.1] + [0.0, 0.0, 2.0]
    seen = density.Camera(clip, 1.0, [(SQUARE, TWO), (cover, CUBE_FACES)], longest=0.5)
    masked = density.MaskedSurface(plane(), [seen], count=300)
    samples = masked.to_original(dapple.sample(masked.surface, 300))
    away = np.abs(samples.positions[:, :2]).max(axis=1)
    assert 0.5 <= away.min() < 0.65  # the spacing is 0.11
    np.testing.assert_array_equal(seen.values(np.array([[0.3, 0, 0], [0.7, 0, 0.0]])), [0, 1])
    clip[2, 2] = 0.1  # looks up, from below the square
    assert density.Camera(clip, 1.0, [(cover, CUBE_FACES)]).values(np.zeros((1, 3)))[0] == 1.0
    near = np.array([[1.0, 0, 0, 0], [0, 1.0, 0, 0], [0, 0, 1, -1], [0, 0, -1, 1.0]])  # from z = 1
    assert density.Camera(near, 1.0, [(cover, CUBE_FACES)]).values(np.zeros((1, 3)))[0] == 1.0
    cover[:, 2] -= 1.5
    assert density.Camera(near, 1.0, [(cover, CUBE_FACES)]).values(np.zeros((1, 3)))[0] == 0.0


def logs(count=9, length=1.2) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Turned boxes (s, 8, 3) on the square, their middles, and their axes (s, 3, 3) as columns."""
    turn = np.linspace(0.0, 2.0, count)
    axes = np.zeros((count, 3, 3))
    axes[:, 0, 0] = axes[:, 1, 1] = np.cos(turn)
    axes[:, 1, 0], axes[:, 0, 1], axes[:, 2, 2] = np.sin(turn), -np.sin(turn), 1.0
    middles = np.array([[x, y, 0.05] for x in (-1.3, 0, 1.3) for y in (-1.3, 0, 1.3)])[:count]
    return (
        CUBE * [length / 2, 0.04, 0.05] @ axes.transpose(0, 2, 1) + middles[:, None],
        middles,
        axes,
    )


@pytest.mark.parametrize("margin", [0.0, 0.1])
def test_no_sample_lies_in_solids_and_many_lie_beside_them(margin):
    boxes, middles, axes = logs()
    solids = density.Solids(boxes.reshape(-1, 3), [8] * len(boxes), margin)
    masked = density.MaskedSurface(plane(), [solids], count=2000)
    samples = masked.to_original(dapple.sample(masked.surface, 2000))
    own = np.einsum("skd,snk->snd", axes, samples.positions - middles[:, None])
    away = np.maximum(np.abs(own) - [0.6, 0.04, 0.05], 0.0)
    distances = np.linalg.norm(away, axis=2).min(axis=0)
    assert distances.min() > margin
    assert (distances < margin + 0.05).sum() > 100
    assert samples.report.capacity_variation < 0.05
    np.testing.assert_array_equal(solids.values(samples.positions), np.ones(2000))
    np.testing.assert_array_equal(solids.values(middles * [1, 1, 0]), np.zeros(len(middles)))


def in_box(points, half, axes, place) -> np.ndarray:
    """Distances of points from a turned box, less than 0 inside."""
    beyond = np.abs((points - place) @ axes) - half
    return np.linalg.norm(beyond.clip(0.0), axis=1) + beyond.max(axis=1).clip(max=0.0)


@pytest.mark.parametrize("margin", [0.0, 0.1])
@pytest.mark.parametrize("half", [(0.4, 0.4, 0.4), (0.03, 0.5, 0.3)])
@pytest.mark.parametrize("seed", range(4))
def test_no_face_with_density_reaches_around_a_corner_of_an_obstacle(margin, half, seed):
    random = np.random.default_rng(seed)
    axes, _ = np.linalg.qr(random.normal(size=(3, 3)))
    place = np.array([*random.uniform(-0.3, 0.3, 2), 0.0])
    corners = (CUBE * np.array(half)) @ axes.T + place
    masked = density.MaskedSurface(
        plane(), [density.Obstacle(corners, CUBE_FACES, margin)], count=500
    )
    surface = masked.surface
    left = surface.vertices[surface.faces[surface.density.max(axis=1) > 0.0]]
    weights = random.dirichlet((0.5, 0.5, 0.5), 200)
    places = np.einsum("pk,fkd->fpd", weights, left).reshape(-1, 3)
    away = in_box(places, np.array(half), axes, place) - margin
    assert away.min() > -0.001 * surface.spacing(500)
    assert away.min() < 0.3 * surface.spacing(500)


def test_solids_follow_a_surface_that_moves():
    boxes, middles, _ = logs()
    solids = density.Solids(boxes.reshape(-1, 3), [8] * len(boxes))
    first = density.MaskedSurface(plane(), [solids], count=200)
    later = density.Solids(boxes.reshape(-1, 3) + np.array([0.3, 0.0, 0.0]), [8] * len(boxes))
    second = density.MaskedSurface(
        first.original.deformed(SQUARE), [later], count=200, like=first, rest=SQUARE
    )
    assert (later.values(middles * [1, 1, 0]) == 1.0).any()
    samples = second.to_original(dapple.sample(second.surface, 200))
    assert (later.values(samples.positions) == 1.0).all()


def test_solids_that_leave_nothing_or_nothing_out():
    none = density.MaskedSurface(plane(), [density.Solids(np.empty((0, 3)), [])], count=100)
    assert (none.corner_density() == 1.0).all()
    assert len(none.surface.faces) == 2
    all_of_it = density.Solids(9.0 * CUBE, [8])
    with pytest.raises(ValueError, match="density"):
        density.MaskedSurface(plane(), [all_of_it], count=100)
    with pytest.raises(ValueError, match=r"points has the shape \(8, 2\)"):
        density.Solids(CUBE[:, :2], [8])
    with pytest.raises(ValueError, match="counts do not sum up to the 8 points"):
        density.Solids(CUBE, [7])
    with pytest.raises(ValueError, match="margin is -1"):
        density.Solids(CUBE, [8], -1.0)


def test_solids_that_touch():
    boxes = (CUBE + np.array([0.0, 1.9, 9.0])[:, None, None] * [1, 0, 0]).reshape(-1, 3)
    assert dapple.touching_solids(boxes, [8, 8, 8]).tolist() == [[0, 1]]
    assert dapple.touching_solids(boxes, [8, 8, 8], margin=3.0).tolist() == [[0, 1], [1, 2]]
    assert dapple.touching_solids(np.empty((0, 3)), []).shape == (0, 2)


def test_points_that_an_eye_sees():
    surface = dapple.Surface(SQUARE, TWO)
    points = [[0.0, 0.0, -1.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    assert dapple.seen_from(surface, [0, 0, 3, 1], points).tolist() == [False, True, True]
    assert dapple.seen_from(surface, [0, 0, -1, 0], points).tolist() == [True, True, False]
    with pytest.raises(ValueError, match="eye has 3 numbers: 4 are needed"):
        dapple.seen_from(surface, [0, 0, 3], points)
    with pytest.raises(ValueError, match=r"eye\[3\] is 2"):
        dapple.seen_from(surface, [0, 0, 3, 2], points)
    with pytest.raises(ValueError, match=r"points\[0\].*inf"):
        dapple.seen_from(surface, [0, 0, 3, 1], [[0, np.inf, 0]])


def test_a_surface_without_fields_is_left_as_it_is():
    surface = plane()
    masked = density.MaskedSurface(surface, count=100, values={"moss": np.array([0.0, 1, 1, 0])})
    assert masked.surface is surface
    assert not masked.is_cut
    np.testing.assert_array_equal(masked.pieces[0], [0, 1])
    np.testing.assert_array_equal(masked.corner_density(), np.ones((2, 3)))
    np.testing.assert_array_equal(masked.corner_density("moss"), [[0, 1, 1], [0, 1, 0]])
    assert masked.class_density("") == {}
    one = dapple.SampleClass(50, **masked.class_density("moss"))
    assert len(dapple.sample_classes(masked.surface, [one])) == 50


def test_pictures_and_tiles_mask():
    uv = (SQUARE[TWO][:, :, :2] + 2.0) / 4.0
    image = np.zeros((64, 64))
    image[:, 32:] = 1.0
    masked = density.MaskedSurface(plane(), count=300, uv=uv, image=image)
    samples = masked.to_original(dapple.sample(masked.surface, 300))
    assert samples.positions[:, 0].min() > -0.1
    tiles = [(1001, np.ones((4, 4))), (1002, np.zeros((4, 4)))]
    masked = density.MaskedSurface(plane(), count=300, uv=uv * [2.0, 1.0], tiles=tiles)
    samples = masked.to_original(dapple.sample(masked.surface, 300))
    assert samples.positions[:, 0].max() < 0.1
    with pytest.raises(ValueError, match=r"none of the image's tiles \(1001, 1002\)"):
        density.MaskedSurface(plane(), count=300, uv=uv + 5.0, tiles=tiles)


def test_a_field_that_rides_is_looked_up_at_rest():
    vertices, faces = torus()
    patches = density.Noise(Range(0.5, 1.0), size=0.5, rides=True)
    first = density.MaskedSurface(dapple.Surface(vertices, faces), [patches], count=500)
    moved = dapple.Surface(vertices + np.array([5.0, 0.0, 0.0]), faces)
    later = density.MaskedSurface(moved, [patches], count=500, rest=vertices)
    np.testing.assert_array_equal(first.corner_density(), later.corner_density())
    alone = density.MaskedSurface(moved, [patches], count=500)
    assert alone.corner_density().shape != first.corner_density().shape


def test_cutting_can_be_cancelled():
    context = dapple.Context()
    context.cancel()
    with pytest.raises(dapple.Cancelled):
        density.MaskedSurface(
            plane(), [density.Height(Range(-1.0, 0.5)), density.Noise(Range(0.5, 1.0))], count=500,
            context=context,
        )  # fmt: skip


def test_ranges_pickle():
    one = Range(0.1, 0.3, falloff=0.2, invert=True, strength=0.5)
    assert pickle.loads(pickle.dumps(one)) == one


UDIM = [(1001, np.full((2, 3), 1.0)), (1012, np.full((4, 2), 2.0))]


def small_faces(*places):
    """Small triangles at these places."""
    corners = np.array([[0.0, 0.0], [0.01, 0.0], [0.0, 0.01]])
    return np.array(places, dtype=float)[:, None] + corners


def test_numbers_are_squares():
    np.testing.assert_array_equal(pictures.squares(UDIM), [[0, 0], [1, 1]])


def test_faces_over_the_border_of_a_tile_are_found():
    uv = small_faces([0.5, 0.5], [0.995, 0.5], [1.5, 0.5], [1.995, 1.5], [2.995, 2.5], [0.99, 0.0])
    np.testing.assert_array_equal(
        pictures.crossing(uv, UDIM), [False, True, False, True, False, False]
    )
    assert not pictures.crossing(small_faces([1.0 - 1e-9, 0.5]), UDIM).any()


def test_each_face_is_in_the_tile_of_its_center():
    uv = small_faces([0.5, 0.5], [1.2, 1.9], [1.2, 0.5], [-0.5, 0.5], [0.995, 0.5])
    picture, places = pictures.laid_out(uv, UDIM)
    rows, columns = picture.shape
    pixels = np.floor(places * (columns, rows)).astype(int)
    values = picture[pixels[..., 1], pixels[..., 0]]
    np.testing.assert_array_equal(values[:, 0], [1.0, 2.0, 0.0, 0.0, 1.0])


def test_nothing_of_a_neighbor_is_seen_at_a_border():
    """Between centers of pixels, of which those of the frame are the outermost."""
    tiles = [(1001, np.zeros((2, 2))), (1002, np.ones((2, 2)))]
    uv = np.array([[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]], [[1.0, 0.0], [2.0, 0.0], [2.0, 1.0]]])
    picture, places = pictures.laid_out(uv, tiles)
    at = places * picture.shape[::-1] - 0.5
    low = np.floor(at).astype(int)
    for face, expected in ((0, 0.0), (1, 1.0)):
        for x, y in low[face]:
            np.testing.assert_array_equal(picture[y : y + 2, x : x + 2], expected)
