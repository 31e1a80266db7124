# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: stored points -> points on the surface of the current (sub-)frame."""

from dataclasses import dataclass
from typing import Any

import bpy

from .builder import Builder, Group, Socket, inner, new_group
from .color import COLOR, COLOR_INPUTS
from .key_point import FRAME_KEYS, KEY_POINT
from .rest_place import REST_SHAPE
from .surface import SHADING, SURFACE

POINT_INPUTS = [
    ("Geometry", "NodeSocketGeometry"),
    ("Surface", "NodeSocketObject"),
    ("Surface Vertices", "NodeSocketInt"),
    ("Rest Binding", "NodeSocketBool"),
    ("Rest Parts", "NodeSocketInt"),
    ("Rest Vertices", "NodeSocketInt"),
    ("Keys", "NodeSocketObject"),
    ("Triangles", "NodeSocketObject"),
    ("Frames", "NodeSocketObject"),
    ("Key Points", "NodeSocketInt"),
    ("First Frame", "NodeSocketInt"),
    ("Warning", "NodeSocketString"),
    ("Preview", "NodeSocketObject"),
    ("Lean Object", "NodeSocketObject"),
    *COLOR_INPUTS,
]
NUMBERS = (
    "Scale",
    "Scale X",
    "Scale Y",
    "Scale Z",
    "Random Scale Down",
    "Random Scale Up",
    "Random Turn",
    "Align to Normal",
    "Random Tilt",
    "Lean Apart",
    "Lean Along",
    "Density Scale",
    "Offset",
)


def _build_points() -> bpy.types.NodeTree:
    """New group; NUMBERS are fields. The points get `rotation`, `fade` and `scale`.

    If the stored data do not fit the surface, there are no points but a warning.
    """
    numbers = [(name, "NodeSocketFloat") for name in NUMBERS]
    tree = new_group(POINTS.name, POINT_INPUTS + numbers, [("Geometry", "NodeSocketGeometry")])
    b = Builder(tree)
    found = inner(b, SURFACE, b.input("Surface"))
    played = _played(b, found.outputs["Geometry"], _shape(b, found))
    # Aligned instances are turned once, by their own angle plus that of the keyframe.
    turn = b.attribute("dapple_turn", "FLOAT")
    turn = b.number("MULTIPLY", turn, b.input("Random Turn"))
    aligned = b.compare("EQUAL", b.input("Align to Normal"), 1.0, "FLOAT")
    early = b.switch("FLOAT", aligned, 0.0, turn)
    position, rotation, faded, clearance = _placed(b, found, played, early)
    position, rotation = _moved(b, found, played, position, rotation)
    on_surface, position = position, _lifted(b, position, rotation)
    names = ("Align to Normal", "Lean Object", "Lean Along", "Lean Apart", "Random Tilt")
    stood = inner(b, ALIGNMENT, rotation, turn, aligned, *map(b.input, names))
    points = _with_attributes(b, position, stood.outputs["Rotation"], faded)
    points = _with_clearance(b, points, played, clearance)
    colored = (b.input("Surface"), on_surface, *(b.input(name) for name, _ in COLOR_INPUTS))
    points = inner(b, COLOR, points, *colored).outputs[0]
    b.output("Geometry", b.switch("GEOMETRY", played.fits, None, points))
    b.arrange()
    return tree


POINTS = Group("Dapple Points", _build_points)


@dataclass(frozen=True)
class _Played:
    """The data used at the moment, and whether they fit."""

    keys: Socket
    triangles: Socket
    preview: Socket
    count: Socket  # number of points
    baked: Socket
    live: Socket
    resting: Socket  # whether points are bound to the rest shape
    shape: Socket
    scene_info: bpy.types.Node
    fits: Socket


def _shape(b: Builder, found: bpy.types.Node) -> Socket:
    """The rest shape of the surface; its own shape if it has no rest position."""
    feeds = (found.outputs["Unmoved"], found.outputs["Transform"])
    return inner(b, REST_SHAPE, *feeds).outputs["Shape"]


