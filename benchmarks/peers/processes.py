# SPDX-License-Identifier: GPL-3.0-or-later
"""Asks a contender in a process of its own; whatever happens there becomes one line."""

from __future__ import annotations

import contextlib
import importlib.util
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.peers.contenders import Task

ROOT = Path(__file__).resolve().parents[2]
WORKER = Path(__file__).with_name("worker.py")
LONGEST = 120  # characters of a reason


class RefusedError(Exception):
    """Why there is no result, in one line."""


def ask(
    command: Sequence[str], limit: float, task: Task | None = None, runs: int = 1
) -> dict[str, Any]:
    """What the worker of this command, less its files, makes of a task."""
    with tempfile.TemporaryDirectory() as folder:
        made, given = Path(folder, "out.npz"), Path(folder, "in.npz")
        files = [str(made)]
        if task:
            np.savez(given, runs=runs, **task._asdict())
            files.append(str(given))
        why = failure([*command, *files], limit)
        if not made.is_file():
            raise RefusedError(why or "ended without a result")
        with np.load(made) as stored:
            return dict(stored)


def failure(command: Sequence[str], limit: float) -> str:
    """Runs a command; why it failed in one line, or nothing."""
    path = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH")]))
    with tempfile.TemporaryFile("w+", errors="replace") as said:
        try:
            process = subprocess.Popen(
                command,
                env=os.environ | {"PYTHONPATH": path},
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=said,
                start_new_session=True,  # so that what it has started ends with it
            )
        except OSError as error:
            return one_line(str(error))
        try:
            status = process.wait(limit)
        except subprocess.TimeoutExpired:
            return f"ended after {limit:g} s, the limit"
        finally:
            _end(process)
        said.seek(0)
        return reason(status, said.read())


def _end(process: subprocess.Popen[bytes]) -> None:
    """The process and those that it has started."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def reason(status: int, said: str) -> str:
    """What an exit status means: a signal's name, or the last line on stderr."""
    if status < 0:
        return f"crashed: {signal.Signals(-status).name}"
    lines = [line for line in said.splitlines() if line.strip()]
    return one_line(lines[-1]) if status and lines else f"exit status {status}" if status else ""


def one_line(text: str) -> str:
    """Fit for a cell of a Markdown table."""
    text = " ".join(text.replace("|", "/").split())
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."


def worker(name: str, peers_python: str) -> list[str]:
    """The command of a contender's worker: Dapple and Blender's module are here, the rest there."""
    module = ["-m", "benchmarks.peers.worker", name]
    if name == "dapple":
        return [sys.executable, *module]
    if name != "blender":
        return [peers_python, *module]
    if importlib.util.find_spec("bpy") or not (program := shutil.which("blender")):
        return [sys.executable, *module]
    options = ["--background", "--factory-startup", "--python-use-system-env"]
    ends = ["--python-exit-code", "1", "--python", str(WORKER), "--"]
    return [program, *options, *ends, name]
