# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work in a thread of its own, with a progress bar, stopped by Ctrl-C."""

import sys
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor, wait
from types import TracebackType
from typing import Self, TypeVar

import click

import dapple3d as dapple

Result = TypeVar("Result")
INTERVAL = 0.1  # seconds between two looks at the progress
LENGTH = 1000  # of the bar, which counts whole numbers


class Work:
    """Steps of equal share, one after the other; the bar is on stderr, if that is a terminal.

    >>> with Work("sampling") as work:
    ...     samples = work.run(partial(dapple.sample, surface, 2000))
    """

    def __init__(self, label: str, *, steps: int = 1, quiet: bool = False) -> None:
        self._steps, self._done, self._shown = steps, 0, 0
        hidden = quiet or not sys.stderr.isatty()
        self._bar = click.progressbar(
            length=LENGTH, label=label, file=sys.stderr, hidden=hidden, show_eta=False
        )

    def __enter__(self) -> Self:
        self._bar.__enter__()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._bar.__exit__(kind, error, trace)

    def run(self, call: Callable[..., Result]) -> Result:
        """The result of call(context=...), which may raise.

        Raises:
            KeyboardInterrupt: by Ctrl-C, once the call has been cancelled and has ended.
        """
        context = dapple.Context()
        with ThreadPoolExecutor(1) as pool:
            future = pool.submit(call, context=context)
            try:
                self._watch(future, context)
            except BaseException:
                context.cancel()
                raise
        self._done += 1
        self._show(0.0)
        return future.result()

    def _watch(self, future: Future[Result], context: dapple.Context) -> None:
        while not wait([future], timeout=INTERVAL).done:
            self._show(context.progress)

    def _show(self, share: float) -> None:
        reached = int(LENGTH * (self._done + share) / self._steps)
        if reached > self._shown:
            self._bar.update(reached - self._shown)
            self._shown = reached
