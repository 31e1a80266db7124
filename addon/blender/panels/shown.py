# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panels show that takes computing, walking a modifier stack or reading a folder."""

from dataclasses import dataclass

import bpy

from ...core import presets
from ...core.details import details_from
from ..base import prepared
from ..base.prepared import Prepared
from ..base.translation import told
from ..data.scatter import settings_of
from ..steps.classes import count_labels
from ..steps.presets import folder
from ..steps.scatters import is_solo, scatters_of
from ..surface.borders import is_closed
from ..surface.materials import surface_materials
from ..surface.topology import differences
from . import pictures
from .asset_library import library, missing_assets


@dataclass(frozen=True)
class Pictured:
    """Details of a result, as icons."""

    energies: tuple[float, ...] = ()
    energy: int = 0
    gaps: int = 0


@dataclass(frozen=True)
class Assets:
    """Whether the node groups are an asset library, and why they cannot be; empty: they can."""

    there: bool = False
    trouble: str = ""


@dataclass(frozen=True)
class Listed:
    """A scatter in the list of its surface."""

    name: str
    count: int
    solo: bool  # whether the viewport shows no other one of the surface


def _scatters(surface: bpy.types.Object) -> tuple[Listed, ...]:
    found = scatters_of(surface)
    return tuple(Listed(one.name, one.dapple.report.count, is_solo(one, found)) for one in found)


def _differences(surface: bpy.types.Object) -> tuple[str, ...]:
    return tuple(differences(surface, bpy.context.scene, told))


def _pictured(obj: bpy.types.Object) -> Pictured:
    details = details_from(obj.dapple.report.details)
    return Pictured(details.energies, pictures.energy_icon(details), pictures.gaps_icon(details))


def _materials(obj: bpy.types.Object) -> tuple[str, ...]:
    surface = obj.dapple.surface
    if surface is None:
        return ()
    found = surface_materials(surface, bpy.context.evaluated_depsgraph_get())
    return tuple(one.name_full for one in found)


def _pattern(obj: bpy.types.Object) -> int:
    return pictures.pattern_icon(settings_of(obj))


def _class_counts(obj: bpy.types.Object) -> tuple[str, ...]:
    return tuple(count_labels(obj))


def _presets(_: None) -> tuple[str, ...]:
    return tuple(presets.names(folder()))


def _assets(_: None) -> Assets:
    return Assets(library() is not None, missing_assets())


IS_CLOSED = Prepared(is_closed, False)  # whether the surface of a scatter is
# Of a surface: by what the viewport and renders differ.
DIFFERENCES = Prepared(_differences, ())
SCATTERS = Prepared(_scatters, ())  # of a surface
MATERIALS = Prepared(_materials, None)  # of the surface of a scatter, by their full names
DETAILS = Prepared(_pictured, Pictured())
PATTERN = Prepared(_pattern, 0)  # icon
CLASS_COUNTS = Prepared(_class_counts, ())
PRESETS = Prepared(_presets, ())  # names
ASSETS = Prepared(_assets, Assets())


def register() -> None:
    """Begin to know; the names of presets before a menu is opened."""
    prepared.register()
    PRESETS.of()


def unregister() -> None:
    """Know nothing."""
    prepared.unregister()
