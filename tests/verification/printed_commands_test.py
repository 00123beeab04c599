"""Commands in README and pages are accepted, and do what the text says.

A `run` makes one step, since whole runs take up to minutes; `printed_numbers_test.py` and tests/slow make whole ones. `sweep`
is checked with its first values, `fit` with its starting values. Commands of the gallery are `run`s of shipped cases, which `command_line_test.py` checks.
"""

import re
import shlex
import tomllib
import unittest

from tests.acceptance.folder import Folder
from tests.acceptance.on_ranks import ENVIRONMENT
from tests.printed.fences import PAGES, cases, lines, parts
from tests.reference.program import PLOT, ROOT, settings
from tests.reference.results import table

# Beginnings of command lines that this file does not run, and why.
ELSEWHERE = {
    "./peristat build": "builds; tests run in what it has built",
    "./peristat test": "these tests",
    "./peristat site": "tests/acceptance/site_test.py builds it",
    "./peristat python": "builds; python_package_test.py and python_tutorials_test.py run the scripts",
    "./peristat report": "tests of the report",
    "./peristat trust": "runs for an hour; trust_test.py runs its quick form",
    "apt install": "needs root; package_test.py unpacks the package",
    "cp -r /usr/share/peristat/cases": "of an installed package; package_test.py",
    "peristat": "of an installed package; package_test.py",
    "docker": "needs Docker",
    "cmake": "library_test.py",
    "build/plate/plate": "library_test.py",
    "mpirun": "ranks_test.py",
    "srun": "needs Slurm",
    "paraview": "needs ParaView; viewers_test.py reads its files",
    "/usr/bin/python3": "torture_test.py, fuzz_test.py and reference_test.py run these scripts",
    "PERISTAT_PROGRAM=build/release/peristat nice /usr/bin/python3 -B docs/gallery/make.py": "runs all cases; gallery_test.py",
    "PERISTAT_PROGRAM=build/sanitize/peristat": "the same under the sanitizers",
}
PROGRAM = "run", "resume", "check", "check-tangent", "calibrate", "sweep", "fit", "keys", "schema", "points", "plot", "help"
GALLERY = ROOT / "docs/gallery.md"


def commands(path):
    """Words of the page's command lines behind `./peristat`."""
    return [words[1:] for words in lines(path) if words[0] == "./peristat"]


