# SPDX-License-Identifier: GPL-3.0-or-later
"""The inputs of a result, by content: digests of values, numbers for shapes and places.

Names are not included: a renamed image is the same image. Places are in the axes of the surface, so
a scene can be moved as a whole, and are compared with a tolerance, since machines evaluate a little
differently.
"""

import base64
import hashlib
import json
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..settings.values import (
    MARKED,
    MATERIAL,
    DensitySettings,
    Settings,
    marks_of,
    materials_of,
)
from .arrays import Floats, SurfaceArrays, Surroundings, turn_of

# Roles that depend on the frame for most scenes: shapes and places.
PLACES = (
    "shape",
    "scale",
    "up",
    "north",
    "noise",
    "camera",
    "obstacles",
    "hiding",
    "targets",
    "others",
)
POSES = "poses"  # role of the other frames of a bake; known only where they were read
UNKNOWN = "unknown"  # digest of inputs that cannot be compared any more
_BLOCKS = 256  # number of sums that describe a shape, each over neighboring rows
_TOLERANCE = 1e-5  # relative to the largest number of a role


@dataclass(frozen=True)
class Sources:
    """Contents by role; the same role is the same input of the solution."""

    frame: float = 0.0  # of the animation
    capacity: float = 0.0  # integral of the density over the surface; 0: not known
    exact: dict[str, str] = field(default_factory=dict)  # digests
    near: dict[str, Floats] = field(default_factory=dict)  # (k, d) numbers
    moving: tuple[str, ...] = ()  # roles that differ between the frames of a bake

    def text(self) -> str:
        """The text that is stored with a result."""
        near = {name: [_packed(one), one.shape[1]] for name, one in self.near.items()}
        return json.dumps(
            {
                "frame": self.frame,
                "capacity": self.capacity,
                "exact": self.exact,
                "near": near,
                "moving": self.moving,
            },
            sort_keys=True,
        )


def sources_from(text: str) -> Sources | None:
    """The stored sources; None if the text is invalid."""
    try:
        stored = json.loads(text)
        exact = {str(name): str(digest) for name, digest in stored["exact"].items()}
        near = {str(name): _unpacked(*packed) for name, packed in stored["near"].items()}
        moving = tuple(map(str, stored["moving"]))
        return Sources(float(stored["frame"]), float(stored["capacity"]), exact, near, moving)
    except (ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError):
        return None


def _packed(values: Floats) -> str:
    return base64.b64encode(values.astype("<f4").tobytes()).decode()


def _unpacked(packed: str, width: int) -> Floats:
    stored = np.frombuffer(base64.b64decode(packed), dtype="<f4")
    found: Floats = stored.reshape(-1, width).astype(np.float64)
    return found


@dataclass(frozen=True)
class Pose:
    """Position, rotation and size of a surface."""

    center: Floats  # (3,)
    turn: Floats  # (3, 3) its own axes, without scale, as columns
    size: float

    def local(self, points: Floats) -> Floats:
        """Positions (n, 3) in the axes of the surface, in units of its size."""
        found: Floats = (points - self.center) @ self.turn / self.size
        return found


@dataclass(frozen=True)
class Outline:
    """What describes the shape of a surface, without its arrays."""

    topology: str
    pose: Pose
    shape: Floats  # (k, 3) sums of its vertices, in its own axes and with its scale
    scale: Floats  # (3, 3) what the object stretches its mesh by, in the mesh's axes
    origin: Floats  # (3,) of the object


def outline_of(arrays: SurfaceArrays) -> Outline:
    """The outline of a surface."""
    turn, linear = turn_of(arrays.matrix), arrays.matrix[:3, :3]
    columns = turn.T @ arrays.vertices.T  # each coordinate in one block of memory, which is faster
    pose = Pose(arrays.matrix[:3, 3], turn, 1.0)
    if len(arrays.vertices):
        size = float(np.linalg.norm(np.ptp(columns, axis=1)))
        pose = Pose(arrays.vertices.mean(axis=0), turn, max(size, 1e-30))
    shape = _sums((columns - (turn.T @ pose.center)[:, None]).T)
    return Outline(arrays.topology, pose, shape, turn.T @ linear, arrays.matrix[:3, 3])


def sources_of(arrays: SurfaceArrays, settings: Settings, capacity: float = 0.0) -> Sources:
    """The sources of a surface that was read with all inputs of the settings."""
    outline = outline_of(arrays)
    values = {
        name: arrays.digests.get(name) or digest_of([one]) for name, one in arrays.weights.items()
    }
    own = surface_sources(outline, values, settings)
    if arrays.poses:
        places = np.concatenate([outline.pose.local(one) for one in arrays.poses])
        own = replace(own, near=own.near | {POSES: _sums(places)})
    nearby = around_sources(outline.pose, arrays.around)
    return replace(joined(own, nearby), frame=arrays.time, capacity=capacity)


def joined(own: Sources, nearby: Sources) -> Sources:
    """The sources of a surface and of its surroundings."""
    return replace(own, exact=own.exact | nearby.exact, near=own.near | nearby.near)


def surface_sources(outline: Outline, values: dict[str, str], settings: Settings) -> Sources:
    """The sources of a surface: faces, digests of values by name, shape, and orientation if it
    matters.
    """
    density = settings.density
    roles = {role: values[name] for role, name in value_roles(settings).items()}
    near = {"shape": outline.shape, "scale": outline.scale}
    near |= _standing(outline, density)
    return Sources(exact={"faces": outline.topology, **roles}, near=near)


