# SPDX-License-Identifier: GPL-3.0-or-later
"""Masks of a density against other computations of the same, also within large faces."""

import math
from dataclasses import replace

import dapple3d as dapple
import numpy as np
import pytest

from addon.core import aspect, density_colors, frames, masks, nearest, raw, sources, stale
from addon.core.density_table import DENSITY
from addon.core.fields import fields_of
from addon.core.ground import Ground
from addon.core.noise import bend, noise
from addon.core.settings import DensitySettings, Settings
from addon.core.surface import Floats, SurfaceArrays, Surroundings

RANDOM = np.random.default_rng(7)
SQUARE = np.array([[-2, -2, 0], [2, -2, 0], [2, 2, 0], [-2, 2, 0]], dtype=float)
TWO = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
CUBE = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
CUBE_FACES = np.array(
    [
        [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
        [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
    ],
    dtype=np.int32,
)  # fmt: skip


def plane(matrix=None, **around) -> SurfaceArrays:
    """One square of two triangles: whatever varies, varies within its faces."""
    matrix = np.eye(4) if matrix is None else matrix
    vertices = SQUARE @ matrix[:3, :3].T + matrix[:3, 3]
    return SurfaceArrays("Plane", vertices, TWO, "same", matrix, around=Surroundings(**around))


def winding() -> np.ndarray:
    """Segments of a line over the square."""
    t = np.linspace(-1.5, 1.5, 60)
    places = np.column_stack([t, np.sin(2.0 * t), 0.2 * t])
    return np.stack([places[:-1], places[1:]], axis=1)


def by_hand(points, segments) -> np.ndarray:
    """Distances to segments, place by place."""
    found = []
    for point in points:
        best = math.inf
        for begin, end in segments:
            along = end - begin
            length = float(along @ along)
            share = min(max(float((point - begin) @ along) / length, 0.0), 1.0) if length else 0.0
            best = min(best, math.dist(point, begin + share * along))
        found.append(best)
    return np.array(found)


def falls(value, low, high, fade, invert=False, strength=1.0) -> float:
    """A factor of the density, as docs/add-on.md has it."""
    if low <= value <= high:
        full = 1.0
    else:
        beside = low - value if value < low else value - high
        full = max(1.0 - beside / fade, 0.0) if fade > 0.0 else 0.0
    return 1.0 - strength * full if invert else 1.0 - strength * (1.0 - full)


def density_at(surface: SurfaceArrays, points, count=4000, **density) -> np.ndarray:
    """What the ground has at places of the square."""
    ground = Ground(surface, Settings(count=count, density=DensitySettings(**density)))
    closest = dapple.project(ground.surface, np.ascontiguousarray(points))
    corners = ground.at_corners()[closest.faces]
    return np.einsum("nk,nk->n", corners, closest.barycentric)


def somewhere(count=500) -> np.ndarray:
    return np.column_stack([RANDOM.uniform(-1.99, 1.99, (count, 2)), np.zeros(count)])


@pytest.mark.parametrize("invert", [False, True])
@pytest.mark.parametrize("strength", [1.0, 0.3])
@pytest.mark.parametrize("fade", [0.0, 0.4])
def test_a_mask_is_full_in_its_range_and_falls_beside_it(invert, strength, fade):
    mask = masks.Mask(0.2, 0.7, fade, invert, strength)
    values = np.concatenate([RANDOM.uniform(-1.0, 2.0, 200), [0.2, 0.7]])
    expected = [falls(value, 0.2, 0.7, fade, invert, strength) for value in values]
    np.testing.assert_allclose(mask.factors(values), expected, atol=1e-12)


def test_a_mask_of_full_strength_is_the_window_to_the_last_bit():
    values = RANDOM.uniform(-1.0, 2.0, 10_000)
    found = masks.Mask(0.2, 0.7, 0.3).factors(values)
    assert (found == masks.window(values, 0.2, 0.7, 0.3)).all()


def test_a_mask_without_strength_is_none():
    for name in ("slope", "height", "distance", "border", "aspect", "noise"):
        on = DensitySettings(**{f"use_{name}": True})
        assert masks.mask_of(on, name) is not None
        off = DensitySettings(**{f"use_{name}": True, f"{name}_strength": 0.0})
        assert masks.mask_of(off, name) is None


def test_slope_and_height_can_be_inverted_and_weak():
    points = somewhere()
    tipped = turned_up(0.8)
    there = points @ tipped[:3, :3].T
    range_of = {"height_from": -0.5, "height_to": 0.5, "height_fade": 0.3}
    weak = {"height_invert": True, "height_strength": 0.6}
    found = density_at(plane(tipped), there, use_height=True, **range_of, **weak)
    expected = [falls(z, -0.5, 0.5, 0.3, True, 0.6) for z in there[:, 2]]
    assert np.abs(found - expected).mean() < 0.01
    for angle in (0.1, 0.5, 0.8, 1.2):
        found = density_at(
            plane(turned_up(angle)), points[:1], use_slope=True, slope_invert=True,
            slope_strength=0.7, slope_to=0.4, slope_fade=0.5,
        )  # fmt: skip
        assert found == pytest.approx(falls(angle, 0.0, 0.4, 0.5, True, 0.7))


def turned_up(angle: float) -> np.ndarray:
    found = np.eye(4)
    found[1:3, 1:3] = [[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]]
    return found


def test_faces_on_which_a_mask_falls():
    mask = masks.Mask(0.0, 1.0, 0.5)
    for least, most, changes in (
        (0.1, 0.9, False), (1.6, 2.0, False), (0.9, 1.1, True), (-9.0, 9.0, True),
        (-0.4, -0.3, True), (1.2, 1.3, True), (-9.0, -0.6, False),
    ):  # fmt: skip
        assert mask.falls(np.array([least]), np.array([most]))[0] == changes


def test_distances_to_lines_points_and_meshes():
    points = RANDOM.normal(size=(300, 3))
    lines = np.concatenate([winding(), np.array([[[0.5, 1.0, 0.3]] * 2])])
    found = nearest.Nearest((), lines).distances(points)
    np.testing.assert_allclose(found, by_hand(points, lines), atol=1e-12)
    away = CUBE * 0.5 + [0.2, 0.1, 0.0]
    found = nearest.Nearest([(away, CUBE_FACES)], np.empty((0, 2, 3))).distances(points)
    outside = np.maximum(np.abs(points - [0.2, 0.1, 0.0]) - 0.5, 0.0)
    np.testing.assert_allclose(found, np.linalg.norm(outside, axis=1), atol=1e-12)
    open_mesh = (away, CUBE_FACES[2:])
    found = nearest.Nearest([open_mesh], np.empty((0, 2, 3))).distances(np.array([[0.2, 0.1, 0]]))
    assert found == pytest.approx([0.5]), "an open mesh has no inside"


def test_the_nearest_of_several_counts():
    points = RANDOM.normal(size=(100, 3))
    apart = CUBE * 0.1 + [2.0, 0.0, 0.0]
    both = nearest.Nearest([(apart, CUBE_FACES), (CUBE * 0.1, CUBE_FACES)], winding())
    outside = [np.maximum(np.abs(points - at) - 0.1, 0.0) for at in ([2.0, 0, 0], [0, 0, 0])]
    expected = np.min([np.linalg.norm(one, axis=1) for one in outside], axis=0)
    expected = np.minimum(expected, by_hand(points, winding()))
    np.testing.assert_allclose(both.distances(points), expected, atol=1e-12)


def test_distances_seen_from_above():
    points = RANDOM.normal(size=(200, 3))
    flat = points * [1.0, 1.0, 0.0]
    found = nearest.Nearest((), winding() + np.array([0.0, 0.0, 7.0]), plan=True).distances(points)
    np.testing.assert_allclose(found, by_hand(flat, winding() * [1.0, 1.0, 0.0]), atol=1e-12)
    outside = np.maximum(np.abs(flat) - [0.5, 0.5, 0.0], 0.0)
    for mesh in ((CUBE * 0.5 + [0, 0, 9.0], CUBE_FACES), (CUBE * 0.5, CUBE_FACES[2:])):
        found = nearest.Nearest([mesh], np.empty((0, 2, 3)), plan=True).distances(points)
        np.testing.assert_allclose(found, np.linalg.norm(outside, axis=1), atol=1e-9)
    wall = (np.array([[0.0, -1, 0], [0, 1, 0], [0, 1, 3]]), np.array([[0, 1, 2]], dtype=np.int32))
    found = nearest.Nearest([wall], np.empty((0, 2, 3)), plan=True).distances(points)
    expected = by_hand(flat, np.array([[[0.0, -1.0, 0.0], [0.0, 1.0, 0.0]]]))
    np.testing.assert_allclose(found, expected, atol=1e-12)


def test_a_line_far_from_the_origin_and_a_line_without_length():
    far = winding() + np.array([1e5, 0.0, 0.0])
    points = RANDOM.normal(size=(50, 3)) + np.array([1e5, 0.0, 0.0])
    np.testing.assert_allclose(
        nearest.Nearest((), far).distances(points), by_hand(points, far), atol=1e-3
    )
    at = np.zeros((1, 2, 3))
    found = nearest.Nearest((), at).distances(np.array([[3.0, 4.0, 0.0]]))
    assert found == pytest.approx([5.0])


def test_the_distance_counts_within_large_faces():
    points = somewhere()
    range_of = {"distance_from": 0.1, "distance_to": 0.4, "distance_fade": 0.3}
    found = density_at(plane(lines=winding()), points, use_distance=True, **range_of)
    expected = [falls(one, 0.1, 0.4, 0.3) for one in by_hand(points, winding())]
    assert np.abs(found - expected).mean() < 0.01
    assert np.abs(found - expected).max() < 0.2


def test_a_sharp_distance_is_followed_to_a_share_of_the_spacing():
    points, count = somewhere(2000), 4000
    found = density_at(plane(lines=winding()), points, count, use_distance=True, distance_fade=0.0)
    distance = by_hand(points, winding())
    spacing = math.sqrt(16.0 / count)
    clear = np.abs(distance - 0.5) > 0.5 * spacing
    np.testing.assert_array_equal(found[clear], distance[clear] <= 0.5)


def test_a_border_is_that_of_the_surface_whatever_its_seams():
    assert len(nearest.border_of(SQUARE, TWO)) == 4
    assert len(nearest.border_of(CUBE, CUBE_FACES)) == 0
    apart = CUBE[CUBE_FACES].reshape(-1, 3)
    split = np.arange(len(apart), dtype=np.int32).reshape(-1, 3)
    assert len(nearest.border_of(apart, split)) == 0, "split vertices are no border"
    without_top = split[~(apart[split][:, :, 2] == 1.0).all(axis=1)]
    edges = nearest.border_of(apart, without_top)
    assert len(edges) == 4
    assert (edges[:, :, 2] == 1.0).all()


def test_the_border_counts_within_large_faces():
    points = somewhere()
    found = density_at(plane(), points, use_border=True, border_to=0.3, border_fade=0.4)
    expected = [falls(one, 0.0, 0.3, 0.4) for one in 2.0 - np.abs(points[:, :2]).max(axis=1)]
    assert np.abs(found - expected).mean() < 0.01


def test_a_closed_surface_has_no_border_and_the_mask_no_effect():
    surface = SurfaceArrays("Cube", CUBE, CUBE_FACES, "same")
    settings = DensitySettings(use_border=True, border_invert=True)
    assert fields_of(surface, settings) == []
    assert not Ground(surface, Settings(density=settings)).is_cut


def test_a_distance_to_nothing_has_no_effect():
    assert fields_of(plane(), DensitySettings(use_distance=True)) == []


def test_a_sharp_height_ends_at_the_edge_of_a_floor():
    cube = SurfaceArrays("Cube", CUBE, CUBE_FACES, "same")
    settings = DensitySettings(use_height=True, height_from=1.0, height_to=2.0, height_fade=0.0)
    ground = Ground(cube, Settings(count=300, density=settings))
    top = (ground.surface.vertices[ground.surface.faces][:, :, 2] == 1.0).all(axis=1)
    np.testing.assert_array_equal(ground.at_corners(), np.repeat(top[:, None], 3, axis=1))
    assert ground.surface.mass == pytest.approx(4.0)


def roof(pitch: float) -> SurfaceArrays:
    """Two faces that slope down to the north and to the south from a ridge along x."""
    rise = math.tan(pitch)
    vertices = np.array(
        [[-1, -1, -rise], [1, -1, -rise], [1, 0, 0], [-1, 0, 0], [1, 1, -rise], [-1, 1, -rise]]
    )
    faces = np.array([[0, 1, 2], [0, 2, 3], [3, 2, 4], [3, 4, 5]], dtype=np.int32)
    return shaded_flat(SurfaceArrays("Roof", vertices, faces, "same"))


def shaded_flat(surface: SurfaceArrays) -> SurfaceArrays:
    a, b, c = (surface.vertices[surface.faces[:, k]] for k in range(3))
    flat = np.cross(b - a, c - a)
    flat /= np.linalg.norm(flat, axis=1)[:, None]
    return replace(surface, normals=np.repeat(flat, 3, axis=0))


def aspect_of(surface: SurfaceArrays, mask: masks.Mask, direction: float) -> Floats:
    return aspect.aspect_factors(frames.corner_normals(surface), mask, direction)


def test_aspect_tells_the_sides_of_a_roof_apart():
    mask = masks.Mask(0.0, 0.5, 0.0)
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
    surface = SurfaceArrays("Slope", vertices, TWO, "same")
    for off in (0.0, 20.0, -35.0, 120.0):
        found = aspect_of(surface, masks.Mask(0.0, 0.2, 1.0), math.radians(direction + off))
        np.testing.assert_allclose(found, falls(math.radians(abs(off)), 0.0, 0.2, 1.0), atol=1e-7)


def test_level_ground_faces_no_direction():
    none = masks.Mask(0.0, 0.1, 0.0)
    assert (aspect_of(plane(), none, 0.0) == 1.0).all()
    half = aspect_of(roof(0.5 * aspect.LEVEL), none, math.pi / 2)
    eaves = np.array([half[0, 0], half[0, 1], half[3, 1], half[3, 2]])
    np.testing.assert_allclose(eaves, 0.5, atol=1e-6)


def test_aspect_and_other_terms_are_multiplied():
    weights = {"Grass": np.array([0.2, 0.4, 0.6, 0.8, 1.0, 1.0])}
    surface = roof(0.6)
    surface = replace(surface, weights=weights)
    density = DensitySettings(use_aspect=True, attribute="Grass", aspect_strength=0.5)
    ground = Ground(surface, Settings(density=density))
    own = weights["Grass"][surface.faces]
    np.testing.assert_allclose(ground.uncut, own * [[0.5], [0.5], [1.0], [1.0]], atol=1e-12)
    assert ground.uncut.shape == ground.at_corners().shape == (4, 3)


def test_aspect_holds_within_faces_that_others_cut():
    density = {"use_aspect": True, "use_height": True, "height_to": 5.0, "height_from": -0.4}
    ground = Ground(roof(0.6), Settings(count=2000, density=DensitySettings(**density)))
    assert ground.is_cut
    corners = ground.surface.vertices[ground.surface.faces]
    north = corners[:, :, 1].mean(axis=1) > 0.0
    expected = [[falls(z, -0.4, 5.0, 0.1) for z in one] for one in corners[north][:, :, 2]]
    np.testing.assert_allclose(ground.at_corners()[north], expected, atol=1e-9)
    assert not ground.at_corners()[~north].any()


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


def turned_by(angle: float, shift) -> np.ndarray:
    found = np.eye(4)
    found[:2, :2] = [[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]]
    found[:3, 3] = shift
    return found


def test_noise_counts_within_large_faces_and_goes_with_the_surface():
    points, pose = somewhere(), turned_by(0.7, [5.0, -3.0, 2.0])
    density = {"use_noise": True, "noise_scale": 0.8, "noise_fade": 0.2, "noise_seed": 3}
    found = density_at(plane(), points, **density)
    expected = [falls(one, 0.5, 1.0, 0.2) for one in noise(points / 0.8, 2, 3)]
    assert np.abs(found - expected).mean() < 0.03
    there = points @ pose[:3, :3].T + pose[:3, 3]
    again = density_at(plane(pose), there, **density)
    assert np.abs(found - again).mean() < 0.01


def test_size_of_noise_is_that_of_the_world():
    """An object that was scaled has patches of the same size."""
    scaled = plane(np.diag([2.0, 2.0, 2.0, 1.0]))
    (field,) = fields_of(scaled, DensitySettings(use_noise=True, noise_scale=0.5))
    points = somewhere()
    np.testing.assert_allclose(field.at(points), noise(points / 0.5, 2, 0), atol=1e-9)


def test_values_are_looked_up_once(monkeypatch):
    (field,) = fields_of(plane(), DensitySettings(use_noise=True))
    points, asked, at = somewhere(), [], field.at
    monkeypatch.setattr(field, "at", lambda places: asked.append(len(places)) or at(places))
    first = field.values(points[:100])
    more = field.values(points)
    np.testing.assert_array_equal(more[:100], first)
    field.values(points)
    field.values(points[1:])
    assert asked == [100, 400, 499]
    np.testing.assert_array_equal(field.values(points[1:]), more[1:])


def test_a_term_alone_has_its_settings_and_no_other():
    full = DensitySettings(
        attribute="Grass", use_slope=True, slope_to=0.3, use_noise=True, noise_seed=4
    )
    alone = full.alone("use_noise")
    assert (alone.use_noise, alone.noise_seed, alone.use_slope, alone.attribute) == (
        True, 4, False, "",
    )  # fmt: skip
    assert full.alone("attribute") == DensitySettings(attribute="Grass")


def test_a_result_of_before_masks_fits():
    settings = Settings(density=DensitySettings(use_slope=True))
    old = stale.settings_text(settings)
    for name in [one.name for one in DENSITY if one.name.endswith(("_invert", "_strength"))]:
        assert f'"{name}"' in old
        value = "false" if name.endswith("_invert") else "1.0"
        old = old.replace(f'"{name}": {value}, ', "")
    for mask in ("distance", "border", "aspect", "noise"):
        old = old.replace(f'"use_{mask}": false, ', "")
    assert stale.changed_settings(old, settings) == []
    inverted = Settings(density=DensitySettings(use_slope=True, slope_invert=True))
    assert stale.changed_settings(old, inverted) == ["density"]


def differing(before: SurfaceArrays, now: SurfaceArrays, **density) -> list[str]:
    settings = Settings(density=DensitySettings(**density))
    stored = sources.sources_from(sources.sources_of(before, settings).text())
    return sources.differing(stored, sources.sources_of(now, settings))


def test_what_masks_depend_on_is_compared():
    line = winding()
    other = line.copy()
    other[7, 0, 1] += 0.01
    before = plane(lines=line)
    assert differing(before, plane(lines=line), use_distance=True) == []
    assert differing(before, plane(lines=other), use_distance=True) == ["targets"]
    assert differing(before, plane(lines=line[1:]), use_distance=True) == ["targets"]
    assert differing(before, plane(), use_distance=True) == ["targets"]
    tipped = turned_up(0.3)
    turned_line = line @ tipped[:3, :3].T
    assert differing(before, plane(tipped, lines=turned_line), use_distance=True) == []
    seen = {"use_distance": True, "distance_plan": True}
    assert differing(before, plane(tipped, lines=turned_line), **seen) == ["up"]
    turned = plane(turned_by(0.3, [0.0, 0.0, 0.0]))
    assert differing(plane(), turned, use_aspect=True) == ["north"]
    assert differing(plane(), turned, use_slope=True, use_noise=True) == []
    moved = plane(turned_by(0.3, [4.0, 5.0, 6.0]))
    assert differing(turned, moved, use_aspect=True, use_noise=True) == []
    shifted = SurfaceArrays("Plane", SQUARE, TWO, "same", turned_by(0.0, [0.5, 0.0, 0.0]))
    assert differing(plane(), shifted, use_noise=True) == ["noise"]
    assert differing(plane(), shifted) == []


def test_a_whole_scene_may_move():
    pose = turned_by(0.5, [10.0, 20.0, 30.0])
    line = winding()
    there = line @ pose[:3, :3].T + pose[:3, 3]
    assert differing(plane(lines=line), plane(pose, lines=there), use_distance=True) == []


@pytest.mark.parametrize("channels", [1, 2, 3, 4])
def test_channels_of_an_image(channels):
    pixels = RANDOM.uniform(0.1, 1.0, (3, 5, channels)).astype(np.float32)
    image = raw.RawImage("Any", pixels)
    color = pixels[:, :, :3] if channels >= 3 else np.repeat(pixels[:, :, :1], 3, axis=2)
    opacity = pixels[:, :, -1] if channels in (2, 4) else np.ones((3, 5))
    for k, name in enumerate(("RED", "GREEN", "BLUE")):
        np.testing.assert_allclose(raw.shade(image, name), color[:, :, k])
    np.testing.assert_allclose(raw.shade(image, "ALPHA"), opacity)
    expected = color.astype(float).mean(axis=2) * opacity
    np.testing.assert_allclose(raw.shade(image, "BRIGHTNESS"), expected)


def test_an_empty_channel_is_told():
    pixels = np.ones((2, 2, 4), dtype=np.float32)
    pixels[:, :, 1] = 0.0
    with pytest.raises(Exception, match="Image 'Any' is 0 in its channel Green everywhere"):
        raw.shade(raw.RawImage("Any", pixels), "GREEN")


def test_colors_of_one_term_are_of_its_own_scale():
    settings = Settings(count=300, density=DensitySettings(use_border=True, border_strength=0.5))
    shown = density_colors.computed(plane(), settings, "", True, None)
    assert shown.most == 1.0
    assert not shown.points
    everything = density_colors.computed(plane(), settings, "", False, None)
    assert everything.points * Ground(plane(), settings).surface.mass == pytest.approx(300)
    by_area = Settings(per_area=12.0, density=settings.density)
    assert density_colors.computed(plane(), by_area, "", False, None).points == 12.0
    steps, colors = density_colors.ramp()
    np.testing.assert_allclose(density_colors.colored(steps)[:, :3], colors[:, :3])
