# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of the density: terms that are multiplied, and what points avoid."""

import math
from dataclasses import dataclass

from .descriptors import Kind, Setting

DENSITY = (
    Setting(
        "attribute",
        Kind.VALUES,
        "",
        "Attribute",
        "Attribute or vertex group of the evaluated surface that multiplies the density: there "
        "are no points where it is 0, and twice as many where it is twice as large. Colors count "
        "by their brightness",
    ),
    Setting(
        "blocked",
        Kind.VALUES,
        "",
        "Blocked Areas",
        "Attribute or vertex group of the evaluated surface that multiplies the density by 1 minus "
        "its value: there are no points where it is 1, and half as many where it is 0.5",
    ),
    Setting(
        "image",
        Kind.IMAGE,
        "",
        "Image",
        "Image whose brightness, as painted, and opacity multiply the density",
    ),
    Setting(
        "uv_map",
        Kind.UV_MAP,
        "",
        "UV Map",
        "UV map that places the image on the surface; if empty, the one that is active for "
        "rendering",
        under="image",
    ),
    Setting(
        "curvature",
        Kind.NUMBER,
        0.0,
        "Curvature",
        "How much sparser flat areas are than curved ones",
        low=0.0,
        high=1.0,
        subtype="FACTOR",
    ),
    Setting(
        "use_slope",
        Kind.SWITCH,
        False,
        "Slope",
        "Only scatter points where the angle between the normal and world Z is in a range",
    ),
    Setting(
        "slope_from",
        Kind.NUMBER,
        0.0,
        "Min",
        "Smallest angle between the normal and world Z with full density: 0 is a floor, 90 a "
        "wall, 180 a ceiling",
        low=0.0,
        high=math.pi,
        subtype="ANGLE",
        under="use_slope",
    ),
    Setting(
        "slope_to",
        Kind.NUMBER,
        0.7853982,
        "Max",
        "Largest angle between the normal and world Z with full density: 0 is a floor, 90 a "
        "wall, 180 a ceiling",
        low=0.0,
        high=math.pi,
        subtype="ANGLE",
        under="use_slope",
    ),
    Setting(
        "slope_fade",
        Kind.NUMBER,
        0.1745329,
        "Falloff",
        "Angle beyond the range over which the density falls to 0",
        low=0.0,
        high=math.pi,
        subtype="ANGLE",
        under="use_slope",
    ),
    Setting(
        "use_height",
        Kind.SWITCH,
        False,
        "Height",
        "Only scatter points where world Z is in a range",
    ),
    Setting(
        "height_from",
        Kind.NUMBER,
        0.0,
        "Min",
        "Lowest world Z with full density",
        unit="LENGTH",
        under="use_height",
    ),
    Setting(
        "height_to",
        Kind.NUMBER,
        1.0,
        "Max",
        "Highest world Z with full density",
        unit="LENGTH",
        under="use_height",
    ),
    Setting(
        "height_fade",
        Kind.NUMBER,
        0.1,
        "Falloff",
        "Height beyond the range over which the density falls to 0",
        low=0.0,
        unit="LENGTH",
        under="use_height",
    ),
    Setting(
        "use_camera",
        Kind.SWITCH,
        False,
        "Camera View",
        "Only scatter points in the view of the scene camera at the current frame, whether "
        "hidden behind something or not",
    ),
    Setting(
        "camera_margin",
        Kind.NUMBER,
        0.1,
        "Margin",
        "How far points extend beyond the camera frame, relative to half the frame: for shadows "
        "and moving cameras",
        low=0.0,
        soft_high=1.0,
        subtype="FACTOR",
        under="use_camera",
    ),
    Setting(
        "obstacles",
        Kind.COLLECTION,
        "",
        "Avoid Collection",
        "Collection of objects that points avoid: the inside of closed meshes, the vicinity of "
        "any mesh, and the instances of other scatters with their radii. The scatter's own "
        "points, tiles and instances are never avoided",
    ),
    Setting(
        "obstacle_margin",
        Kind.NUMBER,
        0.05,
        "Margin",
        "Distance that points keep from what they avoid",
        low=0.0,
        soft_high=10.0,
        unit="LENGTH",
        under="obstacles",
    ),
)


@dataclass(frozen=True)
class Painted:
    """A setting whose vertex group can be painted."""

    setting: str
    suffix: str  # of the name of a new group, after that of the scatter
    full: bool  # whether a new group allows points everywhere, otherwise it is empty


PAINTED = {
    "DENSITY": Painted("attribute", "Density", True),
    "BLOCKED": Painted("blocked", "Blocked", False),
}
