# SPDX-License-Identifier: GPL-3.0-or-later
"""Python with bpy in a process of its own: the wheel's Python, or this Blender executable."""

import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import bpy

HERE = Path(__file__).resolve().parent

_HEAD = f"""
import os, sys
arguments = sys.argv[sys.argv.index("--") + 1 :]
sys.path.insert(0, {str(HERE)!r})
import bpy
"""
_TAIL = """
sys.stdout.flush()
os._exit(0)
"""


def run(script, *arguments, **environment):
    """What a script prints; it finds its arguments in `arguments`."""
    done = _done(script, *arguments, **environment)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def killed(script, *arguments, **environment):
    """Run a script that ends its own process by the signal KILL."""
    done = _done(script, *arguments, **environment)
    assert done.returncode == -signal.SIGKILL, done.stdout + done.stderr


def _done(script, *arguments, **environment):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "script.py")
        path.write_text(_HEAD + script + _TAIL)
        home = {"BLENDER_USER_RESOURCES": folder}
        return subprocess.run(
            [*_command(path), "--", *map(str, arguments)],
            env={**os.environ, **home, **environment},
            capture_output=True,
            text=True,
            timeout=120,
        )


def _command(path):
    if not bpy.app.binary_path:
        return [sys.executable, str(path)]
    return [*blender("--background"), "--python", str(path)]


def blender(*options):
    """Command line of this Blender executable, which fails when its script fails."""
    return [
        bpy.app.binary_path,
        "--factory-startup",
        "--python-use-system-env",
        "--python-exit-code",
        "1",
        *options,
    ]
