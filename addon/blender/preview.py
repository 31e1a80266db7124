# SPDX-License-Identifier: GPL-3.0-or-later
"""Live preview: while the artist scrubs or poses, points are kept even within a time budget.

An app timer reads the surface after Blender has evaluated it and writes a binding of its own,
which the node group plays in the viewport only. Renders play the bake or the stored binding, so
nothing here runs in one or changes one. Handlers only note that something happened.
"""

from collections.abc import Callable, Container
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np

from ..core.bake import Start
from ..core.errors import ScatterError
from ..core.follow import Follower
from ..core.records import ROW_ATTRIBUTES, Binding
from ..core.surface import SurfaceArrays
from ..nodes import get_input, has_input, set_input
from .held import Held
from .meshio import read_surface, write_columns, write_points
from .resting import current_binding
from .scatter import is_scatter, scatter_modifier, settings_of, surface_of
from .staleness import other_faces
from .store import ensure_modifier, own_points
from .surroundings import read_with
from .translation import told

_INPUT = "Preview"
_TICK = 0.05  # seconds between two looks at the surface


@dataclass
class _Preview:
    scatter: Held
    surface: Held
    follower: Follower


@dataclass
class _State:
    """What the timer and the handlers share; file data is always looked up anew."""

    previews: dict[int, _Preview]  # by the scatter's session_uid
    dirty: bool = False
    undone: bool = False  # an undo may have brought back a preview that is off
    rendering: bool = False
    said: str = ""  # why a preview ended by itself


_state = _State({})


def is_on(obj: bpy.types.Object) -> bool:
    """Whether a scatter is previewed."""
    return obj.session_uid in _state.previews


def note(obj: bpy.types.Object) -> str:
    """What the panel says about a scatter's preview."""
    if not is_on(obj):
        return _state.said
    riding = _state.previews[obj.session_uid].follower.riding
    if riding:
        return told("Over budget: points ride on the surface")
    return told("Points follow the surface")


def start(obj: bpy.types.Object) -> None:
    """Preview a scatter; ScatterError if it does not fit its surface."""
    surface = surface_of(obj)
    arrays = read_with(settings_of(obj), surface, bpy.context.evaluated_depsgraph_get(), obj)
    if obj.dapple.bound_to == "FACES" and other_faces(obj, arrays):
        raise ScatterError(f"Scatter '{obj.name}' is stale: {other_faces(obj, arrays)}")
    if not own_points(obj).all():
        raise ScatterError(
            f"Scatter '{obj.name}' has points that its bake added: clear the bake to preview"
        )
    follower = _follower(obj, surface, arrays)
    _clear_all(keep=_state.previews)  # a copy of a scatter that is previewed has its preview
    _write(obj, follower.binding)
    _state.previews[obj.session_uid] = _Preview(Held(obj), Held(surface), follower)
    _state.said, _state.dirty = "", True
    _ensure_timer()


def _follower(obj: bpy.types.Object, surface: bpy.types.Object, arrays: SurfaceArrays) -> Follower:
    binding, columns = current_binding(obj, surface, arrays)
    begin = Start(binding, columns["id"], columns["dapple_class"], settings_of(obj))
    return Follower(arrays, begin)


def _ensure_timer() -> None:
    if not bpy.app.timers.is_registered(tick):
        bpy.app.timers.register(tick, first_interval=_TICK)


def stop(obj: bpy.types.Object) -> None:
    """End a scatter's preview: it shows its bake or its stored binding again."""
    _state.previews.pop(obj.session_uid, None)
    _clear_all(keep=_state.previews)


def solved_anew(obj: bpy.types.Object) -> None:
    """Have a scatter's preview, if there is one, begin from the points that it has now."""
    preview = _state.previews.get(obj.session_uid)
    _clear_all(keep=_state.previews)
    if preview is None:
        return
    try:
        start(obj)
    except ScatterError as error:
        _end(preview, str(error))


def tick() -> float | None:
    """Look at the surfaces that are previewed; seconds until the next look, None to end."""
    if _state.undone and not _busy():
        _state.undone = False
        _clear_all(keep=_state.previews)
    if not _state.previews and not _state.undone:
        return None
    if _state.dirty and not _busy():
        _state.dirty = False
        for preview in list(_state.previews.values()):
            try:
                _follow(preview)
            except ScatterError as error:
                _end(preview, str(error))
    return _TICK


