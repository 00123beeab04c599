#!/usr/bin/env -S /usr/bin/python3 -BEs
"""Torture: random but valid cases, whose accepted steps the reference has to confirm.

    /usr/bin/python3 -B tests/torture/torture.py                    all 300 cases, some 20 minutes on one core
    /usr/bin/python3 -B tests/torture/torture.py --only 17          one of them again
    /usr/bin/python3 -B tests/torture/torture.py --seed 2 --cases 50
    /usr/bin/python3 -B tests/torture/torture.py --rich             those of tests/torture/rich.py

A case must end with 0 (done), 3 (did not converge), 4 (memory), or 2 if its body is unstable at rest
or not held, within a minute of processor time. Failing cases are kept below --keep.
"""

import argparse
import collections
import pathlib
import re
import shutil
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2]))

from tests.reference.program import peristat  # noqa: E402
from tests.reference.results import not_finite  # noqa: E402
from tests.reference.verify import Verification  # noqa: E402
from tests.torture.generator import Generator  # noqa: E402
from tests.torture.rich import RichGenerator  # noqa: E402

CPU_SECONDS = 60
# Messages for a body that can't be calculated because of its constants, points or supports.
REFUSALS = ("unstable at rest", "move freely", "held", "negative", "Poisson", "selects no")


def judge(path, folder):
    """Runs a case; returns the exit code, whether the reference checked it, and complaints."""
    run = peristat("run", path, "--quiet", "--threads", 1, "--output", folder / "out", "--set", "output.stress=true", folder=folder,
                   seconds=10 * CPU_SECONDS, cpu_seconds=CPU_SECONDS)  # fmt: skip
    (folder / "said.txt").write_text(run.said)
    if run.code is None:
        return run.code, False, ["out of time"]
    if run.code == 2 and any(word in run.said for word in REFUSALS):
        return run.code, False, []
    if run.code not in (0, 3, 4):
        return run.code, False, [f"exit code {run.code}: {run.said.strip()[-500:]}"]
    if run.code == 4 or not (folder / "out/results.h5").exists():
        return run.code, False, []
    complaints = [f"not finite: {place}" for place in not_finite(folder / "out")]
    verification = Verification(folder / "out", path.read_text(), folder)
    if verification.histories_are_known:
        return run.code, True, complaints + verification.run()
    return run.code, False, complaints


def torture(seed, numbers, keep, tell=print, generator=Generator):
    """Runs cases; returns counts by outcome and the numbers of those that failed with complaints."""
    counts, failures = collections.Counter(), {}
    for number in numbers:
        with tempfile.TemporaryDirectory(prefix="peristat_torture_") as temporary:
            folder, since = pathlib.Path(temporary), time.monotonic()
            path = generator(seed, number).make(folder)
            try:
                code, judged, complaints = judge(path, folder)
            except Exception as error:  # noqa: BLE001  what the reference can't read is a finding, too
                code, judged, complaints = -1, False, [f"the reference fails: {error!r}"]
            counts[f"exit {code}"] += 1
            counts["judged"] += judged
            if complaints:
                failures[number] = complaints
                if keep:
                    kind = "rich" if generator is RichGenerator else "seed"
                    kept = pathlib.Path(keep) / f"{kind}_{seed}_case_{number}"
                    shutil.rmtree(kept, ignore_errors=True)
                    shutil.copytree(folder, kept)
                    (kept / "complaints.txt").write_text("\n".join(complaints) + "\n")
            text = f"case {number}: exit {code}, {'judged' if judged else 'not judged'}, {time.monotonic() - since:.1f} s"
            tell(text + "".join(f"\n    {line}" for line in complaints[:3]))
    return counts, failures


def main():
    parser = argparse.ArgumentParser(description=re.split(r"\n\n", __doc__)[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--cases", type=int, default=300)
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--only", type=int, help="a single case by its number")
    parser.add_argument("--rich", action="store_true", help="cases with every key that the others lack")
    parser.add_argument("--keep", default="results/torture", help="folder for the cases that fail")
    options = parser.parse_args()
    numbers = [options.only] if options.only is not None else range(options.first, options.first + options.cases)
    counts, failures = torture(options.seed, numbers, options.keep, lambda text: print(text, flush=True),
                               RichGenerator if options.rich else Generator)  # fmt: skip
    print(", ".join(f"{name}: {count}" for name, count in sorted(counts.items())))
    print(f"{len(failures)} failed" + (f": {', '.join(map(str, failures))}" if failures else ""))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
