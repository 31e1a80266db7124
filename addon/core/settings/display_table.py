# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of the display: in the viewport, and far from the camera."""

from .descriptors import Changes, Kind, Setting

DISPLAY_AS = (  # as the node group counts them
    ("INSTANCES", "Instances", "Show the instances"),
    ("BOUNDS", "Bounds", "Show the bounding box of each instance, which is faster to draw"),
    ("POINTS", "Points", "Show a dot for each instance, which is fastest to draw"),
)
SHOWN = (
    Setting(
        "display_as",
        Kind.CHOICE,
        "INSTANCES",
        "Display As",
        "Display in the viewport; renders show instances",
        Changes.INSTANCES,
        choices=DISPLAY_AS,
    ),
    Setting(
        "viewport_share",
        Kind.NUMBER,
        1.0,
        "Viewport Share",
        "Fraction of the points shown in the viewport, evenly spread; renders show all points",
        Changes.INSTANCES,
        low=0.0,
        high=1.0,
        subtype="FACTOR",
    ),
)
WHERE = (  # without one of them the others have no effect
    Setting(
        "detail_in_viewport",
        Kind.SWITCH,
        False,
        "Viewport",
        "Show fewer points far from the scene camera and outside its view, evenly spread, in the "
        "viewport",
        Changes.INSTANCES,
    ),
    Setting(
        "detail_in_renders",
        Kind.SWITCH,
        False,
        "Renders",
        "Show fewer points far from the scene camera and outside its view, evenly spread, in "
        "renders",
        Changes.INSTANCES,
        own_words=True,
    ),
)
DETAIL = (
    Setting(
        "detail_full_until",
        Kind.NUMBER,
        20.0,
        "Full Until",
        "Distance from the camera up to which all points are shown. A quarter of them is left at "
        "twice the distance, a ninth at three times; orthographic cameras see all points",
        Changes.INSTANCES,
        low=0.0,
        soft_high=1000.0,
        unit="LENGTH",
    ),
    Setting(
        "detail_minimum",
        Kind.NUMBER,
        0.05,
        "Minimum",
        "Fraction of the points that remains at any distance",
        Changes.INSTANCES,
        low=0.0,
        high=1.0,
        subtype="FACTOR",
    ),
    Setting(
        "detail_widen",
        Kind.NUMBER,
        0.5,
        "Widen",
        "How much wider the remaining instances are at a distance: with 1 they cover as much "
        "ground as all of them. They get no taller",
        Changes.INSTANCES,
        low=0.0,
        high=1.0,
        subtype="FACTOR",
    ),
    Setting(
        "detail_outside_view",
        Kind.NUMBER,
        0.1,
        "Outside View",
        "Fraction of these points that remains outside the camera view, for shadows and "
        "reflections",
        Changes.INSTANCES,
        low=0.0,
        high=1.0,
        subtype="FACTOR",
    ),
    Setting(
        "detail_margin",
        Kind.NUMBER,
        1.0,
        "Margin",
        "Distance from the camera view up to which points count as inside; at least the size of "
        "an instance, which may reach into the picture",
        Changes.INSTANCES,
        low=0.0,
        soft_high=100.0,
        unit="LENGTH",
    ),
    Setting(
        "detail_fade",
        Kind.NUMBER,
        0.1,
        "Fade",
        "Instances shrink before they disappear, so that they do not pop. As a fraction of the "
        "points that remain",
        Changes.INSTANCES,
        low=0.0,
        high=1.0,
        subtype="FACTOR",
    ),
)
DISPLAY = (*SHOWN, *WHERE, *DETAIL)
