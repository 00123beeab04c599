"""The program beside the reference of tests/reference: energies, forces, tangents, runs."""

import collections
import itertools
import pathlib
import tempfile
import unittest

import numpy

from tests.reference.body import Body
from tests.reference.case import Case, evaluate, read_points
from tests.reference.clouds import LAWS, random_cloud, random_deformation
from tests.reference.mechanics import STEP, Mechanics
from tests.reference.program import peristat
from tests.reference.verify import Verification

# Both sides sum some 10^2 to 10^4 terms of stretches near 1e-2 in double precision: a term has lost
# two digits of 16, and terms that cancel in a sum one or two more.
ROUND_OFF = 1e-12


def mechanics_of(path):
    case = Case(path.read_text(), path.parent)
    reference, volume, sets = read_points(case)
    mechanics = Mechanics(Body(case, reference, volume, sets=sets))
    mechanics.spare(sets)
    return mechanics, sets


class Clouds(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="peristat_reference_")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.random = numpy.random.default_rng(20)

    def compare(self, path, amount, size):
        """check-tangent beside the reference; returns the reference and the displacements."""
        mechanics, _ = mechanics_of(path)
        reference = mechanics.body.reference
        expressions = random_deformation(self.random, reference.shape[1], size, amount)
        displacement = numpy.stack([evaluate(e, reference) for e in expressions], 1) - reference
        run = peristat("check-tangent", path, "--deformation", "; ".join(expressions))
        self.assertEqual(run.code, 0, run.said)
        told, tangent = run.json(), mechanics.tangent(displacement)
        forces = mechanics.gradient(displacement)
        for key, value in (("energy", mechanics.energy(displacement)),
                           ("residual_norm", numpy.linalg.norm(forces)),
                           ("tangent_frobenius_norm", numpy.linalg.norm(tangent))):  # fmt: skip
            self.assertGreater(value, 0)
            self.assertAlmostEqual(told[key] / value, 1, delta=ROUND_OFF, msg=f"{key}: {told[key]} and {value}")
        self.assertLess(numpy.abs(tangent - tangent.T).max(), 1e-13 * numpy.abs(tangent).max())
        self.assertLess(told["force_sum"], ROUND_OFF)
        self.assertLess(told["moment_sum"], ROUND_OFF)
        return mechanics, displacement

    def assert_forces_are_derivatives(self, mechanics, displacement):
        """The reference beside itself: its forces are complex steps of its energy."""
        forces, scale = mechanics.gradient(displacement), mechanics.gradient(displacement, absolute=True).max()
        for place in itertools.islice(numpy.ndindex(displacement.shape), 8):
            moved = displacement.astype(complex)
            moved[place] += 1j * STEP
            self.assertAlmostEqual(mechanics.energy(moved).imag / STEP / scale, forces[place] / scale, delta=1e-13)

    def test_bonds_with_every_correction_and_law(self):
        compared, seen = 0, collections.Counter()
        for dimension, plane in ((1, "stress"), (2, "stress"), (2, "strain"), (3, "stress")):
            corrections = itertools.product(("none", "linear"), ("none", "volume", "energy"))
            for (volume, surface), law in itertools.product(corrections, LAWS):
                with self.subTest(dimension=dimension, plane=plane, volume=volume, surface=surface, law=law):
                    material = {"youngs_modulus": 3e3, **({"plane": plane} if dimension == 2 else {})}
                    if LAWS[law]:
                        material["damage"] = {**LAWS[law], "no_fail": ["left"]}
                    path = random_cloud(self.random, self.folder, dimension, count=(9, 24, 30)[dimension - 1],
                                        horizon=self.random.uniform(2.2, 3.2), material=material,
                                        quadrature={"volume_correction": volume, "surface_correction": surface},
                                        )  # fmt: skip
                    mechanics, displacement = self.compare(path, 0.07, 6.0)
                    history = mechanics.grown(mechanics.no_history(), displacement)
                    seen["stretched"] += int((mechanics.stretch(displacement) > 0).sum())
                    seen["compressed"] += int((mechanics.stretch(displacement) < 0).sum())
                    seen["broken"] += int(mechanics.is_broken(history).sum())
                    seen["softening"] += int(((history > 0) & ~mechanics.is_broken(history)).sum())
                    if (volume, surface) == ("linear", "energy"):
                        self.assert_forces_are_derivatives(mechanics, displacement)
                    compared += 1
        self.assertEqual(compared, 4 * 6 * len(LAWS))
        self.assertGreater(min(seen[kind] for kind in ("stretched", "compressed", "broken", "softening")), 100)

    def test_cpd_with_both_weights(self):
        compared = 0
        for dimension, weights, law in itertools.product((2, 3), ("mean", "bulk"), LAWS):
            with self.subTest(dimension=dimension, weights=weights, law=law):
                material = {"model": "cpd", "c1": 2.0, "c2": 0.7}
                if dimension == 3:
                    material["c3"] = 0.4
                if LAWS[law]:
                    material["damage"] = {**LAWS[law], "no_fail": ["left"]}
                path = random_cloud(self.random, self.folder, dimension, count=(0, 22, 18)[dimension - 1],
                                    horizon=self.random.uniform(2.05, 2.3), material=material,
                                    quadrature={"weights": weights})  # fmt: skip
                mechanics, displacement = self.compare(path, 0.07, 4.0)
                self.assertTrue(all(len(tuples) > 0 for tuples in mechanics.body.tuples.values()))
                self.assert_forces_are_derivatives(mechanics, displacement)
                compared += 1
        self.assertEqual(compared, 4 * len(LAWS))

    def test_cpd_of_few_and_nearly_flat_points(self):
        """Where flatness factors lie between 0 and 1, and where those of a point sum up to less than 1."""
        between = below = 0
        for dimension, count in itertools.product((2, 3), (7, 8, 9, 10)):
            with self.subTest(dimension=dimension, count=count):
                material = {"model": "cpd", "c1": 2.0, "c2": 0.7, **({"c3": 0.4} if dimension == 3 else {})}
                path = random_cloud(self.random, self.folder, dimension, count=count, horizon=1.5,
                                    material=material)  # fmt: skip
                if dimension == 3 and not len(mechanics_of(path)[0].body.tuples[3]):
                    run = peristat("check", path)
                    self.assertEqual(run.code, 2, run.said)
                    self.assertIn("material.c3", run.said)
                    continue
                mechanics, _ = self.compare(path, 0.05, 3.0)
                for factor in mechanics.body.flatness.values():
                    between += int(((factor > 0.01) & (factor < 0.99)).sum())
                below += sum(int(((n > 0) & (n < 1)).sum()) for n in mechanics.body.factor_sums.values())
        self.assertGreater(between, 10)
        self.assertGreater(below, 5)

    def test_accepted_states_of_runs_are_what_they_claim(self):
        judged = 0
        kinds = [("bond", dimension) for dimension in (1, 2, 3)] + [("cpd", 2), ("cpd", 3)]
        for (model, dimension), law in itertools.product(kinds, LAWS):
            with self.subTest(model=model, dimension=dimension, law=law):
                material = {"micromodulus": 50.0} if model == "bond" else {"model": "cpd", "c1": 50.0, "c2": 9.0}
                quadrature = {"volume_correction": "linear", "surface_correction": "energy"} if model == "bond" else {}
                if LAWS[law]:
                    material["damage"] = {**LAWS[law], "no_fail": ["left", "right"]}
                still = [0] * dimension
                pulled = ["0.25*load", *still[1:]]
                path = random_cloud(self.random, self.folder, dimension, count=(10, 28, 36)[dimension - 1], horizon=2.2,
                                    material=material, quadrature=quadrature,
                                    support=[{"set": "left", "displacement": still}, {"set": "right", "displacement": pulled}],
                                    load=[{"set": "middle", "total_force": ["0.3*load", *still[1:]]}],
                                    loading={"steps": 4}, relaxation={"steps": 8},
                                    solver={"mode": "adaptive" if LAWS[law] else "newton"})  # fmt: skip
                output = self.folder / f"{model}_{dimension}_{law}"
                run = peristat("run", path, "--quiet", "--output", output)
                self.assertIn(run.code, (0, 3), run.said)
                verification = Verification(output, path.read_text(), self.folder)
                if verification.histories_are_known:
                    self.assertEqual(verification.run(), [])
                    judged += len(verification.results.steps)
        self.assertGreater(judged, 60)


if __name__ == "__main__":
    unittest.main()
