# SPDX-License-Identifier: GPL-3.0-or-later
"""Why a result does not fit any more: surface, faces, points, settings, contents, keys, motion."""

from dataclasses import dataclass

import bpy
import numpy as np

from ..core.errors import ScatterError
from ..core.records import FRAME_ATTRIBUTES
from ..core.sources import (
    PLACES,
    UNKNOWN,
    Sources,
    differing,
    is_of_faces,
    sources_from,
    value_roles,
)
from ..core.stale import changed_settings, moved
from ..core.surface import SurfaceArrays
from ..nodes import get_input, has_input
from .meshio import read_columns
from .present import Looked, Present
from .scatter import (
    is_surface,
    scatter_modifier,
    settings_changed,
    settings_of,
    settings_reason,
    solve_again,
)
from .store import key_points, stored_object
from .times import time_of, times_of, whole_time
from .translation import counted, told


@dataclass(frozen=True)
class Verdict:
    """Whether a result fits what is there now."""

    reason: str = ""  # why not, the first of the reasons; empty when it fits
    note: str = ""  # what cannot be compared in this frame


def stale_reason(obj: bpy.types.Object, context: bpy.types.Context) -> str:
    """The first of the reasons in words; empty when the result fits."""
    return verdict(obj, context).reason


def verdict(
    obj: bpy.types.Object, context: bpy.types.Context, present: Present | None = None
) -> Verdict:
    """Compare a result with what is there now: present, as far as it was read before.

    Motion is compared on whole frames that are baked: call it again on another frame.
    """
    depsgraph = context.evaluated_depsgraph_get()
    try:
        return _verdict(obj, depsgraph, present or Present())
    except ScatterError as error:  # nothing could be solved from what is there
        return Verdict(str(error))


def _verdict(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, present: Present) -> Verdict:
    reason = _object_reason(obj, depsgraph)
    if reason:
        return Verdict(reason)
    looked = present.surface(obj, depsgraph)
    reason = _surface_reason(obj, depsgraph, looked) or _points_reason(obj, present)
    reason = reason or settings_reason(obj)
    if reason:
        return Verdict(reason)
    reasons, note = _contents(obj, present.sources(obj, depsgraph))
    if reasons:
        return Verdict(solve_again(obj, reasons[0]))
    if obj.dapple.baked_keys:
        return Verdict(_bake_reason(obj, depsgraph.scene, present, looked))
    return Verdict("", note)


def solution_reason(obj: bpy.types.Object, now: Sources) -> str:
    """Why a solution is not that of the settings and contents now; empty when it is.

    What is on a later frame as it is because it moves is no reason.
    """
    names = changed_settings(obj.dapple.solved_settings, settings_of(obj))
    if names and obj.dapple.solved_settings:
        return settings_changed(names)
    if _other_surface(obj):
        return _other_surface(obj)
    before = sources_from(obj.dapple.solved_from)
    if before is None:
        return ""
    reasons, _ = _compared(obj, before, now)
    return reasons[0] if reasons else ""


def other_faces(obj: bpy.types.Object, arrays: SurfaceArrays) -> str:
    """How the faces are not those the points are bound to; empty when they are."""
    bound, now = obj.dapple.surface_vertices, len(arrays.vertices)
    if bound != now:
        return f"attached to {bound} vertices, surface '{arrays.name}' has {now}"
    known = obj.dapple.surface_topology.split()
    if known and arrays.topology != known[0]:
        return f"surface '{arrays.name}' has {now} vertices as before, but other faces"
    return ""


