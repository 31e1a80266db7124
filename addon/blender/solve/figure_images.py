# SPDX-License-Identifier: GPL-3.0-or-later
"""Charts in the panel: drawn once, shown as icons, kept while the add-on is enabled."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import bpy
import bpy.utils.previews

from ...core import pictures
from ...core.settings.values import Settings
from ...core.solve.figures import Details, details_from
from ...core.surface.arrays import Floats
from ..base.panel_values import CachedValue
from ..scatter.object import settings_of

_POINTS = 120  # in the sample pattern
_MOST = 32  # pictures that are kept


class _IconCache:
    """The pictures by their content."""

    icons: Any = None


def energy_icon(details: Details) -> int:
    """The energy over the iterations."""
    return _icon(("energy", details.energies), lambda: pictures.curve(details.energies))


def gaps_icon(details: Details) -> int:
    """Histogram of the distances to the nearest points."""
    return _icon(("gaps", details.gaps), lambda: pictures.bars(details.gaps))


def pattern_icon(settings: Settings) -> int:
    """Sample pattern of points in the plane with these settings."""
    options = settings.sample_options() | {"seed": 1}
    return _icon(("pattern", *options.values()), lambda: pictures.pattern(_POINTS, options))


def _icon(key: tuple[Any, ...], draw: Callable[[], Floats]) -> int:
    if _IconCache.icons is None:
        return 0
    name = repr(key)
    if name not in _IconCache.icons:
        if len(_IconCache.icons) >= _MOST:
            _IconCache.icons.clear()
        pixels = draw()
        pixels[:, :, :3] *= pixels[:, :, 3:]  # icons are drawn as premultiplied
        preview = _IconCache.icons.new(name)
        preview.image_size = (pixels.shape[1], pixels.shape[0])
        preview.image_pixels_float.foreach_set(pixels.ravel().tolist())
    icon: int = _IconCache.icons[name].icon_id
    return icon


def register() -> None:
    """Create the collection of pictures."""
    _IconCache.icons = bpy.utils.previews.new()


def unregister() -> None:
    """Remove it."""
    if _IconCache.icons is not None:
        bpy.utils.previews.remove(_IconCache.icons)
    _IconCache.icons = None


@dataclass(frozen=True)
class DetailIcons:
    """Details of a result, as icons."""

    energies: tuple[float, ...] = ()
    energy: int = 0
    gaps: int = 0


def _detail_icons(obj: bpy.types.Object) -> DetailIcons:
    details = details_from(obj.dapple.report.details)
    return DetailIcons(details.energies, energy_icon(details), gaps_icon(details))


def _pattern(obj: bpy.types.Object) -> int:
    return pattern_icon(settings_of(obj))


DETAILS = CachedValue(_detail_icons, DetailIcons())
PATTERN = CachedValue(_pattern, 0)  # icon
