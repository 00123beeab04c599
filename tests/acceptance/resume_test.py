"""A split run equals the uninterrupted run, to the last bit on one thread."""

import contextlib
import os
import random
import re
import shutil
import signal
import subprocess
import time
import unittest

import h5py
import numpy

from tests.acceptance.folder import Folder
from tests.acceptance.strip import LATTICE, PULLED
from tests.reference.program import PROGRAM, ROOT, limited_by_shell, settings
from tests.reference.results import table
from tests.same_results import differences

# Pulled in two.
TORN = LATTICE + """\
[material]
youngs_modulus = 200e9
[material.damage]
law = "tanh_continuous"
onset = 0.006
critical = 0.01
[[crack]]
from = [0.01, 0.006]
to = [0.01, 0.011]
[[support]]
set = "left"
displacement = [0, 0]
[[support]]
set = "right"
displacement = ["3e-4*load", 0]
[[probe]]
name = "pulled"
set = "right"
[[set]]
name = "middle"
where = "abs(x - 0.01) < 3e-3"
[[probe]]
name = "crack"
set = "middle"
field = "crack_length"
axis = "y"
[[probe]]
name = "resistance"
set = "middle"
field = "crack_resistance"
[loading]
steps = 10
[solver]
mode = "adaptive"
"""  # fmt: skip
# Differences from it for planes of symmetry, periods, rigid sets and loads other than supports.
HALF = TORN.replace("[0.01, 0.006]", "[0.01, 0.008]") + '[[symmetry]]\naxis = "y"\n'
CELL = """\
dimension = 2
[lattice]
spacing = 1e-3
thickness = 1e-3
shape = [{ add = "box", min = [0, 0], max = [0.024, 0.012] }]
[material]
youngs_modulus = 200e9
[material.damage]
law = "critical_stretch"
critical = 0.01
[[crack]]
from = [-0.003, 0]
to = [0.004, 0]
[[period]]
axis = "x"
from = 0
to = 0.024
gradient = [0, "free"]
[[period]]
axis = "y"
from = 0
to = 0.012
gradient = ["1e-3*load", "8.5e-3*load"]
[[set]]
name = "all"
where = "1"
[[probe]]
name = "crack"
set = "all"
field = "crack_length"
[loading]
steps = 6
[solver]
mode = "adaptive"
"""
RIGID = 'rigid=[{set="right", displacement=["3e-4*load", 0]}]'
LEFT = 'support=[{set="left", displacement=[0, 0]}]'
MODES = {
    "elastic": (PULLED, 0, ["loading.steps=6"]),
    "softening in implicit steps": (TORN, 3, ['solver.mode="newton"', "loading.smallest_step=1e-2",
                                              'material.damage={law="tanh",onset=0.002,critical=0.02}']),
    "relaxed steps": (TORN, 0, ['solver.mode="relaxation"']),
    "a load that moves": (TORN, 0, ['solver.mode="relaxation"', 'relaxation.load="moving"',
                                    "relaxation.iterations=2000"]),
    "hand-overs": (TORN, 0, []),
    "a stand-in": (TORN, 0, ["solver.elastic_horizon_ratio=2.015"]),
    "fragments that are held": (TORN, 0, ['support[1].displacement=["6e-4*load","free"]']),
    "fragments that are removed": (TORN, 0, ['support[1].displacement=["6e-4*load","free"]',
                                             'solver.fragments="remove"']),
    "continuum kinematics": (TORN, 0, ['material.model="cpd"', "material.poisson_ratio=0.35"]),
    "fields now and then": (TORN, 0, ["output.every=4"]),
    "cycles of the load": (TORN, 0, ['solver.mode="fatigue"', 'material.damage={law="critical_stretch",critical=0.05}',
                                     "fatigue={growth={coefficient=1e9,exponent=3},blocks=8}", "loading.steps=2",
                                     "output.every=3"]),
    "an iterative solver": (TORN, 0, ['solver.preconditioner="rigid_pieces"']),
    "a surrogate": (TORN, 0, ['solver.preconditioner="surrogate"']),
    "a plane of symmetry": (HALF, 0, []),
    "a cell": (CELL, 0, []),
    "a cell whose fields are written now and then": (CELL, 0, ["output.every=3"]),
    "a rigid set": (TORN, 0, [LEFT, RIGID]),
    "a roller": (TORN, 0, ['support=[{set="right", displacement=["3e-4*load", "free"]}]',
                           'rigid=[{set="left", displacement=[0, 0]}]',
                           'roller=[{name="foot", at=[0.015, 0], normal=[0, 1]}]']),
    "a temperature": (TORN, 0, ['temperature={change="-400*load*x/0.02"}', "material.thermal_expansion=1e-5"]),
    "a pressure": (TORN, 0, ['load=[{side="y-", pressure="2e8*load"}]']),
}  # fmt: skip


