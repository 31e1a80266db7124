# SPDX-License-Identifier: GPL-3.0-or-later
"""A new mesh for each frame of an animation whose faces change, which goes on from the last one."""

from dataclasses import dataclass, field, replace
from typing import Any

from .base.errors import ScatterError
from .base.native import named, package
from .remesh import NewMesh, OldMesh, Options, surface_of, with_sources


@dataclass(frozen=True)
class SequenceFrame:
    """The new mesh of a frame."""

    new: NewMesh  # without its surface, as all frames are in memory
    made: Any  # the package's SequenceMesh


@dataclass
class MeshSequence:
    """The new meshes of the frames so far."""

    name: str  # of the object, for messages
    first: int  # number of the first frame
    count: int  # of vertices of the first mesh
    options: Options
    frames: list[SequenceFrame | None] = field(default_factory=list)  # None: one without faces
    _sequence: Any = field(default=None, repr=False)

    def advance(self, old: OldMesh, context: Any) -> None:
        """Remesh the next frame."""
        frame = self.first + len(self.frames)
        try:
            with named(self.name):
                found = self._next(old, context)
        except ScatterError as error:
            raise ScatterError(f"Frame {frame}: {error}") from error
        if found is None:
            self.frames.append(None)
            return
        surface, made = found
        new = with_sources(surface, old, made.mesh, self.options["max_distance"])
        self.frames.append(SequenceFrame(replace(new, surface=None), made))

    def _next(self, old: OldMesh, context: Any) -> tuple[Any, Any] | None:
        """The surface of the frame and its SequenceMesh; None without faces."""
        surface = surface_of(old) if len(old.faces) else None
        if self._sequence is not None:
            made = self._sequence.advance(surface, edges=old.lines, context=context)
            return None if surface is None else (surface, made)
        if surface is None:
            return None
        self._sequence = package().MeshSequence(
            surface, self.count, edges=old.lines, context=context, **self.options
        )
        return surface, self._sequence.first

    @property
    def made(self) -> list[Any]:
        """The package's SequenceMesh of each frame that has faces."""
        return [frame.made for frame in self.frames if frame]

    def check(self) -> None:
        """ScatterError if no frame had faces."""
        if not self.made:
            raise ScatterError(f"'{self.name}' has no faces: a new mesh needs a surface")

    @property
    def counts(self) -> tuple[int, int]:
        """The least and the largest number of vertices of a frame that has some."""
        counts = [len(one.ids) for one in self.made]
        return min(counts), max(counts)

    @property
    def kept(self) -> float:
        """The share of vertices that have not moved since the frame before."""
        later = self.made[1:]
        vertices = sum(len(one.ids) for one in later)
        return sum(one.kept for one in later) / vertices if vertices else 1.0

    @property
    def flaws(self) -> int:
        """Places of all frames where the topology is another one."""
        return sum(one.mesh.report.flaws for one in self.made)