class Commands(Folder):
    def setUp(self):
        super().setUp()
        (self.folder / "cases").symlink_to(ROOT / "cases")

    def prepare(self, page):
        for name, text in cases(page).items():
            (self.folder / name).write_text(text)

    def assert_does(self, words):
        command, *rest = words
        if command in ("sweep", "fit"):
            sets = [rest[k + 1] for k, word in enumerate(rest) if word == "--set"]
            sets += [re.split(r",(?![^\[]*\])", rest[k + 1])[0] for k, word in enumerate(rest) if word == "--vary"]
            words = ["check", rest[0], *settings(*sets)]
        if command == "run":
            words = [*self.without_output(words), "--stop-after", "1", "--output", "out", "--overwrite", "--quiet"]
        ended = self.peristat(*words, limited="--ranks" not in words, environment=ENVIRONMENT)
        self.assert_code(ended, (0, 130) if command == "run" else 0)

    @staticmethod
    def without_output(words):
        at = words.index("--output") if "--output" in words else len(words)
        at_stop = words.index("--stop-after") if "--stop-after" in words else len(words)
        return [word for k, word in enumerate(words) if k not in (at, at + 1, at_stop, at_stop + 1)]

    def test_run(self):
        asked = {}
        for page in PAGES:
            for words in commands(page):
                # resume and plot need results: see test_strip and test_restart below, and the tests of plot
                if page != GALLERY and words[0] in PROGRAM and words[0] not in ("resume", "plot", "help"):
                    asked.setdefault(tuple(words), page)
        self.assertGreater(len(asked), 40)
        for words, page in asked.items():
            with self.subTest(page=page.name, command=" ".join(words)):
                self.prepare(page)
                self.assert_does(list(words))

    def test_every_line_is_run_or_has_a_reason(self):
        used = set()
        for page in PAGES:
            for words in lines(page):
                line = " ".join(words)
                if words[0] == "./peristat" and words[1] in PROGRAM:
                    continue
                reasons = [start for start in ELSEWHERE if line == start or line.startswith(f"{start} ")]
                self.assertTrue(reasons, f"{page.name}: {line}")
                used.update(reasons)
        self.assertGreater(len(used), 10)

    def test_gallery_runs_the_shipped_cases(self):
        asked = [words for words in commands(GALLERY)]
        shipped = sorted(str(path.relative_to(ROOT)) for path in (ROOT / "cases").glob("*/*.toml"))
        self.assertEqual(sorted(case for _, case in asked), shipped)
        self.assertEqual({command for command, _ in asked}, {"run"})

    def test_parts_of_cases_are_accepted(self):
        """Tables below `<!-- with: CASE -->` go with the case, those below `<!-- in: CASE -->` are in it."""
        tried = 0
        for page in PAGES:
            for name, text in parts(page, "with"):
                with self.subTest(page=page.name, text=text):
                    case = self.write(f"cases of pages/{name}.toml", (ROOT / f"cases/{name}.toml").read_text() + "\n" + text)
                    self.assert_completed(self.peristat("check", case))
                    tried += 1
            for name, text in parts(page, "in"):
                self.assert_contains(tomllib.loads((ROOT / f"cases/{name}.toml").read_text()), tomllib.loads(text))
                tried += 1
        self.assertGreater(tried, 5)

    def assert_contains(self, tables, part):
        for key, value in part.items():
            self.assertIn(key, tables)
            if isinstance(value, dict):
                self.assert_contains(tables[key], value)
            else:
                self.assertEqual(tables[key], value, key)

    def test_settings_within_the_text_are_accepted(self):
        """`--set …` within the tutorial's sentences, for the case of the last command before them."""
        text, case, tried = (ROOT / "docs/tutorial-fracture.md").read_text(), None, 0
        for line in text.splitlines():
            if named := re.match(r"\./peristat \w+ (cases/\S+)", line):
                case = named[1]
            for quoted in re.findall(r"`(--set [^`…]*)`", line):
                mode = ["--set", "solver.mode=relaxation"] if "relaxation.load" in quoted else []
                self.assert_completed(self.peristat("check", case, *mode, *shlex.split(quoted)))
                tried += 1
        self.assertGreater(tried, 0)

    def test_plate_of_readme_is_the_plate_from_scratch(self):
        short, long = cases(ROOT / "README.md")["plate.toml"], cases(ROOT / "docs/start/own-plate.md")["plate.toml"]
        self.assertEqual(tomllib.loads(short), tomllib.loads(long))

    def test_readme_is_short(self):
        self.assertLessEqual(len((ROOT / "README.md").read_text().splitlines()), 100)
        self.assertLessEqual(len(cases(ROOT / "README.md")["plate.toml"].splitlines()), 15)

    def test_strip(self):
        page = ROOT / "docs/commands.md"
        self.prepare(page)
        elastic, torn, cycle = (words for words in commands(page) if words[:2] == ["run", "strip.toml"])
        ((_, drawn), again) = (words for words in commands(page) if words[0] in ("plot", "resume"))
        self.assert_completed(self.peristat(*elastic, "--quiet"))
        self.assertEqual(len(table(self.folder / "results/strip/history.csv")), 11)  # step 0 is one
        self.assert_completed(self.peristat(*again))
        self.assert_completed(self.execute([*PLOT, drawn]))
        self.assert_completed(self.peristat(*torn, "--quiet", "--output", "torn", limited=False))
        last = table(self.folder / "torn/history.csv")[-1]
        self.assertGreater(last["broken_bonds"], 0)  # "until it breaks"
        peak = max(abs(row["reaction_x:left"]) for row in table(self.folder / "torn/history.csv"))
        self.assertLess(abs(last["reaction_x:left"]), 1e-2 * peak)  # carried by loose points between the pieces
        self.assert_completed(self.peristat(*cycle, "--quiet", "--output", "cycle"))
        self.assertEqual([row["load_factor"] for row in table(self.folder / "cycle/history.csv")], [0, 1, 0, 1.2])

    def test_restart(self):
        """Pairs of a run and its continuation; the second pair takes minutes, so its end alone is made."""
        first, again, newton, adaptive, elastic, unload = commands(ROOT / "docs/how-to/restart.md")
        self.assert_code(self.peristat(*first, "--quiet"), 130)
        self.assert_completed(self.peristat(*again, "--quiet"))
        coarse = ["--set", "loading.smallest_step=0.05", "--set", "lattice.spacing=2e-3"]
        self.assert_code(self.peristat(*newton, *coarse, "--quiet"), 3)
        self.assert_completed(self.peristat(*adaptive, "--quiet"))
        self.assert_completed(self.peristat(*elastic, "--quiet"))
        self.assert_completed(self.peristat(*unload, "--quiet"))
        history = table(self.folder / "results/plate_with_hole_elastic/history.csv")
        self.assertEqual([row["load_factor"] for row in history][-1], 0)


if __name__ == "__main__":
    unittest.main()