def _busy() -> bool:
    """Whether Blender renders, or has locked its interface to do so."""
    locked = any(manager.is_interface_locked for manager in bpy.data.window_managers)
    return _state.rendering or locked or bpy.app.is_job_running("RENDER")


def _follow(preview: _Preview) -> None:
    obj, surface = preview.scatter.get(), preview.surface.get()
    if bpy.context.view_layer.objects.get(surface.name) is None:
        raise ScatterError(f"Surface '{surface.name}' is not in the view layer")
    depsgraph = bpy.context.evaluated_depsgraph_get()
    arrays = read_surface(surface, depsgraph)
    if obj.dapple.bound_to == "REST" and arrays.topology != preview.follower.topology:
        begun = _follower(obj, surface, read_with(settings_of(obj), surface, depsgraph, obj))
        preview.follower = begun
        _write(obj, begun.binding)
    binding = preview.follower.follow(arrays, obj.dapple.preview_budget / 1000.0)
    if binding is not None or get_input(ensure_modifier(obj), _INPUT) is None:
        _write(obj, preview.follower.binding)


def _end(preview: _Preview, why: str) -> None:
    _state.previews.pop(preview.scatter.uid, None)
    _state.said = told("Preview ended: {why}", why=why)
    _clear_all(keep=_state.previews)


def _write(obj: bpy.types.Object, binding: Binding) -> None:
    modifier = ensure_modifier(obj)
    store = get_input(modifier, _INPUT)
    if store is None:
        label = f"{obj.name} {_INPUT}"
        store = bpy.data.objects.new(label, bpy.data.meshes.new(label))
        store[_INPUT] = True
    if len(store.data.vertices) != len(binding.carry):
        write_points(store.data, np.zeros((len(binding.carry), 3)))
    write_columns(store.data, binding.rows(), ROW_ATTRIBUTES)
    store.data.update_tag()
    if get_input(modifier, _INPUT) is None:
        set_input(modifier, _INPUT, store)
    obj.update_tag()


def _clear_all(keep: Container[int] = ()) -> None:
    """End what previews the file shows, but for those of some scatters."""
    for obj in bpy.data.objects:
        if is_scatter(obj) and obj.session_uid not in keep:
            _unlink(obj)
    _remove_unused()


def _unlink(obj: bpy.types.Object) -> None:
    modifier = scatter_modifier(obj)
    if modifier is None or not has_input(modifier, _INPUT):
        return
    if get_input(modifier, _INPUT) is not None:
        set_input(modifier, _INPUT, None)
        obj.update_tag()


def _remove_unused() -> None:
    for store in [item for item in bpy.data.objects if _INPUT in item and item.users == 0]:
        mesh = store.data
        bpy.data.objects.remove(store)
        bpy.data.meshes.remove(mesh)


def _touched(*_arguments: Any) -> None:
    _state.dirty = True


def _render_begins(*_arguments: Any) -> None:
    _state.rendering = True


def _render_ends(*_arguments: Any) -> None:
    _state.rendering, _state.dirty = False, True


def _undone(*_arguments: Any) -> None:
    _state.undone = _state.dirty = True
    _ensure_timer()


def _leaving(*_arguments: Any) -> None:
    _state.previews.clear()
    _state.rendering, _state.undone, _state.said = False, False, ""


def _saving(*_arguments: Any) -> None:
    """What is saved shows the bake or the stored binding."""
    _state.previews.clear()
    _clear_all()


_HANDLERS: dict[str, Callable[..., None]] = {
    "depsgraph_update_post": _touched,
    "frame_change_post": _touched,
    "render_init": _render_begins,
    "render_complete": _render_ends,
    "render_cancel": _render_ends,
    "undo_post": _undone,
    "redo_post": _undone,
    "load_pre": _leaving,
    "save_pre": _saving,
}


def register() -> None:
    """Watch what happens to the file."""
    for name, handler in _HANDLERS.items():
        bpy.app.handlers.persistent(handler)
        getattr(bpy.app.handlers, name).append(handler)


def unregister() -> None:
    """Stop all previews and watching."""
    _state.previews.clear()
    _clear_all()
    if bpy.app.timers.is_registered(tick):
        bpy.app.timers.unregister(tick)
    for name, handler in _HANDLERS.items():
        handlers = getattr(bpy.app.handlers, name)
        if handler in handlers:
            handlers.remove(handler)
