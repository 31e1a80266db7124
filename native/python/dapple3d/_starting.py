# SPDX-License-Identifier: GPL-3.0-or-later
"""Ctrl-C while a command is still being imported: a sentence, no traceback.

The package imports this first, so it imports nothing that takes long.
"""

import os
import signal
import sys
from types import FrameType
from typing import Final

CANCELLED: Final = "Cancelled: nothing was written."
INTERRUPTED: Final = 130  # 128 + SIGINT, as shells have it


def is_command() -> bool:
    """Whether this process is the command `dapple`, or `python -m dapple3d`."""
    name = os.path.splitext(os.path.basename(sys.argv[0]))[0] if sys.argv else ""
    return name == "dapple" or (name == "-m" and "dapple3d" in sys.orig_argv)


def _end(_signal: int, _frame: FrameType | None) -> None:
    os.write(2, f"{CANCELLED}\n".encode())
    os._exit(INTERRUPTED)


def begin() -> None:
    """From here on Ctrl-C ends the process, unless somebody else listens to it."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _end)


def ready() -> None:
    """From here on Ctrl-C is the exception that the command waits for."""
    if signal.getsignal(signal.SIGINT) is _end:
        signal.signal(signal.SIGINT, signal.default_int_handler)


if is_command():
    begin()
