# SPDX-License-Identifier: GPL-3.0-or-later
"""UDIM tiles of the add-on, without Blender."""

import numpy as np

from addon.core import udim

TILES = [(1001, np.full((2, 3), 1.0)), (1012, np.full((4, 2), 2.0))]


def faces(*places):
    """Small triangles at these places."""
    corners = np.array([[0.0, 0.0], [0.01, 0.0], [0.0, 0.01]])
    return np.array(places, dtype=float)[:, None] + corners


def test_numbers_are_squares():
    np.testing.assert_array_equal(udim.squares(TILES), [[0, 0], [1, 1]])


def test_faces_over_the_border_of_a_tile_are_found():
    uv = faces([0.5, 0.5], [0.995, 0.5], [1.5, 0.5], [1.995, 1.5], [2.995, 2.5], [0.99, 0.0])
    np.testing.assert_array_equal(
        udim.crossing(uv, TILES), [False, True, False, True, False, False]
    )
    assert not udim.crossing(faces([1.0 - 1e-9, 0.5]), TILES).any()


def test_each_face_is_in_the_tile_of_its_center():
    uv = faces([0.5, 0.5], [1.2, 1.9], [1.2, 0.5], [-0.5, 0.5], [0.995, 0.5])
    picture, places = udim.laid_out(uv, TILES)
    rows, columns = picture.shape
    pixels = np.floor(places * (columns, rows)).astype(int)
    values = picture[pixels[..., 1], pixels[..., 0]]
    np.testing.assert_array_equal(values[:, 0], [1.0, 2.0, 0.0, 0.0, 1.0])


def test_nothing_of_a_neighbor_is_seen_at_a_border():
    """Between centers of pixels, of which those of the frame are the outermost."""
    tiles = [(1001, np.zeros((2, 2))), (1002, np.ones((2, 2)))]
    uv = np.array([[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]], [[1.0, 0.0], [2.0, 0.0], [2.0, 1.0]]])
    picture, places = udim.laid_out(uv, tiles)
    at = places * picture.shape[::-1] - 0.5
    low = np.floor(at).astype(int)
    for face, expected in ((0, 0.0), (1, 1.0)):
        for x, y in low[face]:
            np.testing.assert_array_equal(picture[y : y + 2, x : x + 2], expected)
