# SPDX-License-Identifier: GPL-3.0-or-later
"""Why a result does not fit any more: surface, faces, settings, frames, motion."""

import bpy
import numpy as np

from ..core.records import FRAME_ATTRIBUTES
from ..core.stale import moved
from ..core.surface import SurfaceArrays
from ..nodes import get_input
from .meshio import evaluated_mesh, read_columns, read_surface, topology
from .scatter import scatter_modifier, settings_reason, solve_again
from .store import stored_object
from .translation import counted, told


def stale_reason(obj: bpy.types.Object, context: bpy.types.Context) -> str:
    """The first of the reasons in words; empty when the result fits.

    Motion is compared on whole frames that are baked: call it again on another frame.
    """
    depsgraph = context.evaluated_depsgraph_get()
    reason = _surface_reason(obj, depsgraph) or _points_reason(obj) or settings_reason(obj)
    if not reason and obj.dapple.baked_keys:
        reason = _range_reason(obj, context.scene) or _motion_reason(obj, context.scene, depsgraph)
    return reason


def other_faces(obj: bpy.types.Object, arrays: SurfaceArrays) -> str:
    """How the faces are not those the points are bound to; empty when they are."""
    bound, now = obj.dapple.surface_vertices, len(arrays.vertices)
    if bound != now:
        return f"bound to {bound} vertices, surface '{arrays.name}' has {now}"
    known = obj.dapple.surface_topology.split()
    if known and arrays.topology != known[0]:
        return f"surface '{arrays.name}' has {now} vertices as before, but other faces"
    return ""


def _surface_reason(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> str:
    surface = obj.dapple.surface
    if surface is None:
        return told("The surface is gone")
    if not surface.evaluated_get(depsgraph).is_evaluated:
        return told("Surface '{surface}' is not in the view layer", surface=surface.name)
    if not surface.users_collection and surface.library is None:
        return told(
            "Surface '{surface}' was deleted, or is in no collection: choose another",
            surface=surface.name,
        )
    if obj.dapple.bound_to == "REST":
        return ""
    bound = _bound_vertices(obj, depsgraph.scene)
    with evaluated_mesh(surface, depsgraph) as mesh:
        now, faces = len(mesh.vertices), topology(mesh)
    known = obj.dapple.surface_topology.split()
    if now not in bound:
        reason = told(
            "Bound to {bound:,} vertices, the surface has {now:,}", bound=bound[0], now=now
        )
    elif known and faces not in known:
        reason = told(
            "The faces of '{surface}' are not those the points are bound to", surface=surface.name
        )
    else:
        return ""
    return solve_again(obj, reason)


def _points_reason(obj: bpy.types.Object) -> str:
    """Whether points were added by hand, or removed under the keys."""
    count = len(obj.data.vertices)
    if obj.dapple.baked_keys:
        known = get_input(scatter_modifier(obj), "Key Points")
        if count == known:
            return ""
        return solve_again(obj, told("Points were added or removed since the bake"))
    added = count - obj.dapple.report.count
    if added <= 0:
        return ""
    return counted(
        added,
        "{count} point was added by hand: re-bind, or lock it and optimise",
        "{count:,} points were added by hand: re-bind, or lock them and optimise",
    )


def _bound_vertices(obj: bpy.types.Object, scene: bpy.types.Scene) -> list[int]:
    """Numbers of vertices that fit now: between two frames, that of either."""
    if not obj.dapple.baked_keys:
        return [obj.dapple.surface_vertices]
    table = frames(obj)["dapple_vertices"]
    time = scene.frame_current + scene.frame_subframe - obj.dapple.baked_start
    around = np.clip([np.floor(time), np.ceil(time)], 0, len(table) - 1).astype(int)
    return [int(count) for count in table[around]]


def _range_reason(obj: bpy.types.Object, scene: bpy.types.Scene) -> str:
    first = obj.dapple.baked_start
    last = first + obj.dapple.baked_frames - 1
    if first <= scene.frame_start and scene.frame_end <= last:
        return ""
    reason = told(
        "Frames {first} to {last} are baked, the scene has {start} to {end}",
        first=first,
        last=last,
        start=scene.frame_start,
        end=scene.frame_end,
    )
    return solve_again(obj, reason)


def _motion_reason(
    obj: bpy.types.Object, scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph
) -> str:
    frame = _baked_frame(obj, scene)
    if frame is None:
        return ""
    columns = frames(obj)
    stored = np.array([columns[f"dapple_sketch{k}"][frame] for k in range(3)], dtype=np.float64)
    if not moved(stored, read_surface(obj.dapple.surface, depsgraph)):
        return ""
    reason = told(
        "Surface '{surface}' moves otherwise than when it was baked (frame {frame})",
        surface=obj.dapple.surface.name,
        frame=scene.frame_current,
    )
    return solve_again(obj, reason)


def _baked_frame(obj: bpy.types.Object, scene: bpy.types.Scene) -> int | None:
    """Index of the scene's frame in the bake, if it is a whole one of it."""
    frame = scene.frame_current - obj.dapple.baked_start
    if scene.frame_subframe or not 0 <= frame < obj.dapple.baked_frames:
        return None
    return int(frame)


def frames(obj: bpy.types.Object) -> dict[str, np.ndarray]:
    """The table of the baked frames."""
    return read_columns(stored_object(obj, "Frames").data, FRAME_ATTRIBUTES)
