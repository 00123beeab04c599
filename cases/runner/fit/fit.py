"""Fits keys of cases to measured curves by least squares (docs/fit.md).

The program to run is named by the environment variable PERISTAT_PROGRAM, which the launcher sets.
"""

import argparse
import contextlib
import json
import os
import sys
import tomllib
import traceback
from collections.abc import Sequence
from pathlib import Path

# The package peristat, in the sources or in an installation; and what is common with sweeps.
places = (folder / name for folder in Path(__file__).resolve().parents for name in ("python", "lib/python3/dist-packages"))
sys.path[1:1] = [str(place) for place in places if (place / "peristat").is_dir()]
sys.path.insert(1, str(Path(__file__).resolve().parents[1] / "sweep"))

from computed import Keys, compute, split_computed
from jobs import bounded
from own_files import PICTURE, ForeignFile, picture, require_own, write_own
from peristat.errors import InputError
from peristat.fitting.comparison import WAYS, Comparison
from peristat.fitting.curves import Columns, read_measured, require_one_system
from peristat.fitting.outcome import CURVES, SIGN, NoCurve, Outcome, curves_table, document, fit_problem, table
from peristat.fitting.parameters import Parameter, parameter
from peristat.fitting.problem import Problem, Specimen
from program import Program
from program_runs import Case, Ended, ProgramRuns
from variations import WrongInput

DONE, BUG, WRONG_INPUT, NOT_CONVERGED, MACHINE_FAILED, INTERRUPTED = 0, 1, 2, 3, 5, 130
FILES = {"fit.json": SIGN.encode(), "curves.csv": CURVES.encode(), "fit.png": PICTURE, "fit.svg": PICTURE}  # and signatures


def say(text: str) -> None:
    """Prints a message; if nobody reads it any more, the fit continues silently."""
    try:
        print(text, flush=True)
    except OSError:
        sys.stdout = open(os.devnull, "w")


# ----------------------------------------------------------------------------------------- reading


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="peristat fit", allow_abbrev=False,
        description="Fits keys of a case to a measured curve by least squares: values, standard deviations and correlations "
        "(DIR/fit.json), measured and fitted points (DIR/curves.csv) and a picture (DIR/fit.png, DIR/fit.svg). "
        "Finished runs in DIR are used again, so that an interrupted fit goes on.",
        epilog="Exit codes: 0 a minimum was found and determines every value, 2 wrong input, 3 no minimum, a run with the fitted "
        "values that did not converge, or a value that the data do not determine, 4 a run was out of memory, 5 the "
        "machine failed, 130 interrupted, 1 a bug.",
    )  # fmt: skip
    add = parser.add_argument
    add("case", metavar="CASE", nargs="?", help="case file of the specimen")
    add("--data", metavar="FILE", help="its measured curve: a table with x and y in the first two columns")
    add("--specimen", metavar="CASE=FILE", action="append", default=[], help="a further specimen with the same values, and its "
        "measured curve; may be repeated")  # fmt: skip
    add("--over", metavar="KEY,KEY,...", required=True, help="keys whose values are fitted")
    add("--start", metavar="KEY=VALUE", action="append", default=[], help="starting value, in the unit of the case (default: the "
        "value of the case)")  # fmt: skip
    add("--bounds", metavar="KEY=LOW:HIGH", action="append", default=[], help="bounds of a value; either may be left out")
    add("--x", metavar="COLUMN", default="", help="column of history.csv (docs/results.md) for the first column of the data, with a "
        "sign, a factor, or as a sum: 'right - left' (default: displacement of what the case drives, or its control)")  # fmt: skip
    add("--y", metavar="COLUMN", default="", help="likewise for the second column (default: the force there)")
    add("--columns", metavar="X,Y[,SIGMA]", help="names of the columns of the data; the third has standard deviations of y")
    add("--units", metavar="X,Y", default=",", help="units of the data, such as mm,kN (default: SI units)")
    add("--compare", choices=WAYS, default="auto", help="x: y at the measured x; path: distances to the curve, for snap-backs "
        "(default: x if the measured x grows, otherwise path)")  # fmt: skip
    add("--starts", metavar="N", type=int, default=1, help="number of starts, the others spread around the first (default: 1)")
    add("--seed", metavar="N", type=int, default=1, help="of the other starts (default: 1)")
    add("--difference", metavar="D", type=float, default=0.02, help="relative difference of values that gives derivatives (default: "
        "0.02)")  # fmt: skip
    add("--steps", metavar="N", type=int, default=30, help="most steps of each search (default: 30)")
    add("--set", metavar="KEY=VALUE", action="append", default=[], dest="settings", help="override a key of all cases, also by "
        "KEY:=EXPRESSION of other keys, as in sweep")  # fmt: skip
    add("--output", metavar="DIR", type=Path, help="folder of the fit (default: results/FOLDER_STEM_fit)")
    add("--overwrite", action="store_true", help="replace results of another case in DIR")
    add("--threads", metavar="N", type=int, help="threads of each run (default: all processors, divided among the jobs)")
    add("--jobs", metavar="N", type=int, default=1, help="number of parallel runs (default: 1)")
    return parser


