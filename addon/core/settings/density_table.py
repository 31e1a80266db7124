# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of the density: terms that are multiplied, and what points avoid."""

from dataclasses import dataclass
from itertools import chain

from .descriptors import Kind, Setting
from .mask_table import MASKS

# When a bake decides what is outside.
FIRST_FRAME, ALL_FRAMES, EACH_FRAME = "FIRST_FRAME", "ALL_FRAMES", "EACH_FRAME"

DENSITY = (
    Setting(
        "attribute",
        Kind.VALUES,
        "",
        "Attribute",
        "Attribute or vertex group of the evaluated surface that multiplies the density: there "
        "are no points where it is 0, and twice as many where it is twice as large. Values of "
        "faces and face corners are used exactly where they are. Of colors, the brightness is "
        "used",
        own_words=True,
    ),
    Setting(
        "blocked_areas",
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
        "Image that multiplies the density, as painted: by its brightness and opacity, or by one "
        "channel. UDIM tiles are used where the UV map points to them; where there is no tile, "
        "there are no points",
    ),
    Setting(
        "image_channel",
        Kind.CHOICE,
        "BRIGHTNESS",
        "Channel",
        "Image channel used as density",
        choices=(
            ("BRIGHTNESS", "Brightness", "Brightness of the color, times its opacity"),
            ("RED", "Red", "Red only, regardless of opacity"),
            ("GREEN", "Green", "Green only, regardless of opacity"),
            ("BLUE", "Blue", "Blue only, regardless of opacity"),
            ("ALPHA", "Alpha", "Opacity only"),
        ),
        under="image",
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
    *chain(*MASKS.values()),
    Setting(
        "use_outside",
        Kind.SWITCH,
        False,
        "Outside Only",
        "Only scatter points where the surface is seen from outside, not on parts that are inside "
        "others. Where parts pass through each other, points keep their distance across the "
        "joint. Add Scatter turns this on for surfaces made of parts",
    ),
    Setting(
        "openness",
        Kind.NUMBER,
        0.05,
        "Openness",
        "Fraction of the sky that a place must see; higher values leave out crevices too",
        low=0.0,
        high=1.0,
        subtype="FACTOR",
        under="use_outside",
    ),
    Setting(
        "outside_over_time",
        Kind.CHOICE,
        FIRST_FRAME,
        "Over Time",
        "Frames at which a bake decides which places are seen from outside",
        choices=(
            (
                FIRST_FRAME,
                "First Frame",
                "Places stay as they are on the first frame. Points on them may become hidden, and "
                "places that come to light get none",
            ),
            (
                ALL_FRAMES,
                "All Frames",
                "Only places that are seen on every frame of the bake, so that no point is ever "
                "hidden and none has to leave its place. Bake looks at all frames and optimizes "
                "the points again first",
            ),
            (
                EACH_FRAME,
                "Each Frame",
                "As it is on each frame: points leave places that become hidden and move to those "
                "that come to light. Masks below Animation must be Each Frame too",
            ),
        ),
        under="use_outside",
    ),
    Setting(
        "use_camera_view",
        Kind.SWITCH,
        False,
        "Camera View",
        "Only scatter points in the view of the scene camera at the current frame",
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
        under="use_camera_view",
    ),
    Setting(
        "camera_hidden",
        Kind.SWITCH,
        False,
        "Leave Out Hidden",
        "Only scatter points that the camera sees, none behind the surface itself or behind "
        "objects of Hiding Objects",
        under="use_camera_view",
    ),
    Setting(
        "hiding_collection",
        Kind.COLLECTION,
        "",
        "Hiding Objects",
        "Collection of objects behind which Leave Out Hidden leaves points out, beside the surface "
        "itself. The scatter's own tiles and instances hide nothing",
        under="use_camera_view",
    ),
    Setting(
        "avoid_collection",
        Kind.COLLECTION,
        "",
        "Avoid Collection",
        "Collection of objects that points avoid: the inside of closed meshes, the vicinity of "
        "any mesh, and the instances of other scatters. The scatter's own points, tiles and "
        "instances are never avoided",
    ),
    Setting(
        "avoid_shape",
        Kind.CHOICE,
        "DISC",
        "Instances",
        "What instances of other scatters keep free, as renders show them",
        choices=(
            ("DISC", "Disc", "A disc around each point, by the radius of its object type"),
            ("BOX", "Bounding Box", "The box around the instance, which turns with it"),
            ("HULL", "Convex Hull", "The smallest convex shape around the instance"),
        ),
        under="avoid_collection",
    ),
    Setting(
        "avoid_margin",
        Kind.NUMBER,
        0.05,
        "Margin",
        "Distance that points keep from what they avoid",
        low=0.0,
        soft_high=10.0,
        unit="LENGTH",
        under="avoid_collection",
    ),
)


ALL = "ALL"
# What Show Density can show: all of the density, or one of its terms.
SHOWN_TERMS = (
    (ALL, "Density", "All terms of the density, multiplied"),
    *((one.name, one.label, one.tooltip) for one in DENSITY if not one.under),
)


def settings_of_term(term: str) -> list[str]:
    """Names of the settings of one of them."""
    return [one.name for one in DENSITY if term in (one.name, one.under)]


@dataclass(frozen=True)
class Painted:
    """A setting whose vertex group can be painted."""

    setting: str
    suffix: str  # of the name of a new group, after that of the scatter
    full: bool  # whether a new group allows points everywhere, otherwise it is empty


PAINTED = {
    "DENSITY": Painted("attribute", "Density", True),
    "BLOCKED": Painted("blocked_areas", "Blocked", False),
}
