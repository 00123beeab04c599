"""Strength surfaces, from the command line: what calibrate and check tell, compared with the reference of
tests/reference/surface_pull.py, patches that bear it, and what is refused."""

import math

import numpy

from tests.acceptance.folder import Folder
from tests.acceptance.motions import columns
from tests.reference import surface_pull
from tests.reference.states_pull import StatePull
from tests.reference.tear import directions

E, STRENGTH, COMPRESSION, ENERGY = 30e9, 3e6, 50e6, 2.6
BIAXIAL = 2 * COMPRESSION * STRENGTH / (3 * COMPRESSION - STRENGTH)
SHEAR = 2 * COMPRESSION * STRENGTH / (math.sqrt(3) * (COMPRESSION + STRENGTH))
EDGE = 4e-3  # of the patch
SURFACE = {"strength_surface": "drucker_prager", "compressive_strength": COMPRESSION}
DAMAGE = {"law": "linear", "fracture_energy": ENERGY, "strength": STRENGTH, **SURFACE}


def material(nu, model="state", damage=DAMAGE):
    constants = {"poisson_ratio": nu} if model == "state" else {"calibration": "lattice"}
    return {"model": model, "youngs_modulus": E, **constants, "damage": damage}


def patch(nu, strains, steps, model="state", damage=DAMAGE):
    """A cell of an infinite plate; a strain of None is free."""
    period = []
    for k, axis in enumerate("xy"):
        gradient = [0, 0]
        gradient[k] = "free" if strains[k] is None else f"{strains[k]!r}*load"
        period.append({"axis": axis, "from": 0, "to": EDGE, "gradient": gradient})
    box = {"add": "box", "min": [0, 0], "max": [EDGE, EDGE]}
    return {
        "dimension": 2,
        "lattice": {"spacing": 1e-3, "horizon_ratio": 3.015, "thickness": 1e-3, "shape": [box]},
        "material": material(nu, model, damage), "period": period, "loading": {"steps": steps},
        "solver": {"mode": "newton"}, "output": {"every": steps},
    }  # fmt: skip


