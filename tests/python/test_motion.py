# SPDX-License-Identifier: GPL-3.0-or-later
"""Going on from stored frames, frames solved together, and constant density per area."""

import dapple3d as dapple
import numpy as np
import pytest
from checks import check_samples, same_bytes
from shapes import bent, torus


def frames_of(mesh, count: int) -> list[np.ndarray]:
    return [bent(mesh[0], 0.2 * frame) for frame in range(1, count + 1)]


def stored(samples: dapple.Samples, surface: dapple.Surface) -> dapple.Samples:
    """As read back from a file."""
    return dapple.Samples(surface, samples.faces.copy(), samples.barycentric.copy())


def test_goes_on_with_the_same_bytes(mesh, surface, samples):
    frames = frames_of(mesh, 6)
    whole = dapple.Tracker(surface, samples)
    for vertices in frames[:3]:
        whole.advance(vertices)
    kept, settled = stored(whole.samples, whole.surface), whole.settled
    again = dapple.Tracker(surface, samples)
    again.resume(frames[2], kept, settled=settled)
    for vertices in frames[3:]:
        assert same_bytes(again.advance(vertices), whole.advance(vertices))


def test_refuses_to_go_on_from_another_number(surface, samples):
    tracker = dapple.Tracker(surface, samples)
    with pytest.raises(ValueError, match="samples"):
        tracker.resume(surface.vertices, dapple.sample(surface, len(samples) + 1))


def test_refuses_to_go_on_from_another_surface(mesh, surface, samples, tmp_path):
    """Also where its faces happen to have numbers that this surface has."""
    small = dapple.Surface(*torus(12, 8))
    large = dapple.Surface(*torus(90, 60))
    elsewhere = r"samples.positions\[0\] is .* away from .*: it belongs to another surface"
    outside = r"samples.faces\[\d+\] is \d+, outside the surface's faces"
    for other, said in ((small, elsewhere), (large, outside)):
        there = dapple.sample(other, len(samples))
        for kind in (dapple.Tracker, dapple.WindowTracker, dapple.Population):
            with pytest.raises(ValueError, match=said):
                kind(surface, there)
        tracker, window = dapple.Tracker(surface, samples), dapple.WindowTracker(surface, samples)
        with pytest.raises(ValueError, match=said):
            tracker.resume(mesh[0], there)
        with pytest.raises(ValueError, match=said):
            window.resume(mesh[0], there, [])
        population, begun = dapple.Population(surface, samples), dapple.Population(other, there)
        state = "state belongs to a frame with other faces"
        for frame, points in ((surface, samples), (surface, there)):
            with pytest.raises(ValueError, match=state):
                population.resume(frame, points, kept(begun, tmp_path / "other.npz")[1])
        with pytest.raises(ValueError, match=state):
            population.resume(other, there, population.state)
        with pytest.raises(ValueError, match=said):
            population.resume(surface, there, population.state)
        assert same_bytes(population.samples, samples)
        assert same_bytes(tracker.samples, samples)
    ahead = r"ahead\[1\].faces\[\d+\] is \d+, outside the surface's faces"
    with pytest.raises(ValueError, match=ahead):
        dapple.WindowTracker(surface, samples).resume(
            mesh[0], samples, [samples, dapple.sample(large, len(samples))]
        )


def test_says_into_how_many_parts_a_frame_was_split(mesh, surface, samples):
    far = mesh[0] * [1.3, 1, 1]
    assert dapple.Tracker(surface, samples, longest_motion=0).advance(far).report.parts == 1
    assert dapple.Tracker(surface, samples).advance(far).report.parts > 1
    assert dapple.Tracker(surface, samples).advance(3 * mesh[0] + 1).report.parts == 1


def test_stickiness_lessens_the_slide(mesh, surface, samples):
    slides = [
        dapple.Tracker(surface, samples, stickiness=stickiness, pattern_strength=0)
        .advance(bent(mesh[0], 0.5))
        .report.slide_mean
        for stickiness in (0, 50)
    ]
    assert slides[1] < slides[0]


def test_a_window_has_samples_for_every_frame(mesh, surface, samples):
    frames = frames_of(mesh, 5)
    found = dapple.track_window(surface, samples, frames, sweeps=1)
    assert len(found) == 6
    assert same_bytes(found[0], samples)
    for vertices, one in zip(frames, found[1:], strict=True):
        check_samples(surface.deformed(vertices), one)
        np.testing.assert_array_equal(one.ids, samples.ids)
        assert one.report.capacity_variation < 0.05


def test_a_window_is_cancelled(mesh, surface, samples):
    context = dapple.Context()
    context.cancel()
    with pytest.raises(dapple.Cancelled):
        dapple.track_window(surface, samples, frames_of(mesh, 3), context=context)


