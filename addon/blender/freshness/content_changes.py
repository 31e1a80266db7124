# SPDX-License-Identifier: GPL-3.0-or-later
"""Inputs whose content has changed since a result was solved, and inputs that only move."""

import bpy

from ...core.solve.stale import changed_settings
from ...core.surface.sources import (
    PLACES,
    POSES,
    UNKNOWN,
    Sources,
    differing,
    is_of_faces,
    sources_from,
    value_roles,
)
from ...nodes import get_input, has_input
from ..base.translation import translated
from ..scatter.modifier import scatter_modifier
from ..scatter.object import settings_changed, settings_of


def solution_reason(obj: bpy.types.Object, now: Sources) -> str:
    """Why a solution does not belong to the current settings and inputs; empty if it does.

    Inputs that differ because they are animated are no reason.
    """
    names = changed_settings(obj.dapple.solved_settings, settings_of(obj))
    if names and obj.dapple.solved_settings:
        return settings_changed(names)
    if other_surface(obj):
        return other_surface(obj)
    before = sources_from(obj.dapple.solved_from)
    if before is None:
        return ""
    reasons, _ = _compared(obj, before, now)
    return reasons[0] if reasons else ""


def solved_time(obj: bpy.types.Object) -> float | None:
    """The time of the animation at which a result was solved; None if it is not known."""
    before = sources_from(obj.dapple.solved_from)
    return None if before is None else before.frame


def contents(obj: bpy.types.Object, now: Sources) -> tuple[list[str], str]:
    """Reasons for inputs that have changed, and a note of inputs that differ only in this frame."""
    baked = bool(obj.dapple.baked_keys)
    before = sources_from(obj.dapple.baked_from if baked else obj.dapple.solved_from)
    if before is not None:
        return _compared(obj, before, now)
    return [], ""


def _compared(obj: bpy.types.Object, before: Sources, now: Sources) -> tuple[list[str], str]:
    """Reasons, and a note of inputs that differ from the previous frame because they move."""
    roles = [role for role in differing(before, now) if role != "faces"]
    same = before.exact.get("faces") == now.exact.get("faces")
    roles = [role for role in roles if not (role == "scale" if same else is_of_faces(role))]
    roles.sort(key=lambda role: role != "shape")  # where all else is depends on it
    if before.frame == now.frame:
        return [_change_note(obj, role) for role in roles], _unknown(before)
    if obj.dapple.baked_keys:  # it is known what moves; shapes have sketches in every frame
        moving = {*before.moving, "shape"}
        return [_change_note(obj, role) for role in roles if role not in moving], ""
    places = [role for role in roles if role in PLACES]
    still = [_change_note(obj, role) for role in roles if role not in PLACES]
    return still, _note(before.frame, places) if places else _unknown(before)


def _unknown(before: Sources) -> str:
    if UNKNOWN not in before.exact.values():
        return ""
    return translated("Attached to other faces since then: values of the surface are not compared")


def frozen_note(obj: bpy.types.Object) -> str:
    """Inputs that moved during a bake that used the density of its first frame; empty if none."""
    roles = obj.dapple.baked_frozen.split()
    if not roles:
        return ""
    return translated(
        "The density is that of frame {frame}, although these move: {what}",
        frame=obj.dapple.baked_start,
        what=_listed(roles),
    )


def _note(frame: float, roles: list[str]) -> str:
    return translated(
        "Differs from frame {frame:g}, where the points were optimized: {what}",
        frame=frame,
        what=_listed(roles),
    )


def _listed(roles: list[str]) -> str:
    labels = {
        "shape": translated("shape of the surface"),
        "scale": translated("shape of the surface"),
        "up": translated("direction and height of the surface"),
        "north": translated("direction and height of the surface"),
        "noise": translated("origin of the surface"),
        "camera": translated("camera"),
        "obstacles": translated("avoided objects"),
        "others": translated("avoided objects"),
        "hiding": translated("objects that hide points"),
        "targets": translated("objects that a distance is measured to"),
        "image": translated("image"),
        "uv": translated("texture coordinates"),
    }
    others = translated("values of the surface")
    return ", ".join(dict.fromkeys(labels.get(role, others) for role in roles))


def _change_note(obj: bpy.types.Object, role: str) -> str:
    """Message that an input has changed."""
    settings, surface = settings_of(obj), obj.dapple.surface.name
    named = value_roles(settings)
    of_surface = {
        "material": translated(
            "Materials of '{surface}' were assigned to other faces", surface=surface
        ),
        "edges": translated("Edges of '{surface}' were marked or unmarked", surface=surface),
        "uv": translated("UV map of '{surface}' was changed", surface=surface),
        POSES: translated(
            "It was not known which places of '{surface}' are seen on all frames", surface=surface
        ),
    }
    if role in of_surface:
        return of_surface[role]
    if role in named:
        return translated("Values of '{name}' were changed", name=named[role])
    if role == "image":
        return translated("Image '{name}' was changed", name=settings.density.image)
    if role == "camera":
        return translated("The camera was moved or changed")
    if role in ("obstacles", "others"):
        return translated("Avoided objects were moved or changed")
    if role == "hiding":
        return translated("Objects that hide points were moved or changed")
    if role == "targets":
        return translated("Objects that a distance is measured to were moved or changed")
    if role == "noise":
        return translated(
            "Surface '{surface}' has another origin, and the noise depends on it", surface=surface
        )
    if role in ("up", "north"):
        return translated(
            "Surface '{surface}' was rotated or moved, and the density depends on it",
            surface=surface,
        )
    return translated("Surface '{surface}' has another shape or scale than before", surface=surface)


def other_surface(obj: bpy.types.Object) -> str:
    """Message that the points belong to another surface than the chosen one; empty if not."""
    modifier = scatter_modifier(obj)
    if modifier is None or not has_input(modifier, "Surface"):
        return ""
    played = get_input(modifier, "Surface")
    if played is None or played == obj.dapple.surface:
        return ""
    return translated(
        "The points are on '{played}', not on '{chosen}'",
        played=played.name,
        chosen=obj.dapple.surface.name,
    )
