# SPDX-License-Identifier: GPL-3.0-or-later
"""Keys in numpy alone: packing, every so many frames, the error between, changes of topology."""

import tracemalloc
from dataclasses import replace

import addon_host
import numpy as np
import pytest

FACES = np.array([(0, 1, 2), (2, 1, 3), (2, 3, 4), (4, 3, 5)], dtype=np.int32)


@pytest.fixture
def keys():
    return addon_host.part("core.bake.keys")


def strip(topology="strip", name="Strip", faces=FACES):
    surface = addon_host.part("core.surface.arrays")
    vertices = np.array([(k // 2, k % 2, 0.0) for k in range(6)])
    return surface.SurfaceArrays(name, vertices, faces, topology)


def placed(keys, arrays, faces, weights, angle=0.0):
    records = addon_host.part("core.surface.records")
    faces = np.asarray(faces, dtype=np.int32)
    weights = np.broadcast_to(np.asarray(weights, dtype=float), (len(faces), 3))
    angles = np.full(len(faces), angle)
    return keys.Placed(faces, records.Binding(arrays.faces[faces], weights, angles))


def collected(keys, frames, every=1, vertices=None):
    arrays = strip()
    found = keys.Keyframes(len(frames), every)
    for index, item in enumerate(frames):
        moved = arrays.vertices if vertices is None else vertices[index]
        found.add(item, arrays, replace(arrays, vertices=moved), 0.5)
    return found


def walk(keys, count):
    """A point that goes along the first edge of one triangle, another that changes faces."""
    arrays, frames = strip(), []
    for k in range(count):
        share = k / max(count - 1, 1)
        binding = placed(keys, arrays, [3, k % 3], (0.9 - share / 2, share / 2, 0.1), 0.1 * k)
        frames.append(binding)
    return frames


def test_packing_keeps_single_precision(keys):
    frames = walk(keys, 5)
    packed = collected(keys, frames).packed()
    for frame, item in enumerate(frames):
        first, second, share = packed.binding(frame, 2)
        assert share == 0.0
        assert (first.corners == item.binding.corners).all()
        assert np.allclose(first.barycentric, item.binding.barycentric, rtol=0, atol=2e-7)
        assert np.allclose(first.angle, item.binding.angle, rtol=0, atol=1e-6)
        assert (second.corners == frames[min(frame + 1, 4)].binding.corners).all()


def test_a_row_takes_sixteen_bytes_and_unused_triangles_none(keys):
    arrays = strip()
    packed = collected(keys, [placed(keys, arrays, [3, 1], (0.2, 0.3, 0.5))] * 3).packed()
    assert packed.keys["dapple_face"].nbytes + packed.keys["position"].nbytes == 16 * 3 * 2
    assert [packed.triangles[f"dapple_v{k}"].tolist() for k in range(3)] == [[2, 4], [1, 3], [3, 5]]


@pytest.mark.parametrize(
    ("count", "every", "at"),
    [(7, 3, [0, 3, 6]), (8, 3, [0, 3, 6, 7]), (2, 5, [0, 1]), (1, 4, [0]), (4, 1, [0, 1, 2, 3])],
)
def test_every_so_many_frames_and_the_last_are_keys(keys, count, every, at):
    packed = collected(keys, walk(keys, count), every).packed()
    table = packed.frames
    found = [k for k in range(count) if table["dapple_since"][k] == 0]
    assert found == at
    for frame in range(count):
        key = max(k for k, begin in enumerate(at) if begin <= frame)
        following = at[key + 1] if key + 1 < len(at) else at[key]
        assert table["dapple_key"][frame] == key
        assert table["dapple_since"][frame] == frame - at[key]
        assert table["dapple_span"][frame] == following - at[key]


def test_the_distance_between_keys_is_that_of_the_mixed_points(keys):
    arrays = strip()
    frames = [
        placed(keys, arrays, [0], weights)
        for weights in ((1, 0, 0), (0.5, 0, 0.5), (0.5, 0.5, 0), (0, 1, 0))
    ]
    error = collected(keys, frames, every=3).error
    # Vertices 0, 1 and 2 are at (0, 0), (0, 1) and (1, 0). Values at y = 1/3 and 2/3 are
    # interpolated, those at (1/2, 0) and (0, 1/2) are solved; the spacing is 1/2.
    first, second = 2 * np.hypot(1 / 2, 1 / 3), 2 * (2 / 3 - 1 / 2)
    assert error.largest == pytest.approx(first)
    assert error.mean == pytest.approx((first + second) / 2)
    assert collected(keys, frames).error.largest == 0.0


def test_keys_are_not_mixed_across_a_change_of_topology(keys):
    before = strip("before")
    after = strip("after", faces=FACES[::-1].copy())
    found = keys.Keyframes(6, 3)
    for frame in range(6):
        arrays = before if frame < 3 else after
        found.add(placed(keys, arrays, [0], (0.2, 0.3, 0.5)), arrays, arrays, 1.0)
    table = found.packed().frames
    # 0 and 3 are first frames of the intervals between changes, 2 and 5 are last frames.
    assert table["dapple_key"].tolist() == [0, 0, 1, 2, 2, 3]
    assert table["dapple_span"].tolist() == [2, 2, 0, 2, 2, 0]
    corners = [found.packed().binding(frame, 1)[0].corners[0].tolist() for frame in (2, 3)]
    assert corners == [[0, 1, 2], [4, 3, 5]]


def test_points_that_appear_after_a_change_of_topology_have_rows_before_it(keys):
    before = strip("before", faces=FACES[:2])
    after = strip("after", faces=FACES[::-1].copy())
    found = keys.Keyframes(4)
    for frame, (arrays, faces) in enumerate(
        [(before, [1]), (before, [1, 0]), (after, [2, 0, 3]), (after, [2, 0, 3, 1])]
    ):
        item = placed(keys, arrays, faces, (0.2, 0.3, 0.5), 0.1 * frame)
        found.add(replace(item, faded=np.zeros(len(faces))), arrays, arrays, 1.0)
    packed = found.packed()
    gone = packed.keys["dapple_faded"].reshape(4, 4)
    assert gone.tolist() == [[0, 1, 1, 1], [0, 0, 1, 1], [0, 0, 0, 1], [0, 0, 0, 0]]
    first, second, _, fourth = (packed.binding(k, 4)[0] for k in range(4))
    assert first.corners.tolist() == FACES[[1, 0, 1, 1]].tolist()
    assert second.corners.tolist() == FACES[[1, 0, 1, 1]].tolist()
    assert fourth.corners.tolist() == FACES[::-1][[2, 0, 3, 1]].tolist()
    faces, table = packed.keys["dapple_face"], packed.frames
    assert keys.wrong_index(faces, packed.triangles, table, 4) == ""


def test_the_rows_of_a_bake_are_held_once(keys):
    arrays, count = strip(), 20_000
    found = keys.Keyframes(4)
    tracemalloc.start()
    try:
        for _ in range(4):
            item = placed(keys, arrays, [0, 3] * (count // 2), (0.2, 0.3, 0.5))
            lean = np.full((count, 3), 0.5)
            found.add(replace(item, faded=np.zeros(count), tilt=lean), arrays, arrays, 1.0)
        found.last = None
        del item, lean
        packed = found.packed()
        held, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    stored = sum(values.nbytes for values in packed.keys.values())
    assert stored == 4 * count * 32
    assert held < 1.2 * stored
    assert (packed.keys["dapple_tilt"] == 0.5).all()
    assert found.packed() is packed
