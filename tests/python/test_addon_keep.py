# SPDX-License-Identifier: GPL-3.0-or-later
"""Keep Points: points keep their ids, and far from a change they keep every byte."""

from dataclasses import replace

import dapple3d as dapple
import numpy as np
import pytest
from shapes import torus

from addon.core.base.errors import ScatterError
from addon.core.settings.values import ClassSettings, DensitySettings, Settings
from addon.core.solve.carried_points import PreviousResult
from addon.core.solve.incremental import as_placed, evened, is_whole, keeps, kept, measured
from addon.core.solve.locked import Locked
from addon.core.solve.solve import Scattered, scatter
from addon.core.surface.arrays import SurfaceArrays, Surroundings
from addon.core.surface.records import Binding

ROWS = ("corners", "barycentric", "angle", "loops")
BY_AREA = Settings(per_area=60.0)
PAINTED = DensitySettings(attribute="Grass")


def arrays(**changes) -> SurfaceArrays:
    vertices, faces = torus(96, 48)
    found = SurfaceArrays("Torus", np.asarray(vertices, float), np.asarray(faces, np.int32), "same")
    ones = {"Grass": np.ones(len(found.vertices))}
    return replace(found, **({"weights": ones} | changes))


def middle(surface: SurfaceArrays) -> np.ndarray:
    return surface.vertices[100]


def away(points, surface) -> np.ndarray:
    return np.linalg.norm(points - middle(surface), axis=1)


def painted(surface: SurfaceArrays, value: float) -> SurfaceArrays:
    near = away(surface.vertices, surface) < 0.3
    return replace(surface, weights={"Grass": np.where(near, value, 1.0)})


def bumped(surface: SurfaceArrays) -> SurfaceArrays:
    vertices = surface.vertices.copy()
    vertices[:, 2] += 0.1 * np.clip(1 - away(vertices, surface) / 0.3, 0, None) ** 2
    return replace(surface, vertices=vertices)


def blocked(surface: SurfaceArrays, shift: float = 0.0) -> SurfaceArrays:
    corners = 0.25 * np.array([[-1, -1, -1], [1, 1, -1], [1, -1, 1], [-1, 1, 1]])
    stone = corners + middle(surface) + [0.0, 0.0, shift]
    faces = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]], dtype=np.int32)
    return replace(surface, around=Surroundings(obstacles=((stone, faces),)))


def before_of(solved: Scattered, remembered: bool = True) -> PreviousResult:
    return PreviousResult(solved.binding, solved.columns, solved.solved if remembered else None)


def updated(solved: Scattered, surface: SurfaceArrays, settings: Settings, **more) -> Scattered:
    context, locked = dapple.Context(), more.pop("locked", None)
    found = kept(before_of(solved, **more), surface, settings, context, locked)
    return found if is_whole(found) else evened(found, context, locked)


def rows_of(solved: Scattered, found: Scattered) -> tuple[np.ndarray, np.ndarray]:
    """Rows of the points that both have."""
    _, old, new = np.intersect1d(solved.columns["id"], found.columns["id"], return_indices=True)
    return old, new


def same(solved: Scattered, found: Scattered) -> tuple[np.ndarray, np.ndarray]:
    """Of the points that both have, places before, and whether all that is stored is the same."""
    old, new = rows_of(solved, found)
    alike = (solved.positions[old] == found.positions[new]).all(axis=1)
    for name, values in solved.binding.rows().items():
        other = found.binding.rows()[name][new]
        one = values[old]
        alike &= (one == other).all(axis=1) if one.ndim > 1 else one == other
    for name in ("dapple_scale", "dapple_turn", "dapple_rank"):
        alike &= solved.columns[name][old] == found.columns[name][new]
    return solved.positions[old], alike


def check(found: Scattered, surface: SurfaceArrays) -> None:
    ids = found.columns["id"]
    assert len(np.unique(ids)) == len(ids) == found.report.count
    places = found.binding.positions(surface.vertices)
    assert np.abs(places - found.positions).max() < 1e-9
    figures = measured(found, dapple.Context()).report
    assert figures.measured
    assert figures.capacity_variation < 0.02
    assert figures.alpha_mean > 0.7


def check_far(solved: Scattered, found: Scattered, surface: SurfaceArrays, reach: float) -> None:
    """Within a reach of the middle, and three spacings beyond, points move; all others stay."""
    places, alike = same(solved, found)
    far = away(places, surface) > reach + 3 * solved.report.spacing
    assert far.sum() > 500
    assert alike[far].mean() >= 0.99
    assert not alike[~far].all()


