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
    """A clock that tests advance."""

    def __init__(self):
        self.now = 0.0

    def __call__(self):
        return self.now

    def rest(self):
        """Advance by more than the pause of Auto Update."""
        self.now += 10.0 * addon_host.part("core.base.schedule").PAUSE


@contextmanager
def driven():
    """Enable Auto Update; yields its driver."""
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
        """Call the timer once, after Blender has evaluated changes."""
        bpy.context.view_layer.update()
        return self.watcher.tick()

    def begin(self):
        """Call the timer until a worker solves or nothing is pending; returns whether it solves."""
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
        """Call the timer until nothing is pending; returns how often a result was written."""
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
            wait = self.look()
            if not self.watcher.is_active():
                return
            if self.watcher.is_solving():
                time.sleep(wait or 0.0)  # as Blender does, while the worker has the processor
