# SPDX-License-Identifier: GPL-3.0-or-later
"""What does not belong together, and numbers beyond measure: each verb says so in a sentence."""

import inspect
import re
from collections.abc import Callable

import dapple3d as dapple
import numpy as np
import pytest
from shapes import grid, torus

MOST = 100_000_000


@pytest.fixture(scope="module")
def small():
    return dapple.Surface(*grid(1))


@pytest.fixture(scope="module")
def strangers():
    """Samples of a larger surface: most of their faces are not of the small one."""
    return dapple.sample(dapple.Surface(*torus()), 50, max_evaluations=1)


@pytest.fixture(scope="module")
def impostors():
    """Samples of a larger surface on faces with numbers that the small one has too."""
    return dapple.Samples(dapple.Surface(*torus()), [0, 1, 1], np.full((3, 3), 1 / 3))


def own(surface: dapple.Surface, count: int) -> dapple.Samples:
    return dapple.Samples(surface, [0] * count, np.full((count, 3), 1 / 3))


def resume_population(surface: dapple.Surface, samples: dapple.Samples) -> None:
    population = dapple.Population(surface, own(surface, len(samples)))
    population.resume(surface, samples, population.state)


def cover(surface: dapple.Surface, samples: dapple.Samples) -> object:
    uv = np.zeros((2, 3, 2))
    uv[:, 1, 0] = uv[:, 2, 1] = 1
    grid = dapple.texels(surface, uv, 2, 2)
    across = np.tile([1.0, 0.3, 0.2], (len(samples), 1))
    return dapple.decal_cover(surface, samples, np.ones(len(samples)), across, grid)


# Functions that take a surface and its samples: these read positions of samples.
READERS: dict[str, Callable[[dapple.Surface, dapple.Samples], object]] = {
    "mosaic": dapple.mosaic,
    "decal_cover": cover,
    "analyze": dapple.analyze,
    "surface_spectrum": dapple.surface_spectrum,
    "surface_spectrum of runs": lambda s, p: dapple.surface_spectrum(s, [own(s, 3), p]),
    "relax": lambda s, p: dapple.relax(s, p, []),
    "sample": lambda s, p: dapple.sample(s, 60, locked=p),
    "sample_classes": lambda s, p: dapple.sample_classes(s, [5, dapple.SampleClass(60, locked=p)]),
}
# These read only their faces.
VERBS = READERS | {
    "Tracker": dapple.Tracker,
    "Tracker of classes": lambda s, p: dapple.Tracker(s, p, classes=[1]),
    "resume": lambda s, p: dapple.Tracker(s, own(s, len(p))).resume(s.vertices, p),
    "Population": dapple.Population,
    "Population of classes": lambda s, p: dapple.Population(s, p, classes=[1]),
    "resume_on": lambda s, p: dapple.Tracker(s, own(s, len(p))).resume_on(
        s, s.vertices, p, own(s, len(p))
    ),
    "resume_on, first": lambda s, p: dapple.Tracker(s, own(s, len(p))).resume_on(
        s, s.vertices, own(s, len(p)), p
    ),
    "Population.resume": lambda s, p: resume_population(s, p),
    "track_window": lambda s, p: dapple.track_window(s, p, [s.vertices]),
    "track_pieces": lambda s, p: list(dapple.track_pieces(s, p, [s.vertices])),
    "WindowTracker": dapple.WindowTracker,
    "WindowTracker.resume": lambda s, p: dapple.WindowTracker(s, own(s, len(p))).resume(
        s.vertices, p, []
    ),
    "resample": lambda s, p: dapple.resample(s, p, 30),
    "to_original": lambda s, p: dapple.refine_edges(s, 9.0).to_original(p),
    "from_original": lambda s, p: dapple.refine_edges(s, 9.0).from_original(p),
    "Samples": lambda s, p: dapple.Samples(s, p.faces, p.barycentric),
    "evaluate_energy": lambda s, p: dapple.evaluate_energy(s, p.positions, p.faces),
}


def signature(verb: object) -> str:
    return (inspect.getdoc(verb) or "").splitlines()[0]


