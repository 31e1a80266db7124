# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators that fail restore the file and report the reason in a sentence."""

import traceback
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import bpy

from ...core.base.errors import ScatterError, StoppedError
from .file_snapshot import FileSnapshot
from .translation import operator_label, translated_report

Status = set[str]  # that operators return
_Call = Callable[[], Any]


@dataclass
class _State:
    open: bool = False  # whether there are changes that may have to be undone
    later: list[_Call] = field(default_factory=list)  # called once nothing can fail any more


_state = _State()


@contextmanager
def all_or_nothing(
    context: bpy.types.Context, objects: Iterable[bpy.types.Object] = ()
) -> Iterator[None]:
    """Restore objects if the code inside fails: the active one, the given ones, and objects that
    their properties name. A nested block is a part of the outer one.
    """
    if _state.open:
        yield
        return
    before = FileSnapshot(context, objects)
    _state.open = True
    try:
        yield
        _state.open = False
        _do_later()
    except BaseException:
        _state.open = False
        _state.later.clear()
        before.restore()
        raise
    before.forget()


def is_open() -> bool:
    """Whether there are changes that may have to be undone."""
    return _state.open or bool(_state.later)


def once_done(call: _Call) -> None:
    """Call a function once nothing can fail any more; at once if no operator is running."""
    if _state.open:
        _state.later.append(call)
    else:
        call()


def _do_later() -> None:
    calls, _state.later = _state.later, []
    for call in calls:
        call()


def sentence(label: str, error: Exception) -> str:
    """The error message of an operator; details of unexpected errors go to the console."""
    if isinstance(error, (ScatterError, StoppedError)):
        return str(error)
    if isinstance(error, OSError) and error.filename:
        return f"'{error.filename}': {error.strerror}"
    traceback.print_exception(error)
    return translated_report(
        "'{work}' failed, nothing was changed: {error}",
        work=operator_label(label),
        error=str(error) or type(error).__name__,
    )


def tried(
    operator: Any,
    context: bpy.types.Context,
    work: Callable[[], Status | None],
    objects: Callable[[], Iterable[bpy.types.Object]] = list,
) -> Status:
    """Do the work of an operator, undo it if it fails, and return the operator's status."""
    try:
        with all_or_nothing(context, objects()):
            status = work()
    except Exception as error:
        kind = "WARNING" if isinstance(error, StoppedError) else "ERROR"
        operator.report({kind}, sentence(operator.bl_label, error))
        return {"CANCELLED"}
    return {"FINISHED"} if status is None else status


class AllOrNothing:
    """Mixin for operators: write work(context), perhaps concerned(context)."""

    bl_label: str
    report: Callable[[set[str], str], None]

    def work(self, context: bpy.types.Context) -> Status | None:
        """Do the work; None means FINISHED."""
        raise NotImplementedError

    def concerned(self, context: bpy.types.Context) -> list[bpy.types.Object]:
        """Objects that are written besides the active one; ScatterError if there are none."""
        return []

    def execute(self, context: bpy.types.Context) -> Status:
        """Do the work or change nothing."""
        return tried(self, context, lambda: self.work(context), lambda: self.concerned(context))
