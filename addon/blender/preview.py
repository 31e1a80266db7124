# SPDX-License-Identifier: GPL-3.0-or-later
"""Live preview: while the artist scrubs or poses, points are kept even within a time budget.

An app timer reads the surface after Blender has evaluated it, a worker finds the points' places,
and the timer writes a binding of its own, which the node group plays in the viewport only. Renders
play the bake or the stored binding, so nothing here runs in one or changes one. Handlers only note
that something happened. What is written is runtime data: no file has it, however it is saved.
"""

from collections.abc import Callable, Container
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np

from ..core.bake import Start
from ..core.errors import ScatterError, StoppedError
from ..core.follow import Follower
from ..core.raw import RawMesh, surface_of_raw
from ..core.records import ROW_ATTRIBUTES, Binding
from ..core.steps import Stepper, Steps, Task
from ..nodes import get_input, has_input, set_input
from .held import Held
from .meshio import write_columns, write_points
from .parts import mesh_parts, read_parts
from .renders import busy, when_one_begins
from .resting import current_steps
from .scatter import is_scatter, scatter_modifier, settings_of, surface_of
from .staleness import other_faces
from .store import ensure_modifier, own_points
from .translation import told

_INPUT = "Preview"
_TICK = 0.05  # seconds between two looks at the surface
_POLL = 0.005  # seconds between two looks at a worker
_LONG = 3600.0  # seconds that a Blender without windows waits for one


@dataclass
class _Preview:
    scatter: Held
    surface: Held
    follower: Follower | None = None  # once the worker has made it
    mesh: RawMesh | None = None  # that the follower began with or has seen last
    job: Stepper | None = None  # what goes on


@dataclass
class _State:
    """What the timer and the handlers share; file data is always looked up anew."""

    previews: dict[int, _Preview]  # by the scatter's session_uid
    dirty: bool = False
    undone: bool = False  # an undo may have brought back a preview that is off
    said: str = ""  # why a preview ended by itself


_state = _State({})


def is_on(obj: bpy.types.Object) -> bool:
    """Whether a scatter is previewed."""
    return obj.session_uid in _state.previews


def note(obj: bpy.types.Object) -> str:
    """What the panel says about a scatter's preview."""
    if not is_on(obj):
        return _state.said
    follower = _state.previews[obj.session_uid].follower
    if follower is None:
        return told("The preview is being prepared")
    if follower.riding:
        return told("Over budget: points stick to the surface")
    return told("Points are kept even")


def start(obj: bpy.types.Object) -> None:
    """Preview a scatter; ScatterError if it does not fit its surface.

    Blender with windows finds that out while the artist goes on, and the panel says it.
    """
    preview = _Preview(Held(obj), Held(surface_of(obj)))
    if not own_points(obj).all():
        raise ScatterError(
            f"Scatter '{obj.name}' has points that its bake added: clear the bake to preview"
        )
    _give_up(obj.session_uid)
    _clear_all(keep=_state.previews)  # a copy of a scatter that is previewed has its preview
    preview.job = Stepper(_begin_steps(preview))
    _wait_in_background(preview.job)
    _poll(preview)
    _state.previews[obj.session_uid] = preview
    _state.said, _state.dirty = "", True
    _ensure_timer()


def _begin_steps(preview: _Preview) -> Steps:
    """Read all that the density asks for, have a worker prepare, show what is stored."""
    obj, surface = preview.scatter.get(), preview.surface.get()
    settings = settings_of(obj)
    read = yield from read_parts(settings, preview.surface, preview.scatter)
    arrays = yield Task(lambda _: read.arrays())
    obj, surface = preview.scatter.get(), preview.surface.get()
    if obj.dapple.bound_to == "FACES" and other_faces(obj, arrays):
        raise ScatterError(f"Scatter '{obj.name}' is out of date: {other_faces(obj, arrays)}")
    binding, columns = yield from current_steps(obj, surface, arrays)
    begin = Start(binding, columns["id"], columns["dapple_class"], settings)
    follower = yield Task(lambda context: Follower(arrays, begin, context))
    preview.follower, preview.mesh = follower, read.mesh
    _write(preview.scatter.get(), follower.binding)


def _ensure_timer() -> None:
    if not bpy.app.timers.is_registered(tick):
        bpy.app.timers.register(tick, first_interval=_TICK, persistent=True)


def stop(obj: bpy.types.Object) -> None:
    """End a scatter's preview: it shows its bake or its stored binding again."""
    _give_up(obj.session_uid)
    _clear_all(keep=_state.previews)


def solved_anew(obj: bpy.types.Object) -> None:
    """Have a scatter's preview, if there is one, begin from the points that it has now."""
    preview = _state.previews.get(obj.session_uid)
    _clear_all(keep=_state.previews)
    if preview is not None:
        _begin_anew(preview)


def _begin_anew(preview: _Preview) -> None:
    try:
        start(preview.scatter.get())
    except ScatterError as error:
        _end(preview, str(error))


def tick() -> float | None:
    """Look at the surfaces that are previewed; seconds until the next look, None to end."""
    if _state.undone and not busy():
        _state.undone = False
        _clear_all(keep=_state.previews)
    if not _state.previews and not _state.undone:
        return None
    if busy():
        return _TICK
    dirty, _state.dirty = _state.dirty, False
    for preview in list(_state.previews.values()):
        if preview.job is None and (dirty or _has_other_surface(preview)):
            _try(preview, _follow)
        elif preview.job is not None:
            _state.dirty |= dirty  # to be looked at when that is done
            _try(preview, _poll)
    goes_on = any(one.job is not None for one in _state.previews.values())
    return _POLL if goes_on else _TICK


