# SPDX-License-Identifier: GPL-3.0-or-later
"""How a mesh as it was read is cut into triangles."""

import numpy as np
import pytest

from addon.core.surface import mesh_snapshot


def mesh_of(positions, polygons):
    starts = np.cumsum([0, *map(len, polygons)])[:-1]
    corners = np.concatenate(polygons)
    singles = np.asarray(positions, dtype=np.float32)
    return mesh_snapshot.RawMesh("Mesh", singles, corners.astype(np.int32), starts.astype(np.int32))


def places(mesh, triangles):
    """The triangles of a mesh as sets of places."""
    return [
        frozenset(map(tuple, mesh.positions[mesh.corners[triangle]].tolist()))
        for triangle in triangles
    ]


SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]


@pytest.mark.parametrize("own", [False, True])
@pytest.mark.parametrize("second", [(3, 2, 1, 0), (2, 1, 0, 3), (1, 2, 3, 0), (0, 1, 2, 3)])
def test_quads_on_each_other_are_cut_alike(own, second):
    """Both sides of a quad were cut along different lines, and counted twice."""
    far = [(5, 0, 0), (6, 0, 0), (6, 1, 0), (5, 1, 0)]
    positions = SQUARE + far + (SQUARE if own else [])
    polygons = [(0, 1, 2, 3), (4, 5, 6, 7), tuple(v + 8 * own for v in second)]
    mesh = mesh_of(positions, polygons)
    found = mesh_snapshot.triangle_corners(mesh)
    assert set(places(mesh, found[:2])) == set(places(mesh, found[4:]))
    np.testing.assert_array_equal(found[2:4], [[4, 5, 6], [4, 6, 7]])
    normals = [
        np.cross(p[1] - p[0], p[2] - p[0])[2]
        for p in mesh.positions[mesh.corners[found]].astype(float)
    ]
    turned = second in ((3, 2, 1, 0), (2, 1, 0, 3))
    np.testing.assert_array_equal(np.sign(normals), [1, 1, 1, 1, *([-1, -1] if turned else [1, 1])])


def test_quads_of_other_corners_are_cut_as_blender_does():
    mesh = mesh_of([*SQUARE, (0, 0, 1), (1, 0, 1)], [(0, 1, 2, 3), (1, 0, 4, 5), (3, 2, 5, 4)])
    expected = [(0, 1, 2), (0, 2, 3), (4, 5, 6), (4, 6, 7), (8, 9, 10), (8, 10, 11)]
    np.testing.assert_array_equal(mesh_snapshot.triangle_corners(mesh), expected)


def test_polygons_on_each_other_are_cut_alike():
    angles = np.arange(6) * np.pi / 3
    positions = np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])
    around = np.arange(6)
    mesh = mesh_of(positions, [around, around[::-1]])
    cut = [
        (0, 1, 2),
        (0, 2, 3),
        (0, 3, 4),
        (0, 4, 5),
        (6, 7, 8),
        (6, 8, 9),
        (6, 9, 10),
        (6, 10, 11),
    ]
    mesh = mesh_snapshot.RawMesh(
        "Mesh", mesh.positions, mesh.corners, mesh.starts, np.array(cut, np.int32)
    )
    found = mesh_snapshot.triangle_corners(mesh)
    np.testing.assert_array_equal(found[:4], cut[:4])
    assert set(places(mesh, found[:4])) == set(places(mesh, found[4:]))


def test_all_sides_of_a_cube_are_cut_alike_twice():
    corners = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
    sides = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    mesh = mesh_of(corners, sides + [side[::-1] for side in sides])
    found = places(mesh, mesh_snapshot.triangle_corners(mesh))
    assert len(set(found)) == 12
