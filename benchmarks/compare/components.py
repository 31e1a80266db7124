# SPDX-License-Identifier: GPL-3.0-or-later
"""How even samples are on each connected component of a surface.

Connected cells do not cross between components, and each component gets a whole number of samples.
So the capacity variation of many small components has a part that no placing can remove.
"""

from __future__ import annotations

import dapple3d as dapple
import numpy as np
from numpy.typing import NDArray

from benchmarks.compare.tables import Row

Labels = NDArray[np.int64]


def components(faces: NDArray[np.int32]) -> Labels:
    """Component of each face (f,), connected over edges, numbered from the largest down."""
    ends = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    _, edges = np.unique(ends, axis=0, return_inverse=True)
    edges = edges.reshape(-1, 3)
    label = np.arange(len(faces))
    while True:  # every face takes over the least label across its edges
        least = np.full(edges.max() + 1, len(faces))
        np.minimum.at(least, edges.ravel(), np.repeat(label, 3))
        lower = least[edges].min(axis=1)
        lower = np.minimum(lower, lower[lower])
        if np.array_equal(lower, label):
            break
        label = lower
    _, first, sizes = np.unique(label, return_inverse=True, return_counts=True)
    rank = np.argsort(np.argsort(-sizes, kind="stable"), kind="stable")
    return np.asarray(rank[first])


def component_rows(
    surface: dapple.Surface, samples: dapple.Samples
) -> tuple[str, list[str], list[Row]]:
    """A title, a head and a row for each component that has samples."""
    capacities = dapple.evaluate_energy(surface, samples.positions, samples.faces).capacities
    where = components(surface.faces)
    of_samples = where[samples.faces]
    counts = np.bincount(of_samples, minlength=where.max() + 1)
    rows: list[Row] = []
    means = np.empty(len(samples))
    for k in np.flatnonzero(counts):
        own = capacities[of_samples == k]
        means[of_samples == k] = own.mean()
        rows.append(
            [
                *(str(k), str(np.count_nonzero(where == k)), str(counts[k])),
                f"{own.mean() / capacities.mean():.3f}",
                f"{own.std() / own.mean():.4f}",
            ]
        )
    within = np.sqrt(np.mean((capacities / means - 1.0) ** 2))
    title = (
        f"capacity variation {capacities.std() / capacities.mean():.4f}; within components "
        f"{within:.4f}, from their whole counts alone {means.std() / means.mean():.4f}; "
        f"{np.count_nonzero(counts == 0)} of {len(counts)} components have no sample."
    )
    return title, ["component", "faces", "samples", "mean capacity / overall", "variation"], rows