def _try(preview: _Preview, step: Callable[[_Preview], None]) -> None:
    try:
        step(preview)
    except ScatterError as error:
        _end(preview, str(error))
    except StoppedError:  # a render took its place
        preview.job = None


def _poll(preview: _Preview) -> None:
    """One step of what goes on."""
    if preview.job is not None and preview.job.poll():
        preview.job = None


def _follow(preview: _Preview) -> None:
    """Begin to look at a surface."""
    if _has_other_surface(preview):
        _begin_anew(preview)
        return
    preview.job = Stepper(_follow_steps(preview))
    _wait_in_background(preview.job)
    _poll(preview)


def _wait_in_background(job: Stepper) -> None:
    """A Blender without windows has no timers."""
    while bpy.app.background and not job.poll(wait=_LONG):
        pass


def _has_other_surface(preview: _Preview) -> bool:
    """Whether the artist has chosen another surface, or deleted one of both."""
    try:
        surface = preview.scatter.get().dapple.surface
    except ScatterError:
        return True
    return surface is None or surface.session_uid != preview.surface.uid


def _follow_steps(preview: _Preview) -> Steps:
    """Read the surface, have a worker find the places for its shape, show them."""
    obj, surface = preview.scatter.get(), preview.surface.get()
    if bpy.context.view_layer.objects.get(surface.name) is None:
        raise ScatterError(f"Surface '{surface.name}' is not in the view layer")
    if preview.follower is None or preview.mesh is None:
        return (yield from _begin_steps(preview))
    mesh, follower = (yield from mesh_parts(preview.surface, preview.mesh)), preview.follower
    if not mesh.same_faces(preview.mesh):
        if obj.dapple.bound_to == "REST":
            return (yield from _begin_steps(preview))
        follower.check((yield Task(lambda _: surface_of_raw(mesh))))
    if mesh.same_place(preview.mesh) and get_input(ensure_modifier(obj), _INPUT) is not None:
        return None
    budget = obj.dapple.preview_budget / 1000.0
    binding = yield Task(lambda context: follower.follow(mesh.vertices(), budget, context))
    obj, preview.mesh = preview.scatter.get(), mesh
    if binding is not None or get_input(ensure_modifier(obj), _INPUT) is None:
        _write(obj, follower.binding)


def _give_up(uid: int) -> None:
    """Forget a preview, and what its worker still finds."""
    preview = _state.previews.pop(uid, None)
    if preview is not None and preview.job is not None:
        preview.job.abandon()


def _give_all_up() -> None:
    for uid in list(_state.previews):
        _give_up(uid)


def _end(preview: _Preview, why: str) -> None:
    _give_up(preview.scatter.uid)
    _state.said = told("Preview ended: {why}", why=why)
    _clear_all(keep=_state.previews)


def _write(obj: bpy.types.Object, binding: Binding) -> None:
    modifier = ensure_modifier(obj)
    store = get_input(modifier, _INPUT)
    if store is not None and (store.type != "MESH" or _INPUT not in store):  # of a broken file
        set_input(modifier, _INPUT, None)
        store = None
    if store is None:
        label = f"{obj.name} {_INPUT}"
        store = bpy.data.objects.new(label, bpy.data.meshes.new(label))
        store[_INPUT] = True
        store.is_runtime_data = store.data.is_runtime_data = True
    if len(store.data.vertices) != len(binding.carry):
        write_points(store.data, np.zeros((len(binding.carry), 3)))
    write_columns(store.data, binding.rows(), ROW_ATTRIBUTES)
    store.data.update_tag()
    if get_input(modifier, _INPUT) is None:
        set_input(modifier, _INPUT, store)
    if get_input(modifier, "Surface") != obj.dapple.surface:
        set_input(modifier, "Surface", obj.dapple.surface)
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


def _render_begins() -> None:
    """Workers stop; the surfaces are looked at again afterwards."""
    _state.dirty = True
    for preview in _state.previews.values():
        if preview.job is not None:
            preview.job.cancel()


def _undone(*_arguments: Any) -> None:
    _state.undone = _state.dirty = True
    _ensure_timer()


def _leaving(*_arguments: Any) -> None:
    _give_all_up()
    _state.undone, _state.said = False, ""


def _loaded(*_arguments: Any) -> None:
    """Files that were saved while they recovered, or by older versions, may show a preview."""
    _clear_all()


def _saving(*_arguments: Any) -> None:
    """What is saved shows the bake or the stored binding."""
    _give_all_up()
    _clear_all()


_HANDLERS: dict[str, Callable[..., None]] = {
    "depsgraph_update_post": _touched,
    "frame_change_post": _touched,
    "render_complete": _touched,
    "render_cancel": _touched,
    "undo_post": _undone,
    "redo_post": _undone,
    "load_pre": _leaving,
    "load_post": _loaded,
    "save_pre": _saving,
}


def register() -> None:
    """Watch what happens to the file."""
    when_one_begins(_render_begins)
    for name, handler in _HANDLERS.items():
        bpy.app.handlers.persistent(handler)
        getattr(bpy.app.handlers, name).append(handler)


def unregister() -> None:
    """Stop all previews and watching."""
    for name, handler in _HANDLERS.items():
        handlers = getattr(bpy.app.handlers, name)
        if handler in handlers:
            handlers.remove(handler)
    if bpy.app.timers.is_registered(tick):
        bpy.app.timers.unregister(tick)
    _give_all_up()
    if hasattr(bpy.data, "objects"):  # there is no file yet while Blender starts
        _clear_all()
