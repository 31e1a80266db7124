# SPDX-License-Identifier: GPL-3.0-or-later
import dapple3d as dapple
import numpy as np
import pytest
from checks import check_samples, same_bytes
from shapes import bent, grid, on_faces, torus


def slides(tracker: dapple.Tracker, before: dapple.Samples, after: dapple.Samples) -> np.ndarray:
    """Distances from the carried positions, in spacings."""
    now = tracker.surface
    carried = on_faces(now.vertices, now.faces, before.faces, before.barycentric)
    return np.linalg.norm(after.positions - carried, axis=1) / now.spacing(len(after))


def follow(tracker: dapple.Tracker, frames) -> dict[str, float]:
    """Play the frames; share of samples kept, and the largest slide."""
    kept = total = 0
    largest = 0.0
    ids = tracker.samples.ids.copy()
    for vertices in frames:
        before = tracker.samples
        after = tracker.advance(vertices)
        check_samples(tracker.surface, after)
        np.testing.assert_array_equal(after.ids, ids)
        moved = slides(tracker, before, after)
        assert after.report.slide_max == pytest.approx(moved.max(), abs=1e-12)
        assert after.report.slide_mean == pytest.approx(moved.mean(), abs=1e-12)
        kept += np.count_nonzero(moved < 0.5)
        total += len(moved)
        largest = max(largest, moved.max())
    return {"kept": kept / total, "slide_max": largest, "energy": after.report.energy}


def test_returns_the_same_bytes_for_no_motion(surface, samples):
    tracker = dapple.Tracker(surface, samples)
    for _ in range(3):
        after = tracker.advance(surface.vertices)
        assert same_bytes(after, samples)
        assert after.report.slide_max == 0


def test_keeps_barycentrics_under_rigid_motion(surface, samples):
    tracker = dapple.Tracker(surface, samples)
    turn, _ = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))
    after = tracker.advance(surface.vertices @ turn + [5, -3, 2])
    np.testing.assert_array_equal(after.faces, samples.faces)
    np.testing.assert_allclose(after.barycentric, samples.barycentric, atol=1e-12)
    np.testing.assert_allclose(after.positions, samples.positions @ turn + [5, -3, 2], atol=1e-12)


def test_keeps_every_sample_on_a_gentle_deformation(mesh, dense):
    tracker = dapple.Tracker(dense, dapple.sample(dense, 500))
    found = follow(tracker, (bent(mesh[0], 0.1 * frame) for frame in range(1, 16)))
    print(found)
    assert found["kept"] == 1


def test_keeps_ids_and_classes(mesh, surface, samples):
    ids = np.arange(len(samples), dtype=np.int32)[::-1] * 3
    classes = np.arange(len(samples), dtype=np.int32) % 4
    bound = dapple.Samples(surface, samples.faces, samples.barycentric, ids=ids, classes=classes)
    after = dapple.Tracker(surface, bound).advance(bent(mesh[0], 1.0))
    np.testing.assert_array_equal(after.ids, ids)
    np.testing.assert_array_equal(after.classes, classes)


def test_gives_the_same_bytes_for_any_threads(mesh, surface, samples):
    frames = [bent(mesh[0], 0.4 * frame) for frame in (1, 2, 3)]
    runs = []
    for threads in (1, 2, 8):
        tracker = dapple.Tracker(surface, samples, threads=threads)
        runs.append([tracker.advance(vertices) for vertices in frames])
    for run in runs[1:]:
        assert all(same_bytes(a, b) for a, b in zip(run, runs[0], strict=True))


def test_earlier_frames_stay_what_they_were(mesh, surface, samples):
    tracker = dapple.Tracker(surface, samples)
    first = tracker.advance(bent(mesh[0], 0.5))
    before = first.positions.copy()
    old_surface = tracker.surface
    tracker.advance(bent(mesh[0], 1.0))
    np.testing.assert_array_equal(first.positions, before)
    np.testing.assert_array_equal(old_surface.vertices, bent(mesh[0], 0.5))


