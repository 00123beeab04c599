#!/usr/bin/env -S /usr/bin/python3 -BEs
"""Fuzzer: corrupted case files, overrides, point files and results folders through every command.

    /usr/bin/python3 -B tests/fuzz/fuzz.py --minutes 60 --seed 3     an hour with another seed
    /usr/bin/python3 -B tests/fuzz/fuzz.py --only 1234 --seed 3      one input again
    PERISTAT_PROGRAM=build/sanitize/peristat /usr/bin/python3 -B tests/fuzz/fuzz.py     under the sanitizers

The seed and the number of an input determine it, whatever ran before. A finding is: an exit
code other than 0, 2, 3, 4, 5, a signal, no end within the limits, a traceback, nan or inf in output
or results, or results of a completed run that can't be true. Every fifth input is one of tests/fuzz/properties.py:
answers that must agree with one another. Each finding is written below --keep with its
files, the output, and a command that repeats it.
"""

import argparse
import collections
import contextlib
import pathlib
import random
import re
import shlex
import shutil
import signal
import sys
import tempfile
import time
import tomllib

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2]))

from tests.fuzz import mutations, properties  # noqa: E402
from tests.reference import program  # noqa: E402
from tests.reference.case import NotUnderstood  # noqa: E402
from tests.reference.results import Results, not_finite  # noqa: E402
from tests.reference.verify import Verification  # noqa: E402

CORPUS = pathlib.Path(__file__).resolve().parent / "corpus"
CPU_SECONDS = 20  # check, calibrate and plot must end by themselves
RUN_SECONDS = 10  # a run may have more work than that: it is interrupted, and must end
STOP_SECONDS = 20
LARGEST_RUN = 3000  # points; bigger bodies are only checked
EXPECTED = (0, 2, 3, 4, 5)
NOT_A_NUMBER = re.compile(r"(?<![\w.\"'])[-+]?(nan|inf|infinity)(?![\w\"'])", re.IGNORECASE)


class Finding(Exception):
    """The fault of one input, and the command that showed it."""

    def __init__(self, text, run=None):
        super().__init__(text)
        self.run = run


