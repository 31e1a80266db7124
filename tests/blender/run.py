# SPDX-License-Identifier: GPL-3.0-or-later
"""Run these tests inside a Blender executable.

blender -b --python-use-system-env --python-exit-code 1 -P tests/blender/run.py -- -q
PYTHONPATH must lead to pytest and dapple.
"""

import sys
from pathlib import Path

import pytest

arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
sys.exit(pytest.main([str(Path(__file__).resolve().parent), *arguments]))
