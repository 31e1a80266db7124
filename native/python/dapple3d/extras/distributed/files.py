# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces from files, by the extension."""

import os
from pathlib import Path

from .grids import GRIDS, open_heights
from .meshes import sorted_mesh
from .patches import Tileable


def open_surface(
    path: str | os.PathLike[str],
    work: str | os.PathLike[str],
    *,
    density: str | os.PathLike[str] | None = None,
    step: tuple[float, float] | None = None,
) -> Tileable:
    """A surface in a file, for sample_tiles().

    Args:
        path: a terrain: GeoTIFF (.tif, .tiff, .vrt), an array of .npy or .zarr, a group of .zarr
            with 'heights' and perhaps 'density'. Or a mesh: .npz with 'vertices', 'faces' and
            perhaps 'density', .ply perhaps with a property 'density' of the vertices or
            faces, .obj, .stl, .off, .glb and .gltf.
        work: a folder for the faces of a mesh, sorted by position; made if it is missing, and
            reused if it exists.
        density: a file with a number for each height of a terrain.
        step: distance between columns and between rows, for a terrain that does not store it.

    Raises:
        ValueError: naming the file and what is wrong with it.
        ImportError: the package that reads it is missing.
    """
    path = Path(path)
    if path.suffix.lower() in GRIDS:
        return open_heights(path, Path(density) if density else None, step)
    if density or step:
        raise ValueError(f"{path}: is a mesh, which has no step and brings its own density")
    return sorted_mesh(path, Path(work))
