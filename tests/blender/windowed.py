# SPDX-License-Identifier: GPL-3.0-or-later
"""Replaces bpy in a module that works at once if there are no windows."""

import threading

import bpy


class _App:
    background = False

    def __getattr__(self, name):
        return getattr(bpy.app, name)


class Windowed:
    """bpy of a Blender with windows, in which timers continue the work."""

    app = _App()

    def __getattr__(self, name):
        return getattr(bpy, name)


def held_back(monkeypatch, owner, name):
    """Let a function wait for an event, and record the threads that call it: (event, threads)."""
    call, event, threads = getattr(owner, name), threading.Event(), []

    def waiting(*arguments, **named):
        threads.append(threading.current_thread())
        assert event.wait(60.0)
        return call(*arguments, **named)

    monkeypatch.setattr(owner, name, waiting)
    return event, threads


def until(done, tick):
    """Call tick until done() says so."""
    for _ in range(100_000):
        if done():
            return
        tick()
        threading.Event().wait(0.001)
    raise AssertionError("it was never done")
