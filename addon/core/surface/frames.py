# SPDX-License-Identifier: GPL-3.0-or-later
"""Tangent frames of bound points, and the angle carried from keyframe to keyframe.

The axis z of a frame is the normal of the surface as it is shaded there, interpolated from the
corners of the triangle (with flat faces, sharp edges and custom normals they differ from those of
the vertices). The axis x is the first edge of the triangle, rotated together with the triangle's
plane by the smallest rotation that makes it perpendicular to z. (Edges that meet in a tip may point
along z; made perpendicular without that rotation, x would spin there.) The frame moves with the
material, so it never jumps while a point keeps its triangle. When a keyframe moves the point to
another triangle, its angle is chosen so that the direction stays: the old direction, moved with the
material to the new frame, is transported along the surface to the new place (by the smallest
rotation between both normals, which is parallel transport over a short distance) and measured
against the new first edge.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..base.native import package
from ..settings.tables import AXES
from .arrays import Floats, Ints, SurfaceArrays
from .records import Binding

SMOOTH = 180.0  # degrees; no edge is sharp
LEAST_HEIGHT = 0.1  # least 1 + cosine between a triangle and its normal, which may be opposite
_TINY = 1e-30


@dataclass(frozen=True)
class Frames:
    """Orthonormal axes (n, 3) of n points."""

    tangent: Floats
    bitangent: Floats
    normal: Floats

    def direction(self, angle: Floats) -> Floats:
        """Unit tangent vectors at these angles from the tangent."""
        return np.cos(angle)[:, None] * self.tangent + np.sin(angle)[:, None] * self.bitangent

    def axes(self, angle: Floats) -> Floats:
        """Matrices (n, 3, 3): columns are the direction at the angle, its left, the normal."""
        ahead = self.direction(angle)
        return np.stack([ahead, np.cross(self.normal, ahead), self.normal], axis=2)

    def angle(self, direction: Floats) -> Floats:
        """Angles of tangent vectors."""
        return np.arctan2(_dot(direction, self.bitangent), _dot(direction, self.tangent))


@dataclass(frozen=True)
class Normals:
    """Shading normals of a surface: of its vertices, or of the mesh's face corners."""

    values: Floats  # (v, 3) or (c, 3)
    of_corners: bool = False

    def at(self, binding: Binding) -> Floats:
        """Unit normals (n, 3) at bound points."""
        rows = binding.loops if self.of_corners else binding.corners
        return _unit(binding.interpolated(self.values[rows]))


def smooth(vertices: Floats, faces: Ints) -> Normals:
    """Shading normals of a surface that is smooth everywhere."""
    return Normals(package().density.vertex_normals(vertices, faces))


def shading(surface: SurfaceArrays, faces: Ints | None = None) -> Normals:
    """Shading normals of a surface, optionally with other faces (m, 3)."""
    if surface.normals is not None:
        return Normals(surface.normals, of_corners=True)
    return smooth(surface.vertices, surface.faces if faces is None else faces)


def corner_normals(surface: SurfaceArrays) -> Floats:
    """Unit shading normals (m, 3, 3) at the corners of the faces."""
    if surface.normals is None:
        found: Floats = package().density.vertex_normals(surface.vertices, surface.faces)
        return found[surface.faces]
    found = _unit(surface.normals)[surface.face_corners]
    return found


def shaded(surface: SurfaceArrays) -> dict[str, Any]:
    """Options of a dapple.Surface with the same shading."""
    if surface.normals is None:
        return {"sharp_angle": SMOOTH}
    return {"normals": corner_normals(surface)}


def frames(binding: Binding, vertices: Floats, normals: Normals) -> Frames:
    """Frames of bound points on a surface with these vertices and shading normals."""
    normal = normals.at(binding)
    corner, *others = (vertices[binding.corners[:, k]] for k in range(3))
    edge, second = others[0] - corner, others[1] - corner
    flat = _unit(np.cross(edge, second))
    height = np.maximum(1.0 + _dot(flat, normal), LEAST_HEIGHT)
    edge = edge - (_dot(edge, normal) / height)[:, None] * flat
    tangent = _unit(edge - _dot(edge, normal)[:, None] * normal)
    return Frames(tangent, np.cross(normal, tangent), normal)


def transport(direction: Floats, normal: Floats, other: Floats) -> Floats:
    """Tangent vectors at normal -> at other, by the smallest rotation between both normals."""
    axis = np.cross(normal, other)
    cosine = _dot(normal, other)
    once = np.cross(axis, direction)
    twice = np.cross(axis, once)
    turned = direction + once + twice / np.maximum(1.0 + cosine, 1e-6)[:, None]
    return _unit(turned - _dot(turned, other)[:, None] * other)


def carried(before: Binding, after: Binding, vertices: Floats, normals: Normals) -> Binding:
    """The binding `after` with the angles that keep the previous directions on these vertices."""
    old, new = frames(before, vertices, normals), frames(after, vertices, normals)
    direction = transport(old.direction(before.angle), old.normal, new.normal)
    return replace(after, angle=new.angle(direction))


def _dot(a: Floats, b: Floats) -> Floats:
    return np.einsum("nd,nd->n", a, b)


def _unit(vectors: Floats) -> Floats:
    lengths = np.sqrt(_dot(vectors, vectors))
    return vectors / np.maximum(lengths, _TINY)[:, None]


def pointing(binding: Binding, surface: SurfaceArrays, forward: str) -> Binding:
    """The binding with angles that turn each point's X axis along an axis of the surface object.

    The axis is projected onto the surface. NONE keeps the angles.
    """
    if forward == "NONE":
        return binding
    along = surface.matrix[:3, :3] @ AXES[forward]
    local = frames(binding, surface.vertices, shading(surface))
    angles = local.angle(np.broadcast_to(along, local.normal.shape))
    return replace(binding, angle=angles)
