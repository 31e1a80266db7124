# SPDX-License-Identifier: GPL-3.0-or-later
"""Masks of a density against other computations of the same, also within large faces."""

import math
from dataclasses import replace

import dapple3d as dapple
import numpy as np
import pytest
from dapple3d.density import noise
from mask_checks import CUBE, CUBE_FACES, SQUARE, TWO, by_hand, falls, winding

from addon.core.density import colors as density_colors
from addon.core.density.masked_surface import masked_surface_of
from addon.core.density.terms import fields_of, range_of
from addon.core.settings.density_table import DENSITY
from addon.core.settings.values import DensitySettings, Settings
from addon.core.solve import stale
from addon.core.surface import mesh_snapshot, sources
from addon.core.surface.arrays import SurfaceArrays, Surroundings

RANDOM = np.random.default_rng(7)


def plane(matrix=None, **around) -> SurfaceArrays:
    """One square of two triangles: whatever varies, varies within its faces."""
    matrix = np.eye(4) if matrix is None else matrix
    vertices = SQUARE @ matrix[:3, :3].T + matrix[:3, 3]
    return SurfaceArrays("Plane", vertices, TWO, "same", matrix, around=Surroundings(**around))


def density_at(surface: SurfaceArrays, points, count=4000, **density) -> np.ndarray:
    """What the masked has at places of the square."""
    masked = masked_surface_of(surface, Settings(count=count, density=DensitySettings(**density)))
    closest = dapple.project(masked.surface, np.ascontiguousarray(points))
    corners = masked.corner_density()[closest.faces]
    return np.einsum("nk,nk->n", corners, closest.barycentric)


def somewhere(count=500) -> np.ndarray:
    return np.column_stack([RANDOM.uniform(-1.99, 1.99, (count, 2)), np.zeros(count)])


def test_a_mask_without_strength_is_none():
    for name in ("slope", "height", "distance", "border", "aspect", "noise"):
        on = DensitySettings(**{f"use_{name}": True})
        assert range_of(on, name) is not None
        off = DensitySettings(**{f"use_{name}": True, f"{name}_strength": 0.0})
        assert range_of(off, name) is None


def test_slope_and_height_can_be_inverted_and_weak():
    points = somewhere()
    tipped = turned_up(0.8)
    there = points @ tipped[:3, :3].T
    range_of = {"height_min": -0.5, "height_max": 0.5, "height_falloff": 0.3}
    weak = {"height_invert": True, "height_strength": 0.6}
    found = density_at(plane(tipped), there, use_height=True, **range_of, **weak)
    expected = [falls(z, -0.5, 0.5, 0.3, True, 0.6) for z in there[:, 2]]
    assert np.abs(found - expected).mean() < 0.01
    for angle in (0.1, 0.5, 0.8, 1.2):
        found = density_at(
            plane(turned_up(angle)), points[:1], use_slope=True, slope_invert=True,
            slope_strength=0.7, slope_max=0.4, slope_falloff=0.5,
        )  # fmt: skip
        assert found == pytest.approx(falls(angle, 0.0, 0.4, 0.5, True, 0.7))


def turned_up(angle: float) -> np.ndarray:
    found = np.eye(4)
    found[1:3, 1:3] = [[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]]
    return found


def test_the_distance_counts_within_large_faces():
    points = somewhere()
    range_of = {"distance_min": 0.1, "distance_max": 0.4, "distance_falloff": 0.3}
    found = density_at(plane(lines=winding()), points, use_distance=True, **range_of)
    expected = [falls(one, 0.1, 0.4, 0.3) for one in by_hand(points, winding())]
    assert np.abs(found - expected).mean() < 0.01
    assert np.abs(found - expected).max() < 0.2


def test_a_sharp_distance_is_followed_to_a_share_of_the_spacing():
    points, count = somewhere(2000), 4000
    found = density_at(
        plane(lines=winding()), points, count, use_distance=True, distance_falloff=0.0
    )
    distance = by_hand(points, winding())
    spacing = math.sqrt(16.0 / count)
    clear = np.abs(distance - 0.5) > 0.5 * spacing
    np.testing.assert_array_equal(found[clear], distance[clear] <= 0.5)


def test_the_border_counts_within_large_faces():
    points = somewhere()
    found = density_at(plane(), points, use_border=True, border_max=0.3, border_falloff=0.4)
    expected = [falls(one, 0.0, 0.3, 0.4) for one in 2.0 - np.abs(points[:, :2]).max(axis=1)]
    assert np.abs(found - expected).mean() < 0.01


def test_a_closed_surface_has_no_border_and_the_mask_no_effect():
    surface = SurfaceArrays("Cube", CUBE, CUBE_FACES, "same")
    settings = DensitySettings(use_border=True, border_invert=True)
    assert fields_of(surface, settings) == []
    assert not masked_surface_of(surface, Settings(density=settings)).is_cut


def test_a_distance_to_nothing_has_no_effect():
    assert fields_of(plane(), DensitySettings(use_distance=True)) == []


