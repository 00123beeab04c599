"""Histories of shipped cases by two programs, which run at the same time on a core each.

    /usr/bin/python3 -BEs benchmarks/same_histories.py OLD NEW [--seconds N] [CASE...]

A run ends after N seconds; the rows and columns that both have are compared.
"""

import argparse
import csv
import pathlib
import resource
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]


def rows(folder):
    path = folder / "history.csv"
    return list(csv.DictReader(path.open())) if path.exists() else []


def are_alike(old, new):
    """Whether the rows that both have are the same in the columns of both."""
    common = list(zip(old, new))
    return bool(common) and all(one[column] == other[column] for one, other in common for column in one.keys() & other.keys())


def run(programs, case, seconds, folder):
    """Histories by both programs."""
    folders = [folder / name for name in ("old", "new")]
    runs = [subprocess.Popen(["timeout", "-s", "INT", str(seconds), program, "run", case, "--output", to, "--no-plots",
                              "--threads", "1"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            for program, to in zip(programs, folders)]  # fmt: skip
    codes = [process.wait() for process in runs]
    return codes, [rows(to) for to in folders]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("cases", nargs="*")
    parser.add_argument("--seconds", type=int, default=30)
    given = parser.parse_args()
    cases = given.cases or sorted(path for path in ROOT.glob("cases/*/*.toml"))
    same = ended = 0
    for case in cases:
        with tempfile.TemporaryDirectory() as folder:
            codes, (old, new) = run((given.old, given.new), case, given.seconds, pathlib.Path(folder))
        alike = are_alike(old, new)
        same, ended = same + alike, ended + (codes == [0, 0])
        print(case, codes, len(old), len(new), "same" if alike else "DIFFERENT", flush=True)
    print(f"{same} of {len(cases)} the same, {ended} to their end,",
          f"{resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime:.0f} s of the processor")  # fmt: skip


if __name__ == "__main__":
    main()
