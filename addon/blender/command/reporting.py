# SPDX-License-Identifier: GPL-3.0-or-later
"""Messages of the command while it works, and signals that stop it."""

import signal
import sys
import time
from dataclasses import dataclass, field
from types import FrameType
from typing import Any

from ...core.base.steps import Stepper, Steps

_POLL = 0.2  # seconds between two looks at the worker
_PRINT_PAUSE = 1.0  # seconds between two lines at least
_NAMES = ("SIGINT", "SIGTERM", "SIGBREAK")
_SIGNALS = [getattr(signal, name) for name in _NAMES if hasattr(signal, name)]


class SignalHandler:
    """Signals that stop the command after current files are written and solved frames
    are stored.
    """

    number = 0  # of the last one

    def __enter__(self) -> "SignalHandler":
        self._before = {one: signal.signal(one, self._note) for one in _SIGNALS}
        return self

    def __exit__(self, *_error: object) -> None:
        for one, before in self._before.items():
            signal.signal(one, signal.SIG_DFL if before is None else before)

    def _note(self, number: int, _frame: FrameType | None) -> None:
        self.number = number


@dataclass
class ProgressPrinter:
    """Prints the progress of work on several scatters to stderr."""

    form: str = "text"
    quiet: bool = False
    count: int = 1  # of the scatters
    at: int = 0  # the one that is worked on
    _percent: int = -1
    _when: float = field(default=-_PRINT_PAUSE)

    def progress(self, name: str, frame: int, share: float) -> None:
        """Print the progress of a scatter."""
        percent = int(100.0 * (self.at + share) / max(self.count, 1))
        now = time.monotonic()
        if self.quiet or percent == self._percent or now - self._when < _PRINT_PAUSE:
            return
        self._percent, self._when = percent, now
        self._percentage(percent, f"'{name}', frame {frame}")

    def done(self) -> None:
        """Print that all work is done."""
        if not self.quiet:
            self._percentage(100, "done")

    def line(self, text: str) -> None:
        """Print an event."""
        if not self.quiet:
            _print(f"openjd_status: {text}" if self.form == "openjd" else f"Dapple: {text}")

    def error(self, text: str) -> None:
        """Print an error."""
        _print(f"Error: Dapple: {text}")

    def warning(self, text: str) -> None:
        """Print a warning: the work was done, but not exactly as requested."""
        _print(f"Warning: Dapple: {text}")

    def _percentage(self, percent: int, text: str) -> None:
        if self.form == "openjd":
            _print(f"openjd_progress: {percent}")
        self.line(text if self.form == "openjd" else f"Progress: {percent}%: {text}")


def run_reporting(steps: Steps, signals: SignalHandler, show: Any) -> Any:
    """Run steps and show their progress; StoppedError after a signal."""
    stepper = Stepper(steps)
    try:
        while not stepper.poll(wait=_POLL):
            if signals.number:
                stepper.cancel()
            show(stepper.progress)
    finally:
        stepper.close()
    return stepper.result


def _print(text: str) -> None:
    print(text, file=sys.stderr, flush=True)
