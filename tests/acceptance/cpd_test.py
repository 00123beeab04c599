"""Continuum-kinematics-inspired peridynamics through the command line."""

import unittest

import h5py
import numpy

from tests.acceptance.folder import Folder
from tests.acceptance.strip import LATTICE
from tests.reference.program import ROOT

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

CASES = ROOT / "cases/cpd"


class Cpd(Folder):
    threads = 2

    def calibrated(self, *arguments):
        return self.assert_completed(self.peristat("calibrate", *arguments)).json()

    # ---- tangents ---------------------------------------------------------------------------------

    def test_tangents_of_every_case_are_exact(self):
        checked = 0
        # Coarse: a correct formula is correct for any number of points.
        small = {"cube.toml": ["lattice.spacing=0.2", "material.c2=125", "material.c3=4e4"],
                 "cube_hole.toml": ["lattice.spacing=0.125", "material.c2=125", "material.c3=4e4"],
                 "table3.toml": ["lattice.spacing=0.2", "material.c2=51", "material.c3=1"]}  # fmt: skip
        for case in sorted(CASES.glob("*.toml")):
            for weights in ("mean", "bulk"):
                with self.subTest(case=case.name, weights=weights):
                    settings = [*small.get(case.name, []), f"quadrature.weights={weights}"]
                    told = self.assert_completed(self.command("check-tangent", case, *settings)).json()
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
        results = self.results(CASES / "table3.toml", "material.c2=51", "material.c3=1", "loading.steps=10",
                               "support[1].displacement=['(x + 0.2)*0.04*load', 0, 0]",
                               "support[0].displacement=['(x + 0.2)*0.04*load', 0, 0]")  # fmt: skip
        for words in ("triangles; per point", "tetrahedra; per point", "stored: storing them takes"):
            self.assertIn(words, self.ended.output)
        summary = results.summary
        with h5py.File(self.folder / "out/results.h5") as file:
            neighbours = file["points/neighbours"][...]
            pairs, triplets = file["points/neighbour_pairs"][...], file["points/neighbour_triplets"][...]
        self.assertEqual(neighbours.sum(), 2 * summary["bonds"])
        self.assertEqual(pairs.sum(), 6 * summary["triangles"])
        self.assertEqual(triplets.sum(), 24 * summary["tetrahedra"])
        self.assertTrue((numpy.array([len(neighbours), len(pairs), len(triplets)]) == summary["points"]).all())

        rows, steps = results.table("convergence"), [f"step_{step}" for step in range(1, 11)]
        self.assertEqual(list(rows[0]), ["iteration", *steps])
        self.assertEqual(rows[-1]["iteration"], "observed_order")
        self.assertEqual({rows[0][step] for step in steps}, {1})
        first = [row["residual"] for row in results.table("iterations") if row["step"] == 7]
        column = [row["step_7"] for row in rows[:-1] if row["step_7"] != ""]
        self.assertEqual(len(column), len(first))
        for told, residual in zip(column, first):
            self.assertAlmostEqual(told, residual / first[0], delta=1e-15)

    def test_calibrated_moduli_are_those_of_the_case(self):
        case = (CASES / "poisson_3d.toml").read_text()
        start, end = case.index("c1 = "), case.index("[[support]]")
        case = case[:start] + "youngs_modulus = 3e9\npoisson_ratio = 0.35\n\n" + case[end:]
        run = self.assert_completed(self.command("check", case))
        self.assertIn("lattice: Young's modulus 3e+09 Pa, Poisson's ratio 0.35 ", run.output)
        run = self.command("check", case, "material.calibration=continuum")
        self.assertIn("continuum: Young's modulus 3e+09 Pa, Poisson's ratio 0.35 ", run.output)
        told = self.calibrated(self.case(case))
        self.assertAlmostEqual(told["lattice"]["youngs_modulus"] / 3e9, 1.0, delta=1e-11)
        self.assertAlmostEqual(told["lattice"]["poisson_ratio"], 0.35, delta=1e-11)

    # ---- bodies without a stable rest -------------------------------------------------------------

    def test_a_body_that_is_unstable_at_rest_is_refused(self):
        case = CASES / "square.toml", "material.c2=-2000", "lattice.spacing=0.05"
        for more in ([], ["solver.mode=adaptive"], ["solver.linear=pcg"]):
            fragments = ["material.c2 = -2000", "unstable before anything is loaded"] + ([] if more else ["negative pivots"])
            self.assert_refused(self.command("check", *case, *more), *fragments)
            self.refusal(*case, *more)
            self.assert_refused(self.ended, *fragments)

    def test_a_stable_body_of_a_negative_constant_is_not(self):
        for more in ([], ["solver.linear=pcg"]):
            settings = "lattice.spacing=0.05", "material.c2=-20", *more
            self.assert_completed(self.command("check", CASES / "square.toml", *settings))

    def test_damage_of_a_negative_constant_is_refused(self):
        law = '{law="critical_stretch",critical=0.01}'
        for case, limit, below, above in (("square", "0.3333333333333333", 0.3333333, 1.0 / 3.0),
                                          ("cube", "0.25", 0.2499999, 0.25)):  # fmt: skip
            moduli = 'material={model="cpd",youngs_modulus=1e9,poisson_ratio=%r,damage=' + law + "}"
            coarse = CASES / f"{case}.toml", "lattice.spacing=0.2"
            self.refusal(*coarse, moduli % below)
            self.assert_refused(self.ended, "material.damage.law", "c2" if case == "square" else "c3", limit)
            self.assert_completed(self.command("check", *coarse, moduli % above))
            constants = 'material={model="cpd",c1=1.0,c2=%r,damage=' + law + "}"
            self.assert_refused(self.command("check", *coarse, constants % -1.0), "material.damage.law", "c2 is -1")

    def test_a_constant_without_interactions_is_refused(self):
        short = CASES / "square.toml", "lattice.horizon_ratio=1.2"
        self.assert_refused(self.command("check", *short), "material.c2 = 1200", "no triangles")
        moduli = 'material={model="cpd",youngs_modulus=1.0,poisson_ratio=0.45}'
        self.assert_refused(self.command("check", *short, moduli), "material.poisson_ratio", "can't be reached")

    # ---- almost collinear and coplanar points -----------------------------------------------------

    def reaction(self, case, *changes):
        return self.results(case, *changes).summary["reactions"]["pulled"][0]

    def test_a_shift_of_points_that_cannot_be_seen_changes_nothing(self):
        # Not with the horizon, which cuts the longest bonds of the lattice beyond: at 0.01 some points
        # move by more than the 0.015 spacings between them and it, hence the 2 % there.
        for case, end, ratios in (("square", '"0"', (0.1, 0.45)), ("cube", '"0","0"', (0.2, 0.4))):
            for ratio in ratios:
                spacing = 0.05 if case == "square" else 0.2
                pulled = (CASES / f"{case}.toml", f"lattice.spacing={spacing}", "loading.steps=1",
                          f'material={{model="cpd",youngs_modulus=1.0,poisson_ratio={ratio}}}',
                          f'support[1].displacement=["1e-3*load",{end}]')  # fmt: skip
                regular = self.reaction(*pulled)
                for perturbation, tolerance in ((1e-9, 1e-7), (1e-6, 1e-5), (1e-5, 1e-4), (1e-4, 1e-3),
                                                (1e-3, 5e-3), (1e-2, 0.02)):  # fmt: skip
                    with self.subTest(case=case, poisson_ratio=ratio, perturbation=perturbation):
                        found = self.reaction(*pulled, f"lattice.perturbation={perturbation}")
                        self.assertAlmostEqual(found / regular, 1.0, delta=tolerance)

    def test_points_written_with_few_digits_are_those_of_the_lattice(self):
        pulled = ("loading.steps=1", 'material={model="cpd",youngs_modulus=1.0,poisson_ratio=0.45}',
                  'support[1].displacement=["1e-3*load","0"]')  # fmt: skip
        regular = self.reaction(CASES / "square.toml", "lattice.spacing=0.047619047619047616", *pulled)
        with h5py.File(self.folder / "out/results.h5") as file:
            places, volumes = file["points/reference"][...], file["points/volume"][...]
        case = (CASES / "square.toml").read_text()
        case = case[: case.index("[lattice]")] + (
            '[points]\nfile = "points.csv"\nhorizon = 0.14357142857142857\n\n') + case[case.index("[material]") :]
        for digits in (6, 7, 8, 15):
            lines = ["x,y,volume,set"]
            for (x, y), volume in zip(places, volumes):
                name = "held" if x < 0.0 else "pulled" if x > 1.0 else ""
                lines.append(f"{x:.{digits}g},{y:.{digits}g},{volume:.{digits}g},{name}")
            self.write("points.csv", "\n".join(lines) + "\n")
            found = self.reaction(case, *pulled)
            with self.subTest(digits=digits):
                self.assertAlmostEqual(found / regular, 1.0, delta=1e-4)

    # ---- fracture ---------------------------------------------------------------------------------

    def test_fracture_never_gains_energy(self):
        for ratio, mode, breaking, perturbation in ((0.34, "adaptive", "at_equilibrium", 0.0),
                                                    (0.45, "adaptive", "transient", 0.0),
                                                    (0.4, "adaptive", "transient", 0.1),
                                                    (0.34, "relaxation", "transient", 0.0)):  # fmt: skip
            with self.subTest(poisson_ratio=ratio, mode=mode, breaking=breaking, perturbation=perturbation):
                changes = f"relaxation.breaking={breaking}", f"lattice.perturbation={perturbation}"
                results = self.results(STRIP, f"material.poisson_ratio={ratio}", f"solver.mode={mode}", *changes)
                rows = results.table("history")
                work = max(row["external_work"] for row in rows)
                dissipated = [0.0] + [row["dissipated_energy"] for row in rows]
                drained = [0.0] + [row["drained_energy"] for row in rows]
                for before, after in zip(dissipated, dissipated[1:]):
                    self.assertGreaterEqual(after, before * (1 - 1e-15))  # sums round
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
            there = self.calibrated(*lattice, "--youngs-modulus", "2e9", "--poisson-ratio", "0.4")
            for place in ("lattice", "continuum"):
                found = there[place]
                self.assertAlmostEqual(found["youngs_modulus"] / 2e9, 1.0, delta=1e-10)
                constants = [word for key in ("c1", "c2", "c3") for word in ("--" + key, repr(found[key]))]
                back = self.calibrated(*lattice, *constants)[place]
                self.assertAlmostEqual(back["poisson_ratio"], 0.4, delta=1e-9)
                lame = self.calibrated(*lattice, "--lambda", found["lambda"], "--mu", found["mu"])[place]
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
                self.assert_refused(self.peristat("calibrate", *self.PLANE, *moduli, option, value), f"{option}: is not for --model cpd")

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
            ("--model", "bond", *self.PLANE, "--youngs-modulus", "1e308"): ["not finite"],
            ("--dimension", "3", "--spacing", "1", "--horizon-ratio", "100", "--c1", "1"): ["--horizon-ratio"],
            ("--dimension", "3", "--spacing", "1", "--horizon-ratio", "1", "--c1", "1"): ["--horizon-ratio"],
        }.items():
            with self.subTest(arguments=arguments):
                self.assert_refused(self.peristat("calibrate", *arguments), *words)


if __name__ == "__main__":
    unittest.main()
