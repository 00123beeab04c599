"""Work in several processes at once: matplotlib does not draw in threads."""

import multiprocessing
import os
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor

MOST_PROCESSES = 4

_tasks: list[Callable[[], object]] = []  # inherited by the processes


def _result_of(number: int) -> object:
    return _tasks[number]()


def _may_fork() -> bool:
    """A fork of a process with threads may wait forever for a lock that one of them holds, as those of OpenBLAS do."""
    return len(os.listdir("/proc/self/task")) == 1


def results_of(tasks: list[Callable[[], object]]) -> Iterator[object]:
    """The tasks' results, in their order. Raises what a task raises, BrokenProcessPool if a process dies."""
    count = min(len(tasks), MOST_PROCESSES, len(os.sched_getaffinity(0)))
    if count < 2 or not _may_fork():
        yield from (task() for task in tasks)
        return
    _tasks[:] = tasks
    with ProcessPoolExecutor(count, multiprocessing.get_context("fork")) as pool:
        yield from pool.map(_result_of, range(len(tasks)))
