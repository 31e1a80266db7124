# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures that are painted: Blender has no handler for changed pixels, so they are glanced at."""

import time
from dataclasses import dataclass, field
from typing import Any

import bpy

from ..surface.images import picture_digest

_GLANCE = 1.0  # seconds between two glances, or more where they take long
_RARELY = 20.0  # so much longer than a glance took is the pause


@dataclass
class Pictures:
    """What the last glance saw."""

    _seen: dict[int, tuple[Any, str]] = field(default_factory=dict)  # by session_uid: what is
    # quickly compared, and the digest
    _glanced: float = 0.0  # when, by the monotonic clock
    _took: float = 0.0  # seconds

    def wait(self) -> float:
        """Seconds until the next glance."""
        pause = max(_GLANCE, _RARELY * self._took)
        return max(pause - (time.monotonic() - self._glanced), 0.0)

    def changed(self, images: list[bpy.types.Image]) -> set[int]:
        """Those that have other pixels than at the last glance, by session_uid."""
        if self.wait() > 0.0:
            return set()
        begin = time.monotonic()
        found = {image.session_uid for image in images if self._is_other(image)}
        self._glanced = time.monotonic()
        self._took = self._glanced - begin
        return found

    def _is_other(self, image: bpy.types.Image) -> bool:
        """A picture that has changes is read; one that is as on the disk is not."""
        token = (image.is_dirty, image.filepath, image.source, tuple(image.size))
        before = self._seen.get(image.session_uid)
        if before is not None and token == before[0] and not image.is_dirty:
            return False
        self._seen[image.session_uid] = now = (token, picture_digest(image))
        return before is not None and now != before
