# SPDX-License-Identifier: GPL-3.0-or-later
"""A bake at a constant density per area: points appear where the surface grows, others vanish.

Every point that is ever there has a row in every key, in the order in which they appear, so that
instances keep their identity. `gone` of a row is 1 - fade: 0 for one that is there, 1 for one that
is not there yet or no more.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from .bake import Baker
from .binding import faces_with_corners
from .errors import ScatterError
from .frames import carried
from .ground import Ground
from .keys import Placed, padded
from .kinds import of_classes
from .lean import leaning
from .native import package
from .records import Binding, Columns
from .sidecar import Solved
from .solve import named, point_columns, report_of
from .surface import Floats, Ints, SurfaceArrays


@dataclass(frozen=True)
class Born:
    """Points that appear during a bake, where they appear."""

    binding: Binding  # on the first topology
    positions: Floats  # (k, 3) in world space
    columns: Columns  # named as in POINT_ATTRIBUTES and ADDED_ATTRIBUTES


@dataclass
class PopulationBaker(Baker):
    """Bakes births and deaths; frames are not kept in files before the end."""

    at_seam = False  # the package finds where each point goes on
    fade: int = 12  # frames that a point takes to appear or to vanish

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.start.settings.classes:  # which the package follows on the same faces only
            self.rebind, self.remedy = False, "Set Population to Keep Count"
        self.ids = np.asarray(self.start.ids, dtype=np.int32)
        self._population: Any = None
        self._faces = np.zeros(0, dtype=np.int32)  # of all rows so far
        self._births: list[tuple[Binding, Floats, Ints]] = []  # places and classes

    def cross(self, before: SurfaceArrays, after: SurfaceArrays) -> None:
        """Bind all rows to the new topology, those too that are not there."""
        super().cross(before, after)
        self._faces = faces_with_corners(self.last.corners, after.faces)
        self._ground = None

    def advance(self, context: Any) -> None:
        """Solve the frame."""
        with named(self.bound.name):
            if self._population is None:
                options = self.start.settings.tracker_options()
                samples = self._begin()
                options |= of_classes(self._ground, samples, self.start.settings)
                self._population = package().Population(
                    self._ground.surface, samples, fade=self.fade, **options
                )
            samples = self._population.advance(self._surface(), context=context)
            samples = self._ground.back(samples)
        self._add(Solved(self._rows(samples), report_of(samples.report)))

    def _surface(self) -> Any:
        """Vertices of the ground in the frame, or a dapple.Surface where its faces are others."""
        if self._ground is None:
            self._ground = Ground(self.bound, self.start.settings)
            return self._ground.surface
        return self._ground.vertices(self._now.vertices)

    def born(self) -> Born | None:
        """The points that were not there at the start."""
        first = len(self.start.ids)
        ids = self.ids[first:]
        if not len(ids):
            return None
        bindings, places, classes = zip(*self._births, strict=True)
        columns = point_columns(ids, np.concatenate(classes), self.start.settings.seed)
        return Born(_joined(list(bindings)), np.concatenate(places), columns)

    def _rows(self, samples: Any) -> Placed:
        """The samples as rows: known ids first, each at its own, then those that appear."""
        order = {int(one): row for row, one in enumerate(self.ids)}
        new = np.array([one not in order for one in samples.ids.tolist()], dtype=bool)
        self._appear(samples, new)
        for one in self.ids[len(order) :].tolist():
            order[one] = len(order)
        rows = np.array([order[one] for one in samples.ids.tolist()], dtype=np.int64)
        gone = np.ones(len(self.ids))
        faces, weights = self._faces.copy(), self.last.barycentric.copy()
        faces[rows], weights[rows], gone[rows] = (
            samples.faces,
            samples.barycentric,
            1.0 - samples.fade,
        )
        self._faces = faces
        after = Binding(self.bound.faces[faces], weights, np.zeros(len(faces)))
        vertices, own = self._now.vertices, self.bound.faces
        turned = carried(self.last, after, vertices, own)
        lean = None if self.lean is None else padded(self.lean, len(faces))
        return Placed(faces, turned, gone, leaning(self.last, lean, turned, vertices, own))

    def _appear(self, samples: Any, new: Any) -> None:
        """Give new ids rows at their first places."""
        if not len(self._faces):
            self._faces = _faces_at_start(samples, self.ids)
        if not new.any():
            return
        faces = np.asarray(samples.faces, dtype=np.int32)[new]
        binding = Binding(
            self.bound.faces[faces], np.asarray(samples.barycentric)[new], np.zeros(len(faces))
        )
        stored = binding if len(self.topologies) == 1 else _first_row(self.begin, len(faces))
        classes = np.asarray(samples.classes, dtype=np.int32)[new]
        self._births.append((stored, binding.positions(self._now.vertices), classes))
        self._faces = np.concatenate([self._faces, faces])
        self.ids = np.concatenate([self.ids, np.asarray(samples.ids, dtype=np.int32)[new]])
        self.last = _joined([self.last, binding])


def _first_row(binding: Binding, count: int) -> Binding:
    """So many like the first: for points of later topologies, which the first one never shows."""
    return Binding(
        *(
            np.repeat(values[:1], count, axis=0)
            for values in (binding.corners, binding.barycentric, binding.carry)
        )
    )


def _faces_at_start(samples: Any, ids: Ints) -> Ints:
    """Faces of the first rows on the first frame, on which nothing can have vanished for good."""
    of = dict(zip(samples.ids.tolist(), samples.faces.tolist(), strict=True))
    missing = [one for one in ids.tolist() if one not in of]
    if missing:
        raise ScatterError(f"Point {missing[0]} vanished on the first frame: optimize the scatter")
    return np.array([of[one] for one in ids.tolist()], dtype=np.int32)


def _joined(bindings: list[Binding]) -> Binding:
    return Binding(
        np.concatenate([one.corners for one in bindings]),
        np.concatenate([one.barycentric for one in bindings]),
        np.concatenate([one.carry for one in bindings]),
    )
