"""The launcher forwards, draws pictures and passes interrupts on; here to a stand-in program."""

import os
import pathlib
import re
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]

# Prints its arguments; writes the results folder's path to the note; `run wait` waits for interrupts and counts those
# of the next half second; `run write` writes states; `run end CODE` ends with that code; `run talk` keeps printing.
PROGRAM = r"""#!/usr/bin/env bash
printf '[%s]' "$@"; echo
[[ ${PERISTAT_NOTE-} ]] && echo "$PWD/some results" >"$PERISTAT_NOTE"
if [[ ${2-} == wait ]]; then
  interrupts=0
  trap 'interrupts=$((interrupts + 1))' INT
  echo ready
  for ((i = 0; i < 300 && interrupts == 0; i++)); do sleep 0.1; done
  for ((i = 0; i < 5; i++)); do sleep 0.1; done
  echo "interrupts=$interrupts"
  exit 130
fi
if [[ ${2-} == talk ]]; then
  trap '' PIPE
  for ((i = 0; i < 20; i++)); do echo "$i" 2>/dev/null; sleep 0.02; done
  touch talked
fi
if [[ ${2-} == write ]]; then
  for ((i = 1; i <= 6; i++)); do mkdir -p "some results/parts" && touch "some results/parts/00000$i.h5" && sleep 0.7; done
fi
[[ ${2-} == end ]] && exit "$3"
exit 0
"""
PLOT = """import sys
folder = sys.argv[1] if sys.argv[1] != "-" else sys.stdin.readline().strip()
if folder:
    print("pictures of", folder)
sys.exit(len(sys.argv) > 2)
"""
SWEEP = """import os, sys
print("sweep", sys.argv[1:], os.environ["PERISTAT_PROGRAM"])
sys.exit(3)
"""
# dpkg-query that reports every requested package as installed
PACKAGES_ARE_THERE = r'''for name; do [[ $name == -* ]] || printf "|%s installed|" "$name"; done'''


