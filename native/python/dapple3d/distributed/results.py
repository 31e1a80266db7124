# SPDX-License-Identifier: GPL-3.0-or-later
"""The folder of a run: what is done lies there in files, each whole or not at all."""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..reading import BROKEN, read_npz
from ..writing import replacing, write_npz
from .layout import Job
from .patches import Floats
from .plan import Plan, read_plan

PLAN = "plan.json"


@dataclass(frozen=True)
class Bound:
    """Points on faces, by their ids in increasing order.

    ids, faces: (n,) int64, faces of the whole surface. barycentric: (n, 3) float64.
    normals: (n, 3) float32.
    """

    ids: NDArray[np.int64]
    faces: NDArray[np.int64]
    barycentric: Floats
    normals: NDArray[np.float32]

    def only(self, chosen: NDArray[np.bool_]) -> "Bound":
        """The chosen points."""
        return Bound(*(values[chosen] for values in vars(self).values()))


@dataclass(frozen=True)
class TilePoints:
    """The points of a finished tile, by their ids, which no two points of the surface share.

    positions: (n, 3) float64. normals: (n, 3) float32. faces: (n,) int64, of the whole surface.
    barycentric: (n, 3) float64. ids: (n,) int64, from 0 to the number of points on the surface.
    """

    positions: Floats
    normals: NDArray[np.float32]
    faces: NDArray[np.int64]
    barycentric: Floats
    ids: NDArray[np.int64]


NO_POINTS = Bound(
    np.empty(0, np.int64), np.empty(0, np.int64), np.empty((0, 3)), np.empty((0, 3), np.float32)
)


def merged(layers: Sequence[Bound]) -> Bound:
    """All points of some results, where later ones replace what earlier ones say of a point."""
    kept: list[Bound] = []
    for layer in layers:
        kept = [k.only(~np.isin(k.ids, layer.ids)) for k in kept] + [layer]
    columns = zip(*(vars(k).values() for k in kept or [NO_POINTS]), strict=True)
    joined = Bound(*(np.concatenate(parts) for parts in columns))
    order = np.argsort(joined.ids, kind="stable")
    return Bound(*(values[order] for values in vars(joined).values()))


@dataclass(frozen=True)
class Folder:
    """Where files of a run are."""

    path: Path

    @property
    def plan(self) -> Path:
        """Of the plan."""
        return self.path / PLAN

    @property
    def surface(self) -> Path:
        """Of a mesh whose faces are sorted."""
        return self.path / "surface"

    def file(self, job: Job) -> Path:
        """Of a result: a tile, or what it is made of."""
        below = "tiles" if job.kind == "tile" else "work"
        return self.path / below / f"{job.name}.npz"

    def make(self) -> None:
        """Make the folders."""
        for name in ("tiles", "work"):
            (self.path / name).mkdir(parents=True, exist_ok=True)

    def has(self, job: Job) -> bool:
        """Whether a result is there."""
        return self.file(job).exists()

    def write(self, job: Job, result: Bound | TilePoints) -> None:
        """Store a result."""
        with replacing(self.file(job)) as file:
            write_npz(file, vars(result))

    def read(self, job: Job) -> Bound:
        """A result that other work begins with."""
        return Bound(**_arrays(self.file(job)))

    def read_tile(self, row: int, column: int) -> TilePoints:
        """A finished tile."""
        return TilePoints(**_arrays(self.file(Job("tile", row, column))))

    def drop(self, job: Job) -> None:
        """Remove a result that nothing needs any more."""
        self.file(job).unlink(missing_ok=True)

    def sweep(self) -> None:
        """Remove what killed processes have left half written, and the folder of unfinished work
        if it is empty; nobody is at work any more."""
        for part in self.path.glob("*/.*.part"):
            part.unlink(missing_ok=True)
        with suppress(OSError):
            (self.path / "work").rmdir()


def _arrays(path: Path) -> dict[str, NDArray]:
    try:
        return read_npz(path)
    except BROKEN as error:
        raise ValueError(f"{path}: could not be read: {error}") from error


@dataclass(frozen=True)
class Tiles:
    """A surface's points in a folder, tile by tile."""

    folder: Path

    def __len__(self) -> int:
        """How many points there are on the whole surface."""
        return self.plan().total

    def plan(self) -> Plan:
        """Where the tiles are."""
        return read_plan(Folder(self.folder).plan)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of tiles."""
        return self.plan().layout.shape

    def tile(self, row: int, column: int) -> TilePoints:
        """One of them.

        Raises:
            OSError: it has not been made.
        """
        return Folder(self.folder).read_tile(row, column)

    def tiles(self) -> Iterator[TilePoints]:
        """All of them, row by row, each read when it is asked for."""
        return (self.tile(r, c) for r, c in self.plan().layout.tiles())
