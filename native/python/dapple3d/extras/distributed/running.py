# SPDX-License-Identifier: GPL-3.0-or-later
"""Many calls that need each other's results: in this process, or on a cluster of Dask."""

import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, Any, NamedTuple

from ... import _native as native

if TYPE_CHECKING:
    from distributed import Client, Future, as_completed

# Dask has workers give memory back at once. Solutions ask for the same memory again and again,
# which takes 8 % longer then.
KEEPING = {"distributed.nanny.pre-spawn-environ.MALLOC_TRIM_THRESHOLD_": None}
LOOK = 0.02  # seconds between two checks of the workers


class Task(NamedTuple):
    """A call, function(shared, argument, context), and the tasks that have to end before it."""

    name: str
    argument: Any
    needs: tuple[str, ...] = ()


Function = Callable[[Any, Any, native.Context], Any]
Done = Iterator[tuple[Task, Any]]  # tasks with their results, in the order in which they end
Runner = Callable[[Function, Any, Sequence[Task], native.Context], Done]


def run_here(
    function: Function, shared: Any, tasks: Sequence[Task], context: native.Context
) -> Done:
    """Run tasks one after another; each follows those that it needs."""
    for k, task in enumerate(tasks):
        context.check()
        part = context.part(k / len(tasks), (k + 1) / len(tasks))
        yield task, function(shared, task.argument, part)


def runner_on(client: "Client") -> Runner:
    """A runner that has workers do it; what a lost worker was doing is done again by others."""
    from distributed import as_completed

    def run(
        function: Function, shared: Any, tasks: Sequence[Task], context: native.Context
    ) -> Done:
        # Shared data is sent to each worker once; the scheduler keeps a copy.
        common = client.submit(_same, shared, pure=False)
        futures = _submitted(client, function, common, tasks)
        named = {futures[task.name].key: task for task in tasks}
        waiting = as_completed(futures.values(), loop=client.loop)
        try:
            for k, future in enumerate(_ended(waiting, context), 1):
                task = named[future.key]
                # A result that is held would be computed again if its worker is lost.
                del futures[task.name]
                yield task, _result(task, future)
                context.advance(k / len(tasks))
        finally:
            # Tasks that nobody waits for are not begun. A cancel would fail at results that were
            # let go and that others need.
            for left in (common, *futures.values()):
                left.release()

    return run


def _submitted(
    client: "Client", function: Function, common: "Future", tasks: Sequence[Task]
) -> "dict[str, Future]":
    futures: dict[str, Future] = {}
    for k, task in enumerate(tasks):
        needed = [futures[name] for name in task.needs if name in futures]
        futures[task.name] = client.submit(
            _call, function, common, task.argument, *needed, pure=False, priority=-k
        )
    return futures


def _same(value: Any) -> Any:
    return value


def _call(function: Function, shared: Any, argument: Any, *needed: Any) -> Any:
    return function(shared, argument, native.Context())


def _ended(waiting: "as_completed", context: native.Context) -> Iterator["Future"]:
    """Futures as they end, with a look at whether all is cancelled."""
    while not waiting.is_empty():
        context.check()
        if waiting.has_ready():
            yield next(waiting)
        else:
            time.sleep(LOOK)


def _result(task: Task, future: "Future") -> Any:
    from distributed import KilledWorker

    try:
        return future.result()
    except KilledWorker as error:
        raise OSError(f"{task.name}: every worker that did this died: {error}") from error


@contextmanager
def connected(scheduler: "str | Client | None", workers: int) -> Iterator["Client"]:
    """A client of a cluster: one's own, that at an address, or a new one on this machine.

    Raises:
        ImportError: Dask distributed is missing.
        OSError: there is no scheduler at the address.
    """
    try:
        import dask
        from distributed import Client, LocalCluster
    except ImportError as error:
        raise ImportError(
            "work for several processes needs distributed, which is missing: "
            'pip install "dapple3d[farm]"'
        ) from error
    if isinstance(scheduler, Client):
        yield scheduler
        return
    with ExitStack() as stack:
        if scheduler is None:
            stack.enter_context(dask.config.set(KEEPING))
            scheduler = stack.enter_context(
                LocalCluster(
                    n_workers=workers or len(os.sched_getaffinity(0)),
                    threads_per_worker=1,
                    dashboard_address=":0",
                )
            )
        yield stack.enter_context(Client(scheduler, set_as_default=False))


@contextmanager
def chosen_runner(scheduler: "str | Client | None", workers: int | None) -> Iterator[Runner]:
    """One on a cluster if a scheduler or a number of workers is given, else one in this process."""
    if scheduler is None and workers is None:
        yield run_here
        return
    with connected(scheduler, workers or 0) as client:
        yield runner_on(client)


def shown(done: Done, total: int, label: str) -> Done:
    """The same, while a line on stderr tells how far it is."""
    for k, ended in enumerate(done, 1):
        yield ended
        print(f"\r{label}: {k} of {total}", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
