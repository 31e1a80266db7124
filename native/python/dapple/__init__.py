# SPDX-License-Identifier: GPL-3.0-or-later
"""Blue noise on surfaces by variational optimisation.

>>> surface = dapple.Surface(vertices, faces)
>>> samples = dapple.sample(surface, 2000, seed=0)
>>> samples.positions  # (2000, 3): evenly spaced, never patterned
"""

from ._native import (
    Cancelled,
    Context,
    Energy,
    FileError,
    Projection,
    Report,
    Samples,
    Surface,
    SurfaceError,
    Topology,
    Tracker,
    __version__,
    energy,
    project,
    read_mesh,
    sample,
    write_mesh,
)

__all__ = [
    "Cancelled",
    "Context",
    "Energy",
    "FileError",
    "Projection",
    "Report",
    "Samples",
    "Surface",
    "SurfaceError",
    "Topology",
    "Tracker",
    "__version__",
    "energy",
    "project",
    "read_mesh",
    "sample",
    "write_mesh",
]
