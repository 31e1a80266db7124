# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of a scatter as dataclasses; field names are those of the native package."""

from dataclasses import dataclass
from typing import Any

from .density_table import settings_of_term
from .edge_table import MARKS, ON_EDGES
from .fields import BakeFields, ClassFields, DensityFields, SolutionFields, TileFields
from .instance_table import KEEP
from .solver_options import SAMPLE, TRACKED
from .symmetry_table import NO_SYMMETRY


@dataclass(frozen=True)
class ClassSettings(ClassFields):
    """One object type among several."""

    count: int = 0  # exactly so many; 0: by its share
    max_clearance: float = 0.0  # that its instances are fitted to; 0: no limit
    shrinks: bool = False  # where its discs would not fit: then its instances are smaller too

    @property
    def stays_inside(self) -> bool:
        """Whether its discs do not stick out over borders."""
        return self.borders != KEEP and self.radius > 0.0


@dataclass(frozen=True)
class DensitySettings(DensityFields):
    """Terms that are multiplied; none: the same density everywhere. Angles in radians."""

    def alone(self, term: str) -> "DensitySettings":
        """With one of the terms and no other."""
        return DensitySettings(**{name: getattr(self, name) for name in settings_of_term(term)})


MATERIAL = "material_index"  # name of the values that mark faces of chosen materials


def materials_of(density: DensitySettings) -> tuple[str, ...]:
    """Names of the materials that a density asks for; none where they have no effect."""
    counts = density.use_material and density.material_strength > 0.0
    return tuple(density.materials) if counts else ()


@dataclass(frozen=True)
class TileSettings(TileFields):
    """How tiles are cut; lengths in spacings of the points."""


@dataclass(frozen=True)
class Settings(SolutionFields):
    """Options of one optimization."""

    per_area: float = 0.0  # points on a unit of area where the density is 1; 0: count holds
    object_types: tuple[ClassSettings, ...] = ()  # none: all points are alike
    density: DensitySettings = DensitySettings()

    @property
    def on_edges(self) -> bool:
        """Whether points are along edges of the surface, not all over it."""
        return self.scatter_on == ON_EDGES

    @property
    def in_pairs(self) -> bool:
        """Whether points are in pairs of mirror images."""
        return self.symmetry != NO_SYMMETRY and not self.on_edges

    def sample_options(self) -> dict[str, Any]:
        """Keyword options of dapple.sample, without count, classes and density."""
        return {one.name: getattr(self, one.name) for one in SAMPLE}

    def tracker_options(self) -> dict[str, Any]:
        """Keyword options of dapple.Tracker, which has a limit of evaluations of its own, without
        classes."""
        return {name: getattr(self, name) for name in TRACKED}


MARKED = "marked_edges"  # name of the values that say which edges are marked


def marks_of(settings: Settings) -> tuple[str, ...]:
    """The marks of edges that settings ask for: names of settings; none where they have no effect.

    Creases and borders are no marks: they follow from the shape.
    """
    return tuple(name for name in MARKS if settings.on_edges and getattr(settings, name))


@dataclass(frozen=True)
class BakeSettings(BakeFields):
    """Settings of a bake that do not change the solution of its first frame."""
