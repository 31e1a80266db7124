# SPDX-License-Identifier: GPL-3.0-or-later
"""Work that goes on in a folder: only with what it was begun with, whatever became of its files."""

import json
import shutil
from dataclasses import dataclass
from pathlib import Path

import dapple3d as dapple
import numpy as np
import pytest
import shapes
from command_line import done, refused
from dapple3d.extras.distributed import HeightField, Tiles, open_surface, sample_tiles
from dapple3d.extras.distributed.digests import write_checked
from test_tiles import TILE, contents, gathered, hills

COUNT = 4_000
HEIGHTS = np.array(hills(60, 80).heights)


def made(folder: Path, field=None, **given) -> Tiles:
    field = HeightField(HEIGHTS) if field is None else field
    return sample_tiles(field, folder, **{"count": COUNT, "tile": TILE} | given)


def tile_of(folder: Path, column: int = 0) -> Path:
    return folder / "tiles" / f"tile-0000-{column:04d}.npz"


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    """Two tiles of a terrain."""
    folder = tmp_path_factory.mktemp("whole")
    made(folder)
    return folder


@pytest.fixture
def folder(whole, tmp_path) -> Path:
    """The same, to be damaged."""
    return Path(shutil.copytree(whole, tmp_path / "copy"))


def without_first(folder: Path) -> Path:
    tile_of(folder).unlink()
    return folder


@pytest.mark.parametrize(
    ("field", "told"),
    [
        (HeightField(HEIGHTS + 50), "surface heights of other numbers in the rows 0:3"),
        (HeightField(np.where(np.arange(60)[:, None] == 40, 1.0, HEIGHTS)), "in the rows 37:41"),
        (HeightField(HEIGHTS, (2.0, 1.0)), r"surface step \[1.0, 1.0\], not \[2.0, 1.0\]"),
        (HeightField(HEIGHTS, origin=(5.0, 0.0)), "surface origin"),
        (HeightField(HEIGHTS, density=np.ones((60, 80))), "surface density False, not True"),
        (HeightField(HEIGHTS[:50]), r"surface shape \[60, 80\], not \[50, 80\]"),
    ],
    ids=["heights", "a row", "step", "origin", "density", "shape"],
)
def test_a_run_does_not_go_on_with_another_terrain(folder, field, told):
    before = contents(without_first(folder))
    with pytest.raises(ValueError, match=rf"copy: holds tiles with .*{told}.*: remove it, or"):
        made(folder, field)
    assert contents(folder) == before


def test_a_run_does_not_go_on_with_another_density(tmp_path):
    density = np.ones((60, 80))
    made(tmp_path, HeightField(HEIGHTS, density=density))
    density[7, 7] = 2.0
    with pytest.raises(ValueError, match=r"surface density of other numbers in the rows 7:11"):
        made(tmp_path, HeightField(HEIGHTS, density=density))


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"seed": 1}, "seed 0, not 1"),
        ({"count": COUNT + 1}, "count 4000, not 4001"),
        ({"tile": 3_000}, "tile 2000, not 3000"),
        ({"tolerance": 1e-2}, "tolerance .*, not 0.01"),
        ({"cells": "euclidean"}, "cells .*, not euclidean"),
    ],
)
def test_a_run_does_not_go_on_with_other_settings(folder, given, told):
    without_first(folder)
    with pytest.raises(ValueError, match=rf"holds tiles with {told}: remove it"):
        made(folder, **given)


def test_an_option_that_is_given_as_its_default_is_no_other_one(folder, whole):
    default = next(o.default for o in dapple.option_table("sample") if o.name == "tolerance")
    made(without_first(folder), tolerance=np.float64(default))
    assert contents(folder) == contents(whole)


def test_the_same_terrain_by_another_name_and_type_goes_on(folder, whole, tmp_path):
    np.save(tmp_path / "other name.npy", np.asfortranarray(HEIGHTS))
    made(without_first(folder), tmp_path / "other name.npy")
    assert contents(folder) == contents(whole)


def truncated(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-1000])


def emptied(path: Path) -> None:
    path.write_bytes(b"")


