# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes in the file, and the scatters that depend on them.

Handlers only note changes; the dependencies of a scatter are looked up on demand. If a scatter was
updated because of another one, that does not update the other one in turn: two scatters that avoid
each other would be updated forever. So the data written by an update has a cause: the scatters that
led to the update.
"""

import time
from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field
from typing import Any

import bpy

from ...core.base.native import missing
from ..base.activity import is_using_tool, last_operator
from ..base.handlers import Evaluation
from ..base.times import time_of
from ..freshness.content_changes import solved_time
from ..freshness.scene_snapshot import AROUND, SURFACE, VALUES, depends_on
from ..scatter.linked_data import is_in_view_layer, read_only
from ..scatter.object import is_automatic, is_scatter
from ..surface.images import picture_digest
from ..surface.joined_parts import collections_of
from ..surface.surroundings import picture_of

Cause = frozenset[int]  # session_uids of scatters
NOBODY: Cause = frozenset()
_READ = {SURFACE, VALUES, AROUND}  # parts of the scene that a solution depends on
IMAGE_PAUSE = 1.0  # seconds between two checks of images
IMAGE_PATIENCE = 20.0  # smallest ratio of the pause between checks to their duration


@dataclass
class Pictures:
    """The images at the last check."""

    # By session_uid: properties that are compared quickly, and the digest.
    _seen: dict[int, tuple[Any, str]] = field(default_factory=dict)
    _images_checked: float = 0.0  # time of the last check, monotonic
    _took: float = 0.0  # its duration in seconds

    def wait(self) -> float:
        """Seconds until the next check."""
        pause = max(IMAGE_PAUSE, IMAGE_PATIENCE * self._took)
        return max(pause - (time.monotonic() - self._images_checked), 0.0)

    def changed(self, images: list[bpy.types.Image]) -> set[int]:
        """The session_uids of images whose pixels changed since the last check."""
        if self.wait() > 0.0:
            return set()
        begin = time.monotonic()
        found = {image.session_uid for image in images if self._is_other(image)}
        self._images_checked = time.monotonic()
        self._took = self._images_checked - begin
        return found

    def _is_other(self, image: bpy.types.Image) -> bool:
        """An image is read only if it has unsaved changes or its file changed."""
        token = (image.is_dirty, image.filepath, image.source, tuple(image.size))
        before = self._seen.get(image.session_uid)
        if before is not None and token == before[0] and not image.is_dirty:
            return False
        self._seen[image.session_uid] = now = (token, picture_digest(image))
        return before is not None and now != before


@dataclass
class Changes:
    """Noted changes, by session_uid; file data is always looked up again."""

    _touched: set[int] = field(default_factory=set)  # changed data-blocks
    _depends: dict[int, set[Hashable]] = field(default_factory=dict)  # dependencies of each scatter
    _images: set[int] = field(default_factory=set)  # images in use
    _pictures: Pictures = field(default_factory=Pictures)
    _relinked: bool = True  # whether dependencies must be looked up again
    _outdated: set[int] = field(default_factory=set)  # scatters whose dependencies changed
    _mark_all: bool = False
    _skipped: set[int] = field(default_factory=set)  # scatters that did not follow a change
    # Scatters that wait for a frame, and the time at which they were solved.
    _waiting: dict[int, float] = field(default_factory=dict)
    # Data written by updates, with their causes.
    _wrote: dict[int, Cause] = field(default_factory=dict)
    used_tool: bool = False  # at the last check
    _last_operator: int = 0  # when the last change was noted
    _ended: bool = False  # whether the tool or operator that made changes has ended

    def note(self, evaluation: Evaluation) -> bool:
        """Note edited data-blocks; returns whether there are any unprocessed changes."""
        for one in evaluation.updates:
            if not one.is_edited:
                continue
            self._touched.add(one.uid)
            if isinstance(one.block, bpy.types.Collection | bpy.types.Scene):
                self._relinked = True  # other objects may be avoided, or another camera used
            elif isinstance(one.block, bpy.types.Object):
                self._relinked |= one.uid not in self._depends and is_scatter(one.block)
        before, self._last_operator = self._last_operator, last_operator()
        self._ended |= self.any_noted() and before != self._last_operator
        return self.any_noted()

    def note_operator_end(self) -> None:
        """Note whether the artist has just finished using a tool."""
        before, self.used_tool = self.used_tool, is_using_tool()
        self._ended |= before and not self.used_tool

    def take_operator_end(self) -> bool:
        """Whether the tool or operator that made changes has ended since the last call."""
        ended, self._ended = self._ended, False
        return ended

    def any_noted(self) -> bool:
        """Whether there are unprocessed changes."""
        return bool(self._touched)

    def relink(self) -> None:
        """Look up the dependencies of scatters again."""
        self._relinked = True

    def mark_all(self) -> None:
        """Treat all scatters as changed, since an undo may have changed anything."""
        self._mark_all = self._relinked = True

    def skip(self, uid: int) -> None:
        """Note that a scatter did not follow a change; it is checked again at its next change."""
        self._skipped.add(uid)

    def start_update(self, uid: int) -> None:
        """Note that a scatter will be updated."""
        self._skipped.discard(uid)
        self._waiting.pop(uid, None)

    def wait_for_frame(self, obj: bpy.types.Object) -> None:
        """Check a scatter again at the frame at which it was solved, as shapes must be compared."""
        time = solved_time(obj)
        if time is not None and time != time_of(bpy.context.scene):
            self._waiting[obj.session_uid] = time

    def note_frame(self, scene: bpy.types.Scene) -> bool:
        """Note the current frame; returns whether a scatter has waited for it."""
        shown = {uid for uid, time in self._waiting.items() if time == time_of(scene)}
        self._skipped |= shown
        self._touched |= shown
        return bool(shown)

    def wrote(self, written: Mapping[int, Cause]) -> None:
        """Note data that an update has written."""
        self._wrote |= written

    def check_images(self) -> None:
        """Check whether images in use were painted, for which Blender has no handler."""
        if self._images:
            watched = [one for one in bpy.data.images if one.session_uid in self._images]
            self._touched |= self._pictures.changed(watched)

    def wait(self) -> float | None:
        """Seconds until the next check of images; None if there are none."""
        return self._pictures.wait() if self._images else None

    def changed_scatters(self, being_written: Mapping[int, Cause]) -> list[tuple[int, Cause]]:
        """Scatters that depend on changes since the last call, each with its cause."""
        edited, self._touched = self._touched, set()
        causes = {uid: self._wrote.pop(uid) for uid in edited & self._wrote.keys()}
        causes |= being_written
        found = []
        for uid, depends in self._looked_up().items():
            because = {causes.get(block, NOBODY) for block in edited if block in depends}
            if self._mark_all or uid in self._outdated or uid in edited & self._skipped:
                because.add(NOBODY)
            found += [(uid, cause) for cause in because if uid not in cause]
        self._mark_all = False
        self._outdated.clear()
        return found

    def known_scatters(self) -> set[int]:
        """The scatters of the file."""
        return set(self._looked_up())

    def _looked_up(self) -> dict[int, set[Hashable]]:
        """The dependencies of scatters; a scatter whose dependencies differ counts as changed."""
        if self._relinked:
            self._relinked = False
            before = self._depends
            self._depends = {obj.session_uid: dependencies(obj) for obj in scatters()}
            densities = [obj.dapple.density for obj in scatters() if follows(obj)]
            self._images = {one.image.session_uid for one in densities if one.image is not None}
            self._outdated |= {
                uid for uid, now in self._depends.items() if now != before.get(uid, now)
            }
        return self._depends


def follows(obj: bpy.types.Object) -> bool:
    """Whether a scatter may be updated automatically: it has a result and no bake, which would be
    lost, and it is in Object Mode in the current view layer.
    """
    settings = obj.dapple
    if not settings.solved_settings or settings.baked_keys or not is_automatic(obj):
        return False
    is_visible = is_in_view_layer(obj) and settings.surface is not None
    return is_visible and obj.mode == "OBJECT" and not read_only(obj) and not missing()


def scatters() -> list[bpy.types.Object]:
    """The scatters of the file."""
    return [obj for obj in bpy.data.objects if is_scatter(obj)]


def dependencies(obj: bpy.types.Object) -> set[Hashable]:
    """The inputs of a scatter, by session_uid, without the scatter itself.

    Collections are left out, since they change with every object in them. So is the scene, which
    changes with every selection: the settings that Camera View reads are added as values.
    """
    scene, density = bpy.context.scene, obj.dapple.density
    found: set[Hashable] = {
        uid for uid, parts in depends_on(obj, scene).items() if _READ & set(parts)
    }
    found.discard(scene.session_uid)
    if density.use_camera_view:
        found.add(picture_of(scene))
    listed = (density.avoid_collection, density.distance_collection, density.hiding_collection)
    for one in filter(None, listed):
        found -= {block.session_uid for block in (one, *one.children_recursive)}
    return found - {one.session_uid for one in collections_of(obj.dapple.surface)}
