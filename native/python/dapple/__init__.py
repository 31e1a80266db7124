# SPDX-License-Identifier: GPL-3.0-or-later
"""Blue noise on surfaces by variational optimisation.

>>> surface = dapple.Surface(vertices, faces)
>>> samples = dapple.sample(surface, 2000, seed=0)
>>> samples.positions  # (2000, 3): evenly spaced, never patterned
"""

from typing import Any, Final

from ._native import (
    Cancelled,
    Context,
    Energy,
    FileError,
    FlatDomain,
    PlanarSamples,
    Plane,
    Population,
    Projection,
    Quality,
    RadialStatistics,
    Refined,
    Report,
    SampleClass,
    Samples,
    Spectrum,
    Surface,
    SurfaceError,
    SurfaceSpectrum,
    Topology,
    Torus,
    Tracker,
    __version__,
    analyse,
    curvature_density,
    curvedness,
    energy,
    energy_planar,
    project,
    read_mesh,
    refine_image,
    refine_obstacles,
    resample,
    sample,
    sample_classes,
    sample_planar,
    sample_planar_classes,
    spectrum,
    surface_spectrum,
    track_window,
    write_mesh,
)

PAPER: Final[dict[str, Any]] = {
    "start": "random",
    "method": "line_search",
    "gap_weight": 0.0,
    "cells": "euclidean",
    "tolerance": 1e-5,
}
"""Options of sample() for the paper's own way: white noise, plain L-BFGS, no gap.

Chen et al. 2012, Algorithm 2.
"""

__all__ = [
    "PAPER",
    "Cancelled",
    "Context",
    "Energy",
    "FileError",
    "FlatDomain",
    "PlanarSamples",
    "Plane",
    "Population",
    "Projection",
    "Quality",
    "RadialStatistics",
    "Refined",
    "Report",
    "SampleClass",
    "Samples",
    "Spectrum",
    "Surface",
    "SurfaceError",
    "SurfaceSpectrum",
    "Topology",
    "Torus",
    "Tracker",
    "__version__",
    "analyse",
    "curvature_density",
    "curvedness",
    "energy",
    "energy_planar",
    "project",
    "read_mesh",
    "refine_image",
    "refine_obstacles",
    "resample",
    "sample",
    "sample_classes",
    "sample_planar",
    "sample_planar_classes",
    "spectrum",
    "surface_spectrum",
    "track_window",
    "write_mesh",
]
