# SPDX-License-Identifier: GPL-3.0-or-later
"""A surface as it is seen from one side: shaded cells, dots and values.

Each pixel knows the place of the surface that it shows, so cells and dots are found by the sites
nearest to that place and are hidden and foreshortened as the surface is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib import colormaps
from numpy.typing import NDArray
from PIL import Image, ImageDraw
from scipy.spatial import cKDTree  # type: ignore[import-untyped]

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]

FINE = 2  # pixels computed for each one shown, each way
LIGHT = np.array([-0.35, 0.55, 0.76]) / np.linalg.norm([-0.35, 0.55, 0.76])
STONE = np.array([0.87, 0.86, 0.83])
LINE = np.array([0.16, 0.18, 0.24])


def view(up: str, azimuth: float, elevation: float) -> Array:
    """Rows (3, 3): right, up and toward the eye. Angles in degrees.

    At azimuth 0 the eye is at z where y is up, and at -y where z is up.
    """
    axes = np.eye(3) if up == "y" else np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
    a, e = np.radians([azimuth, elevation])
    turn = np.array([[np.cos(a), 0, -np.sin(a)], [0, 1, 0], [np.sin(a), 0, np.cos(a)]])
    tilt = np.array([[1, 0, 0], [0, np.cos(e), -np.sin(e)], [0, np.sin(e), np.cos(e)]])
    return np.asarray(tilt @ turn @ axes)


@dataclass(frozen=True)
class Frame:
    """What part of the plane of view a picture shows: its lower left and upper right corners."""

    low: Array
    high: Array

    @staticmethod
    def around(points: Array, eye: Array) -> Frame:
        """All points (n, 3), with a margin."""
        flat = points @ eye[:2].T
        low, high = flat.min(axis=0), flat.max(axis=0)
        margin = 0.03 * (high - low).max()
        return Frame(low - margin, high + margin)


class Scene:
    """A mesh in view, `width` pixels wide."""

    def __init__(
        self,
        vertices: Array,
        faces: NDArray[np.int32],
        eye: Array,
        frame: Frame | None = None,
        width: int = 420,
    ) -> None:
        frame = frame or Frame.around(vertices, eye)
        self._faces, self._eye = faces, eye
        self._scale = FINE * width / (frame.high - frame.low)[0]
        self._seen = vertices @ eye.T
        rows = FINE * round((frame.high - frame.low)[1] * self._scale / FINE)
        self._flat = np.column_stack(
            [
                (self._seen[:, 0] - frame.low[0]) * self._scale,
                (frame.high[1] - self._seen[:, 1]) * self._scale,
            ]
        )
        self._face = self._draw_faces(FINE * width, rows)
        self._hit = self._face >= 0
        self._weights = self._barycentric()
        self.places = self._blend(vertices)  # (hits, 3): of the pixels that show the surface
        self._shade = self._shading()

    def cells(self, sites: Array, colors: Array | None = None) -> Picture:
        """Cells of sites (n, 3), outlined; colors (n, 3) in 0..1."""
        _, owner = cKDTree(sites).query(self.places)
        base = STONE if colors is None else colors[owner]
        return self._finish(self._outlined(self._paint(base), owner))

    def dots(self, sites: Array, colors: Array, radii: float | Array) -> Picture:
        """Round dots at sites (n, 3); colors (n, 3) in 0..1, radii in the unit of the mesh."""
        away, owner = cKDTree(sites).query(self.places)
        inside = away < np.broadcast_to(radii, len(sites))[owner]
        return self._finish(self._paint(np.where(inside[:, None], colors[owner], STONE)))

    def values(self, values: Array, color_map: str = "viridis") -> Picture:
        """Values (v,) at the vertices, from their least to their largest."""
        span = max(float(np.ptp(values)), 1e-300)
        at = (self._blend(values[:, None])[:, 0] - values.min()) / span
        return self._finish(self._paint(colormaps[color_map](at)[:, :3]))

    def _draw_faces(self, columns: int, rows: int) -> NDArray[np.int64]:
        """The face in front at each pixel, or -1: painted from the farthest to the nearest."""
        image = Image.new("I", (columns, rows), -1)
        draw = ImageDraw.Draw(image)
        corners = self._flat[self._faces]
        for face in np.argsort(self._seen[self._faces, 2].mean(axis=1), kind="stable"):
            draw.polygon([tuple(corner) for corner in corners[face]], fill=int(face))
        return np.asarray(image, np.int64)

    def _barycentric(self) -> Array:
        """(hits, 3), clipped to the face: pixels at its rim count as on it."""
        row, column = np.nonzero(self._hit)
        a, b, c = np.moveaxis(self._flat[self._faces[self._face[self._hit]]], 1, 0)
        u, v = b - a, c - a
        p = np.column_stack([column, row]) - a
        twice = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
        twice = np.where(np.abs(twice) < 1e-12, 1e-12, twice)
        second = (p[:, 0] * v[:, 1] - p[:, 1] * v[:, 0]) / twice
        third = (u[:, 0] * p[:, 1] - u[:, 1] * p[:, 0]) / twice
        weights = np.clip(np.column_stack([1 - second - third, second, third]), 0, 1)
        return np.asarray(weights / weights.sum(axis=1)[:, None])

    def _blend(self, at_vertices: Array) -> Array:
        corners = at_vertices[self._faces[self._face[self._hit]]]
        return np.asarray(np.einsum("hk,hkd->hd", self._weights, corners))

    def _shading(self) -> Array:
        """(hits,): light on smooth normals, both sides alike."""
        corners = self._seen[self._faces]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        sums = np.zeros_like(self._seen)
        np.add.at(sums, self._faces.ravel(), np.repeat(normals, 3, axis=0))
        smooth = self._blend(sums)
        smooth /= np.maximum(np.linalg.norm(smooth, axis=1), 1e-300)[:, None]
        smooth *= np.where(smooth[:, 2:] < 0, -1, 1)
        return np.asarray(0.45 + 0.6 * np.clip(smooth @ LIGHT, 0, 1))

    def _paint(self, colors: Array) -> Array:
        """White paper with shaded colors (hits, 3) or (3,) on the surface."""
        paper = np.ones((*self._hit.shape, 3))
        paper[self._hit] = np.clip(colors * self._shade[:, None], 0, 1)
        return paper

    def _outlined(self, paper: Array, owner: NDArray[np.int64]) -> Array:
        """Lines where pixels that touch have different owners."""
        owners = np.full(self._hit.shape, -1)
        owners[self._hit] = owner
        edge = np.zeros_like(self._hit)
        edge[:, 1:] |= owners[:, 1:] != owners[:, :-1]
        edge[1:] |= owners[1:] != owners[:-1]
        paper[edge & self._hit] = LINE
        return paper

    @staticmethod
    def _finish(paper: Array) -> Picture:
        rows, columns, _ = paper.shape
        blocks = paper.reshape(rows // FINE, FINE, columns // FINE, FINE, 3)
        return np.asarray(255 * blocks.mean(axis=(1, 3)) + 0.5, np.uint8)
