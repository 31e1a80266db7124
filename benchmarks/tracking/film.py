# SPDX-License-Identifier: GPL-3.0-or-later
"""Films to look at: each contender on the same body, with trails of what slides along it.

A trail leads through the places where a sample was in the frames before, all carried to the present
frame: without slide there is none, smooth slide draws a curve, jerk a zigzag.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import dapple3d as dapple
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from benchmarks.tracking.animations import Animation
from benchmarks.tracking.blender_points import Met, Scattered
from benchmarks.tracking.contenders import entered
from benchmarks.tracking.implicit import Array, Faces

SECONDS = 2
PANEL = 340  # pixels across
TRAIL = 10  # frames
SHOWN = 4  # frames of the strip, TRAIL apart from the first to the last
ZOOM = 0.55  # of the body's width, that the strip shows
COLORS = 64  # of the strip, which keeps it small
TURN, TILT = np.radians((-35.0, 20.0))  # of the camera
LIGHT = np.array([-0.3, 0.5, 0.8])
BODY, POINT, CHANGE = np.array([0.93, 0.91, 0.87]), "#23395d", "#e07b00"


@dataclass(frozen=True)
class Shot:
    """A frame of a contender."""

    points: Array  # (n, 3)
    normals: Array  # (n, 3)
    new: NDArray[np.bool_]  # (n,): not there a frame before
    trails: Array  # (n, k, 3): through the places before, to the present one


@dataclass(frozen=True)
class Take:
    """A contender, frame by frame."""

    title: str
    shots: list[Shot]


def taken(animation: Animation, start: dapple.Samples, contender: str, title: str) -> Take:
    """A contender that carries samples from frame to frame, over a period."""
    surface = dapple.Surface(animation.frames[0], animation.faces)
    order = list(animation.order(animation.period))
    frames = [animation.frames[frame] for frame in order]
    one = entered(contender, surface, start, frames)
    past = [(np.asarray(start.faces), np.asarray(start.barycentric))]
    shots = []
    for vertices in frames:
        samples = one.advance(vertices).samples
        past = [*past, (np.asarray(samples.faces), np.asarray(samples.barycentric))][-TRAIL:]
        trails = [_places(vertices, animation.faces, *places) for places in past]
        new = np.zeros(len(samples), dtype=bool)
        shots.append(Shot(samples.positions, samples.normals, new, np.stack(trails, axis=1)))
    return Take(title, shots)


def taken_by_node(
    animation: Animation, found: Scattered, meetings: Sequence[Met], title: str
) -> Take:
    """Blender's node, whose points begin anew on every frame."""
    first = dapple.Surface(animation.frames[0], animation.faces)
    order = animation.order(len(meetings))
    shots = []
    for frame, points, one in zip(order, found.points[1:], meetings, strict=True):
        on = dapple.project(first.deformed(animation.frames[frame]), points)
        normals = _normals(animation.frames[frame], animation.faces)[on.faces]
        shots.append(Shot(points, normals, one.new, points[:, None]))
    return Take(title, shots)


def write_film(animation: Animation, takes: Sequence[Take], file: Path) -> None:
    """All takes side by side, over a period: an animated WebP of two seconds."""
    count = len(takes[0].shots)
    box = _bounds(animation.frames.reshape(-1, 3))
    images = [_pictures(animation, takes, frame, box, upright=False) for frame in range(count)]
    duration = round(1000 * SECONDS / count)
    images[0].save(file, append_images=images[1:], duration=duration, loop=0, quality=60)


def write_strip(animation: Animation, takes: Sequence[Take], middle: int, file: Path) -> None:
    """Some frames around one, a row for each take, of the part of the body where most slides."""
    frames = [middle + round(TRAIL * (k / (SHOWN - 1) - 0.5)) for k in range(SHOWN)]
    count = len(takes[0].shots)
    box = _nearer(_bounds(animation.frames.reshape(-1, 3)), takes[-1].shots[middle % count])
    columns = [_pictures(animation, takes, frame % count, box, upright=True) for frame in frames]
    strip = Image.new("RGB", (sum(one.width for one in columns), columns[0].height), "white")
    for k, one in enumerate(columns):
        strip.paste(one, (k * one.width, 0))
    strip.quantize(COLORS, dither=Image.Dither.NONE).save(file, optimize=True)


@dataclass(frozen=True)
class Box:
    """What a picture shows, as the camera sees it."""

    middle: Array  # (2,)
    half: Array  # (2,)


def _bounds(vertices: Array) -> Box:
    seen = _seen(vertices)[:, :2]
    low, high = seen.min(axis=0), seen.max(axis=0)
    return Box((low + high) / 2, 0.54 * (high - low))


