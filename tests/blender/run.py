# SPDX-License-Identifier: GPL-3.0-or-later
"""Run these tests inside a Blender executable.

blender -b --python-use-system-env --python-exit-code 1 -P tests/blender/run.py -- -q
PYTHONPATH must lead to pytest and, unless DAPPLE_TESTED_ZIP brings it, to dapple. Files and folders
among the arguments are run instead of all tests.
"""

import sys
from pathlib import Path

import pytest

arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
if not any(Path(argument).exists() for argument in arguments):
    arguments.append(str(Path(__file__).resolve().parent))
sys.exit(pytest.main(arguments))
