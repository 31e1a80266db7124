# SPDX-License-Identifier: GPL-3.0-or-later
"""The folder of a run: finished parts are files, each complete or not written."""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .digests import is_there, read_checked, write_checked
from .layout import KINDS, Job
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
    """Where files of a run are.

    run: the digest of its plan, by which files of other runs are recognized.
    """

    path: Path
    run: str = ""

    @property
    def plan(self) -> Path:
        """File of the plan."""
        return self.path / PLAN

    @property
    def surface(self) -> Path:
        """Folder of a mesh whose faces are sorted."""
        return self.path / "surface"

    def file(self, job: Job) -> Path:
        """File of a result: a tile, or a part of one."""
        below = "tiles" if job.kind == "tile" else "work"
        return self.path / below / f"{job.name}.npz"

    def make(self) -> None:
        """Make the folders."""
        for name in ("tiles", "work"):
            (self.path / name).mkdir(parents=True, exist_ok=True)

    def key(self, job: Job) -> str:
        """What the digest of a result says of it beside its arrays."""
        return f"{self.run} {job.name}"

    def has(self, job: Job) -> bool:
        """Whether a result of this run is there and whole."""
        return is_there(self.file(job), self.key(job))

    def write(self, job: Job, result: Bound | TilePoints) -> None:
        """Store a result."""
        write_checked(self.file(job), vars(result), self.key(job))

    def read(self, job: Job) -> Bound:
        """A result that other work begins with."""
        return Bound(**read_checked(self.file(job), self.key(job)))

    def read_tile(self, row: int, column: int) -> TilePoints:
        """A finished tile."""
        job = Job("tile", row, column)
        return TilePoints(**read_checked(self.file(job), self.key(job)))

    def check_tiles(self, plan: Plan) -> None:
        """Refuse tiles beside those of a plan.

        Raises:
            ValueError: naming the first one.
        """
        names = {self.file(Job("tile", row, column)).name for row, column in plan.layout.tiles()}
        for file in sorted((self.path / "tiles").glob("tile-*.npz")):
            if file.name not in names:
                raise ValueError(
                    f"{file}: is no tile of {self.plan}: remove it, or choose another folder"
                )

    def drop(self, job: Job) -> None:
        """Remove a result that nothing needs any more."""
        self.file(job).unlink(missing_ok=True)

    def sweep(self) -> None:
        """Remove the files of killed processes, and the folder of unfinished work if it is empty.

        No process may be working."""
        left = [f"work/{kind}-*.npz" for kind in KINDS]
        for pattern in ("*/.*.part", *left):
            for part in self.path.glob(pattern):
                part.unlink(missing_ok=True)
        with suppress(OSError):
            (self.path / "work").rmdir()


@dataclass(frozen=True)
class Tiles:
    """A surface's points in a folder, tile by tile.

    made_again: files that were damaged or of another run, and were made again.
    """

    folder: Path
    made_again: tuple[Path, ...] = ()

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
            ValueError: it is damaged, or of something else.
        """
        return Folder(self.folder, self.plan().digest).read_tile(row, column)

    def tiles(self) -> Iterator[TilePoints]:
        """All tiles, row by row; each is read when it is needed."""
        plan = self.plan()
        folder = Folder(self.folder, plan.digest)
        return (folder.read_tile(r, c) for r, c in plan.layout.tiles())
