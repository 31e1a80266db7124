# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's optimizer from given sites: plain L-BFGS (Chen et al. 2012, Algorithm 2).

dapple.Tracker restores the first frame's evenness and cannot minimize on; here every frame goes
down to the tolerance, with Euclidean cells, without repulsion, without a limit of the slide.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import dapple3d as dapple
import numpy as np
from numpy.typing import NDArray

from benchmarks.tracking.implicit import Array

TOLERANCE = 1e-5  # relative decrease of the energy ...
PATIENCE = 2  # ... this many times in a row
PAIRS = 7
ARMIJO = 1e-4
HALVINGS = 6
LONGEST_STEP = 0.5  # of a site, in spacings
FIRST_STEP = 0.25  # of the longest step, while nothing is known of the curvature
MOST_EVALUATIONS = 200


@dataclass(frozen=True)
class State:
    """Sites with what is known there."""

    positions: Array  # (n, 3)
    faces: NDArray[np.int32]  # (n,)
    barycentric: Array  # (n, 3)
    energy: float
    gradient: Array  # (n, 3), tangential


class Minimizer:
    def __init__(self, surface: dapple.Surface, count: int) -> None:
        self.surface = surface
        self.longest = LONGEST_STEP * surface.spacing(count)
        self.evaluations = 0
        corners = surface.vertices[surface.faces]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        self.normals = normals / np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]

    def evaluate(self, points: Array) -> State:
        on = dapple.project(self.surface, points)
        found = dapple.evaluate_energy(self.surface, on.positions, on.faces, cells="euclidean")
        self.evaluations += 1
        gradient = self._tangential(found.gradient, on.faces)
        return State(on.positions, on.faces, on.barycentric, found.total, gradient)

    def direction(self, state: State, pairs: deque[tuple[Array, Array]]) -> Array:
        """Two-loop recursion (Nocedal 1980), each site's step cut to the longest."""
        q = state.gradient.copy()
        shares = []
        for step, change in reversed(pairs):
            shares.append(float((step * q).sum() / (step * change).sum()))
            q -= shares[-1] * change
        q *= self._scale(state, pairs)
        for (step, change), share in zip(pairs, reversed(shares), strict=True):
            q += (share - float((change * q).sum() / (step * change).sum())) * step
        q = self._tangential(-q, state.faces)
        excess = np.linalg.norm(q, axis=1) / self.longest
        return np.asarray(q / np.maximum(excess, 1)[:, None])

    def backtrack(self, state: State, direction: Array) -> State | None:
        slope = float((direction * state.gradient).sum())
        share = 1.0
        for _ in range(HALVINGS):
            found = self.evaluate(state.positions + share * direction)
            if found.energy <= state.energy + ARMIJO * share * slope:
                return found
            share /= 2
        return None

    def _scale(self, state: State, pairs: deque[tuple[Array, Array]]) -> float:
        if pairs:
            step, change = pairs[-1]
            return float((step * change).sum() / (change**2).sum())
        largest = float(np.linalg.norm(state.gradient, axis=1).max())
        return FIRST_STEP * self.longest / max(largest, 1e-300)

    def _tangential(self, vectors: Array, faces: NDArray[np.int32]) -> Array:
        normals = self.normals[faces]
        return np.asarray(vectors - (vectors * normals).sum(axis=1)[:, None] * normals)


def minimize(
    surface: dapple.Surface, positions: Array, faces: NDArray[np.int32]
) -> tuple[NDArray[np.int32], Array, int]:
    """Faces (n,), barycentric coordinates (n, 3) and the number of evaluations.

    Ends after PATIENCE decreases in a row that are not above TOLERANCE; where not even a short step
    decreases the energy, or the direction does not descend, the memory is dropped once.
    """
    solver = Minimizer(surface, len(positions))
    state = solver.evaluate(positions)
    pairs: deque[tuple[Array, Array]] = deque(maxlen=PAIRS)
    small = 0
    while small < PATIENCE and solver.evaluations < MOST_EVALUATIONS:
        direction = solver.direction(state, pairs)
        if float((direction * state.gradient).sum()) >= 0:
            pairs.clear()
            direction = solver.direction(state, pairs)
        found = solver.backtrack(state, direction)
        if found is None:
            small += 1
            pairs.clear()
            continue
        small = 0 if state.energy - found.energy > TOLERANCE * state.energy else small + 1
        step, change = found.positions - state.positions, found.gradient - state.gradient
        if float((step * change).sum()) > 0:
            pairs.append((step, change))
        state = found
    return state.faces, state.barycentric, solver.evaluations
