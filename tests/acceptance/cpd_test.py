"""Continuum-kinematics-inspired peridynamics through the command line, as an analyst types it."""

import csv
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import h5py
import numpy

from tests.acceptance.strip import LATTICE

PROGRAM = os.environ["PERISTAT_PROGRAM"]
STRIP = LATTICE + """\
[material]
model = "cpd"
youngs_modulus = 200e9
poisson_ratio = 0.34

[material.damage]
law = "critical_stretch"
critical = 0.01
no_fail = ["left", "right"]

[[support]]
set = "left"
displacement = [0, 0]

[[support]]
set = "right"
displacement = ["6e-4*load", "free"]

[loading]
steps = 4

[relaxation]
steps = 20
"""

CASES = pathlib.Path(__file__).resolve().parents[2] / "cases" / "cpd"


class Cpd(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="peristat_acceptance_")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def peristat(self, *arguments):
        return subprocess.run([PROGRAM, *map(str, arguments)], cwd=self.folder, text=True, timeout=300,
                              stdin=subprocess.DEVNULL, capture_output=True)  # fmt: skip

    def answer(self, *arguments):
        run = self.peristat(*arguments)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        return json.loads(run.stdout)

    def assert_refused(self, run, *fragments):
        self.assertEqual(run.returncode, 2, run.stdout + run.stderr)
        for fragment in fragments:
            self.assertIn(fragment, run.stderr)

    # ---- tangents ---------------------------------------------------------------------------------

    def test_tangents_of_every_case_are_exact(self):
        checked = 0
        # Coarse: a formula that is right is so at any number of points.
        small = {"cube.toml": ["lattice.spacing=0.2", "material.c2=125", "material.c3=4e4"],
                 "cube_hole.toml": ["lattice.spacing=0.125", "material.c2=125", "material.c3=4e4"],
                 "table3.toml": ["lattice.spacing=0.2", "material.c2=51", "material.c3=1"]}  # fmt: skip
        for case in sorted(CASES.glob("*.toml")):
            for weights in ("mean", "bulk"):
                with self.subTest(case=case.name, weights=weights):
                    settings = [*small.get(case.name, []), f"quadrature.weights={weights}"]
                    told = self.answer("check-tangent", case, *(word for s in settings for word in ("--set", s)))
                    checked += 1
                    self.assertGreater(told["energy"], 0.0)
                    self.assertLess(told["residual_error"], 1e-7)
                    self.assertLess(told["tangent_error"], 1e-7)
                    self.assertAlmostEqual(told["residual_order"], 2.0, delta=0.1)
                    self.assertAlmostEqual(told["tangent_order"], 2.0, delta=0.1)
                    self.assertLess(told["asymmetry"], 1e-9)  # of differences
                    self.assertLess(told["force_sum"], 1e-11)
                    self.assertLess(told["moment_sum"], 1e-11)
        self.assertEqual(checked, 14)

    # ---- a run ------------------------------------------------------------------------------------

    def test_a_run_leaves_counts_and_the_convergence_table(self):
        run = self.peristat("run", CASES / "table3.toml", "--output", "out", "--set", "material.c2=51",
                            "--set", "material.c3=1", "--set", "loading.steps=10",
                            "--set", "support[1].displacement=['(x + 0.2)*0.04*load', 0, 0]",
                            "--set", "support[0].displacement=['(x + 0.2)*0.04*load', 0, 0]")  # fmt: skip
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        self.assertIn("triangles; per point", run.stdout)
        self.assertIn("tetrahedra; per point", run.stdout)
        self.assertIn("stored: storing them takes", run.stdout)
        summary = json.loads((self.folder / "out/summary.json").read_text())
        with h5py.File(self.folder / "out/results.h5") as file:
            neighbours = file["points/neighbours"][...]
            pairs, triplets = file["points/neighbour_pairs"][...], file["points/neighbour_triplets"][...]
        self.assertEqual(neighbours.sum(), 2 * summary["bonds"])
        self.assertEqual(pairs.sum(), 6 * summary["triangles"])
        self.assertEqual(triplets.sum(), 24 * summary["tetrahedra"])
        self.assertTrue((numpy.array([len(neighbours), len(pairs), len(triplets)]) == summary["points"]).all())

        with open(self.folder / "out/convergence.csv", newline="") as table:
            header, *rows = csv.reader(table)
        self.assertEqual(header, ["iteration"] + [f"step_{step}" for step in range(1, 11)])
        self.assertEqual(rows[-1][0], "observed_order")
        self.assertEqual(set(rows[0][1:]), {"1"})
        with open(self.folder / "out/iterations.csv", newline="") as table:
            first = [float(row["residual"]) for row in csv.DictReader(table) if row["step"] == "7"]
        column = [row[7] for row in rows[:-1] if row[7]]
        self.assertEqual(len(column), len(first))
        for told, residual in zip(column, first):
            self.assertAlmostEqual(float(told), residual / first[0], delta=1e-15)

    def test_calibrated_moduli_are_those_of_the_case(self):
        case = (CASES / "poisson_3d.toml").read_text()
        start, end = case.index("c1 = "), case.index("[[support]]")
        path = self.folder / "moduli.toml"
        path.write_text(case[:start] + "youngs_modulus = 3e9\npoisson_ratio = 0.35\n\n" + case[end:])
        run = self.peristat("check", path)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("lattice: Young's modulus 3e+09 Pa, Poisson's ratio 0.35 ", run.stdout)
        run = self.peristat("check", path, "--set", "material.calibration=continuum")
        self.assertIn("continuum: Young's modulus 3e+09 Pa, Poisson's ratio 0.35 ", run.stdout)
        told = self.answer("calibrate", path)
        self.assertAlmostEqual(told["lattice"]["youngs_modulus"] / 3e9, 1.0, delta=1e-11)
        self.assertAlmostEqual(told["lattice"]["poisson_ratio"], 0.35, delta=1e-11)

    # ---- bodies without a stable rest -------------------------------------------------------------

    def test_a_body_that_is_unstable_at_rest_is_refused(self):
        settings = [CASES / "square.toml", "--set", "material.c2=-2000", "--set", "lattice.spacing=0.05"]
        for words in ([], ["--set", "solver.mode=adaptive"], ["--set", "solver.linear=pcg"]):
            for command in (["check"], ["run", "--output", "out"]):
                run = self.peristat(*command, *settings, *words)
                self.assert_refused(run, "material.c2 = -2000", "unstable before anything is loaded")
                if not words:
                    self.assertIn("negative pivots", run.stderr)
        self.assertFalse((self.folder / "out").exists())

    def test_a_stable_body_of_a_negative_constant_is_not(self):
        for words in ([], ["--set", "solver.linear=pcg"]):
            run = self.peristat("check", CASES / "square.toml", "--set", "lattice.spacing=0.05",
                                "--set", "material.c2=-20", *words)  # fmt: skip
            self.assertEqual(run.returncode, 0, run.stdout + run.stderr)

    def test_damage_of_a_negative_constant_is_refused(self):
        law = '{law="critical_stretch",critical=0.01}'
        for case, limit, below, above in (("square", "0.3333333333333333", 0.3333333, 1.0 / 3.0),
                                          ("cube", "0.25", 0.2499999, 0.25)):  # fmt: skip
            moduli = 'material={model="cpd",youngs_modulus=1e9,poisson_ratio=%r,damage=' + law + "}"
            settings = [CASES / f"{case}.toml", "--set", "lattice.spacing=0.2", "--set"]
            self.assert_refused(self.peristat("run", *settings, moduli % below, "--output", "out"),
                                "material.damage.law", "c2" if case == "square" else "c3", limit)  # fmt: skip
            run = self.peristat("check", *settings, moduli % above)
            self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
            constants = 'material={model="cpd",c1=1.0,c2=%r,damage=' + law + "}"
            self.assert_refused(self.peristat("check", *settings, constants % -1.0), "material.damage.law", "c2 is -1")
        self.assertFalse((self.folder / "out").exists())

    def test_a_constant_without_interactions_is_refused(self):
        short = [CASES / "square.toml", "--set", "lattice.horizon_ratio=1.2"]
        self.assert_refused(self.peristat("check", *short), "material.c2 = 1200", "no triangles")
        moduli = 'material={model="cpd",youngs_modulus=1.0,poisson_ratio=0.45}'
        self.assert_refused(self.peristat("check", *short, "--set", moduli), "material.poisson_ratio", "can't be reached")

    # ---- almost collinear and coplanar points -----------------------------------------------------

    def reaction(self, *settings):
        run = self.peristat("run", *settings, "--output", "out", "--overwrite", "--quiet")
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        return json.loads((self.folder / "out/summary.json").read_text())["reactions"]["pulled"][0]

    def test_a_shift_of_points_that_cannot_be_seen_changes_nothing(self):
        # Not the horizon, which cuts the longest bonds of the lattice beyond: at 0.01 the points of some
        # move by more than the 0.015 spacings that they are away from it, hence the 2 % there.
        for case, end, ratios in (("square", '"0"', (0.1, 0.45)), ("cube", '"0","0"', (0.2, 0.4))):
            for ratio in ratios:
                settings = [CASES / f"{case}.toml"]
                for setting in (f"lattice.spacing={0.05 if case == 'square' else 0.2}", "loading.steps=1",
                                f'material={{model="cpd",youngs_modulus=1.0,poisson_ratio={ratio}}}',
                                f'support[1].displacement=["1e-3*load",{end}]'):  # fmt: skip
                    settings += ["--set", setting]
                regular = self.reaction(*settings)
                for perturbation, tolerance in ((1e-9, 1e-7), (1e-6, 1e-5), (1e-5, 1e-4), (1e-4, 1e-3),
                                                (1e-3, 5e-3), (1e-2, 0.02)):  # fmt: skip
                    with self.subTest(case=case, poisson_ratio=ratio, perturbation=perturbation):
                        found = self.reaction(*settings, "--set", f"lattice.perturbation={perturbation}")
                        self.assertAlmostEqual(found / regular, 1.0, delta=tolerance)

    def test_points_written_with_few_digits_are_those_of_the_lattice(self):
        settings = []
        for setting in ("lattice.spacing=0.047619047619047616", "loading.steps=1",
                        'material={model="cpd",youngs_modulus=1.0,poisson_ratio=0.45}',
                        'support[1].displacement=["1e-3*load","0"]'):  # fmt: skip
            settings += ["--set", setting]
        regular = self.reaction(CASES / "square.toml", *settings)
        with h5py.File(self.folder / "out/results.h5") as file:
            places, volumes = file["points/reference"][...], file["points/volume"][...]
        case = (CASES / "square.toml").read_text()
        case = case[: case.index("[lattice]")] + (
            '[points]\nfile = "points.csv"\nhorizon = 0.14357142857142857\n\n') + case[case.index("[material]") :]
        (self.folder / "points.toml").write_text(case)
        for digits in (6, 7, 8, 15):
            lines = ["x,y,volume,set"]
            for (x, y), volume in zip(places, volumes):
                name = "held" if x < 0.0 else "pulled" if x > 1.0 else ""
                lines.append(f"{x:.{digits}g},{y:.{digits}g},{volume:.{digits}g},{name}")
            (self.folder / "points.csv").write_text("\n".join(lines) + "\n")
            found = self.reaction(self.folder / "points.toml", *settings[2:])
            with self.subTest(digits=digits):
                self.assertAlmostEqual(found / regular, 1.0, delta=1e-4)

    # ---- fracture ---------------------------------------------------------------------------------

    def test_fracture_never_gains_energy(self):
        strip = self.folder / "strip.toml"
        strip.write_text(STRIP)
        for ratio, mode, breaking, perturbation in ((0.34, "adaptive", "at_equilibrium", 0.0),
                                                    (0.45, "adaptive", "transient", 0.0),
                                                    (0.4, "adaptive", "transient", 0.1),
                                                    (0.34, "relaxation", "transient", 0.0)):  # fmt: skip
            with self.subTest(poisson_ratio=ratio, mode=mode, breaking=breaking, perturbation=perturbation):
                run = self.peristat("run", strip, "--output", "out", "--set", f"material.poisson_ratio={ratio}",
                                    "--set", f"solver.mode={mode}", "--set", f"relaxation.breaking={breaking}",
                                    "--set", f"lattice.perturbation={perturbation}")  # fmt: skip
                self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
                with open(self.folder / "out/history.csv", newline="") as table:
                    rows = [{key: float(value) for key, value in row.items() if key != "mode"}
                            for row in csv.DictReader(table)]  # fmt: skip
                work = max(row["external_work"] for row in rows)
                dissipated = [0.0] + [row["dissipated_energy"] for row in rows]
                drained = [0.0] + [row["drained_energy"] for row in rows]
                for before, after in zip(dissipated, dissipated[1:]):
                    self.assertGreaterEqual(after, before)
                for before, after in zip(drained, drained[1:]):
                    self.assertGreaterEqual(after, before - 1e-12 * work)
                self.assertGreater(dissipated[-1], 0.1 * work)
                self.assertGreater(rows[-1]["broken_bonds"], 100)
                self.assertTrue(all(row["stored_energy"] >= 0.0 for row in rows))
                # The trapezoidal rule over the few elastic steps.
                self.assertLess(max(abs(row["balance_error"]) for row in rows), 2e-3 * work)

    # ---- calibrate --------------------------------------------------------------------------------

    LATTICE = ["--dimension", "3", "--spacing", "0.05", "--horizon-ratio", "2.015"]
    PLANE = ["--dimension", "2", "--spacing", "0.02", "--horizon-ratio", "3.015", "--thickness", "0.1"]

    def test_calibrate_goes_there_and_back(self):
        for lattice in (self.LATTICE, self.PLANE):
            there = self.answer("calibrate", *lattice, "--youngs-modulus", "2e9", "--poisson-ratio", "0.4")
            for place in ("lattice", "continuum"):
                found = there[place]
                self.assertAlmostEqual(found["youngs_modulus"] / 2e9, 1.0, delta=1e-10)
                constants = [word for key in ("c1", "c2", "c3") for word in ("--" + key, repr(found[key]))]
                back = self.answer("calibrate", *lattice, *constants)[place]
                self.assertAlmostEqual(back["poisson_ratio"], 0.4, delta=1e-9)
                lame = self.answer("calibrate", *lattice, "--lambda", found["lambda"], "--mu", found["mu"])[place]
                for key in ("c1", "c2", "c3"):
                    self.assertAlmostEqual(lame[key], found[key], delta=1e-9 * abs(found[key]))
            self.assertEqual(there["continuum"]["anisotropy"], 1.0)
            self.assertNotAlmostEqual(there["lattice"]["anisotropy"], 1.0, delta=0.01)

    def test_calibrate_refuses_what_only_bonds_have(self):
        moduli = ["--youngs-modulus", "1", "--poisson-ratio", "0.4"]
        for option, value in {"--micromodulus": "1", "--plane": "strain", "--angle": "10", "--area": "1",
                              "--calibration": "lattice", "--volume-correction": "linear",
                              "--surface-correction": "none"}.items():  # fmt: skip
            with self.subTest(option=option):
                self.assert_refused(self.peristat("calibrate", *self.PLANE, *moduli, option, value), f"{option}: is for --model bond")

    def test_calibrate_refuses_what_makes_no_sense(self):
        moduli = ["--youngs-modulus", "1", "--poisson-ratio"]
        for arguments, words in {
            (*self.LATTICE, *moduli, "0.5"): ["--poisson-ratio", "below 0.5"],
            (*self.LATTICE, *moduli, "nan"): ["--poisson-ratio"],
            (*self.PLANE, *moduli, "1"): ["--poisson-ratio", "below 1"],
            (*self.LATTICE, "--youngs-modulus", "-1", "--poisson-ratio", "0"): ["--youngs-modulus"],
            (*self.LATTICE, "--lambda", "-1", "--mu", "1"): ["--lambda", "stable"],
            (*self.LATTICE, "--lambda", "1"): ["--mu", "missing"],
            (*self.LATTICE, *moduli, "0.3", "--c2", "1e30"): ["--c2", "no positive c1"],
            (*self.PLANE, *moduli, "0.3", "--c2", "1"): ["--c2", "2D"],
            (*self.PLANE, "--c1", "1", "--c3", "1"): ["--c3", "2D"],
            (*self.LATTICE, "--c1", "0"): ["--c1", "positive"],
            (*self.LATTICE, "--c1", "1", "--mu", "1"): ["exactly one"],
            (*self.LATTICE,): ["exactly one"],
            ("--dimension", "1", "--spacing", "1", "--horizon-ratio", "3", "--c1", "1"): ["--dimension", "must be 2 or 3"],
            ("--dimension", "2", "--spacing", "1", "--c1", "1"): ["--horizon-ratio", "is missing"],
            (*self.PLANE, "--K1c", "1.2", "--c1", "1"): ["unknown option --K1c"],
            (*self.PLANE, "--c1", "1", "--strengths"): ["--strengths", "needs a law of damage"],
            (*self.PLANE, *moduli, "0.999999999"): ["--poisson-ratio", "digits"],
            (*self.LATTICE, *moduli, "0.499999999"): ["--poisson-ratio", "digits"],
            ("--model", "bond", *self.PLANE, "--youngs-modulus", "1e308"): ["no finite"],
            ("--dimension", "3", "--spacing", "1", "--horizon-ratio", "100", "--c1", "1"): ["--horizon-ratio"],
            ("--dimension", "3", "--spacing", "1", "--horizon-ratio", "1", "--c1", "1"): ["--horizon-ratio"],
        }.items():
            with self.subTest(arguments=arguments):
                self.assert_refused(self.peristat("calibrate", *arguments), *words)


if __name__ == "__main__":
    unittest.main()
