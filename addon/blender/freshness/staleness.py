# SPDX-License-Identifier: GPL-3.0-or-later
"""Why a result is out of date: surface, faces, points, settings, inputs, keyframes, motion."""

from dataclasses import dataclass

import bpy
import numpy as np

from ...core.base.errors import ScatterError
from ...core.solve.stale import moved
from ...core.surface.records import RESULT_KEY
from ...core.surface.sources import Sources
from ..base.times import time_of, times_of, whole_time
from ..base.translation import translated, translated_count
from ..scatter.key_stores import frames, key_points
from ..scatter.object import is_surface, settings_reason, solve_again
from ..scatter.points import edited_places, points_digest
from ..surface.joined_parts import has_lost_some, is_joined, parts_of, pieces_of, wanted
from .content_changes import contents, other_surface, solution_reason
from .scene_snapshot import SceneSnapshot, SurfaceSummary


@dataclass(frozen=True)
class Verdict:
    """Whether a result fits the current scene."""

    reason: str = ""  # the first reason why it does not fit; empty if it does
    note: str = ""  # inputs that cannot be compared in this frame


def stale_reason(obj: bpy.types.Object, context: bpy.types.Context) -> str:
    """The first reason as text; empty if the result fits."""
    return verdict(obj, context).reason


def verdict(
    obj: bpy.types.Object, context: bpy.types.Context, snapshot: SceneSnapshot | None = None
) -> Verdict:
    """Compare a result with the current scene; its points are not seen while they are edited.

    `snapshot` holds what was read before. Motion is compared on whole baked frames: call it again
    at another frame.
    """
    depsgraph = context.evaluated_depsgraph_get()
    try:
        return _verdict(obj, depsgraph, snapshot or SceneSnapshot())
    except ScatterError as error:  # such inputs could not be solved
        if obj.data.is_editmode:
            return Verdict("", translated("Not compared with its surface in Edit Mode"))
        return Verdict(str(error))


def _verdict(
    obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, snapshot: SceneSnapshot
) -> Verdict:
    if _is_unseen(obj, depsgraph):
        reason = other_surface(obj) or _parts_reason(obj.dapple.surface)
        note = translated("Not compared with its surface while it is hidden")
        return Verdict(solve_again(obj, reason)) if reason else Verdict("", note)
    reason = _object_reason(obj, depsgraph)
    if reason:
        return Verdict(reason)
    summary = snapshot.surface(obj, depsgraph)
    reason = _surface_reason(obj, depsgraph, summary) or points_reason(obj, snapshot)
    reason = reason or settings_reason(obj)
    if reason:
        return Verdict(reason)
    if summary.empty:
        return Verdict(bake_reason(obj, depsgraph.scene, snapshot, summary))
    reasons, note = contents(obj, snapshot.sources(obj, depsgraph))
    if reasons:
        return Verdict(solve_again(obj, reasons[0]))
    if obj.dapple.baked_keys:
        return Verdict(bake_reason(obj, depsgraph.scene, snapshot, summary))
    return Verdict("", note)


