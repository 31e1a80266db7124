# SPDX-License-Identifier: GPL-3.0-or-later
"""A rigged, textured body that is remeshed plays its action as before."""

import bpy
import dapple3d as dapple
import numpy as np
import pytest
import scenes

FRAMES = range(1, 7)


def textured_tail():
    """A tube that two bones bend; its texture runs around it and up, with a seam."""
    obj = scenes.tail(levels=0, render_levels=0)
    finer = obj.modifiers.new("Finer", "SUBSURF")
    finer.subdivision_type, finer.levels = "SIMPLE", 1
    bpy.ops.object.modifier_move_to_index(modifier="Finer", index=0)
    bpy.ops.object.modifier_apply(modifier="Finer")
    mesh = obj.data
    layer = mesh.uv_layers.new(name="UVMap").uv
    for polygon in mesh.polygons:
        places = [mesh.vertices[k].co for k in polygon.vertices]
        turns = np.array([np.arctan2(p.y, p.x) / (2 * np.pi) for p in places])
        cap = abs(polygon.normal.z) > 0.9
        if np.ptp(turns) > 0.5:
            turns[turns < 0] += 1
        for corner, turn, place in zip(polygon.loop_indices, turns, places, strict=True):
            layer[corner].vector = (place.x + 5, place.y + 5) if cap else (turn, place.z / 4)
    return obj


def farthest(first, second):
    """Distance of the vertices and middles of one mesh from another."""
    points = np.concatenate([first[0], first[0][first[1]].mean(axis=1)])
    return dapple.project(dapple.Surface(*second), points).distances.max()


LIMIT = 0.02  # of the height


@pytest.mark.parametrize(("share", "max_distance"), [(0.5, 0.06), (2.0, 0.0)])
def test_its_surface_and_texture_stay_in_place_through_the_action(share, max_distance):
    old = textured_tail()
    new = old.copy()
    new.data = old.data.copy()
    bpy.context.scene.collection.objects.link(new)
    scenes.activate(new)
    triangles = len(scenes.shown(old)[1])
    given = {"count": round(share * triangles / 2), "max_distance": max_distance}
    assert bpy.ops.dapple.remesh(**given) == {"FINISHED"}
    assert len(new.data.polygons) == pytest.approx(share * triangles, rel=0.2)
    for frame in FRAMES:
        bpy.context.scene.frame_set(frame)
        before, after = scenes.shown(old), scenes.shown(new)
        height = np.ptp(before[0], axis=0).max()
        assert farthest(after, before) < LIMIT * height
        assert farthest(before, after) < LIMIT * height
    assert [group.name for group in new.vertex_groups] == ["root", "tip"]
    for vertex in new.data.vertices:
        assert sum(one.weight for one in vertex.groups) == pytest.approx(1.0, abs=1e-5)
    check_texture(new.data)


def check_texture(mesh):
    """Each corner has the height that its texture coordinates tell."""
    layer, sides = mesh.uv_layers.active.uv, 0
    for polygon in mesh.polygons:
        for corner, vertex in zip(polygon.loop_indices, polygon.vertices, strict=True):
            place, (u, v) = mesh.vertices[vertex].co, layer[corner].vector
            if abs(polygon.normal.z) > 0.9:  # the caps
                assert (u - 5, v - 5) == pytest.approx((place.x, place.y), abs=1e-4)
                continue
            sides += 1
            assert 4 * v == pytest.approx(place.z, abs=1e-3)
            off = 2 * np.pi * u - np.arctan2(place.y, place.x)
            assert abs((off + np.pi) % (2 * np.pi) - np.pi) < 0.05
    assert sides > 100
