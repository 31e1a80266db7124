# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of a scatter itself, and the tables of all groups."""

import numpy as np

from .density_table import DENSITY
from .descriptors import Changes, Kind, Setting, Settings
from .display_table import DISPLAY
from .edge_table import EDGES
from .instance_table import CLASS, INSTANCES, TILES
from .solver_options import MOTION, SAMPLE
from .symmetry_table import SYMMETRY

AXES = {
    f"{sign}{name}": (-1.0 if sign else 1.0) * np.eye(3)[k]
    for sign in ("", "-")
    for k, name in enumerate("XYZ")
}


BOUND_TO = (  # the numbers are what files hold
    (
        "FACES",
        "Faces",
        "Faces after all modifiers, which must be the same in the viewport and in renders",
        0,
    ),
    (
        "REST",
        "Rest Position",
        "Shape before all modifiers, which may change the faces in every frame and in "
        "renders. Enables Rest Position on the surface",
        1,
    ),
)
_BIND_TO = (
    (
        "AUTO",
        "Automatic",
        "Faces, or the rest position if the viewport and renders have different faces",
        2,
    ),
    *BOUND_TO,
)
_AMOUNT = (
    Setting(
        "surface",
        Kind.SURFACE,
        "",
        "Surface",
        "Object to scatter points on: a mesh, curve, text or metaball",
        Changes.INDIRECTLY,
    ),
    Setting(
        "count",
        Kind.WHOLE,
        1000,
        "Count",
        "Exact number of points",
        low=1,
        soft_high=100_000,
    ),
    Setting(
        "amount",
        Kind.CHOICE,
        "COUNT",
        "Amount",
        "How the number of points is defined",
        Changes.INDIRECTLY,
        choices=(
            ("COUNT", "Count", "An exact number of points"),
            (
                "PER_AREA",
                "Per Area",
                "A number of points per square unit of the surface in world space",
            ),
        ),
    ),
    Setting(
        "points_per_area",
        Kind.NUMBER,
        100.0,
        "Points per Area",
        "Number of points on a square unit of the surface in world space where the density is 1",
        Changes.INDIRECTLY,
        low=0.0001,
        soft_high=10_000.0,
        field="per_area",
    ),
)
_FACES = (
    Setting(
        "merge_doubled",
        Kind.SWITCH,
        True,
        "Merge Doubled",
        "Count faces with the same corners as one, regardless of their orientation. Otherwise "
        "each of them gets its own points",
    ),
)
_DIRECTION = (
    Setting(
        "forward",
        Kind.CHOICE,
        "NONE",
        "Forward Axis",
        "Axis of the surface object that the X axis of the instances follows along the surface; "
        "instances then turn with the surface. Set Random Turn to 0",
        choices=(
            ("NONE", "Any", "Instances point in any direction"),
            *((axis, axis, f"{axis} axis of the surface object") for axis in AXES),
        ),
    ),
)
_LEANING = (
    Setting(
        "lean_object",
        Kind.OBJECT,
        "",
        "Lean Object",
        "Object whose Z axis gives the direction in which instances lean by Lean Along. The Z axis "
        "of a sun points to the sun, so plants lean to the light",
        Changes.INSTANCES,
    ),
)
_COLOR = (
    Setting(
        "color_attribute",
        Kind.VALUES,
        "",
        "Color Attribute",
        "Color attribute, other attribute or vertex group of the evaluated surface that gives each "
        "instance one color. Materials read it by an Attribute node of the type Instancer with the "
        "name dapple_color",
        Changes.INSTANCES,
        own_words=True,
    ),
    Setting(
        "color_image",
        Kind.IMAGE,
        "",
        "Color Image",
        "Image on the surface that gives each instance one color, multiplied by the color "
        "attribute. Materials read it by an Attribute node of the type Instancer with the name "
        "dapple_color",
        Changes.INSTANCES,
    ),
    Setting(
        "color_uv_map",
        Kind.UV_MAP,
        "",
        "Color UV Map",
        "UV map that places the image on the surface; if empty, the one that is active for "
        "rendering",
        Changes.INSTANCES,
        under="color_image",
    ),
)
_BAKE = (
    Setting(
        "keyframe_step",
        Kind.WHOLE,
        1,
        "Keyframe Step",
        "Number of frames from one keyframe to the next; larger intervals make smaller files, "
        "and points are interpolated in between",
        Changes.BAKE,
        low=1,
        high=25,
        subtype="TIME",
    ),
    Setting(
        "smoothing",
        Kind.CHOICE,
        "FORWARD",
        "Smoothing",
        "How a bake smooths the motion of the points over time",
        Changes.BAKE,
        choices=(
            (
                "FORWARD",
                "Forward",
                "Solve one frame after another",
            ),
            (
                "BOTH_WAYS",
                "Both Directions",
                "Solve all frames together: motion is smooth in both directions of time",
            ),
            (
                "LOOP",
                "Loop",
                "Solve all frames together, with the last frame leading back to the first",
            ),
        ),
        field="smoothing",
    ),
    Setting(
        "attach_to",
        Kind.CHOICE,
        "AUTO",
        "Attach To",
        "Geometry that the points are attached to while the surface deforms",
        Changes.INDIRECTLY,
        choices=_BIND_TO,
        own_words=True,
    ),
    Setting(
        "population",
        Kind.CHOICE,
        "KEEP_COUNT",
        "Population",
        "Quantity that a bake preserves while the surface grows and shrinks",
        Changes.BAKE,
        choices=(
            ("KEEP_COUNT", "Keep Count", "The same points in all frames"),
            (
                "KEEP_DENSITY",
                "Keep Density",
                "As many points per area as at the start; points fade in and out",
            ),
        ),
    ),
    Setting(
        "fade_duration",
        Kind.WHOLE,
        12,
        "Fade Duration",
        "Number of frames over which a point appears or vanishes",
        Changes.BAKE,
        low=1,
        soft_high=100,
        subtype="TIME",
        own_words=True,
        field="fade",
    ),
    Setting(
        "masks",
        Kind.CHOICE,
        "EACH_FRAME",
        "Masks",
        "Frames at which a bake evaluates the density: masks, avoided objects and "
        "scatters, the camera, attributes and images",
        Changes.BAKE,
        choices=(
            (
                "EACH_FRAME",
                "Each Frame",
                "As it is on each frame: points leave areas that they avoid. Noise, "
                "Border and Curvature stay on the surface as on the first frame",
            ),
            (
                "FIRST_FRAME",
                "First Frame",
                "As it is on the first frame, moving with the surface. Both Directions and Loop "
                "always do this",
            ),
        ),
        field="masks",
    ),
    Setting(
        "new_topology",
        Kind.CHOICE,
        "STOP",
        "New Topology",
        "Action if the faces of the surface differ from those that the points are "
        "attached to, at the start of a bake or in a later frame",
        Changes.NOTHING,
        choices=(
            ("STOP", "Stop", "Stop with an error message that names the frame"),
            ("REATTACH", "Reattach", "Continue from the nearest places on the new faces"),
        ),
    ),
    Setting(
        "preview_budget",
        Kind.WHOLE,
        40,
        "Preview Budget",
        "Time limit of the live preview per frame, in milliseconds; if it takes longer, points "
        "stick to the surface",
        Changes.NOTHING,
        low=1,
        soft_high=1000,
    ),
)
_UPDATES = (
    Setting(
        "auto_update_mode",
        Kind.CHOICE,
        "AUTOMATIC",
        "Auto Update",
        "When the points automatically follow changes of the settings, the surface and "
        "avoided objects",
        Changes.NOTHING,
        choices=(
            ("AUTOMATIC", "Automatic", "While the last solution took less than a second"),
            ("ON", "On", "However long a solution takes"),
            ("OFF", "Off", "Only when Optimize is pressed"),
        ),
        own_words=True,
    ),
    Setting(
        "keep_points",
        Kind.SWITCH,
        True,
        "Keep Points",
        "Auto Update starts from the existing points: they keep their identity, and far from a "
        "change few of them move. Optimize starts over from the seed",
        Changes.NOTHING,
    ),
)
SCATTER: Settings = (
    *_AMOUNT,
    *EDGES,
    *SYMMETRY,
    *_FACES,
    *SAMPLE,
    *_DIRECTION,
    *_LEANING,
    *_COLOR,
    *DISPLAY,
    *MOTION,
    *_BAKE,
    *_UPDATES,
)
# By the name of the property that holds the group; "" is the scatter itself.
GROUPS: dict[str, Settings] = {
    "": (*SCATTER, *INSTANCES),
    "density": DENSITY,
    "tiles": TILES,
    "object_types": (*CLASS, *INSTANCES),
}