def _standing(outline: Outline, density: DensitySettings) -> dict[str, Floats]:
    """The orientation of a surface in the world and the origin of its object, if they matter."""
    pose, found = outline.pose, {}
    in_plan = density.use_distance and density.ignore_height
    if density.use_slope or density.use_height or density.use_aspect or in_plan:
        height = pose.center[2] / pose.size if density.use_height else 0.0
        found["up"] = np.array([[*pose.turn[2], height]])
    if density.use_aspect:
        found["north"] = pose.turn[1:2]
    if density.use_noise:
        found["noise"] = pose.local(outline.origin[None])
    return found


def on_faces(stored: str, arrays: SurfaceArrays) -> str:
    """Stored sources of a solution that was bound to another surface.

    Values at vertices of other faces cannot be compared any more.
    """
    before = sources_from(stored)
    if before is None or before.exact.get("faces") == arrays.topology:
        return stored
    outline = outline_of(arrays)
    unknown = {role: UNKNOWN for role in before.exact if is_of_faces(role)}
    exact = before.exact | unknown | {"faces": outline.topology}
    return replace(before, exact=exact, near=before.near | {"shape": outline.shape}).text()


def is_of_faces(role: str) -> bool:
    """Whether a role can only be compared on the same faces."""
    values = ("shape", "density", "blocked", "material", "edges", "uv")
    return role in values or role.startswith("class ")


def value_roles(settings: Settings) -> dict[str, str]:
    """Names of the surface's values by their roles."""
    named = {"density": settings.density.attribute, "blocked": settings.density.blocked_areas}
    named["material"] = MATERIAL if materials_of(settings.density) else ""
    named["edges"] = MARKED if marks_of(settings) else ""
    named |= {f"class {k}": kind.density for k, kind in enumerate(settings.object_types)}
    return {role: name for role, name in named.items() if name}


def around_sources(pose: Pose, around: Surroundings) -> Sources:
    """The sources of a surface's surroundings, relative to its pose."""
    exact, near = {}, {}
    if around.image is not None:
        exact["image"] = digest_of([around.image])
    elif around.tiles:
        numbers = np.array([number for number, _ in around.tiles])
        exact["image"] = digest_of([numbers, *(picture for _, picture in around.tiles)])
    if around.uv is not None:
        exact["uv"] = digest_of([around.uv])
    if around.camera is not None:
        near["camera"] = _seen(pose, around.camera)
    for role, meshes in (("obstacles", around.obstacles), ("hiding", around.hiding)):
        if meshes:
            exact[role] = digest_of(faces for _, faces in meshes)
            places = np.concatenate([vertices for vertices, _ in meshes])
            near[role] = _sums(pose.local(places))
    if around.targets or len(around.lines):
        ends = around.lines.reshape(-1, 3)
        exact["targets"] = digest_of(
            [np.array([len(ends)]), *(faces for _, faces in around.targets)]
        )
        corners = np.concatenate([ends, *(vertices for vertices, _ in around.targets)])
        near["targets"] = _sums(pose.local(corners))
    if len(around.points) or len(around.hulls):
        near["others"] = _sums(_spheres(pose, around))
    if len(around.hulls):
        exact["others"] = digest_of([around.hull_counts])
    return Sources(exact=exact, near=near)


def _spheres(pose: Pose, around: Surroundings) -> Floats:
    """Places and radii (k, 4) that points avoid; corners of shapes have none."""
    rows = np.column_stack([pose.local(around.points), around.radii])
    corners = pose.local(around.hulls)
    return np.concatenate([rows, np.column_stack([corners, np.zeros(len(corners))])])


def differing(before: Sources, now: Sources) -> list[str]:
    """Roles whose contents are not the same; the poses only count if they are known now."""
    exact = [
        role
        for role in before.exact.keys() | now.exact.keys()
        if before.exact.get(role) not in (UNKNOWN, now.exact.get(role))
    ]
    roles = now.near.keys() | (before.near.keys() - {POSES})
    near = [role for role in roles if not _same(role, before, now)]
    return sorted({*exact, *near})


def _same(role: str, before: Sources, now: Sources) -> bool:
    one, other = before.near.get(role), now.near.get(role)
    if one is None or other is None or one.shape != other.shape:
        return False
    largest = float(np.abs(one).max(initial=0.0))
    return bool(np.abs(one - other).max(initial=0.0) <= _TOLERANCE * largest)


def _seen(pose: Pose, camera: Floats) -> Floats:
    """The part of a camera's matrix that determines the places in the picture."""
    there = np.eye(4)
    there[:3, :3], there[:3, 3] = pose.turn * pose.size, pose.center
    found: Floats = (camera @ there)[[0, 1, 3]]
    return found


def _sums(rows: Floats) -> Floats:
    """Sums (k, d) of neighboring rows with fixed random signs, sensitive to any change."""
    count = len(rows)
    blocks = min(count, _BLOCKS)
    if not blocks:
        return np.empty((0, rows.shape[1]))
    mixed = np.arange(count, dtype=np.uint32) * np.uint32(2654435761)
    signs = 1.0 - 2.0 * (mixed >> np.uint32(31))
    starts = np.arange(blocks) * count // blocks
    sums = np.add.reduceat(np.ascontiguousarray(rows.T) * signs, starts, axis=1)
    found: Floats = sums.T / np.sqrt(np.diff(np.append(starts, count)))[:, None]
    return found


def digest_of(arrays: Iterable[Any]) -> str:
    """Digest of arrays, their order and shapes."""
    digest = hashlib.blake2b(digest_size=16)
    for array in arrays:
        digest.update(f"{array.shape}".encode())
        digest.update(np.ascontiguousarray(array).data)
    return digest.hexdigest()
