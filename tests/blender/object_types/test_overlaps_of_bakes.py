# SPDX-License-Identifier: GPL-3.0-or-later
"""The largest overlaps that a bake reports: of each object type, and between keyframes."""

import addon_host
import bpy
import numpy as np
import pytest
import scenes
from test_object_types import classes_of
from test_panels import drawn

FRAMES = 9
RADII = (0.3, 0.12, 0.0)


def mixed(every=1, sizes=(), **settings):
    """A baked scatter of three types on a body that bends, and has these sizes at some frames."""
    surface = scenes.tail(frames=FRAMES)
    for frame, size in sizes:
        surface.scale = (size, size, size)
        surface.keyframe_insert("scale", frame=frame)
    bpy.context.scene.frame_set(1)
    obj = scenes.scattered(surface, count=60)
    for radius in RADII:
        assert bpy.ops.dapple.edit_object_types(action="ADD") == {"FINISHED"}
        obj.dapple.object_types[-1].radius = radius
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    obj.dapple.keyframe_step = every
    for name, value in settings.items():
        setattr(obj.dapple, name, value)
    assert bpy.ops.dapple.bake() == {"FINISHED"}
    return obj


def overlaps_from(text):
    return addon_host.part("core.bake.overlaps").overlaps_from(text)


def measured(points, kinds):
    """Largest overlap of a disc of each type."""
    radii = np.array(RADII)[kinds]
    together = radii[:, None] + radii[None]
    apart = np.linalg.norm(points[:, None] - points[None], axis=2)
    np.fill_diagonal(apart, np.inf)
    shares = np.where(together > 0.0, 1.0 - apart / np.maximum(together, 1e-9), 0.0).max(axis=1)
    return [max(float(shares[kinds == kind].max()), 0.0) for kind in range(len(RADII))]


def played(obj):
    kinds = classes_of(obj)
    for frame in range(1, FRAMES + 1):
        bpy.context.scene.frame_set(frame)
        yield measured(scenes.positions(obj), kinds)


@pytest.mark.parametrize("every", [1, 4])
def test_each_type_has_its_largest_overlap_as_played(every):
    obj = mixed(every)
    found = np.array(list(played(obj)))
    report, overlaps = obj.dapple.report, overlaps_from(obj.dapple.report.type_overlaps)
    assert report.worst_overlap == pytest.approx(found.max(), abs=1e-4)
    assert [one.share for one in overlaps] == pytest.approx(found.max(axis=0), abs=1e-4)
    frames = [one.frame for one in overlaps if one.share > 1e-3]
    worst = found.argmax(axis=0) + 1
    assert frames == [frame for frame, one in zip(worst, overlaps, strict=True) if one.share > 1e-3]
    assert report.overlap_between == ((report.overlap_frame - 1) % every != 0)


def test_points_that_appear_or_vanish_do_not_count():
    """What vanishes gives way: others may stand where it becomes smaller."""
    obj = mixed(population="KEEP_DENSITY", sizes=((1, 1.0), (4, 1.3), (FRAMES, 1.0)))
    scales = []
    for frame in range(1, FRAMES + 1):
        bpy.context.scene.frame_set(frame)
        lengths = np.linalg.norm(scenes.instance_matrices(obj)[:, :3, 0], axis=1)
        scales.append(lengths.min() / lengths.max())
    assert min(scales) < 0.9, "some fade"
    assert obj.dapple.report.worst_overlap < 0.05


def test_overlaps_between_keyframes_are_said():
    obj = mixed(every=4)
    report = obj.dapple.report
    assert report.overlap_between
    text = " ".join(drawn())
    assert f"Max overlap {100 * report.worst_overlap:.0f} % in frame {report.overlap_frame}" in text
    assert "That is between keyframes: reduce Keyframe Step" in text
    assert bpy.ops.dapple.select_overlap() == {"FINISHED"}
    assert bpy.context.scene.frame_current == report.overlap_frame
    pair = scenes.positions(obj)[[vertex.index for vertex in obj.data.vertices if vertex.select]]
    kinds = classes_of(obj)
    chosen = kinds[[vertex.index for vertex in obj.data.vertices if vertex.select]]
    together = np.array(RADII)[chosen].sum()
    apart = np.linalg.norm(pair[0] - pair[1])
    assert 1.0 - apart / together == pytest.approx(report.worst_overlap, abs=1e-4)


def test_the_panel_tells_the_overlap_of_the_active_type():
    obj = mixed(every=4)
    overlaps = overlaps_from(obj.dapple.report.type_overlaps)
    for index, own in enumerate(overlaps):
        obj.dapple.object_type_index = index
        line = f"Of this type {100 * own.share:.0f} % in frame {own.frame}"
        assert (line if own.share >= 0.005 else "Of this type no overlap") in drawn()
    assert bpy.ops.dapple.optimize() == {"FINISHED"}
    assert not any("Of this type" in text for text in drawn())


def test_texts_that_are_no_overlaps_tell_nothing():
    for text in ("", "{}", "[[1]]", '[["a", 1, true]]', "[[1e400, 1, true]]", "[" * 100_000):
        assert overlaps_from(text) == []


def test_pairs_are_found_as_by_comparing_all():
    random = np.random.default_rng(3)
    points, kinds = random.random((300, 3)), random.integers(0, 3, 300).astype(np.int32)
    radii = np.array([0.06, 0.02, 0.0])[kinds]
    ids = np.arange(300, dtype=np.int32)
    make = addon_host.part("core.bake.overlaps").Discs
    discs = make(points, np.tile([0.0, 0.0, 1.0], (300, 1)), radii, kinds, ids)
    shares, rows = discs.worst(3)
    together = radii[:, None] + radii[None]
    apart = np.linalg.norm(points[:, None] - points[None], axis=2)
    np.fill_diagonal(apart, np.inf)
    each = np.where(together > 0.0, 1.0 - apart / np.maximum(together, 1e-9), 0.0).max(axis=1)
    assert shares == pytest.approx([each[kinds == kind].max() for kind in range(3)])
    for share, (one, other) in zip(shares, rows, strict=True):
        assert 1.0 - apart[one, other] / together[one, other] == pytest.approx(share)
