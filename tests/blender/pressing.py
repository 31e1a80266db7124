# SPDX-License-Identifier: GPL-3.0-or-later
"""Buttons of long work pressed, and its timer driven by hand: a background Blender has neither."""

import time
from contextlib import contextmanager
from functools import partial
from types import FunctionType, SimpleNamespace

import addon_host
import bpy

_PATIENCE = 120.0  # most seconds for a piece of work


def own_methods(kind):
    """Names of the methods of an operator that are written in Python."""
    return [name for name in dir(kind) if isinstance(getattr(kind, name), FunctionType)]


@contextmanager
def windowed():
    """Let buttons work in the background; yields their driver."""
    jobs = addon_host.part("blender.base.jobs")
    jobs.at_once = False
    try:
        yield Pressing(addon_host.part("blender.base.operator_jobs"))
    finally:
        addon_host.part("blender.base.handlers").publish("before_load")
        jobs.at_once = True


class Pressing:
    """The artist, and the timer."""

    def __init__(self, jobs):
        self.jobs = jobs
        self.reported = []

    def press(self, name, **properties):
        """Press a button; returns the status of its operator."""
        kind = addon_host.registered(f"DAPPLE_OT_{name}")
        given = SimpleNamespace(is_property_set=properties.__contains__)
        button = SimpleNamespace(bl_label=kind.bl_label, properties=given, **properties)
        button.report = lambda kinds, text: self.reported.append((*kinds, text))
        for method in own_methods(kind):
            setattr(button, method, partial(getattr(kind, method), button))
        button.done = kind.done
        job = addon_host.part("blender.base.step_operators")
        return job.StepsOperator.invoke(button, bpy.context, None)

    @property
    def work(self):
        return self.jobs.current()

    def until(self, done):
        """Call the timer until done() is true or nothing is pending."""
        end = time.monotonic() + _PATIENCE
        while self.work is not None and not done():
            assert time.monotonic() < end, "the work does not come to its end"
            self.jobs.tick()

    def finish(self):
        self.until(lambda: False)

    def said(self, obj):
        return self.jobs.notes(obj)