class Input:
    """One fuzzed input: its files in a folder of its own, and the commands to try on them."""

    EVERY_FIFTH = 5  # every fifth input tests a property; the others do not depend on these

    def __init__(self, seed, number, folder):
        self.number = number
        self.random = random.Random(f"{seed}/{number}")
        self.folder = pathlib.Path(folder)
        self.texts = {path.name: path.read_text() for path in sorted(CORPUS.iterdir())}
        self.cases = [name for name in self.texts if name.endswith(".toml")]
        self.commands = []

    # ---- running ---------------------------------------------------------------------------------

    def execute(self, command, **limits):
        self.commands.append(command)
        run = program.execute(command, folder=self.folder, **limits)
        if run.code is None:
            raise Finding("no end within the limits", run)
        self.judge_end(run)
        return run

    def peristat(self, *arguments, **limits):
        return self.execute([program.PROGRAM, *arguments], seconds=6 * CPU_SECONDS, cpu_seconds=CPU_SECONDS, **limits)

    @staticmethod
    def finding(text, run):
        raise Finding(text, run)

    def judge_end(self, run):
        if run.code not in EXPECTED:
            name = signal.Signals(-run.code).name if run.code < 0 else f"exit code {run.code}"
            raise Finding(f"ends with {name}", run)
        if "Traceback" in run.said or "terminate called" in run.said or "ERROR: AddressSanitizer" in run.said:
            raise Finding("shows its inside", run)
        if run.code != 0 and not run.errors.strip():
            raise Finding(f"exit code {run.code} without a message", run)
        # A motion prints every state that it writes: thousands in the seconds of a run.
        if len(run.said) > 500_000 and "check-tangent" not in run.command:
            raise Finding(f"says {len(run.said)} characters", run)

    def assert_numbers(self, run):
        """No nan or inf that the input does not contain; a refusal may print the refused value."""
        if run.code == 2:
            return
        found = NOT_A_NUMBER.search(run.said)
        typed = " ".join([*run.command, *(t.read_text(errors="replace") for t in self.folder.glob("*.*")
                                          if t.suffix in (".toml", ".csv", ".txt"))])  # fmt: skip
        if found and not NOT_A_NUMBER.search(typed) and found[1].lower() not in typed.lower():
            raise Finding(f"says {found[0]!r}", run)

    # ---- inputs ----------------------------------------------------------------------------------

    def try_it(self):
        """Makes the input and tries it; returns its kind."""
        if self.number % self.EVERY_FIFTH == 0:
            properties.try_property(self)
            return "property"
        kind = self.random.choices(("case", "set", "points", "calibrate", "plot", "pair"), weights=(50, 25, 12, 6, 3, 4))[0]
        getattr(self, f"try_{kind}")()
        return kind

    def write(self, name, data):
        (self.folder / name).write_bytes(data if isinstance(data, bytes) else data.encode())

    def write_corpus(self, case):
        self.write("case.toml", self.texts[case])
        for name in ("cloud.csv", "neighbours.txt"):
            self.write(name, self.texts[name])

    def try_case(self):
        case = self.random.choice(self.cases)
        self.write_corpus(case)
        self.write("case.toml", mutations.mutated_text(self.random, self.texts[case], list(self.texts.values())))
        self.try_commands()

    def try_pair(self):
        """Combines halves of two cases."""
        first, second = (self.texts[self.random.choice(self.cases)].splitlines() for _ in range(2))
        self.write_corpus("cloud.toml")
        cut = self.random.randrange(len(first)), self.random.randrange(len(second))
        self.write("case.toml", "\n".join(first[: cut[0]] + second[cut[1] :]) + "\n")
        self.try_commands()

    def try_set(self):
        self.write_corpus(self.random.choice(self.cases))
        overrides = []
        for _ in range(self.random.choice((1, 1, 2, 3))):
            value = mutations.value(self.random)
            if self.random.random() < 0.2:
                value = value.strip('"')
            overrides += ["--set", f"{self.random.choice(mutations.KEYS)}={value}".replace("\0", "")]
        self.try_commands(overrides)

    def try_points(self):
        if self.random.random() < 0.3:
            self.write_corpus("listed.toml")
            self.write("neighbours.txt", mutations.mutated_neighbours(self.random, self.texts["neighbours.txt"]))
        else:
            self.write_corpus("cloud.toml")
            self.write("cloud.csv", mutations.mutated_points(self.random, self.texts["cloud.csv"]))
        self.try_commands()

    def try_commands(self, overrides=()):
        check = self.peristat("check", "case.toml", *overrides)
        self.assert_numbers(check)
        size = re.search(r"^points +(\d+) ", check.output, re.MULTILINE)
        if check.code == 0 and (not size or int(size[1]) > LARGEST_RUN or self.has_many_interactions(check)):
            return
        what = self.random.random()
        if what < 0.15:
            deformation = []
            if self.random.random() < 0.5:
                parts = [self.random.choice(mutations.EXPRESSIONS) for _ in range(self.random.randint(0, 4))]
                deformation = ["--deformation", "; ".join(parts)]
            self.assert_numbers(self.peristat("check-tangent", "case.toml", *overrides, *deformation))
        elif what < 0.25:
            self.assert_numbers(self.peristat("calibrate", "case.toml", *overrides))
        else:
            self.run_case(overrides, check)

    @staticmethod
    def has_many_interactions(check):
        return any(int(count) > 300_000 for count in re.findall(r"(\d+) (?:triangles|tetrahedra)", check.output))

    def run_case(self, overrides, check):
        command = ["timeout", "--signal=INT", f"--kill-after={STOP_SECONDS}", str(RUN_SECONDS), program.PROGRAM, "run",
                   "case.toml", "--threads", "1", "--output", "out", *overrides]  # fmt: skip
        self.commands.append(command)
        run = program.execute(command, folder=self.folder, seconds=RUN_SECONDS + 3 * STOP_SECONDS)
        if run.code in (None, 137, -signal.SIGKILL):
            raise Finding("does not stop when told to", run)
        if run.code in (124, 130):  # interrupted by us: more work than time
            return
        self.judge_end(run)
        self.assert_numbers(run)
        if check.code == 2 and run.code != 2:
            raise Finding(f"refused by check, but run ends with {run.code}", run)
        if (self.folder / "out/results.h5").exists():
            self.judge_results(run, overrides)

    def judge_results(self, run, overrides):
        places = not_finite(self.folder / "out")
        if places:
            raise Finding(f"not finite: {', '.join(places[:5])}", run)
        results = Results(self.folder / "out")
        statuses = {0: ("completed",), 3: ("not_converged", "inconsistent")}.get(run.code)
        if statuses and results.summary["status"] not in statuses:
            raise Finding(f"exit code {run.code}, status {results.summary['status']}", run)
        if run.code == 0:
            self.judge_steps(run, results)
        if not overrides:
            self.judge_by_reference(run, results)

    @staticmethod
    def judge_steps(run, results):
        past = 0.0
        for row in results.table("history"):
            largest = max(abs(row[name]) for name in ("stored_energy", "dissipated_energy", "external_work"))
            if row["dissipated_energy"] < past - 1e-12 * largest:
                raise Finding(f"dissipated energy falls in step {row['step']}", run)
            past = row["dissipated_energy"]
            if not 0 <= row["max_damage"] <= 1:
                raise Finding(f"damage {row['max_damage']}", run)
        rows = {int(row["step"]): row for row in results.table("history")}
        # Torn parts keep the round-off of their previous forces, also in the step that tears them.
        borne = max((abs(step.force).max() for step in results.steps), default=0.0)
        for step in results.steps:
            moved = abs(step.displacement).max()
            borne = max(borne, abs(rows[step.number]["external_work"]) / moved if moved > 0.0 else 0.0)
        for step in results.steps:
            total = step.force.sum(axis=0)
            for axis in range(len(total)):  # forces from beyond planes of symmetry
                name = f"reaction_{'xyz'[axis]}:symmetry_"
                total[axis] -= sum(value for key, value in rows[step.number].items() if key.startswith(name))
            largest, total = abs(step.force).max(), abs(total).max()
            reactions = [abs(value) for key, value in rows[step.number].items() if key.startswith("reaction_")]
            beyond = max(reactions, default=0.0)  # of planes and periods, also where points carry no force
            if total > 1e-9 * largest * len(step.force) + 1e-12 * (beyond + borne):
                raise Finding(f"internal forces of step {step.number} sum up to {total:.3g} N of {largest:.3g} N", run)

    def judge_by_reference(self, run, results):
        """Checks accepted steps by the reference, if it can read the case."""
        text = (self.folder / "case.toml").read_bytes().decode(errors="replace")
        tables = tomllib.loads(text)
        relaxation = tables.get("relaxation", {})
        materials = [table["material"] for table in [tables, *tables.get("region", []), *tables.get("interface", [])]
                     if "material" in table]  # fmt: skip
        calibrated = materials[0].get("model") == "cpd" and not all("c1" in material for material in materials)
        settled = relaxation.get("load") == "moving" or relaxation.get("displacement_tolerance", 0) > 0
        # tests/reference/motion.py checks motions, tests/reference/fatigue.py cycles of the load.
        is_elsewhere = tables.get("solver", {}).get("mode") in ("dynamics", "fatigue")
        if calibrated or settled or is_elsewhere or len(results.volume) > 500 or len(results.steps) > 200:
            return
        try:
            verification = Verification(self.folder / "out", text, self.folder)
            complaints = verification.run() if verification.histories_are_known else []
        except NotUnderstood:
            return
        if complaints:
            raise Finding(f"the reference disagrees: {complaints[0]}", run)

    def try_calibrate(self):
        names = """--dimension --spacing --horizon-ratio --thickness --youngs-modulus --poisson-ratio --lambda --mu --c1 --c2
            --c3""".split()
        usual = {"--dimension": "2", "--spacing": "0.1", "--horizon-ratio": "2.015", "--youngs-modulus": "1e3", "--poisson-ratio": "0.4"}
        for _ in range(self.random.choice((1, 1, 2, 3))):
            usual[self.random.choice(names)] = self.random.choice([*mutations.NUMBERS, "x", ""])
        if self.random.random() < 0.2:
            usual.pop(self.random.choice(list(usual)))
        self.assert_numbers(self.peristat("calibrate", *(f"{name}={value}" for name, value in usual.items())))

    def try_plot(self):
        self.write_corpus(self.random.choice(["strip.toml", "cloud.toml", "bar.toml"]))
        run = self.peristat("run", "case.toml", "--quiet", "--threads", "1", "--output", "out")
        if run.code != 0:
            raise Finding("a case of the corpus does not run", run)
        mutations.spoil_folder(self.random, self.folder / "out")
        if self.random.random() < 1 / 3:
            with contextlib.suppress(OSError, RuntimeError, KeyError, ValueError):  # too corrupted for more
                mutations.spoil_folder(self.random, self.folder / "out")
        self.execute([*program.PLOT, "out"], seconds=10 * CPU_SECONDS, cpu_seconds=2 * CPU_SECONDS)


