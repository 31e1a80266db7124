# SPDX-License-Identifier: GPL-3.0-or-later
"""Deforming bodies to judge samples on, made from numbers alone: the same bytes every time."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.tracking import implicit
from benchmarks.tracking.implicit import Array, Faces
from benchmarks.tracking.rig import Bone, Rig, Vector

LENGTH = 96  # frames of a loop
FACES = 12_000


@dataclass(frozen=True)
class Animation:
    """A mesh that moves: faces (m, 3) and frames (t, v, 3).

    In a closed animation the last frame leads back to the first; another is played forth and back.
    """

    name: str
    faces: Faces
    frames: Array
    closed: bool = True

    @property
    def size(self) -> float:
        """Diagonal of the first frame's bounding box."""
        return float(np.linalg.norm(np.ptp(self.frames[0], axis=0)))

    @property
    def largest_motion(self) -> float:
        """Of a vertex from one frame to the next, relative to the size."""
        order = list(self.order(self.period))
        steps = (self.frames[b] - self.frames[a] for a, b in zip([0, *order], order, strict=False))
        return max(float(np.linalg.norm(step, axis=1).max()) for step in steps) / self.size

    @property
    def period(self) -> int:
        """Advances after which the first frame is there again."""
        count = len(self.frames)
        return count if self.closed else max(2 * (count - 1), 1)

    def order(self, advances: int) -> Iterator[int]:
        """The frames to advance to, one after another; period of them end at the first frame."""
        for k in range(1, advances + 1):
            place = k % self.period
            yield place if place < len(self.frames) else self.period - place


def _phases(length: int, cycles: int = 1) -> Array:
    return 2 * np.pi * cycles * np.arange(length) / length


def _there_and_back(phase: float) -> float:
    """From 0 to 1 and back, smoothly."""
    return float(1 - np.cos(phase)) / 2


def _bar(faces: int) -> tuple[Array, Faces]:
    """A round bar along x, four long, with round ends."""
    start, end = np.array([-1.6, 0, 0]), np.array([1.6, 0, 0])
    high = np.array([2.1, 0.5, 0.5])
    return implicit.mesh(
        lambda points: implicit.capsule(points, start, end, (0.4, 0.4)), -high, high, faces
    )


def bend(length: int = LENGTH, faces: int = FACES) -> Animation:
    """A bar bent to half a circle, to one side and the other."""
    rest, triangles = _bar(faces)

    def bent(angle: float) -> Array:
        x, y, z = rest.T
        curvature = angle / 4
        if abs(curvature) < 1e-9:
            return rest
        radius = 1 / curvature - y
        return np.column_stack(
            [radius * np.sin(curvature * x), 1 / curvature - radius * np.cos(curvature * x), z]
        )

    frames = [bent(0.9 * np.pi * np.sin(phase)) for phase in _phases(length)]
    return Animation("bend", triangles, np.stack(frames))


def twist(length: int = LENGTH, faces: int = FACES) -> Animation:
    """A square bar whose ends turn against each other, half a turn at most, each way."""
    half = np.array([2.0, 0.5, 0.5])
    rest, triangles = implicit.mesh(
        lambda points: implicit.rounded_box(points, half, 0.12), -1.2 * half, 1.2 * half, faces
    )

    def twisted(angle: float) -> Array:
        x, y, z = rest.T
        turn = angle * x / 4
        return np.column_stack(
            [x, np.cos(turn) * y - np.sin(turn) * z, np.sin(turn) * y + np.cos(turn) * z]
        )

    frames = [twisted(np.pi * np.sin(phase)) for phase in _phases(length)]
    return Animation("twist", triangles, np.stack(frames))


def bulge(length: int = LENGTH, faces: int = FACES) -> Animation:
    """A breathing ellipsoid: one side swells far out, three times in a loop."""
    axes = np.array([1.3, 1.0, 0.8])
    rest, triangles = implicit.mesh(
        lambda points: (np.linalg.norm(points / axes, axis=1) - 1) * axes.min(),
        -1.15 * axes,
        1.15 * axes,
        faces,
    )
    away = ((rest / axes - [0.5, 0, 0.866]) ** 2).sum(axis=1)
    shape = 0.55 * np.exp(-away / 0.35)
    outward = rest / axes**2
    outward /= np.linalg.norm(outward, axis=1)[:, None]
    frames = [
        (1 + 0.05 * breath) * rest + breath * shape[:, None] * outward
        for breath in map(_there_and_back, _phases(length, 3))
    ]
    return Animation("bulge", triangles, np.stack(frames))


def stretch(length: int = LENGTH, faces: int = FACES) -> Animation:
    """A bar whose middle fifth becomes three times as long, twice in a loop."""
    rest, triangles = _bar(faces)
    # The integral of a bump of height 1 between -0.6 and 0.6.
    inside = np.clip(rest[:, 0] / 0.6, -1, 1)
    grown = 0.3 * (inside + np.sin(np.pi * inside) / np.pi)
    frames = []
    for phase in _phases(length, 2):
        moved = rest.copy()
        moved[:, 0] += 2 * _there_and_back(phase) * grown
        frames.append(moved)
    return Animation("stretch", triangles, np.stack(frames))


