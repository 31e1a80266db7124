# SPDX-License-Identifier: GPL-3.0-or-later
"""Motions of any length, optimized window by window, in the memory of one window."""

from collections.abc import Iterable, Iterator
from operator import index
from typing import Any

from numpy.typing import ArrayLike

from ._native import Context, Samples, Surface, WindowTracker

PIECE, OVERLAP = 50, 12


def track_pieces(
    surface: Surface,
    samples: Samples,
    frames: Iterable[ArrayLike],
    *,
    piece: int = PIECE,
    overlap: int = OVERLAP,
    context: Context | None = None,
    **options: Any,
) -> Iterator[Samples]:
    """Samples on the frames of a motion of any length, as smooth as track_window() makes them.

    Frames are read when they are needed and optimized in overlapping pieces. At most
    `2 * piece - overlap` frames are in memory; a shorter motion is optimized at once, as by
    track_window().

    Args:
        surface: the Surface of the first frame.
        samples: Samples of the first frame, which are not changed.
        frames: vertices, (v, 3) float64, of each frame after it.
        piece: number of frames that are optimized together; the last piece may have more.
        overlap: number of frames that the next piece optimizes again, 0..piece - 1.
        context: a Context for the progress of a piece and for cancellation.
        options: of WindowTracker, `classes` among them.

    Yields:
        Samples of each frame after the first.

    Raises:
        SurfaceError: vertices of another number or not finite.
        ValueError: samples that are not of the surface, or an option out of range.
        Cancelled: through the context.
    """
    piece, overlap = index(piece), index(overlap)
    if not 0 <= overlap < piece:
        raise ValueError(f"overlap is {overlap}: it must be in 0..{piece - 1}, below piece")
    tracker = WindowTracker(surface, samples, context=context, **options)
    return _tracked(tracker, frames, piece, piece - overlap, context)


def _tracked(
    tracker: WindowTracker,
    frames: Iterable[ArrayLike],
    piece: int,
    step: int,
    context: Context | None,
) -> Iterator[Samples]:
    held: list[ArrayLike] = []
    for vertices in frames:
        held.append(vertices)
        if len(held) == piece + step:
            yield from tracker.advance(held[:piece], step, context=context)[:step]
            del held[:step]
    yield from tracker.advance(held, len(held), context=context)
