# SPDX-License-Identifier: GPL-3.0-or-later
"""What a job promises, what came of it, and what is measured of points that Blender shows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import bpy
import dapple3d as dapple
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Found:
    """Figures of a job; of several frames the worst. None: not asked for."""

    seconds: float = 0.0
    variation: float | None = None  # of the capacities
    alpha: float | None = None  # smallest distance, in local spacings
    overlap: float | None = None  # of discs, 1 where they coincide
    inside: int | None = None  # points where there must be none
    between: int | None = None  # the same half a frame later: no promise is made of it
    off: float | None = None  # farthest from the surface, in spacings
    wrong: str = ""  # a promise that is no figure, in words


@dataclass(frozen=True)
class Job:
    """A job and its promises: at most these figures, but for alpha, which is at least that."""

    name: str
    run: Callable[[], Found]
    beside: str = ""  # the job whose time is 1
    time: float = 0.0
    variation: float = 0.02
    alpha: float = 0.5
    overlap: float = 0.02
    inside: int = 0
    off: float = 1e-3

    def broken(self, found: Found, ratio: float | None) -> list[str]:
        """Names of the promises that are not kept."""
        figures = {
            "time": None if ratio is None or not self.time else ratio <= self.time,
            "variation": _at_most(found.variation, self.variation),
            "alpha": None if found.alpha is None else found.alpha >= self.alpha,
            "overlap": _at_most(found.overlap, self.overlap),
            "inside": _at_most(found.inside, self.inside),
            "off the surface": _at_most(found.off, self.off),
        }
        said = [found.wrong] if found.wrong else []
        return [name for name, kept in figures.items() if kept is False] + said


def _at_most(value: float | None, limit: float) -> bool | None:
    return None if value is None else value <= limit


def worst(found: list[Found]) -> Found:
    """Of several frames."""

    def of(name: str, pick: Callable[[list[Any]], Any]) -> Any:
        values = [value for one in found if (value := getattr(one, name)) is not None]
        return pick(values) if values else None

    return Found(
        seconds=sum(one.seconds for one in found),
        variation=of("variation", max),
        alpha=of("alpha", min),
        overlap=of("overlap", max),
        inside=of("inside", max),
        between=of("between", max),
        off=of("off", max),
        wrong=next((one.wrong for one in found if one.wrong), ""),
    )


def points(scatter: Any) -> tuple[Array, list[str]]:
    """World positions of the instances that do not fade, and the names of their objects.

    No job has a random scale: those that fade are the smaller ones of their object.
    """
    shown = [
        (np.array(one.matrix_world)[:3, 3], one.object.name, one.matrix_world.to_scale()[0])
        for one in bpy.context.evaluated_depsgraph_get().object_instances
        if one.is_instance and one.parent.original == scatter
    ]
    full: dict[str, float] = {}
    for _, name, scale in shown:
        full[name] = max(full.get(name, 0.0), scale)
    whole = [(place, name) for place, name, scale in shown if scale > 0.99 * full[name]]
    return np.array([place for place, _ in whole]).reshape(-1, 3), [name for _, name in whole]


def surface_now(obj: Any) -> dapple.Surface:
    """The evaluated triangles of an object in the world."""
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    mesh.calc_loop_triangles()
    local = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", local)
    faces = np.empty(3 * len(mesh.loop_triangles), dtype=np.int32)
    mesh.loop_triangles.foreach_get("vertices", faces)
    evaluated.to_mesh_clear()
    matrix = np.array(obj.matrix_world, dtype=np.float64)
    return dapple.Surface(
        local.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3], faces.reshape(-1, 3)
    )


def measured(
    surface: dapple.Surface, places: Array, *, even: bool = True, outside: float | None = None
) -> Found:
    """How even points are over a surface whose density is 1, and how far they are from it.

    Only what is as open as `outside` counts, if that is given.
    """
    found = dapple.project(surface, places)
    spacing = surface.spacing(max(len(places), 1))
    off = float(np.linalg.norm(found.positions - places, axis=1).max(initial=0.0)) / spacing
    if not even:
        return Found(off=off)
    samples = dapple.Samples(surface, found.faces, found.barycentric)
    if outside is not None:
        masked = dapple.density.MaskedSurface(surface, count=len(places), outside=outside)
        surface, samples = masked.surface, masked.from_original(samples)
    report = dapple.analyze(surface, samples)
    return Found(variation=report.capacity_variation, alpha=report.alpha_min, off=off)


def overlap(places: Array, radii: Array) -> float:
    """Largest share by which two discs overlap; a point without a radius counts too."""
    largest = 0.0
    for k in np.flatnonzero(radii > 0.0):
        apart = radii + radii[k]
        share = 1.0 - np.linalg.norm(places - places[k], axis=1) / apart
        share[k] = 0.0
        largest = max(largest, float(share.max()))
    return largest
