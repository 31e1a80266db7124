# SPDX-License-Identifier: GPL-3.0-or-later
"""What the artist sets before a scatter is optimized; field names as in the native package.

The fields are made from the tables of settings, with their defaults; only those are written here
that are none of one setting alone. Data-blocks are there by their names.
"""

import inspect
from collections.abc import Callable, Iterable
from dataclasses import Field, dataclass
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

from .density_table import DENSITY, settings_of_term
from .descriptors import Changes, Setting
from .instance_table import CLASS, TILES
from .solver_options import MOTION, SAMPLE, TRACKED
from .tables import SCATTER

_Class = TypeVar("_Class", bound="_Values")


class _Values:
    """A dataclass whose fields a type checker cannot know."""

    if TYPE_CHECKING:
        __dataclass_fields__: ClassVar[dict[str, Field[Any]]]

        def __init__(self, **values: Any) -> None: ...
        def __getattr__(self, name: str) -> Any: ...


def _fields_of(settings: Iterable[Setting]) -> Callable[[type[_Class]], type[_Class]]:
    """Make a class a frozen dataclass with a field for each setting, before its own."""

    def made(cls: type[_Class]) -> type[_Class]:
        own = inspect.get_annotations(cls)
        given = {one.field_name: one.default for one in settings if one.field_name not in own}
        for name, default in given.items():
            setattr(cls, name, default)
        cls.__annotations__ = {name: type(default) for name, default in given.items()} | own
        return dataclass(frozen=True)(cls)

    return made


def _that(settings: Iterable[Setting], changes: Changes) -> list[Setting]:
    return [one for one in settings if one.changes is changes]


@_fields_of(_that(CLASS, Changes.SOLUTION))
class ClassSettings(_Values):
    """One object type among several."""

    count: int = 0  # exactly so many; 0: by its share
    most_room: float = 0.0  # that its instances are fitted to; 0: no limit
    shrinks: bool = False  # where its discs would not fit: then its instances are smaller too


@_fields_of(DENSITY)
class DensitySettings(_Values):
    """Terms that are multiplied; none: the same density everywhere. Angles in radians."""

    def alone(self, term: str) -> "DensitySettings":
        """With one of the terms and no other."""
        return DensitySettings(**{name: getattr(self, name) for name in settings_of_term(term)})


MATERIAL = "material_index"  # in whose name values say where chosen materials are


def materials_of(density: DensitySettings) -> tuple[str, ...]:
    """Names of the materials that a density asks for; none where they have no effect."""
    counts = density.use_material and density.material_strength > 0.0
    return tuple(density.materials) if counts else ()


@_fields_of(TILES)
class TileSettings(_Values):
    """How tiles are cut; lengths in spacings of the points."""


@_fields_of([*_that(SCATTER, Changes.SOLUTION), *SAMPLE, *MOTION])
class Settings(_Values):
    """Options of one optimization."""

    per_area: float = 0.0  # points on a unit of area where the density is 1; 0: count holds
    classes: tuple[ClassSettings, ...] = ()  # none: all points are alike
    density: DensitySettings = DensitySettings()

    def sample_options(self) -> dict[str, Any]:
        """Keyword options of dapple.sample, without count, classes and density."""
        return {one.name: getattr(self, one.name) for one in SAMPLE}

    def tracker_options(self) -> dict[str, Any]:
        """Keyword options of dapple.Tracker, which has a limit of evaluations of its own, without
        classes."""
        return {name: getattr(self, name) for name in TRACKED}


@_fields_of(_that(SCATTER, Changes.BAKE))
class BakeSettings(_Values):
    """What only a bake takes; the solution that it begins with has no part in it."""
