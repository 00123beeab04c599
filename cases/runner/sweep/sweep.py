"""Runs a case for every combination of given values: one table and one picture (docs/sweep.md).

The program to run is named by the environment variable PERISTAT_PROGRAM, which the launcher sets.
"""

import argparse
import contextlib
import errno
import json
import math
import os
import sys
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

# The package peristat, in the sources or in an installation.
places = (folder / name for folder in Path(__file__).resolve().parents for name in ("python", "lib/python3/dist-packages"))
sys.path[1:1] = [str(place) for place in places if (place / "peristat").is_dir()]

from computed import Keys, compute, split_computed
from ensemble import SIGN as ENSEMBLE
from ensemble import Sample, sample, seeds, size_effect, write_ensemble
from jobs import FolderLock, Jobs, bounded, estimated_memory
from own_files import PICTURE, TABLE, ForeignFile, picture, remove_own, require_own, write_own
from program import Ending, Program
from record import can_go_on, is_done, record_done
from refinement import SIGN, Refinement, refine, write_refinements
from table import figures, quantities, write_table
from variations import Axis, WrongInput, check_keys, combinations, folder_name, vary, vary_with

DONE, BUG, WRONG_INPUT, NOT_CONVERGED, OUT_OF_MEMORY, MACHINE_FAILED, INTERRUPTED = 0, 1, 2, 3, 4, 5, 130
STATUS = {DONE: "completed", NOT_CONVERGED: "not_converged", OUT_OF_MEMORY: "out_of_memory",
          INTERRUPTED: "interrupted"}  # fmt: skip
WORDS = {NOT_CONVERGED: "did not converge", OUT_OF_MEMORY: "out of memory", INTERRUPTED: "interrupted",
         WRONG_INPUT: "refused", MACHINE_FAILED: "the machine failed"}  # fmt: skip
MADE_OF_THE_TABLE = {"sweep.png": PICTURE, "refinement.csv": SIGN, "refinement.png": PICTURE, "ensemble.csv": ENSEMBLE,
                     "ensemble.png": PICTURE}  # and signatures
REFINED = "lattice.spacing"
REGIONS = "lattice.refine"  # whose spacings are refined with it
# Errors of writing: the disk is full or failing, or a limit of the shell is reached.
FAULTS = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EMFILE, errno.ENFILE, errno.EIO, errno.ENOMEM}


@dataclass
class Combination:
    """One run of the sweep."""

    values: tuple[str, ...]  # of the varied keys
    settings: list[str]  # all "key=value" settings of the run
    folder: Path


@dataclass
class Sweep:
    case: Path
    case_text: bytes
    keys: list[str]  # varied keys
    combinations: list[Combination]
    directory: Path
    threads: int | None
    overwrite: bool  # replaces runs of another case in the folders, too
    jobs: int = 1  # runs at once
    refined: int | None = None  # number of the key that --refine varies
    length_unit: float = 1.0  # of the spacings that --refine varies [m]
    linked: frozenset[int] = frozenset()  # numbers of that key, of the keys that vary with it, and of computed ones
    seeds: frozenset[int] = frozenset()  # numbers of the keys that --seeds varies
    per: str = ""  # expression by which peaks of an ensemble are divided


# ----------------------------------------------------------------------------------------- running


def run_all(sweep: Sweep, program: Program) -> int:
    """Runs all combinations that are not done yet; returns the exit code of the sweep."""
    all_runs = AllRuns(sweep, program)
    code = all_runs.run()
    if code is not None:
        with contextlib.suppress(OSError):  # leaves nothing behind if the first run was refused
            sweep.directory.rmdir()
        return code
    _save(sweep, all_runs.rows)
    rows = [all_runs.rows[number] for number in range(len(sweep.combinations))]
    say(f"sweep: {sweep.directory / 'sweep.csv'}")
    if sweep.refined is not None:
        all_runs.codes.add(_tell_refinements(sweep, rows))
    if sweep.seeds:
        all_runs.codes.add(_tell_ensemble(sweep, rows))
    all_runs.codes.add(_draw(sweep.directory / "sweep.png", lambda: _sweep_figure(sweep, [row["status"] for row in rows])))
    return _worst(all_runs.codes)


@dataclass
class Ran:
    """How a run ended."""

    ending: Ending
    is_new: bool  # false: the folder's results are from an earlier run
    is_recorded: bool  # as done, if it is done