class Launcher(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="peristat launcher ")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name).resolve()
        root = self.folder / "house"
        for part in ["src", "assembly", "solvers", "python/core", "python/peristat/pictures", "cases/runner/sweep", "cases/runner/fit", "cases/runner/trust", "cmake", "build/release"]:
            (root / part).mkdir(parents=True)
        for name in ["peristat", "CMakeLists.txt", "CMakePresets.json"]:
            shutil.copy(ROOT / name, root)
        (root / "python/peristat/pictures/__main__.py").write_text(PLOT)
        (root / "cases/runner/sweep/sweep.py").write_text(SWEEP)
        (root / "cases/runner/fit/fit.py").write_text(SWEEP.replace('"sweep"', '"fit"'))
        (root / "cases/runner/trust/trust.py").write_text(SWEEP.replace('"sweep"', '"trust"'))
        (root / "build/release/peristat").write_text(PROGRAM)
        (root / "build/release/peristat").chmod(0o755)
        (root / "build/release/.built").touch()
        self.launcher = root / "peristat"
        self.root = root

    def launch(self, *arguments, launcher=None, **environment):
        return subprocess.run(
            [launcher or self.launcher, *arguments],
            cwd=self.folder,
            env=os.environ | environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
        )

    def test_arguments_reach_the_program_unchanged(self):
        result = self.launch("check", "a case.toml", "--set", "title=two words", "")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("[check][a case.toml][--set][title=two words][]", result.stdout)

    def test_a_link_to_the_launcher_finds_the_program(self):
        link = self.folder / "link"
        link.symlink_to(self.launcher)
        self.assertIn("[check][x]", self.launch("check", "x", launcher=link).stdout)

    def test_a_run_draws_its_pictures(self):
        result = self.launch("run", "case.toml")
        self.assertIn(f"pictures of {self.folder}/some results", result.stdout)

    def test_no_plots_is_taken_by_the_launcher(self):
        result = self.launch("run", "case.toml", "--no-plots", "--threads", "1")
        self.assertIn("[run][case.toml][--threads][1]", result.stdout)
        self.assertNotIn("pictures", result.stdout)

    def test_pictures_are_drawn_on_the_way(self):
        drawn = self.folder / "drawn"
        counting = f"open({str(drawn)!r}, 'a').write('drawn ')\n"
        (self.root / "python/peristat/pictures/__main__.py").write_text(counting + PLOT)
        result = self.launch("run", "write", "--plots-every", "2", "--threads", "1")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertIn("[run][write][--threads][1]", result.stdout)
        self.assertEqual(result.stdout.count("pictures of"), 1)  # intermediate drawings are not reported
        self.assertGreaterEqual(len(drawn.read_text().split()), 3)
        drawn.unlink()
        shutil.rmtree(self.folder / "some results")
        self.launch("run", "case.toml", "--plots-every", "1")
        self.assertEqual(len(drawn.read_text().split()), 1)
        for wrong in (["0"], ["two"], []):
            result = self.launch("run", "case.toml", "--plots-every", *wrong)
            self.assertEqual(result.returncode, 2)
            self.assertIn("--plots-every", result.stderr)

    def test_the_exit_code_is_the_programs(self):
        (self.folder / "some results").mkdir()
        (self.folder / "some results/results.h5").touch()
        for code, pictures in [(0, True), (1, False), (2, False), (3, True), (4, False), (5, True)]:
            result = self.launch("run", "end", str(code))
            self.assertEqual(result.returncode, code)
            self.assertEqual("pictures" in result.stdout, pictures, code)

    def test_a_folder_that_is_gone_has_no_pictures(self):
        result = self.launch("run", "end", "5")
        self.assertEqual((result.returncode, result.stderr), (5, ""))
        self.assertNotIn("pictures", result.stdout)

    def test_no_folder_for_temporary_files_is_needed(self):
        result = self.launch("run", "case.toml", TMPDIR="/nowhere")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertIn(f"pictures of {self.folder}/some results", result.stdout)

    def test_closed_streams_are_opened_before_anything_else(self):
        (self.root / "build/release/peristat").write_text(
            '#!/usr/bin/env bash\nfor fd in 0 1 2; do readlink /proc/$$/fd/$fd; done >"$2"\n'
        )
        script = f"exec '{self.launcher}' check streams <&- >&- 2>&-"
        self.assertEqual(subprocess.run(["sh", "-c", script], cwd=self.folder).returncode, 0)
        streams = (self.folder / "streams").read_text().splitlines()
        self.assertEqual((streams[0], streams[2]), ("/dev/null", "/dev/null"))

    def test_who_stops_reading_stops_neither_the_run_nor_its_pictures(self):
        script = f"'{self.launcher}' run talk | head -1; exit \"${{PIPESTATUS[0]}}\""
        (self.root / "python/peristat/pictures/__main__.py").write_text(PLOT.replace("sys.exit", 'open("drawn", "w"); sys.exit'))
        result = subprocess.run(["bash", "-c", script], cwd=self.folder, capture_output=True, text=True, timeout=60)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertTrue((self.folder / "talked").exists())
        self.assertTrue((self.folder / "drawn").exists())

    def test_a_program_that_the_system_does_not_start(self):
        (self.root / "build/release/peristat").write_text("#!/nowhere/interpreter\n")
        for command in ["run", "check"]:
            result = self.launch(command, "case.toml")
            self.assertEqual(result.returncode, 5)
            self.assertIn("limits of the shell", result.stderr)
        limited = ["bash", "-c", f"ulimit -v 4000000; '{self.launcher}' run case.toml"]
        self.assertEqual(subprocess.run(limited, cwd=self.folder, capture_output=True).returncode, 4)

    def test_a_failing_plot_changes_no_exit_code(self):
        (self.root / "python/peristat/pictures/__main__.py").write_text("raise SystemExit(1)")
        result = self.launch("run", "case.toml")
        self.assertEqual(result.returncode, 0)
        self.assertIn("could not be drawn", result.stderr)

    def test_the_suite_knows_the_program(self):
        result = self.launch("trust", "surfing", "--quick")
        self.assertTrue(result.stdout.startswith("trust ['surfing', '--quick'] "), result.stdout)
        self.assertIn("trust ['--help']", self.launch("help", "trust").stdout)

    def python(self, *arguments, **environment):
        """./peristat python with a package that names its folder, as if its compiled part had been built."""
        (self.root / "python/peristat/__init__.py").write_text("import pathlib; HERE = pathlib.Path(__file__).parent\n")
        (self.root / "build/release/_core.cpython-311-x86_64-linux-gnu.so").touch()
        return self.launch("python", *arguments, **environment)

    def test_python_has_the_package(self):
        code = "import sys, peristat, os; print(peristat.HERE, sys.executable, sys.argv[1:], os.environ['PERISTAT_LAUNCHER'])"
        expected = f"{self.root}/python/peristat /usr/bin/python3 ['two words', ''] {self.launcher}\n"
        (self.folder / "a script.py").write_text(code)
        for started in (["-c", code], ["a script.py"]):
            result = self.python(*started, "two words", "")
            self.assertEqual((result.stdout, result.stderr, result.returncode), (expected, "", 0))
        self.assertEqual(self.python("-c", "import sys; sys.exit(7)").returncode, 7)
        self.assertIn("./peristat python [SCRIPT", self.launch("help", "python").stdout)

    def test_python_keeps_the_path_of_its_user(self):
        (self.folder / "own.py").write_text("print('own')")
        self.assertEqual(self.python("-c", "import own, peristat", PYTHONPATH=str(self.folder)).stdout, "own\n")

    def test_a_script_of_python_in_the_background_can_be_interrupted(self):
        code = "import signal; print(signal.getsignal(signal.SIGINT) is signal.default_int_handler)"
        self.python("-c", "")
        script = f"'{self.launcher}' python -c '{code}' & wait $!"
        self.assertEqual(subprocess.run(["sh", "-c", script], capture_output=True, text=True).stdout, "True\n")

    def test_a_sweep_knows_the_program(self):
        result = self.launch("sweep", "a case.toml", "--vary", "x=1,2")
        self.assertEqual(result.returncode, 3, result.stderr)
        program = self.root / "build/release/peristat"
        self.assertEqual(result.stdout, f"sweep ['a case.toml', '--vary', 'x=1,2'] {program}\n")
        self.assertIn("sweep ['--help']", self.launch("help", "sweep").stdout)

    def test_a_fit_knows_the_program_and_its_packages(self):
        result = self.launch("fit", "a case.toml", "--over", "x")
        program = self.root / "build/release/peristat"
        self.assertEqual((result.stdout, result.returncode), (f"fit ['a case.toml', '--over', 'x'] {program}\n", 3), result.stderr)
        self.assertIn("fit ['--help']", self.launch("help", "fit").stdout)

    def test_help_of_a_command_is_the_commands(self):
        self.assertIn("[run][--help]", self.launch("help", "run").stdout)
        self.assertIn("pictures of --help", self.launch("help", "plot").stdout)
        self.assertIn("peristat bench", self.launch("help", "bench").stdout)
        result = self.launch("help", "chekc")
        self.assertEqual(result.returncode, 2)
        self.assertIn('did you mean "check"?', result.stderr)

    def test_an_interrupt_reaches_the_program_once(self):
        to_launcher = lambda process: process.send_signal(signal.SIGINT)
        to_group = lambda process: os.killpg(process.pid, signal.SIGINT)
        for interrupt in [to_launcher, to_group]:
            process = subprocess.Popen(
                [self.launcher, "run", "wait"],
                stdout=subprocess.PIPE,
                text=True,
                start_new_session=True,
                cwd=self.folder,
            )
            while process.stdout.readline() != "ready\n":
                self.assertIsNone(process.poll())
            interrupt(process)
            output = process.communicate(timeout=60)[0]
            self.assertEqual(process.returncode, 130)
            self.assertIn("interrupts=1\n", output)
            self.assertIn("pictures of", output)

    def test_an_interrupt_reaches_the_background_job_of_a_script(self):
        script = f"'{self.launcher}' run wait >log & "
        script += "until grep -qs ready log; do sleep 0.1; done; kill -INT $!; wait $!"
        result = subprocess.run(["sh", "-c", script], cwd=self.folder, timeout=60)
        self.assertEqual(result.returncode, 130)
        self.assertIn("interrupts=1\n", (self.folder / "log").read_text())

    def test_a_killed_launcher_leaves_no_program_behind(self):
        process = subprocess.Popen(
            [self.launcher, "run", "wait"], stdout=subprocess.PIPE, text=True, cwd=self.folder
        )
        while process.stdout.readline() != "ready\n":
            self.assertIsNone(process.poll())
        started = time.monotonic()
        process.kill()
        process.communicate(timeout=60)  # ends when the last holder of the pipe ends
        self.assertLess(time.monotonic() - started, 10, "the program waits 30 s by itself")

    # ---- building, and continuous integration -----------------------------------------------------

    def build_with(self, cmake):
        """./peristat build with a script in place of cmake; nothing is installed."""
        tools = self.folder / "tools"
        tools.mkdir(exist_ok=True)
        for name, text in {"cmake": cmake, "dpkg-query": PACKAGES_ARE_THERE}.items():
            (tools / name).write_text("#!/usr/bin/env bash\n" + text)
            (tools / name).chmod(0o755)
        (self.root / "build/release/.built").unlink(missing_ok=True)
        return self.launch("build", PATH=f"{tools}:{os.environ['PATH']}")

    def test_a_build_shows_how_far_it_is_and_the_time_left(self):
        result = self.build_with('for ((k = 1; k <= 40; k++)); do ((k == 24)) && sleep 6; echo "[$k/40] Building $k.o"; done')
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stderr, r"built 4 of 40, \d+ s\n(.*\n)*.*built 24 of 40, 6 s, 4 s left\n(.*\n)*.*built 40 of 40")
        self.assertEqual(result.stderr.count(" of 40"), 10)
        self.assertEqual((self.root / "build/release/build.log").read_text().count("Building"), 2 * 40)

    def test_a_terminal_shows_a_bar(self):
        self.build_with('for ((k = 1; k <= 10; k++)); do echo "[$k/10] Building $k.o"; done')
        environment = os.environ | {"PATH": f"{self.folder / 'tools'}:{os.environ['PATH']}"}
        typescript = subprocess.run(["script", "-qec", f"'{self.launcher}' build", "/dev/null"], env=environment,
                                    stdin=subprocess.DEVNULL, capture_output=True, text=True).stdout  # fmt: skip
        self.assertIn("built [" + 15 * "#" + 15 * " " + "] 5 of 10", typescript)

    def test_a_build_of_the_program_takes_along_the_modules_that_are_there(self):
        echo = 'echo "$@" >>cmake_calls'
        (self.root / "build/release/peristat_mumps.so").touch()
        self.build_with(echo)
        self.launch("check", "x", PATH=f"{self.folder / 'tools'}:{os.environ['PATH']}")  # which is up to date
        first = (self.root / "cmake_calls").read_text()
        (self.root / "src/changed.cpp").touch()
        self.launch("check", "x", PATH=f"{self.folder / 'tools'}:{os.environ['PATH']}")
        calls = (self.root / "cmake_calls").read_text()
        self.assertTrue(calls.startswith(first))
        self.assertRegex(first, "--target peristat peristat_trilinos peristat_ranks peristat_mumps")
        self.assertTrue(calls.endswith("--target peristat peristat_mumps\n"), calls)

    def test_the_package_of_python_is_built_at_its_first_use_and_with_the_program(self):
        self.build_with('echo "$@" >>cmake_calls')
        calls, tools = self.root / "cmake_calls", {"PATH": f"{self.folder / 'tools'}:{os.environ['PATH']}"}
        self.assertIn("peristat_library peristat_python\n", calls.read_text())  # ./peristat build
        self.launch("python", "-c", "", **tools)
        first = calls.read_text()
        self.assertTrue(first.endswith("--target peristat peristat_python\n"), first)
        self.python("-c", "", **tools)  # which is there and up to date
        self.assertEqual(calls.read_text(), first)
        for used in (["check", "x"], ["python", "-c", ""]):  # an old one must not be loaded
            (self.root / "python/core/changed.cpp").write_text(used[0])
            self.launch(*used, **tools)
            self.assertTrue(calls.read_text().endswith("--target peristat peristat_python\n"))
            self.assertGreater(len(calls.read_text()), len(first))
            first = calls.read_text()

    def test_a_module_is_built_alone_and_of_the_sources_of_the_program(self):
        self.build_with('echo "$@" >>cmake_calls')
        path = f"{self.folder / 'tools'}:{os.environ['PATH']}"
        result = self.launch("build", "peristat_mumps", PATH=path)
        self.assertEqual(result.returncode, 0, result.stderr)
        calls = (self.root / "cmake_calls").read_text()
        self.assertTrue(calls.endswith("--target peristat_mumps\n"), calls)
        (self.root / "src/changed.cpp").touch()
        result = self.launch("build", "peristat_mumps", PATH=path)
        self.assertEqual(result.returncode, 1)
        self.assertIn("the sources have changed", result.stderr)
        self.assertEqual((self.root / "cmake_calls").read_text(), calls)
        self.assertEqual(self.launch("build", "unheard_of", PATH=path).returncode, 2)

    def test_a_package_takes_no_arguments(self):
        result = self.launch("package", "extra")
        self.assertEqual((result.returncode, result.stderr), (2, "peristat: package takes no arguments\n"))

    def test_a_build_that_fails_tells_why(self):
        result = self.build_with('echo "[3/40] Building 3.o"; echo "FAILED: 3.o"; echo "3.cpp:1: error"; exit 1')
        self.assertEqual(result.returncode, 1)
        self.assertIn("3.cpp:1: error", result.stderr)
        self.assertFalse((self.root / "build/release/.built").exists())

    def run_ci(self, launcher, **environment):
        (self.root / ".ci").mkdir(exist_ok=True)
        shutil.copy(ROOT / ".ci/run", self.root / ".ci")
        self.launcher.write_text("#!/usr/bin/env bash\n" + launcher)
        return self.launch(launcher=self.root / ".ci/run", **environment)

    def test_what_has_no_time_is_incomplete_and_not_green(self):
        log = self.root / "build/release/build.log"
        log.write_text("[1/1] Building\n")
        complete = self.run_ci('echo "$@"')
        self.assertEqual(complete.returncode, 0, complete.stderr)
        self.assertEqual(complete.stdout.splitlines(), ["test -N", "test --all -E printed_(cases|tutorial)"])
        self.assertRegex(complete.stderr.splitlines()[-1], "no part of this run: numbers printed in long cases .* sanitizers")
        slow = self.run_ci('[[ $2 == -N ]] || exec sleep 20', PERISTAT_CI_SECONDS="1")
        self.assertEqual(slow.returncode, 75)
        self.assertRegex(slow.stderr.splitlines()[-1], r"^INCOMPLETE after \d+ s: not run in full: tests$")
        self.assertEqual(self.run_ci("exit 8").returncode, 8)
        log.write_text("a.cpp:1: warning: unused variable\n")
        self.assertEqual(self.run_ci("").returncode, 1)

    def test_the_verdict_has_tiers_that_exist(self):
        tiers = re.search(r"choice=\(-L '\^\((.*)\)\$'\) ;;", (ROOT / "peristat").read_text())[1].split("|")
        labels = (ROOT / "tests/CMakeLists.txt").read_text()
        for tier in tiers:
            self.assertRegex(labels, rf"(LABELS|IN ITEMS|set\(label) ([a-z ]* )?{tier}\b")

    def test_an_option_that_ctest_would_ignore_is_refused(self):
        result = self.launch("test", "--nonsense")
        self.assertEqual(result.returncode, 2)
        self.assertIn("--nonsense: not an option of CTest", result.stderr)

    def test_an_unknown_command_names_the_nearest_one(self):
        for given, meant in [("chekc", "check"), ("rnu", "run"), ("tests", "test")]:
            result = self.launch(given)
            self.assertEqual(result.returncode, 2)
            self.assertIn(f'did you mean "{meant}"?', result.stderr)
        result = self.launch("xyzzy")
        self.assertEqual(result.returncode, 2)
        self.assertNotIn("did you mean", result.stderr)

    def test_help_and_version_need_no_build(self):
        shutil.rmtree(self.root / "build")
        self.assertRegex(self.launch("version").stdout, r"^peristat \d+\.\d+\.\d+\n$")
        self.assertIn("check-tangent", self.launch("help").stdout)
        for command in ("sweep", "fit", "trust"):
            self.assertIn(f"{command} ['--help']", self.launch(command, "--help").stdout)
        self.assertEqual(self.launch().returncode, 2)
        self.assertFalse((self.root / "build").exists())


if __name__ == "__main__":
    unittest.main()
