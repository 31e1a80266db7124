# SPDX-License-Identifier: GPL-3.0-or-later
"""The command on Blender's command line: it processes scatters, writes a report and returns an exit
code.
"""

import json
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import bpy

from ...core.base.atomic_file import part_of, replacing
from ...core.base.errors import ScatterError, StoppedError
from ...core.base.native import missing, package
from .arguments import Arguments, parsed
from .reporting import ProgressPrinter, SignalHandler, run_reporting
from .shot import Shot
from .verbs import CURRENT, OUTDATED, VERBS, Facts

NAME = "dapple"
FAILED, STOPPED = "failed", "stopped"
_SIGNALED = 128  # is added to the number of a signal
FORMAT = 1  # another number where a program that reads reports would not understand it


@dataclass
class _State:
    """The registered command."""

    handle: Any = None


_state = _State()


def main(arguments: list[str]) -> int:
    """Run a command line on the open file; returns the exit code."""
    try:
        options = parsed(arguments)
    except SystemExit as end:
        return int(end.code or 0)
    with SignalHandler() as signals:
        return _Run(options, signals).all()


@dataclass
class _Run:
    """One run of the command."""

    options: Arguments
    signals: SignalHandler
    found: list[Facts] = field(default_factory=list)  # one for each scatter
    troubles: list[str] = field(default_factory=list)  # of the whole
    saved: str = ""  # the file

    def __post_init__(self) -> None:
        self.printer = ProgressPrinter(self.options.progress, self.options.quiet)
        self.verb = VERBS[self.options.verb]

    def all(self) -> int:
        """Process all scatters and write the report; returns the exit code."""
        begin = time.monotonic()
        self._attempt(self._work)
        code = self._code()
        if self.options.json is not None:
            self._attempt(self._report, self.options.json, code, time.monotonic() - begin)
        return code or self._code()

    def _report(self, path: Path, code: int, seconds: float) -> None:
        facts = {"exit": code, "seconds": seconds, "saved": self.saved, "errors": self.troubles}
        write_report(path, self.options.verb, {**facts, "scatters": self.found})

    def _work(self) -> None:
        shot = Shot(self.options)
        groups = [shot.scatters] if self.verb.together else [[obj] for obj in shot.scatters]
        self.printer.count = len(groups)
        for self.printer.at, group in enumerate(filter(None, groups)):
            if not self.signals.number:
                self._do(group)
        if self.verb.saves and self._is_worth_saving():
            shot.save()
            self.saved = str(shot.target)
            self.printer.line(f"saved '{self.saved}'")
        if not self._code():
            self.printer.done()

    def _is_worth_saving(self) -> bool:
        """Whether the file has changed, or is to be saved under another name."""
        copied = self.options.output is not None and not self._code()
        return copied or any(map(_has_changed, self.found))

    def _attempt(self, work: Callable[..., None], *arguments: Any) -> None:
        try:
            work(*arguments)
        except (ScatterError, OSError) as error:
            self.troubles.append(str(error))
            self.printer.error(str(error))

    def _do(self, group: list[bpy.types.Object]) -> None:
        """Process scatters; an error does not stop the work on other scatters."""
        names, begin = [obj.name for obj in group], time.monotonic()
        facts = self._outcome(group) | {"seconds": time.monotonic() - begin}
        found = [{"name": name, **facts} for name in names]
        self.found += found
        for one in found:
            self._print_outcome(one)

    def _outcome(self, group: list[bpy.types.Object]) -> Facts:
        first = group[0]
        try:
            with bpy.context.temp_override(object=first, active_object=first):
                steps = self.verb.steps(group, self.options)
                return dict(run_reporting(steps, self.signals, self._progress(first)))
        except StoppedError as error:
            return {"state": STOPPED, "error": str(error)}
        except ScatterError as error:
            return {"state": FAILED, "error": str(error)}
        except Exception as error:  # a bug, or no memory: the others are done and saved
            traceback.print_exc()
            return {"state": FAILED, "error": f"{type(error).__name__}: {error}"}

    def _progress(self, obj: bpy.types.Object) -> Any:
        name, scene = obj.name, bpy.context.scene
        return lambda share: self.printer.progress(name, scene.frame_current, share)

    def _print_outcome(self, facts: Facts) -> None:
        text = f"'{facts['name']}': {facts['state']}"
        if "error" in facts:
            self.printer.error(f"{text}: {facts['error']}")
        elif facts["state"] in (CURRENT, OUTDATED):
            print(": ".join(filter(None, (text, facts.get("reason")))), flush=True)
        else:
            self._print_done(text, facts)

    def _print_done(self, text: str, facts: Facts) -> None:
        if facts.get("resumed"):
            text = f"{text}, {facts['resumed']} frames by a run before"
        self.printer.line(text)
        for warning in facts.get("warnings", ()):
            self.printer.warning(warning)

    def _code(self) -> int:
        if self.signals.number:
            return _SIGNALED + self.signals.number
        return int(bool(self.troubles) or any(map(_is_wrong, self.found)))


def _has_changed(facts: Facts) -> bool:
    return facts["state"] not in (FAILED, STOPPED, CURRENT)


def _is_wrong(facts: Facts) -> bool:
    return facts["state"] in (FAILED, STOPPED, OUTDATED)


def is_registered() -> bool:
    """Whether the command is registered in Blender."""
    return _state.handle is not None


def register() -> None:
    """Add the command to Blender's command line."""
    _state.handle = bpy.utils.register_cli_command(NAME, main)


def unregister() -> None:
    """Remove the command."""
    if _state.handle is not None:
        bpy.utils.unregister_cli_command(_state.handle)
        _state.handle = None


def write_report(path: Path, verb: str, facts: dict[str, Any]) -> None:
    """Write the report; OSError if that fails."""
    report = {
        "format": FORMAT,
        "command": verb,
        "file": bpy.data.filepath,
        "dapple": "" if missing() else package().__version__,
        "blender": bpy.app.version_string,
        **facts,
    }
    path = path.absolute()
    with replacing(path, part_of(path)) as part:
        part.write_text(json.dumps(report, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