def flipped(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[len(content) // 3] ^= 1
    path.write_bytes(content)


def exchanged(path: Path) -> None:
    path.write_bytes(tile_of(path.parents[1], 1).read_bytes())


def saved_anew(path: Path) -> None:
    """The same arrays, but moved, as by a script."""
    arrays = dict(np.load(path))
    np.savez(path, **arrays | {"positions": arrays["positions"] + 1.0})


def of_another_run(path: Path) -> None:
    write_checked(path, dict(np.load(path)), "another run tile-0000-0000")


def with_fewer_points(path: Path) -> None:
    np.savez(path, **{name: values[:-1] for name, values in np.load(path).items()})


def of_text(path: Path) -> None:
    path.write_text("no archive")


DAMAGES = [truncated, emptied, flipped, exchanged, saved_anew, of_another_run, of_text]


@pytest.mark.parametrize("damage", [*DAMAGES, with_fewer_points])
def test_a_tile_that_is_not_what_was_made_is_made_again(folder, whole, damage):
    damage(tile_of(folder))
    tiles = made(folder)
    assert tiles.made_again == (tile_of(folder),)
    assert contents(folder) == contents(whole)
    assert gathered(tiles, "ids").tolist() == list(range(COUNT))
    assert made(folder).made_again == ()


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_tile_that_is_not_what_was_made_is_not_read(folder, damage):
    damage(tile_of(folder))
    with pytest.raises(ValueError, match=r"tile-0000-0000\.npz: (could not be read|was changed)"):
        list(Tiles(folder).tiles())


@pytest.mark.parametrize("damage", [truncated, emptied, flipped, of_text])
def test_unfinished_work_that_is_damaged_is_done_again(whole, tmp_path, damage):
    context = dapple.Context()

    class Stopping(HeightField):
        reads = 0

        def read(self, rows, columns):
            type(self).reads += 1
            if self.reads == 6:
                context.cancel()
            return super().read(rows, columns)

    with pytest.raises(dapple.Cancelled):
        made(tmp_path, Stopping(HEIGHTS), context=context)
    left = sorted((tmp_path / "work").glob("*.npz"))
    assert left
    for path in left:
        damage(path)
    assert set(made(tmp_path).made_again) == set(left)
    assert contents(tmp_path) == contents(whole)
    assert not (tmp_path / "work").exists()


def test_a_tile_of_another_layout_is_named(folder):
    shutil.copy(tile_of(folder), folder / "tiles" / "tile-0007-0000.npz")
    with pytest.raises(ValueError, match=r"tile-0007-0000\.npz: is no tile of .*plan\.json"):
        made(folder)


def edited(folder: Path, **changes) -> None:
    path = folder / "plan.json"
    document = json.loads(path.read_text())
    path.write_text(json.dumps(document | changes))


def test_a_plan_without_an_entry_is_named_with_the_first(folder):
    document = json.loads((folder / "plan.json").read_text())
    for name in document:
        rest = {key: value for key, value in document.items() if key != name}
        (folder / "plan.json").write_text(json.dumps(rest))
        wanted = r"'format' is null" if name == "format" else f"'{name}' is missing"
        with pytest.raises(ValueError, match=rf"plan\.json: cannot be used: {wanted}"):
            made(folder)
        with pytest.raises(ValueError, match=rf"plan\.json: cannot be used: {wanted}"):
            len(Tiles(folder))


@pytest.mark.parametrize("value", [None, "x", -1, 1.5, [], [[]], {}, True, 1e400, 10**30, [None]])
def test_a_plan_with_a_wrong_entry_is_named_with_it(folder, value):
    document = json.loads((folder / "plan.json").read_text())
    for name, kept in document.items():
        if value == kept or (name in ("options", "surface") and value == {}):
            continue
        (folder / "plan.json").write_text(json.dumps(document | {name: value}))
        with pytest.raises(ValueError, match=rf"plan\.json: cannot be used: '({name}|counts|di)"):
            made(folder)


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (b"", "Expecting value"),
        (b"{", "Expecting property name"),
        (b"[1, 2]", r"it holds \[1, 2\] instead of the entries of a plan"),
        (b"\xff\xfe\x00", "can't decode"),
        (b"[" * 100_000, "recursion"),
        (b'{"format": 1}', "'format' is 1: this version has 2"),
    ],
)
def test_a_plan_that_is_none_is_named(folder, content, told):
    (folder / "plan.json").write_bytes(content)
    with pytest.raises(ValueError, match=rf"plan\.json: cannot be used: .*{told}.*; remove it"):
        made(folder)


