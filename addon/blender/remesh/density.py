# SPDX-License-Identifier: GPL-3.0-or-later
"""What makes vertices denser: values of the mesh, and an image."""

from dataclasses import dataclass

import bpy
import numpy as np

from ...core.remesh import Picture, Pixels
from ...core.surface.arrays import Ints
from ..surface.images import is_film, read_images
from ..surface.mesh import uv_layer


@dataclass(frozen=True)
class Chosen:
    """The choices of the dialog."""

    values: str = ""  # name of an attribute or a vertex group; empty for none
    image: str = ""  # full name; empty for none
    channel: str = "BRIGHTNESS"
    uv_map: str = ""  # empty for the one that is active for rendering


def full_name(image: str) -> str:
    """The full name of an image of which the name is given, as dialogs do, or the full name."""
    found = bpy.data.images.get(image)
    return image if found is None else found.name_full


class Images:
    """The chosen image; its pixels are read once, or on each frame if they depend on it."""

    def __init__(self, chosen: Chosen) -> None:
        self._chosen = chosen
        self._pixels: Pixels | None = None

    def on(self, obj: bpy.types.Object, mesh: bpy.types.Mesh, corners: Ints) -> Picture | None:
        """The image on a mesh of an object, of whose triangles the corners (t, 3) are given; None
        if there is none.

        Raises:
            ScatterError: the mesh has no such UV map, or the image has no pixels.
        """
        name = self._chosen.image
        if not name:
            return None
        uv = np.empty((len(mesh.loops), 2), np.float32)
        uv_layer(obj, mesh, self._chosen.uv_map).uv.foreach_get("vector", uv.ravel())
        if self._pixels is None or is_film(name):
            self._pixels = Pixels(tuple(read_images(name)), self._chosen.channel)
        return Picture(self._pixels, uv[corners].astype(np.float64))
