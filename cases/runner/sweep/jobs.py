"""Decides how many runs go on at once: limited by cores, memory and other sweeps in the same folder."""

import fcntl
import os
import re
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import suppress
from pathlib import Path

BYTES = {"B": 1.0, "kB": 1e3, "MB": 1e6, "GB": 1e9, "TB": 1e12}
SHARE_OF_MEMORY = 0.9


def bounded(jobs: int, threads: int | None, cores: int) -> tuple[int, int | None]:
    """Number of jobs and threads of each, so that together they use no more than the cores."""
    if jobs == 1:
        return 1, threads
    if threads is None:
        jobs = min(jobs, cores)
        return jobs, max(1, cores // jobs)
    return max(1, min(jobs, cores // threads)), threads


def estimated_memory(told: str) -> tuple[float, float] | None:
    """Memory that a run needs according to `check`, and memory that the machine has [byte]."""
    found = re.search(r"^memory +about ([\d.]+) (\w+) of ([\d.]+) (\w+) available", told, re.MULTILINE)
    if not found or found[2] not in BYTES or found[4] not in BYTES:
        return None
    return float(found[1]) * BYTES[found[2]], float(found[3]) * BYTES[found[4]]


class FolderLock:
    """A lock that gives one sweep exclusive use of a folder; the kernel releases it when the process ends."""

    def __init__(self, folder: Path):
        folder.mkdir(parents=True, exist_ok=True)
        self._folder = folder
        self._descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        self.is_held = True
        try:
            fcntl.flock(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            self.is_held = False
            self.release()
        except OSError:  # a file system without locks can't report one
            pass

    def release(self) -> None:
        if self.is_held:
            with suppress(OSError):  # a refused run leaves nothing behind
                self._folder.rmdir()
        os.close(self._descriptor)


class Jobs:
    """Runs numbered tasks in parallel.

    `memory` returns what a task needs and what is available [byte], or None if unknown; it is called only if there
    are several jobs. A task whose lock another sweep holds is postponed until nothing else is left, and then waited
    for.
    """

    PATIENCE = 0.2  # interval between checks on other sweeps [s]

    def __init__(self, jobs: int, memory: Callable[[int], tuple[float, float] | None],
                 lock: Callable[[int], FolderLock]):  # fmt: skip
        self._jobs, self._memory, self._lock = jobs, memory, lock
        self._running: dict[Future, tuple[int, FolderLock, float]] = {}

    def run(self, numbers: Sequence[int], task: Callable[[int], object],
            goes_on: Callable[[], bool], waits: Callable[[int], None]) -> Iterator[tuple[int, object]]:  # fmt: skip
        """Yields each task's number and result as it ends."""
        waiting = list(numbers)
        told = set()
        with ThreadPoolExecutor(max_workers=self._jobs) as pool:
            while self._running or (waiting and goes_on()):
                while waiting and goes_on() and len(self._running) < self._jobs:
                    if not self._start_one(waiting, pool, task):
                        break
                if not self._running and waiting and waiting[0] not in told:
                    told.add(waiting[0])
                    waits(waiting[0])
                if not self._running:
                    time.sleep(self.PATIENCE)
                done, _ = wait(self._running, timeout=self.PATIENCE, return_when=FIRST_COMPLETED)
                for future in done:
                    number, lock, _ = self._running.pop(future)
                    lock.release()
                    yield number, future.result()

    def _start_one(self, waiting: list[int], pool: ThreadPoolExecutor, task: Callable[[int], object]) -> bool:
        for number in waiting:
            lock = self._lock(number)
            if not lock.is_held:
                continue
            needed = 0.0
            if self._jobs > 1:
                needed, available = self._memory(number) or (float("inf"), 0.0)
                taken = sum(memory for _, _, memory in self._running.values())
                if self._running and taken + needed > SHARE_OF_MEMORY * available:
                    lock.release()
                    return False  # keeps the order, so that small tasks do not overtake a large one forever
            waiting.remove(number)
            self._running[pool.submit(task, number)] = (number, lock, needed)
            return True
        return False
