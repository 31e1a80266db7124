# SPDX-License-Identifier: GPL-3.0-or-later
"""The frames on which places of a moving surface have to be seen from outside."""

from ..settings.density_table import ALL_FRAMES, EACH_FRAME
from ..settings.values import DensitySettings
from ..surface.arrays import Floats, SurfaceArrays


def is_decided_on_each_frame(density: DensitySettings) -> bool:
    """Whether what is outside changes with the shape of the surface."""
    return density.use_outside and density.outside_over_time == EACH_FRAME


def is_decided_on_all_frames(density: DensitySettings) -> bool:
    """Whether places have to be seen on all frames of a bake."""
    return density.use_outside and density.outside_over_time == ALL_FRAMES


def poses_of(
    arrays: SurfaceArrays, density: DensitySettings, first: SurfaceArrays
) -> tuple[Floats, ...]:
    """Vertices (v, 3) of all poses in which places have to be seen, of a surface and the first
    frame of a bake; empty if it is the first frame alone.
    """
    if is_decided_on_each_frame(density):
        return (arrays.vertices,)
    if is_decided_on_all_frames(density) and first.poses:
        return (first.vertices, *first.poses)
    return ()
