# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawing the panel of a scatter over a large surface, and what a change costs beside it."""

from __future__ import annotations

import time
import types
from collections.abc import Callable
from typing import Any

import bpy
import numpy as np

from addon.blender import main_panel
from addon.blender.base import panel_values
from addon.blender.freshness import findings
from addon.blender.surface.mesh import read_mesh
from benchmarks.bake.made_up import add_bake, add_scatter

_FRAMES = 10
_LEAF = (
    "prop",
    "label",
    "separator",
    "popover",
    "menu",
    "prop_search",
    "template_icon",
    "progress",
)


class _Layout:
    """Takes what a panel draws and does nothing: a background Blender has no layout."""

    def __init__(self) -> None:
        for name in (*_LEAF, "template_list"):
            setattr(self, name, lambda *_, **__: None)

    def row(self, **_: Any) -> _Layout:
        return self

    column = box = split = row

    def operator(self, *_: Any, **__: Any) -> types.SimpleNamespace:
        return types.SimpleNamespace()

    operator_menu_enum = operator


def measure_redraw(sites: int, faces: int, rounds: int) -> dict[str, float]:
    """Median seconds of a redraw of all panels, and of the timer's look after a change."""
    side = max(round((faces / 2) ** 0.5), 1)
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=side, y_subdivisions=side)
    surface = bpy.context.object
    arrays = read_mesh(surface)
    findings.at_once = panel_values.at_once = False
    vars(findings)["is_shown"] = lambda _: True
    findings.PAUSE = findings.PATIENCE = 0.0
    taken: dict[str, float] = {}
    for baked in ("bound", "baked"):
        scatter = add_scatter(surface, arrays, sites)
        if baked == "baked":
            add_bake(scatter, arrays, sites, _FRAMES, 0.5)
        bpy.context.view_layer.objects.active = scatter
        taken |= {f"{baked}, {name}": median for name, median in _cases(scatter, surface, rounds)}
    return taken


def _cases(
    scatter: bpy.types.Object, surface: bpy.types.Object, rounds: int
) -> list[tuple[str, float]]:
    def setting() -> None:
        scatter.dapple.repulsion_weight += 0.1

    def shape() -> None:
        surface.data.vertices[0].co.z += 0.1

    _draw()
    findings.tick()
    panel_values.tick()
    found = [
        ("a redraw", _median(_draw, rounds)),
        ("what the panels ask for", _median(panel_values.tick, rounds, _draw)),
    ]
    changes: list[tuple[str, Callable[[], None]]] = [
        ("a look after a setting", setting),
        ("a look after another shape", shape),
    ]
    for name, change in changes:
        found.append((name, _median(findings.tick, rounds, change)))
    return found


def _draw() -> None:
    for kind in main_panel.CLASSES:
        if issubclass(kind, bpy.types.Panel) and getattr(kind, "poll", lambda _: True)(bpy.context):
            panel: Any = types.SimpleNamespace(layout=_Layout())
            kind.draw(panel, bpy.context)


def _median(
    work: Callable[[], object], rounds: int, before: Callable[[], None] | None = None
) -> float:
    taken = []
    for _ in range(rounds):
        if before:
            before()
            bpy.context.view_layer.update()
        begin = time.perf_counter()
        work()
        taken.append(time.perf_counter() - begin)
    return float(np.median(taken))
