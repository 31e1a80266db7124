# SPDX-License-Identifier: GPL-3.0-or-later
"""A new mesh for each frame of an animation whose faces change, which goes on from the last one."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .base.errors import ScatterError
from .base.native import named, package
from .remesh import Ground, NewMesh, OldMesh, Options, ground_of, rest_of, with_sources
from .surface.arrays import Ints


@dataclass(frozen=True)
class SequenceFrame:
    """The new mesh of a frame."""

    new: NewMesh
    ids: Ints  # (n,) of its vertices, which stay from frame to frame


@dataclass(frozen=True)
class _Figures:
    """What is known of a frame once its mesh is written."""

    vertices: int
    kept: int  # vertices that have not moved since the frame before
    flaws: int  # places where the topology is another one


@dataclass
class MeshSequence:
    """The new meshes of an animation, of which only the last one is in memory."""

    name: str  # of the object, for messages
    first: int  # number of the first frame
    count: int  # of vertices of the first mesh
    options: Options
    _frames: list[_Figures | None] = field(default_factory=list)  # None: one without faces
    _sequence: Any = field(default=None, repr=False)

    def advance(self, old: OldMesh, context: Any) -> SequenceFrame | None:
        """Remesh the next frame; None if it has no faces."""
        frame = self.first + len(self._frames)
        try:
            with named(self.name):
                found = self._next(old, context)
        except ScatterError as error:
            raise ScatterError(f"Frame {frame}: {error}") from error
        if found is None:
            self._frames.append(None)
            return None
        ground, made = found
        new = with_sources(ground, old, made.mesh, self.options["max_distance"])
        self._frames.append(_Figures(len(made.ids), made.kept, made.mesh.report.flaws))
        return SequenceFrame(new, np.array(made.ids))

    def _next(self, old: OldMesh, context: Any) -> tuple[Ground, Any] | None:
        """What the frame shows and its SequenceMesh; None without faces."""
        ground = ground_of(old, self.count, context) if len(old.faces) else None
        given = {"edges": ground.lines if ground else old.lines, "context": rest_of(context, old)}
        if self._sequence is not None:
            made = self._sequence.advance(ground.surface if ground else None, **given)
            return None if ground is None else (ground, made)
        if ground is None:
            return None
        self._sequence = package().MeshSequence(ground.surface, self.count, **given, **self.options)
        return ground, self._sequence.first

    @property
    def frame_count(self) -> int:
        """How many frames there are so far."""
        return len(self._frames)

    def check(self) -> None:
        """ScatterError if no frame had faces."""
        if not self._made:
            raise ScatterError(f"'{self.name}' has no faces: a new mesh needs a surface")

    @property
    def counts(self) -> tuple[int, int]:
        """The least and the largest number of vertices of a frame that has some."""
        counts = [one.vertices for one in self._made]
        return min(counts), max(counts)

    @property
    def kept(self) -> float:
        """The share of vertices that have not moved since the frame before."""
        later = self._made[1:]
        vertices = sum(one.vertices for one in later)
        return sum(one.kept for one in later) / vertices if vertices else 1.0

    @property
    def flaws(self) -> int:
        """Places of all frames where the topology is another one."""
        return sum(one.flaws for one in self._made)

    @property
    def _made(self) -> list[_Figures]:
        """The frames that have faces."""
        return [one for one in self._frames if one]