class AllRuns:
    """The runs of a sweep, in parallel or one after the other, and their results."""

    def __init__(self, sweep: Sweep, program: Program):
        self.sweep, self.program = sweep, program
        self.rows = {number: _row(sweep, combination, DONE, True)
                     for number, combination in enumerate(sweep.combinations) if self._is_done(number)}  # fmt: skip
        self.done_before = frozenset(self.rows)
        self.codes: set[int] = set()

    def run(self) -> int | None:
        """@return the exit code of a sweep that ends before all combinations have been run"""
        jobs = Jobs(self.sweep.jobs, self._memory, lambda number: FolderLock(self.sweep.combinations[number].folder))
        ends = None
        goes_on = lambda: ends is None and not self.program.interrupted
        numbers = range(len(self.sweep.combinations))
        for number, ran in jobs.run(numbers, self._run, goes_on, self._tell_waiting):
            stops = self._take(number, ran)
            ends = stops if ends is None else ends
        return INTERRUPTED if ends is None and self.program.interrupted else ends

    def _run(self, number: int) -> Ran | None:
        """None if it is done, before or by another sweep meanwhile."""
        combination = self.sweep.combinations[number]
        if number in self.done_before or self._is_done(number):
            return None
        if self.sweep.jobs == 1:
            say(f"{self._label(number)}: ", end="")
        before = _stamp(combination.folder)
        ending = None
        if can_go_on(combination.folder, self.sweep.case_text, combination.settings):
            ending = self.program.run(["resume", str(combination.folder), "--quiet", *_threads(self.sweep)])
        if ending is None or ending.code == WRONG_INPUT:
            ending = self.program.run(_arguments(self.sweep, combination))
        is_recorded = ending.code != DONE or record_done(combination.folder, combination.settings)
        return Ran(ending, _stamp(combination.folder) != before, is_recorded)

    def _take(self, number: int, ran: Ran | None) -> int | None:
        """@return the exit code of the sweep if it ends with this run"""
        combination = self.sweep.combinations[number]
        if ran is None:
            say(f"{self._label(number)}: skipped (done {'before' if number in self.done_before else 'by another sweep'})")
            self.rows[number] = _row(self.sweep, combination, DONE, True)
            return None
        label = "" if self.sweep.jobs == 1 else f"{self._label(number)}: "
        ending = ran.ending
        say(label + _told(ending, combination.folder if ran.is_new else None))
        if ending.code == WRONG_INPUT:
            print(ending.message, file=sys.stderr)
            return WRONG_INPUT
        if not ran.is_recorded:
            print("  sweep.json could not be written: this combination will be run again", file=sys.stderr)
        self.rows[number] = _row(self.sweep, combination, ending.code, ran.is_new)
        _save(self.sweep, self.rows)
        if ending.code in (INTERRUPTED, MACHINE_FAILED):  # the next runs would fail, too
            return ending.code
        self.codes.add(ending.code)
        return None

    def _is_done(self, number: int) -> bool:
        combination = self.sweep.combinations[number]
        return is_done(combination.folder, self.sweep.case_text, combination.settings)

    def _memory(self, number: int) -> tuple[float, float] | None:
        if number in self.done_before:
            return 0.0, 1.0
        settings = self.sweep.combinations[number].settings
        words = [word for setting in settings for word in ("--set", setting)]
        return estimated_memory(self.program.run(["check", str(self.sweep.case), *words], told=True).output)

    def _label(self, number: int) -> str:
        combination = self.sweep.combinations[number]
        return f"{number + 1}/{len(self.sweep.combinations)} {_values(self.sweep, combination)}"

    def _tell_waiting(self, number: int) -> None:
        say(f"{self._label(number)}: another sweep is running it; waiting for its end")


def _arguments(sweep: Sweep, combination: Combination) -> list[str]:
    settings = [word for setting in combination.settings for word in ("--set", setting)]
    overwrite = ["--overwrite"] if sweep.overwrite else []
    return ["run", str(sweep.case), "--quiet", *settings, "--output", str(combination.folder), *_threads(sweep),
            *overwrite]  # fmt: skip


def _threads(sweep: Sweep) -> list[str]:
    return [] if sweep.threads is None else ["--threads", str(sweep.threads)]


def say(text: str, end: str = "\n") -> None:
    """Prints a message; if nobody reads it any more, the sweep continues silently."""
    try:
        print(text, end=end, flush=True)
    except OSError as error:
        sys.stdout = open(os.devnull, "w")
        print(f"sweep: standard output can't be written ({error.strerror}): the sweep continues without output", file=sys.stderr)


