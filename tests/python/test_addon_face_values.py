# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of faces and of face corners in the core: no point is where the density is 0."""

from dataclasses import replace

import dapple3d as dapple
import numpy as np
import pytest
from dapple3d import density
from shapes import torus

from addon.core.base.errors import ScatterError
from addon.core.density.masked_surface import masked_surface_of
from addon.core.density.terms import density_of
from addon.core.settings.values import MATERIAL, ClassSettings, DensitySettings, Settings
from addon.core.solve.carried_points import PreviousResult
from addon.core.solve.incremental import evened, is_whole, kept
from addon.core.solve.locked import Locked
from addon.core.solve.solve import scatter
from addon.core.surface import mesh_snapshot
from addon.core.surface.arrays import SurfaceArrays

VERTICES, FACES = torus(48, 24)
RANDOM = np.random.default_rng(5)
PLACED = {"vertices": len(VERTICES), "faces": (len(FACES), 1), "corners": (len(FACES), 3)}


def surface_of(**weights) -> SurfaceArrays:
    vertices, faces = np.asarray(VERTICES, float), np.asarray(FACES, np.int32)
    return SurfaceArrays("Torus", vertices, faces, "same", weights=weights)


def above(surface: SurfaceArrays) -> np.ndarray:
    """Which faces (m,) are in the upper half."""
    found: np.ndarray = surface.vertices[surface.faces][:, :, 2].min(axis=1) > -1e-9
    return found


def half(width: int = 1, upper: bool = True) -> np.ndarray:
    """1 on the faces of one half, 0 on all others: (m, 1) or (m, 3)."""
    chosen = above(surface_of()) == upper
    return np.repeat(chosen[:, None].astype(float), width, axis=1)


def at_corners(values: np.ndarray, faces) -> np.ndarray:
    found = values[faces] if values.ndim == 1 else values
    return np.broadcast_to(found, (len(faces), 3))


@pytest.mark.parametrize("places", [("faces",), ("faces", "corners"), ("vertices", "faces"),
                                    ("vertices", "faces", "corners"), ("vertices",)])  # fmt: skip
def test_products_stay_where_their_values_are(places):
    values = [RANDOM.random(PLACED[one]) for one in places]
    found = density.product(values, FACES)
    expected = np.prod([at_corners(one, FACES) for one in values], axis=0)
    np.testing.assert_allclose(at_corners(found, FACES), expected, rtol=1e-12)
    assert found.shape == {
        ("faces",): (len(FACES), 1),
        ("vertices",): (len(VERTICES),),
    }.get(places, (len(FACES), 3))


@pytest.mark.parametrize("width", [1, 3])
@pytest.mark.parametrize("cut", [False, True])
def test_faces_keep_their_values_where_others_cut_them(width, cut):
    more = {"use_height": True, "height_min": -9.0, "height_max": 0.1, "height_falloff": 0.2}
    settings = DensitySettings(attribute="Grass", **(more if cut else {}))
    surface = surface_of(Grass=half(width), Moss=half(width, upper=False))
    masked = masked_surface_of(surface, Settings(count=500, density=settings))
    assert masked.is_cut == cut
    upper = above(surface)[masked.pieces[0]]
    assert not masked.corner_density()[~upper].any()
    assert masked.corner_density()[upper].max() == 1.0
    assert not masked.corner_density("Moss").any()
    plain = masked_surface_of(surface, Settings(count=500, density=replace(settings, attribute="")))
    own = plain.corner_density("Moss")
    assert not own[above(surface)[plain.pieces[0]]].any()
    assert own.any()


@pytest.mark.parametrize("width", [1, 3])
@pytest.mark.parametrize("amount", [{"count": 300}, {"per_area": 20.0}])
def test_points_are_on_faces_of_some_density_alone(width, amount):
    surface = surface_of(Grass=half(width), Road=half(width, upper=False))
    for terms in ({"attribute": "Grass"}, {"blocked_areas": "Road"}):
        settings = Settings(**amount, density=DensitySettings(**terms))
        found = scatter(surface, settings, None)
        assert above(surface)[found.solved.samples.faces].all()
        np.testing.assert_allclose(found.columns["dapple_density"], 1.0)
    if "per_area" in amount:
        assert found.report.count == pytest.approx(20.0 * found.capacity, abs=1.0)


def test_object_types_multiply_values_of_faces_by_their_own():
    first = RANDOM.random(len(VERTICES)) + 0.5
    surface = surface_of(Grass=half(3), Slowly=first, Right=half_by_x())
    kinds = tuple(ClassSettings(density=name, radius=0.01) for name in ("Slowly", "Right", ""))
    settings = Settings(count=300, object_types=kinds, density=DensitySettings(attribute="Grass"))
    found = scatter(surface, settings, None)
    faces, kinds = found.solved.samples.faces, found.columns["dapple_object_type"]
    assert above(surface)[faces].all()
    assert (half_by_x()[faces[kinds == 1]] > 0.0).all()
    assert np.bincount(kinds).tolist() == [100, 100, 100]


def half_by_x() -> np.ndarray:
    middles = np.asarray(VERTICES)[FACES].mean(axis=1)
    return (middles[:, :1] > 0.0).astype(float)