def test_refuses_bad_frames_and_is_unchanged(mesh, surface, samples):
    tracker = dapple.Tracker(surface, samples)
    bad = mesh[0].copy()
    bad[12, 2] = np.nan
    for vertices, match in [
        (mesh[0][1:], f"vertices.*{len(mesh[0]) - 1}.*{len(mesh[0])}"),
        (bad, r"vertices\[12\].*nan"),
        (np.zeros_like(mesh[0]), "area"),
        (mesh[0][:, :2], "vertices"),
    ]:
        with pytest.raises(ValueError, match=match):
            tracker.advance(vertices)
        assert same_bytes(tracker.samples, samples)
        np.testing.assert_array_equal(tracker.surface.vertices, mesh[0])


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"capacity_weight": -1.0}, "capacity_weight"),
        ({"tolerance": np.nan}, "tolerance"),
        ({"max_evaluations": 0}, "max_evaluations"),
        ({"threads": -1}, "threads"),
    ],
)
def test_names_the_option_out_of_range(mesh, surface, samples, options, match):
    with pytest.raises(ValueError, match=match):
        dapple.Tracker(surface, samples, **options).advance(bent(mesh[0], 0.5))


def test_keeps_samples_on_the_elephant(data):
    folder = data / "meshes" / "anim_elephant"
    frames = np.load(folder / "frames.npz")
    surface = dapple.Surface(frames["frames"][0], frames["F"])
    tracker = dapple.Tracker(surface, dapple.sample(surface, 500))
    found = follow(tracker, frames["frames"][1:13])
    print(found)
    assert found["kept"] == 1


def test_tracks_more_samples_than_faces(data):
    frames = np.load(data / "meshes" / "anim_greenman" / "frames.npz")
    surface = dapple.Surface(frames["frames"][0], frames["F"])
    tracker = dapple.Tracker(surface, dapple.sample(surface, 2 * len(frames["F"])))
    found = follow(tracker, frames["frames"][1:8])
    print(found)
    assert found["kept"] > 0.99  # the limbs touch and separate, and cells bridge the gap


def test_discs_stay_apart_on_a_body_that_bends():
    surface = dapple.Surface(*torus(48, 24))
    area = surface.area
    radii = [np.sqrt(0.2 * area / np.pi / 60), np.sqrt(0.2 * area / np.pi / 240), 0.0]
    classes = [dapple.SampleClass(n, radius=r) for n, r in zip((60, 240, 300), radii, strict=True)]
    samples = dapple.sample_classes(surface, classes, seed=3)
    assert samples.report.worst_overlap <= 1e-3
    tracker = dapple.Tracker(surface, samples, classes=classes)
    for frame in range(1, 9):
        vertices = surface.vertices
        bend = 0.06 * frame * vertices[:, 0]
        bent = np.column_stack([vertices[:, 0], vertices[:, 1] * (1.0 + bend), vertices[:, 2]])
        assert tracker.advance(bent).report.worst_overlap <= 0.01


@pytest.mark.parametrize("count", [200, 400, 600, 800])
@pytest.mark.parametrize("seed", [0, 1, 2, 3])
def test_samples_keep_apart_while_the_density_moves(count, seed):
    """A window wanders over a square, by up to half a spacing a frame."""
    surface = dapple.Surface(*grid(60))
    centers = surface.vertices[surface.faces].mean(axis=1)

    def window(middle: float) -> dapple.Surface:
        away = np.abs(centers[:, :2] - [middle, 0.5]).max(axis=1)
        return surface.with_density((away < 0.25).astype(float), density_at="faces")

    first = dapple.sample(window(0.35), count, seed=seed)
    tracker = dapple.Tracker(window(0.35), first)
    for frame in range(1, 13):
        now = window(0.35 + 0.025 * frame)
        stands, began = (
            dapple.Samples(now, one.faces, one.barycentric, ids=first.ids)
            for one in (tracker.samples, first)
        )
        tracker.resume_on(now, now.vertices, stands, began)
        assert tracker.advance(now.vertices).report.alpha_min >= 0.5
        check_samples(now, tracker.samples)
