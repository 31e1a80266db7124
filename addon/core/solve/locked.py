# SPDX-License-Identifier: GPL-3.0-or-later
"""Locked points, which keep their place while the others are arranged around them."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..base.errors import ScatterError
from ..base.native import package
from ..surface.arrays import Floats, Ints


@dataclass(frozen=True)
class Locked:
    """Points that an artist has placed or wants to keep."""

    positions: Floats  # (k, 3) in world space; moved to the nearest place of the surface
    ids: Ints  # (k,)
    classes: Ints  # (k,)

    def of_classes(self, counts: list[int]) -> list["Locked | None"]:
        """The locked points of each class; those of removed classes belong to the last one.

        Raises:
            ScatterError: a class has fewer points than are locked.
        """
        kinds = np.minimum(self.classes, len(counts) - 1)
        groups = [self._only(kinds == kind) for kind in range(len(counts))]
        for number, (group, count) in enumerate(zip(groups, counts, strict=True)):
            if group is not None and len(group.ids) > count:
                where = f" of object type {number + 1}" if len(counts) > 1 else ""
                raise ScatterError(
                    f"{len(group.ids):,} points{where} are locked, the count is {count:,}: "
                    "increase it, or unlock some"
                )
        return groups

    def samples(self, surface: Any) -> Any:
        """dapple.Samples at the nearest places of a dapple.Surface."""
        places = package().project(surface, self.positions)
        return package().Samples(surface, places.faces, places.barycentric)

    def _only(self, chosen: Any) -> "Locked | None":
        if not chosen.any():
            return None
        return Locked(self.positions[chosen], self.ids[chosen], self.classes[chosen])


def rows_of(locked: Locked, classes: Ints) -> Ints:
    """Rows (k,) of locked points among samples of these classes, in the order of the rows."""
    counts = np.bincount(classes)
    begin = np.concatenate([[0], np.cumsum(counts)])
    groups = locked.of_classes(counts.tolist())
    rows = [begin[k] + np.arange(len(one.ids)) for k, one in enumerate(groups) if one is not None]
    found: Ints = np.concatenate(rows).astype(np.int32)
    return found


def kept_ids(locked: Locked, classes: Ints) -> Ints:
    """Ids (n,) of samples of these classes: locked points keep theirs, others get the rest.

    A copy of a locked point gets a new id.
    """
    groups = locked.of_classes(np.bincount(classes).tolist())
    wanted = np.concatenate([one.ids for one in groups if one is not None])
    rows = rows_of(locked, classes)
    ids = np.full(len(classes), -1, dtype=np.int32)
    _, first = np.unique(wanted, return_index=True)
    mine = first[wanted[first] >= 0]
    ids[rows[mine]] = wanted[mine]
    free = np.setdiff1d(np.arange(len(classes) + len(wanted), dtype=np.int32), wanted)
    others = np.flatnonzero(ids < 0)
    ids[others] = free[: len(others)]
    return ids
