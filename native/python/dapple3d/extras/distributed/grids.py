# SPDX-License-Identifier: GPL-3.0-or-later
"""Grids of numbers in files, read piece by piece.

They are opened where they are read: a worker gets the path.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from .heights import HeightField
from .patches import Floats, check_real

State = tuple[int, int, int]
GRIDS = (".npy", ".zarr", ".tif", ".tiff", ".vrt")


@dataclass(frozen=True)
class StoredGrid:
    """An array of npy or Zarr, or the first band of a picture that GDAL reads."""

    path: str
    name: str = ""  # of an array in a group of Zarr

    @property
    def shape(self) -> tuple[int, ...]:
        """Rows and columns."""
        return tuple(self._open().shape)

    @property
    def dtype(self) -> np.dtype[Any]:
        """What is stored."""
        return np.dtype(self._open().dtype)

    def __getitem__(self, key: tuple[slice, slice]) -> Floats:
        return np.asarray(self._open()[key], np.float64)

    def _open(self) -> Any:
        path = Path(self.path)
        return _openers()[path.suffix.lower()](path, self.name, state_of(path))


class _Raster:
    """The first band as an array; missing values are not a number."""

    def __init__(self, path: Path) -> None:
        self.file = _rasterio().open(path)
        self.shape = self.file.shape
        # GDAL has complex integers, which NumPy lacks.
        self.dtype = complex if "complex" in self.file.dtypes[0] else self.file.dtypes[0]

    def __getitem__(self, key: tuple[slice, slice]) -> Floats:
        window = ((key[0].start, key[0].stop), (key[1].start, key[1].stop))
        found = self.file.read(1, window=window, masked=True)
        filled: Floats = np.ma.filled(found.astype(np.float64), np.nan)
        return filled


def state_of(path: Path) -> State:
    """What changes when a file is written or exchanged."""
    found = path.stat()
    return found.st_ino, found.st_size, found.st_mtime_ns


def open_grid(path: Path, name: str = "") -> StoredGrid:
    """A grid in a file.

    Raises:
        ValueError: naming what it is instead.
        OSError: there is none, or it cannot be read.
    """
    grid = StoredGrid(str(path.absolute()), name)
    try:
        shape = grid.shape
    except (ValueError, EOFError) as error:
        raise ValueError(f"{path}: could not be read: {error}") from error
    if len(shape) != 2:
        raise ValueError(f"{path}: has the shape {shape}: (rows, columns) is needed")
    check_real(f"{path}:", grid.dtype)
    return grid


def open_heights(
    path: Path, density: Path | None = None, step: tuple[float, float] | None = None
) -> HeightField:
    """A terrain in a file.

    Args:
        path: a GeoTIFF or what else GDAL reads, which says where it is; an array of npy or Zarr; or
            a group of Zarr with an array 'heights', and 'density' if there is one.
        density: a file with as many numbers.
        step: between two columns and between two rows; None is that of the file, or 1.

    Raises:
        ValueError: naming the file and what is wrong with it.
    """
    grouped = path.suffix.lower() == ".zarr" and _is_group(str(path.absolute()))
    heights = open_grid(path, "heights" if grouped else "")
    weights = open_grid(density) if density else None
    if grouped and not density and "density" in _zarr().open_group(str(path), mode="r"):
        weights = open_grid(path, "density")
    found_step, origin = (1.0, 1.0), (0.0, 0.0)
    if path.suffix.lower() not in (".npy", ".zarr"):
        found_step, origin = _place_of(path)
    try:
        return HeightField(heights, step or found_step, origin, weights, path.name)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error


def _place_of(path: Path) -> tuple[tuple[float, float], tuple[float, float]]:
    """Step and origin of a picture: a height is that in the middle of a pixel."""
    file = _Raster(path).file
    place = file.transform
    if place.b != 0.0 or place.d != 0.0:
        raise ValueError(f"{path}: is turned: rows along x are needed (gdalwarp makes them)")
    if file.crs and file.crs.is_geographic:
        raise ValueError(
            f"{path}: is in degrees, {file.crs}: heights and places need one unit (gdalwarp -t_srs)"
        )
    return (place.a, place.e), (place.c + 0.5 * place.a, place.f + 0.5 * place.e)


@lru_cache(maxsize=8)
def _open_npy(path: Path, _: str, _state: State) -> Any:
    return np.load(path, mmap_mode="r", allow_pickle=False)


@lru_cache(maxsize=8)
def _open_zarr(path: Path, name: str, _state: State) -> Any:
    if not name:
        return _zarr().open_array(path, mode="r")
    group = _zarr().open_group(path, mode="r")
    if name not in group:
        raise ValueError(f"{path}: has no array '{name}'")
    return group[name]


@lru_cache(maxsize=8)
def _open_raster(path: Path, _: str, _state: State) -> _Raster:
    return _Raster(path)


def _openers() -> dict[str, Callable[[Path, str, State], Any]]:
    rasters = dict.fromkeys((".tif", ".tiff", ".vrt"), _open_raster)
    return {".npy": _open_npy, ".zarr": _open_zarr, **rasters}


def _is_group(path: str) -> bool:
    zarr = _zarr()
    return isinstance(zarr.open(path, mode="r"), zarr.Group)


def _zarr() -> Any:
    try:
        import zarr
    except ImportError as error:
        raise ImportError(
            'Zarr needs zarr, which is missing: pip install "dapple3d[farm]"'
        ) from error
    return zarr


def _rasterio() -> Any:
    try:
        import rasterio
    except ImportError as error:
        raise ImportError(
            'GeoTIFF needs rasterio, which is missing: pip install "dapple3d[farm]"'
        ) from error
    return rasterio
