# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces that are solved tile by tile."""

from pathlib import Path

import dapple3d as dapple
import numpy as np
import pytest
from dapple3d.extras.distributed import HeightField, Patch, Tiles, sample_tiles
from dapple3d.extras.distributed.plan import allot

TILE = 2_000  # the smallest


def hills(rows=100, columns=100, **given):
    y, x = np.mgrid[:rows, :columns].astype(float)
    return HeightField(6 * np.sin(x / 19) * np.cos(y / 17) + np.sin(x / 7 + 1), **given)


def whole(field) -> Patch:
    return field.read((-np.inf, np.inf), (-np.inf, np.inf))


def gathered(tiles: Tiles, name: str):
    """An array of all tiles, by the points' ids."""
    order = np.argsort(np.concatenate([tile.ids for tile in tiles.tiles()]))
    return np.concatenate([getattr(tile, name) for tile in tiles.tiles()])[order]


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in (folder / "tiles").iterdir()}


def on_one_surface(field, tiles: Tiles) -> tuple[dapple.Surface, dapple.Samples]:
    patch = whole(field)
    surface = dapple.Surface(patch.vertices, patch.faces)
    if patch.density is not None:
        surface = surface.with_density(patch.density, density_at=patch.density_at)
    faces = patch.find(gathered(tiles, "faces"))
    return surface, dapple.Samples(surface, faces, gathered(tiles, "barycentric"))


def near_seams(tiles: Tiles, positions, reach):
    layout = tiles.plan().layout
    near = np.zeros(len(positions), bool)
    for axis, lines in zip(layout.axes, (layout.rows, layout.columns), strict=True):
        for line in lines[1:-1]:
            near |= np.abs(positions[:, axis] - line) < reach
    return near


@pytest.fixture(scope="module")
def four(tmp_path_factory):
    """Four tiles of a terrain."""
    return sample_tiles(hills(), tmp_path_factory.mktemp("four"), 8_000, tile=TILE)


def test_all_tiles_together_have_exactly_as_many_points_as_asked(four):
    assert four.shape == (2, 2)
    assert len(four) == 8_000
    assert gathered(four, "ids").tolist() == list(range(8_000))


def test_points_lie_on_the_faces_of_their_tile(four):
    patch = whole(hills())
    layout = four.plan().layout
    for (row, column), tile in zip(layout.tiles(), four.tiles(), strict=True):
        places = patch.points(patch.find(tile.faces), tile.barycentric)
        assert np.array_equal(places, tile.positions)
        for axis, lines, k in ((1, layout.rows, row), (0, layout.columns, column)):
            assert tile.positions[:, axis].min() >= lines[k]
            assert tile.positions[:, axis].max() <= lines[k + 1]


@pytest.mark.parametrize("tiles", [2, 3])
def test_points_beside_seams_are_as_even_as_those_of_one_solution(tmp_path, tiles):
    count, field = TILE * tiles**2, hills(50 * tiles, 50 * tiles)
    done = sample_tiles(field, tmp_path, count, tile=TILE)
    assert done.shape == (tiles, tiles)
    surface, samples = on_one_surface(field, done)
    single = dapple.sample(surface, count)
    reach = 4 * surface.spacing(count)
    variations = []
    for points in (samples, single):
        near = near_seams(done, points.positions, reach)
        owned = dapple.evaluate_energy(surface, points.positions, points.faces).capacities[near]
        variations.append(owned.std() / (surface.capacity / count))
        assert owned.mean() == pytest.approx(surface.capacity / count, rel=0.005)
    assert variations[0] < variations[1] + 0.003
    report = dapple.analyze(surface, samples)
    assert report.alpha_min > single.report.alpha_min - 0.05
    assert report.bond_order == pytest.approx(single.report.bond_order, abs=0.03)


