# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of points along edges."""

import math

from .descriptors import Kind, Setting

ON_EDGES = "EDGES"
COUNT = 100  # of points that edges begin with: they have less room than a surface
MARKS = ("edge_seams", "edge_sharp", "edge_materials")
KINDS = ("edge_creases", "edge_borders", *MARKS)
EDGES = (
    Setting(
        "scatter_on",
        Kind.CHOICE,
        "SURFACE",
        "Scatter On",
        "Where the points are",
        choices=(
            ("SURFACE", "Surface", "All over the surface"),
            (
                ON_EDGES,
                "Edges",
                "Along edges of the surface, with equal distances: rivets along seams, posts "
                "along a border. They stay on their edges while the surface deforms",
            ),
        ),
        own_words=True,
    ),
    Setting(
        "edge_creases",
        Kind.SWITCH,
        True,
        "Creases",
        "Edges at which the surface bends by more than Crease Angle",
        own_words=True,
    ),
    Setting(
        "edge_angle",
        Kind.NUMBER,
        math.radians(30.0),
        "Crease Angle",
        "Angle between the faces of an edge from which it is a crease",
        low=0.0,
        high=math.pi,
        subtype="ANGLE",
    ),
    Setting(
        "edge_borders",
        Kind.SWITCH,
        True,
        "Borders",
        "Edges of only one face, and of three or more",
    ),
    Setting(
        "edge_seams",
        Kind.SWITCH,
        False,
        "Seams",
        "Edges that are marked as seams of the UV map",
    ),
    Setting(
        "edge_sharp",
        Kind.SWITCH,
        False,
        "Sharp Edges",
        "Edges that are marked as sharp",
    ),
    Setting(
        "edge_materials",
        Kind.SWITCH,
        False,
        "Material Borders",
        "Edges between faces of different materials",
        own_words=True,
    ),
    Setting(
        "edge_spacing",
        Kind.CHOICE,
        "EVEN",
        "Distances",
        "How points follow each other along an edge",
        choices=(
            ("EVEN", "Even", "Equal distances"),
            ("NATURAL", "Natural", "Distances from a half to one and a half of the mean"),
        ),
        own_words=True,
    ),
    Setting(
        "edge_corners",
        Kind.SWITCH,
        False,
        "Points at Corners",
        "A point at each corner: where edges end, meet or turn by more than 45 degrees. Otherwise "
        "the first point is half a distance from the corner",
    ),
    Setting(
        "align_to_edges",
        Kind.SWITCH,
        True,
        "Align to Edges",
        "The X axis of the instances follows the edges, and Random Turn has no effect",
    ),
)
