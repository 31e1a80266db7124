# SPDX-License-Identifier: GPL-3.0-or-later
"""Remeshes of surfaces whose faces change, such as fluids: vertices go on where they can."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._native import Context, RemeshResult, Surface, option_table, remesh, remesh_next


@dataclass(frozen=True)
class SequenceMesh:
    """The remesh of one surface of a sequence.

    Attributes:
        mesh: the RemeshResult.
        ids: (n,) int32: of the vertices. A vertex keeps its id from surface to surface; no id is
            used again.
        kept: number of vertices that have not moved, because the surface around is the same.
        born: number of vertices that the mesh before did not have.
        gone: number of vertices of the mesh before that this one does not have.
    """

    mesh: RemeshResult
    ids: NDArray[np.int32]
    kept: int
    born: int
    gone: int

    def figures(self) -> dict[str, Any]:
        """The figures by name, with those of the report."""
        changes = {name: getattr(self, name) for name in ("kept", "born", "gone")}
        return self.mesh.report.to_dict() | changes


class MeshSequence:
    """Remeshes surfaces one after another whose faces may change: fluids, torn and built bodies.

    Where a surface is the same as the one before, vertices and triangles stay exactly as they are.
    Other vertices move along with the surface, and where it appears or is gone they come and go.
    The spacing is that of the first mesh, so that the number of vertices changes with the area.

    >>> sequence = dapple.MeshSequence(surface, 2000)
    >>> sequence.first.mesh.vertices
    >>> frame = sequence.advance(next_surface)
    >>> frame.mesh.vertices, frame.ids

    Where faces never change, MeshTracker keeps all vertices and triangles.

    Args:
        surface: the first Surface.
        count: number of vertices of its mesh, >= 1.
        edges: (k, 2) int32: edges of that surface that stay besides creases and borders.
        context: a Context for progress and cancellation.
        options: of remesh_next(), for all surfaces.

    Raises:
        ValueError: naming the option or count out of range, or the first of edges that is none.
        Cancelled: through the context.
    """

    def __init__(
        self,
        surface: Surface,
        count: int,
        *,
        edges: ArrayLike | None = None,
        context: Context | None = None,
        **options: Any,
    ) -> None:
        known = {one.name for one in option_table("remesh_next")}
        for name in options:
            if name not in known:
                raise TypeError(f"MeshSequence() got an unexpected keyword argument '{name}'")
        made = remesh(surface, count, edges=edges, context=context, **options)
        self._options = options
        self._capacity = surface.capacity / made.report.asked
        self._surface: Surface | None = surface
        self._next_id = len(made)
        ids = np.arange(len(made), dtype=np.int32)
        self._first = self._last = SequenceMesh(made, ids, kept=0, born=len(made), gone=0)

    @property
    def first(self) -> SequenceMesh:
        """The mesh of the first surface."""
        return self._first

    def advance(
        self,
        surface: Surface | None,
        *,
        edges: ArrayLike | None = None,
        context: Context | None = None,
    ) -> SequenceMesh | None:
        """The mesh of the next surface. The sequence is unchanged if this raises.

        Args:
            surface: the next Surface. None: there is nothing on this frame; the surface after it
                begins anew.
            edges: (k, 2) int32: edges of this surface that stay besides creases and borders.
            context: a Context for progress and cancellation.

        Returns:
            The SequenceMesh; None if there is no surface.

        Raises:
            ValueError: naming the first of edges that is none.
            Cancelled: through the context.
        """
        if surface is None:
            self._surface = None
            return None
        if self._surface is None:
            found = self._begun(surface, edges, context)
        else:
            found = self._continued(self._surface, surface, edges, context)
        self._surface, self._last = surface, found
        self._next_id += found.born
        return found

    def _begun(
        self, surface: Surface, edges: ArrayLike | None, context: Context | None
    ) -> SequenceMesh:
        count = max(round(surface.capacity / self._capacity), 1)
        made = remesh(surface, count, edges=edges, context=context, **self._options)
        ids = np.arange(self._next_id, self._next_id + len(made), dtype=np.int32)
        return SequenceMesh(made, ids, kept=0, born=len(made), gone=0)

    def _continued(
        self,
        before: Surface,
        surface: Surface,
        edges: ArrayLike | None,
        context: Context | None,
    ) -> SequenceMesh:
        last = self._last
        next_mesh = remesh_next(
            before,
            last.mesh,
            surface,
            self._capacity,
            edges=edges,
            context=context,
            **self._options,
        )
        previous = np.asarray(next_mesh.previous)
        new = previous < 0
        born = int(new.sum())
        ids = last.ids[np.maximum(previous, 0)]
        ids[new] = np.arange(self._next_id, self._next_id + born, dtype=np.int32)
        gone = len(last.ids) - (len(ids) - born)
        return SequenceMesh(next_mesh.mesh, ids, next_mesh.kept, born, gone)
