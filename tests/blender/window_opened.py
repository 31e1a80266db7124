# SPDX-License-Identifier: GPL-3.0-or-later
"""Enables the add-on before Blender opens the file of its command line, and leaves when it is open.

Started as `blender --python window_opened.py FILE`.
"""

import os
import sys
import tempfile
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))
import addon_host

addon_host.add_repository(Path(tempfile.mkdtemp()))
addon_host.enable()


def _leave_once_open() -> float:
    if bpy.data.filepath:
        addon_host.disable()
        os._exit(0)
    return 0.1


bpy.app.timers.register(_leave_once_open, first_interval=0.1, persistent=True)
