# SPDX-License-Identifier: GPL-3.0-or-later
"""Images in UDIM tiles as a density: each tile where texture coordinates point at it."""

import addon_host
import bpy
import numpy as np
import pytest
import scenes
from test_surroundings import optimized, plane

ADDON = addon_host.part("blender.surface.images")


def saved(folder, number, values, suffix="png", name="tile"):
    """A file with these gray values (rows, columns), row 0 at the bottom."""
    values = np.asarray(values, dtype=np.float32)
    rows, columns = values.shape
    image = bpy.data.images.new("Made", columns, rows, float_buffer=suffix == "exr")
    pixels = np.ones((rows, columns, 4), dtype=np.float32)
    pixels[:, :, :3] = values[:, :, None]
    image.pixels.foreach_set(pixels.ravel())
    image.filepath_raw = str(folder / f"{name}.{number}.{suffix}")
    image.file_format = "OPEN_EXR" if suffix == "exr" else "PNG"
    image.save()
    bpy.data.images.remove(image)


def tiled(folder, tiles, suffix="png", token="<UDIM>"):
    """An image of tiles by their numbers."""
    for number, values in tiles.items():
        saved(folder, number, values, suffix)
    first = min(tiles)
    image = bpy.data.images.load(str(folder / f"tile.{first}.{suffix}"))
    image.source = "TILED"
    image.filepath = str(folder / f"tile.{token}.{suffix}")
    image.reload()
    assert sorted(tile.number for tile in image.tiles) == sorted(tiles)
    return image


def scattered(across=2, up=1, count=200):
    """A plane from -1 to 1 whose texture coordinates reach over so many tiles."""
    surface = plane()
    layer = surface.data.uv_layers[0]
    places = np.empty(2 * len(surface.data.loops), dtype=np.float32)
    layer.uv.foreach_get("vector", places)
    layer.uv.foreach_set("vector", (places.reshape(-1, 2) * (across, up)).ravel())
    return scenes.scattered(surface, count=count)


BLACK, WHITE = np.zeros((16, 16)), np.ones((16, 16))


@pytest.mark.parametrize("suffix", ["png", "exr"])
def test_each_tile_lies_where_coordinates_point_at_it(tmp_path, suffix):
    image = tiled(tmp_path, {1001: BLACK, 1002: WHITE, 1011: WHITE, 1012: BLACK}, suffix)
    found = optimized(scattered(2, 2), image=image)
    assert len(found) == 200
    products = found[:, 0] * found[:, 1]
    assert products.max() < 0.01  # the two white quarters, up to a share of the spacing
    assert abs(int((found[:, 0] > 0.0).sum()) - 100) < 5


def test_there_is_no_point_where_there_is_no_tile(tmp_path):
    found = optimized(scattered(4, 2), image=tiled(tmp_path, {1001: WHITE, 1013: WHITE}))
    lower = (found[:, 0] < -0.49) & (found[:, 1] < 0.01)
    upper = (found[:, 0] > -0.01) & (found[:, 0] < 0.51) & (found[:, 1] > -0.01)
    assert (lower | upper).all()
    assert abs(int(lower.sum()) - 100) < 6


def test_tiles_have_sizes_of_their_own(tmp_path):
    half = np.zeros((8, 32))
    half[:, 16:] = 1.0
    image = tiled(tmp_path, {1001: np.zeros((4, 4)), 1002: half})
    found = optimized(scattered(), image=image)
    assert found[:, 0].min() > 0.48


def test_packed_tiles_are_read(tmp_path):
    image = tiled(tmp_path, {1001: BLACK, 1002: WHITE})
    image.pack()
    for path in tmp_path.iterdir():
        path.unlink()
    assert optimized(scattered(), image=image)[:, 0].min() > -0.01


def test_what_is_painted_counts_before_it_is_saved(tmp_path):
    image = tiled(tmp_path, {1001: BLACK, 1002: WHITE})
    image.pixels.foreach_set(np.ones(16 * 16 * 4, dtype=np.float32))
    assert image.is_dirty
    found = optimized(scattered(), image=image)
    assert abs(int((found[:, 0] < 0.0).sum()) - 100) < 6
    assert image.is_dirty
    assert image.filepath == str(tmp_path / "tile.<UDIM>.png")


def test_a_tile_without_a_file_is_named(tmp_path):
    image = tiled(tmp_path, {1001: WHITE, 1002: WHITE})
    (tmp_path / "tile.1002.png").unlink()
    obj = scattered()
    obj.dapple.density.image = image
    with pytest.raises(RuntimeError, match="has no pixels in tile 1002: its file may be missing"):
        bpy.ops.dapple.optimize()


def test_a_surface_beside_all_tiles_is_refused(tmp_path):
    obj = scattered()
    obj.dapple.density.image = tiled(tmp_path, {1005: WHITE})
    with pytest.raises(RuntimeError, match=r"points at none of the image's tiles \(1005\)"):
        bpy.ops.dapple.optimize()


def test_another_picture_in_a_later_tile_is_noticed(tmp_path):
    image = tiled(tmp_path, {1001: WHITE, 1002: WHITE})
    before = ADDON.picture_digest(image)
    assert ADDON.picture_digest(image) == before
    saved(tmp_path, 1002, BLACK)
    image.reload()
    assert ADDON.picture_digest(image) != before


def test_reading_tiles_leaves_the_file_as_it_was(tmp_path):
    image = tiled(tmp_path, {1001: WHITE, 1002: WHITE})
    names = [one.name for one in bpy.data.images]
    assert [one.tile for one in ADDON.read_images(image.name)] == [1001, 1002]
    assert [one.name for one in bpy.data.images] == names