def _pairs(asked: argparse.Namespace) -> list[tuple[Path, Path]]:
    """Case and data of each specimen."""
    if (asked.case is None) != (asked.data is None):
        raise WrongInput("CASE and --data belong together; further specimens are given by --specimen CASE=FILE")
    found = [(Path(asked.case), Path(asked.data))] if asked.case else []
    for text in asked.specimen:
        case, equals, data = text.partition("=")
        if not (case and equals and data):
            raise WrongInput(f"--specimen {text}: needs the form CASE=FILE")
        found.append((Path(case), Path(data)))
    if not found:
        raise WrongInput("there is nothing to fit to: give CASE --data FILE, or --specimen CASE=FILE")
    return found


def _values(option: str, texts: list[str], keys: list[str]) -> dict[str, str]:
    found: dict[str, str] = {}
    for text in texts:
        key, equals, value = (part.strip() for part in text.partition("="))
        if not equals or not value:
            raise WrongInput(f"{option} {text}: needs the form KEY=" + ("VALUE" if option == "--start" else "LOW:HIGH"))
        if key not in keys:
            raise WrongInput(f"{option} {text}: {key} is not fitted; --over has {', '.join(keys)}")
        if key in found:
            raise WrongInput(f"{option} {text}: {key} is given twice")
        found[key] = value
    return found


def _bounds(key: str, text: str | None) -> tuple[str | None, str | None] | None:
    if text is None:
        return None
    low, colon, high = text.partition(":")
    if not colon or not (low.strip() or high.strip()):
        raise WrongInput(f"--bounds {key}={text}: needs the form KEY=LOW:HIGH")
    return low.strip() or None, high.strip() or None


def _parameters(asked: argparse.Namespace, case: Case) -> list[Parameter]:
    keys = [key.strip() for key in asked.over.split(",")]
    if "" in keys or len(set(keys)) != len(keys):
        raise WrongInput(f"--over {asked.over}: needs different keys with commas between them")
    for setting in asked.settings:
        if setting.partition("=")[0].rstrip(": ") in keys:
            raise WrongInput(f"--set {setting}: the key is fitted; give its starting value by --start")
    if "output.directory" in keys:
        raise WrongInput("output.directory: the runs have folders of their own, below --output")
    values = Keys(case.text, [setting for setting in asked.settings if not split_computed(setting)])
    if values.fault:
        raise WrongInput(f"{case.path}: {values.fault}")
    starts, bounds = _values("--start", asked.start, keys), _values("--bounds", asked.bounds, keys)
    return [parameter(key, values.given(key), starts.get(key), _bounds(key, bounds.get(key))) for key in keys]


def _case(path: Path) -> Case:
    try:
        return Case(path, path.read_bytes())
    except OSError as error:
        raise WrongInput(f"{path}: can't be read ({error.strerror})") from None


def _settings_of(asked: argparse.Namespace, parameters: list[Parameter], case: Case, texts: Sequence[str]) -> list[str]:
    """All settings of a run."""
    found = [setting for setting in asked.settings if not split_computed(setting)]
    found += [f"{each.key}={text}" for each, text in zip(parameters, texts, strict=True)]
    for setting in asked.settings:
        if computed := split_computed(setting):
            try:
                found.append(f"{computed[0]}={compute(computed[1], Keys(case.text, found))}")
            except WrongInput as error:
                raise WrongInput(f"--set {setting}: {error}") from None
    return found


def read(asked: argparse.Namespace, program: Program) -> tuple[Problem, Path, str]:
    pairs = _pairs(asked)
    cases = [_case(path) for path, _ in pairs]
    require_one_system([Keys(case.text, []).given("units") for case in cases])
    parameters = _parameters(asked, cases[0])
    columns = None if asked.columns is None else [name.strip() for name in asked.columns.split(",")]
    if columns is not None and len(columns) not in (2, 3):
        raise WrongInput(f"--columns {asked.columns}: needs two names or three")
    units = tuple(unit.strip() for unit in asked.units.split(","))
    if len(units) != 2:
        raise WrongInput(f"--units {asked.units}: needs the units of x and y with a comma between them, such as mm,kN")
    specimens = []
    for _, path in pairs:
        data = read_measured(path, columns, units)
        specimens.append(Specimen(data.name, data, Comparison(data, asked.compare), Columns(asked.x, asked.y)))
    _require_numbers(asked)
    directory = asked.output or _default_directory(pairs[0][0])
    if directory.exists() and not directory.is_dir():
        raise WrongInput(f"--output {directory}: is not a folder")
    for name, sign in FILES.items():
        require_own(directory / name, sign)
    cores = len(os.sched_getaffinity(0))
    jobs, threads = bounded(asked.jobs, asked.threads, cores)
    settings = lambda number, texts: _settings_of(asked, parameters, cases[number], texts)
    runs = ProgramRuns(program, cases, parameters, settings, directory, jobs, threads, asked.overwrite, say)
    title = "Fit"
    with contextlib.suppress(ValueError):
        title = f"Fit of {tomllib.loads(cases[0].text.decode()).get('title') or pairs[0][0].stem}"
    return Problem(specimens, parameters, runs, asked.difference, say), directory, title