def _nearer(box: Box, shot: Shot) -> Box:
    """As wide as ZOOM, around what slides farthest of what the camera sees."""
    lengths = np.linalg.norm(np.ptp(shot.trails, axis=1), axis=1)
    lengths[_seen(shot.normals)[:, 2] < 0] = 0
    farthest = lengths >= np.quantile(lengths, 0.9)
    middle = np.median(_seen(shot.points[farthest])[:, :2], axis=0)
    return Box(middle, np.array([1, 0.62]) * ZOOM * box.half[0])


def _pictures(
    animation: Animation, takes: Sequence[Take], frame: int, box: Box, *, upright: bool
) -> Image.Image:
    """Of a frame, the takes beside or below each other."""
    order = list(animation.order(animation.period))
    rows, columns = (len(takes), 1) if upright else (1, len(takes))
    height = round(PANEL * box.half[1] / box.half[0])
    figure = Figure(figsize=(columns * PANEL / 100, rows * height / 100), dpi=100)
    for axes, take in zip(figure.subplots(rows, columns, squeeze=False).flat, takes, strict=True):
        _draw(axes, animation.frames[order[frame]], animation.faces, take.shots[frame])
        (x, y), (width, tall) = box.middle, box.half
        axes.set(xlim=(x - width, x + width), ylim=(y - tall, y + tall))
        axes.text(0.02, 0.97, take.title, fontsize=8, va="top", transform=axes.transAxes)
    figure.subplots_adjust(0, 0, 1, 1, 0, 0)
    drawn = io.BytesIO()
    figure.savefig(drawn)
    return Image.open(drawn).convert("RGB")


def _draw(axes: Axes, vertices: Array, faces: Faces, shot: Shot) -> None:
    seen, toward = _seen(vertices), _seen(_normals(vertices, faces))
    front = np.flatnonzero(toward[:, 2] > 0)
    front = front[np.argsort(seen[faces[front], 2].mean(axis=1))]
    shade = 0.72 + 0.28 * np.clip(toward[front] @ LIGHT / np.linalg.norm(LIGHT), 0, 1)
    colors = shade[:, None] * BODY
    body = PolyCollection(
        list(seen[faces[front], :2]), facecolors=colors, edgecolors=colors, linewidths=0.3
    )
    axes.add_collection(body)
    points = _seen(shot.points)
    visible = (_seen(shot.normals)[:, 2] > 0.1) & ~_hidden(points, seen[faces[front]])
    trails = _seen(shot.trails[visible])[..., :2]
    axes.add_collection(LineCollection(list(trails), colors=CHANGE, linewidths=1.1))
    for shown, color, size in ((~shot.new, POINT, 7), (shot.new, CHANGE, 16)):
        x, y, _ = points[visible & shown].T
        axes.scatter(x, y, s=size, c=color, linewidths=0)
    axes.set_aspect("equal")
    axes.set_axis_off()


def _hidden(points: Array, triangles: Array) -> NDArray[np.bool_]:
    """Which points (n, 3) lie behind one of the triangles (m, 3, 3), as the camera sees them."""
    a, b, c = np.moveaxis(triangles, 1, 0)
    near = 0.02 * float(np.ptp(triangles[..., 2]))
    doubled = _cross(b - a, c - a)
    result = np.zeros(len(points), dtype=bool)
    for k, point in enumerate(points):
        u, v = _cross(point - a, c - a) / doubled, _cross(b - a, point - a) / doubled
        inside = (u >= 0) & (v >= 0) & (u + v <= 1)
        depth = a[:, 2] + u * (b - a)[:, 2] + v * (c - a)[:, 2]
        result[k] = bool((depth[inside] > point[2] + near).any())
    return result


def _cross(a: Array, b: Array) -> Array:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def _seen(vectors: Array) -> Array:
    """Right, up and toward the camera."""
    x, y, z = np.moveaxis(vectors, -1, 0)
    right, away = np.cos(TURN) * x - np.sin(TURN) * y, np.sin(TURN) * x + np.cos(TURN) * y
    up, toward = np.cos(TILT) * z + np.sin(TILT) * away, np.sin(TILT) * z - np.cos(TILT) * away
    return np.stack([right, up, toward], axis=-1)


def _places(vertices: Array, faces: Faces, on: NDArray[np.int32], weights: Array) -> Array:
    return np.asarray(np.einsum("nk,nkd->nd", weights, vertices[faces[on]]))


def _normals(vertices: Array, faces: Faces) -> Array:
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    normals = np.cross(b - a, c - a)
    return np.asarray(normals / np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None])
