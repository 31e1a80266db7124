# SPDX-License-Identifier: GPL-3.0-or-later
"""A new mesh that follows the old one through an animation, its vertices even on each frame."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .base.errors import ScatterError
from .base.native import named, package
from .remesh import NewMesh
from .surface.arrays import Floats


@dataclass(frozen=True)
class MovedFrame:
    """What is known of a frame once its vertices are written."""

    below_15: int  # triangles with an angle below 15 degrees
    flipped: int  # triangles that are turned over


@dataclass
class MovingMesh:
    """The new mesh on the frames so far, of which only the last one is in memory."""

    name: str  # of the object, for messages
    first: int  # frame of the remesh
    new: NewMesh
    frames: list[MovedFrame]
    _tracker: Any = field(repr=False)

    @classmethod
    def begun(cls, name: str, first: int, new: NewMesh, context: Any) -> "MovingMesh":
        """The new mesh on its first frame."""
        with named(name):
            tracker = package().MeshTracker(new.ground.surface, new.made, context=context)
        return cls(name, first, new, [_known(tracker.first)], tracker)

    def advance(self, vertices: Floats, context: Any) -> Floats:
        """Its vertices (n, 3) on the next frame, of which the old mesh's vertices (v, 3) are
        given.
        """
        frame = self.first + len(self.frames)
        try:
            with named(self.name):
                now = self.new.ground.vertices(vertices)
                moved = self._tracker.advance(now, context=context)
        except ScatterError as error:
            raise ScatterError(f"Frame {frame}: {error}") from error
        self.frames.append(_known(moved))
        return np.array(moved.vertices)

    @property
    def worst(self) -> int:
        """The number of the frame with the most triangles below 15 degrees, or turned over."""
        return max(
            range(len(self.frames)),
            key=lambda k: (self.frames[k].below_15, self.frames[k].flipped, -k),
        )


def _known(moved: Any) -> MovedFrame:
    """The figures of the package's MovedMesh."""
    return MovedFrame(moved.below_15, moved.flipped)