def test_the_table_has_every_verb():
    """A new verb that takes a surface with samples shows up here, and belongs into the table."""
    taking = {
        name
        for name in dapple.__all__
        for verb in [getattr(dapple, name)]
        for doc in [signature(verb), signature(getattr(verb, "__init__", None))]
        if "Surface" in doc and re.search(r"samples|runs|locked|positions|SampleClass|classes", doc)
    }
    assert taking <= {name.split()[0] for name in VERBS}, taking


@pytest.mark.parametrize("name", VERBS)
def test_refuses_samples_of_a_larger_surface(small, strangers, name):
    with pytest.raises(ValueError, match=r"faces\[\d+\] is \d+, outside the surface's faces 0..1"):
        VERBS[name](small, strangers)


@pytest.mark.parametrize("name", READERS)
def test_refuses_samples_of_another_surface_on_faces_that_it_has(small, impostors, name):
    with pytest.raises(ValueError, match=r"positions\[0\] is .* another surface"):
        READERS[name](small, impostors)


SURFACE_ARRAYS: dict[str, Callable[[dapple.Surface], object]] = {
    "deformed": lambda s: s.deformed(np.zeros((5, 3))),
    "with_density": lambda s: s.with_density(np.ones(5)),
    "with_density at faces": lambda s: s.with_density(np.ones(3), density_at="faces"),
    "with_density at corners": lambda s: s.with_density(np.ones((3, 3)), density_at="corners"),
    "density of a class": lambda s: dapple.sample_classes(
        s, [dapple.SampleClass(3, density=np.ones(5))]
    ),
    "advance": lambda s: dapple.Tracker(s, own(s, 3)).advance(np.zeros((5, 3))),
    "resume": lambda s: dapple.Tracker(s, own(s, 3)).resume(np.zeros((5, 3)), own(s, 3)),
    "resume with others": lambda s: dapple.Tracker(s, own(s, 3)).resume(s.vertices, own(s, 4)),
    "population": lambda s: dapple.Population(s, own(s, 3)).advance(np.zeros((5, 3))),
    "window": lambda s: dapple.track_window(s, own(s, 3), [s.vertices, np.zeros((5, 3))]),
    "pieces": lambda s: list(dapple.track_pieces(s, own(s, 3), [np.zeros((5, 3))])),
    "WindowTracker": lambda s: dapple.WindowTracker(s, own(s, 3)).advance([np.zeros((5, 3))], 1),
    "WindowTracker.resume": lambda s: dapple.WindowTracker(s, own(s, 3)).resume(
        s.vertices, own(s, 3), [own(s, 4)]
    ),
    "refine_image": lambda s: dapple.refine_image(s, np.zeros((3, 3, 2)), np.ones((2, 2))),
    "refine_obstacles": lambda s: dapple.refine_obstacles(
        s, np.zeros((0, 3)), 1.0, areas=np.zeros(3, bool)
    ),
    "radii": lambda s: dapple.refine_obstacles(s, np.zeros((2, 3)), np.ones(3)),
    "refine_edges": lambda s: dapple.refine_edges(s, np.ones(3)),
    "texels": lambda s: dapple.texels(s, np.zeros((3, 3, 2)), 2, 2),
    "insets": lambda s: dapple.mosaic(s, own(s, 3), insets=np.ones(4)),
    "fine vertices": lambda s: dapple.refine_edges(s, 9.0).vertices(np.zeros((5, 3))),
    "fine deformed": lambda s: dapple.refine_edges(s, 9.0).deformed(np.zeros((5, 3))),
    "then": lambda s: dapple.refine_edges(s, 0.5).then(dapple.refine_edges(s, 0.2)),
    "faces of samples": lambda s: dapple.Samples(s, [0, 1], np.full((3, 3), 1 / 3)),
    "ids of samples": lambda s: dapple.Samples(s, [0, 1], np.full((2, 3), 1 / 3), ids=[1]),
    "positions": lambda s: dapple.evaluate_energy(s, np.zeros((3, 3)), [0, 1]),
    "ranks": lambda s: dapple.progressive_ranks(np.zeros((3, 3)), [0, 1]),
}


