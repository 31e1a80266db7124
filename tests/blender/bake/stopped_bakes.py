# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes that are stopped, for tests of how they go on."""

import addon_host
import bpy


def stop_after(tasks, frames):
    """Begin to bake the active scatter from frame 1 on, and stop after so many tasks."""
    package = addon_host.part("core.base.native").package()
    going = addon_host.part("blender.bake.steps").bake_steps(bpy.context, 1, frames)
    task = next(going)
    for _ in range(tasks):
        task = going.send(task.call(package.Context()))
    going.close()