def _row(sweep: Sweep, combination: Combination, code: int, has_results: bool) -> dict:
    row = dict(zip(sweep.keys, combination.values))
    row |= {"status": STATUS.get(code, "failed"), "exit_code": code}
    return row | (figures(combination.folder) if has_results else {})


def _values(sweep: Sweep, combination: Combination) -> str:
    return ", ".join(f"{key}={value}" for key, value in zip(sweep.keys, combination.values))


def _stamp(folder: Path):
    """Distinguishes one summary of a folder from the next."""
    try:
        status = (folder / "summary.json").stat()
    except OSError:
        return None
    return status.st_ino, status.st_mtime_ns


def _told(ending: Ending, folder: Path | None) -> str:
    """How a run ended, in one line, followed by the warnings of a completed run."""
    if ending.code == DONE:
        return "\n  ".join(["done", *ending.message.splitlines()])
    words = WORDS.get(ending.code, "failed")
    if ending.code in (WRONG_INPUT, INTERRUPTED):
        return f"exit code {ending.code}: {words}"
    reason = _reason(folder) or ending.message.partition("\n")[0].removeprefix("peristat: ")
    return f"exit code {ending.code}: {words}" + (f" ({reason})" if reason else "")


def _reason(folder: Path | None) -> str:
    try:
        return json.loads((folder / "summary.json").read_bytes())["reason"] if folder else ""
    except (OSError, ValueError, KeyError):
        return ""


def _worst(codes: set[int]) -> int:
    if codes - {DONE, NOT_CONVERGED, OUT_OF_MEMORY, MACHINE_FAILED}:
        return BUG
    return next((code for code in (MACHINE_FAILED, NOT_CONVERGED, OUT_OF_MEMORY) if code in codes), DONE)


def _save(sweep: Sweep, rows: dict[int, dict]) -> None:
    """Writes the table of completed runs; files made from an earlier table are removed."""
    sweep.directory.mkdir(parents=True, exist_ok=True)  # missing if no run had enough memory
    write_table(sweep.directory / "sweep.csv", sweep.keys, [rows[number] for number in sorted(rows)])
    for name, sign in MADE_OF_THE_TABLE.items():
        remove_own(sweep.directory / name, sign)


def _refinements(sweep: Sweep, rows: list[dict]) -> list[tuple[tuple[str, ...], Refinement]]:
    """Refinement of every quantity, for each combination of the other keys whose lattices have all been run."""
    groups: dict[tuple[str, ...], list[dict]] = {}
    for combination, row in zip(sweep.combinations, rows):
        others = tuple(value for place, value in enumerate(combination.values) if place not in sweep.linked)
        groups.setdefault(others, []).append(row)
    found = []
    for others, lattices in groups.items():
        if any(row["status"] != "completed" for row in lattices):
            told = f" of {', '.join(others)}" if others else ""
            say(f"sweep: nothing is extrapolated{told}: a lattice has no completed run")
            continue
        spacings = [_spacing(row[sweep.keys[sweep.refined]]) * sweep.length_unit for row in lattices]
        found += [(others, refine(name, spacings, values)) for name, values in quantities(lattices).items()]
    return found


def _tell_refinements(sweep: Sweep, rows: list[dict]) -> int:
    """@return as `_draw`"""
    found = _refinements(sweep, rows)
    if not found:
        return DONE
    keys = [key for place, key in enumerate(sweep.keys) if place not in sweep.linked]
    write_refinements(sweep.directory / "refinement.csv", keys, found)
    for others, refinement in found:
        say("  " + ", ".join([*others, f"{refinement.quantity}: {refinement.told()}"]))
    say(f"sweep: {sweep.directory / 'refinement.csv'}")
    return _draw(sweep.directory / "refinement.png", lambda: _refinement_figure(sweep, found))


def _tell_ensemble(sweep: Sweep, rows: list[dict]) -> int:
    """@return as `_draw`"""
    peaks = {column: max(row.get(column) or 0.0 for row in rows) for row in rows for column in row if column.startswith("peak_reaction:")}
    if not peaks:
        say("sweep: no ensemble: no run has a reaction")
        return DONE
    column = next(column for column, peak in peaks.items() if peak >= (1 - 1e-6) * max(peaks.values()))
    own = [place for place in range(len(sweep.keys)) if place not in sweep.seeds]
    groups: dict[tuple[str, ...], list[int]] = {}
    for number, combination in enumerate(sweep.combinations):
        groups.setdefault(tuple(combination.values[place] for place in own), []).append(number)
    samples = []
    for values, numbers in groups.items():
        done = [number for number in numbers if rows[number]["status"] == "completed"]
        if len(done) < len(numbers):
            say(f"sweep: {', '.join(values)}: {len(numbers) - len(done)} of {len(numbers)} runs are left out: they did not complete")
        if done:
            folders = [sweep.combinations[number].folder for number in done]
            samples.append(sample(values, folders, column.partition(":")[2], _divisor(sweep, sweep.combinations[done[0]].settings)))
    quantity = f"{column} [N]" if not sweep.per else f"{column} / ({sweep.per})"
    return _write_ensemble(sweep, [sweep.keys[place] for place in own], quantity, samples) if samples else DONE


