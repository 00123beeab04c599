"""Bodies of several materials beside the reference, and what is refused of them."""

import itertools
import json
import pathlib
import subprocess
import tempfile
import unittest

import h5py
import numpy

from tests.acceptance.reference_test import ROUND_OFF, mechanics_of
from tests.reference.case import evaluate
from tests.reference.clouds import LAWS, random_cloud, random_deformation, toml_value
from tests.reference.program import PROGRAM, peristat
from tests.reference.verify import Verification

# Laws of two materials and of the rest: of one kind, of unlike kinds, with and without one.
UNLIKE = {
    "alike": ("tanh", "tanh", "tanh"),
    "brittle and softening": ("critical_stretch", "tanh", "tanh_continuous"),
    "one fails": ("none", "tanh_continuous", "none"),
    "none fails": ("none", "none", "none"),
}
STILL = {"set": "left"}


def law(name, scale):
    """A law with its stretches multiplied."""
    table = LAWS[name]
    return {"damage": {k: v * scale if k in ("onset", "critical") else v for k, v in table.items()}} if table else {}


class Regions(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="peristat_regions_")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.random = numpy.random.default_rng(33)

    def bonds(self, laws, stiffness=(3e3, 9e2, 2e4)):
        """Material of the rest, and two regions."""
        tables = [{"youngs_modulus": e, **law(name, s)} for e, name, s in zip(stiffness, laws, (1.0, 1.3, 0.8))]
        return tables[0], [{"set": "left", "material": tables[1]}, {"set": "right", "material": tables[2]}]

    def cpd(self, laws, dimension):
        tables = []
        for (c1, c2, c3), name, s in zip(((2.0, 0.7, 0.4), (5.0, 0.1, 0.0), (0.9, 1.2, 0.6)), laws, (1.0, 1.3, 0.8)):
            tables.append({"model": "cpd", "c1": c1, "c2": c2, **({"c3": c3} if dimension == 3 else {}), **law(name, s)})
        return tables[0], [{"set": "left", "material": tables[1]}, {"set": "right", "material": tables[2]}]

    def compare(self, path, amount, size, seen):
        """check-tangent beside the reference, in a state with damage."""
        mechanics, sets = mechanics_of(path)
        mechanics.spare(sets)
        reference = mechanics.body.reference
        expressions = random_deformation(self.random, reference.shape[1], size, amount)
        displacement = numpy.stack([evaluate(e, reference) for e in expressions], 1) - reference
        run = peristat("check-tangent", path, "--deformation", "; ".join(expressions))
        self.assertEqual(run.code, 0, run.said)
        told = run.json()
        for key, value in (("energy", mechanics.energy(displacement)),
                           ("residual_norm", numpy.linalg.norm(mechanics.gradient(displacement))),
                           ("tangent_frobenius_norm", numpy.linalg.norm(mechanics.tangent(displacement)))):  # fmt: skip
            self.assertGreater(value, 0)
            self.assertAlmostEqual(told[key] / value, 1, delta=ROUND_OFF, msg=f"{key}: {told[key]} and {value}")
        self.assertLess(max(told["force_sum"], told["moment_sum"]), ROUND_OFF)
        # differences over a state with damage, where they stand clear of round-off
        self.assertLess(told["tangent_error"], 1e-6)
        stretch = mechanics.stretch(displacement)
        seen += [numpy.any(mechanics.fails & (stretch > mechanics.law.onset) & (stretch < mechanics.law.critical)),
                 numpy.any(stretch > mechanics.law.critical)]  # fmt: skip
        return mechanics

    def test_bonds_by_every_rule(self):
        softening = broken = crossing = 0
        interfaces = [[]] + [[{"rule": rule}] for rule in ("harmonic", "arithmetic", "weaker")]
        own = {"between": ["left", "material"], "material": {"youngs_modulus": 50.0, **law("tanh", 0.7)}}
        interfaces += [[own, {"between": ["material", "right"], "rule": "weaker"}]]
        for dimension, (kind, laws), interface in itertools.product((1, 2, 3), UNLIKE.items(), interfaces):
            with self.subTest(dimension=dimension, kind=kind, interface=interface):
                material, regions = self.bonds(laws)
                path = random_cloud(self.random, self.folder, dimension, count=(9, 24, 27)[dimension - 1],
                                    horizon=self.random.uniform(2.2, 3.2), material=material, region=regions,
                                    quadrature={"volume_correction": "linear", "surface_correction": "energy"},
                                    **({"interface": interface} if interface else {}))  # fmt: skip
                seen = []
                mechanics = self.compare(path, 0.07, 6.0, seen)
                softening, broken = softening + seen[0], broken + seen[1]
                number = mechanics.body.materials.number[mechanics.body.bonds]
                crossing += int((number[:, 0] != number[:, 1]).sum())
        self.assertGreater(min(softening, broken), 15)
        self.assertGreater(crossing, 500)

    def test_cpd_by_every_rule(self):
        interfaces = [[]] + [[{"rule": rule}] for rule in ("arithmetic", "weaker")]
        several = 0
        for dimension, kind, interface in itertools.product((2, 3), ("alike", "one fails", "none fails"), interfaces):
            if dimension == 3 and interface:
                own = {"model": "cpd", "c1": 3.0, "c2": 0.2, "c3": 0.9}
                interface = [*interface, {"between": ["material", "left"], "material": own}]
            with self.subTest(dimension=dimension, kind=kind, interface=interface):
                material, regions = self.cpd(UNLIKE[kind], dimension)
                path = random_cloud(self.random, self.folder, dimension, count=(0, 22, 16)[dimension - 1],
                                    horizon=self.random.uniform(2.05, 2.3), material=material, region=regions,
                                    **({"interface": interface} if interface else {}))  # fmt: skip
                mechanics = self.compare(path, 0.07, 4.0, [])
                highest = mechanics.body.tuples[dimension]
                several += sum(len(set(row)) == 3 for row in mechanics.body.materials.number[highest].tolist())
        self.assertGreater(several, 10)  # tuples of points of all three materials

    def test_fibres_in_regions(self):
        for dimension, laws in itertools.product((2, 3), UNLIKE.values()):
            with self.subTest(dimension=dimension, laws=laws):
                material, regions = self.bonds(laws)
                where = {"angle": 30} if dimension == 2 else {"direction": [1, 2, -0.5]}
                material["fibre"] = {**where, "transverse_modulus": 1.5e3}
                where = {"angle": -70} if dimension == 2 else {"direction": [0, 0, 3]}
                regions[1]["material"]["fibre"] = {**where, "transverse_modulus": 6e3, "shear_modulus": 5e3}
                if laws[0] != "none":
                    material["fibre"]["transverse_critical"] = 0.04
                path = random_cloud(self.random, self.folder, dimension, count=(0, 24, 27)[dimension - 1], horizon=2.7,
                                    material=material, region=regions)  # fmt: skip
                mechanics = self.compare(path, 0.07, 6.0, [])
                share = mechanics.body.weight[1] / mechanics.body.volume[mechanics.body.bonds].prod(axis=1)
                self.assertGreater(share.max() / share.min(), 3)

    def test_accepted_states_of_runs_are_what_they_claim(self):
        judged = damaged = 0
        scatter = [{"of": "stiffness", "weibull_modulus": 6, "correlation_length": 2.0, "seed": 4}]
        for (model, dimension), kind in itertools.product((("bond", 1), ("bond", 2), ("bond", 3), ("cpd", 2)), UNLIKE):
            with self.subTest(model=model, dimension=dimension, kind=kind):
                laws = UNLIKE[kind]
                material, regions = self.bonds(laws) if model == "bond" else self.cpd(laws, dimension)
                regions[1]["material"]["scatter"] = list(scatter)
                if laws[0] != "none":
                    material["scatter"] = [{"of": "strength", "weibull_modulus": 8, "seed": 1}]
                    material["damage"]["no_fail"] = ["left"]
                still = [0] * dimension
                path = random_cloud(self.random, self.folder, dimension, count=(10, 28, 36)[dimension - 1], horizon=2.2,
                                    material=material, region=regions,
                                    support=[{"set": "left", "displacement": still},
                                             {"set": "right", "displacement": ["0.25*load", *still[1:]]}],
                                    load=[{"set": "middle", "total_force": ["0.3*load", *still[1:]]}],
                                    loading={"steps": 4}, relaxation={"steps": 8},
                                    solver={"mode": "newton" if kind == "none fails" else "adaptive"})  # fmt: skip
                output = self.folder / f"{model}_{dimension}_{kind.replace(' ', '_')}"
                run = peristat("run", path, "--quiet", "--output", output)
                self.assertIn(run.code, (0, 3), run.said)
                verification = Verification(output, path.read_text(), self.folder)
                self.assertTrue(verification.histories_are_known)
                self.assertEqual(verification.run(), [])
                judged += len(verification.results.steps)
                damaged += any(step.damage.max() > 0 for step in verification.results.steps)
        self.assertGreater(judged, 40)
        self.assertGreater(damaged, 6)


if __name__ == "__main__":
    unittest.main()
