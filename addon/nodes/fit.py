# SPDX-License-Identifier: GPL-3.0-or-later
"""Node group: do the stored rows fit the surface and the points? What does not is a warning."""

from typing import Any

import bpy

from .builder import Builder, Socket, new_group
from .groups import Group


def _build_fit() -> bpy.types.NodeTree:
    """New group; Warning is the add-on's own warning, which hides nothing.

    On a surface without faces there is no point; in a bake that is no reason to warn.
    """
    tree = new_group(
        FIT.name,
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
    said = b.compare("GREATER_THAN", b.out("FunctionNodeStringLength", b.input("Warning")), 0)
    said = _warning(b, said, b.input("Warning"))
    # Changed settings show a warning and hide nothing; only a node that is used is evaluated.
    bare = b.compare("EQUAL", b.input("Faces"), 0)
    gone = b.boolean("AND", bare, b.boolean("NOR", played, other))
    gone = _warning(b, gone, "The surface has no faces")
    hidden = b.boolean("OR", b.boolean("OR", other, lost), b.boolean("OR", bare, gone))
    b.output("Fits", b.boolean("NOR", hidden, b.boolean("AND", said, hidden)))
    b.arrange()
    return tree


FIT = Group("Dapple Fit", _build_fit)


def _differs(b: Builder, number: Socket, asked: Socket) -> Socket:
    """Whether there is another number than is asked for; 0 asks for none."""
    asks = b.compare("NOT_EQUAL", asked, 0)
    return b.boolean("AND", asks, b.compare("NOT_EQUAL", number, asked))


def _warning(b: Builder, show: Socket, message: Any) -> Socket:
    return b.out("GeometryNodeWarning", show, message, warning_type="WARNING")