def test_a_plan_that_was_edited_is_named(folder):
    edited(folder, seed=7)
    with pytest.raises(ValueError, match="'digest' is not that of the other entries"):
        made(folder)
    edited(folder, seed=0, counts=[[1999, 2001]])
    with pytest.raises(ValueError, match=r"'digest' is not|'counts' has the sum"):
        made(folder)


def test_a_plan_that_was_removed_is_made_again_and_its_tiles_stay(folder, whole):
    (folder / "plan.json").unlink()
    assert made(without_first(folder)).made_again == ()
    assert contents(folder) == contents(whole)
    assert (folder / "plan.json").read_bytes() == (whole / "plan.json").read_bytes()


def test_tiles_of_another_terrain_beside_no_plan_are_made_again(folder):
    (folder / "plan.json").unlink()
    tiles = made(folder, HeightField(HEIGHTS + 50))
    assert len(tiles.made_again) == 2
    assert gathered(tiles, "positions")[:, 2].min() > 40


@dataclass(frozen=True)
class Own:
    """A surface of somebody else's class, that says little of itself."""

    field: HeightField
    face_count = property(lambda self: self.field.face_count)
    axes = property(lambda self: self.field.axes)

    def lines(self, rows, columns):
        return self.field.lines(rows, columns)

    def read(self, rows, columns):
        return self.field.read(rows, columns)

    def describe(self):
        return {"kind": "own", "size": np.int64(3), "corners": (1, np.float32(0.5))}


def test_another_surface_of_a_class_without_digests_is_reported_by_its_tile(tmp_path, whole):
    made(tmp_path, Own(HeightField(HEIGHTS)))
    made(without_first(tmp_path), Own(HeightField(HEIGHTS)))
    assert (
        gathered(Tiles(tmp_path), "positions").tobytes()
        == gathered(Tiles(whole), "positions").tobytes()
    )
    heights = HEIGHTS.copy()
    heights[30, 70] += 1.0
    with pytest.raises(ValueError, match="holds tiles with another surface at tile-0000-0001"):
        made(tmp_path, Own(HeightField(heights)))


def test_a_surface_that_changes_during_the_run_is_named_by_the_tile(tmp_path):
    heights = HEIGHTS.copy()

    class Changing(HeightField):
        reads = 0

        def read(self, rows, columns):
            type(self).reads += 1
            if self.reads == 4:
                heights[:, 60:] += 1.0
            return super().read(rows, columns)

    with pytest.raises(ValueError, match="tile-0000-0001: the surface has changed since the run"):
        made(tmp_path, Changing(heights))


# Meshes


def write_mesh(path: Path, bump: float = 0.0, **others) -> Path:
    vertices, faces = shapes.torus(60, 30)
    vertices = vertices + bump * (np.arange(len(vertices)) == 17)[:, None]
    np.savez(path, vertices=vertices, faces=faces, **others)
    return path


@pytest.fixture
def mesh(tmp_path) -> Path:
    return write_mesh(tmp_path / "torus.npz")


def places(folder: Path) -> bytes:
    return gathered(Tiles(folder), "positions").tobytes()


def test_a_run_does_not_go_on_with_an_edited_mesh(mesh, tmp_path):
    made(tmp_path / "out", mesh)
    before = contents(without_first(tmp_path / "out"))
    write_mesh(mesh, bump=0.01)
    with pytest.raises(ValueError, match="holds tiles with surface vertices of other numbers"):
        made(tmp_path / "out", mesh)
    assert contents(tmp_path / "out") == before
    write_mesh(mesh)
    made(tmp_path / "out", mesh)
    made(tmp_path / "whole", mesh)
    assert contents(tmp_path / "out") == contents(tmp_path / "whole")


def test_a_run_does_not_go_on_with_other_faces_or_densities(mesh, tmp_path):
    made(tmp_path / "out", mesh)
    arrays = dict(np.load(mesh))
    np.savez(mesh, **arrays | {"faces": arrays["faces"][::-1]})
    with pytest.raises(ValueError, match="surface faces of other numbers"):
        made(tmp_path / "out", mesh)
    write_mesh(mesh, density=np.ones(len(arrays["faces"])))
    with pytest.raises(ValueError, match="surface density None, not faces"):
        made(tmp_path / "out", mesh)


