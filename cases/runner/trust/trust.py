"""Compares one setting with references that it was not fitted to; the table says what agrees and what does not

(docs/trustworthy-peaks.md).
The environment variable PERISTAT_PROGRAM, which the launcher sets, names the program to run.
"""

import argparse
import os
import sys
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "sweep"))

import attracted_crack
import brazilian_disk
import centre_crack
import compact_tension
import concrete_beams
import double_cantilever
import double_edge_notch
import edge_cracks
import inclined_notch
import kink
import l_panel
import notched_beam
import phase_field
import phase_field_table
import size_effect
import strength
import surfing
import trapping
from entries_picture import draw
from given import GLASS, WrongSetting, poisson_ratio, read_settings
from jobs import bounded
from own_files import PICTURE, ForeignFile, require_own, write_own
from program import Program
from run_all import Failed, Ran, Runs
from specimen import Lattice, Specimen
from strip import Strip
from verdict import CALIBRATION, HEADING, Verdict, extension_of, row

MODULES = (surfing, notched_beam, compact_tension, centre_crack, double_cantilever, brazilian_disk, size_effect, l_panel,
           concrete_beams, double_edge_notch, inclined_notch, attracted_crack, strength, edge_cracks, phase_field)  # fmt: skip
ENTRIES: dict[str, Specimen] = {s.name: s for module in MODULES for s in module.SPECIMENS}
STUDIES = {"trapping": trapping, "kink": kink, "phase_fields": phase_field_table}  # with tables of their own
VARY = ("trapping", "kink")  # settings themselves
STEADY = "surfing"
TABLE = HEADING[0].encode()  # the signature of the table
PASSED, RED, WRONG_INPUT, MACHINE_FAILED, INTERRUPTED = 0, 3, 2, 5, 130


def verdicts(specimens: list[Specimen], runs: Runs, quick: bool, tell: Callable[[str], None]) -> list[Verdict]:
    """One verdict per specimen and quantity; an interrupted one has no values."""
    places = {f"{specimen.name}/{lattice.name}": (specimen, lattice) for specimen in specimens for lattice in specimen.lattices(quick)}
    found = {specimen.name: [Verdict(specimen, measure, {}, {}, 0.0, {}) for measure in specimen.measures] for specimen in specimens}
    # Judged after all runs, because some quantities need several sizes.
    for ran in list(runs.run({name: specimen.text(lattice) for name, (specimen, lattice) in places.items()})):
        specimen, lattice = places[ran.name]
        for verdict in found[specimen.name]:
            take(verdict, lattice, ran, tell)
    return [verdict for of_specimen in found.values() for verdict in of_specimen]


def take(verdict: Verdict, lattice: Lattice, ran: Ran, tell: Callable[[str], None]) -> None:
    name = f"{ran.name}, {verdict.measure.quantity}"
    try:
        verdict.values[lattice] = ran.value(verdict.measure.value)
        verdict.seconds += ran.seconds
        tell(f"{name}: {verdict.values[lattice]:.4f} of the reference")
    except Failed as failure:
        # Runs on the finest lattices end behind the peak, so quantities judged on coarser lattices do not need them.
        if lattice.refinement >= verdict.measure.at:
            verdict.failures[lattice] = str(failure)
            tell(f"{name}: {failure}")


def extend_cracks(found: list[Verdict]) -> None:
    """Sets kappa of every verdict from the setting's notched beam, if that beam and the strip were run."""
    first = {}
    for verdict in found:
        first.setdefault(verdict.specimen.name, verdict)
    beam, strip = first.get(CALIBRATION), first.get(STEADY)
    if beam is None or strip is None or strip.raw is None:
        return
    steady = lambda lattice: strip.values.get(lattice, strip.raw)
    kappa = {lattice: extension_of(beam, lattice, steady(lattice)) for lattice in beam.values}
    for verdict in found:
        verdict.extension = kappa


def table(found: list[Verdict], given: dict[str, str]) -> str:
    seconds: dict[str, float] = {}
    for verdict in found:  # some quantities do not use all runs
        seconds[verdict.specimen.name] = max(verdict.seconds, seconds.get(verdict.specimen.name, 0.0))
    cost = ", ".join(f"{name} {second:.0f} s" for name, second in seconds.items())
    other = "".join(f"\n\nWith {key} = {value}." for key, value in given.items())
    return "\n".join([*HEADING, *map(row, found)]) + f"{other}\n\nSeconds of the runs: {cost}.\n"


