# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the faces change during a bake: the surface just before and just after."""

from dataclasses import replace

from ...core.bake.baker import Baker
from ...core.surface.arrays import SurfaceArrays
from ..base.object_handles import Held
from ..surface.reading import at_frame
from ..surface.surroundings import Known
from .bare_frames import appeared

_SEAM_STEPS = 6


def crossed(
    baker: Baker, held: Held, surface: Held, arrays: SurfaceArrays, known: Known | None = None
) -> SurfaceArrays:
    """Have a baker cross to the faces of its next frame, which is returned as read again."""
    if baker.is_bare:
        return appeared(baker, held, surface, arrays, known)
    number = baker.first + baker.done
    before, after = baker.now, arrays
    if arrays.rest is None and baker.at_seam:
        before, after = _seam(surface, number, baker.bound.topology)
    then = at_frame(surface, number, settings=baker.start.settings, own=held, known=known)
    # Quads are cut as where values were read: these are of the corners of triangles, too.
    there = replace(after, faces=then.faces, loops=then.loops, around=then.around)
    baker.cross(before, replace(there, weights=then.weights, digests=then.digests))
    again = then if baker.follows else at_frame(surface, number)
    return replace(again, rest=arrays.rest)


def _seam(surface: Held, frame: int, topology: str) -> tuple[SurfaceArrays, SurfaceArrays]:
    """The surface just before and just after it loses its topology, between two frames.

    Bisected, so that it hardly moves between both, however far it moves in a frame.
    """
    begin, end = 0.0, 1.0
    before, after = at_frame(surface, frame - 1), at_frame(surface, frame)
    for _ in range(_SEAM_STEPS):
        middle = (begin + end) / 2
        arrays = at_frame(surface, frame - 1, middle)
        if arrays.topology == topology:
            begin, before = middle, arrays
        elif arrays.topology == after.topology:
            end, after = middle, arrays
        else:  # yet another topology between both
            break
    return before, after