def _write_ensemble(sweep: Sweep, keys: list[str], quantity: str, samples: list[Sample]) -> int:
    write_ensemble(sweep.directory / "ensemble.csv", keys, quantity, samples)
    effect = size_effect(samples)
    for each in samples:
        say("  " + ", ".join([*each.values, f"{quantity}: {each.told()}"]))
    if effect:
        say(f"  {effect.told()}")
    say(f"sweep: {sweep.directory / 'ensemble.csv'}")
    return _draw(sweep.directory / "ensemble.png", lambda: _ensemble_figure(sweep, keys, quantity, samples, effect))


def _ensemble_figure(sweep: Sweep, keys: list[str], quantity: str, samples: list[Sample], effect):
    from ensemble_picture import draw_ensemble

    return draw_ensemble(f"Ensemble of {sweep.case.stem}", keys, quantity, samples, effect)


def _divisor(sweep: Sweep, settings: list[str]) -> float:
    if not sweep.per:
        return 1.0
    try:
        value = float(compute(sweep.per, Keys(sweep.case_text, settings)))
    except WrongInput as error:
        raise WrongInput(f"--per {sweep.per}: {error}") from None
    if value <= 0.0:
        raise WrongInput(f"--per {sweep.per}: is {value:g}; must be positive")
    return value


def _refinement_figure(sweep: Sweep, found: list[tuple[tuple[str, ...], Refinement]]):
    from refinement_picture import draw_refinements

    return draw_refinements(sweep.case, found)


def _sweep_figure(sweep: Sweep, statuses: list[str]):
    from sweep_picture import draw_sweep

    folders = [combination.folder for combination in sweep.combinations]
    values = [combination.values for combination in sweep.combinations]
    return draw_sweep(sweep.keys, values, folders, statuses)


def _draw(path: Path, make: Callable[[], object]) -> int:
    """Writes a picture. The table is complete even if this fails.

    @return DONE, MACHINE_FAILED if the picture can't be written, BUG if the drawing code has a fault
    """
    try:
        figure = make()
        if figure is None:
            say(f"sweep: no {path.name}: no combination has an accepted step")
            return DONE
        write_own(path, picture(figure, "png", pil_kwargs={"compress_level": 4}), PICTURE)
    except (OSError, MemoryError, ImportError) as error:
        print(f"sweep: {path} could not be drawn ({error}); the table is complete", file=sys.stderr)
        return MACHINE_FAILED
    except Exception:
        traceback.print_exc()
        print(f"sweep: {path} could not be drawn, by a fault of the program that is worth a report; the table is complete",
              file=sys.stderr)  # fmt: skip
        return BUG
    say(f"sweep: {path}")
    return DONE


# ------------------------------------------------------------------------------------ command line


