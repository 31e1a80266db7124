# SPDX-License-Identifier: GPL-3.0-or-later
"""Solving: calls of the native package, arrays in and bindings out."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .binding import binding_of, samples_of
from .errors import ScatterError, StoppedError
from .frames import carried
from .native import package
from .records import Binding, Columns, own_random
from .settings import Settings
from .surface import Floats, Ints, SurfaceArrays


@dataclass(frozen=True)
class Report:
    """Figures of a result that the panel shows."""

    count: int = 0
    spacing: float = 0.0
    alpha_min: float = 0.0
    alpha_mean: float = 0.0
    capacity_spread: float = 0.0
    evaluations: int = 0
    milliseconds: float = 0.0
    converged: bool = False


@dataclass(frozen=True)
class Scattered:
    """A solved scatter, ready to be stored."""

    positions: Floats
    binding: Binding
    columns: Columns  # named as in POINT_ATTRIBUTES
    report: Report


def scatter(arrays: SurfaceArrays, settings: Settings, context: Any) -> Scattered:
    """Scatter points over a surface as it stands."""
    with named(arrays.name):
        surface = package().Surface(arrays.vertices, arrays.faces)
        samples = package().sample(
            surface, settings.count, context=context, **settings.sample_options()
        )
    columns = point_columns(samples.ids, samples.classes, settings.seed)
    binding = binding_of(samples, arrays.faces)
    return Scattered(np.asarray(samples.positions), binding, columns, report_of(samples.report))


def point_columns(ids: Ints, classes: Ints, seed: int) -> Columns:
    """What each point owns whatever its place."""
    return {
        "id": ids,
        "dapple_class": classes,
        "dapple_density": np.ones(len(ids)),
        "dapple_scale": own_random(seed, ids, 0),
        "dapple_turn": own_random(seed, ids, 1) * 2.0 * np.pi,
    }


def report_of(report: Any) -> Report:
    """The shown part of a dapple.Report."""
    shown = {
        name: getattr(report, name)
        for name in Report.__dataclass_fields__
        if name != "milliseconds"
    }
    return Report(milliseconds=1000.0 * report.seconds, **shown)


@dataclass
class Baker:
    """Carries a binding through the frames of a deforming surface, one key for each."""

    first: SurfaceArrays
    settings: Settings
    binding: Binding
    ids: Ints
    classes: Ints
    keys: list[Binding] = field(default_factory=list)
    reports: list[Report] = field(default_factory=list)
    _tracker: Any = None

    def advance(self, vertices: Floats, context: Any) -> None:
        """Add the key of the next frame."""
        with named(self.first.name):
            if self._tracker is None:
                self._tracker = self._new_tracker()
            samples = self._tracker.advance(vertices, context=context)
        before = self.keys[-1] if self.keys else self.binding
        key = carried(before, binding_of(samples, self.first.faces), vertices, self.first.faces)
        self.keys.append(key)
        self.reports.append(report_of(samples.report))

    def _new_tracker(self) -> Any:
        surface = package().Surface(self.first.vertices, self.first.faces)
        samples = samples_of(self.binding, surface, self.ids, self.classes)
        return package().Tracker(surface, samples, **self.settings.tracker_options())

    def report(self) -> Report:
        """The worst spacing and spread of all keys, the mean cost of one."""
        reports, count = self.reports, max(len(self.reports), 1)
        return Report(
            count=len(self.ids),
            spacing=reports[-1].spacing,
            alpha_min=min(report.alpha_min for report in reports),
            alpha_mean=sum(report.alpha_mean for report in reports) / count,
            capacity_spread=max(report.capacity_spread for report in reports),
            evaluations=round(sum(report.evaluations for report in reports) / count),
            milliseconds=sum(report.milliseconds for report in reports) / count,
            converged=all(report.converged for report in reports),
        )


@contextmanager
def named(name: str) -> Iterator[None]:
    """Errors of the native package inside, told as those of the surface called name."""
    try:
        yield
    except package().Cancelled as error:
        raise StoppedError("Cancelled: nothing was written") from error
    except (ValueError, MemoryError) as error:
        raise ScatterError(f"Surface '{name}': {error}") from error