def test_a_sharp_height_ends_at_the_edge_of_a_floor():
    cube = SurfaceArrays("Cube", CUBE, CUBE_FACES, "same")
    settings = DensitySettings(use_height=True, height_min=1.0, height_max=2.0, height_falloff=0.0)
    masked = masked_surface_of(cube, Settings(count=300, density=settings))
    top = (masked.surface.vertices[masked.surface.faces][:, :, 2] == 1.0).all(axis=1)
    np.testing.assert_array_equal(masked.corner_density(), np.repeat(top[:, None], 3, axis=1))
    assert masked.surface.capacity == pytest.approx(4.0)


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


def test_aspect_and_other_terms_are_multiplied():
    weights = {"Grass": np.array([0.2, 0.4, 0.6, 0.8, 1.0, 1.0])}
    surface = roof(0.6)
    surface = replace(surface, weights=weights)
    density = DensitySettings(use_aspect=True, attribute="Grass", aspect_strength=0.5)
    masked = masked_surface_of(surface, Settings(density=density))
    own = weights["Grass"][surface.faces]
    np.testing.assert_allclose(masked.own_density, own * [[0.5], [0.5], [1.0], [1.0]], atol=1e-12)
    assert masked.own_density.shape == masked.corner_density().shape == (4, 3)


def test_aspect_holds_within_faces_that_others_cut():
    density = {"use_aspect": True, "use_height": True, "height_max": 5.0, "height_min": -0.4}
    masked = masked_surface_of(roof(0.6), Settings(count=2000, density=DensitySettings(**density)))
    assert masked.is_cut
    corners = masked.surface.vertices[masked.surface.faces]
    north = corners[:, :, 1].mean(axis=1) > 0.0
    expected = [[falls(z, -0.4, 5.0, 0.1) for z in one] for one in corners[north][:, :, 2]]
    np.testing.assert_allclose(masked.corner_density()[north], expected, atol=1e-9)
    assert not masked.corner_density()[~north].any()


def turned_by(angle: float, shift) -> np.ndarray:
    found = np.eye(4)
    found[:2, :2] = [[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]]
    found[:3, 3] = shift
    return found


def test_noise_counts_within_large_faces_and_goes_with_the_surface():
    points, pose = somewhere(), turned_by(0.7, [5.0, -3.0, 2.0])
    density = {"use_noise": True, "noise_size": 0.8, "noise_falloff": 0.2, "noise_seed": 3}
    found = density_at(plane(), points, **density)
    expected = [falls(one, 0.5, 1.0, 0.2) for one in noise(points / 0.8, 2, 3)]
    assert np.abs(found - expected).mean() < 0.03
    there = points @ pose[:3, :3].T + pose[:3, 3]
    again = density_at(plane(pose), there, **density)
    assert np.abs(found - again).mean() < 0.01


def test_size_of_noise_is_that_of_the_world():
    """An object that was scaled has patches of the same size."""
    scaled = plane(np.diag([2.0, 2.0, 2.0, 1.0]))
    (field,) = fields_of(scaled, DensitySettings(use_noise=True, noise_size=0.5))
    points = somewhere()
    np.testing.assert_allclose(field.at(points), noise(points / 0.5, 2, 0), atol=1e-9)


def test_a_term_alone_has_its_settings_and_no_other():
    full = DensitySettings(
        attribute="Grass", use_slope=True, slope_max=0.3, use_noise=True, noise_seed=4
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
    seen = {"use_distance": True, "ignore_height": True}
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
    image = mesh_snapshot.RawImage("Any", pixels)
    color = pixels[:, :, :3] if channels >= 3 else np.repeat(pixels[:, :, :1], 3, axis=2)
    opacity = pixels[:, :, -1] if channels in (2, 4) else np.ones((3, 5))
    for k, name in enumerate(("RED", "GREEN", "BLUE")):
        np.testing.assert_allclose(mesh_snapshot.shade(image, name), color[:, :, k])
    np.testing.assert_allclose(mesh_snapshot.shade(image, "ALPHA"), opacity)
    expected = color.astype(float).mean(axis=2) * opacity
    np.testing.assert_allclose(mesh_snapshot.shade(image, "BRIGHTNESS"), expected)


def test_an_empty_channel_is_reported():
    pixels = np.ones((2, 2, 4), dtype=np.float32)
    pixels[:, :, 1] = 0.0
    with pytest.raises(Exception, match="Image 'Any' is 0 in its channel Green everywhere"):
        mesh_snapshot.shade(mesh_snapshot.RawImage("Any", pixels), "GREEN")


def test_colors_of_one_term_are_of_its_own_scale():
    settings = Settings(count=300, density=DensitySettings(use_border=True, border_strength=0.5))
    shown = density_colors.computed(plane(), settings, "", True, None)
    assert shown.most == 1.0
    assert not shown.points
    everything = density_colors.computed(plane(), settings, "", False, None)
    assert everything.points * masked_surface_of(
        plane(), settings
    ).surface.capacity == pytest.approx(300)
    by_area = Settings(per_area=12.0, density=settings.density)
    assert density_colors.computed(plane(), by_area, "", False, None).points == 12.0
    steps, colors = density_colors.ramp()
    np.testing.assert_allclose(density_colors.colored(steps)[:, :3], colors[:, :3])
