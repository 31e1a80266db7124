# SPDX-License-Identifier: GPL-3.0-or-later
"""Points in pairs of mirror images."""

from typing import Any

import numpy as np

from ..base.errors import ScatterError
from ..base.native import package
from ..density.masked_surface import MaskedSurface
from ..settings.symmetry_table import AXES
from ..settings.values import Settings
from ..surface.arrays import Floats, Ints, SurfaceArrays
from .class_counts import wanted_counts
from .locked import Locked


def sampled_in_pairs(
    masked: MaskedSurface,
    arrays: SurfaceArrays,
    settings: Settings,
    context: Any,
    locked: Locked | None,
) -> Any:
    """dapple.SymmetricSamples across a plane through the surface's origin.

    Raises:
        ScatterError: points are locked, there are object types, or the surface is not symmetric.
    """
    if locked is not None:
        raise ScatterError(
            f"With Symmetry points cannot be locked ({len(locked.ids):,} are): unlock all"
        )
    if settings.object_types:
        raise ScatterError("With Symmetry all points are of one object type: remove Object Types")
    try:
        return package().sample_symmetric(
            masked.surface,
            wanted_counts(masked, settings)[0],
            normal=_normal(arrays.matrix, AXES.index(settings.symmetry)),
            point=arrays.matrix[:3, 3],
            context=context,
            **settings.sample_options(),
        )
    except ValueError as error:
        if "not symmetric" not in str(error) and "must be even" not in str(error):
            raise
        raise ScatterError(
            f"Surface '{arrays.name}', Symmetry {settings.symmetry}: {error}"
        ) from error


def on_original(masked: MaskedSurface, pairs: Any, arrays: SurfaceArrays, axis: str) -> Any:
    """dapple.Samples of the surface, from those in pairs on the faces that the density needs."""
    normal = _normal(arrays.matrix, AXES.index(axis))
    return masked.pairs_to_original(pairs, normal, arrays.matrix[:3, 3])


def _normal(matrix: Floats, axis: int) -> Floats:
    """Normal in world space of the plane across a local axis: normals go by the transposed inverse,
    here without its determinant, so that a scale of 0 along the plane does no harm.
    """
    first, second = (matrix[:3, k] for k in range(3) if k != axis)
    found: Floats = np.cross(first, second)
    return found if found.any() else np.eye(3)[axis]


def paired_ranks(ranks: Ints, mirror: Ints) -> Ints:
    """The ranks with mirror images beside each other, so that every beginning is symmetric but for
    one point.
    """
    first = np.minimum(ranks, ranks[mirror])
    order = np.lexsort((ranks, first))
    paired = np.empty_like(ranks)
    paired[order] = np.arange(len(ranks), dtype=ranks.dtype)
    return paired
