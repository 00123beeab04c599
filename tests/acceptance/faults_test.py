"""Faults of the machine, and files of other users and programs: no file of theirs is lost or
overwritten, every accepted step is kept and readable, and the exit code says what happened."""

import csv
import json
import os
import shutil
import signal
import time
import unittest

import h5py

from tests.acceptance.folder import Folder
from tests.acceptance.strip import PULLED
from tests.reference.program import PROGRAM, execute, limited_by_shell

PLAIN = {"results.h5", "results.xdmf", "results.vtkhdf", "history.csv", "load_displacement.csv", "iterations.csv",
         "decisions.csv", "broken_bonds.csv", "convergence.csv", "summary.json", "peristat.json"}  # fmt: skip

STRIP = 'title = "Strip"\n' + PULLED
LONG = ["--set", "loading.steps=20000"]  # a run that lasts until the test disturbs it
CAN_MOUNT = execute(["unshare", "-rm", "sh", "-c", "mount -t tmpfs tmpfs /mnt"]).code == 0
CANNOT_MOUNT = "this machine lets nobody mount a small disk: not tried what a full one does"
# root may write everywhere, so the run drops that right to meet a read-only folder
AS_ANYBODY = (["setpriv", "--bounding-set=-dac_override", "--inh-caps=-dac_override"]
              if os.geteuid() == 0 else [])  # fmt: skip


