# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures that are painted: Blender has no handler for changed pixels, so they are glanced at."""

import time
from typing import Any

import bpy

from ..surface.surroundings import picture_digest

_GLANCE = 1.0  # seconds between two glances, or more where they take long
_RARELY = 20.0  # so much longer than a glance took is the pause

_seen: dict[int, tuple[Any, str]] = {}  # by session_uid: what is quickly compared, and the digest
_pace = {"glanced": 0.0, "took": 0.0}  # by the monotonic clock


def wait() -> float:
    """Seconds until the next glance."""
    pause = max(_GLANCE, _RARELY * _pace["took"])
    return max(pause - (time.monotonic() - _pace["glanced"]), 0.0)


def changed(images: list[bpy.types.Image]) -> set[int]:
    """Those that have other pixels than at the last glance, by session_uid."""
    if wait() > 0.0:
        return set()
    begin = time.monotonic()
    found = {image.session_uid for image in images if _is_other(image)}
    _pace["glanced"] = time.monotonic()
    _pace["took"] = _pace["glanced"] - begin
    return found


def forget() -> None:
    """Know no picture."""
    _seen.clear()
    _pace.update(glanced=0.0, took=0.0)


def _is_other(image: bpy.types.Image) -> bool:
    """A picture that has changes is read; one that is as on the disk is not."""
    token = (image.is_dirty, image.filepath, image.source, tuple(image.size))
    before = _seen.get(image.session_uid)
    if before is not None and token == before[0] and not image.is_dirty:
        return False
    _seen[image.session_uid] = now = (token, picture_digest(image))
    return before is not None and now != before