def keep_finding(keep, seed, number, made, finding):
    """Writes files, words and commands of a finding into a folder of its own; returns it."""
    folder = pathlib.Path(keep) / f"seed_{seed}_input_{number}"
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(made.folder, folder, symlinks=True, ignore=shutil.ignore_patterns("plots"))
    said = finding.run.said[-20_000:] if finding.run else ""
    (folder / "finding.txt").write_text(f"{finding}\n\n{said}\n")
    lines = ["#!/bin/sh", f"# {' '.join(str(finding).split())[:200]}", 'cd "$(dirname "$0")" || exit',
             *(shlex.join(map(str, command)) for command in made.commands)]  # fmt: skip
    (folder / "repeat.sh").write_text("\n".join(lines) + "\n")
    return folder


def fuzz(seed, numbers, keep, until=float("inf"), tell=print):
    """Tries inputs; returns how many of each kind were tried, and the findings by their number."""
    tried, findings = collections.Counter(), {}
    for number in numbers:
        if time.monotonic() > until:
            break
        with tempfile.TemporaryDirectory(prefix="peristat_fuzz_") as temporary:
            made = Input(seed, number, temporary)
            try:
                tried[made.try_it()] += 1
            except Finding as finding:
                folder = keep_finding(keep, seed, number, made, finding)
                findings[number] = str(finding)
                tell(f"input {number}: {finding}\n    {folder}")
    return tried, findings


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--minutes", type=float, default=1.5)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="number of the first input")
    parser.add_argument("--only", type=int, help="a single input by its number")
    parser.add_argument("--keep", default="results/fuzz", help="folder for the findings")
    options = parser.parse_args()
    numbers = [options.only] if options.only is not None else range(options.first, 10**9)
    until = time.monotonic() + 60 * options.minutes
    tried, findings = fuzz(options.seed, numbers, options.keep, until, lambda text: print(text, flush=True))
    print(f"seed {options.seed}: {sum(tried.values()) + len(findings)} inputs "
          f"({', '.join(f'{count} {kind}' for kind, count in sorted(tried.items()))}), {len(findings)} findings")  # fmt: skip
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
