"""The architecture: includes only go downwards, and the code is formatted."""

import concurrent.futures
import os
import pathlib
import re
import shutil
import subprocess
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
# From the lowest floor up. Tests and benchmarks may include any floor.
FLOORS = ["src", "assembly", "solvers", "cases", "python"]
# Rooms of the floors; each may include itself and earlier ones.
ROOMS = [
    "src/core",
    "src/parallel",
    "src/dense",
    "src/transforms",
    "src/measures",
    "src/potentials",
    "src/geometry",
    "src/neighbourhood",
    "src/connectivity",
    "src/materials",
    "src/constraints",
    "src/conditions",
    "assembly/convolutions",
    "assembly/energy",
    "assembly/operators",
    "assembly/terms/failure",
    "assembly/terms",
    "assembly",
    "solvers/linear",
    "solvers/ranks",
    "solvers/formulations/specification",
    "solvers/formulations/materials",
    "solvers/formulations/interface",
    "solvers/formulations/convolved",
    "solvers/formulations/solid",
    "solvers/formulations/bond",
    "solvers/formulations/linear_bond",
    "solvers/formulations/green_bond",
    "solvers/formulations/cpd",
    "solvers/formulations/state",
    "solvers/formulations/lps_energy",
    "solvers/formulations/lps_collocation",
    "solvers/formulations/correspondence",
    "solvers/formulations",
    "solvers/body",
    "solvers/problem",
    "solvers/fracture",
    "solvers/search",
    "solvers/motion",
    "solvers/drivers",
    "solvers/study",
    "solvers/observe",
    "cases/runner/process",
    "cases/runner/input",
    "cases/runner/setup",
    "cases/runner/results/files",
    "cases/runner/results/tables",
    "cases/runner/results/parts",
    "cases/runner/results/checkpoint",
    "cases/runner/results/folder",
    "cases/runner/results",
    "cases/runner/commands",
    "cases/runner",
    "python/core",
]
# Ceilings, to be lowered.
PARTITION_BRANCHES, MODEL_BRANCHES = 60, 15
OUTSIDE = ["tests", "benchmarks"]
# Headers outside the standard library that headers of a floor may include; keep it this small.
ALLOWED_IN_HEADERS = {"omp.h"}
BINDING = "pybind11/"  # headers of python/core exist to bind, and no other floor includes them
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)
STANDARD_HEADER = re.compile(r"[a-z_0-9]+")  # <vector>: neither a folder nor an extension
CLANG_FORMAT_VERSION = "14"  # versions format differently; this is the one of Debian 12


def sources(*suffixes, places=tuple(FLOORS + OUTSIDE)):
    found = [
        path
        for place in places
        for path in sorted((ROOT / place).rglob("*"))
        if path.suffix in suffixes
    ]
    assert found, f"no {suffixes} in {places}"
    return found


def room_of(file):
    """The room that contains a file, at any depth; its folder if there is none."""
    folders = file.split("/")[:-1]
    for depth in range(len(folders), 0, -1):
        if "/".join(folders[:depth]) in ROOMS:
            return "/".join(folders[:depth])
    return "/".join(folders)


def misplaced_includes(file, text):
    """Errors in the includes of a file; `file` is relative to the root, with slashes."""
    floor = file.split("/")[0]
    wrong = []
    for kind, name in INCLUDE.findall(text):
        target = name.split("/")[0]
        if kind == '"':
            if target not in FLOORS + OUTSIDE:
                wrong.append(f'{file}: "{name}" is not rooted at the project root')
            elif floor in FLOORS and target in OUTSIDE:
                wrong.append(f'{file}: "{name}" is outside the house')
            elif floor in FLOORS and FLOORS.index(target) > FLOORS.index(floor):
                wrong.append(f'{file}: "{name}" runs up a floor')
            elif floor in FLOORS and room_of(file) in ROOMS and room_of(name) in ROOMS:
                if ROOMS.index(room_of(name)) > ROOMS.index(room_of(file)):
                    wrong.append(f'{file}: "{name}" is in a room above its own')
        elif file.endswith(".hpp") and floor in FLOORS:
            allowed = STANDARD_HEADER.fullmatch(name) or name in ALLOWED_IN_HEADERS
            if not allowed and not (floor == "python" and name.startswith(BINDING)):
                wrong.append(f"{file}: <{name}> belongs in a .cpp file")
    return wrong


def lines_with(pattern, *, outside=()):
    """Lines of the floors that match, as "file:number", but in rooms `outside`."""
    return [
        f"{path.relative_to(ROOT).as_posix()}:{number}"
        for path in sources(".hpp", ".cpp", places=FLOORS)
        if room_of(path.relative_to(ROOT).as_posix()) not in outside
        for number, line in enumerate(path.read_text("utf-8").splitlines(), 1)
        if re.search(pattern, re.sub(r"//.*", "", line))
    ]


def in_parallel(check, files):
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        return [message for message in pool.map(check, files) if message]


