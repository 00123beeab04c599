"""Runs of a fit by the program, each in a folder of its own; finished ones are used again, interrupted ones resumed."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from jobs import FolderLock, Jobs, estimated_memory
from peristat.fitting.parameters import Parameter
from peristat.fitting.problem import REFUSED, Ran
from peristat.fitting.record import is_finished, record_finished, status_of
from program import Ending, Program
from record import can_go_on
from variations import WrongInput, folder_name

DONE, WRONG_INPUT, NOT_CONVERGED, OUT_OF_MEMORY, INTERRUPTED = 0, 2, 3, 4, 130
WORDS = {OUT_OF_MEMORY: "a run was out of memory", 5: "the machine failed", INTERRUPTED: "interrupted: the same command goes on"}


class Ended(Exception):
    """A run whose ending ends the fit."""

    def __init__(self, code: int, message: str):
        super().__init__(WORDS.get(code, "a run failed") + (f": {message}" if message and code != INTERRUPTED else ""))
        self.code = code if code in (OUT_OF_MEMORY, 5, INTERRUPTED) else 1


@dataclass(frozen=True)
class Case:
    path: Path
    text: bytes


class ProgramRuns:
    def __init__(self, program: Program, cases: list[Case], parameters: list[Parameter],
                 settings: Callable[[int, Sequence[str]], list[str]], directory: Path, jobs: int, threads: int | None,
                 overwrite: bool, tell: Callable[[str], None]):  # fmt: skip
        """@param settings all settings of a run, from the number of its specimen and the values of the parameters"""
        self._program, self._cases, self._parameters, self._settings = program, cases, parameters, settings
        self._directory, self._jobs, self._tell = directory, jobs, tell
        self._words = ([] if threads is None else ["--threads", str(threads)])
        self._overwrite = ["--overwrite"] if overwrite else []
        self._memory_of: dict[int, tuple[float, float] | None] = {}  # by specimen

    def __call__(self, asked: Sequence[tuple[int, tuple[str, ...]]]) -> list[Ran]:
        found: dict[int, Ran] = {}
        ended: list[Ending] = []
        goes_on = lambda: not ended and not self._program.interrupted
        jobs = Jobs(self._jobs, lambda k: self._memory(asked[k][0]), lambda k: FolderLock(self._folder(*asked[k])))
        for k, ran in jobs.run(range(len(asked)), lambda k: self._run(*asked[k]), goes_on, self._tell_waiting):
            if isinstance(ran, Ran):
                found[k] = ran
            else:
                ended.append(ran)
        if ended or self._program.interrupted:
            end = ended[0] if ended and not self._program.interrupted else Ending(INTERRUPTED, "")
            raise Ended(end.code, end.message.partition("\n")[0].removeprefix("peristat: "))
        return [found[k] for k in range(len(asked))]

    def _folder(self, number: int, texts: tuple[str, ...]) -> Path:
        keys = [each.key.rpartition(".")[2] for each in self._parameters]
        names = [key if keys.count(key) == 1 else each.key for key, each in zip(keys, self._parameters, strict=True)]
        values = [f"{name}={text.strip(chr(34)).replace(' ', '')}" for name, text in zip(names, texts, strict=True)]
        return self._directory / "runs" / (f"specimen_{number + 1}" if len(self._cases) > 1 else "") / folder_name(values)

    def _run(self, number: int, texts: tuple[str, ...]) -> Ran | Ending:
        case, folder, settings = self._cases[number], self._folder(number, texts), self._settings(number, texts)
        if is_finished(folder, case.text, settings):
            return Ran(folder, *status_of(folder))
        ending = None
        if can_go_on(folder, case.text, settings):
            ending = self._program.run(["resume", str(folder), "--quiet", *self._words])
        if ending is None or ending.code == WRONG_INPUT:
            given = [word for setting in settings for word in ("--set", setting)]
            ending = self._program.run(["run", str(case.path), "--quiet", *given, "--output", str(folder), *self._words,
                                        *self._overwrite])  # fmt: skip
        if ending.code == WRONG_INPUT:
            if "--overwrite" in ending.message:  # the folder is another case's, whatever the values
                raise WrongInput(ending.message.removeprefix("peristat: "))
            return Ran(folder, REFUSED, ending.message.removeprefix("peristat: "))
        if ending.code not in (DONE, NOT_CONVERGED):
            return ending
        record_finished(folder, case.text, settings)
        status, reason = status_of(folder)
        if status != "completed":
            self._tell(f"{folder.name}: did not converge ({reason}); its steps count as far as they go")
        return Ran(folder, status, reason)

    def _memory(self, number: int) -> tuple[float, float] | None:
        """Estimated once for each specimen: the values of materials do not change it."""
        if number not in self._memory_of:
            told = self._program.run(["check", str(self._cases[number].path)], told=True).output
            self._memory_of[number] = estimated_memory(told)
        return self._memory_of[number]

    def _tell_waiting(self, number: int) -> None:
        self._tell("another fit is running the next values; waiting for its end")
