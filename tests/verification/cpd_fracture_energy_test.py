"""Fracture energy of cpd: the energy of tears through the command line, compared with the requested one."""

import itertools
import math
import unittest

import numpy

from tests.acceptance.folder import Folder
from tests.reference.case import Case
from tests.reference.laws import Law
from tests.reference.pull import Pull, uniaxial
from tests.reference.sheets import resolve
from tests.reference.tear import Tear, directions

SPACING, RATIO, G = 1e-3, 2.015, 4e3
C1, C2 = 5e19, 3e27
STEPS = 200
PEAK = 1e-7  # of a peak that is searched for by steps
# Directions of the lattice in which it repeats, with the period in spacings, and a little more than
# the opening over s_c at which the bond breaks that is flattest to the plane, L^2 / h in spacings.
ANGLES = ((0.0, 1.0, 2.1), (math.degrees(math.atan(0.5)), math.sqrt(5.0), 4.7), (45.0, math.sqrt(2.0), 3.0))


class CpdFractureEnergy(Folder):
    threads = 2

    def strip(self, length, angle, damage, steps=1, opening=0.0):
        """Two halves are pulled apart as rigid blocks, in small steps, until no bond joins them."""
        half = (RATIO + 1) * SPACING
        return {
            "dimension": 2,
            "lattice": {"spacing": SPACING, "horizon_ratio": RATIO, "angle": angle, "thickness": 0.5,
                        "shape": [{"add": "box", "min": [0, -half], "max": [length, half]}]},
            "set": [{"name": "low", "where": "y < 1.23e-5"}, {"name": "high", "where": "y >= 1.23e-5"}],
            "quadrature": {"weights": "bulk"},  # the strip consists of surface
            "material": {"model": "cpd", "c1": C1, "c2": C2, "damage": damage},
            "support": [{"set": "low", "displacement": [0, 0]}, {"set": "high", "displacement": [0, f"{opening}*load"]}],
            "loading": {"steps": steps}, "solver": {"mode": "relaxation"}, "output": {"every": steps},
        }  # fmt: skip

    def told(self, tables, *words):
        return self.assert_completed(self.command("calibrate", tables, words=words)).json()["damage"]

    def dissipated(self, tables):
        return self.results(tables).summary["energy"]["dissipated"]

    def test_a_torn_strip_takes_what_was_told(self):
        for law, angles in (("critical_stretch", ANGLES), ("linear", ANGLES[:1])):
            damage = {"law": law, "fracture_energy": G, "drive": "stretch"}
            told = self.told(self.strip(0.03, 0.0, damage))
            self.assertAlmostEqual(told["fracture_energy"]["mean"] / G, 1.0, delta=1e-9)
            found = {"law": law} | {key: told[key] for key in ("onset", "critical") if key in told}
            tear = Tear(2, RATIO, SPACING, 0.5, {1: C1, 2: C2})
            for angle, period, last in angles:
                with self.subTest(law=law, angle=angle):
                    normal = [math.sin(math.radians(angle)), math.cos(math.radians(angle))]
                    foretold = tear.energy(found, normal)
                    took = self.tear(angle, period, damage, last * told["critical"] * SPACING)
                    # A step exceeds the breaking opening by half of one of the STEPS, with a quadratic effect.
                    self.assertAlmostEqual(took / foretold, 1.0, delta=0.01)
                    self.assertGreater(foretold / tear.of_bonds(found, normal), 1.1)  # triangles matter
                    if angle == 0.0:
                        self.assertAlmostEqual(foretold / told["fracture_energy"]["axes"][0], 1.0, delta=1e-9)

    def tear(self, angle, period, damage, opening):
        """Dissipated energy over area in the middle of a strip: the increase from a shorter to a longer strip."""
        periods = math.ceil((2 * RATIO + 2) / period)
        lengths = [n * period * SPACING * (1 + 1e-12) for n in (periods, periods + 2)]
        short, long = (self.dissipated(self.strip(n, angle, damage, STEPS, opening)) for n in lengths)
        return (long - short) / (2 * period * SPACING * 0.5)

    def test_stretches_are_those_of_the_reference(self):
        laws = ({"law": "critical_stretch"}, {"law": "tanh"}, {"law": "linear", "onset": 2e-3}, {"law": "exponential"})
        for law, drive in itertools.product(laws, ("stretch", "release")):
            with self.subTest(law=law["law"], drive=drive):
                damage = law | {"fracture_energy": G, "drive": drive}
                told = self.told(self.strip(0.03, 0.0, damage))
                case = Case(self.strip(0.03, 0.0, damage))
                resolve(case)
                found = case["material"]["damage"]
                for key in {"onset", "critical"} & set(told):
                    self.assertAlmostEqual(told[key] / float(found[key]), 1.0, delta=1e-9)

    def test_in_space_the_reference_takes_as_much(self):
        constants = {"c1": 4e20, "c2": 1e28, "c3": 7e37}
        options = [word for key, value in constants.items() for word in (f"--{key}", repr(value))]
        ended = self.peristat("calibrate", "--dimension", "3", "--spacing", "1e-3", "--horizon-ratio", "2", *options,
                              "--law", "critical_stretch", "--fracture-energy", "500", "--drive", "stretch")  # fmt: skip
        told = self.assert_completed(ended).json()["damage"]
        tear = Tear(3, 2.0, 1e-3, 1.0, dict(zip((1, 2, 3), constants.values(), strict=True)))
        damage = {"law": "critical_stretch", "critical": told["critical"]}
        self.assertAlmostEqual(tear.mean(damage) / 500, 1.0, delta=1e-9)

    def test_stretches_heed_the_influence_function(self):
        constants = {"c1": 4e20, "c2": 1e28, "c3": 7e37}
        for dimension, influence in ((2, "cubic"), (2, "gaussian"), (2, "linear"), (3, "septic"), (3, "inverse")):
            with self.subTest(dimension=dimension, influence=influence):
                of = dict(list(constants.items())[:dimension])
                options = [word for key, value in of.items() for word in (f"--{key}", repr(value))]
                ended = self.peristat("calibrate", "--dimension", dimension, "--spacing", "1e-3", "--horizon-ratio", "2",
                                      *options, "--law", "linear", "--fracture-energy", "500",
                                      "--influence", influence, "--drive", "stretch")  # fmt: skip
                told = self.assert_completed(ended).json()
                tear = Tear(dimension, 2.0, 1e-3, 1.0, dict(zip((1, 2, 3), of.values())), influence)
                damage = {"law": "linear"} | {key: told["damage"][key] for key in ("onset", "critical")}
                self.assertAlmostEqual(tear.mean(damage) / 500, 1.0, delta=1e-9)
                self.assertIsNone(told["continuum"])

    def test_a_strength_comes_back_and_check_tells_both(self):
        tables = self.strip(0.03, 0.0, {"law": "linear", "fracture_energy": G, "strength": 2e8, "drive": "stretch"})
        material = tables["material"]
        del material["c1"], material["c2"]
        material |= {"youngs_modulus": 70e9, "poisson_ratio": 0.4}
        run = self.assert_completed(self.command("check", tables))
        line = next(line for line in run.output.splitlines() if line.startswith("fracture "))
        self.assertIn("fracture energy 4000 J/m2 in the mean over the directions of a crack (", line)
        self.assertIn("strength 2e+08 Pa in the mean over the directions of a pull (", line)

    def of_moduli(self, damage):
        tables = self.strip(0.03, 0.0, damage)
        del tables["material"]["c1"], tables["material"]["c2"]
        tables["material"] |= {"youngs_modulus": 70e9, "poisson_ratio": 0.4}
        return tables

    def test_stretches_of_a_strength_have_that_strength(self):
        for damage, keys in (({"law": "linear", "critical": 0.02}, ("onset", "critical")), ({"law": "exponential", "critical": 0.02}, ("onset", "critical")),
                             ({"law": "critical_stretch"}, ("critical",))):  # fmt: skip
            with self.subTest(law=damage["law"]):
                told = self.told(self.of_moduli(damage | {"strength": 3e8}))
                self.assertAlmostEqual(told["strength"] / 3e8, 1.0, delta=1e-7)
                # In reverse: uniaxial tension of the lattice whose bonds have these stretches.
                pulled = self.of_moduli({"law": damage["law"]} | {key: told[key] for key in keys})
                peak = self.told(pulled, "--strengths")["strengths"]["uniaxial"]["peak"]
                self.assertAlmostEqual(peak["mean"] / 3e8, 1.0, delta=1e-6)
                self.assertLess(peak["least"], 3e8)
                self.assertGreater(peak["most"], 3e8)

    def test_strengths_are_those_of_the_reference(self):
        """Strengths in uniaxial tension, equal biaxial tension and shear, with triangles that fail with their bonds."""
        shear = lambda normal: uniaxial(normal) - uniaxial([-normal[1], normal[0]])
        normals, weights = directions(2)
        pull, of_bonds = Pull.of_cpd(Tear(2, RATIO, SPACING, 0.5, {1: C1, 2: C2})), Pull.of_cpd(Tear(2, RATIO, SPACING, 0.5, {1: C1}))
        for law in ("linear", "exponential", "tanh_continuous", "critical_stretch"):
            with self.subTest(law=law):
                damage = {"law": law, "critical": 0.016} | ({} if law == "critical_stretch" else {"onset": 0.002})
                strengths = self.told(self.strip(0.03, 0.0, damage), "--strengths")["strengths"]
                told = {stress: of.get("peak") for stress, of in strengths.items()}
                of = Law.of_table(damage)
                for stress, form in (("uniaxial", uniaxial), ("shear", shear))[: 2 if law == "linear" else 1]:
                    found = [pull.peak(of, form(normal)) for normal in normals]
                    self.assertAlmostEqual(told[stress]["mean"] / numpy.dot(weights, found), 1.0, delta=PEAK, msg=stress)
                    ends = [pull.peak(of, form(normal)) for normal in ([1, 0], [1, 1])]
                    self.assertAlmostEqual(told[stress]["least"] / min(*found, *ends), 1.0, delta=PEAK, msg=stress)
                    self.assertAlmostEqual(told[stress]["most"] / max(*found, *ends), 1.0, delta=PEAK, msg=stress)
                biaxial = pull.peak(of, numpy.eye(2))
                self.assertAlmostEqual(told["biaxial"]["mean"] / biaxial, 1.0, delta=PEAK)
                self.assertGreater(biaxial / of_bonds.peak(of, numpy.eye(2)), 1.1)  # triangles matter

    def test_a_strength_needs_no_moduli(self):
        tables = self.strip(0.03, 0.0, {"law": "linear", "critical": 0.02, "strength": 2e8})
        ended = self.assert_completed(self.command("check", tables))
        self.assertIn("strength 2e+08 Pa in the mean over the directions of a pull (", ended.said)

    def test_strengths_without_an_answer_are_refused(self):
        for law, strength, words in (("critical_stretch", 2e8, "one stretch for both"),
                                     ("linear", 2e9, "a spacing below")):  # fmt: skip
            with self.subTest(words=words):
                tables = self.of_moduli({"law": law, "fracture_energy": G, "strength": strength, "drive": "stretch"})
                self.assert_refused(self.command("check", tables), "material.damage.strength", words)

    def test_too_long_a_horizon_is_refused(self):
        ended = self.peristat("calibrate", "--dimension", "3", "--spacing", "1e-3", "--horizon-ratio", "4",
                              "--youngs-modulus", "70e9", "--poisson-ratio", "0.4", "--law", "critical_stretch",
                              "--fracture-energy", "10", "--drive", "stretch")  # fmt: skip
        self.assert_refused(ended, "is for horizon ratios up to 3.2 with cpd in 3D")


if __name__ == "__main__":
    unittest.main()