class Architecture(unittest.TestCase):
    def test_a_misplaced_include_is_noticed(self):
        def wrong(file, line):
            return len(misplaced_includes(file, "#pragma once\n" + line + "\n"))

        self.assertEqual(wrong("src/geometry/points.hpp", '#include "assembly/operators/block_pattern.hpp"'), 1)
        self.assertEqual(wrong("src/points/points.cpp", '#include "solvers/search/newton.hpp"'), 1)
        self.assertEqual(wrong("solvers/search/newton.cpp", '  #  include "cases/runner/input/case.hpp"'), 1)
        self.assertEqual(wrong("src/geometry/points.hpp", '#include "src/materials/quadrature.hpp"'), 1)
        self.assertEqual(wrong("assembly/terms/bonds/a.hpp", '#include "assembly/terms/term.hpp"'), 0)
        self.assertEqual(wrong("assembly/terms/bonds/a.hpp", '#include "assembly/assembler.hpp"'), 1)
        self.assertEqual(wrong("src/types.cpp", '#include "tests/support.hpp"'), 1)
        self.assertEqual(wrong("src/geometry/points.hpp", '#include "shape.hpp"'), 1)
        self.assertEqual(wrong("src/geometry/points.hpp", "#include <Eigen/Dense>"), 1)
        self.assertEqual(wrong("solvers/linear/solver.hpp", "#include <cholmod.h>"), 1)
        self.assertEqual(wrong("solvers/linear/solver.cpp", "#include <cholmod.h>"), 0)
        self.assertEqual(wrong("solvers/search/newton.cpp", '#include "src/core/types.hpp"'), 0)
        self.assertEqual(wrong("src/geometry/points.hpp", "#include <vector>"), 0)
        self.assertEqual(wrong("cases/runner/main.cpp", '#include "python/core/step.hpp"'), 1)
        self.assertEqual(wrong("python/core/step.cpp", '#include "cases/runner/commands/run.hpp"'), 0)
        self.assertEqual(wrong("python/core/step.hpp", "#include <pybind11/numpy.h>"), 0)
        self.assertEqual(wrong("cases/runner/input/case.hpp", "#include <pybind11/numpy.h>"), 1)
        self.assertEqual(wrong("python/core/step.hpp", "#include <Eigen/Dense>"), 1)
        self.assertEqual(wrong("tests/unit/a_test.cpp", '#include "cases/runner/input/case.hpp"'), 0)

    def test_every_file_stands_in_a_room(self):
        files = [path.relative_to(ROOT).as_posix() for path in sources(".hpp", ".cpp", places=FLOORS)]
        self.assertEqual([file for file in files if room_of(file) not in ROOMS], [])
        self.assertEqual(room_of("src/shape.cpp"), "src")  # src is not a room

    def test_includes_never_run_up_a_floor(self):
        wrong = []
        for path in sources(".hpp", ".cpp"):
            text = path.read_text(encoding="utf-8")
            wrong += misplaced_includes(path.relative_to(ROOT).as_posix(), text)
        self.assertEqual(wrong, [])

    def test_every_header_is_read_once(self):
        wrong = [
            path.relative_to(ROOT).as_posix()
            for path in sources(".hpp")
            if len(re.findall(r"^#pragma once$", path.read_text("utf-8"), re.MULTILINE)) != 1
        ]
        self.assertEqual(wrong, [])

    def test_few_places_ask_whether_a_body_is_partitioned(self):
        """Each such branch is code that ranks or one rank alone run. The index map has an answer without it."""
        asking = lines_with(r"is_whole\(\)|if \(numbering_?\b|!numbering_?\b|\bnumbering_? (\?|&&)", outside=("src/parallel",))
        self.assertLessEqual(len(asking), PARTITION_BRANCHES, asking)

    def test_few_places_know_the_models(self):
        """A new model has to be added to each of them."""
        asking = [
            line
            for line in lines_with(r"MaterialModel::\w|\bis_(convolved|collocated|polynomial|cpd|lps)\(|\bhas_states\(")
            if not line.startswith("solvers/formulations/")
        ]
        self.assertLessEqual(len(asking), MODEL_BRANCHES, asking)

    def test_no_test_runs_in_two_files(self):
        """A class that a file imports from another runs there again, with its tests; so do its subclasses."""
        with_tests = {}
        for path in ROOT.glob("tests/*/**/*_test.py"):
            for name, body in re.findall(r"^class (\w+)\(.*\n((?:[ \t].*\n|\n)*)", path.read_text(), re.MULTILINE):
                if "    def test_" in body:
                    with_tests[path.stem, name] = path
        self.assertGreater(len(with_tests), 100)
        for path in ROOT.glob("tests/*/**/*_test.py"):
            for module, names in re.findall(r"^from [\w.]*?(\w+) import (.+)", path.read_text(), re.MULTILINE):
                again = [name for name in re.findall(r"\w+", names) if (module, name) in with_tests]
                self.assertEqual(again, [], path)

    def test_the_code_is_formatted(self):
        program = shutil.which("clang-format-" + CLANG_FORMAT_VERSION) or shutil.which(
            "clang-format"
        )
        self.assertTrue(program, "clang-format is missing")
        version = subprocess.run([program, "--version"], capture_output=True, text=True).stdout
        if f"version {CLANG_FORMAT_VERSION}." not in version:
            self.skipTest(f"clang-format {CLANG_FORMAT_VERSION} is wanted, here is {version}")

        def check_format(paths):
            command = [program, "--dry-run", "-Werror", "--style=file", *paths]
            checked = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
            return checked.stderr if checked.returncode else ""

        files = [path.relative_to(ROOT).as_posix() for path in sources(".hpp", ".cpp")]
        size = 50  # starting the program takes longer than formatting a file
        wrong = in_parallel(check_format, [files[k : k + size] for k in range(0, len(files), size)])
        self.assertFalse(wrong, f"run {program} -i on the files of\n" + "\n".join(wrong))


if __name__ == "__main__":
    unittest.main()