def _played(b: Builder, geometry: Socket, shape: Socket) -> _Played:
    names = ("Keys", "Triangles", "Frames", "Preview")
    keys, triangles, frames, preview = (_stored(b, name) for name in names)
    count, vertices = b.count_points(b.input("Geometry")), b.count(geometry)
    baked = b.compare("GREATER_THAN", b.count(keys), 0)
    live = _live(b, preview, count)
    rest, warning = b.input("Rest Binding"), b.input("Warning")
    now = inner(b, FRAME_KEYS, frames, b.input("First Frame"), vertices, rest)
    bake = b.boolean("AND", baked, b.boolean("NOT", live))
    has = (vertices, b.count_faces(geometry))
    bound = (b.input("Surface Vertices"), now.outputs["Vertices"])
    fits = inner(b, CHECK, *has, *bound, count, b.input("Key Points"), bake, rest, warning)
    faces = b.compare("EQUAL", vertices, b.input("Rest Vertices"))
    resting = b.boolean("AND", rest, b.boolean("NOR", live, faces))
    stored = (keys, triangles, preview, count, baked, live)
    return _Played(*stored, resting, shape, now, fits.outputs["Fits"])


def _stored(b: Builder, name: str) -> Socket:
    info = b.node("GeometryNodeObjectInfo", b.input(name), transform_space="ORIGINAL")
    return info.outputs["Geometry"]


def _live(b: Builder, rows: Socket, count: Socket) -> Socket:
    """Whether to show a live preview, never in renders."""
    number = b.count(rows)
    fits = b.compare("EQUAL", number, count)
    some = b.compare("GREATER_THAN", number, 0)
    return b.boolean("AND", b.boolean("AND", fits, some), b.out("GeometryNodeIsViewport"))


def _placed(b: Builder, found: bpy.types.Node, played: _Played, turn: Socket) -> list[Socket]:
    """Position, rotation, fade and clearance on the surface.

    The second keyframe is not evaluated on whole keyframes or without a bake.
    """
    stored = (played.keys, played.triangles, played.preview, played.count)
    now = played.scene_info.outputs
    switches = (played.baked, played.live, played.resting, played.shape, b.input("Rest Parts"))
    geometry, unmoved = found.outputs["Geometry"], found.outputs["Unmoved"]
    shaded = (unmoved, *inner(b, SHADING, unmoved).outputs)
    turned = (found.outputs["Sheared"], found.outputs["Normals"])
    first, second = (
        inner(b, KEY_POINT, geometry, *shaded, *turned, *stored, key, *switches, turn)
        for key in (now["First"], now["Second"])
    )
    fraction = now["Fraction"]
    between = b.compare("GREATER_THAN", fraction, 0.0, "FLOAT")
    return [
        b.switch(kind, between, one, b.mix(kind, fraction, one, other))
        for kind, one, other in zip(
            ("VECTOR", "ROTATION", "FLOAT", "FLOAT"), first.outputs, second.outputs, strict=True
        )
    ]


def _moved(
    b: Builder, found: bpy.types.Node, played: _Played, position: Socket, rotation: Socket
) -> tuple[Socket, Socket]:
    """Position and rotation moved with the surface, unless they come from the rest shape."""
    moves = b.boolean("AND", found.outputs["Moved"], b.boolean("NOT", played.resting))
    there = b.out("FunctionNodeTransformPoint", position, found.outputs["Transform"])
    feeds = (rotation, found.outputs["Rotation"])
    along = b.out("FunctionNodeRotateRotation", *feeds, rotation_space="GLOBAL")
    return b.switch("VECTOR", moves, position, there), b.switch("ROTATION", moves, rotation, along)


def _lifted(b: Builder, position: Socket, rotation: Socket) -> Socket:
    """The position, offset from the surface along its normal."""
    offset = b.input("Offset")
    normal = b.out("FunctionNodeRotateVector", (0.0, 0.0, 1.0), rotation)
    none = b.compare("EQUAL", offset, 0.0, "FLOAT")
    there = b.vector("ADD", position, b.scaled(normal, offset))
    return b.switch("VECTOR", none, there, position)


def _with_attributes(b: Builder, position: Socket, rotation: Socket, faded: Socket) -> Socket:
    """The existing points with their attributes."""
    placed = b.captured(
        b.input("Geometry"), Position=("VECTOR", position), Rotation=("ROTATION", rotation)
    )
    points = b.store(placed.outputs[0], "rotation", placed.outputs["Rotation"], "QUATERNION")
    points = b.store(points, "fade", b.number("SUBTRACT", 1.0, faded), "FLOAT")
    points = b.store(points, "scale", _size(b), "FLOAT_VECTOR")
    return b.out("GeometryNodeSetPosition", points, True, placed.outputs["Position"])


