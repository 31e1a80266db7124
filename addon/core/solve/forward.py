# SPDX-License-Identifier: GPL-3.0-or-later
"""Directions along a surface: scales that lie from head to tail, tiles that look down a roof."""

from dataclasses import replace

import numpy as np

from ..settings.tables import AXES
from ..surface.arrays import SurfaceArrays
from ..surface.frames import frames, shading
from ..surface.records import Binding


def pointing(binding: Binding, surface: SurfaceArrays, forward: str) -> Binding:
    """The binding with angles that turn each point's X axis along an axis of the surface object.

    As far as the surface lets it: the axis is projected onto the surface. NONE leaves the angles.
    """
    if forward == "NONE":
        return binding
    along = surface.matrix[:3, :3] @ AXES[forward]
    local = frames(binding, surface.vertices, shading(surface))
    angles = local.angle(np.broadcast_to(along, local.normal.shape))
    return replace(binding, carry=angles)
