# SPDX-License-Identifier: GPL-3.0-or-later
"""What pickles comes back to the last byte, in every protocol; what does not says why."""

import copy
import pickle

import dapple3d as dapple
import numpy as np
import pytest
from checks import same_bytes
from shapes import bent, torus

PROTOCOLS = range(pickle.HIGHEST_PROTOCOL + 1)


def sent(value, protocol=pickle.HIGHEST_PROTOCOL):
    return pickle.loads(pickle.dumps(value, protocol))


def surfaces():
    vertices, faces = torus()
    plain = dapple.Surface(vertices, faces)
    soup = dapple.Surface(vertices[faces].reshape(-1, 3), np.arange(faces.size).reshape(-1, 3))
    doubled = dapple.Surface(vertices, np.vstack([faces, faces[:30]]))
    return {
        "plain": plain,
        "deformed": plain.deformed(bent(vertices, 1.0)),
        "dense": plain.with_density(1.5 + vertices[:, 0]),
        "by faces": plain.with_density(np.arange(len(faces)) % 3, density_at="faces"),
        "at corners": plain.with_density(np.ones((len(faces), 3)), density_at="corners"),
        "welded": soup,
        "by indices": dapple.Surface(vertices, faces, weld=None, sharp_angle=5.0),
        "doubled": doubled,
        "shaded": dapple.Surface(vertices, faces, normals=plain.corner_normals[::-1]),
    }


def check_same_surface(found, surface):
    for name in ("vertices", "faces", "corner_normals"):
        assert getattr(found, name).tobytes() == getattr(surface, name).tobytes()
    density, expected = found.density, surface.density
    assert (density is None) == (expected is None)
    assert density is None or density.tobytes() == expected.tobytes()
    options = ("density_at", "weld", "sharp_angle", "merge_doubled")
    for name in (*options, "doubled_faces", "area", "capacity"):
        assert getattr(found, name) == getattr(surface, name)
    options = {"max_evaluations": 4}
    assert same_bytes(dapple.sample(found, 60, **options), dapple.sample(surface, 60, **options))


@pytest.mark.parametrize("name", surfaces())
def test_a_surface_pickles(name):
    surface = surfaces()[name]
    for protocol in PROTOCOLS:
        check_same_surface(sent(surface, protocol), surface)
    check_same_surface(copy.copy(surface), surface)
    check_same_surface(copy.deepcopy(surface), surface)


def test_surfaces_of_one_pickle_keep_their_faces_in_common(surface, mesh):
    density = np.ones(len(mesh[0]))
    density[:9] = 2.0
    other = surface.with_density(density)
    expected = dapple.changed_faces(surface.with_density(np.ones(len(mesh[0]))), other)
    before, after = sent((surface.with_density(np.ones(len(mesh[0]))), other))
    np.testing.assert_array_equal(dapple.changed_faces(before, after), expected)
    assert len(pickle.dumps((surface, other))) < 1.6 * len(pickle.dumps(surface))
    twin = copy.copy(surface)
    assert len(dapple.changed_faces(surface, twin)) == 0


def test_a_tracker_goes_on_from_pickled_values(surface, samples, mesh):
    tracker = dapple.Tracker(surface, samples)
    tracker.advance(bent(mesh[0], 0.3))
    start, first, now, settled = sent((surface, samples, tracker.samples, tracker.settled))
    other = dapple.Tracker(start, first)
    other.resume(bent(mesh[0], 0.3), now, settled=settled)
    assert same_bytes(other.advance(bent(mesh[0], 0.6)), tracker.advance(bent(mesh[0], 0.6)))


def values():
    vertices, faces = torus()
    surface = dapple.Surface(vertices, faces)
    samples = dapple.sample(surface, 60, max_evaluations=4)
    classes = [
        dapple.SampleClass(20, radius=0.1),
        dapple.SampleClass(30, density=vertices[:, 0] + 2),
    ]
    several = dapple.sample_classes(surface, classes, max_evaluations=2)
    population = dapple.Population(surface, samples, max_evaluations=2)
    grown = population.advance(1.2 * vertices)
    flat = dapple.sample(dapple.Torus(), 64, max_evaluations=2)
    uv = np.stack([vertices[faces][..., 0], vertices[faces][..., 1]], axis=-1) / 10 + 0.5
    return {
        "Samples": samples,
        "classes": several,
        "fade": grown,
        "Report": several.report,
        "Quality": several.report.classes[0],
        "PlanarSamples": flat,
        "SampleClass": classes[1],
        "locked": dapple.SampleClass(90, locked=samples),
        "Option": dapple.option_table("sample")[0],
        "choice": next(o for o in dapple.option_table("sample") if o.choices),
        "Topology": surface.topology,
        "Projection": dapple.project(surface, vertices * 1.1),
        "Energy": dapple.evaluate_energy(surface, samples.positions, samples.faces),
        "Mosaic": dapple.mosaic(surface, samples, grout=0.01),
        "RemeshResult": dapple.remesh(surface, 120, max_evaluations=3),
        "RemeshReport": dapple.remesh(surface, 120, max_evaluations=3).report,
        "SymmetricSamples": dapple.sample_symmetric(surface, 50, max_mirror_error=1.0),
        "LineSamples": dapple.sample_lines(surface, 50, feature_angle=0),
        "Texels": dapple.texels(surface, uv, 16, 16),
        "Spectrum": dapple.spectrum(flat.positions, half_width=8),
        "SurfaceSpectrum": dapple.surface_spectrum(surface, samples, radius=1.0, bins=8),
        "Stipples": dapple.stipple_inks(np.ones((1, 8, 8)), 20, max_evaluations=2),
        "Refined": dapple.refine_edges(surface, 0.5),
        "Plane": dapple.Plane(2.0, 3.0),
        "image": dapple.Plane(2.0, 3.0, np.arange(12.0).reshape(3, 4)),
        "polygon": dapple.Plane.polygon(
            [[0, 0], [4, 0], [4, 4], [0, 4]], [[[1, 1], [2, 1], [1, 2]]]
        ),
        "Torus": dapple.Torus(),
        "periodic": dapple.Torus(np.arange(12.0).reshape(3, 4)),
    }


