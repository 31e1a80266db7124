# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a surface has a border; looked up once for each set of faces."""

import bpy

from ...core.base.errors import ScatterError
from ...core.base.native import package
from ..base.panel_values import Prepared
from .surface_mesh import read_surface

_MOST = 64
_known: dict[tuple[int, str], bool] = {}  # by the surface's session_uid and its faces


def is_closed(obj: bpy.types.Object) -> bool:
    """Whether the surface of a scatter had no border when it was solved."""
    surface = obj.dapple.surface
    if surface is None:
        return False
    key = surface.session_uid, obj.dapple.surface_topology
    if key not in _known:
        while len(_known) >= _MOST:
            del _known[next(iter(_known))]
        _known[key] = _look(surface)
    return _known[key]


def _look(surface: bpy.types.Object) -> bool:
    try:
        arrays = read_surface(surface, bpy.context.evaluated_depsgraph_get())
    except ScatterError:  # it says so elsewhere
        return False
    if not len(arrays.faces):
        return False
    return not len(package().density.border_edges(arrays.vertices, arrays.faces))


IS_CLOSED = Prepared(is_closed, False)  # whether the surface of a scatter is