def _positive(text: str) -> int:
    number = int(text)
    if number < 1:
        raise ValueError(text)
    return number


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="peristat trust", allow_abbrev=False,
        description="Runs one setting on specimens with known answers and writes a table of which agree (DIR/table.md). "
        "Finished runs are skipped, interrupted ones resumed.",
        epilog=f"Entries: {', '.join(ENTRIES)}. Exit codes: 0 all pass, 3 some are red, 2 wrong input, 5 the machine failed, 130 interrupted.",
    )  # fmt: skip
    parser.add_argument("names", metavar="NAME", nargs="*", help="entries (default: all); trapping: how strongly "
                        "lattices trap cracks, by law, horizon ratio and angle; kink: where cracks turn under mixed mode, by "
                        "T-stress and points; phase_fields: peaks, cracks and costs beside phase fields")  # fmt: skip
    parser.add_argument("--set", metavar="KEY=VALUE", action="append", default=[], dest="given",
                        help="another value of a key of the setting, in every run; models with a free Poisson's ratio have "
                        f"that of glass, {GLASS}, unless material.poisson_ratio is set. Entries whose keys the model does not "
                        "take are red, with the program's message")  # fmt: skip
    parser.add_argument("--quick", action="store_true", help="run only the coarsest lattice of each entry")
    parser.add_argument("--output", metavar="DIR", type=Path, default=Path("results/trust"), help="default: results/trust")
    parser.add_argument("--jobs", metavar="N", type=_positive, help="number of parallel runs (default: one per processor)")
    parser.add_argument("--threads", metavar="N", type=_positive, help="threads of each run (default: 1)")
    return parser


def main(words: list[str]) -> int:
    asked = _parser().parse_args(words)
    try:
        return run(asked)
    except (ForeignFile, WrongSetting) as error:
        print(f"peristat trust: {error}", file=sys.stderr)
        return WRONG_INPUT
    except OSError as error:
        print(f"peristat trust: {error}", file=sys.stderr)
        return MACHINE_FAILED


def run(asked: argparse.Namespace) -> int:
    unknown = [name for name in asked.names if name not in ENTRIES | STUDIES]
    if unknown:
        print(f"peristat trust: no entry {unknown[0]}; there are {', '.join([*ENTRIES, *STUDIES])}", file=sys.stderr)
        return WRONG_INPUT
    given = read_settings(asked.given)
    studies = [name for name in STUDIES if name in asked.names]
    varied = [name for name in studies if name in VARY]
    if given and varied:
        raise WrongSetting(f"{varied[0]} takes no --set: its settings are what it varies")
    entries = ENTRIES | {STEADY: surfing.specimen(Strip(given_ratio=poisson_ratio(given)))}
    program = os.environ.get("PERISTAT_PROGRAM")
    if not program:
        print("peristat trust: PERISTAT_PROGRAM must name the program; use ./peristat trust", file=sys.stderr)
        return WRONG_INPUT
    tell = lambda text: print(text, flush=True)
    cores = len(os.sched_getaffinity(0))
    jobs, threads = bounded(asked.jobs or cores, asked.threads or 1, cores)
    for name, sign in ({"table.md": TABLE, "entries.svg": PICTURE} | trapping.FILES | kink.FILES | phase_field_table.FILES).items():
        require_own(asked.output / name, sign)
    asked.output.mkdir(parents=True, exist_ok=True)
    runs = Runs(Program(program), asked.output, jobs, threads, tell, given)
    passed = [STUDIES[name].measure(runs, asked.output, asked.quick, tell) for name in studies]
    names = [name for name in asked.names if name not in STUDIES] or ([] if asked.names else list(ENTRIES))
    found = verdicts([entries[name] for name in names], runs, asked.quick, tell)
    if runs.interrupted:
        return INTERRUPTED
    if not found:
        return PASSED if all(passed) else RED
    extend_cracks(found)
    text = table(found, given)
    write_own(asked.output / "table.md", text.encode(), TABLE)
    if not asked.quick:
        draw(found, asked.output / "entries.svg")
    tell("\n" + text)
    return PASSED if all([*passed, *(verdict.passes for verdict in found)]) else RED


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
