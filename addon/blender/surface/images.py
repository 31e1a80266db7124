# SPDX-License-Identifier: GPL-3.0-or-later
"""Pixels of images.

Blender only provides the pixels of the first UDIM tile. Other tiles are read from their files, from
packed data or, if they were painted, from a copy that Blender saves.
"""

import ctypes
import tempfile
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray

from ...core.base.errors import ScatterError
from ...core.surface.mesh_snapshot import RawImage
from ...core.surface.sources import digest_of
from .scene_objects import by_full_name

FIRST, ACROSS = 1001, 10  # of UDIM tiles: number 1001 + u + 10 v
Pixels = NDArray[np.float32]  # (rows, columns, channels), row 0 at the bottom
_SAVES_COPIES = (4, 4, 0)  # Blender can save a copy of an image since then


def read_images(name: str) -> Iterator[RawImage]:
    """The pixels of an image, or of each UDIM tile in turn; ScatterError if there are none.

    They are oriented as Blender shows them: it ignores the orientation stored in photos.
    """
    image = by_full_name(bpy.data.images, name)
    if image is None:
        raise ScatterError(f"There is no image '{name}'")
    if image.source == "TILED":
        for number, pixels in tile_pixels(image, name):
            yield RawImage(name, pixels, number)
        return
    pixels = pixels_of(image)
    if not pixels.size:
        raise ScatterError(f"Image '{name}' has no pixels: its file may be missing")
    yield RawImage(name, pixels)


def is_film(name: str) -> bool:
    """Whether the pixels of an image depend on the frame."""
    image = by_full_name(bpy.data.images, name)
    return image is not None and image.source in ("SEQUENCE", "MOVIE")


def picture_digest(image: bpy.types.Image) -> str:
    """Digest of all pixels of an image; empty if one of its tiles cannot be read."""
    if image.source != "TILED":
        return digest_of([pixels_of(image)])
    try:
        tiles = list(tile_pixels(image, image.name))
    except ScatterError:
        return ""
    return digest_of([np.array([number for number, _ in tiles]), *(one for _, one in tiles)])


def pixels_of(image: bpy.types.Image) -> Pixels:
    """The pixels of an image, or of its first tile; none if its file is missing."""
    width, height = image.size
    stored = np.empty(width * height * image.channels, dtype=np.float32)
    if len(stored):
        image.pixels.foreach_get(stored)
    return stored.reshape(height, width, image.channels)


def tile_pixels(image: bpy.types.Image, name: str) -> Iterator[tuple[int, Pixels]]:
    """Number and pixels of each UDIM tile in turn.

    Raises:
        ScatterError: a tile has no pixels.
    """
    numbers = [tile.number for tile in image.tiles]
    with tempfile.TemporaryDirectory(prefix="dapple-") as folder:
        files = _files(image, numbers, Path(folder))
        for index, number in enumerate(numbers):
            found = _read(files[number], image) if index else pixels_of(image)
            if not found.size:
                raise ScatterError(
                    f"Image '{name}' has no pixels in tile {number}: its file may be missing or "
                    "not saved yet"
                )
            yield number, found


def _files(image: bpy.types.Image, numbers: list[int], folder: Path) -> dict[int, Path]:
    """Paths from which the tiles can be read, by their numbers."""
    files = {number: _named(image, number) for number in numbers}
    for packed in image.packed_files:
        files[packed.tile_number] = folder / f"packed.{packed.tile_number}"
        files[packed.tile_number].write_bytes(packed.packed_file.data)
    if image.is_dirty and bpy.app.version >= _SAVES_COPIES:
        with suppress(RuntimeError):  # a tile without pixels; the others can be read
            image.save(filepath=str(folder / "painted.<UDIM>"), save_copy=True)
        painted = {number: folder / f"painted.{number}" for number in numbers}
        files |= {number: path for number, path in painted.items() if path.exists()}
    return files


def _named(image: bpy.types.Image, number: int) -> Path:
    """The file of a tile, according to the file name pattern of its image."""
    down, across = divmod(number - FIRST, ACROSS)
    named = image.filepath.replace("<UDIM>", str(number))
    named = named.replace("<UVTILE>", f"u{across + 1}_v{down + 1}")
    return Path(bpy.path.abspath(named, library=image.library))


def _read(path: Path, like: bpy.types.Image) -> Pixels:
    """The pixels of a file, read with the settings of an image; empty if that is impossible.

    The image is loaded outside the scene's data, so that no one is notified of a change.
    """
    none = np.empty((0, 0, 4), dtype=np.float32)
    if not path.is_file():
        return none
    with bpy.data.temp_data() as data:
        # Blender frees these data once for its own context manager and once for this name.
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(data))
        try:
            image = data.images.load(str(path))
        except RuntimeError:
            return none
        image.colorspace_settings.name = like.colorspace_settings.name
        image.alpha_mode = like.alpha_mode
        found = pixels_of(image)
        data.images.remove(image)
        return found
