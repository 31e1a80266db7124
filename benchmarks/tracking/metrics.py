# SPDX-License-Identifier: GPL-3.0-or-later
"""How samples behave from frame to frame. Lengths are in spacings of the frame, angles in degrees.

The judge is the same for every contender: connected cells, whatever cells it optimizes.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field

import dapple3d as dapple
import numpy as np
from numpy.typing import NDArray

from benchmarks.tracking.animations import Animation
from benchmarks.tracking.contenders import Step, carried, entered
from benchmarks.tracking.implicit import Array

STEADY = 500  # advances over which a pattern shows its drift


@dataclass
class Run:
    """A contender on an animation: for each advance a row of every list."""

    animation: str
    contender: str
    first: dict[str, float]  # the first frame's energy, bond_order, alpha_min, capacity_variation
    energy: list[float] = field(default_factory=list)
    alpha_min: list[float] = field(default_factory=list)
    capacity_variation: list[float] = field(default_factory=list)
    bond_order: list[float] = field(default_factory=list)
    evaluations: list[int] = field(default_factory=list)
    parts: list[int] = field(default_factory=list)  # a frame of far motion is split
    milliseconds: list[float] = field(default_factory=list)
    slide_mean: list[float] = field(default_factory=list)
    slide_max: list[float] = field(default_factory=list)
    jerk_mean: list[float] = field(default_factory=list)
    jerk_max: list[float] = field(default_factory=list)
    turn_max: list[float] = field(default_factory=list)
    jerk_p99: float | None = None  # of all samples on all frames
    hysteresis: float | None = None  # mean distance from the start after the last loop


def play(animation: Animation, samples: dapple.Samples, contender: str, advances: int) -> Run:
    """Carry samples of the first frame through so many advances of the animation."""
    surface = dapple.Surface(animation.frames[0], animation.faces)
    order = list(animation.order(advances))
    one = entered(contender, surface, samples, [animation.frames[frame] for frame in order])
    run = Run(animation.name, contender, quality(surface, samples))
    start = samples.positions
    slide = np.zeros_like(start)
    jerks: list[Array] = []
    for advance, frame in enumerate(order, 1):
        ridden = carried(surface.deformed(animation.frames[frame]), samples)
        began = time.perf_counter()
        step = one.advance(animation.frames[frame])
        run.milliseconds.append(1000 * (time.perf_counter() - began))
        slide, jerk = _note(run, surface, samples, slide, ridden, step)
        jerks.append(jerk)
        surface, samples = step.surface, step.samples
        if advance % animation.period == 0:
            way = np.linalg.norm(samples.positions - start, axis=1)
            run.hysteresis = float(way.mean()) / surface.spacing(len(start))
    run.jerk_p99 = float(np.quantile(np.concatenate(jerks), 0.99))
    return run


def quality(surface: dapple.Surface, samples: dapple.Samples) -> dict[str, float]:
    """Energy, bond order, alpha min and capacity variation, with connected cells."""
    report = dapple.analyze(surface, samples)
    return {
        "energy": report.energy,
        "bond_order": report.bond_order,
        "alpha_min": report.alpha_min,
        "capacity_variation": report.capacity_variation,
    }


def _note(
    run: Run,
    surface: dapple.Surface,
    before: dapple.Samples,
    slide_before: Array,
    ridden: dapple.Samples,
    step: Step,
) -> tuple[Array, Array]:
    """Add a row; the slide (n, 3) of this advance, which is slide_before at the next; the jerk."""
    for name, value in quality(step.surface, step.samples).items():
        getattr(run, name).append(value)
    spacing = step.surface.spacing(len(ridden))
    slide = np.asarray(step.samples.positions - ridden.positions)
    turned = turn_with_faces(surface, step.surface, np.asarray(before.faces), slide_before)
    slid = np.linalg.norm(slide, axis=1) / spacing
    jerk = np.linalg.norm(slide - turned, axis=1) / spacing
    run.evaluations.append(step.evaluations)
    run.parts.append(step.parts)
    run.slide_mean.append(float(slid.mean()))
    run.slide_max.append(float(slid.max()))
    run.jerk_mean.append(float(jerk.mean()))
    run.jerk_max.append(float(jerk.max()))
    run.turn_max.append(float(turn(ridden.normals, step.samples.normals).max()))
    return slide, jerk


def face_frames(surface: dapple.Surface, faces: NDArray[np.int32]) -> Array:
    """Orthonormal axes (n, 3, 3) in columns: the first edge, across it in the face, the normal."""
    a, b, c = np.moveaxis(surface.vertices[surface.faces[faces]], 1, 0)
    along = b - a
    normal = np.cross(along, c - a)
    along = along / np.maximum(np.linalg.norm(along, axis=1), 1e-300)[:, None]
    normal = normal / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    return np.stack([along, np.cross(normal, along), normal], axis=-1)


def turn_with_faces(
    before: dapple.Surface, after: dapple.Surface, faces: NDArray[np.int32], vectors: Array
) -> Array:
    """Vectors (n, 3) at faces (n,) of a surface, turned as those faces turn to the next frame."""
    local = np.einsum("nij,ni->nj", face_frames(before, faces), vectors)
    return np.asarray(np.einsum("nij,nj->ni", face_frames(after, faces), local))


def turn(normals: Array, others: Array) -> Array:
    """Angles (n,) in degrees between unit vectors (n, 3).

    A tangent that is carried by the least turn from one normal to the other adds nothing, so this
    is the turn of the whole frame against the one that rides on the surface.
    """
    sine = np.linalg.norm(np.cross(normals, others), axis=1)
    return np.asarray(np.degrees(np.arctan2(sine, (normals * others).sum(axis=1))))


def roughness(run: Run) -> float | None:
    """Mean jerk over mean slide: near 1 each frame's correction is new noise, near 0 smooth.

    None where nothing slides.
    """
    slide = float(np.mean(run.slide_mean))
    return float(np.mean(run.jerk_mean)) / slide if slide > 0 else None


def drift(run: Run) -> float:
    """Change of the bond order psi6 from the first frame to the last."""
    return run.bond_order[-1] - run.first["bond_order"]