def _object_reason(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> str:
    """What keeps the surface from being looked at."""
    surface = obj.dapple.surface
    if surface is None:
        return told("The surface is gone")
    if not is_surface(surface):
        return told(
            "Surface '{surface}' is not a mesh, curve, text or metaball", surface=surface.name
        )
    if not surface.evaluated_get(depsgraph).is_evaluated:
        return told("Surface '{surface}' is not in the view layer", surface=surface.name)
    if not surface.users_collection and surface.library is None:
        return told(
            "Surface '{surface}' was deleted or is in no collection: choose another one",
            surface=surface.name,
        )
    return ""


def _surface_reason(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, looked: Looked) -> str:
    surface = obj.dapple.surface
    if obj.dapple.bound_to == "REST":
        reason = _rest_reason(surface)
    else:
        reason = _faces_reason(obj, depsgraph, looked)
    if looked.trouble and not reason:
        reason = told(
            "Surface '{surface}': {trouble}", surface=surface.name, trouble=looked.trouble
        )
    reason = reason or _other_surface(obj)
    return solve_again(obj, reason) if reason else ""


def _rest_reason(surface: bpy.types.Object) -> str:
    if surface.type == "MESH" and not surface.add_rest_position_attribute:
        return told("Rest Position of '{surface}' is off", surface=surface.name)
    return ""


def _faces_reason(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, looked: Looked) -> str:
    bound, now = _bound_vertices(obj, depsgraph.scene), looked.vertices
    known = obj.dapple.surface_topology.split()
    if now not in bound:
        return told(
            "Attached to {bound:,} vertices, the surface has {now:,}", bound=bound[0], now=now
        )
    if known and looked.outline.topology not in known:
        return told(
            "The faces of '{surface}' are not those that the points are attached to",
            surface=looked.name,
        )
    return ""


def _other_surface(obj: bpy.types.Object) -> str:
    """Whether points are played on another surface than the one that is chosen."""
    modifier = scatter_modifier(obj)
    if modifier is None or not has_input(modifier, "Surface"):
        return ""
    played = get_input(modifier, "Surface")
    if played is None or played == obj.dapple.surface:
        return ""
    return told(
        "The points are on '{played}', not on '{chosen}'",
        played=played.name,
        chosen=obj.dapple.surface.name,
    )


def _points_reason(obj: bpy.types.Object, present: Present) -> str:
    """Whether points were edited by hand, or added and removed under the keys."""
    if obj.dapple.baked_keys:
        if len(obj.data.vertices) != key_points(obj):
            return solve_again(obj, told("Points were added or removed since the bake"))
    elif obj.dapple.report.count != len(obj.data.vertices):
        return _added_or_removed(len(obj.data.vertices) - obj.dapple.report.count)
    if not obj.dapple.solved_points or present.points(obj) == obj.dapple.solved_points:
        return ""
    return told("Points were edited by hand: reattach them, or lock them and optimize")


def _added_or_removed(added: int) -> str:
    if added > 0:
        return counted(
            added,
            "{count} point was added by hand: reattach it, or lock it and optimize",
            "{count:,} points were added by hand: reattach them, or lock them and optimize",
        )
    return counted(
        -added,
        "{count} point was removed by hand: reattach to keep the others, or optimize",
        "{count:,} points were removed by hand: reattach to keep the others, or optimize",
    )


def _contents(obj: bpy.types.Object, now: Sources) -> tuple[list[str], str]:
    """What has other contents than when the result was solved; what is only so in this frame."""
    baked = bool(obj.dapple.baked_keys)
    before = sources_from(obj.dapple.baked_from if baked else obj.dapple.solved_from)
    if before is not None:
        return _compared(obj, before, now)
    if baked or not obj.dapple.report.count:
        return [], ""
    return [], told("Made by an older version: only settings and faces are compared")


def _compared(obj: bpy.types.Object, before: Sources, now: Sources) -> tuple[list[str], str]:
    """Reasons, and a note of what differs from the frame of before as what moves does."""
    roles = [role for role in differing(before, now) if role != "faces"]
    same = before.exact.get("faces") == now.exact.get("faces")
    roles = [role for role in roles if not (role == "scale" if same else is_of_faces(role))]
    if before.frame == now.frame:
        return [_said(obj, role) for role in roles], _unknown(before)
    if obj.dapple.baked_keys:  # it is known what moves; shapes have sketches in every frame
        moving = {*before.moving, "shape"}
        return [_said(obj, role) for role in roles if role not in moving], ""
    places = [role for role in roles if role in PLACES]
    still = [_said(obj, role) for role in roles if role not in PLACES]
    return still, _note(before.frame, places) if places else _unknown(before)


def _unknown(before: Sources) -> str:
    if UNKNOWN not in before.exact.values():
        return ""
    return told("Attached to other faces since then: values of the surface are not compared")


def _note(frame: float, roles: list[str]) -> str:
    labels = {
        "shape": told("shape of the surface"),
        "scale": told("shape of the surface"),
        "up": told("direction and height of the surface"),
        "camera": told("camera"),
        "obstacles": told("avoided objects"),
        "others": told("avoided objects"),
    }
    listed = ", ".join(dict.fromkeys(labels[role] for role in roles))
    return told(
        "Differs from frame {frame:g}, where the points were optimized: {what}",
        frame=frame,
        what=listed,
    )


def _said(obj: bpy.types.Object, role: str) -> str:
    """That a role has other contents."""
    settings, surface = settings_of(obj), obj.dapple.surface.name
    named = value_roles(settings)
    if role in named:
        return told("Values of '{name}' were changed", name=named[role])
    if role == "image":
        return told("Image '{name}' was changed", name=settings.density.image)
    if role == "uv":
        return told("UV map of '{surface}' was changed", surface=surface)
    if role == "camera":
        return told("The camera was moved or changed")
    if role in ("obstacles", "others"):
        return told("Avoided objects were moved or changed")
    if role == "up":
        return told(
            "Surface '{surface}' was rotated or moved, and the density depends on it",
            surface=surface,
        )
    return told("Surface '{surface}' has another shape or scale than before", surface=surface)


def _bound_vertices(obj: bpy.types.Object, scene: bpy.types.Scene) -> list[int]:
    """Numbers of vertices that fit now: between two frames, that of either."""
    if not obj.dapple.baked_keys:
        return [obj.dapple.surface_vertices]
    table = frames(obj)["dapple_vertices"]
    if not len(table):
        raise ScatterError(f"Scatter '{obj.name}' has no baked frame: bake again")
    time = time_of(scene) - obj.dapple.baked_start
    around = np.clip([np.floor(time), np.ceil(time)], 0, len(table) - 1).astype(int)
    return [int(count) for count in table[around]]


def _bake_reason(
    obj: bpy.types.Object, scene: bpy.types.Scene, present: Present, looked: Looked
) -> str:
    reasons = (
        _key_reason(obj, present),
        _range_reason(obj, scene),
        _motion_reason(obj, scene, looked),
    )
    return next((solve_again(obj, reason) for reason in reasons if reason), "")


def _key_reason(obj: bpy.types.Object, present: Present) -> str:
    wrong = present.wrong_key(obj)
    return told("The keyframes are damaged: {wrong}", wrong=wrong) if wrong else ""


def _range_reason(obj: bpy.types.Object, scene: bpy.types.Scene) -> str:
    first = obj.dapple.baked_start
    last = first + obj.dapple.baked_frames - 1
    start, end = times_of(scene, scene.frame_start, scene.frame_end)
    if first <= start and end <= last:
        return ""
    return told(
        "Frames {first} to {last} are baked, the scene has {start} to {end}",
        first=first,
        last=last,
        start=start,
        end=end,
    )


def _motion_reason(obj: bpy.types.Object, scene: bpy.types.Scene, looked: Looked) -> str:
    frame = _baked_frame(obj, scene)
    if frame is None:
        return ""
    columns = frames(obj)
    if obj.dapple.bound_to == "REST" and looked.vertices != columns["dapple_vertices"][frame]:
        return ""  # other faces of the same shape, which vertices do not tell
    stored = np.array([columns[f"dapple_sketch{k}"][frame] for k in range(3)], dtype=np.float64)
    if not moved(stored, looked.sketched):
        return ""
    return told(
        "Surface '{surface}' moves differently than when it was baked (frame {frame})",
        surface=obj.dapple.surface.name,
        frame=whole_time(scene),
    )


def _baked_frame(obj: bpy.types.Object, scene: bpy.types.Scene) -> int | None:
    """Index of the time that is shown in the bake, if it is a whole one of it."""
    time = whole_time(scene)
    if time is None or not 0 <= time - obj.dapple.baked_start < obj.dapple.baked_frames:
        return None
    return time - obj.dapple.baked_start


def frames(obj: bpy.types.Object) -> dict[str, np.ndarray]:
    """The table of the baked frames."""
    found = read_columns(stored_object(obj, "Frames").data, FRAME_ATTRIBUTES)
    count = len(found["dapple_key"])
    if count != obj.dapple.baked_frames:
        raise ScatterError(
            f"Scatter '{obj.name}' has {count} baked frames, not {obj.dapple.baked_frames}: bake "
            "again"
        )
    return found