def _leg(parent: str, name: str, x: float, side: int, bow: float) -> dict[str, Bone]:
    hip = (x, 0.2 * side, 0.82)
    knee = (x + bow, 0.24 * side, 0.46)
    foot = (x + 0.02, 0.25 * side, 0.1)
    return {
        f"{name}.upper": Bone(parent, hip, knee, (0.15, 0.095)),
        f"{name}.lower": Bone(f"{name}.upper", knee, foot, (0.095, 0.085)),
    }


CREATURE = {
    "hips": Bone(None, (0.0, 0, 0.92), (-0.5, 0, 0.9), (0.25, 0.27)),
    "chest": Bone("hips", (0.0, 0, 0.92), (0.5, 0, 0.95), (0.25, 0.29)),
    "neck": Bone("chest", (0.62, 0, 1.05), (0.88, 0, 1.38), (0.17, 0.13)),
    "head": Bone("neck", (0.9, 0, 1.43), (1.22, 0, 1.36), (0.18, 0.11)),
    "tail.1": Bone("hips", (-0.72, 0, 0.97), (-1.05, 0, 1.03), (0.11, 0.085)),
    "tail.2": Bone("tail.1", (-1.05, 0, 1.03), (-1.42, 0, 1.15), (0.085, 0.055)),
    **_leg("chest", "fore.left", 0.45, 1, -0.03),
    **_leg("chest", "fore.right", 0.45, -1, -0.03),
    **_leg("hips", "hind.left", -0.5, 1, 0.05),
    **_leg("hips", "hind.right", -0.5, -1, 0.05),
}
GAIT = {"fore.left": 0.0, "hind.right": 0.15, "fore.right": np.pi, "hind.left": np.pi + 0.15}


def _stride(phase: float) -> tuple[dict[str, Vector], Vector]:
    """Turns of the creature's bones and its shift, in degrees and units."""
    sway, bob = float(np.sin(phase)), float(np.cos(2 * phase))
    turns: dict[str, Vector] = {
        "hips": (0, 0, 4 * sway),
        "chest": (0, 1.5 * bob, -8 * sway),
        "neck": (0, 4 * bob, 3 * sway),
        "head": (0, -3 * bob, 2 * sway),
        "tail.1": (0, 0, 16 * sway),
        "tail.2": (0, 0, 22 * float(np.sin(phase - 0.8))),
    }
    for name, offset in GAIT.items():
        turns[f"{name}.upper"] = (0, -24 * float(np.sin(phase + offset)), 0)
        # The knee bends while the leg swings forward.
        fold = 38 * max(float(np.cos(phase + offset)), 0.0) ** 2
        turns[f"{name}.lower"] = (0, fold, 0)
    return turns, (0, 0, 0.03 * bob)


def walk(length: int = LENGTH, faces: int = FACES) -> Animation:
    """A four-legged creature that walks on the spot, two strides in a loop."""
    rig = Rig(CREATURE, faces, fillet=0.03, softness=0.05)
    frames = [rig.pose(*_stride(float(phase))) for phase in _phases(length, 2)]
    return Animation("walk", rig.faces, np.stack(frames))


def fold(length: int = LENGTH, faces: int = FACES) -> Animation:
    """A cloth whose one part folds over the other, until they lie less than a spacing apart."""
    columns = round((faces * 0.8) ** 0.5)
    rows = round(columns / 1.6)
    along = np.linspace(0, 1.6, columns + 1)
    across = np.linspace(0, 1, rows + 1)
    # The slope of the folded cloth: a loop of 230 degrees, then back to parallel.
    bends = [0, 0.7, 0.95, 1.0, 1.12, 1.6]
    slope = np.radians(np.interp(along, bends, [0, 0, 230, 230, 180, 180]))
    frames = []
    for phase in _phases(length):
        share = _there_and_back(float(phase))
        angle = share * slope
        middle = (angle[1:] + angle[:-1]) / 2
        step = 1.6 / columns
        x = np.concatenate([[0], np.cumsum(step * np.cos(middle))])
        z = np.concatenate([[0], np.cumsum(step * np.sin(middle))])
        waves = 0.02 * share * np.sin(2 * np.pi * across)
        rise = z[:, None] + waves[None, :]
        frames.append(
            np.stack(np.broadcast_arrays(x[:, None], across[None, :], rise), -1).reshape(-1, 3)
        )
    return Animation("fold", _grid(columns, rows), np.stack(frames))


def _grid(columns: int, rows: int) -> Faces:
    i, j = (index.ravel() for index in np.indices((columns, rows)))
    a = i * (rows + 1) + j
    b, c, d = a + rows + 1, a + rows + 2, a + 1
    return np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])]).astype(np.int32)