@pytest.mark.parametrize("name", SURFACE_ARRAYS)
def test_refuses_arrays_of_another_length(small, name):
    with pytest.raises(ValueError, match=r"\d|finer"):
        SURFACE_ARRAYS[name](small)


def test_a_window_names_the_frame(small):
    frames = [small.vertices, small.vertices[:3]]
    with pytest.raises(dapple.SurfaceError, match=r"frames\[1\] has 3 rows"):
        dapple.track_window(small, own(small, 3), frames)


# Integers, by the name of the argument.

INKS = np.ones((1, 2, 2))
SQUARE = dapple.Plane(1, 1)


def whole_arguments() -> list[tuple[str, str, Callable[[dapple.Surface, int], object]]]:
    verbs = {
        "sample": lambda s, **k: dapple.sample(s, **{"count": 2, **k}),
        "resample": lambda s, **k: dapple.resample(s, own(s, 2), **{"count": 2, **k}),
        "relax": lambda s, **k: dapple.relax(s, own(s, 2), [0], **k),
        "sample, in a plane": lambda s, **k: dapple.sample(SQUARE, **{"count": 2, **k}),
        "sample_classes": lambda s, **k: dapple.sample_classes(s, [2], **k),
        "sample_classes, in a plane": lambda s, **k: dapple.sample_classes(SQUARE, [2], **k),
        "stipple_inks": lambda s, **k: dapple.stipple_inks(INKS, **{"count": 2, **k}),
        "stipple": lambda s, **k: dapple.stipple(INKS[0] / 2, **{"count": 2, **k}),
        "Tracker": lambda s, **k: dapple.Tracker(s, own(s, 2), **k),
        "Population": lambda s, **k: dapple.Population(s, own(s, 2), **k),
        "track_window": lambda s, **k: dapple.track_window(s, own(s, 2), [s.vertices], **k),
        "WindowTracker": lambda s, **k: dapple.WindowTracker(s, own(s, 2), **k),
        "mosaic": lambda s, **k: dapple.mosaic(s, own(s, 2), **k),
        "remesh": lambda s, **k: dapple.remesh(s, **{"count": 4, **k}),
        "sample_symmetric": lambda s, **k: dapple.sample_symmetric(
            s, **{"count": 2, "max_mirror_error": 1.0, **k}
        ),
        "sample_lines": lambda s, **k: dapple.sample_lines(s, **{"count": 4, **k}),
        "spectrum": lambda s, **k: dapple.spectrum(np.full((2, 2), 0.5), **k),
        "surface_spectrum": lambda s, **k: dapple.surface_spectrum(s, own(s, 2), **k),
        "refine_edges": lambda s, **k: dapple.refine_edges(s, 9.0, **k),
        "refine_image": lambda s, **k: dapple.refine_image(s, np.zeros((2, 3, 2)), INKS[0], **k),
        "refine_obstacles": lambda s, **k: dapple.refine_obstacles(s, np.zeros((0, 3)), 1.0, **k),
        "refine_outside": lambda s, **k: dapple.refine_outside(s, **{"edge": 0.1, **k}),
        "exposure": lambda s, **k: dapple.exposure(s, **k),
        "curvedness": lambda s, **k: dapple.curvedness(s, **k),
        "curvature_density": lambda s, **k: dapple.curvature_density(s, **k),
        "texels": lambda s, **k: dapple.texels(
            s, np.zeros((2, 3, 2)), **{"rows": 2, "columns": 2, **k}
        ),
        "SampleClass": lambda s, **k: dapple.SampleClass(**k),
    }
    found = []
    for name, verb in verbs.items():
        made = getattr(dapple, name.split(",")[0])
        doc = signature(made.__init__ if isinstance(made, type) else made)
        if name == "stipple":
            doc = str(inspect.signature(made))
        for argument in re.findall(r"(\w+): int\b", doc):
            found.append((name, argument, lambda s, n, v=verb, a=argument: v(s, **{a: n})))
    return found


