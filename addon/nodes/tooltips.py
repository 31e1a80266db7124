# SPDX-License-Identifier: GPL-3.0-or-later
"""Tooltips of the node groups' sockets, and default values."""

_OF_CLASSES = "0123456789 "  # stripped from the end of a name: "Scale 2" is described like "Scale"

DEFAULTS = {
    "Align to Normal": 1.0,
    "Object Type": -1,
    "Detail Full Until": 20.0,
    "Detail Fade": 0.1,
    "Detail Margin": 1.0,
    "Detail Minimum": 0.05,
    "Detail Outside View": 0.1,
    "Detail Widen": 0.5,
    "Detail in Renders": True,
    "Detail in Viewport": True,
    "First Frame": 1,
    "Parts": 1,
    "Rest Parts": 1,
    "Scale": 1.0,
    "Scale X": 1.0,
    "Scale Y": 1.0,
    "Scale Z": 1.0,
    "Side": 1.0,
    "Spacing": 0.1,
    "Random Turn": 1.0,
}

INPUTS = {
    "Geometry": "Points of a scatter, as its mesh has them before its modifier; also as a point "
    "cloud. They carry what binds them to the surface",
    "Surface": "What the points are attached to, with its modifiers in the current frame",
    "Surface Vertices": "Vertices that the surface must have for the points to be shown. 0: any "
    "number",
    "Rest Binding": "The points are attached to the rest position of the surface, not to its faces",
    "Rest Parts": "Equal ranges of the surface's faces that may overlap in the rest position, as "
    "Mirror makes them",
    "Rest Vertices": "Points that are attached to the rest position are played by faces if the "
    "surface has this many vertices, which is faster. 0: never",
    "Keys": "Of a bake: the object with a row for each keyframe and point",
    "Triangles": "Of a bake: the object with the triangles that the keyframes use",
    "Frames": "Of a bake: the object with a row for each frame",
    "Key Points": "Of a bake: number of points that there must be. 0: any number",
    "First Frame": "Of a bake: the scene frame in which it starts",
    "Warning": "A warning that the modifier shows; it hides nothing",
    "Preview": "The object with the points of a live preview, which the add-on creates",
    "Spacing": "Distance between neighbors; the size of the cone where nothing is chosen",
    "Hidden": "Fraction of the points that the viewport hides; the others stay even, and renders "
    "show all points",
    "Display": "What the viewport shows: 0 instances, 1 their bounding boxes, 2 points. "
    "Renders show instances",
    "Bounds": "Instance the bounding boxes of the objects",
    "Detail in Viewport": "Show fewer points far from the scene's camera and outside its view, in "
    "the viewport",
    "Detail in Renders": "Show fewer points far from the scene's camera and outside its view, in "
    "renders",
    "Detail Full Until": "Distance from the camera up to which all points are shown; at twice the "
    "distance a quarter is left",
    "Detail Minimum": "Fraction of the points that remains at any distance",
    "Detail Outside View": "Fraction of these points that is left outside the camera's view",
    "Detail Margin": "Distance from the camera's view up to which points count as inside",
    "Detail Fade": "Points shrink before they vanish, in this fraction of those that are left",
    "Detail Widen": "Widen instances that are left at a distance: with 1 they cover the same area",
    "Instance": "Object to instance on the points",
    "Collection": "Collection whose objects are instanced on the points, one picked at random for "
    "each",
    "Scale": "Scale of the instances",
    "Scale X": "Scale of the instances along their X axis",
    "Scale Y": "Scale of the instances along their Y axis",
    "Scale Z": "Scale of the instances along their Z axis",
    "Random Scale Down": "Maximum random reduction of the scale",
    "Random Scale Up": "Maximum random enlargement of the scale. 1: up to twice as large",
    "Random Turn": "Maximum random rotation around the normal, as a fraction of a full turn",
    "Align to Normal": "Align instances with the surface normal (1) or with world Z (0)",
    "Random Tilt": "Maximum angle by which instances lean in a random direction, in radians",
    "Color Attribute": "Attribute or vertex group of the surface that gives instances their color, "
    "as dapple_color",
    "Color Image": "Image on the surface that gives instances their color, as dapple_color",
    "Color UV Map": "UV map that places the image on the surface",
    "Lean Object": "Object whose Z axis gives the direction in which instances lean by Lean Along",
    "Lean Apart": "Angle by which instances lean away from their neighbors, in radians",
    "Lean Along": "How far instances lean to the Z axis of Lean Object, or of the world if there "
    "is none, from 0 to 1",
    "Density Scale": "How much smaller instances are where the density is lower; negative values "
    "make them larger",
    "Offset": "Distance of the instances from the surface along its normal; negative values sink "
    "them",
    "Fit to Spacing": "How far instances are scaled to the free space around their "
    "points: 0 keeps their size, at 1 they touch the nearest instance "
    "of the same type without overlap",
    "Weights": "How often each object of the collection is picked, as the add-on writes it. Empty: "
    "all alike",
    "Points": "Points with the attributes rotation and scale; those whose fade is 0 are left out",
    "Object Type": "Only instance on points with this dapple_object_type. Below 0: on all points",
    "V": "Vertex of the surface, a corner of the triangle that the point lies in",
    "C": "Face corner of the surface at that vertex, whose normal the surface is shaded with",
    "W": "Weight of that vertex, a barycentric coordinate of the point",
    "Turn": "Angle around the normal, in radians",
    "Side": "1; -1 where the surface is mirrored and its normals point the other way",
    "Rest": "The point's place on the surface's rest_position",
    "Part": "Index of the part in which the place is looked for, from 0",
    "Parts": "Equal ranges of the surface's faces that may overlap in the rest position",
    "Ahead": "A place near it on the surface's rest_position, where X points",
}

OUTPUTS = {
    "Geometry": "What is played in this frame",
    "Instances": "The instances on their points",
    "Points": "The points that are shown",
    "Position": "On the surface as it is now",
    "Rotation": "Z along the surface's normal, X along the surface",
}


def default(name: str) -> float | None:
    """Default value of an input; None: Blender's own."""
    return DEFAULTS.get(name.rstrip(_OF_CLASSES))


def of_input(name: str) -> str:
    """Tooltip of a group's input; empty for inner groups."""
    return INPUTS.get(name) or INPUTS.get(name.rstrip(_OF_CLASSES), "")


def is_machine_text(name: str) -> bool:
    """Whether an input holds data that no person reads or writes."""
    return name.rstrip(_OF_CLASSES) == "Weights"


def of_output(name: str) -> str:
    """Tooltip of a group's output."""
    return OUTPUTS.get(name, "")
