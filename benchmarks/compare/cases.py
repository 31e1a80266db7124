# SPDX-License-Identifier: GPL-3.0-or-later
"""What the comparisons run on: meshes, densities, counts, seeds."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import dapple3d as dapple
import numpy as np
from numpy.typing import NDArray

ROOT = Path(__file__).resolve().parents[2]
SUFFIXES = {".obj", ".off", ".ply", ".stl"}
REST_POSE = "rest"  # a file of this name stands for the folder of an animation


def mesh_folder() -> Path:
    """The folder of real meshes, as the tests find it: $DAPPLE_DATA/meshes or shared/ next door."""
    return Path(os.environ.get("DAPPLE_DATA") or ROOT.parent / "shared" / "data") / "meshes"


def mesh_files(folder: Path) -> dict[str, Path]:
    """Meshes by name: those in the folder, and the rest poses in the folders below."""
    files = [file for file in sorted(folder.glob("*")) if file.suffix in SUFFIXES]
    found = {file.stem: file for file in files}
    for file in sorted(folder.glob(f"*/{REST_POSE}.*")):
        if file.suffix in SUFFIXES:
            found[file.parent.name] = file
    return found


def ramp(vertices: NDArray[np.float64], ratio: float) -> NDArray[np.float64] | None:
    """Density per vertex (v,): from 1 to `ratio` along the mesh's longest axis; None for ratio 1.

    It is ratio^t for t in [0, 1], so the spacing shrinks by the same factor over equal distances.
    """
    if ratio == 1.0:
        return None
    extent = np.ptp(vertices, axis=0)
    axis = int(np.argmax(extent))
    t = (vertices[:, axis] - vertices[:, axis].min()) / extent[axis]
    return np.asarray(ratio**t)


@dataclass(frozen=True)
class Case:
    """One row of a table: a mesh with its density, and how many samples to place."""

    mesh: str
    ratio: float  # largest over smallest density
    count: int
    surface: dapple.Surface

    @property
    def names(self) -> list[str]:
        return [self.mesh, f"1:{self.ratio:g}", f"{self.count:,}"]


def cases(files: dict[str, Path], ratios: list[float], counts: list[int]) -> Iterator[Case]:
    """Each mesh with each density and count; a mesh is read only when its turn comes."""
    for name, file in files.items():
        vertices, faces = dapple.read_mesh(file)
        for ratio in ratios:
            surface = dapple.Surface(vertices, faces, ramp(vertices, ratio))
            for count in counts:
                yield Case(name, ratio, count, surface)
