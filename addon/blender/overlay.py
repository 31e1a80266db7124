# SPDX-License-Identifier: GPL-3.0-or-later
"""The density as colours over the surface, in the viewport only.

Handlers and property updates only note that something changed; an app timer computes the colours
anew once nothing has changed for a moment, and drawing shows what was computed last.
"""

import time
from dataclasses import dataclass, field
from typing import Any

import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from ..core.errors import ScatterError
from ..core.frames import vertex_normals
from ..core.ground import Ground
from ..core.solve import named
from ..core.surface import Floats
from .held import Held
from .scatter import settings_of, surface_of
from .surroundings import read_with
from .translation import told

_PAUSE = 0.2  # seconds without a change before the colours are computed
_LIFT = 2e-3  # above the surface, of its size
_ALPHA = 0.75
# From nothing to the most: dark, teal, yellow.
_COLOURS = np.array([[0.10, 0.06, 0.25], [0.13, 0.55, 0.55], [0.99, 0.90, 0.15]])


@dataclass
class _Shown:
    """The scatter whose density is shown, and its triangles."""

    scatter: Held | None = None
    surface: int = 0  # session_uid
    positions: Floats = field(default_factory=lambda: np.empty((0, 3)))
    colours: Floats = field(default_factory=lambda: np.empty((0, 4)))
    batch: Any = None
    changed: float = 0.0  # when, by the monotonic clock; 0: not since it was computed
    said: str = ""  # why it ended
    handle: Any = None


_shown = _Shown()


def is_on(obj: bpy.types.Object) -> bool:
    """Whether the density of a scatter is shown."""
    return _shown.scatter is not None and _shown.scatter.uid == obj.session_uid


def note() -> str:
    """Why the density is shown no more; empty when nothing is to be said."""
    return _shown.said


def start(obj: bpy.types.Object) -> None:
    """Show the density of a scatter; ScatterError if it has none that can be computed."""
    stop()
    _compute(obj)
    _shown.scatter, _shown.said = Held(obj), ""
    if not bpy.app.background:
        space = bpy.types.SpaceView3D
        _shown.handle = space.draw_handler_add(_draw, (), "WINDOW", "POST_VIEW")
    if not bpy.app.timers.is_registered(_tick):
        bpy.app.timers.register(_tick, first_interval=_PAUSE)
    _redraw()


def stop() -> None:
    """Show no density."""
    if _shown.handle is not None:
        bpy.types.SpaceView3D.draw_handler_remove(_shown.handle, "WINDOW")
    _shown.handle, _shown.scatter, _shown.batch = None, None, None
    _redraw()


def touch(obj: bpy.types.Object) -> None:
    """Something changed that a scatter's density may depend on."""
    if is_on(obj):
        _shown.changed = time.monotonic()


def triangles() -> tuple[Floats, Floats]:
    """What is drawn: corners (3 m, 3) in world space and their colours (3 m, 4)."""
    return _shown.positions, _shown.colours


def _compute(obj: bpy.types.Object) -> None:
    surface, settings = surface_of(obj), settings_of(obj)
    arrays = read_with(settings, surface, bpy.context.evaluated_depsgraph_get(), obj)
    kinds, at = settings.classes, obj.dapple.class_index
    with named(arrays.name):
        ground = Ground(arrays, settings)
        density = ground.at_corners(kinds[at].density if at < len(kinds) else "")
    vertices, faces = ground.surface.vertices, ground.surface.faces
    lift = _LIFT * float(np.linalg.norm(np.ptp(arrays.vertices, axis=0)))
    lifted = vertices + lift * vertex_normals(vertices, faces)
    _shown.positions = lifted[faces].reshape(-1, 3)
    _shown.colours = coloured(density.ravel() / max(float(density.max()), 1e-300))
    _shown.surface, _shown.batch, _shown.changed = surface.session_uid, None, 0.0


def coloured(shares: Floats) -> Floats:
    """Colours (n, 4) of shares (n,) of the largest density."""
    steps = np.linspace(0.0, 1.0, len(_COLOURS))
    channels = [np.interp(shares, steps, _COLOURS[:, k]) for k in range(3)]
    return np.column_stack([*channels, np.full(len(shares), _ALPHA)])


def _tick() -> float | None:
    if _shown.scatter is None:
        return None
    if _shown.changed and time.monotonic() - _shown.changed > _PAUSE:
        try:
            _compute(_shown.scatter.get())
        except ScatterError as error:
            _shown.said = told("Density is not shown: {error}", error=error)
            stop()
            return None
        _redraw()
    return _PAUSE


def _draw() -> None:
    if _shown.batch is None:
        shader = gpu.shader.from_builtin("SMOOTH_COLOR")
        content = {"pos": _shown.positions.astype("f4"), "color": _shown.colours.astype("f4")}
        _shown.batch = batch_for_shader(shader, "TRIS", content)
    shader = gpu.shader.from_builtin("SMOOTH_COLOR")
    gpu.state.blend_set("ALPHA")
    gpu.state.depth_test_set("LESS_EQUAL")
    _shown.batch.draw(shader)
    gpu.state.depth_test_set("NONE")
    gpu.state.blend_set("NONE")


def _redraw() -> None:
    for manager in bpy.data.window_managers:
        for window in manager.windows:
            for area in window.screen.areas:
                if area.type == "VIEW_3D":
                    area.tag_redraw()


def _updated(_scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    if _shown.scatter is None:
        return
    if any(one.id.original.session_uid == _shown.surface for one in depsgraph.updates):
        _shown.changed = time.monotonic()


def _leaving(*_arguments: Any) -> None:
    stop()
    _shown.said = ""


def register() -> None:
    """Watch the surface, and files being opened."""
    for handlers, handler in _handlers():
        bpy.app.handlers.persistent(handler)
        handlers.append(handler)


def unregister() -> None:
    """Show nothing and watch nothing."""
    stop()
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)
    for handlers, handler in _handlers():
        if handler in handlers:
            handlers.remove(handler)


def _handlers() -> list[tuple[Any, Any]]:
    return [
        (bpy.app.handlers.depsgraph_update_post, _updated),
        (bpy.app.handlers.load_pre, _leaving),
    ]
