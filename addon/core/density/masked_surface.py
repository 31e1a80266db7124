# SPDX-License-Identifier: GPL-3.0-or-later
"""The surface that was read, with the density of the settings."""

from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.errors import ScatterError
from ..base.native import package
from ..settings.values import MARKED, Settings
from ..surface.arrays import Floats, SurfaceArrays
from ..surface.frames import SMOOTH, shaded
from .counts import cleared_name, shrunk
from .outside import poses_of
from .terms import density_of, fields_of

if TYPE_CHECKING:
    from dapple3d.density import MaskedSurface as MaskedSurface
else:
    MaskedSurface = Any  # the package may be missing

_LEAST = 1e-12  # least distance from a border, where others leave discs of no size


def masked_surface_of(
    arrays: SurfaceArrays,
    settings: Settings,
    context: Any = None,
    like: MaskedSurface | None = None,
    first: SurfaceArrays | None = None,
    like_arrays: SurfaceArrays | None = None,
) -> MaskedSurface:
    """The surface with its density.

    Raises ValueError as dapple.Surface does; a dapple.Context can cancel the refinement. A previous
    surface with the same faces, `like`, saves recomputing what has not changed; more of it if its
    arrays are given. If the first frame is given, inputs that belong to the surface are taken from
    it.
    """
    density, merge = density_of(arrays, settings.density, first), settings.merge_doubled
    original = None if like is None else like.original
    if original is not None and original.merge_doubled == merge and _is_alike(like_arrays, arrays):
        surface = _with_density(original, density)
    else:
        surface = _measured(arrays, density, merge, original)
    count, around = settings.count, arrays.around
    poses = poses_of(arrays, settings.density, first or arrays)
    if settings.per_area:
        count = round(settings.per_area * surface.area)
    masked = package().density.MaskedSurface(
        surface,
        fields_of(arrays, settings.density, first),
        count=count,
        outside=settings.density.openness if settings.density.use_outside else None,
        poses=poses,
        balls=(around.points, around.radii) if len(around.points) else None,
        uv=around.uv,
        image=around.image,
        tiles=around.tiles,
        values={name: one for name, one in arrays.weights.items() if name != MARKED},
        like=like,
        rest=None if first is None else first.vertices,
        context=context,
    )
    _clear_borders(masked, settings)
    return masked


def _clear_borders(masked: MaskedSurface, settings: Settings) -> None:
    """Keep the discs of object types inside the border.

    Raises:
        ScatterError: there is no room for an object type.
    """
    if settings.on_edges or not any(kind.stays_inside for kind in settings.object_types):
        return
    sized = shrunk(settings, masked.surface).object_types
    for index, kind in enumerate(settings.object_types):
        if not kind.stays_inside:
            continue
        distance = max(sized[index].radius, _LEAST)
        masked.clear_borders({cleared_name(index): (kind.density, distance)})
        if masked.cleared_share(cleared_name(index)) == 0.0:
            raise ScatterError(
                f"Object type {index + 1} has no room: no place is {distance:.3g} away from the "
                "border. Reduce its Radius, or set its Borders to Keep"
            )


def shares(masked: MaskedSurface, densities: Floats) -> Floats:
    """Densities relative to the largest density of the surface."""
    density = masked.surface.density
    return densities if density is None else densities / density.max()


def _measured(arrays: SurfaceArrays, density: Floats | None, merge: bool, like: Any) -> Any:
    """A dapple.Surface; one with the same faces, `like`, saves most of the work."""
    own = shaded(arrays)
    same = like is not None and like.merge_doubled == merge
    same = same and (like.sharp_angle == SMOOTH) == ("normals" not in own)
    if not same or not np.array_equal(like.faces, arrays.faces):
        values, at = package().density.placed(density)
        own |= {"density_at": at, "merge_doubled": merge}
        return package().Surface(arrays.vertices, arrays.faces, values, **own)
    if "normals" in own or not np.array_equal(like.vertices, arrays.vertices):
        like = like.deformed(arrays.vertices, normals=own.get("normals"))
    return _with_density(like, density)


def _with_density(surface: Any, density: Floats | None) -> Any:
    if density is None and surface.density is None:
        return surface
    values, at = package().density.placed(density)
    return surface.with_density(values, density_at=at)


def _is_alike(before: SurfaceArrays | None, now: SurfaceArrays) -> bool:
    """Whether two surfaces have the same faces, vertices and shading."""
    if before is None or (before.normals is None) != (now.normals is None):
        return False
    pairs: list[tuple[Any, Any]] = [(before.vertices, now.vertices), (before.faces, now.faces)]
    if now.normals is not None:
        pairs += [(before.normals, now.normals), (before.face_corners, now.face_corners)]
    return all(one is other or np.array_equal(one, other) for one, other in pairs)
