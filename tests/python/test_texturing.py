# SPDX-License-Identifier: GPL-3.0-or-later
"""Decals: baked images, frames, turns. The geometry is tested in tests/native."""

import dapple3d as dapple
import numpy as np
import pytest
from dapple3d import texturing

RED, GREEN = (1.0, 0.0, 0.0, 1.0), (0.0, 1.0, 0.0, 1.0)


def flat(color, size=4):
    return np.full((size, size, 4), color)


@pytest.fixture(scope="module")
def square():
    """The unit square, and texture coordinates that are x and y."""
    surface = dapple.Plane(1.0, 1.0).surface
    return surface, surface.vertices[surface.faces][:, :, :2]


def bound(surface, points, **more):
    near = dapple.project(surface, np.array(points))
    return dapple.Samples(surface, near.faces, near.barycentric, **more)


def test_bakes_each_class_where_its_samples_are(square):
    surface, uv = square
    samples = bound(surface, [(0.25, 0.25, 0), (0.75, 0.5, 0)], classes=[0, 1])
    decals = [texturing.Decal(flat(RED), 0.125), texturing.Decal(flat(GREEN), 0.25)]
    image = texturing.bake(surface, uv, samples, decals, 64, 64, angles=[0, 0])
    expected = np.zeros((64, 64, 4))
    expected[8:24, 8:24] = RED
    expected[16:48, 32:64] = GREEN
    np.testing.assert_allclose(image, expected, atol=1e-12)


def test_an_image_lies_in_the_frame(square):
    surface, uv = square
    samples = bound(surface, [(0.5, 0.5, 0)])
    picture = np.zeros((2, 2, 4))
    picture[..., 3] = 1
    picture[0, 1] = RED  # right, below
    for angle in (0.0, 0.5 * np.pi, np.pi):
        image = texturing.bake(
            surface, uv, samples, [texturing.Decal(picture, 0.5)], 64, 64, angles=[angle]
        )
        frame = texturing.frames(samples, [angle])[0]
        x, y = (32 + 24 * (frame[:, 0] - frame[:, 1]))[:2].astype(int)
        assert image[y, x, 0] > 0.9
        assert image[63 - y, 63 - x, 0] < 0.1


def test_edges_are_soft_and_the_background_shows(square):
    surface, uv = square
    samples = bound(surface, [(0.5, 0.5, 0)])
    half = flat((1.0, 0.0, 0.0, 0.5))
    image = texturing.bake(
        *(surface, uv, samples, [texturing.Decal(half, 0.2)], 33, 33),
        angles=[0.3],
        background=(0, 0, 1, 1),
        oversampling=4,
    )
    np.testing.assert_allclose(image[16, 16], (0.5, 0, 0.5, 1), atol=1e-12)
    np.testing.assert_allclose(image[0, 0], (0, 0, 1, 1), atol=1e-12)
    reds = np.unique(image[..., 0].round(6))
    assert len(reds) > 4


def test_fine_detail_does_not_alias(square):
    surface, uv = square
    board = np.indices((512, 512)).sum(axis=0) % 2
    picture = np.dstack([board, board, board, np.ones_like(board)]).astype(float)
    image = texturing.bake(
        *(surface, uv, bound(surface, [(0.5, 0.5, 0)]), [texturing.Decal(picture, 0.5)], 32, 32),
        angles=[0.0],
    )
    np.testing.assert_allclose(image[..., :3], 0.5, atol=1e-9)


def test_frames_are_rotations_about_the_normal(samples):
    frames = texturing.frames(samples)
    np.testing.assert_allclose(
        frames.transpose(0, 2, 1) @ frames, np.tile(np.eye(3), (len(samples), 1, 1)), atol=1e-12
    )
    np.testing.assert_allclose(np.linalg.det(frames), 1)
    np.testing.assert_allclose(frames[:, :, 2], samples.normals)


def test_turns_depend_on_the_id_alone():
    ids = np.arange(2000)
    angles = texturing.turns(ids)
    np.testing.assert_array_equal(texturing.turns(ids[::-1])[::-1], angles)
    np.testing.assert_array_equal(texturing.turns([1234]), angles[1234:1235])
    assert not np.allclose(texturing.turns(ids, seed=1), angles)
    assert angles.min() >= 0
    assert angles.max() < 2 * np.pi
    counts = np.histogram(angles, 10, (0, 2 * np.pi))[0]
    assert abs(counts - 200).max() < 60
    assert abs(np.exp(1j * np.diff(angles)).mean()) < 0.1


@pytest.mark.parametrize(
    ("image", "radius", "message"),
    [
        (np.zeros((4, 4, 3)), 1.0, r"image has the shape \(4, 4, 3\)"),
        (np.full((4, 4, 4), 2.0), 1.0, "outside 0..1"),
        (np.full((4, 4, 4), np.nan), 1.0, "outside 0..1"),
        (np.zeros((4, 4, 4)), 0.0, "radius is 0.0"),
    ],
)
def test_refuses_decals(image, radius, message):
    with pytest.raises(ValueError, match=message):
        texturing.Decal(image, radius)


def test_refuses_a_class_without_a_decal(square):
    surface, uv = square
    samples = bound(surface, [(0.5, 0.5, 0), (0.2, 0.2, 0)], classes=[0, 3])
    with pytest.raises(ValueError, match="sample 1 is of class 3: decals has 1"):
        texturing.bake(surface, uv, samples, [texturing.Decal(flat(RED), 0.1)], 8, 8)


def test_refuses_texture_coordinates(square):
    surface, uv = square
    samples = bound(surface, [(0.5, 0.5, 0)])
    with pytest.raises(ValueError, match="uv has the shape"):
        texturing.bake(surface, uv[0], samples, [texturing.Decal(flat(RED), 0.1)], 8, 8)