def _is_unseen(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> bool:
    """Whether a joined surface is not evaluated because nothing visible needs it."""
    surface = obj.dapple.surface
    joined = surface is not None and is_joined(surface)
    return joined and not len(surface.evaluated_get(depsgraph).data.vertices)


def _object_reason(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> str:
    """Why the surface cannot be checked."""
    surface = obj.dapple.surface
    if surface is None:
        return translated("The surface is gone")
    if not is_surface(surface):
        return translated(
            "Surface '{surface}' is not a mesh, curve, text or metaball", surface=surface.name
        )
    if not surface.evaluated_get(depsgraph).is_evaluated:
        return translated("Surface '{surface}' is not in the view layer", surface=surface.name)
    if not surface.users_collection and surface.library is None and not is_joined(surface):
        return translated(
            "Surface '{surface}' was deleted or is in no collection: choose another one",
            surface=surface.name,
        )
    return ""


def _surface_reason(
    obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, summary: SurfaceSummary
) -> str:
    surface = obj.dapple.surface
    if is_joined(surface) and _parts_reason(surface):
        reason = _parts_reason(surface)
    elif obj.dapple.attached_to == "REST":
        reason = _rest_reason(surface)
    else:
        reason = _faces_reason(obj, depsgraph, summary)
    if summary.trouble and not reason and not is_baked_empty(obj, depsgraph.scene, summary):
        reason = translated(
            "Surface '{surface}': {trouble}", surface=surface.name, trouble=summary.trouble
        )
    reason = reason or other_surface(obj)
    return solve_again(obj, reason) if reason else ""


def _rest_reason(surface: bpy.types.Object) -> str:
    for part in parts_of(surface):
        if part.type == "MESH" and not part.add_rest_position_attribute:
            return translated("Rest Position of '{surface}' is off", surface=part.name)
    return ""


def _parts_reason(surface: bpy.types.Object) -> str:
    """Whether the parts of a joined surface are out of date."""
    if has_lost_some(surface):
        return translated("A part of '{surface}' was deleted", surface=surface.name)
    before, now = pieces_of(surface), wanted(surface)
    for piece in before:
        if piece not in now:
            return translated(
                "'{part}' of '{surface}' was deleted or left its collection",
                part=piece.object.name,
                surface=surface.name,
            )
    for piece in now[len(before) :]:
        return translated(
            "'{part}' was added to '{surface}'", part=piece.object.name, surface=surface.name
        )
    return ""


def _faces_reason(
    obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, summary: SurfaceSummary
) -> str:
    bound, now = bound_vertices(obj, depsgraph.scene), summary.vertices
    known = obj.dapple.surface_topology.split()
    if now not in bound:
        return translated(
            "Attached to {bound:,} vertices, the surface has {now:,}", bound=bound[0], now=now
        )
    if known and summary.outline.topology not in known:
        return translated(
            "The faces of '{surface}' are not those that the points are attached to",
            surface=summary.name,
        )
    return ""


def needs_solving(obj: bpy.types.Object, now: Sources) -> bool:
    """Whether a result does not belong to the current settings and inputs.

    True as well after an undo that restored the points or the settings, but not both.
    """
    known = obj.dapple.surface_topology.split()
    on_faces = obj.dapple.attached_to == "FACES" and bool(known)
    other_faces = on_faces and now.exact["faces"] not in known
    other_binding = obj.dapple.attach_to not in ("AUTO", obj.dapple.attached_to)
    undone = bool(obj.dapple.solved_points) and points_digest(obj) != obj.dapple.solved_points
    placed = edited_places(obj) is not None
    changed = placed or other_faces or other_binding or undone
    return changed or bool(solution_reason(obj, now))


def bake_reason(
    obj: bpy.types.Object, scene: bpy.types.Scene, snapshot: SceneSnapshot, summary: SurfaceSummary
) -> str:
    """The first reason why a bake does not fit, as text; empty if it fits."""
    reasons = (
        _key_reason(obj, snapshot),
        _range_reason(obj, scene),
        _motion_reason(obj, scene, summary),
    )
    return next((solve_again(obj, reason) for reason in reasons if reason), "")


def _key_reason(obj: bpy.types.Object, snapshot: SceneSnapshot) -> str:
    wrong = snapshot.wrong_key(obj)
    return translated("The keyframes are damaged: {wrong}", wrong=wrong) if wrong else ""


def _range_reason(obj: bpy.types.Object, scene: bpy.types.Scene) -> str:
    first = obj.dapple.baked_start
    last = first + obj.dapple.baked_frames - 1
    start, end = times_of(scene, scene.frame_start, scene.frame_end)
    if first <= start and end <= last:
        return ""
    return translated(
        "Frames {first} to {last} are baked, the scene has {start} to {end}",
        first=first,
        last=last,
        start=start,
        end=end,
    )


def _motion_reason(obj: bpy.types.Object, scene: bpy.types.Scene, summary: SurfaceSummary) -> str:
    frame = _baked_frame(obj, scene)
    if frame is None:
        return ""
    columns = frames(obj)
    stored = np.array([columns[f"dapple_sketch{k}"][frame] for k in range(3)], dtype=np.float64)
    if stored.any() or summary.empty:
        if (
            obj.dapple.attached_to == "REST"
            and summary.vertices != columns["dapple_vertices"][frame]
        ):
            return ""  # other faces of the same shape: vertices cannot be compared
        if not moved(stored, summary.sketched):
            return ""
    return translated(
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


def is_baked_empty(obj: bpy.types.Object, scene: bpy.types.Scene, summary: SurfaceSummary) -> bool:
    """Whether a surface has no faces now and had none in the bake."""
    baked = summary.empty and obj.dapple.baked_keys > 0
    return baked and summary.vertices in bound_vertices(obj, scene)


def bound_vertices(obj: bpy.types.Object, scene: bpy.types.Scene) -> list[int]:
    """Valid numbers of vertices now: between two frames, that of either."""
    if not obj.dapple.baked_keys:
        return [obj.dapple.surface_vertices]
    table = frames(obj)["dapple_vertices"]
    if not len(table):
        raise ScatterError(f"Scatter '{obj.name}' has no baked frame: bake again")
    time = time_of(scene) - obj.dapple.baked_start
    around = np.clip([np.floor(time), np.ceil(time)], 0, len(table) - 1).astype(int)
    return [int(count) for count in table[around]]


def is_edited(obj: bpy.types.Object) -> bool:
    """Whether points were edited by hand since they were stored."""
    stored = obj.dapple.solved_points, obj.data.get(RESULT_KEY)
    return bool(stored[0]) and points_digest(obj) not in stored


def points_reason(obj: bpy.types.Object, snapshot: SceneSnapshot) -> str:
    """Whether points were edited by hand, or added or removed since the bake."""
    if obj.dapple.baked_keys and len(obj.data.vertices) != key_points(obj):
        return solve_again(obj, translated("Points were added or removed since the bake"))
    reason = _edited_reason(obj, snapshot)
    if reason and obj.data.get(RESULT_KEY) == snapshot.points(obj):
        return solve_again(
            obj, translated("Undo restored points that were made with other settings")
        )
    return reason or _placed_reason(obj)


def _edited_reason(obj: bpy.types.Object, snapshot: SceneSnapshot) -> str:
    if not obj.dapple.baked_keys and obj.dapple.report.count != len(obj.data.vertices):
        return _added_or_removed(len(obj.data.vertices) - obj.dapple.report.count)
    if not obj.dapple.solved_points or snapshot.points(obj) == obj.dapple.solved_points:
        return ""
    return translated("Points were edited by hand: reattach them, or lock them and optimize")


def _placed_reason(obj: bpy.types.Object) -> str:
    if obj.dapple.baked_keys or edited_places(obj) is None:
        return ""
    return solve_again(obj, translated("Points were placed by hand; their neighbors are uneven"))


def _added_or_removed(added: int) -> str:
    if added > 0:
        return translated_count(
            added,
            "{count} point was added by hand: reattach it, or lock it and optimize",
            "{count:,} points were added by hand: reattach them, or lock them and optimize",
        )
    return translated_count(
        -added,
        "{count} point was removed by hand: reattach to keep the others, or optimize",
        "{count:,} points were removed by hand: reattach to keep the others, or optimize",
    )