class Faults(Folder):
    def setUp(self):
        super().setUp()
        self.strip = self.write("strip.toml", STRIP)
        self.out = self.folder / "out"

    def words(self, *arguments, case=None):
        return [PROGRAM, "run", case or self.strip, "--output", self.out, "--threads", "1", *arguments]

    def run_strip(self, *arguments, **options):
        return self.execute(self.words(*arguments, **options))

    def limited(self, limits, *arguments):
        return self.execute(limited_by_shell(limits, self.words(*arguments)))

    def wait_for_steps(self, process, count=5):
        until = time.monotonic() + 60
        while self.steps() < count:
            self.assertIsNone(process.poll(), "it ended before anything could happen to it")
            self.assertLess(time.monotonic(), until)
            time.sleep(0.01)

    def steps(self, folder=None):
        try:
            return len((folder or self.out).joinpath("history.csv").read_text().splitlines()) - 2  # header, step 0
        except OSError:
            return 0

    def assert_readable(self, folder=None, at_least=0):
        """Every accepted step can be read; returns their number."""
        folder = folder or self.out
        with h5py.File(folder / "results.h5") as file:
            rows = list(file["history/step"][...])
            self.assertEqual(rows, list(range(len(rows))))
            steps = rows[1:]  # without step 0, for which the disk may have been full
            self.assertGreaterEqual(len(steps), at_least)
            self.assertEqual(sorted(file["steps"]), [f"{step:06d}" for step in steps])
            for step in file["steps"].values():
                self.assertTrue(abs(step["displacement"][...]).max() > 0.0)
        with open(folder / "history.csv", newline="") as table:
            rows = list(csv.DictReader(table))[1:]
        self.assertEqual([int(row["step"]) for row in rows], steps[: len(rows)])
        self.assertGreaterEqual(len(rows), len(steps) - 1)  # the disk was full between the two
        return len(steps)

    def assert_failed(self, folder=None):
        """The summary reports that the machine failed, the reason, and the number of steps."""
        folder = folder or self.out
        summary = json.loads((folder / "summary.json").read_text())
        self.assertEqual(summary["status"], "failed")
        self.assertIn("can't be", summary["reason"])
        self.assertEqual(summary["steps"], self.assert_readable(folder))

    def contents(self, folder):
        return {str(path.relative_to(folder)): path.read_bytes() if path.is_file() else None
                for path in folder.rglob("*")}  # fmt: skip

    # ---- files of others --------------------------------------------------------------------------

    def test_a_folder_with_files_of_others_is_refused_and_left_as_it_is(self):
        for name in ["summary.json", "history.csv", "results.h5", "plots/deformed.png", "peristat.json"]:
            shutil.rmtree(self.out, ignore_errors=True)
            self.write(f"out/{name}", "mine")
            before = self.contents(self.out)
            for option in [[], ["--overwrite"]]:
                self.assert_code(self.run_strip(*option), 2)
                self.assertEqual(self.contents(self.out), before)

    def test_a_new_run_of_the_case_removes_what_the_last_one_has_written_and_nothing_else(self):
        self.assert_code(self.run_strip(), 0)
        self.write("out/plots/.pictures", "deformed.png\ngone.png\n../notes.txt\n")
        for name in ["notes.txt", "plots/mine.png", "plots/crack.gif", "parts/mine.txt", "sweep.json"]:
            self.write(f"out/{name}", "mine")
        self.write("out/plots/deformed.png", "ours")
        self.assert_code(self.run_strip("--set", "loading.steps=3"), 0)
        self.assertEqual(self.assert_readable(), 3)
        for name in ["notes.txt", "plots/mine.png", "plots/crack.gif", "parts/mine.txt", "sweep.json"]:
            self.assertEqual((self.out / name).read_text(), "mine")
        self.assertFalse((self.out / "plots/deformed.png").exists())

    def test_results_of_another_case_are_replaced_on_demand_only(self):
        # Two cases in folders of the same name have the same default folder.
        first, second = self.write("a/bar/strip.toml", STRIP), self.write("b/bar/strip.toml", STRIP)
        run = lambda case, *options: self.execute([PROGRAM, "run", case, "--threads", "1", *options])
        self.assert_code(run(first), 0)
        folder = self.folder / "results/bar_strip"
        before = self.contents(folder)
        refused = run(second)
        self.assert_code(refused, 2)
        self.assertIn(str(first), refused.errors)
        self.assertIn("--overwrite", refused.errors)
        self.assertEqual(self.contents(folder), before)
        self.assert_code(run(second, "--overwrite", "--set", "loading.steps=2"), 0)
        self.assertEqual(self.assert_readable(folder), 2)
        self.assert_code(run(first), 2)
        # The same file by another path is the same case.
        (self.folder / "way").symlink_to(second.parent)
        self.assert_code(run(self.folder / "way/strip.toml", "--output", folder), 0)

    def test_results_of_version_1_are_replaced_on_demand_only(self):
        self.assert_code(self.run_strip(), 0)
        (self.out / "peristat.json").unlink()
        self.write("out/plots/deformed.png", "ours")
        self.write("out/plots/mine.png", "mine")
        before = self.contents(self.out)
        refused = self.run_strip()
        self.assert_code(refused, 2)
        self.assertIn("--overwrite", refused.errors)
        self.assertEqual(self.contents(self.out), before)
        self.assert_code(self.run_strip("--overwrite"), 0)
        self.assertFalse((self.out / "plots/deformed.png").exists())
        self.assertEqual((self.out / "plots/mine.png").read_text(), "mine")
        self.assert_code(self.run_strip(), 0)

    def test_links_in_the_folder_are_replaced_and_not_followed(self):
        self.assert_code(self.run_strip(), 0)
        victim = self.write("victim", "mine")
        for name in sorted(PLAIN - {"peristat.json"}):
            for link in [self.out / name, self.out / f"{name}.tmp"]:
                link.unlink(missing_ok=True)
                link.symlink_to(victim)
        self.write("out/plots/.pictures", "deformed.png\n")
        (self.out / "plots/deformed.png").symlink_to(victim)
        self.assert_code(self.run_strip(), 0)
        self.assertEqual(victim.read_text(), "mine")
        self.assertEqual({path.name for path in self.out.iterdir()}, PLAIN | {"plots"})
        self.assertFalse(any(path.is_symlink() for path in self.out.rglob("*")))

    def test_folders_and_a_marker_that_are_links_are_refused(self):
        for name in ["parts", "plots", "peristat.json"]:
            shutil.rmtree(self.out, ignore_errors=True)
            self.assert_code(self.run_strip("--overwrite"), 0)
            elsewhere = self.folder / f"elsewhere_{name}"
            if name == "peristat.json":
                (self.out / name).rename(elsewhere)
            else:
                self.write(f"elsewhere_{name}/000001.h5", "mine")
                self.write(f"elsewhere_{name}/.pictures", "000001.h5\n")
            (self.out / name).symlink_to(elsewhere)
            before = self.contents(self.folder)
            for option in [[], ["--overwrite"]]:
                self.assert_code(self.run_strip(*option), 2)
                self.assertEqual(self.contents(self.folder), before, name)

    def test_the_folder_itself_may_be_a_link(self):
        (self.folder / "big_disk").mkdir()
        self.out.symlink_to(self.folder / "big_disk")
        for _ in range(2):
            self.assert_code(self.run_strip(), 0)
        self.assert_readable(self.folder / "big_disk", 1)

    def test_a_folder_has_one_writer(self):
        first = self.start(self.words(*LONG))
        self.wait_for_steps(first)
        for option in [[], ["--overwrite"]]:
            second = self.run_strip(*option)
            self.assert_code(second, 2)
            self.assertIn(f"process {first.pid}", second.errors)
        self.assertIsNone(first.poll())
        first.send_signal(signal.SIGINT)
        first.communicate()
        self.assertEqual(first.returncode, 130)
        self.assert_readable(at_least=5)
        self.assert_code(self.run_strip(), 0)

    def test_of_runs_that_start_at_once_one_gets_the_folder(self):
        runs = [self.start(self.words(*LONG)) for _ in range(4)]
        for run in runs:
            run.wait_until = time.monotonic() + 60
        while sum(run.poll() is None for run in runs) > 1:
            self.assertLess(time.monotonic(), runs[0].wait_until)
            time.sleep(0.01)
        self.assertEqual(sorted(str(run.poll()) for run in runs), ["2", "2", "2", "None"])
        owner = next(run for run in runs if run.poll() is None)
        self.wait_for_steps(owner)
        owner.send_signal(signal.SIGTERM)
        owner.communicate()
        self.assertEqual(owner.returncode, 130)
        self.assert_readable(at_least=5)

    # ---- standard streams and signals -------------------------------------------------------------

    def test_closed_streams_get_into_no_file(self):
        for closed in ["<&-", ">&-", "2>&-", ">&- 2>&-", "<&- >&- 2>&-"]:
            run = self.limited(f"exec {closed}", "--set", "loading.steps=3")
            self.assert_code(run, 0)
            self.assertEqual(self.assert_readable(), 3)
            summary = json.loads((self.out / "summary.json").read_text())
            self.assertEqual(summary["status"], "completed")
            for path in self.out.glob("*.csv"):
                columns = {line.count(",") for line in path.read_text().splitlines()}
                self.assertTrue(path.name == "decisions.csv" or len(columns) == 1, path)

    def test_who_stops_reading_does_not_stop_the_run(self):
        command = self.words("--set", "loading.steps=200")
        run = self.execute(["bash", "-c", '"$@" | head -1; exit "${PIPESTATUS[0]}"', "bash", *command])
        self.assert_completed(run)
        self.assertEqual(len(run.output.splitlines()), 1)
        self.assertEqual(run.errors.count("standard output can't be written"), 1, run.errors)
        self.assertEqual(self.assert_readable(), 200)

    def test_a_full_disk_under_standard_output(self):
        # Commands other than run only produce output.
        for command, code in ((self.words(), 0), ([PROGRAM, "check", self.strip], 5)):
            ended = self.execute(limited_by_shell("exec >/dev/full", command))
            self.assert_code(ended, code)
            self.assertIn("No space left", ended.errors)

    def test_a_log_that_cannot_be_written_is_told_and_stops_nothing(self):
        run = self.run_strip("--log", "/dev/full")
        self.assert_code(run, 0)
        self.assertEqual(run.errors.count("the log can't be written"), 1, run.errors)

    def test_a_log_replaces_nothing_but_logs(self):
        self.assert_code(self.run_strip(), 0)
        foreign = self.write("notes.txt", "mine")
        (self.folder / "linked").symlink_to(foreign)
        (self.folder / "nowhere").symlink_to(self.folder / "new")
        os.link(self.out / "history.csv", self.folder / "second_name")
        places = [self.strip, foreign, "linked", "nowhere", "second_name", "out/history.csv", "out/new.txt", "out/parts/000001.h5"]
        before = self.contents(self.folder)
        for log in places:
            for command in (self.words("--log", log), [PROGRAM, "resume", self.out, "--log", log]):
                run = self.execute(command)
                self.assert_code(run, 2)
                self.assertIn("--log", run.errors)
                self.assertEqual(self.contents(self.folder), before, log)
        for again in range(2):
            self.assert_code(self.run_strip("--log", "log.txt"), 0)
            self.assertEqual((self.folder / "log.txt").read_text().count("# log of peristat\n"), 1)

    def test_a_log_does_not_take_the_place_of_an_input(self):
        """The input is a file of points, which may not exist yet."""
        for points in ("points.csv", "missing.csv"):
            self.write("cloud.toml", '[points]\nfile = "' + points + '"\nspacing = 1.0\n' + STRIP[STRIP.index("[material]"):])
            self.write("points.csv", "x, y, volume\n0, 0, 1\n1, 0, 1\n")
            before = self.contents(self.folder)
            run = self.run_strip("--log", points, case=self.folder / "cloud.toml")
            self.assert_code(run, 2)
            self.assertEqual(self.contents(self.folder), before)

    def test_results_do_not_take_the_place_of_other_files(self):
        """The other files are an input with the name of a result, and a table that no earlier run has written."""
        self.assert_code(self.run_strip(), 0)
        line = '[[probe]]\nname = "cut"\nfrom = [0.0, 0.0]\nto = [1.0, 0.0]\n'
        self.write("strip.toml", STRIP + line)
        self.write("out/line_cut.csv", "mine")
        before = self.contents(self.folder)
        run = self.run_strip("--overwrite")
        self.assert_code(run, 2)
        self.assertIn("line_cut.csv", run.errors)
        self.write("out/decisions.csv", STRIP)
        run = self.run_strip("--overwrite", case=self.out / "decisions.csv")
        self.assert_code(run, 2)
        self.assertIn("would replace it", run.errors)
        self.assertEqual({name: text for name, text in self.contents(self.folder).items() if "decisions" not in str(name)},
                         {name: text for name, text in before.items() if "decisions" not in str(name)})

    def test_a_closed_terminal_interrupts(self):
        run = self.start(self.words(*LONG))
        self.wait_for_steps(run)
        run.send_signal(signal.SIGHUP)
        run.communicate(timeout=60)
        self.assertEqual(run.returncode, 130)
        summary = json.loads((self.out / "summary.json").read_text())
        self.assertEqual((summary["status"], summary["steps"]), ("interrupted", self.assert_readable(at_least=5)))

    def test_nohup_is_respected(self):
        run = self.start(["nohup", *self.words(*LONG)])
        self.wait_for_steps(run)
        run.send_signal(signal.SIGHUP)
        self.wait_for_steps(run, self.steps() + 10)
        run.send_signal(signal.SIGTERM)
        run.communicate(timeout=60)
        self.assertEqual(run.returncode, 130)

    def test_a_killed_run_can_be_read_and_replaced(self):
        run = self.start(self.words(*LONG))
        self.wait_for_steps(run)
        run.kill()
        run.communicate()
        self.assert_readable(at_least=5)
        self.assertFalse((self.out / "summary.json").exists())
        self.assert_code(self.run_strip(), 0)
        self.assertEqual({path.name for path in self.out.iterdir()}, PLAIN)

    # ---- disks and limits -------------------------------------------------------------------------

    def on_small_disk(self, size, *arguments):
        """A run whose results folder is a disk of its own; its contents are then copied to `out`."""
        disk = self.folder / "disk"
        disk.mkdir(exist_ok=True)
        shutil.rmtree(self.out, ignore_errors=True)
        words = [disk if word == self.out else word for word in self.words(*arguments)]
        script = (f'mount -t tmpfs -o size={size} tmpfs "{disk}" && "$@"; code=$?; '
                  f'cp -r "{disk}" "{self.out}"; exit $code')  # fmt: skip
        return self.execute(["unshare", "-rm", "sh", "-c", script, "sh", *words])

    @unittest.skipUnless(CAN_MOUNT, CANNOT_MOUNT)
    def test_a_full_disk_keeps_every_accepted_step(self):
        counts = []
        for size in ["300k", "600k", "1m", "1500k"]:
            run = self.on_small_disk(size, *LONG)
            self.assert_code(run, 5)
            self.assertIn("No space left on device", run.errors)
            self.assert_failed()
            counts.append(self.assert_readable())
            self.assertIn(f"{counts[-1]} accepted step", run.errors)
        self.assertGreater(counts[-1], counts[0])

    @unittest.skipUnless(CAN_MOUNT, CANNOT_MOUNT)
    def test_a_disk_that_is_full_from_the_start(self):
        for size in ["4k", "16k", "64k"]:
            run = self.on_small_disk(size, *LONG)
            self.assert_code(run, 5)
            self.assertIn("No space left on device", run.errors)

    @unittest.skipUnless(CAN_MOUNT, CANNOT_MOUNT)
    def test_steps_that_cannot_be_gathered_stay_in_parts(self):
        for size in range(160, 1600, 40):  # some sizes fit the steps once but not twice
            run = self.on_small_disk(f"{size}k", "--set", "loading.steps=6")
            if run.code == 0:
                break
            self.assert_code(run, 5)
            if (self.out / "summary.json").exists():
                self.assert_failed()
            gathered = self.assert_readable() if (self.out / "results.h5").exists() else 0
        self.assert_code(run, 0)
        self.assertEqual(gathered, 6, "no size of the disk made the gathering fail")

    def test_a_limit_of_file_sizes(self):
        for blocks in [1, 8, 32, 64, 100, 200, 400]:
            shutil.rmtree(self.out, ignore_errors=True)
            run = self.limited(f"ulimit -f {blocks}", "--set", "loading.steps=2000")
            self.assert_code(run, 5)
            self.assertIn("File too large", run.errors)
        self.assert_failed()
        self.assert_readable(at_least=2)

    def test_a_limit_of_descriptors(self):
        codes = set()
        for count in [4, 5, 6, 7, 8, 9, 10, 12, 16, 24]:
            shutil.rmtree(self.out, ignore_errors=True)
            run = self.limited(f"ulimit -n {count}", "--set", "loading.steps=3")
            codes.add(run.code)
            self.assertIn(run.code, (0, 5), run.errors)
            if run.code == 5:
                self.assertIn("Too many open files", run.errors)
            if (self.out / "summary.json").exists() and run.code == 5:
                self.assert_failed()
        self.assertEqual(codes, {0, 5})

    def test_a_limit_of_the_address_space(self):
        codes = {}
        # Close enough to hit the few megabytes between the limits of one allocation and the next.
        for megabytes in [50, 100, 150, 200, *range(300, 560, 4), 600, 700, 900, 1200, 2000]:
            for linear in ["cholesky", "pcg"]:
                started = time.monotonic()
                words = [PROGRAM, "run", self.strip, "--threads", "2", "--set", f"solver.linear={linear}"]
                run = self.execute(limited_by_shell(f"ulimit -v {megabytes * 1000}", words))
                self.assertLess(time.monotonic() - started, 60)
                if megabytes == 50 and run.code == 127:  # the loader's own message; see launcher_test
                    continue
                self.assertIn(run.code, (0, 4), f"{megabytes} MB: {run.errors}")
                codes[megabytes, linear] = run.code
                if run.code == 4:
                    self.assertRegex(run.errors, r"address space|needs about .* are available|out of memory")
        self.assertEqual({codes[100, "pcg"], codes[300, "cholesky"]}, {4})
        self.assertEqual({codes[2000, "pcg"], codes[2000, "cholesky"]}, {0})

    def test_a_folder_that_is_removed_in_mid_run(self):
        run = self.start(self.words(*LONG))
        self.wait_for_steps(run)
        self.out.rename(self.folder / "moved")
        complaints = run.communicate(timeout=60)[1]
        self.assertEqual(run.returncode, 5, complaints)
        self.assertIn("has been removed", complaints)
        self.assert_readable(self.folder / "moved", 5)

    def test_a_folder_that_is_read_only_from_the_start(self):
        self.out.mkdir(mode=0o500)
        for words in [self.words(), [*self.words()[:4], self.out / "below"]]:
            run = self.execute([*AS_ANYBODY, *words])
            self.assert_code(run, 2)
            self.assertIn("can't be written", run.errors)

    def test_a_folder_that_becomes_read_only(self):
        run = self.start([*AS_ANYBODY, *self.words(*LONG)])
        self.wait_for_steps(run)
        for folder in [self.out / "parts", self.out]:
            folder.chmod(0o500)
        complaints = run.communicate(timeout=60)[1]
        self.assertEqual(run.returncode, 5, complaints)
        self.assertIn("Permission denied", complaints)
        self.assertIn("accepted steps are in", complaints)
        self.assert_readable(at_least=5)
        self.out.chmod(0o700)
        (self.out / "parts").chmod(0o700)

    def test_more_threads_than_make_sense(self):
        run = self.peristat("run", self.strip, environment={"OMP_NUM_THREADS": "999999"}, limited=False)
        self.assert_completed(run)
        run = self.run_strip("--threads", "100000")
        self.assert_code(run, 2)
        self.assertIn("--threads", run.errors)


if __name__ == "__main__":
    unittest.main()
