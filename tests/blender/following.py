# SPDX-License-Identifier: GPL-3.0-or-later
"""Auto Update driven by hand: a background Blender has no timers, and a test no time to wait."""

import time
from contextlib import contextmanager

import addon_host
import bpy

_PATIENCE = 120.0  # most seconds for an update


def long(obj):
    """Settings with which it takes far longer than a test."""
    obj.dapple.count, obj.dapple.tolerance, obj.dapple.max_evaluations = 20_000, 1e-9, 100_000


def short(obj, count=80):
    obj.dapple.count, obj.dapple.max_evaluations = count, 30


class Clock:
    """Time that goes on when it is told to."""

    def __init__(self):
        self.now = 0.0

    def __call__(self):
        return self.now

    def rest(self):
        """So long that what was changed is worked on."""
        self.now += 10.0 * addon_host.part("core.base.schedule").PAUSE


@contextmanager
def driven():
    """Have scatters follow changes; what the tests call is yielded."""
    watcher = addon_host.part("blender.solve.auto_update")
    watcher.enabled = True
    clock = Clock()
    watcher.reset(clock)
    pictures = addon_host.part("blender.solve.changes")
    glance, rarely = pictures.IMAGE_PAUSE, pictures.IMAGE_PATIENCE
    pictures.IMAGE_PAUSE = pictures.IMAGE_PATIENCE = 0.0  # check at every opportunity
    try:
        yield Driver(watcher, clock)
    finally:
        watcher.reset()
        watcher.enabled = False
        pictures.IMAGE_PAUSE, pictures.IMAGE_PATIENCE = glance, rarely


def _patient():
    end = time.monotonic() + _PATIENCE
    while time.monotonic() < end:
        yield
    raise AssertionError("an update does not come to its end")


class Driver:
    """The timer of Auto Update."""

    def __init__(self, watcher, clock):
        self.watcher, self.clock = watcher, clock

    def look(self):
        """One look, after Blender has evaluated what was changed."""
        bpy.context.view_layer.update()
        return self.watcher.tick()

    def begin(self):
        """Until a worker solves, or nothing is left to be done; whether it solves."""
        self.look()
        self.clock.rest()
        for _ in _patient():
            self.look()
            if not self.watcher.is_solving() or self._has_begun():
                break
        return self.watcher.is_solving()

    def _has_begun(self):
        return any(self.watcher.progress(obj) for obj in bpy.data.objects)

    def settle(self):
        """Until nothing is left to be done; how often something was written."""
        written, follow_up = [], self.watcher.restart_preview
        self.watcher.restart_preview = lambda obj: written.append(follow_up(obj))
        try:
            self._until_idle()
        finally:
            self.watcher.restart_preview = follow_up
        return len(written)

    def _until_idle(self):
        for _ in _patient():
            self.look()
            self.clock.rest()
            self.look()
            if not self.watcher.is_active():
                return
