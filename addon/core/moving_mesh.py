# SPDX-License-Identifier: GPL-3.0-or-later
"""A new mesh that follows the old one through an animation, its vertices even on each frame."""

from dataclasses import dataclass, field
from typing import Any

from .base.errors import ScatterError
from .base.native import named, package
from .remesh import NewMesh
from .surface.arrays import Floats


@dataclass
class MovingMesh:
    """The new mesh on the frames so far."""

    name: str  # of the object, for messages
    first: int  # frame of the remesh
    new: NewMesh
    frames: list[Any]  # the package's MovedMesh of each frame
    _tracker: Any = field(repr=False)

    @classmethod
    def begun(cls, name: str, first: int, new: NewMesh, context: Any) -> "MovingMesh":
        """The new mesh on its first frame."""
        with named(name):
            tracker = package().MeshTracker(new.ground.surface, new.made, context=context)
        return cls(name, first, new, [tracker.first], tracker)

    def advance(self, vertices: Floats, context: Any) -> None:
        """Move it with the old mesh, whose vertices (v, 3) on the next frame are given."""
        frame = self.first + len(self.frames)
        try:
            with named(self.name):
                now = self.new.ground.vertices(vertices)
                self.frames.append(self._tracker.advance(now, context=context))
        except ScatterError as error:
            raise ScatterError(f"Frame {frame}: {error}") from error

    @property
    def worst(self) -> int:
        """The number of the frame with the most triangles below 15 degrees, or turned over."""
        return max(
            range(len(self.frames)),
            key=lambda k: (self.frames[k].below_15, self.frames[k].flipped, -k),
        )
