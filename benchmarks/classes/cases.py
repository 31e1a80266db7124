# SPDX-License-Identifier: GPL-3.0-or-later
"""What is sampled in several classes, and what each set is compared with."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import dapple3d as dapple
import numpy as np

from benchmarks.compare.cases import mesh_files, ramp

CONTRAST = 16.0  # largest over smallest density, where two classes oppose each other


@dataclass(frozen=True)
class Goals:
    """Of a set of samples; alpha is relative to the spacing that the set wants at that place."""

    alpha_min: float
    alpha_mean: float
    capacity_variation: float

    def misses(self, means: dict[str, float]) -> list[str]:
        """The figures that miss, by name; `means` holds one by each name."""
        low = [name for name in ("alpha_min", "alpha_mean") if means[name] < getattr(self, name)]
        high = means["capacity_variation"] > self.capacity_variation
        return low + ["capacity_variation"] * high

    def __str__(self) -> str:
        return f">= {self.alpha_min:g}, >= {self.alpha_mean:g}, <= {self.capacity_variation:g}"


@dataclass(frozen=True)
class Case:
    """Classes over one domain. Its sets are the classes and, last, all samples together."""

    name: str
    domain: dapple.Surface | dapple.Torus
    classes: list[dapple.SampleClass]
    alone: list[dapple.Surface | dapple.Torus]  # per set: the domain with the set's own density
    max_evaluations: int = 200
    goals: tuple[Goals, Goals] | None = field(default=None)  # of each class, of all together

    @property
    def counts(self) -> list[int]:
        counts = [wanted.count for wanted in self.classes]
        return [*counts, sum(counts)]

    def together(self, seed: int, **options: Any) -> dapple.Report:
        """All classes at once."""
        if isinstance(self.domain, dapple.Torus):
            return dapple.sample_classes(self.domain, self.classes, seed=seed, **options).report
        return dapple.sample_classes(self.domain, self.classes, seed=seed, **options).report

    def by_itself(self, k: int, seed: int, **options: Any) -> dapple.Report:
        """As many samples as set k has, of its density, as one class."""
        domain = self.alone[k]
        if isinstance(domain, dapple.Torus):
            return dapple.sample(domain, self.counts[k], seed=seed, **options).report
        return dapple.sample(domain, self.counts[k], seed=seed, **options).report


def torus(_: Path) -> Case:
    domain = dapple.Torus()
    return Case(
        "torus",
        domain,
        [dapple.SampleClass(500), dapple.SampleClass(500)],
        [domain] * 3,
        max_evaluations=25,
        goals=(Goals(0.62, 0.76, 0.02), Goals(0.54, 0.70, 0.01)),
    )


def bunny(folder: Path) -> Case:
    surface = dapple.Surface(*read_bunny(folder))
    classes = [dapple.SampleClass(count) for count in (300, 600, 1800)]
    return Case("bunny", surface, classes, [surface] * 4)


def opposing(folder: Path) -> Case:
    """Two classes whose densities run against each other along the longest axis."""
    vertices, faces = read_bunny(folder)
    rising = ramp(vertices, CONTRAST)
    assert rising is not None
    densities = [rising, CONTRAST / rising]
    surfaces = [dapple.Surface(vertices, faces, density) for density in densities]
    union = np.sum([d / s.capacity for d, s in zip(densities, surfaces, strict=True)], axis=0)
    classes = [dapple.SampleClass(1000, density=density) for density in densities]
    return Case(
        "opposing",
        surfaces[0].with_density(None),
        classes,
        [*surfaces, surfaces[0].with_density(union)],
    )


def read_bunny(folder: Path) -> tuple[Any, Any]:
    return dapple.read_mesh(mesh_files(folder)["bunny"])


MAKERS: dict[str, Callable[[Path], Case]] = {"torus": torus, "bunny": bunny, "opposing": opposing}
