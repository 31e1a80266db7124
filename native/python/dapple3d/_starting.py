# SPDX-License-Identifier: GPL-3.0-or-later
"""Ctrl-C while a command is still being imported: a sentence, no traceback.

The package imports this first, so it imports only what every Python has loaded already: signal
itself makes enumerations, which takes a while.
"""

import _signal as signal  # type: ignore[import-not-found]
import os
import sys

CANCELLED = "Cancelled: nothing was written."
INTERRUPTED = 130  # 128 + SIGINT, as shells have it


def is_command() -> bool:
    """Whether this process is the command `dapple`, or `python -m dapple3d`."""
    name = os.path.splitext(os.path.basename(sys.argv[0]))[0] if sys.argv else ""
    return name == "dapple" or (name == "-m" and "dapple3d" in sys.orig_argv)


def _end(_signal: int, _frame: object) -> None:
    os.write(2, f"{CANCELLED}\n".encode())
    os._exit(INTERRUPTED)


def begin() -> None:
    """From here on Ctrl-C ends the process, unless another handler is installed.

    The script `dapple` has it blocked until then.
    """
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _end)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})


def ready() -> None:
    """From here on Ctrl-C raises the exception that the command handles."""
    if signal.getsignal(signal.SIGINT) is _end:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def ended() -> None:
    """From here on there is nothing left to interrupt."""
    if signal.getsignal(signal.SIGINT) in (_end, signal.default_int_handler):
        signal.signal(signal.SIGINT, signal.SIG_IGN)


if is_command():
    begin()