@pytest.mark.parametrize(
    ("invert", "strength", "other"), [(0, 1.0, 0.0), (1, 1.0, 1.0), (0, 0.25, 0.75)]
)
def test_a_material_mask_is_constant_on_faces(invert, strength, other):
    settings = DensitySettings(
        use_material=True,
        materials=("Soil",),
        material_invert=bool(invert),
        material_strength=strength,
    )
    found = density_of(surface_of(**{MATERIAL: half()}), settings)
    expected = np.where(half() > 0.0, 0.0 if invert else 1.0, other)
    np.testing.assert_allclose(found, expected)
    unused = replace(settings, use_material=False)
    assert density_of(surface_of(), unused) is None
    assert density_of(surface_of(), replace(settings, material_strength=0.0)) is None
    assert density_of(surface_of(), replace(settings, materials=())) is None


def changed(before, surface, settings, locked=None):
    """Points that follow a change as Auto Update has them."""
    context = dapple.Context()
    stored = PreviousResult(before.binding, before.columns, before.solved)
    found = kept(stored, surface, settings, context, locked)
    return found if is_whole(found) else evened(found, context, locked)


@pytest.mark.parametrize("amount", [{"count": 300}, {"per_area": 20.0}])
@pytest.mark.parametrize("share", [0.02, 0.2, 0.6])
def test_points_that_are_kept_leave_faces_whose_density_is_0(amount, share):
    for seed in range(4):
        chance = np.random.default_rng(seed).random((len(FACES) // 2, 1))
        values = np.repeat((chance >= share).astype(float), 2, axis=0)
        settings = Settings(**amount, seed=seed, density=DensitySettings(attribute="Grass"))
        full = scatter(surface_of(Grass=np.ones((len(FACES), 1))), settings, None)
        found = changed(full, surface_of(Grass=values), settings)
        assert (values[found.solved.samples.faces] > 0.0).all()
        again = changed(found, surface_of(Grass=1.0 - values), settings)
        assert (values[again.solved.samples.faces] == 0.0).all()


@pytest.mark.parametrize("count", [300, 310])
def test_points_beside_locked_ones_leave_faces_whose_density_is_0(count):
    settings = Settings(count=300, density=DensitySettings(attribute="Grass"))
    full = scatter(surface_of(Grass=np.ones((len(FACES), 1))), settings, None)
    ids = full.columns["id"][:5]
    locked = Locked(full.positions[:5], ids, np.zeros(5, dtype=np.int32))
    for values in (half(), half(upper=False), half_by_x()):
        found = changed(full, surface_of(Grass=values), replace(settings, count=count), locked)
        free = ~np.isin(found.columns["id"], ids)
        assert len(free) == count
        assert (values[found.solved.samples.faces[free]] > 0.0).all()


def test_a_value_that_is_no_density_is_named_where_it_is():
    for domain, said in (("POINT", "vertex 1"), ("FACE", "face 1"), ("CORNER", "face corner 1")):
        values = mesh_snapshot.RawValues(
            "Grass", domain, np.array([1.0, -2.0, 3.0], dtype=np.float32)
        )
        with pytest.raises(ScatterError, match=f"'Grass' is -2 at {said}; a density must be"):
            values.numbers("Torus")


def test_triangles_have_the_values_of_their_polygons_and_corners():
    starts = np.array([0, 5, 8], dtype=np.int32)  # a pentagon, a triangle, a quad
    cut = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [5, 6, 7], [8, 9, 10], [8, 10, 11]])
    values = [
        mesh_snapshot.RawValues("Of faces", "FACE", np.array([True, False, True])),
        mesh_snapshot.RawValues("Of corners", "CORNER", np.arange(12, dtype=np.int32)),
        mesh_snapshot.RawValues(
            "Colors", "FACE", np.array([[0, 1, 2, 9], [3, 3, 3, 9], [0, 0, 3, 9.0]])
        ),
    ]
    found, digests = mesh_snapshot.placed_values("Mixed", values, starts, cut[:, ::-1])
    assert found["Of faces"][:, 0].tolist() == [1.0, 1.0, 1.0, 0.0, 1.0, 1.0]
    assert (found["Of corners"] == cut[:, ::-1]).all()
    assert found["Colors"][:, 0].tolist() == [1.0, 1.0, 1.0, 3.0, 1.0, 1.0]
    other = cut.copy()
    other[4:] = [[8, 9, 11], [9, 10, 11]]  # the quad along its other diagonal
    assert mesh_snapshot.placed_values("Mixed", values, starts, other)[1] == digests


def test_points_spread_evenly_over_faces_that_get_a_density():
    """All points came together on a quarter of the surface, or were as many as before there."""
    few = (half() > 0.0) & (half_by_x() > 0.0)
    settings = Settings(count=200, density=DensitySettings(attribute="Grass"))
    start = scatter(surface_of(Grass=few.astype(float)), settings, None)
    for values in (np.ones((len(FACES), 1)), half(upper=False)):
        found = changed(start, surface_of(Grass=values), settings)
        surface = found.solved.masked.surface
        report = dapple.analyze(surface, found.solved.samples)
        assert report.count == 200
        assert report.capacity_variation < 0.02
        assert len(np.intersect1d(found.columns["id"], start.columns["id"])) == 200
