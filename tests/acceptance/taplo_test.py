"""Case files by `#:schema`, as taplo and the editors that use it check them.

npm installs taplo in the build folder (tests/schema/package-lock.json), which needs the network once. Without
npm or the network the tests fail rather than pass unseen; `ctest -E taplo_test` leaves them out.
"""

import functools
import pathlib
import re
import shutil
import subprocess
import unittest

from tests.acceptance.folder import Folder
from tests.reference.program import PROGRAM, ROOT

SCHEMA = ROOT / "docs/case.schema.json"
SOURCES = ROOT / "tests/schema"
SHIPPED = sorted([*(ROOT / "cases").rglob("*.toml"), *(ROOT / "benchmarks").glob("*.toml")])

VALID = """#:schema SCHEMA
dimension = 2
[lattice]
spacing = 1e-3
thickness = "1000 mm"
[[lattice.shape]]
add = "box"
min = [0, 0.0]
max = [0.02, 1e-2]
[[lattice.layer]]
name = "left"
side = "x-"
[[set]]
name = "corner"
shape = { disk = { centre = [0.02, 0.01], radius = 2e-3 } }
[material]
youngs_modulus = 200e9
[material.damage]
law = "critical_stretch"
critical = 0.01
[[support]]
set = "left"
displacement = [0, "0.0"]
[[support]]
set = "corner"
displacement = ["0.01 mm * load", "free"]
[loading]
steps = 2
adaptive = true
"""
# What is wrong, by what it replaces, and the line at which taplo has to report it.
BROKEN = {
    "a misspelt key": ("spacing = 1e-3", "spacing = 1e-3\nhorizn_ratio = 3.0", 5),
    "a misspelt table": ("[loading]", "[loadng]", 27),
    "a key of another table": ("steps = 2", "steps = 2\nthickness = 1", 29),
    "a key that a shape does not have": ("radius = 2e-3 }", "radius = 2e-3, length = 1.0 }", 15),
    "text for a whole number": ("dimension = 2", 'dimension = "two"', 2),
    "a fraction for a whole number": ("steps = 2", "steps = 2.5", 28),
    "a number for a name": ('name = "left"', "name = 7", 11),
    "a name with a blank": ('name = "left"', 'name = "left side"', 11),
    "text for a switch": ("adaptive = true", 'adaptive = "yes"', 29),
    "text that is no quantity": ("youngs_modulus = 200e9", 'youngs_modulus = "stiff"', 17),
    "a number for a list": ("min = [0, 0.0]", "min = 0", 8),
    "too many components": ("min = [0, 0.0]", "min = [0, 0, 0, 0]", 8),
    "a table for a value": ("critical = 0.01", "critical = {}", 20),
    "one table for many": ("[[lattice.layer]]", "[lattice.layer]", 10),
    "a word that is no choice": ('law = "critical_stretch"', 'law = "critical"', 19),
    "a shape that there is not": ('add = "box"', 'add = "brick"', 7),
    "a side that there is not": ('side = "x-"', 'side = "left"', 12),
    "a number above its range": ("dimension = 2", "dimension = 4", 2),
    "a number below its range": ("steps = 2", "steps = 0", 28),
    "a negative modulus": ("200e9", "-200e9", 17),
    "no dimension": ("dimension = 2\n", "", 2),
    "no radius": (", radius = 2e-3", "", 15),
    "no set of a support": ('set = "corner"\n', "", 24),
    "no body": (VALID[VALID.index("[lattice]") : VALID.index("[[set]]")], "", 2),
    "no modulus": ("youngs_modulus = 200e9\n", "", 16),
    "two moduli": ("youngs_modulus = 200e9", "youngs_modulus = 200e9\nmicromodulus = 1e20", 17),
}


@functools.cache
def taplo():
    """Path of taplo, which npm installs if the lock file asks for another one."""
    folder = pathlib.Path(PROGRAM).resolve().parent / "taplo"
    command = folder / "node_modules/.bin/taplo"
    files = [SOURCES / name for name in ("package.json", "package-lock.json")]
    if command.exists() and all((folder / file.name).read_bytes() == file.read_bytes() for file in files):
        return command
    if not shutil.which("npm"):
        raise AssertionError("taplo needs npm: apt-get install --no-install-recommends npm")
    folder.mkdir(exist_ok=True)
    for file in files:
        shutil.copy(file, folder)
    ended = subprocess.run(["npm", "ci", "--no-audit", "--no-fund"], cwd=folder, capture_output=True, text=True, timeout=300)
    if ended.returncode != 0:
        (folder / "package-lock.json").unlink()  # the next run installs again
        raise AssertionError(f"npm could not install taplo, which needs the network once:\n{ended.stderr}")
    return command


class Taplo(Folder):
    def lint(self, *files):
        return self.execute([taplo(), "lint", "--no-auto-config", "--colors", "never", *files], limited=False)  # WebAssembly

    def test_shipped_cases_name_the_schema_in_their_first_line(self):
        self.assertGreater(len(SHIPPED), 40)
        for case in SHIPPED:
            word, path = case.read_text().partition("\n")[0].split()
            self.assertEqual((word, (case.parent / path).resolve()), ("#:schema", SCHEMA), case)

    def test_shipped_cases_are_valid(self):
        self.assert_code(self.lint(*SHIPPED), 0)

    def test_broken_cases_are_refused_at_their_line_as_the_program_refuses_them(self):
        text = VALID.replace("SCHEMA", SCHEMA.as_uri())
        valid = self.write("valid.toml", text)
        self.assert_code(self.lint(valid), 0)
        self.assert_code(self.peristat("check", valid), 0)
        files = {}
        for what, (old, new, _) in BROKEN.items():
            self.assertEqual(text.count(old), 1, what)
            files[what] = self.write(f"{what}.toml", text.replace(old, new))
        said = self.lint(*files.values()).said
        for what, (_, _, line) in BROKEN.items():
            with self.subTest(what):
                found = {int(place) for place in re.findall(rf"{re.escape(str(files[what]))}:(\d+):", said)}
                self.assertIn(line, found)
                self.assert_code(self.peristat("check", files[what]), 2)


if __name__ == "__main__":
    unittest.main()
