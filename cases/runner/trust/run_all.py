"""Runs the missing cases in parallel, each in a folder of its own, so that an interrupted suite continues and two
suites in one folder share the work."""

import json
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from given import in_case
from jobs import FolderLock, Jobs, estimated_memory
from own_files import CASE, remove_own, write_own
from program import Ending, Program
from record import can_go_on, is_done, record_done


LIMIT = 900.0  # s; a run that takes longer is interrupted, and the next suite resumes it


class Failed(Exception):
    """A run without usable results."""


@dataclass
class Ran:
    """One run, and how it ended."""

    name: str
    results: Path
    failure: str = ""  # why there are no results

    def value(self, of: Callable[[Path], float]) -> float:
        """@raise Failed also if the results lack the requested quantity"""
        if self.failure:
            raise Failed(self.failure)
        try:
            return of(self.results)
        except (LookupError, ValueError, ZeroDivisionError) as error:
            raise Failed(f"its results can't be judged: {error}") from error

    @property
    def seconds(self) -> float:
        """Duration of the run, in this or an earlier suite."""
        return json.loads((self.results / "summary.json").read_text())["seconds"]["total"] if not self.failure else 0.0


class Runs:
    def __init__(self, program: Program, directory: Path, jobs: int, threads: int, tell: Callable[[str], None],
                 given: dict[str, str] | None = None):  # fmt: skip
        """@param given values of keys in the place of the setting's"""
        self._program, self._directory, self._jobs, self._tell = program, directory, jobs, tell
        self._given = given or {}
        self._words = ["--threads", str(threads)]

    @property
    def interrupted(self) -> bool:
        return self._program.interrupted

    def run(self, texts: dict[str, str]) -> Iterator[Ran]:
        """Runs case texts by name and yields them as they end; fewer if the suite is interrupted."""
        texts = {name: CASE.decode() + text for name, text in texts.items()}
        names = list(texts)
        jobs = Jobs(self._jobs, lambda number: self._memory(names[number], texts[names[number]]),
                    lambda number: FolderLock(self._folder(names[number])))  # fmt: skip
        waits = lambda number: self._tell(f"{names[number]}: another suite is running it; waiting for its end")
        task = lambda number: self._run(names[number], texts[names[number]])
        for _, ran in jobs.run(range(len(names)), task, lambda: not self.interrupted, waits):
            if not self.interrupted or not ran.failure:
                yield ran

    def _folder(self, name: str) -> Path:
        return self._directory / name

    def _memory(self, name: str, text: str) -> tuple[float, float] | None:
        folder = self._folder(name)
        settings = in_case(self._given, text)
        if is_done(folder / "out", text.encode(), settings):
            return 0.0, 1.0
        case = folder / "asked.toml"
        write_own(case, text.encode(), CASE)
        told = self._program.run(["check", str(case), *_set(settings)], told=True).output
        remove_own(case, CASE)
        return estimated_memory(told)

    def _run(self, name: str, text: str) -> Ran:
        case, out = self._folder(name) / "case.toml", self._folder(name) / "out"
        settings = in_case(self._given, text)
        if is_done(out, text.encode(), settings):
            return Ran(name, out)
        is_known = case.is_file()
        goes_on = is_known and case.read_text() == text and can_go_on(out, text.encode(), settings)
        write_own(case, text.encode(), CASE)
        # The suite may have been moved; then its results name the case's earlier path.
        moved = ["--overwrite"] if is_known else []
        words = ["resume", str(out)] if goes_on else ["run", str(case), *_set(settings), "--output", str(out), *moved]
        began = time.monotonic()
        ending = self._program.run([*words, "--quiet", "--no-plots", *self._words], limit=LIMIT)
        if ending.code != 0:
            return Ran(name, out, self._failure(ending, case, time.monotonic() - began))
        record_done(out, settings)
        self._tell(f"{name}: {time.monotonic() - began:.0f} s")
        return Ran(name, out)

    def _failure(self, ending: Ending, case: Path, seconds: float) -> str:
        """A message without the path of the suite's folder."""
        if seconds >= LIMIT and not self.interrupted:
            return f"no end within {LIMIT:.0f} s"
        first = ending.message.splitlines()[0] if ending.message else f"exit code {ending.code}"
        return first.removeprefix("peristat: ").removeprefix(f"{case}:")


def _set(settings: list[str]) -> list[str]:
    return [word for setting in settings for word in ("--set", setting)]
