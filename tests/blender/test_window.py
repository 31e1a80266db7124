# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests in a real window, on a virtual display."""

import os
import shutil
import subprocess

import bpy
import child
import pytest

STORIES = ("window.py", "window_live.py", "window_points.py", "window_spray.py", "window_assets.py")


def in_windows(test):
    """Mark a test that needs a real window."""
    for missing, reason in (
        (not bpy.app.binary_path, "bpy as a module of Python has no window"),
        (not shutil.which("xvfb-run"), "no virtual display: xvfb is missing"),
    ):
        test = pytest.mark.skipif(missing, reason=reason)(test)
    return test


@in_windows
@pytest.mark.parametrize("story", STORIES)
def test_what_an_artist_does_in_a_window(story, tmp_path):
    in_a_window(tmp_path, "--enable-event-simulate", "--python", str(child.HERE / story))


@in_windows
def test_a_file_of_the_command_line_is_opened(tmp_path):
    """Blender crashed, with the add-on enabled, as when a file manager opens a file."""
    path = tmp_path / "opened.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    in_a_window(tmp_path, "--python", str(child.HERE / "window_opened.py"), str(path))


def in_a_window(folder, *options):
    """Run Blender with these options on a virtual display, until it ends well."""
    screen = ["xvfb-run", "-a", "-s", "-screen 0 1280x1300x24 +extension GLX"]
    geometry = ("--window-geometry", "0", "0", "1280", "1300", "--gpu-backend", "opengl")
    done = subprocess.run(
        [*screen, *child.blender(*geometry), *options],
        env={**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1", "BLENDER_USER_RESOURCES": str(folder)},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stdout + done.stderr
