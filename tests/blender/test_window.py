# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests in a real window, on a virtual display."""

import os
import shutil
import subprocess

import bpy
import child
import pytest

STORIES = ("window.py", "window_live.py", "window_points.py", "window_spray.py", "window_assets.py")


@pytest.mark.skipif(not bpy.app.binary_path, reason="bpy as a module of Python has no window")
@pytest.mark.skipif(not shutil.which("xvfb-run"), reason="no virtual display: xvfb is missing")
@pytest.mark.parametrize("story", STORIES)
def test_what_an_artist_does_in_a_window(story, tmp_path):
    screen = ["xvfb-run", "-a", "-s", "-screen 0 1280x1300x24 +extension GLX"]
    options = (
        "--window-geometry",
        "0",
        "0",
        "1280",
        "1300",
        "--gpu-backend",
        "opengl",
        "--enable-event-simulate",
    )
    done = subprocess.run(
        [*screen, *child.blender(*options), "--python", str(child.HERE / story)],
        env={**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1", "BLENDER_USER_RESOURCES": str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stdout + done.stderr