class Resumed(Folder):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "split"

    def whole(self, text=TORN, *changes, **options):
        return self.run_case(text, *changes, name="whole", **options)

    def stop(self, after, text=TORN, *changes, **options):
        """A run with the given number of steps done, and more to go."""
        self.run_case(text, *changes, name="split", words=("--stop-after", after), code=130, **options)

    def go_on(self, *changes, **options):
        return self.resume(self.out, *changes, **options)

    def steps(self, out=None):
        return sum(row["step"] > 0 for row in table((out or self.out) / "history.csv"))

    def is_as(self, whole):
        self.assertEqual(differences(whole, self.out), [])


class Split(Resumed):
    def test_every_mode_goes_on_as_if_nothing_had_been(self):
        for name, (text, code, changes) in MODES.items():
            with self.subTest(name):
                shutil.rmtree(self.out, ignore_errors=True)
                whole = self.whole(text, *changes, code=code)
                self.assertGreater(self.steps(whole), 4)
                self.stop(2, text, *changes)
                self.go_on(words=("--stop-after", self.steps(whole) // 2 - 1), code=130)
                self.go_on(code=code)
                self.is_as(whole)

    def test_from_every_other_accepted_step(self):
        whole = self.whole()
        for steps in range(1, self.steps(whole), 2):
            with self.subTest(steps):
                shutil.rmtree(self.out, ignore_errors=True)
                self.stop(steps)
                self.assertEqual(self.steps(), steps)
                self.go_on()
                self.is_as(whole)

    def test_killed_at_random_moments(self):
        """Kills between any two system calls, once the folder can be resumed."""
        started = time.monotonic()
        whole = self.whole()
        duration = time.monotonic() - started
        chance = random.Random(13)
        command = [PROGRAM, "run", self.case(TORN), "--output", self.out, "--threads", 1, "--quiet"]
        kills = 0
        for _ in range(40):
            process = self.start(command)
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(chance.uniform(0.05, 0.4 * duration))
            ended = process.poll()
            process.kill()
            errors = process.communicate()[1]
            if ended is not None:
                self.assertEqual(ended, 0, errors)
                break
            kills += 1
            if (self.out / "parts/checkpoint.0").exists() or "checkpoint" in self.members():
                command = [PROGRAM, "resume", self.out, "--threads", 1, "--quiet"]
            else:
                duration *= 1.1  # the machine has become slower
        self.assertGreater(kills, 2)
        if ended is None:
            self.go_on()
        self.is_as(whole)

    def members(self):
        try:
            with h5py.File(self.out / "results.h5") as file:
                return set(file)
        except OSError:
            return set()

    def test_signals_leave_a_checkpoint(self):
        whole = self.whole(PULLED, "loading.steps=150")
        for code in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(code):
                shutil.rmtree(self.out, ignore_errors=True)
                process = self.start([PROGRAM, "run", self.case(PULLED), "--output", self.out, "--threads", 1,
                                      "--set", "loading.steps=150"], stderr=subprocess.STDOUT)  # fmt: skip
                while not (self.out / "parts/checkpoint.0").exists():
                    self.assertIsNone(process.poll())
                    time.sleep(0.01)
                process.send_signal(code)
                said = process.communicate(timeout=60)[0]
                self.assertEqual(process.returncode, 130, said)
                self.go_on()
                self.is_as(whole)

    def test_other_numbers_of_threads_change_round_off_alone(self):
        """Until damage begins: from then on round-off decides which of two equal bonds breaks first."""
        whole = self.whole(PULLED, "loading.steps=6")
        self.stop(3, PULLED, "loading.steps=6", threads=2)
        self.go_on(threads=3)
        with h5py.File(whole / "results.h5") as one, h5py.File(self.out / "results.h5") as two:
            for step in one["steps"]:
                expected = one["steps"][step]["displacement"][...]
                error = abs(two["steps"][step]["displacement"][...] - expected).max()
                self.assertLess(error, 1e-11 * abs(expected).max())


class Extended(Resumed):
    def test_smaller_steps_lead_beyond_where_they_were_too_large(self):
        self.run_case(TORN, 'solver.mode="newton"', "loading.smallest_step=0.1", name="split", code=3)
        before = self.steps()
        self.go_on(code=3)  # the same attempt fails again
        self.assertEqual(self.steps(), before)
        self.go_on("loading.smallest_step=1e-4", code=3)
        self.assertGreater(self.steps(), before)

    def test_another_mode_goes_on_where_one_has_ended(self):
        self.run_case(TORN, 'solver.mode="newton"', "loading.smallest_step=1e-2", name="split", code=3)
        before = (self.out / "history.csv").read_text()
        self.assertTrue((self.out / "dossier.txt").exists())
        self.go_on('solver.mode="adaptive"')
        self.assertTrue((self.out / "history.csv").read_text().startswith(before))
        self.assertFalse((self.out / "dossier.txt").exists())
        with h5py.File(self.out / "results.h5") as file:
            self.assertNotIn("dossier", file)
            self.assertIn('mode = "adaptive"', file["case/as_resolved"][()].decode())

    def test_a_stand_in_is_replaced_in_mode_adaptive_alone(self):
        self.stop(1, TORN, "solver.elastic_horizon_ratio=2.015")
        for mode in ("newton", "relaxation"):
            ended = self.go_on(f"solver.mode={mode}", code=2)
            self.assertIn("the run still uses its elastic stand-in", ended.errors)
        self.go_on()

    def test_settings_of_all_sessions_hold(self):
        self.stop(2, TORN, "loading.steps=5", "output.every=2")
        self.go_on("loading.steps=8", words=("--stop-after", 2), code=130)
        self.go_on()
        with h5py.File(self.out / "results.h5") as file:
            resolved = file["case/as_resolved"][()].decode()
            self.assertIn("steps = 8", resolved)
            self.assertIn("every = 2", resolved)

    def test_a_finished_run_says_so(self):
        self.run_case(PULLED, "loading.steps=2", name="split")
        before = {path.name: path.read_bytes() for path in self.out.iterdir() if path.is_file()}
        self.assertIn("has reached its end: 2 steps, load factor 1", self.go_on().output)
        self.assertEqual(before, {path.name: path.read_bytes() for path in self.out.iterdir() if path.is_file()})


class Refused(Resumed):
    def setUp(self):
        super().setUp()
        self.stop(3)

    def refuses(self, words, *changes, out=None):
        before = {path: path.read_bytes() for path in self.folder.rglob("*") if path.is_file()}
        ended = self.resume(out or self.out, *changes, code=2)
        for word in [words] if isinstance(words, str) else words:
            self.assertIn(word, ended.errors)
        self.assertEqual(before, {path: path.read_bytes() for path in self.folder.rglob("*") if path.is_file()})

    def test_a_case_that_has_changed(self):
        self.case(TORN.replace("steps = 10", "steps = 12").replace("[loading]", "[loading]\nadaptive = false"))
        self.refuses(["case.toml: has changed since the run began", "loading.steps is 12, was 10",
                      "loading.adaptive is false, was true"])  # fmt: skip

    def test_a_remark_in_the_case_changes_nothing(self):
        self.case("# a remark\n" + TORN)
        self.go_on()

    def test_a_case_file_that_is_gone_is_taken_from_the_results(self):
        whole = self.whole()
        (self.folder / "case.toml").unlink()
        self.go_on()
        self.is_as(whole)

    def test_a_folder_that_was_moved(self):
        whole = self.whole()
        self.out = self.out.rename(self.folder / "elsewhere")
        self.go_on()
        self.is_as(whole)

    def test_settings_that_make_another_case(self):
        self.refuses(["--set = material.youngs_modulus=1e9: would change the case", "loading.steps"],
                     "material.youngs_modulus=1e9")  # fmt: skip
        self.refuses("output.directory=x: would change the case", "output.directory=x")

    def test_settings_that_are_wrong(self):
        self.refuses("loading.steps = 0", "loading.steps=0")

    def test_what_is_no_results_folder(self):
        (self.folder / "empty").mkdir()
        self.refuses("holds no run", out=self.folder / "empty")
        self.refuses("is not the results folder", out=self.folder / "none")
        self.refuses("is not the results folder", out=self.folder / "case.toml")

    def test_a_folder_that_another_run_writes(self):
        other = self.folder / "other"
        process = self.start([PROGRAM, "run", self.case(PULLED), "--output", other, "--quiet",
                              "--set", "loading.steps=20000"])  # fmt: skip
        while not (other / "parts/checkpoint.0").exists():
            time.sleep(0.01)
        self.assertIn(f"another run is writing to it (process {process.pid})", self.resume(other, code=2).errors)

    def test_a_run_without_an_accepted_step(self):
        other = self.run_case(PULLED.replace("*load", ""), "solver.max_iterations=1", "loading.adaptive=false",
                              name="other", code=3)  # step 0 fails # fmt: skip
        self.case(TORN)
        self.refuses("it has no accepted step", out=other)

    def change_checkpoint(self, change):
        with h5py.File(self.out / "results.h5", "r+") as file:
            data = change(bytearray(file["checkpoint"][...]))
            del file["checkpoint"]
            file["checkpoint"] = numpy.frombuffer(data, numpy.uint8)

    def test_an_older_layout(self):
        version = self.peristat("--version").output.split()[1]
        header = (ROOT / "cases/runner/results/checkpoint/checkpoint.hpp").read_text()
        layout = re.search(r"checkpoint_layout = (\d+);", header)[1]
        self.change_checkpoint(lambda data: data.replace(f"checkpoint {layout} {version}".encode(), b"checkpoint 0 0.0.7"))
        self.refuses(["layout 0 of peristat 0.0.7", f"this is peristat {version}, which resumes from layout {layout}"])

    def test_points_that_are_others(self):
        with h5py.File(self.out / "results.h5", "r+") as file:
            file["points/reference"][3, 1] += 1e-12
        self.refuses("its points differ from those that the case now makes")

    def test_sets_that_are_others(self):
        with h5py.File(self.out / "results.h5", "r+") as file:
            flags = file["points/sets/right"]
            flags[0] = 1 - flags[0]
        self.refuses("its points differ from those that the case now makes")

    def test_a_checkpoint_that_is_damaged(self):
        self.change_checkpoint(lambda data: data[:-1])
        self.refuses("its checkpoint is damaged: it is incomplete")
        self.change_checkpoint(lambda data: data + bytes([data[-1]]))
        self.change_checkpoint(lambda data: data[:-100] + bytes([data[-100] ^ 1]) + data[-99:])
        self.refuses("its checkpoint is damaged: its checksum is wrong")
        self.change_checkpoint(lambda data: data[:0])
        self.refuses("its checkpoint is damaged")

    def test_a_checkpoint_of_another_body(self):
        other = self.run_case(TORN, "lattice.spacing=2e-3", name="other", words=("--stop-after", 3), code=130)
        with h5py.File(self.out / "results.h5", "r+") as file, h5py.File(other / "results.h5") as source:
            del file["checkpoint"]
            source.copy("checkpoint", file)
        self.refuses("its checkpoint belongs to another body")

    def test_files_that_are_cut_or_changed_anywhere(self):
        """For any damage to results.h5, the run continues correctly, or reports that it can't."""
        whole = self.whole()
        kept = self.folder / "kept"
        shutil.copytree(self.out, kept)
        chance = random.Random(7)
        intact = (kept / "results.h5").read_bytes()
        outcomes = set()
        for trial in range(24):
            with self.subTest(trial):
                shutil.rmtree(self.out)
                shutil.copytree(kept, self.out)
                data = bytearray(intact)
                if trial % 4 == 0:
                    del data[chance.randrange(len(data)) :]
                else:
                    for _ in range(chance.choice([1, 1, 50])):
                        data[chance.randrange(len(data))] = chance.randrange(256)
                (self.out / "results.h5").write_bytes(data)
                ended = self.go_on(code=(0, 2))
                outcomes.add(ended.code)
                if ended.code == 0:  # the fields of earlier steps have no checksums; the later steps are correct
                    for name in ("history.csv", "decisions.csv", "broken_bonds.csv"):
                        rows = (self.out / name).read_text().splitlines()[4:]
                        self.assertEqual(rows, (whole / name).read_text().splitlines()[4:])
        self.assertEqual(outcomes, {0, 2})


class Faults(Resumed):
    def resume_within(self, blocks):
        """Under the shell's limit of file sizes, in units of 1024 bytes."""
        return self.execute(limited_by_shell(f"ulimit -f {blocks}", self.resuming()))

    def resuming(self):
        return [PROGRAM, "resume", self.out, "--threads", 1, "--quiet"]

    def test_whatever_can_not_be_written_the_run_goes_on_once_it_can(self):
        whole = self.whole(PULLED, "loading.steps=60")
        for limits in ([8], [64], [200], [8, 64, 200], [200, 400]):
            with self.subTest(limits):
                shutil.rmtree(self.out, ignore_errors=True)
                self.stop(20, PULLED, "loading.steps=60")
                for blocks in limits:
                    self.assert_code(self.resume_within(blocks), 5)
                self.go_on()
                self.is_as(whole)

    def test_two_at_once(self):
        whole = self.whole(PULLED, "loading.steps=60")
        self.stop(20, PULLED, "loading.steps=60")
        both = [self.start(self.resuming()) for _ in range(2)]
        self.assertIn(sorted(process.wait() for process in both), ([0, 0], [0, 2]))
        self.is_as(whole)


class LossOfPower(Resumed):
    def run_until_a_state_has_reached_the_disk(self, *changes):
        for _ in range(5):  # writes of others may keep the disk busy until the run has ended
            os.sync()
            shutil.rmtree(self.out, ignore_errors=True)
            process = self.start([PROGRAM, "run", self.case(PULLED), "--output", self.out, "--threads", 1, "--quiet",
                                  *settings(*changes)])  # fmt: skip
            while process.poll() is None:
                if (self.out / "parts/safe_checkpoint").exists():
                    return process
                time.sleep(0.01)
        self.fail("five runs have ended before anything was sure to be on the disk")

    def test_an_older_state_that_had_reached_the_disk_is_taken(self):
        changes = "loading.steps=160", "lattice.spacing=2e-4"  # takes some seconds
        whole = self.whole(PULLED, *changes)
        process = self.run_until_a_state_has_reached_the_disk(*changes)
        process.kill()
        process.wait()
        for name in ("results.h5", "parts/checkpoint.0", "parts/checkpoint.1", "history.csv"):
            (self.out / name).unlink()  # a file of the last moments, not the one that was synced
            (self.out / name).touch()
        self.assertIn("an older state, which is on the disk, is used instead", self.go_on().errors)
        self.is_as(whole)


if __name__ == "__main__":
    unittest.main()