class _Varied(argparse.Action):
    """Keeps --vary, --with and --refine in the given order."""

    def __call__(self, parser, namespace, values, option_string=None):
        namespace.varied = [*(getattr(namespace, "varied", None) or []), (self.option_strings[0], values)]


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="peristat sweep", allow_abbrev=False,
        description="Runs a case for every combination of the given values, and collects the results in one table "
        "(DIR/sweep.csv) and one picture (DIR/sweep.png). Finished combinations are skipped, interrupted ones resumed.",
        epilog="Exit codes: 0 all completed, 2 wrong input, 3 a combination did not converge, 4 one was "
        "out of memory, 5 the machine failed (disk full, a limit of the shell), 130 interrupted, 1 a bug.",
    )  # fmt: skip
    parser.add_argument("case", metavar="CASE", help="case file (docs/case-file.md)")
    parser.add_argument("--vary", metavar="KEY=V1,V2,...", action=_Varied,
                        help="values of a key of the case file, such as loading.steps=10,20; may be repeated. "
                        "Commas within brackets and quotes do not separate values")  # fmt: skip
    parser.add_argument("--with", metavar="KEY=V1,V2,...", action=_Varied,
                        help="values of another key that varies together with the --vary or --refine before it, one for "
                        "each of its values; or KEY:=EXPRESSION of other keys, such as "
                        "loading.steps:=round(0.02/lattice.spacing)")  # fmt: skip
    parser.add_argument("--refine", metavar="N", action=_Varied,
                        help=f"refine {REFINED} of the case, or of --set, on N lattices, and report observed orders, "
                        "extrapolated values and grid convergence indices of all quantities")  # fmt: skip
    parser.add_argument("--seeds", metavar="N", help="an ensemble: N seeds of all random fields ([[material.scatter]]); reports the "
                        "distribution of the peaks, with their Weibull modulus, and the size effect if a --vary changes the "
                        "volume")  # fmt: skip
    parser.add_argument("--per", metavar="EXPRESSION", default="", help="divides the peaks of --seeds, such as by an area of keys in "
                        "plain numbers")  # fmt: skip
    parser.add_argument("--ratio", metavar="R", type=float, default=2.0, help="ratio of the spacings of --refine (default: 2)")
    parser.add_argument("--set", metavar="KEY=VALUE", action="append", default=[], dest="settings",
                        help="override a key of the case file in all runs, also by KEY:=EXPRESSION; may be "
                        "repeated")  # fmt: skip
    parser.add_argument("--output", metavar="DIR", type=Path,
                        help="folder of the sweep (default: results/FOLDER_STEM_sweep)")  # fmt: skip
    parser.add_argument("--overwrite", action="store_true", help="replace results of another case in DIR")
    parser.add_argument("--threads", metavar="N", type=int, help="number of threads of each run (default: all "
                        "processors, divided among the jobs)")  # fmt: skip
    parser.add_argument("--jobs", metavar="N", type=int, default=1, help="number of parallel runs, limited by "
                        "processors and memory (default: 1)")  # fmt: skip
    return parser


def _default_directory(case: Path) -> Path:
    """results/FOLDER_STEM_sweep, like the program's own results/FOLDER_STEM."""
    absolute = Path(os.path.abspath(case))
    return Path("results") / "_".join(filter(None, [absolute.parent.name, absolute.stem, "sweep"]))


def read_sweep(arguments: argparse.Namespace) -> Sweep:
    case = Path(arguments.case)
    try:
        text = case.read_bytes()
    except OSError as error:
        raise WrongInput(f"{case}: can't be read ({error.strerror})") from error
    directory = arguments.output or _default_directory(case)
    if directory.exists() and not directory.is_dir():
        raise WrongInput(f"--output {directory}: is not a folder")
    for name, sign in {"sweep.csv": TABLE, **MADE_OF_THE_TABLE}.items():
        require_own(directory / name, sign)
    if set('"\\') & set(str(directory)):
        raise WrongInput(f"--output {directory}: must not have quotes or backslashes")
    jobs, threads = _jobs(arguments)
    sweep = Sweep(case, text, [], [], directory, threads, arguments.overwrite, jobs)
    _find_combinations(sweep, arguments)
    return sweep


def _jobs(arguments: argparse.Namespace) -> tuple[int, int | None]:
    if not 1 <= arguments.jobs <= 1024:
        raise WrongInput(f"--jobs {arguments.jobs}: must be from 1 to 1024")
    jobs, threads = bounded(arguments.jobs, arguments.threads, len(os.sched_getaffinity(0)))
    if jobs < arguments.jobs:
        say(f"sweep: {jobs} at a time, not {arguments.jobs}: there are {len(os.sched_getaffinity(0))} processors")
    return jobs, threads


def _find_combinations(sweep: Sweep, arguments: argparse.Namespace) -> None:
    axes, computed = _read_axes(sweep, arguments)
    keys = [key for axis in axes for key in axis.keys]
    given = arguments.settings
    if arguments.per and not sweep.seeds:
        raise WrongInput(f"--per {arguments.per}: divides the peaks of an ensemble; give --seeds, too")
    if sweep.refined is not None:  # settings are the spacings of the coarsest lattice
        scaled = {key for axis in axes if REFINED in axis.keys for key in axis.keys}
        given = [setting for setting in given if setting.partition("=")[0].strip() not in scaled]
    set_as_given = [setting for setting in given if not split_computed(setting)]
    computed_by_set = [found for setting in given if (found := split_computed(setting))]
    sweep.keys = [*keys, *(key for key, _ in computed)]
    check_keys(sweep.keys, given)
    for values in combinations(axes):
        varied = [f"{key}={value}" for key, value in zip(keys, values)]
        settings = [*set_as_given, *varied]
        expressions = [*computed_by_set, *computed]
        for place, (key, expression) in enumerate(expressions):
            try:
                later = {key for key, _ in expressions[place:]}
                value = compute(expression, Keys(sweep.case_text, settings, later))
            except WrongInput as error:
                raise WrongInput(f"{key}:={expression}: {error}") from None
            settings.append(f"{key}={value}")
            if (key, expression) in computed:
                values = (*values, value)
        _divisor(sweep, settings)  # refuses a wrong one
        folder = sweep.directory / folder_name(varied)
        sweep.combinations.append(Combination(values, settings, folder))