def _with_clearance(b: Builder, points: Socket, played: _Played, clearance: Socket) -> Socket:
    """The points with the clearance of the keyframes, if stored; otherwise with their own."""
    exists = b.attribute("dapple_clearance", "FLOAT").node.outputs["Exists"]
    stored = b.boolean("AND", played.baked, b.sample(played.keys, exists, 0, "BOOLEAN"))
    return b.switch(
        "GEOMETRY", stored, points, b.store(points, "dapple_clearance", clearance, "FLOAT")
    )


def _size(b: Builder) -> Socket:
    """Scale * fade * a random factor, reduced by the density, on each axis.

    The factor falls from 1 + growth to 1 - randomness with the point's own random number.
    """
    own, growth = b.attribute("dapple_scale", "FLOAT"), b.input("Random Scale Up")
    less = b.number("MULTIPLY", own, b.number("ADD", b.input("Random Scale Down"), growth))
    chance = b.number("SUBTRACT", b.number("ADD", growth, 1.0), less)
    factor = b.number("MULTIPLY", b.input("Scale"), chance)
    factor = b.number("MULTIPLY", factor, b.attribute("fade", "FLOAT"))
    sparse = b.number("SUBTRACT", 1.0, b.attribute("dapple_density", "FLOAT"))
    smaller = b.number("MULTIPLY", sparse, b.input("Density Scale"))
    other = b.number("MULTIPLY", factor, b.number("SUBTRACT", 1.0, smaller))
    same = b.compare("EQUAL", b.input("Density Scale"), 0.0, "FLOAT")
    axes = b.out("ShaderNodeCombineXYZ", *(b.input(f"Scale {axis}") for axis in "XYZ"))
    return b.scaled(axes, b.switch("FLOAT", same, other, factor))


def _build_alignment() -> bpy.types.NodeTree:
    """New group; if Aligned is set, Rotation already includes the turn."""
    tree = new_group(
        ALIGNMENT.name,
        [
            ("Rotation", "NodeSocketRotation"),
            ("Turn", "NodeSocketFloat"),
            ("Aligned", "NodeSocketBool"),
            ("Align to Normal", "NodeSocketFloat"),
            ("Lean Object", "NodeSocketObject"),
            ("Lean Along", "NodeSocketFloat"),
            ("Lean Apart", "NodeSocketFloat"),
            ("Random Tilt", "NodeSocketFloat"),
        ],
        [("Rotation", "NodeSocketRotation")],
    )
    b = Builder(tree)
    rotation = b.input("Rotation")
    rotation = b.switch("ROTATION", b.input("Aligned"), _upright(b, rotation), rotation)
    alone = b.compare("EQUAL", b.input("Lean Along"), 0.0, "FLOAT")
    rotation = b.switch("ROTATION", alone, _along(b, rotation), rotation)
    alone = b.compare("EQUAL", b.input("Lean Apart"), 0.0, "FLOAT")
    rotation = b.switch("ROTATION", alone, _apart(b, rotation), rotation)
    straight = b.compare("EQUAL", b.input("Random Tilt"), 0.0, "FLOAT")
    b.output("Rotation", b.switch("ROTATION", straight, _tilted(b, rotation), rotation))
    b.arrange()
    return tree


ALIGNMENT = Group("Dapple Alignment", _build_alignment)


def _upright(b: Builder, rotation: Socket) -> Socket:
    """The rotation between world Z and the normal by Align to Normal, then turned about its Z."""
    less = b.number("SUBTRACT", 1.0, b.input("Align to Normal"))
    up = (0.0, 0.0, 1.0)
    rotation = b.out("FunctionNodeAlignRotationToVector", rotation, less, up, axis="Z")
    return b.turned(rotation, b.input("Turn"))


def _along(b: Builder, rotation: Socket) -> Socket:
    """The rotation, leaning to the Z axis of an object by the shortest way."""
    info = b.node("GeometryNodeObjectInfo", b.input("Lean Object"), transform_space="RELATIVE")
    ahead = b.out("FunctionNodeRotateVector", (0.0, 0.0, 1.0), info.outputs["Rotation"])
    share = b.input("Lean Along")
    return b.out("FunctionNodeAlignRotationToVector", rotation, share, ahead, axis="Z")