class StrengthSurfaces(Folder):
    def told(self, nu, *more, model="state"):
        words = ["--model", model, "--dimension", 2, "--spacing", 1e-3, "--horizon-ratio", 3.015, "--youngs-modulus", E]
        words += ["--poisson-ratio", repr(nu)] if model == "state" else ["--calibration", "lattice"]
        words += ["--law", "linear", "--fracture-energy", ENERGY, "--strength", STRENGTH, "--strengths", *more]
        return self.assert_completed(self.peristat("calibrate", *words)).json()["damage"]

    def stresses(self, *case, code=0):
        """Stresses of a patch along its edges [Pa], and the energy that it has dissipated."""
        rows = columns(self.run_case(patch(*case[:3], **(case[3] if len(case) > 3 else {})), code=code, name="patch"))
        area = EDGE * 1e-3
        return abs(rows["reaction_x:period_x"]) / area, abs(rows["reaction_y:period_y"]) / area, rows["dissipated_energy"]

    def test_calibrate_tells_the_strengths_of_each_surface(self):
        found = self.told(0.2, "--strength-surface", "drucker_prager", "--compressive-strength", COMPRESSION)["strengths"]
        for name, strength in (("uniaxial", STRENGTH), ("biaxial", BIAXIAL), ("shear", SHEAR), ("compression", COMPRESSION)):
            self.assertAlmostEqual(found[name]["surface"] / strength, 1, delta=1e-12)
            if name != "compression":  # bonds across it cannot start so late
                self.assertAlmostEqual(found[name]["reached"] / strength, 1, delta=1e-12)
        self.assertLess(found["compression"]["reached"], 0.6 * COMPRESSION)
        same = self.told(0.2, "--strength-surface", "drucker_prager", "--biaxial-strength", repr(BIAXIAL))["strengths"]
        for name, strengths in found.items():
            self.assertAlmostEqual(same[name]["onset"] / strengths["onset"], 1, delta=1e-9)
        coulomb = self.told(0.2, "--strength-surface", "mohr_coulomb", "--compressive-strength", COMPRESSION)["strengths"]
        self.assertAlmostEqual(coulomb["biaxial"]["surface"] / STRENGTH, 1, delta=1e-12)
        self.assertAlmostEqual(coulomb["shear"]["surface"] * (1 / STRENGTH + 1 / COMPRESSION), 1, delta=1e-12)
        rankine = self.told(0.2, "--strength-surface", "rankine")["strengths"]
        self.assertAlmostEqual(rankine["shear"]["surface"] / STRENGTH, 1, delta=1e-12)
        self.assertIsNone(rankine["compression"])

    def test_peaks_lie_on_the_surface(self):
        """The reference starts bonds where calibrate says, and finds the peaks by itself."""
        for model, nu in (("state", 0.2), ("state", 0.45), ("bond", 1 / 3)):
            told = self.told(nu, "--strength-surface", "drucker_prager", "--compressive-strength", COMPRESSION, model=model)
            for name, stresses in (("uniaxial", (1, 0)), ("biaxial", (1, 1)), ("shear", (1, -1))):
                with self.subTest(model=model, nu=nu, stresses=name):
                    strengths = told["strengths"][name]
                    growth = strengths["surface"] / strengths["onset"]
                    pull = surface_pull.SurfacePull(
                        StatePull(2, 3.015, E, nu), E, nu, told["onset"], told["critical"],
                        lambda s, growth=growth: growth * surface_pull.drucker_prager(s, STRENGTH, COMPRESSION))  # fmt: skip
                    courses = [(weight, pull.course(stresses, math.atan2(n[1], n[0]), step=5e-3)) for n, weight in zip(*directions(2), strict=True)]
                    onset, peak = (sum(weight * course[k] for weight, course in courses) for k in (0, 1))
                    # The lattice is as stiff as E and nu say in the mean over directions.
                    self.assertAlmostEqual(onset / strengths["onset"], 1, delta=2e-3)
                    self.assertAlmostEqual(peak / strengths["surface"], 1, delta=0.01)

    def test_a_patch_bears_the_strengths(self):
        for model, nu in (("state", 0.2), ("bond", 1 / 3)):
            reach = 1.5 * STRENGTH / E
            with self.subTest(model=model, stress="uniaxial"):
                told = self.told(nu, "--strength-surface", "drucker_prager", "--compressive-strength", COMPRESSION, model=model)
                growth = STRENGTH / told["strengths"]["uniaxial"]["onset"]
                pull = surface_pull.SurfacePull(
                    StatePull(2, 3.015, E, nu), E, nu, told["onset"], told["critical"],
                    lambda s, growth=growth: growth * surface_pull.drucker_prager(s, STRENGTH, COMPRESSION))  # fmt: skip
                onset, peak = pull.course((1, 0), 0.0)
                along, _, dissipated = self.stresses(nu, (reach, None), 75, {"model": model}, code=(0, 3))
                self.assertAlmostEqual(along.max() / peak, 1, delta=0.01)
                self.assertAlmostEqual(along.max() / STRENGTH, 1, delta=0.05)  # of this direction, not of all
                self.assertAlmostEqual(along[numpy.argmax(dissipated > 0)] / onset, 1, delta=0.03)  # a step
            with self.subTest(model=model, stress="biaxial"):
                along, across, _ = self.stresses(nu, (reach * (1 - nu), reach * (1 - nu)), 75, {"model": model}, code=(0, 3))
                self.assertAlmostEqual(along.max() / BIAXIAL, 1, delta=0.01)
                self.assertAlmostEqual(across.max() / BIAXIAL, 1, delta=0.01)
            with self.subTest(model=model, stress="biaxial, no surface"):
                plain = {key: value for key, value in DAMAGE.items() if key not in SURFACE}
                along, _, _ = self.stresses(nu, (reach * (1 - nu), reach * (1 - nu)), 75, {"model": model, "damage": plain}, code=(0, 3))
                self.assertGreater(along.max(), 1.3 * STRENGTH)

    def test_steps_and_threads_do_not_decide_where_damage_begins(self):
        found = []
        for steps, threads in ((40, 1), (80, 1), (80, 3)):
            self.threads = threads
            along, _, dissipated = self.stresses(0.2, (1.2 * STRENGTH / E, 0.3 * STRENGTH / E), steps)
            found.append((along[dissipated == 0].max(), along[dissipated > 0].min(), along.max()))
        (before, after, _), (finer_before, finer_after, peak), (_, _, on_threads) = found
        self.assertLessEqual(before, finer_after)
        self.assertLessEqual(finer_before, after)
        self.assertAlmostEqual(on_threads / peak, 1, delta=1e-9)

    def notched(self, **damage):
        """A small plate with a notch, pulled apart until it has torn."""
        return {
            "dimension": 2,
            "lattice": {"spacing": 1e-3, "horizon_ratio": 3.015, "thickness": 1e-3,
                        "shape": [{"add": "box", "min": [0, 0], "max": [0.02, 0.02]}]},
            "crack": [{"from": [-1e-3, 0.01], "to": [0.006, 0.01]}],
            "set": [{"name": "low", "where": "y < 0.003"}, {"name": "high", "where": "y > 0.017"}],
            "support": [{"set": "low", "displacement": [0, 0]}, {"set": "high", "displacement": [0, "3e-6*load"]}],
            "material": material(0.2, damage=DAMAGE | {"no_fail": ["low", "high"]} | damage),
            "loading": {"steps": 12}, "solver": {"mode": "newton"}, "output": {"every": 4},
        }  # fmt: skip

    def test_an_interrupted_run_goes_on_as_if_it_had_not_been(self):
        whole = self.run_case(self.notched(), name="whole")
        self.assertGreater(columns(whole)["broken_bonds"][-1], 50)
        self.run_case(self.notched(), name="split", words=("--stop-after", 7), code=130)
        self.resume("split")
        for table in ("history.csv", "broken_bonds.csv"):
            self.assertEqual((whole / table).read_text(), (self.folder / "split" / table).read_text())

    def test_check_names_strengths_that_the_law_does_not_reach(self):
        ended = self.assert_completed(self.command("check", self.notched()))
        self.assertIn(f"equal biaxial {BIAXIAL:.4g} Pa", ended.said)
        self.assertIn(f"shear {SHEAR:.4g} Pa; bonds begin to soften under compression at", ended.said)
        brittle = self.assert_completed(self.command("check", self.notched(fracture_energy=0.65)))
        self.assertRegex(brittle.said, rf"shear [0-9.e+]+ Pa where {SHEAR:.4g} Pa are asked \(too little work for more\)".replace("+0", r"\+0"))

    def test_stresses_that_drive_no_bond_have_no_strength(self):
        """With lambda = 0 equal biaxial tension sets nothing free with one bond."""
        ended = self.assert_completed(self.command("check", self.notched(), "material.poisson_ratio=0"))
        self.assertIn("equal biaxial no value: it drives no bond", ended.said)
        found = self.told(0.0, "--strength-surface", "drucker_prager", "--compressive-strength", COMPRESSION)["strengths"]
        self.assertIsNone(found["biaxial"]["reached"])
        self.assertAlmostEqual(found["uniaxial"]["reached"] / STRENGTH, 1, delta=1e-12)

    def test_what_is_refused(self):
        case = self.notched()
        for changes, word in (
            ({"strength_surface": "none"}, "needs strength_surface"),
            ({"compressive_strength": 2e6}, "must be above strength"),
            ({"biaxial_strength": 2e6}, "give one of them"),
            ({"strength_surface": "rankine"}, 'is not for the surface "rankine"'),
            ({"strength_factor": [0.0, 2.0]}, "must be from 0.01 to 1"),
            ({"drive": "stretch"}, "drive"),
        ):
            with self.subTest(word):
                self.assertIn(word, self.refusal(self.notched(**changes)))
        self.assertIn("a strength_surface needs it", self.refusal(case, "material.damage={law='linear', fracture_energy=2.6, strength_surface='rankine'}"))
        self.assertIn("laws that soften", self.refusal(case, "material.damage={law='critical_stretch', strength=3e6, strength_surface='rankine'}"))
        self.assertIn("is for models", self.refusal(case, "material.model=cpd"))
        self.assertIn('mode "path"', self.refusal(case, "solver.mode=path"))
        self.assertIn("is missing", self.refusal(case, "material.damage={law='linear', fracture_energy=2.6, strength=3e6, strength_surface='mohr_coulomb'}"))