def test_a_tile_that_is_removed_is_made_again_to_the_same_bytes(tmp_path):
    sample_tiles(hills(), tmp_path, 8_000, tile=TILE)
    before = contents(tmp_path)
    (tmp_path / "tiles" / "tile-0000-0001.npz").unlink()
    sample_tiles(hills(), tmp_path, 8_000, tile=TILE)
    assert contents(tmp_path) == before


def test_a_run_that_was_stopped_goes_on_to_the_same_bytes(tmp_path, four):
    context = dapple.Context()

    class Stopping(HeightField):
        """Stops the run when it has been read so often."""

        reads = 0

        def read(self, rows, columns):
            type(self).reads += 1
            if self.reads == 12:
                context.cancel()
            return super().read(rows, columns)

    with pytest.raises(dapple.Cancelled):
        sample_tiles(Stopping(hills().heights), tmp_path, 8_000, tile=TILE, context=context)
    done = list((tmp_path / "work").iterdir())
    assert done
    sample_tiles(hills(), tmp_path, 8_000, tile=TILE)
    assert contents(tmp_path) == contents(four.folder)


def test_threads_do_not_change_a_byte(tmp_path, four):
    sample_tiles(hills(), tmp_path, 8_000, tile=TILE, threads=1)
    assert contents(tmp_path) == contents(four.folder)


def test_nothing_is_left_of_the_work_when_all_tiles_are_there(four):
    assert not (four.folder / "work").exists()


def test_a_folder_with_other_tiles_is_refused(four):
    with pytest.raises(ValueError, match="holds tiles with seed 0, not 1"):
        sample_tiles(hills(), four.folder, 8_000, tile=TILE, seed=1)
    with pytest.raises(ValueError, match="holds tiles with count 8000, not 9000"):
        sample_tiles(hills(), four.folder, 9_000, tile=TILE)
    with pytest.raises(ValueError, match="holds tiles with surface"):
        sample_tiles(hills(90), four.folder, 8_000, tile=TILE)


def test_a_density_is_followed_across_tiles(tmp_path):
    x = np.broadcast_to(np.linspace(1.0, 4.0, 100), (100, 100))
    field = hills(density=x)
    tiles = sample_tiles(field, tmp_path, 8_000, tile=TILE)
    surface, samples = on_one_surface(field, tiles)
    assert dapple.analyze(surface, samples).capacity_variation < 0.015
    assert dapple.analyze(surface, samples).alpha_min > 0.55


def test_missing_heights_get_no_points(tmp_path):
    heights = np.array(hills().heights)
    heights[30:60, 40:70] = np.nan
    tiles = sample_tiles(HeightField(heights), tmp_path, 8_000, tile=TILE)
    places = gathered(tiles, "positions")
    x, y = places[:, 0], places[:, 1]
    assert not ((y > 30) & (y < 59) & (x > 40) & (x < 69)).any()
    assert len(places) == 8_000


def test_a_map_with_north_above_has_its_normals_upward(tmp_path):
    north_up = hills(step=(2.0, -2.0), origin=(500_000.0, 5_000_000.0))
    tiles = sample_tiles(north_up, tmp_path, 8_000, tile=TILE)
    assert gathered(tiles, "normals")[:, 2].min() > 0.0
    assert gathered(tiles, "positions")[:, 1].max() <= 5_000_000.0


def test_a_surface_that_is_smaller_than_a_tile_is_one_tile(tmp_path):
    tiles = sample_tiles(hills(), tmp_path, 500)
    assert tiles.shape == (1, 1)
    assert gathered(tiles, "ids").tolist() == list(range(500))


def test_counts_follow_the_masses_tile_by_tile_and_in_sum():
    masses = np.random.default_rng(0).random((7, 5))
    counts = allot(masses, 12_345)
    shares = masses / masses.sum() * 12_345
    assert counts.sum() == 12_345
    assert np.abs(counts - shares).max() < 1.0
    in_rows = (counts - shares).sum(axis=1).cumsum()
    assert np.abs(in_rows).max() < 1.0


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"count": 0}, "count is 0"),
        ({"tile": 100}, "tile is 100: 2000 points at least"),
    ],
)
def test_what_cannot_be_is_refused_before_the_work(tmp_path, given, message):
    with pytest.raises(ValueError, match=message):
        sample_tiles(hills(), tmp_path / "none", **{"count": 8_000, "tile": TILE} | given)
    assert not (tmp_path / "none").exists()