def _read_axes(sweep: Sweep, arguments: argparse.Namespace) -> tuple[list[Axis], list[tuple[str, str]]]:
    """The variations, and keys with the expressions that they are computed from."""
    axes, computed, refined = [], [], None
    for option, text in getattr(arguments, "varied", None) or []:
        if option == "--refine":
            if refined is not None:
                raise WrongInput(f"--refine {text}: is given twice")
            keys = Keys(sweep.case_text, arguments.settings)
            axes.append(_lattices(text, arguments.ratio, keys))
            sweep.length_unit = keys.length_unit()
            refined = axes[-1]
        elif option == "--vary":
            axes.append(vary(text))
        elif found := split_computed(text):
            computed.append(found)
        else:
            vary_with(axes, text)
    if arguments.seeds is not None:
        if refined:
            raise WrongInput("--seeds and --refine can't be given together: vary lattice.spacing by --vary")
        axes.append(seeds(arguments.seeds, Keys(sweep.case_text, [text for text in arguments.settings if not split_computed(text)])))
        count = sum(len(axis.keys) for axis in axes)
        sweep.seeds, sweep.per = frozenset(range(count - len(axes[-1].keys), count)), arguments.per
    if not axes:
        raise WrongInput("nothing is varied: give --vary key=value1,value2,..., --refine N or --seeds N")
    if refined:
        count = sum(len(axis.keys) for axis in axes)
        sweep.refined = sum(len(axis.keys) for axis in axes[: axes.index(refined)])
        with_it = range(sweep.refined, sweep.refined + len(refined.keys))
        sweep.linked = frozenset([*with_it, *range(count, count + len(computed))])
    return axes, computed


def _lattices(text: str, ratio: float, keys: Keys) -> Axis:
    """Axis of --refine: spacings from that of the case on, and those of its regions of finer points."""
    if not text.isdecimal() or not 3 <= int(text) <= 20:
        raise WrongInput(f"--refine {text}: must be a number of lattices from 3 to 20: an order needs three")
    if not 1.05 <= ratio <= 10.0:
        raise WrongInput(f"--ratio {ratio}: must be from 1.05 to 10")
    try:
        varied = [REFINED, *(f"{REGIONS}[{k}].spacing" for k in range(keys.count(REGIONS)))]
        spacings = [keys.numbers(key) for key in varied]
    except WrongInput as error:
        raise WrongInput(f"--refine {text}: {error}") from None
    finer = lambda spacing, level: [length / ratio**level for length in spacing]
    told = lambda lengths: repr(lengths if len(lengths) > 1 else lengths[0])
    return Axis(varied, [[told(finer(spacing, level)) for level in range(int(text))] for spacing in spacings])


def _spacing(text: str) -> float:
    """The geometric mean of the given spacings, in which the horizon is measured."""
    lengths = [float(length) for length in text.strip("[] ").split(",")]
    return math.prod(lengths) ** (1 / len(lengths)) if len(lengths) > 1 else lengths[0]


def main(words: list[str]) -> int:
    sys.stdout.reconfigure(errors="backslashreplace")
    arguments = _parser().parse_args(words)
    program = os.environ.get("PERISTAT_PROGRAM")
    if not program:
        print("peristat sweep: PERISTAT_PROGRAM must name the program; use ./peristat sweep", file=sys.stderr)
        return WRONG_INPUT
    try:
        return run_all(read_sweep(arguments), Program(program))
    except (WrongInput, ForeignFile) as error:
        print(f"peristat sweep: {error}", file=sys.stderr)
    except OSError as error:
        print(f"peristat sweep: {error}", file=sys.stderr)
        return MACHINE_FAILED if error.errno in FAULTS else WRONG_INPUT
    return WRONG_INPUT


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
