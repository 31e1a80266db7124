# SPDX-License-Identifier: GPL-3.0-or-later
"""Dataclasses whose fields are made from the tables of settings and from the package's options.

A type checker reads `fields.pyi` instead, which scripts/setting_tables.py writes.
"""

from collections.abc import Iterable
from dataclasses import field, make_dataclass
from typing import Any

from .density_table import DENSITY
from .descriptors import Changes, Setting
from .instance_table import CLASS, TILES
from .solver_options import MOTION, SAMPLE
from .tables import SCATTER


def _that(settings: Iterable[Setting], changes: Changes) -> list[Setting]:
    return [one for one in settings if one.changes is changes]


def _each_once(settings: Iterable[Setting]) -> list[Setting]:
    return list({one.name: one for one in settings}.values())


# By the name of the class: its documentation and settings.
TABLES: dict[str, tuple[str, list[Setting]]] = {
    "ClassFields": ("of one object type", _that(CLASS, Changes.SOLUTION)),
    "DensityFields": ("of a density", list(DENSITY)),
    "TileFields": ("of tiles", list(TILES)),
    "SolutionFields": (
        "of one optimization",
        _each_once([*_that(SCATTER, Changes.SOLUTION), *SAMPLE, *MOTION]),
    ),
    "BakeFields": ("of a bake alone", _that(SCATTER, Changes.BAKE)),
}


def _made(name: str) -> Any:
    given = [
        (one.field_name, type(one.default), field(default=one.default)) for one in TABLES[name][1]
    ]
    return make_dataclass(name, given, frozen=True, namespace={"__module__": __name__})


ClassFields = _made("ClassFields")
DensityFields = _made("DensityFields")
TileFields = _made("TileFields")
SolutionFields = _made("SolutionFields")
BakeFields = _made("BakeFields")
