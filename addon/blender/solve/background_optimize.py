# SPDX-License-Identifier: GPL-3.0-or-later
"""What a scatter is solved by beside the artist's work, as steps: Optimize once it was asked for,
else Auto Update.
"""

import bpy

from ...core.base.errors import ScatterError
from ...core.base.steps import Steps
from ..base.object_handles import Held
from ..freshness.concurrent_edits import check_points_kept, check_writable, points_now
from ..scatter.object import settings_of
from ..surface.joining import surface_for
from .incremental import solved_anew
from .updating import read_steps, update_of, update_steps


def steps_of(held: Held, drops_keys: bool | None) -> Steps:
    """Steps that return whether they have solved; drops_keys None: nobody asked for them."""
    return update_steps(held) if drops_keys is None else _asked_steps(held, drops_keys)


def _asked_steps(held: Held, drops_keys: bool) -> Steps:
    """Solve a scatter from its seed, as Optimize does; True.

    Points that the artist moves, locks or bakes meanwhile are left alone.
    """
    before = points_now(held.get())
    _check_free(held.get(), drops_keys)
    settings = settings_of(held.get())
    with surface_for(held.get()) as surface:
        arrays = yield from read_steps(held, surface, settings)
        update = update_of(held, surface, settings, arrays)
        solved = yield from solved_anew(update)
        obj = held.get()
        _check_free(obj, drops_keys)
        check_points_kept(obj, before)
        update.write(solved)
    return True


def _check_free(obj: bpy.types.Object, drops_keys: bool) -> None:
    check_writable(obj)
    if obj.dapple.baked_keys and not drops_keys:
        raise ScatterError(f"Scatter '{obj.name}' was baked meanwhile: nothing was written")