def _require_numbers(asked: argparse.Namespace) -> None:
    for option, value, low, high in (("--starts", asked.starts, 1, 1000), ("--steps", asked.steps, 1, 1000), ("--jobs", asked.jobs, 1, 1024),
                                     ("--difference", asked.difference, 1e-4, 0.3), ("--seed", asked.seed, 0, 2**31)):  # fmt: skip
        if not low <= value <= high:
            raise WrongInput(f"{option} {value}: must be from {low} to {high}")


def _default_directory(case: Path) -> Path:
    absolute = Path(os.path.abspath(case))
    return Path("results") / "_".join(filter(None, [absolute.parent.name, absolute.stem, "fit"]))


# ----------------------------------------------------------------------------------------- writing


def write(outcome: Outcome, directory: Path, title: str) -> int:
    directory.mkdir(parents=True, exist_ok=True)
    write_own(directory / "fit.json", (json.dumps(document(outcome), indent=2, ensure_ascii=False) + "\n").encode(), FILES["fit.json"])
    write_own(directory / "curves.csv", curves_table(outcome).encode(), FILES["curves.csv"])
    say("\n" + table(outcome) + "\n")
    for message in outcome.messages:
        say(f"note: {message}")
    settings = [f"{each.parameter.key}={text}" for each, text in zip(outcome.statistics.estimates, outcome.best.point.texts, strict=True)]
    say("settings: " + " ".join(f"--set '{setting}'" for setting in settings))
    say(f"fit: {directory / 'fit.json'}\nfit: {directory / 'curves.csv'}")
    code = _draw(outcome, directory, title)
    return code if code != DONE else DONE if outcome.is_converged else NOT_CONVERGED


def _draw(outcome: Outcome, directory: Path, title: str) -> int:
    try:
        from peristat.fitting.picture import draw_fit

        figure = draw_fit(outcome, title)
        for ending in ("png", "svg"):
            write_own(directory / f"fit.{ending}", picture(figure, ending), PICTURE)
            say(f"fit: {directory / f'fit.{ending}'}")
    except (OSError, MemoryError, ImportError) as error:
        print(f"fit: the picture could not be drawn ({error}); the numbers are complete", file=sys.stderr)
        return MACHINE_FAILED
    except Exception:
        traceback.print_exc()
        print("fit: the picture could not be drawn, by a fault of the program that is worth a report", file=sys.stderr)
        return BUG
    return DONE


def _with_signs(words: list[str]) -> list[str]:
    """Joins --x and --y with a column that has a sign, which argparse would take for an option."""
    joined: list[str] = []
    for word in words:
        if joined and joined[-1] in ("--x", "--y") and word.startswith("-") and not word.startswith("--"):
            joined[-1] += f"={word}"
        else:
            joined.append(word)
    return joined


def main(words: list[str]) -> int:
    sys.stdout.reconfigure(errors="backslashreplace")
    asked = _parser().parse_args(_with_signs(words))
    program = os.environ.get("PERISTAT_PROGRAM")
    if not program:
        print("peristat fit: PERISTAT_PROGRAM must name the program; use ./peristat fit", file=sys.stderr)
        return WRONG_INPUT
    try:
        import scipy  # noqa: F401
    except ImportError:
        print("peristat fit: needs SciPy: install the package python3-scipy", file=sys.stderr)
        return WRONG_INPUT
    try:
        problem, directory, title = read(asked, Program(program))
        return write(fit_problem(problem, asked.starts, asked.seed, asked.steps), directory, title)
    except (WrongInput, ForeignFile, InputError) as error:
        print(f"peristat fit: {error}", file=sys.stderr)
        return WRONG_INPUT
    except NoCurve as error:
        print(f"peristat fit: {error}", file=sys.stderr)
        return NOT_CONVERGED
    except Ended as end:
        print(f"peristat fit: {end}", file=sys.stderr)
        return end.code
    except OSError as error:
        print(f"peristat fit: {error}", file=sys.stderr)
        return MACHINE_FAILED


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
