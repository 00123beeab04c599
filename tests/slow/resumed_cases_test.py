"""Shipped cases in every mode, killed on their way: a resumed run ends like an undisturbed one."""

import contextlib
import json
import os
import random
import subprocess
import time
import unittest

from tests.acceptance.folder import Folder
from tests.reference.program import PROGRAM, ROOT, settings
from tests.same_results import differences
from tests.shipped_runs import shipped_run

KILLS = 20
FRACTURE = ["plate_with_hole/square"]
if os.environ.get("PERISTAT_ALL_KILLS"):  # some minutes more
    FRACTURE += ["plate_with_hole/rectangle", "three_point_bending/notched", "four_holes/tension",
                 "three_point_bending/mouth_opening"]
# Few steps, which are split like many.
OTHERS = {
    "bar/tension": [],
    "cantilever/plate": [],
    "cantilever/beam": [],
    "plate_with_hole/elastic": [],
    "cpd/square": ["loading.steps=4"],
    "cpd/square_hole": ["loading.steps=4"],
    "cpd/cube": ["loading.steps=3", "lattice.spacing=0.125"],
    "cpd/cube_hole": ["loading.steps=3", "lattice.spacing=0.125"],
    "cpd/poisson_2d": ["loading.steps=4"],
    "cpd/poisson_3d": ["loading.steps=3"],
    "cpd/table3": ["loading.steps=3"],
    "plate_with_hole/path": ["lattice.spacing=2e-3", "loading.event_tolerance=0.1", "loading.teeth=2"],
    "buckling/column": ["arc_length.steps=8"],  # across the bifurcation
    "three_point_bending/mouth_opening": ["loading.table=[0,7e-4]", "loading.steps=2"],  # with the first avalanche
}  # fmt: skip
MODES = {  # of the square
    "newton": ['solver.mode="newton"', "loading.smallest_step=4e-2"],
    "relaxation": ['solver.mode="relaxation"', "relaxation.steps=12"],
    "moving": ['solver.mode="relaxation"', 'relaxation.load="moving"', "relaxation.steps=12",
               "relaxation.iterations=3600"],
    "stand-in": ["solver.elastic_horizon_ratio=2.015"],
}  # fmt: skip


class Resumed(Folder):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "out"

    def begin(self, case, *words):
        return [PROGRAM, "run", ROOT / "cases" / f"{case}.toml", "--output", self.out, "--threads", 1, *words]

    def check(self, case, changes=()):
        """Three sessions: an end after one step, after another one, and the final end."""
        whole = shipped_run(case, *changes)
        self.execute(self.begin(case, *settings(*changes), "--stop-after", 1))
        self.peristat("resume", self.out, "--threads", 1, "--stop-after", 1)
        self.resume(self.out, code=whole.code, seconds=900, limited=False)
        self.assertEqual(differences(whole.folder, self.out), [])

    def check_killed(self, case):
        started = time.monotonic()
        whole = shipped_run(case)
        self.assertEqual(whole.code, 0, whole.errors)
        duration = max(time.monotonic() - started, self.seconds(whole.folder))
        chance = random.Random(case)
        command = self.begin(case)
        for _ in range(KILLS):
            process = self.start(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(chance.uniform(0.0, 2.0 / KILLS) * duration)
            process.kill()
            process.wait()
            if (self.out / "parts/checkpoint.0").exists():
                command = [PROGRAM, "resume", self.out, "--threads", 1]
        # If the machine was too slow for a first step, the whole run.
        self.assert_completed(self.execute(command, seconds=900, limited=False))
        self.assertEqual(differences(whole.folder, self.out), [])

    def seconds(self, folder):
        return json.loads((folder / "summary.json").read_text())["seconds"]["total"]


def _add_tests():
    def named(text):
        return text.replace("/", "_").replace("-", "_")

    for case in FRACTURE:
        setattr(Resumed, f"test_{named(case)}_killed", lambda self, case=case: self.check_killed(case))
    for case, changes in OTHERS.items():
        setattr(Resumed, f"test_{named(case)}", lambda self, case=case, changes=changes: self.check(case, changes))
    for mode, changes in MODES.items():
        setattr(Resumed, f"test_square_{named(mode)}",
                lambda self, changes=changes: self.check("plate_with_hole/square", changes))  # fmt: skip


_add_tests()

if __name__ == "__main__":
    unittest.main()
