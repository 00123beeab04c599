"""An installed peristat, as in a package: its launcher runs cases and draws their pictures from
any folder, without the sources, and writes nothing into its own folders."""

import os
import pathlib
import re
import tempfile
import unittest

from tests.acceptance.folder import Folder
from tests.acceptance.strip import PULLED
from tests.reference.program import PROGRAM, ROOT, execute

BUILD = pathlib.Path(PROGRAM).parent
CASE = PULLED + "[loading]\nsteps = 2\n"


def lines(*command, **options):
    ended = execute(command, **options)
    assert ended.code == 0, ended.said
    return ended.output.splitlines()


class Package(Folder):
    @classmethod
    def setUpClass(cls):
        # Staged, as for packages: the staging folder and the prefix differ.
        stage = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory(prefix="peristat package "))).resolve()
        execute([ROOT / "peristat", "report", stage], limited=False, seconds=300)  # builds the program of the pages
        lines("cmake", "--install", BUILD, "--prefix", "/usr", environment={"DESTDIR": str(stage)})
        cls.prefix = stage / "usr"
        cls.launcher = cls.prefix / "bin/peristat"

    def setUp(self):
        super().setUp()
        self.write("strip.toml", CASE)

    def launch(self, *arguments, **environment):
        return self.execute([self.launcher, *arguments], environment={"OMP_NUM_THREADS": "1"} | environment)

    def installed(self):
        return {path: path.lstat().st_mtime_ns for path in self.prefix.rglob("*")}

    def test_a_run_draws_its_pictures_and_leaves_the_installation_alone(self):
        before = self.installed()
        run = self.launch("run", "strip.toml", "--output", "results/strip")
        self.assertEqual((run.code, run.errors), (0, ""))
        self.assert_completed(self.launch("plot", "results/strip"))
        self.assert_completed(self.launch("report", "results/strip"))
        sweep = self.launch("sweep", "strip.toml", "--vary", "material.youngs_modulus=1e9,2e9", "--output", "moduli")
        self.assert_completed(sweep)
        self.assert_completed(self.launch("fit", "--help"))

        self.assertTrue((self.folder / "results/strip/results.h5").is_file())
        self.assertGreater(len(list((self.folder / "results/strip/plots").glob("*.png"))), 1)
        self.assertTrue((self.folder / "results/strip/report.html").is_file())
        self.assertTrue(list((self.folder / "moduli").glob("*.png")))
        self.assertEqual(self.installed(), before)

    def python(self, code, **environment):
        return self.launch("python", "-c", f"import peristat as ps; {code}", PYTHONDONTWRITEBYTECODE="1", **environment)

    def test_python_has_the_package_and_solves(self):
        before = self.installed()
        code = "run = ps.load_case('strip.toml').solve(output='python', quiet=True, threads=1); print(run.status, run.dimension)"
        told = self.python(code)
        self.assertEqual((told.output, told.errors, told.code), ("completed 2\n", "", 0))
        self.assert_completed(self.launch("run", "strip.toml", "--output", "program", "--no-plots", "--threads", "1"))
        python, program = (self.folder / name / "history.csv" for name in ("python", "program"))
        self.assertGreater(len(python.read_text().splitlines()), 2)
        self.assertEqual(python.read_text(), program.read_text())

        code = "from peristat import _package as p; print(p.load_core().__file__, ps.__file__, sep='\\n')"
        files = [pathlib.Path(line).relative_to(self.prefix / "lib/python3/dist-packages") for line in self.python(code).output.splitlines()]
        self.assertEqual([str(file.parent) for file in files], ["peristat", "peristat"])
        self.assertTrue((self.prefix / "lib/python3/dist-packages/peristat/py.typed").is_file())
        self.assertEqual(self.installed(), before)

    def test_errors_cross_the_border_to_python(self):
        """Exceptions are thrown in the library and caught in the module."""
        told = self.python("case = ps.load_case('strip.toml'); case.set('loading.steps', -1); case.resolved()")
        self.assertEqual(told.code, 1)
        self.assertRegex(told.errors.splitlines()[-1], r"^peristat\.errors\.InputError: .*steps = -1")

    def test_every_module_is_found(self):
        as_root = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}

        def loaded(module, run):
            self.assertEqual(run.code, 0, run.errors[-2000:])
            (file,) = set(re.findall(rf"calling init: (.*/peristat_{module}\.so)", run.errors))
            self.assertEqual(pathlib.Path(os.path.normpath(file)).parent.name, "peristat")
            self.assertTrue(pathlib.Path(file).resolve().is_relative_to(self.prefix), file)

        for module, options in (("trilinos", ["--set", "solver.linear=pcg"]), ("mumps", ["--set", "solver.mode=arc_length"]),
                                ("ranks", ["--ranks", "2"])):  # fmt: skip
            with self.subTest(module=module):
                run = self.launch("run", "strip.toml", "--no-plots", "--output", module, *options, LD_DEBUG="files", **as_root)
                loaded(module, run)
        for module, key, value in (("trilinos", "solver.linear", "pcg"), ("mumps", "solver.mode", "arc_length")):
            with self.subTest(module=module, of="python"):
                code = f"case = ps.load_case('strip.toml'); case.set({key!r}, {value!r}); case.solve(output='python_{module}')"
                loaded(module, self.python(code, LD_DEBUG="files"))

    def test_no_wide_vector_crosses_between_program_and_library(self):
        """A package compiles both for different processors (docs/installing.md#processors)."""
        wide = re.compile(r"simd|__vector|Eigen::")  # Eigen's memory layout also differs
        library = lines("nm", "-C", "--defined-only", "--dynamic", BUILD / "libperistat.so")
        self.assertTrue(any(map(wide.search, library)))  # the library uses some itself
        objects = [BUILD / "libperistat_runner.a", *BUILD.glob("CMakeFiles/peristat_python.dir/python/core/*.o")]
        self.assertGreater(len(objects), 5)
        taken = [line for line in lines("nm", "-C", "--undefined-only", *objects) if " U peristat::" in line]
        self.assertGreater(len(taken), 100)
        self.assertEqual([line for line in taken if wide.search(line)], [])

    def test_the_library_calls_its_own_copies(self):
        """A program also exports templates that it has compiled, perhaps for another processor."""
        library = BUILD / "libperistat.so"
        own = {words[2] for words in map(str.split, lines("nm", "--dynamic", "--defined-only", library)) if words[1] in "TW"}
        asked = [words[4].partition("@")[0] for words in map(str.split, lines("readelf", "-rW", library)) if len(words) > 4]
        self.assertIn("dlopen", asked)
        self.assertGreater(len(own), 100)
        self.assertEqual(own.intersection(asked), set())

    def test_the_loader_finds_every_library(self):
        binaries = [path for path in self.prefix.rglob("*") if path.is_file() and path.read_bytes()[:4] == b"\x7fELF"]
        names = {path.name for path in binaries}
        self.assertTrue(any(name.startswith("_core.") for name in names))
        self.assertLessEqual({"peristat", "peristat_trilinos.so", "peristat_ranks.so", "peristat_mumps.so"}, names)
        for binary in binaries:
            found = "\n".join(lines("ldd", binary))
            self.assertIn("=>", found)
            self.assertNotIn("not found", found, binary)
            self.assertNotIn(str(ROOT), found, binary)  # nothing of the build folder is needed

    def test_the_shipped_cases_come_along(self):
        shipped = lambda folder: {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*.toml")}
        cases = shipped(self.prefix / "share/peristat/cases")
        self.assertIn("plate_with_hole/elastic.toml", cases)
        self.assertEqual(cases, shipped(ROOT / "cases"))
        for case, text in cases.items():
            schema = text.decode().partition("\n")[0].removeprefix("#:schema ")
            self.assertTrue((self.prefix / "share/peristat/cases" / case).parent.joinpath(schema).is_file(), case)

    def test_the_help_names_what_can_be_typed(self):
        told = self.launch("help").output
        self.assertNotIn("./peristat", told)
        listed = set(re.findall(r"^  peristat ([a-z-]+)", told, re.MULTILINE))
        self.assertLessEqual({"run", "resume", "check", "sweep", "fit", "trust", "plot", "report", "python", "help"}, listed)
        self.assertTrue(listed.isdisjoint({"build", "test", "bench", "package", "site"}))
        first = re.search(r"Start with: peristat run (.*)", told)[1]
        self.assert_completed(self.launch("check", first))
        self.assert_completed(self.launch("trust", "--help"))
        version = re.search(r"project\(peristat VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text("utf-8"))[1]
        self.assertEqual(self.launch("version").output, f"peristat {version}\n")

    def test_what_needs_the_sources_is_refused(self):
        for command in ("build", "test", "bench", "package", "site"):
            refused = self.launch(command)
            self.assert_refused(refused, f"{command} needs peristat's sources")
            self.assertEqual(refused.output, "")


if __name__ == "__main__":
    unittest.main()