@pytest.mark.parametrize("surface", [None, np.zeros((9, 9)), 3])
def test_what_is_no_surface_is_refused(tmp_path, surface):
    with pytest.raises(TypeError, match=r"surface is a \w+: a HeightField, a file or another"):
        sample_tiles(surface, tmp_path / "none", 8_000)
    assert not (tmp_path / "none").exists()


def test_an_unknown_option_is_refused(tmp_path):
    with pytest.raises(TypeError, match="no option 'tolerence'"):
        sample_tiles(hills(), tmp_path, 8_000, tolerence=1e-4)
    with pytest.raises(TypeError, match="no option 'locked'"):
        sample_tiles(hills(), tmp_path, 8_000, locked=None)


def test_a_field_that_is_no_grid_is_refused():
    with pytest.raises(ValueError, match=r"heights has the shape \(5,\)"):
        HeightField(np.zeros(5))
    with pytest.raises(ValueError, match="density has the shape"):
        HeightField(np.zeros((5, 5)), density=np.ones((4, 5)))
    with pytest.raises(ValueError, match="step is"):
        HeightField(np.zeros((5, 5)), step=(1.0, 0.0))
    with pytest.raises(ValueError, match="origin is"):
        HeightField(np.zeros((5, 5)), origin=(np.nan, 0.0))
    with pytest.raises(ValueError, match="heights holds complex128: real numbers are needed"):
        HeightField(np.zeros((5, 5), complex))
    with pytest.raises(ValueError, match="density holds str32: real numbers are needed"):
        HeightField(np.zeros((5, 5)), density=np.full((5, 5), "a"))


@pytest.mark.parametrize("value", [-1.0, np.nan, np.inf])
def test_a_density_that_cannot_be_is_named_by_its_row_and_column(tmp_path, value):
    density = np.ones((100, 100))
    density[70, 80] = value
    wrong = rf"density\[70, 80\] is {value:g}: it must be finite and >= 0"
    with pytest.raises(ValueError, match=wrong):
        sample_tiles(hills(density=density), tmp_path, 8_000, tile=TILE)


def test_a_tile_that_cannot_be_solved_is_named_by_its_file(tmp_path):
    needles = HeightField(hills().heights, step=(1e-30, 1e-30))
    with pytest.raises(ValueError, match=r"^tile-0000-0000: faces have no area"):
        sample_tiles(needles, tmp_path, 8_000, tile=TILE)


def test_a_count_that_is_not_whole_is_refused(tmp_path):
    for count in (8_000.5, "8000", None):
        with pytest.raises(TypeError, match=r"count is .*: a whole number is needed"):
            sample_tiles(hills(), tmp_path, count, tile=TILE)


def test_a_surface_without_density_is_refused(tmp_path):
    with pytest.raises(ValueError, match="no face with an area and a density above 0"):
        sample_tiles(hills(density=np.zeros((100, 100))), tmp_path, 8_000, tile=TILE)


def test_what_a_killed_process_has_left_is_in_nobodys_way(tmp_path, four, monkeypatch):
    """One machine's process has the number of another's, as in containers."""
    for name in ("work", "tiles"):
        (tmp_path / name).mkdir()
    monkeypatch.setattr("os.getpid", lambda: 7)
    for job in ("work/.first-0000-0000", "tiles/.tile-0000-0000"):
        (tmp_path / f"{job}.npz.7.part").write_bytes(b"half")
    sample_tiles(hills(), tmp_path, 8_000, tile=TILE)
    assert contents(tmp_path) == contents(four.folder)
    assert not (tmp_path / "work").exists()
