"""Runs what is missing, each run in a folder of its own, so that an interrupted suite goes on where it was."""

import time
from collections.abc import Callable
from pathlib import Path

from program import Program
from record import can_go_on, is_done, record_done


class Failed(Exception):
    """A run that has no results to be judged by."""


class Runs:
    def __init__(self, program: Program, directory: Path, words: list[str]):
        self._program, self._directory, self._words = program, directory, words

    @property
    def interrupted(self) -> bool:
        return self._program.interrupted

    def value(self, name: str, text: str, value: Callable[[Path], float]) -> tuple[float, float]:
        """What a run of a case text has, and the seconds that it took; 0: it was there already.

        @raise Failed
        """
        folder = self._directory / name
        folder.mkdir(parents=True, exist_ok=True)
        case, out = folder / "case.toml", folder / "out"
        began = time.monotonic()
        if is_done(out, text.encode(), []):
            return value(out), 0.0
        goes_on = case.is_file() and case.read_text() == text and can_go_on(out, text.encode(), [])
        case.write_text(text)
        words = ["resume", str(out)] if goes_on else ["run", str(case), "--output", str(out), "--overwrite"]
        ending = self._program.run([*words, "--quiet", *self._words])
        if ending.code != 0:
            raise Failed(ending.message.splitlines()[0].removeprefix("peristat: ") if ending.message else f"exit code {ending.code}")
        record_done(out, [])
        return value(out), time.monotonic() - began
