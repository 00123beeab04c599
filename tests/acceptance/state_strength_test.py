"""Strength of model state, from the command line: what calibrate and check tell, compared with the reference of
tests/reference/states_pull.py, and patches of the lattice that bear it."""

import json

import numpy

from tests.acceptance.folder import Folder
from tests.acceptance.motions import columns
from tests.reference.laws import Law
from tests.reference.states_pull import StatePull

E, STRENGTH, ENERGY = 30e9, 3e6, 2.6
SPACES = ((2, 0.0, "stress"), (2, 0.2, "stress"), (2, 1 / 3, "stress"), (2, 0.45, "stress"), (2, 0.3, "strain"), (3, 0.2, "stress"))


def question(dimension, nu, plane, *more):
    words = ["--model", "state", "--dimension", dimension, "--spacing", 1e-3, "--horizon-ratio", 3.015, "--youngs-modulus", E]
    words += ["--plane", plane] if dimension == 2 else []
    return [*words, "--poisson-ratio", repr(nu), *more]


LINEAR = ("--law", "linear", "--fracture-energy", ENERGY, "--strength", STRENGTH)


class StateStrength(Folder):
    def told(self, *words):
        return self.assert_completed(self.peristat("calibrate", *words)).json()

    def test_a_strength_is_what_the_reference_finds_with_its_stretches(self):
        for dimension, nu, plane in SPACES:
            pull = StatePull(dimension, 3.015, E, nu, plane=plane)
            with self.subTest(dimension=dimension, nu=nu, law="linear"):
                told = self.told(*question(dimension, nu, plane, *LINEAR))["damage"]
                self.assertAlmostEqual(told["strength"] / STRENGTH, 1, delta=1e-7)
                self.assertAlmostEqual(told["fracture_energy"]["mean"] / ENERGY, 1, delta=1e-9)
                law = Law.of_table({"law": "linear"} | {key: told[key] for key in ("onset", "critical")})
                # First order in the steps of the reference.
                self.assertAlmostEqual(pull.strength(law, step=2e-3) / STRENGTH, 1, delta=3e-4)
            with self.subTest(dimension=dimension, nu=nu, law="critical_stretch"):
                told = self.told(*question(dimension, nu, plane, "--law", "critical_stretch", "--strength", STRENGTH))["damage"]
                law = Law.of_table({"law": "critical_stretch", "critical": told["critical"]})
                self.assertAlmostEqual(pull.strength(law, step=2e-3) / STRENGTH, 1, delta=1e-6)

    def test_one_stress_of_a_bond_model_and_of_states_where_lambda_is_mu(self):
        """The bonds' influence r/delta K(r) is that of states with K."""
        words = ("--law", "linear", "--onset", 1e-4, "--critical", 4e-4, "--strengths")
        for dimension, nu in ((2, 1 / 3), (3, 0.25)):
            states = self.told(*question(dimension, nu, "stress", *words))["damage"]
            bond = ["--model", "bond", *question(dimension, nu, "stress", *words)[2:], "--calibration", "lattice"]
            del bond[bond.index("--poisson-ratio") : bond.index("--poisson-ratio") + 2]
            bonds = self.told(*bond)["damage"]
            for loading in ("uniaxial", "biaxial", "shear", "compression"):
                for stress, spread in bonds["strengths"][loading].items():
                    for key, value in spread.items():
                        self.assertAlmostEqual(states["strengths"][loading][stress][key] / value, 1, delta=1e-9)

    def patch(self, dimension, nu, plane, damage, strain, steps):
        """A cell of an infinite body under uniaxial strain, free to contract across it."""
        edge = 4e-3
        tables = {
            "dimension": dimension,
            "lattice": {"spacing": 1e-3, "horizon_ratio": 3.015, "shape": [{"add": "box", "min": [0] * dimension, "max": [edge] * dimension}]},
            "material": {"model": "state", "youngs_modulus": E, "poisson_ratio": nu, "damage": damage},
            "period": [], "loading": {"steps": steps}, "solver": {"mode": "newton"}, "output": {"every": steps},
        }  # fmt: skip
        if dimension == 2:
            tables["lattice"]["thickness"], tables["material"]["plane"] = 1e-3, plane
        for k, axis in enumerate("xyz"[:dimension]):
            gradient = [0] * dimension
            gradient[k] = f"{strain!r}*load" if k == 0 else "free"
            tables["period"].append({"axis": axis, "from": 0, "to": edge, "gradient": gradient})
        rows = columns(self.run_case(tables, code=(0, 3), name="patch"))
        return abs(rows["reaction_x:period_x"]) / (edge * (1e-3 if dimension == 2 else edge))

    def test_a_patch_bears_the_strength_of_its_direction(self):
        """Up to the peak a patch without flaws stays homogeneous."""
        for dimension, nu, plane in SPACES:
            with self.subTest(dimension=dimension, nu=nu):
                told = self.told(*question(dimension, nu, plane, *LINEAR))["damage"]
                law = Law.of_table({"law": "linear"} | {key: told[key] for key in ("onset", "critical")})
                along = StatePull(dimension, 3.015, E, nu, plane=plane).peak(law, [1] + [0] * (dimension - 1), step=2e-3)
                self.assertAlmostEqual(along / STRENGTH, 1, delta=0.06)  # of this direction, not of all
                damage = {"law": "linear", "fracture_energy": ENERGY, "strength": STRENGTH}
                stress = self.patch(dimension, nu, plane, damage, 2.2 * STRENGTH / E, 110)
                self.assertAlmostEqual(stress.max() / along, 1, delta=0.01)

    def test_check_tells_strengths_and_warns_of_coarse_lattices(self):
        case = {"dimension": 2, "lattice": {"spacing": 1e-3, "horizon_ratio": 3.015, "thickness": 1e-3, "shape": [{"add": "box", "min": [0, 0], "max": [0.02, 0.02]}]},
                "set": [{"name": "low", "where": "y < 0.003"}, {"name": "high", "where": "y > 0.017"}],
                "support": [{"set": "low", "displacement": [0, 0]}, {"set": "high", "displacement": [0, "1e-6*load"]}],
                "material": {"model": "state", "youngs_modulus": E, "poisson_ratio": 0.2, "damage": {"law": "linear", "fracture_energy": ENERGY, "strength": STRENGTH}}}  # fmt: skip
        ended = self.assert_completed(self.command("check", case))
        self.assertIn("strength 3e+06 Pa in the mean over the directions of a pull (", ended.said)
        self.assertIn("shear strength", ended.said)
        self.assertNotIn("the spacing is coarse", ended.said)
        coarse = self.assert_completed(self.command("check", case, "material.damage.fracture_energy=0.9"))
        self.assertIn("the spacing is coarse for the process zone", coarse.said)
        self.assertIn("a spacing below", self.refusal(case, "material.damage.fracture_energy=0.5"))
        self.assertIn("damage.strength is missing", self.assert_completed(self.command("check", case, 'material.damage={law="linear", fracture_energy=2.6}')).said)
        self.assertIn("one stretch for both", self.refusal(case, 'material.damage.law="critical_stretch"'))
        self.assertIn("larger poisson_ratio", self.refusal(case, "material.poisson_ratio=-0.5"))
        self.assertIn("no strength", self.assert_completed(self.command("check", case, "material.poisson_ratio=-0.5", 'material.damage={law="linear", fracture_energy=2.6}')).said)

    def test_a_case_is_calibrated_like_the_options(self):
        case = {"dimension": 2, "lattice": {"spacing": 1e-3, "horizon_ratio": 3.015, "thickness": 1.0, "shape": [{"add": "box", "min": [0, 0], "max": [0.02, 0.02]}]},
                "set": [{"name": "all", "where": "1"}], "support": [{"set": "all", "displacement": [0, 0]}],
                "material": {"model": "state", "youngs_modulus": E, "poisson_ratio": 0.2, "damage": {"law": "linear", "fracture_energy": ENERGY, "strength": STRENGTH}}}  # fmt: skip
        of_case = self.assert_completed(self.command("calibrate", case)).json()
        of_options = self.told(*question(2, 0.2, "stress", *LINEAR))
        self.assertEqual(json.dumps(of_case), json.dumps(of_options))
        numpy.testing.assert_allclose([of_case["lambda"], of_case["mu"]], [E * 0.2 / 0.96, E / 2.4], rtol=1e-14)

    def test_calibrate_refuses_what_states_do_not_have(self):
        for option, value, word in (("--micromodulus", 1, "micromodulus"), ("--horizon-shape", "box", "horizon-shape"), ("--c1", 1, "c1"),
                                    ("--calibration", "lattice", "calibration"), ("--lambda", 1, "lambda")):  # fmt: skip
            with self.subTest(option):
                self.assert_refused(self.peristat("calibrate", *question(2, 0.2, "stress", option, value)), word)