def test_a_short_motion_in_pieces_is_a_window(mesh, surface, samples):
    frames = frames_of(mesh, 6)
    whole = dapple.track_window(surface, samples, frames, sweeps=1)
    found = dapple.track_pieces(surface, samples, iter(frames), sweeps=1)
    for one, other in zip(found, whole[1:], strict=True):
        assert same_bytes(one, other)


def test_a_motion_in_pieces_reads_frames_as_it_needs_them(mesh, surface, samples):
    read = []

    def frames():
        for frame in range(1, 13):
            read.append(frame)
            yield bent(mesh[0], 0.1 * frame)

    found = dapple.track_pieces(surface, samples, frames(), piece=4, overlap=2)
    assert not read
    next(found)
    assert len(read) == 6
    places = [next(found) for _ in range(11)]
    assert next(found, None) is None
    for frame, one in zip(range(2, 13), places, strict=True):
        check_samples(surface.deformed(bent(mesh[0], 0.1 * frame)), one)
        np.testing.assert_array_equal(one.ids, samples.ids)
        assert one.report.capacity_variation < 0.05


def test_pieces_go_on_with_the_same_bytes(mesh, surface, samples):
    frames = frames_of(mesh, 8)
    whole = dapple.WindowTracker(surface, samples)
    first = whole.advance(frames[:5], 3)
    places = [stored(one, surface) for one in first]
    assert same_bytes(whole.samples, first[2])
    assert len(whole.ahead) == 2
    again = dapple.WindowTracker(surface, samples)
    again.resume(frames[2], places[2], places[3:])
    for one, other in zip(again.advance(frames[3:], 5), whole.advance(frames[3:], 5), strict=True):
        assert same_bytes(one, other)


def test_classes_stay_even_in_pieces(mesh, surface):
    start = dapple.sample_classes(surface, [60, 30])
    frames = frames_of(mesh, 8)
    for one in dapple.track_pieces(surface, start, frames, piece=4, overlap=1, classes=[60, 30]):
        np.testing.assert_array_equal(one.classes, start.classes)
        assert min(quality.alpha_min for quality in one.report.classes) > 0.4


@pytest.mark.parametrize(("piece", "overlap"), [(4, 4), (4, -1), (0, 0)])
def test_refuses_pieces_that_do_not_come_forward(surface, samples, piece, overlap):
    with pytest.raises(ValueError, match=f"overlap is {overlap}"):
        dapple.track_pieces(surface, samples, [], piece=piece, overlap=overlap)


def test_refuses_what_is_no_frame_ahead(surface, samples):
    tracker = dapple.WindowTracker(surface, samples)
    with pytest.raises(TypeError):
        tracker.resume(surface.vertices, samples, [None])


def test_a_population_follows_the_area(mesh, surface, samples):
    population = dapple.Population(surface, samples, fade=4)
    density = len(samples) / surface.area
    used = set(samples.ids.tolist())
    for frame in range(1, 9):
        population.advance(mesh[0] * [1 + 0.05 * frame, 1, 1])
        now = population.samples
        assert now.fade.shape == (len(now),)
        assert now.fade.min() >= 0
        assert now.fade.max() <= 1
        assert now.report.count == pytest.approx(density * population.surface.area, abs=1)
        used |= set(now.ids.tolist())
    assert len(used) > len(samples)
    assert np.all(samples.fade == 1)


def test_a_population_of_classes_follows_the_area_in_each(mesh, surface):
    start = dapple.sample_classes(surface, [60, 30])
    population = dapple.Population(surface, start, fade=4, classes=[60, 30])
    for frame in range(1, 9):
        now = population.advance(mesh[0] * [1 + 0.05 * frame, 1, 1])
        assert len(now.classes) == len(now)
        growth = population.surface.area / surface.area
        counts = [quality.count for quality in now.report.classes]
        assert counts == pytest.approx([60 * growth, 30 * growth], abs=1)
    assert set(start.ids.tolist()) < set(now.ids.tolist())


def test_a_population_refuses_classes_that_are_not_given(surface):
    start = dapple.sample_classes(surface, [60, 30])
    with pytest.raises(ValueError, match=r"samples\.classes"):
        dapple.Population(surface, start, classes=[90])


def test_a_population_of_classes_refuses_other_faces(surface):
    start = dapple.sample_classes(surface, [60, 30])
    population = dapple.Population(surface, start, classes=[60, 30])
    with pytest.raises(ValueError, match="without classes can continue there, these have 2"):
        population.advance(*torus(50, 24))


def other_mesh(frame: int) -> tuple[np.ndarray, np.ndarray]:
    """The same torus, of other triangles in each frame."""
    return torus(40 + frame % 3, 20 + frame % 2)