def _apart(b: Builder, rotation: Socket) -> Socket:
    """The rotation, leaning away from the neighbors. Their direction is one before the turn."""
    away = b.attribute("dapple_apart", "FLOAT_VECTOR")
    x, y, _ = b.parts(away)
    axis = b.out("ShaderNodeCombineXYZ", b.number("MULTIPLY", y, -1.0), x)
    axis = b.node("ShaderNodeVectorRotate", axis, rotation_type="Z_AXIS")
    b.tree.links.new(b.number("MULTIPLY", b.input("Turn"), -1.0), axis.inputs["Angle"])
    length = b.node("ShaderNodeVectorMath", away, operation="LENGTH").outputs["Value"]
    angle = b.number("MULTIPLY", length, b.input("Lean Apart"))
    lean = b.out("FunctionNodeAxisAngleToRotation", axis.outputs[0], angle)
    return b.out("FunctionNodeRotateRotation", rotation, lean, rotation_space="LOCAL")


def _tilted(b: Builder, rotation: Socket) -> Socket:
    """The rotation, tilted in a random direction by digits that the turn does not use."""
    angle = b.number("MULTIPLY", b.attribute("dapple_turn", "FLOAT"), 1000.0)
    axis = b.out("ShaderNodeCombineXYZ", b.number("COSINE", angle), b.number("SINE", angle))
    chance = b.number("FRACT", b.number("MULTIPLY", b.attribute("dapple_scale", "FLOAT"), 37.0))
    angle = b.number("MULTIPLY", chance, b.input("Random Tilt"))
    tilt = b.out("FunctionNodeAxisAngleToRotation", axis, angle)
    return b.out("FunctionNodeRotateRotation", rotation, tilt, rotation_space="LOCAL")


def _build_check() -> bpy.types.NodeTree:
    """New group; Warning is the add-on's own warning, which hides nothing.

    On a surface without faces there are no points; in a bake this is no reason for a warning.
    """
    tree = new_group(
        CHECK.name,
        [
            ("Vertices", "NodeSocketInt"),
            ("Faces", "NodeSocketInt"),
            ("Surface Vertices", "NodeSocketInt"),
            ("Key Vertices", "NodeSocketInt"),
            ("Points", "NodeSocketInt"),
            ("Key Points", "NodeSocketInt"),
            ("Played", "NodeSocketBool"),
            ("Rest Binding", "NodeSocketBool"),
            ("Warning", "NodeSocketString"),
        ],
        [("Fits", "NodeSocketBool")],
    )
    b = Builder(tree)
    played = b.input("Played")
    bound = b.switch("INT", played, b.input("Surface Vertices"), b.input("Key Vertices"))
    other = _differs(b, b.input("Vertices"), bound)
    other = b.boolean("AND", other, b.boolean("NOT", b.input("Rest Binding")))
    lost = _differs(b, b.input("Points"), b.input("Key Points"))
    lost = b.boolean("AND", played, lost)
    other = _warning(
        b, other, "The number of vertices of the surface has changed: optimize the scatter"
    )
    lost = _warning(b, lost, "Points were added or removed since the bake: bake again")
    shown_warning = b.compare(
        "GREATER_THAN", b.out("FunctionNodeStringLength", b.input("Warning")), 0
    )
    shown_warning = _warning(b, shown_warning, b.input("Warning"))
    # Changed settings show a warning and hide nothing; only a node that is used is evaluated.
    empty = b.compare("EQUAL", b.input("Faces"), 0)
    faded = b.boolean("AND", empty, b.boolean("NOR", played, other))
    faded = _warning(b, faded, "The surface has no faces")
    hidden = b.boolean("OR", b.boolean("OR", other, lost), b.boolean("OR", empty, faded))
    b.output("Fits", b.boolean("NOR", hidden, b.boolean("AND", shown_warning, hidden)))
    b.arrange()
    return tree


CHECK = Group("Dapple Check", _build_check)


def _differs(b: Builder, number: Socket, requested: Socket) -> Socket:
    """Whether a number differs from the required one; 0 allows any."""
    limited = b.compare("NOT_EQUAL", requested, 0)
    return b.boolean("AND", limited, b.compare("NOT_EQUAL", number, requested))


def _warning(b: Builder, show: Socket, message: Any) -> Socket:
    return b.out("GeometryNodeWarning", show, message, warning_type="WARNING")