def test_a_mesh_that_was_written_otherwise_goes_on(mesh, tmp_path):
    made(tmp_path / "out", mesh)
    before = contents(tmp_path / "out")
    without_first(tmp_path / "out")
    np.savez_compressed(tmp_path / "small.npz", **np.load(mesh))
    made(tmp_path / "out", tmp_path / "small.npz")
    assert contents(tmp_path / "out") == before


@pytest.mark.parametrize("name", ["vertices.npy", "faces.npy", "ids.npy", "starts.npy"])
@pytest.mark.parametrize("damage", [truncated, emptied, flipped, of_text])
def test_a_sorted_mesh_that_is_damaged_is_sorted_again(mesh, tmp_path, name, damage):
    open_surface(mesh, tmp_path / "sorted")
    before = {path.name: path.read_bytes() for path in (tmp_path / "sorted").iterdir()}
    damage(tmp_path / "sorted" / name)
    open_surface(mesh, tmp_path / "sorted")
    assert {path.name: path.read_bytes() for path in (tmp_path / "sorted").iterdir()} == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["sorted", "torus.npz"]


@pytest.mark.parametrize("content", ["", "{}", "[]", '{"vertices": 3}', "no JSON"])
def test_a_sorted_mesh_whose_description_is_damaged_is_sorted_again(mesh, tmp_path, content):
    open_surface(mesh, tmp_path / "sorted")
    before = (tmp_path / "sorted" / "mesh.json").read_bytes()
    (tmp_path / "sorted" / "mesh.json").write_text(content)
    open_surface(mesh, tmp_path / "sorted")
    assert (tmp_path / "sorted" / "mesh.json").read_bytes() == before


def test_a_sorted_mesh_that_is_whole_stays(mesh, tmp_path):
    open_surface(mesh, tmp_path / "sorted")
    written = (tmp_path / "sorted" / "mesh.json").stat().st_mtime_ns
    open_surface(mesh, tmp_path / "sorted")
    assert (tmp_path / "sorted" / "mesh.json").stat().st_mtime_ns == written


def test_a_gltf_whose_numbers_are_in_another_file_is_read_again(tmp_path):
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "<f4")
    (tmp_path / "mesh.bin").write_bytes(vertices.tobytes())
    tree = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri": "mesh.bin"}],
    }
    (tmp_path / "mesh.gltf").write_text(json.dumps(tree))
    first = open_surface(tmp_path / "mesh.gltf", tmp_path / "sorted").describe()
    (tmp_path / "mesh.bin").write_bytes((2 * vertices).tobytes())
    second = open_surface(tmp_path / "mesh.gltf", tmp_path / "sorted").describe()
    assert first["content"] != second["content"]


# The command


def test_the_command_says_which_tiles_were_made_again(tmp_path):
    np.save(tmp_path / "hills.npy", HEIGHTS)
    call = ("tiles", tmp_path / "hills.npy", tmp_path / "out", "-n", COUNT, "--tile", TILE)
    done(*call)
    truncated(tile_of(tmp_path / "out", 1))
    found = done(*call, "--json", tmp_path / "report.json")
    assert f"{tile_of(tmp_path / 'out', 1)}: was damaged, and was made again\n" in found.stdout
    document = json.loads((tmp_path / "report.json").read_text())
    assert document["made_again"] == [str(tile_of(tmp_path / "out", 1))]


def test_the_command_refuses_another_terrain_and_a_damaged_plan(tmp_path):
    np.save(tmp_path / "hills.npy", HEIGHTS)
    call = ("tiles", tmp_path / "hills.npy", tmp_path / "out", "-n", COUNT, "--tile", TILE)
    done(*call)
    np.save(tmp_path / "hills.npy", HEIGHTS + 50)
    assert "holds tiles with surface heights of other numbers in the rows 0:3" in refused(*call)
    np.save(tmp_path / "hills.npy", HEIGHTS)
    (tmp_path / "out" / "plan.json").write_text("{}")
    assert "plan.json: cannot be used: 'format' is null" in refused(*call)
