# SPDX-License-Identifier: GPL-3.0-or-later
"""New points on a patch, alone or between points that stay."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import _native as native
from .patches import Floats, Patch
from .results import Bound

FAINT = 1e-9  # factor of the density: no point starts there, but points there repel others
STARTED = 0.3  # of the progress
CAREFUL = 0.8  # times the tolerance: between points that stay, the last steps matter more


@dataclass(frozen=True)
class Solver:
    """How points are made.

    options: those of dapple3d.sample.
    """

    options: dict[str, Any]
    seed: int
    threads: int
    context: native.Context

    def alone(self, patch: Patch, ids: NDArray[np.int64]) -> Bound:
        """As many points as ids, all over the patch."""
        samples = native.sample(
            surface_of(patch),
            len(ids),
            seed=self.seed,
            threads=self.threads,
            context=self.context,
            **self.options,
        )
        return _bound(patch, ids, samples, 0)

    def thrown(
        self, patch: Patch, dark: NDArray[np.bool_], held: Bound, ids: NDArray[np.int64]
    ) -> Bound:
        """As many new points as ids, where darts between points that stay have hit the patch.

        Args:
            dark: per face, whether it gets none.
        """
        weights = np.where(dark, FAINT, 1.0)
        surface = surface_of(patch).with_density(
            patch.corner_densities() * weights[:, None], density_at="corners"
        )
        near = held.only(patch.find(held.faces) >= 0)
        locked = native.Samples(surface, patch.find(near.faces), near.barycentric)
        samples = native.sample(
            surface,
            len(locked) + len(ids),
            locked=locked,
            seed=self.seed,
            threads=self.threads,
            max_evaluations=1,
            context=self.context.part(0.0, STARTED),
        )
        return _bound(patch, ids, samples, len(locked))

    def evened(self, patch: Patch, points: Bound, moving: NDArray[np.bool_]) -> Bound:
        """Some of the points of a patch, made even between those that stay.

        Args:
            moving: per point.
        """
        faces = patch.find(points.faces)
        surface = surface_of(patch)
        known = {option.name: option.default for option in native.option_table("relax")}
        given = {name: value for name, value in self.options.items() if name in known}
        # Relative to the energy of all, of which those that stay have their share.
        share = CAREFUL * float(moving.mean())
        given["tolerance"] = given.get("tolerance", known["tolerance"]) * share
        samples = native.relax(
            surface,
            native.Samples(surface, faces, points.barycentric),
            np.unique(faces[moving]),
            locked=np.flatnonzero(~moving).astype(np.int32),
            count=len(faces),
            seed=self.seed,
            threads=self.threads,
            context=self.context.part(STARTED, 1.0),
            **given,
        )
        return _bound(patch, points.ids, samples, 0).only(moving)


def surface_of(patch: Patch) -> native.Surface:
    """The patch near 0, as closest points are found with numbers of single precision."""
    surface = native.Surface(patch.vertices - patch.vertices.min(axis=0), patch.faces)
    if patch.density is None:
        return surface
    return surface.with_density(patch.density, density_at=patch.density_at)


def _bound(patch: Patch, ids: NDArray[np.int64], samples: native.Samples, first: int) -> Bound:
    """All samples from the first on, on the faces of the whole surface."""
    barycentric: Floats = samples.barycentric[first:]
    normals = samples.normals[first:].astype(np.float32)
    return Bound(ids, patch.ids[samples.faces[first:]], barycentric, normals)
