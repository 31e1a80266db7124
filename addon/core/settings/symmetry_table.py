# SPDX-License-Identifier: GPL-3.0-or-later
"""The setting of points in pairs of mirror images."""

from .descriptors import Kind, Setting

NO_SYMMETRY = "NONE"
AXES = ("X", "Y", "Z")
SYMMETRY = (
    Setting(
        "symmetry",
        Kind.CHOICE,
        NO_SYMMETRY,
        "Symmetry",
        "Points in pairs of mirror images across the surface's own origin, along one of its local "
        "axes. The surface has to be symmetric itself, but for parts without density",
        choices=(
            (NO_SYMMETRY, "None", "Points are placed without symmetry"),
            *((axis, axis, f"Mirror images along the local {axis} axis") for axis in AXES),
        ),
    ),
)