FIGURE = {
    "torso": Bone(None, (0, 0, -0.6), (0, 0, 0.45), (0.36, 0.4)),
    "head": Bone("torso", (0, 0, 0.95), (0, 0, 1.15), (0.2, 0.22)),
    "neck": Bone("torso", (0, 0, 0.7), (0, 0, 0.95), (0.15, 0.13)),
    "arm": Bone("torso", (0.46, 0, 0.6), (0.95, 0, 0.6), (0.16, 0.13)),
    "forearm": Bone("arm", (0.95, 0, 0.6), (1.42, 0, 0.6), (0.13, 0.11)),
}


def arm(length: int = LENGTH, faces: int = FACES) -> Animation:
    """An arm that comes down until forearm and torso touch, lies there and leaves again."""
    rig = Rig(FIGURE, faces, fillet=0.035, softness=0.05)
    frames = []
    for phase in _phases(length):
        down = min(1.15 * _there_and_back(float(phase)), 1.0)
        down = 3 * down**2 - 2 * down**3
        frames.append(rig.pose({"arm": (0, 78 * down, 0), "forearm": (0, 21.5 * down, 0)}))
    return Animation("arm", rig.faces, np.stack(frames))


def gallop(length: int = LENGTH, faces: int = FACES) -> Animation:
    """The creature of walk at a gallop: a stride in about 16 frames, its legs far out."""
    rig = Rig(CREATURE, faces, fillet=0.03, softness=0.05)
    frames = []
    for phase in _phases(length, max(round(length / 16), 1)):
        turns, _ = _stride(float(phase))
        wide = {name: (0, 1.6 * y, 0) for name, (_, y, _) in turns.items()}
        arch = 14 * float(np.sin(phase))
        wide |= {"hips": (0, -arch, 0), "chest": (0, arch, 0)}
        frames.append(rig.pose(wide, (0, 0, 0.1 * float(np.sin(phase)))))
    return Animation("gallop", rig.faces, np.stack(frames))


def flag(length: int = LENGTH, faces: int = FACES) -> Animation:
    """A cloth in the wind, held at one side: waves run along it and stretch it, three in a loop."""
    columns = round((faces * 0.8) ** 0.5)
    rows = round(columns / 1.6)
    x, y = np.meshgrid(np.linspace(0, 1.6, columns + 1), np.linspace(0, 1, rows + 1), indexing="ij")
    frames = []
    for phase in _phases(length, 3):
        z = 0.12 * x * np.sin(5.5 * x + 1.2 * y - phase) + 0.03 * x * np.sin(9 * y + phase)
        frames.append(np.stack([x, y, z], -1).reshape(-1, 3))
    return Animation("flag", _grid(columns, rows), np.stack(frames))


def shear(length: int = LENGTH, faces: int = FACES) -> Animation:
    """A ball whose belt turns against its poles, each way: its area stays where it is."""
    rest, triangles = _ball(faces)
    x, y, z = rest.T
    frames = []
    for phase in _phases(length):
        turn = 1.2 * np.sin(phase) * np.exp(-((z / 0.4) ** 2))
        turned = [np.cos(turn) * x - np.sin(turn) * y, np.sin(turn) * x + np.cos(turn) * y, z]
        frames.append(np.column_stack(turned))
    return Animation("shear", triangles, np.stack(frames))


def bud(length: int = LENGTH, faces: int = FACES) -> Animation:
    """A ball that a horn grows out of and shrinks again, twice in a loop, bent to one side."""
    rest, triangles = _ball(faces)
    shape = np.exp(-((rest - [0, 0, 1]) ** 2).sum(axis=1) / 0.09)
    frames = []
    for phase in _phases(length, 2):
        share = _there_and_back(float(phase))
        grown = rest + 0.9 * share * shape[:, None] * rest
        grown[:, 0] += 0.3 * share**2 * shape**2
        frames.append(grown)
    return Animation("bud", triangles, np.stack(frames))


def _ball(faces: int) -> tuple[Array, Faces]:
    high = np.full(3, 1.15)
    return implicit.mesh(lambda points: np.linalg.norm(points, axis=1) - 1, -high, high, faces)


GENERATED: dict[str, Callable[[int, int], Animation]] = {
    made.__name__: made
    for made in (bend, twist, bulge, stretch, walk, fold, arm, gallop, flag, shear, bud)
}


def load(folder: Path, name: str) -> Animation | None:
    """An animation of real data, meshes/anim_NAME/frames.npz; None where it is not there."""
    file = folder / "meshes" / f"anim_{name}" / "frames.npz"
    if not file.is_file():
        return None
    with np.load(file) as stored:
        frames = stored["frames"].astype(np.float64)
        return Animation(name, stored["F"].astype(np.int32), frames, closed=False)
