# SPDX-License-Identifier: GPL-3.0-or-later
"""What sockets of the node groups say of themselves, and their values where nothing is set."""

_OF_CLASSES = "0123456789 "  # at the end of a name: "Scale 2" is described as "Scale" is

DEFAULTS = {
    "Align": 1.0,
    "Class": -1,
    "First Frame": 1,
    "Parts": 1,
    "Rest Parts": 1,
    "Scale": 1.0,
    "Side": 1.0,
    "Spacing": 0.1,
    "Turn Randomness": 1.0,
}

INPUTS = {
    "Geometry": "Points of a scatter, as its mesh has them before its modifier; also as a point "
    "cloud. They carry what binds them to the surface",
    "Surface": "What the points are bound to, as it looks with its modifiers in this frame",
    "Surface Vertices": "Vertices that the surface must have for the points to be shown. 0: any "
    "number",
    "Rest Binding": "The points are bound to the surface's rest position, not to its faces",
    "Rest Parts": "Equal runs of the surface's faces that may lie on one another in the rest "
    "position, as Mirror makes them",
    "Rest Vertices": "Bound to the rest position, points are yet played by the faces of a surface "
    "with so many vertices, which is faster. 0: never",
    "Keys": "Of a bake: the object with a row for each key and point",
    "Triangles": "Of a bake: the object with the triangles that the keys name",
    "Frames": "Of a bake: the object with a row for each frame",
    "Key Points": "Of a bake: points that there must be. 0: any number",
    "First Frame": "Of a bake: the frame of the scene in which it begins",
    "Stale": "A warning that the modifier shows; it hides nothing",
    "Preview": "The object with the rows of a live preview, which the add-on makes",
    "Spacing": "Distance of neighbors: the size of the cone where nothing is chosen",
    "Hidden": "Share of the points that the viewport leaves out, so that the others stay even; "
    "renders show all",
    "Instance": "Object to place on the points",
    "Collection": "Place objects of this collection, each point one by chance",
    "Scale": "Size of the instances",
    "Scale Randomness": "By how much of their size instances may be smaller",
    "Turn Randomness": "Share of a full turn by which instances are turned about the normal",
    "Align": "1 stands upright on the surface, 0 upright in the world",
    "Tilt": "Largest angle by which instances lean, each its own way, in radians",
    "Density Scale": "How much smaller instances are where the density is less; below 0 larger",
    "Points": "Points that carry rotation and scale; those whose fade is 0 are not there",
    "Class": "Place things on the points with this dapple_class alone. Below 0: on all",
    "V": "Vertex of the surface, a corner of the triangle that the point lies in",
    "W": "Weight of that vertex, a barycentric coordinate of the point",
    "Turn": "Angle about the normal, in radians",
    "Side": "1; -1 where the surface is mirrored and its normals point the other way",
    "Rest": "The point's place on the surface's rest_position",
    "Part": "In which of the parts the place is looked for, from 0",
    "Parts": "Equal runs of the surface's faces that may lie on one another in the rest position",
    "Ahead": "A place near it on the surface's rest_position, where X points",
}

OUTPUTS = {
    "Geometry": "What is played in this frame",
    "Instances": "The things on their points",
    "Points": "The points that are shown",
    "Position": "On the surface as it is now",
    "Rotation": "Z along the surface's normal, X along the surface",
}


def default(name: str) -> float | None:
    """Value of an input where nothing is set; None: Blender's own."""
    return DEFAULTS.get(name.rstrip(_OF_CLASSES))


def of_input(name: str) -> str:
    """Tooltip of a group's input; empty inside of other groups, where nobody looks."""
    return INPUTS.get(name) or INPUTS.get(name.rstrip(_OF_CLASSES), "")


def of_output(name: str) -> str:
    """Tooltip of a group's output."""
    return OUTPUTS.get(name, "")
