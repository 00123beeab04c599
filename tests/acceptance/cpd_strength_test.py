"""Strength of cpd by release, from the command line: what calibrate and check tell, compared with the reference of
tests/reference/release_pull.py, and patches of the lattice that bear it."""

from tests.acceptance.folder import Folder
from tests.acceptance.motions import columns
from tests.reference.laws import Law
from tests.reference.release_pull import ReleasePull
from tests.reference.tear import Tear

E, STRENGTH, ENERGY, THICKNESS = 30e9, 3e6, 2.6, 1e-3
LINEAR = ("--law", "linear", "--fracture-energy", ENERGY, "--strength", STRENGTH)
SPACES = ((2, 3.015, 0.0), (2, 3.015, 0.2), (2, 3.015, 0.45), (3, 2.015, 0.1), (3, 2.015, 0.35))


def question(dimension, ratio, nu, *more):
    words = ["--dimension", dimension, "--spacing", 1e-3, "--horizon-ratio", ratio, "--youngs-modulus", E, "--drive", "release"]
    words += ["--thickness", THICKNESS] if dimension == 2 else []
    return [*words, "--poisson-ratio", repr(nu), *more]


class CpdStrength(Folder):
    def told(self, *words):
        return self.assert_completed(self.peristat("calibrate", *words)).json()

    def pull(self, dimension, ratio, told):
        constants = {order: told["lattice"][f"c{order}"] for order in range(1, dimension + 1)}
        return ReleasePull(Tear(dimension, ratio, 1e-3, THICKNESS if dimension == 2 else 1.0, constants))

    def test_a_strength_is_what_the_reference_finds_with_its_stretches(self):
        for dimension, ratio, nu in SPACES:
            with self.subTest(dimension=dimension, nu=nu, law="linear"):
                told = self.told(*question(dimension, ratio, nu, *LINEAR))
                damage = told["damage"]
                self.assertAlmostEqual(damage["strength"] / STRENGTH, 1, delta=1e-7)
                self.assertAlmostEqual(damage["fracture_energy"]["mean"] / ENERGY, 1, delta=1e-9)
                law = Law.of_table({"law": "linear"} | {key: damage[key] for key in ("onset", "critical")})
                pull = self.pull(dimension, ratio, told)
                # First order in the steps of the reference.
                if dimension == 2:
                    self.assertAlmostEqual(pull.strength(law, step=2e-3) / STRENGTH, 1, delta=3e-4)
                axis, diagonal = [1, 0, 0][:dimension], [1, 1, 1][:dimension]
                peaks = [pull.peak(law, normal, step=2e-3) for normal in (axis, diagonal)]
                self.assertLess(damage["uniaxial_strength"]["least"] / min(peaks), 1 + 3e-4)
                self.assertGreater(damage["uniaxial_strength"]["most"] / max(peaks), 1 - 3e-4)
            with self.subTest(dimension=dimension, nu=nu, law="critical_stretch"):
                told = self.told(*question(dimension, ratio, nu, "--law", "critical_stretch", "--strength", STRENGTH))
                law = Law.of_table({"law": "critical_stretch", "critical": told["damage"]["critical"]})
                self.assertAlmostEqual(self.pull(dimension, ratio, told).strength(law, step=2e-2) / STRENGTH, 1, delta=1e-6)

    def test_a_patch_bears_the_strength_of_its_direction(self):
        """A cell of an infinite body under uniaxial strain, free to contract across it, stays homogeneous up to the peak."""
        for nu in (0.1, 0.45):
            told = self.told(*question(2, 3.015, nu, *LINEAR))
            law = Law.of_table({"law": "linear"} | {key: told["damage"][key] for key in ("onset", "critical")})
            along = self.pull(2, 3.015, told).peak(law, [1, 0], step=2e-3)
            edge, strain = 4e-3, 2.2 * STRENGTH / E
            tables = {
                "dimension": 2,
                "lattice": {"spacing": 1e-3, "horizon_ratio": 3.015, "thickness": THICKNESS, "shape": [{"add": "box", "min": [0, 0], "max": [edge, edge]}]},
                "material": {"model": "cpd", "youngs_modulus": E, "poisson_ratio": nu,
                             "damage": {"law": "linear", "fracture_energy": ENERGY, "strength": STRENGTH}},
                "period": [{"axis": "x", "from": 0, "to": edge, "gradient": [f"{strain!r}*load", 0]},
                           {"axis": "y", "from": 0, "to": edge, "gradient": [0, "free"]}],
                "loading": {"steps": 110}, "solver": {"mode": "newton"}, "output": {"every": 110},
            }  # fmt: skip
            rows = columns(self.run_case(tables, code=(0, 3), name="patch"))
            stress = abs(rows["reaction_x:period_x"]).max() / (edge * THICKNESS)
            self.assertAlmostEqual(stress / along, 1, delta=0.01)

    def test_one_stress_of_both_drives_where_no_triangle_stands_on_a_bond(self):
        words = ("--law", "linear", "--onset", 1e-4, "--critical", 4e-4, "--strengths", "--c1", 1e21)
        of_bonds = ["--dimension", 2, "--spacing", 1e-3, "--horizon-ratio", 3.015, "--thickness", THICKNESS, *words]
        release, stretch = (self.told(*of_bonds, "--drive", drive)["damage"] for drive in ("release", "stretch"))
        self.assertEqual(release, stretch)
        # Hardly any triangles: the two ways to count bonds, one by one or by their directions.
        few, fewer = (self.told(*of_bonds, "--c2", 1e24, "--drive", drive)["damage"] for drive in ("release", "stretch"))
        for loading in ("uniaxial", "biaxial", "shear", "compression"):
            for stress, spread in few["strengths"][loading].items():
                for key, value in spread.items():
                    self.assertAlmostEqual(value / fewer["strengths"][loading][stress][key], 1, delta=1e-6)

    def test_stretches_of_a_case_are_those_of_its_strength(self):
        box = {"add": "box", "min": [0, 0], "max": [0.02, 0.02]}
        case = {"dimension": 2, "lattice": {"spacing": 1e-3, "horizon_ratio": 3.015, "thickness": THICKNESS, "shape": [box]},
                "set": [{"name": "low", "where": "y < 0.003"}, {"name": "high", "where": "y > 0.017"}],
                "support": [{"set": "low", "displacement": [0, 0]}, {"set": "high", "displacement": [0, "1e-6*load"]}],
                "material": {"model": "cpd", "youngs_modulus": E, "poisson_ratio": 0.2,
                             "damage": {"law": "linear", "fracture_energy": ENERGY, "strength": STRENGTH}}}  # fmt: skip
        ended = self.assert_completed(self.command("check", case))
        self.assertIn("strength 3e+06 Pa in the mean over the directions of a pull (", ended.said)
        self.assertIn("shear strength", ended.said)
        self.assertIn("a spacing below", self.refusal(case, "material.damage.fracture_energy=0.5"))
        self.assertIn("one stretch for both", self.refusal(case, 'material.damage.law="critical_stretch"'))

    def test_strengths_that_take_minutes_are_refused(self):
        for words in (question(3, 3.3, 0.1), question(3, 4, 0.1), question(2, 13, 0.1)):
            self.assert_refused(self.peristat("calibrate", *words, *LINEAR), "strength", "shorter horizon")