def test_a_population_goes_on_on_other_faces():
    surface = dapple.Surface(*torus(40, 20))
    samples = dapple.sample(surface, 300)
    population = dapple.Population(surface, samples)
    for frame in range(1, 7):
        vertices, faces = other_mesh(frame)
        now = population.advance(vertices, faces)
        check_samples(dapple.Surface(vertices, faces), now)
        assert population.surface.faces.tolist() == faces.tolist()
        assert now.report.births + now.report.deaths <= 0.015 * len(samples)
        assert now.report.slide_max <= 0.45
        assert now.report.capacity_variation < 0.02
    stay = np.isin(now.ids, samples.ids)
    assert stay.mean() > 0.95


def test_a_population_takes_a_surface_as_its_vertices(mesh, surface, samples):
    vertices = bent(mesh[0], 0.2)
    one, two, three = (dapple.Population(surface, samples) for _ in range(3))
    expected = one.advance(vertices)
    assert same_bytes(two.advance(dapple.Surface(vertices, mesh[1])), expected)
    assert same_bytes(three.advance(vertices, mesh[1]), expected)


def kept(population, path):
    """What a population goes on from, as read back from a file."""
    there = population.samples
    np.savez(path, **population.state, ids=there.ids, faces=there.faces, places=there.barycentric)
    with np.load(path) as stored:
        arrays = dict(stored)
    samples = dapple.Samples(
        population.surface, arrays["faces"], arrays["places"], ids=arrays["ids"]
    )
    return samples, arrays


def test_a_population_goes_on_with_the_same_bytes(tmp_path):
    surface = dapple.Surface(*torus(40, 20))
    start = dapple.sample(surface, 200)
    whole = dapple.Population(surface, start, fade=3)
    for frame in range(1, 8):
        again = dapple.Population(surface, start, fade=3)
        again.resume(whole.surface, *kept(whole, tmp_path / "frame.npz"))
        vertices, faces = other_mesh(frame // 3)
        now = whole.advance((1.0 + 0.04 * frame) * vertices, faces)
        assert same_bytes(again.advance((1.0 + 0.04 * frame) * vertices, faces), now)
        assert again.samples.fade.tolist() == now.fade.tolist()
    assert whole.state["next_id"] > len(start)


def test_a_population_names_what_of_a_state_does_not_fit(surface, samples):
    population = dapple.Population(surface, samples)
    state = population.state
    for name, bad, said in [
        ("fades", state["fades"][:-1], r"state.fades"),
        ("fades", -state["fades"], r"state.fades\[0\] is -1"),
        ("first_faces", state["first_faces"] - 10**6, r"state.first_faces\[0\] is -\d+"),
        ("first_barycentric", state["first_faces"], r"state.first_barycentric has the shape"),
        ("starts", state["starts"][::-1], r"state.starts does not rise"),
        ("neighbors", state["neighbors"] + len(samples), r"state.neighbors\[0\] is"),
        ("densities", [np.nan], r"state.densities"),
        ("next_id", 0, r"state.next_id is 0, not above samples.ids\[0\]"),
    ]:
        with pytest.raises(ValueError, match=said):
            population.resume(surface, samples, state | {name: bad})
        left = {key: value for key, value in state.items() if key != name}
        with pytest.raises(ValueError, match=f"state has no '{name}'"):
            population.resume(surface, samples, left)
    assert same_bytes(population.samples, samples)


def test_a_population_follows_the_density_of_a_surface():
    vertices, faces = torus(40, 20)
    surface = dapple.Surface(vertices, faces, density=1.0 + (vertices[:, 0] > 0))
    population = dapple.Population(surface, dapple.sample(surface, 200))
    other, triangles = torus(50, 24)
    with pytest.raises(ValueError, match="Surface with its density"):
        population.advance(other, triangles)
    with pytest.raises(ValueError, match="faces must not be given with a Surface"):
        population.advance(surface, faces)
    now = population.advance(dapple.Surface(other, triangles, density=1.0 + (other[:, 0] > 0)))
    assert now.report.capacity_variation < 0.1
    dense = (now.positions[:, 0] > 0).sum()
    assert 1.8 < dense / (len(now) - dense) < 2.2


@pytest.mark.parametrize("name", ["pattern_strength", "stickiness", "longest_motion"])
def test_names_an_option_below_zero(surface, samples, name):
    with pytest.raises(ValueError, match=name):
        dapple.Tracker(surface, samples, **{name: -1}).advance(surface.vertices)


@pytest.mark.parametrize(("name", "value"), [("fade", 0), ("reach", -1), ("pattern_strength", 2)])
def test_a_population_names_an_option_out_of_range(surface, samples, name, value):
    with pytest.raises(ValueError, match=name):
        dapple.Population(surface, samples, **{name: value})