CHANGES = {
    "less where it was painted": lambda surface: painted(surface, 0.3),
    "nothing where it was painted": lambda surface: painted(surface, 0.0),
    "more where it was painted": lambda surface: painted(surface, 3.0),
    "a bump": bumped,
    "an obstacle": blocked,
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES.keys())
def test_far_from_a_local_change_points_keep_their_bytes(change) -> None:
    settings = replace(BY_AREA, density=replace(PAINTED, avoid_margin=0.02))
    surface = arrays()
    solved = scatter(surface, settings, dapple.Context())
    after = change(surface)
    found = updated(solved, after, settings)
    check(found, after)
    check_far(solved, found, surface, 0.45)


def test_an_obstacle_that_is_moved_moves_what_is_around_it() -> None:
    settings = replace(BY_AREA, density=DensitySettings(avoid_margin=0.02))
    before, after = blocked(arrays()), blocked(arrays(), 0.1)
    solved = scatter(before, settings, dapple.Context())
    found = updated(solved, after, settings)
    check(found, after)
    check_far(solved, found, before, 0.55)


def test_a_surface_that_was_moved_as_a_whole_is_the_same_one() -> None:
    settings = replace(BY_AREA, density=PAINTED)
    surface = arrays()
    solved = scatter(surface, settings, dapple.Context())
    pose = np.eye(4)
    pose[:3, :3] = np.array([[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])
    pose[:3, 3] = 1.0, 2.0, 3.0
    after = painted(surface, 0.2)
    vertices = after.vertices @ pose[:3, :3].T + pose[:3, 3]
    found = updated(solved, replace(after, vertices=vertices, matrix=pose), settings)
    old, new = rows_of(solved, found)
    far = away(solved.positions[old], surface) > 0.45 + 3 * solved.report.spacing
    stays = (solved.binding.barycentric[old] == found.binding.barycentric[new]).all(axis=1)
    assert far.sum() > 500
    assert stays[far].mean() >= 0.99


@pytest.mark.parametrize("remembered", [True, False])
@pytest.mark.parametrize("count", [900, 1000, 1100])
def test_another_count_is_exact_keeps_the_ids_and_moves_points_little(remembered, count) -> None:
    surface, settings = arrays(), Settings(count=1000)
    solved = scatter(surface, settings, dapple.Context())
    found = updated(solved, surface, replace(settings, count=count), remembered=remembered)
    check(found, surface)
    assert found.report.count == count
    old, new = rows_of(solved, found)
    assert len(old) == min(count, 1000)
    moved = np.linalg.norm(solved.positions[old] - found.positions[new], axis=1)
    assert np.median(moved) < 0.25 * found.report.spacing
    assert moved.max() < found.report.spacing


def test_an_exact_count_stays_where_density_is_taken_away() -> None:
    surface, settings = arrays(), Settings(count=1000, density=PAINTED)
    solved = scatter(surface, settings, dapple.Context())
    after = painted(surface, 0.0)
    first = kept(before_of(solved), after, settings, dapple.Context(), None)
    assert not is_whole(first)
    found = evened(first, dapple.Context(), None)
    assert is_whole(found)
    check(found, after)
    assert found.report.count == 1000
    assert (away(found.positions, surface) > 0.25).all()


def test_where_many_more_are_needed_all_points_move_at_once() -> None:
    """First the many that an exact count takes away again would be added one after another."""
    surface, settings = arrays(), Settings(count=1000, density=PAINTED)
    solved = scatter(surface, settings, dapple.Context(), None)
    denser = np.where(surface.vertices[:, 2] > 0.0, 3.0, 1.0)
    found = kept(
        before_of(solved), replace(surface, weights={"Grass": denser}), settings, None, None
    )
    assert is_whole(found)
    old, _ = rows_of(solved, found)
    assert len(old) > 700
    assert measured(found, dapple.Context()).report.capacity_variation < 0.02


def test_locked_points_stay() -> None:
    surface, settings = arrays(), Settings(count=1000, density=PAINTED)
    solved = scatter(surface, settings, dapple.Context())
    rows = np.flatnonzero(away(solved.positions, surface) < 1.0)[::2]
    ids = solved.columns["id"][rows]
    locked = Locked(solved.positions[rows], ids, np.zeros(len(rows), np.int32))
    for after, count in ((painted(surface, 0.3), 1000), (surface, 1100)):
        found = updated(solved, after, replace(settings, count=count), locked=locked)
        assert found.report.count == count
        there = np.isin(found.columns["id"], ids)
        assert np.array_equal(found.columns["dapple_locked"], there)
        assert there.sum() == len(ids)
        alike = same(solved, found)[1]
        assert alike[np.isin(solved.columns["id"][rows_of(solved, found)[0]], ids)].all()


def all_locked(solved: Scattered) -> Locked:
    count = solved.report.count
    return Locked(solved.positions, solved.columns["id"], np.zeros(count, np.int32))


def test_others_come_between_points_that_are_all_locked() -> None:
    surface, settings = arrays(), Settings(count=200)
    solved = scatter(surface, settings, dapple.Context())
    more = replace(settings, count=500)
    found = updated(solved, surface, more, locked=all_locked(solved))
    assert found.report.count == 500
    old, alike = rows_of(solved, found)[0], same(solved, found)[1]
    assert len(old) == 200
    assert alike.all()
    assert found.report.alpha_min > 0.4


@pytest.mark.parametrize("settings", [Settings(count=99), Settings(per_area=1.0)])
def test_more_locked_points_than_there_shall_be_are_said(settings) -> None:
    surface = arrays()
    solved = scatter(surface, Settings(count=100), dapple.Context())
    with pytest.raises(ScatterError, match=r"100 points are locked, the count is \d+: increase"):
        updated(solved, surface, settings, locked=all_locked(solved))


def test_nothing_changed_changes_nothing() -> None:
    surface, settings = arrays(), Settings(count=500)
    solved = scatter(surface, settings, dapple.Context())
    _, alike = same(solved, updated(solved, surface, settings))
    assert len(alike) == 500
    assert alike.all()


def test_points_are_solved_anew_where_they_cannot_be_kept() -> None:
    settings = Settings(count=100)
    assert keeps(settings, ["count", "density", "per_area", "forward"], same_faces=True)
    assert not keeps(settings, [], same_faces=False)
    for name in ("seed", "tolerance", "capacity_weight", "repulsion_weight", "classes"):
        assert not keeps(settings, [name], same_faces=True)
    assert keeps(replace(settings, object_types=(ClassSettings(),)), ["count"], same_faces=True)


def test_quads_that_are_cut_along_the_other_diagonal_are_the_same_faces() -> None:
    settings = replace(BY_AREA, density=PAINTED)
    surface = arrays()
    solved = scatter(surface, settings, dapple.Context())
    faces = surface.faces.copy()
    beside = np.flatnonzero(np.isin(faces, faces[0]).sum(axis=1) == 2)[0]
    own, other = (np.setdiff1d(faces[k], faces[j])[0] for k, j in ((0, beside), (beside, 0)))
    first, second = np.intersect1d(faces[0], faces[beside])
    faces[0], faces[beside] = (own, first, other), (own, other, second)
    found = updated(solved, replace(painted(surface, 0.3), faces=faces), settings)
    check_far(solved, found, surface, 0.45)


@pytest.mark.parametrize(("removed", "reach"), [(1, 5), (3, 8), (6, 12)])
def test_where_points_were_removed_by_hand_the_others_close_the_hole(removed, reach) -> None:
    settings, surface = Settings(count=3000), arrays()
    solved = scatter(surface, settings, dapple.Context())
    stays = np.sort(np.argsort(away(solved.positions, surface))[removed:])
    columns = {name: values[stays] for name, values in solved.columns.items()}
    rows = Binding(*(getattr(solved.binding, name)[stays] for name in ROWS))
    ids = solved.columns["id"], columns["id"]
    assert solved.solved is not None
    placed = as_placed(solved.solved, ids[0], rows, ids[1], columns["dapple_object_type"])
    assert np.array_equal(placed.samples.positions, solved.positions[stays])
    before = PreviousResult(rows, columns, placed, middle(surface)[None])
    fewer = replace(settings, count=3000 - removed)
    found = kept(before, surface, fewer, dapple.Context(), None)
    assert is_whole(found)
    assert set(found.columns["id"]) == set(ids[1])
    check(found, surface)
    assert away(found.positions, surface).min() < 0.75 * solved.report.spacing
    check_far(solved, found, surface, (reach - 3) * solved.report.spacing)
    assert found.report.evaluations > 0