def plain(value):
    """All that Python can see of a value, but for methods."""
    if isinstance(value, np.ndarray):
        return (value.shape, str(value.dtype), value.tobytes())
    if type(value).__module__.startswith("dapple3d"):
        names = [
            name for name in dir(type(value)) if isinstance(getattr(type(value), name), property)
        ]
        return {name: plain(getattr(value, name)) for name in names}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    return value


@pytest.mark.parametrize("name", values())
def test_a_value_pickles(name):
    value = values()[name]
    expected = plain(value)
    for protocol in PROTOCOLS:
        found = sent(value, protocol)
        assert type(found) is type(value)
        assert plain(found) == expected
    assert plain(copy.copy(value)) == expected
    assert plain(copy.deepcopy(value)) == expected


def test_what_was_pickled_works_on():
    made = values()
    for name in ("Plane", "image", "polygon", "Torus", "periodic"):
        domain = made[name]
        found = dapple.sample(sent(domain), 30, max_evaluations=2)
        expected = dapple.sample(domain, 30, max_evaluations=2)
        assert found.positions.tobytes() == expected.positions.tobytes()
    refined = sent(made["Refined"])
    fine = dapple.sample(refined.surface, 40, max_evaluations=2)
    expected = dapple.sample(made["Refined"].surface, 40, max_evaluations=2)
    assert same_bytes(refined.to_original(fine), made["Refined"].to_original(expected))


class Named(dapple.Surface):
    def __init__(self, name):
        super().__init__(*torus())
        self.name = name


def test_a_class_of_ones_own_keeps_what_it_added():
    for protocol in PROTOCOLS:
        found = sent(Named("ring"), protocol)
        assert (type(found), found.name) == (Named, "ring")
        assert found.area == Named("ring").area


def moving():
    surface = dapple.Surface(*torus())
    samples = dapple.sample(surface, 60, max_evaluations=4)
    kinds = (dapple.Tracker, dapple.Population, dapple.WindowTracker)
    return [kind(surface, samples) for kind in kinds] + [dapple.Context()]


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_what_is_under_way_refuses_in_words(protocol):
    for value in moving():
        words = f"cannot pickle or copy a {type(value).__name__}: "
        with pytest.raises(TypeError, match=words):
            pickle.dumps(value, protocol)


def test_what_is_under_way_is_not_copied():
    for value in moving():
        for call in (copy.copy, copy.deepcopy):
            with pytest.raises(TypeError, match="cannot pickle or copy"):
                call(value)


def broken(state, rng):
    """The state with one of its parts exchanged."""
    if isinstance(state, tuple) and state:
        k = rng.integers(len(state))
        return (*state[:k], broken(state[k], rng), *state[k + 1 :])
    if isinstance(state, np.ndarray):
        return [state[:-1], state + 1_000_000, state.astype(np.float32), np.zeros((2, 7)), -state][
            rng.integers(5)
        ]
    return [None, "?", -1, 2**40, ()][rng.integers(5)]


@pytest.mark.parametrize("name", ["Surface", "connectivity", *values()])
def test_a_damaged_state_is_refused_or_harmless(name):
    rng = np.random.default_rng(0)
    surface = dapple.Surface(*torus())
    value = {
        "Surface": surface,
        "connectivity": surface.__getstate__()[0][0],
        **values(),
    }[name]
    if not hasattr(type(value), "__setstate__"):
        pytest.skip("a class of Python")
    for _ in range(60):
        made = type(value).__new__(type(value))
        try:
            made.__setstate__(broken(value.__getstate__(), rng))
        except (ValueError, TypeError):
            continue
        plain(made)