WHOLE = whole_arguments()


def test_looks_at_all_whole_numbers():
    assert {"count", "seed", "threads", "max_evaluations", "max_faces", "bins"} <= {
        a for _, a, _ in WHOLE
    }
    assert len(WHOLE) > 45


@pytest.mark.parametrize(("name", "argument", "call"), WHOLE, ids=[f"{n}-{a}" for n, a, _ in WHOLE])
@pytest.mark.parametrize("number", [-1, 2**31, -(2**31) - 1, 2**64, 10**400])
def test_names_a_whole_number_out_of_range(small, name, argument, call, number):
    if argument == "seed" and 0 <= number < 2**64:
        pytest.skip("a seed may be that large")
    with pytest.raises(ValueError, match=rf"^{argument} is {str(number)[:20]}") as error:
        call(small, number)
    assert len(str(error.value)) < 200


@pytest.mark.parametrize("threads", [4097, 10_000_000])
def test_refuses_more_threads_than_machines_have(small, threads):
    with pytest.raises(ValueError, match=rf"threads is {threads}: it must be in 0\.\.4096"):
        dapple.sample(small, 2, threads=threads)


@pytest.mark.parametrize("count", [MOST + 1, 2**31 - 1])
def test_refuses_more_samples_than_can_be(small, count):
    for call in (
        lambda: dapple.sample(small, count),
        lambda: dapple.resample(small, own(small, 2), count),
        lambda: dapple.relax(small, own(small, 2), [0], count=count),
        lambda: dapple.sample(SQUARE, count),
        lambda: dapple.stipple_inks(INKS, count),
        lambda: dapple.sample_classes(small, [count]),
    ):
        with pytest.raises(ValueError, match=rf"{count}.*{MOST}"):
            call()
    with pytest.raises(ValueError, match=rf"{MOST + 2}.*{MOST}"):
        dapple.sample_classes(small, [MOST // 2 + 1, MOST // 2 + 1])


def test_takes_whole_numbers_of_numpy(small):
    assert (
        len(dapple.sample(small, np.int64(3), seed=np.uint64(2**64 - 1), threads=np.int8(1))) == 3
    )
    with pytest.raises(TypeError):
        dapple.sample(small, 3.0)  # type: ignore[arg-type]


@pytest.mark.parametrize("bad", [10**30, -1])
def test_names_a_count_in_a_list(small, bad):
    with pytest.raises(ValueError, match=rf"classes\[1\]\.count is {bad}"):
        dapple.sample_classes(small, [3, bad])
    with pytest.raises(ValueError, match=rf"counts\[0\] is {bad}"):
        dapple.stipple_inks(INKS, 3, counts=[bad])


def test_names_a_length_too_large_for_a_number(small):
    with pytest.raises(ValueError, match=r"longest is 1000.*does not fit"):
        dapple.refine_edges(small, 10**400)
    with pytest.raises(ValueError, match=r"radii is 1000.*does not fit"):
        dapple.refine_obstacles(small, np.zeros((1, 3)), 10**400)


def test_a_population_does_not_grow_without_bound():
    surface = dapple.Surface(*torus())
    population = dapple.Population(surface, dapple.sample(surface, 20))
    before = population.samples.positions
    with pytest.raises(ValueError, match=rf"2e\+09 samples.*{MOST}"):
        population.advance(surface.vertices * 1e4)
    np.testing.assert_array_equal(population.samples.positions, before)


@pytest.mark.parametrize("far", [1e15, 1e155, 1e300])
def test_projects_points_beyond_all_measure(small, far):
    found = dapple.project(small, [[far, far / 2, 0], [-far, 0, far]])
    assert ((found.faces == 0) | (found.faces == 1)).all()
    np.testing.assert_allclose(found.positions[0], [1, 1, 0], atol=1e-9)
    np.testing.assert_allclose(found.distances / far, [np.sqrt(1.25), np.sqrt(2)])
    with pytest.raises(ValueError, match=r"positions\[0\].*outside"):
        dapple.evaluate_energy(SQUARE, [[far, far]])
