"""Bonds that are loaded and unloaded: force, energy and dissipation of every accepted step in closed form."""

import collections
import itertools
import unittest

import numpy

from tests.acceptance.folder import Folder
from tests.reference.case import Case
from tests.reference.clouds import toml, write_points
from tests.reference.laws import Law
from tests.reference.verify import Verification

LAWS = (
    {"law": "critical_stretch", "critical": 0.04},
    {"law": "tanh", "onset": 0.015, "critical": 0.05, "rate": 3.0},
    {"law": "tanh_continuous", "onset": 0.01, "critical": 0.05, "rate": 2.0},
    {"law": "tanh_continuous", "onset": 0.03, "critical": 0.031, "rate": 20.0},
    {"law": "linear", "onset": 0.012, "critical": 0.05},
    {"law": "exponential", "onset": 0.01, "critical": 0.045, "rate": 4.0},
    {"law": "blended", "onset": 0.01, "peak": 0.025, "critical": 0.045, "hardening": 0.3},
    {"law": "bilinear", "onset": 0.01, "critical": 0.045},
    {"law": "cornelissen", "onset": 0.006, "critical": 0.045},
    {"law": "table", "stretches": [0.01, 0.02, 0.03, 0.045], "forces": [0.01, 0.013, 0.006, 0.002]},
)
MODES = ("newton", "relaxation", "adaptive")
AXES = {1: ["x"], 2: ["x", "y"], 3: ["x", "y", "z"]}


def random_path(random, reach):
    """A displacement that rises, falls and changes sign, 0 at load 0, up to about `reach`."""
    waves = [f"{random.uniform(-1, 1):.4f}*sin({random.uniform(1, 15):.4f}*load)" for _ in range(3)]
    return f"{reach:.4f}*({' + '.join(waves)})"


class DamageHistory(Folder):
    threads = 2

    def setUp(self):
        super().setUp()
        self.random = numpy.random.default_rng(31)

    def tables(self, dimension, reference, sets, law, mode, supports):
        volume = self.random.uniform(0.5, 1.4, len(reference))
        write_points(self.folder / "points.csv", reference, volume, sets)
        return {
            "dimension": dimension, "points": {"file": "points.csv", "horizon": 1.6},
            "material": {"micromodulus": 100.0, "damage": law}, "support": supports,
            "loading": {"steps": 25}, "solver": {"mode": mode}, "relaxation": {"steps": 25},
        }  # fmt: skip

    def test_one_bond_follows_its_closed_form(self):
        seen = collections.Counter()
        for law, mode in itertools.product(LAWS, MODES):
            with self.subTest(law=law, mode=mode):
                self.one_bond(law, mode, seen)
        self.assertGreater(min(seen[kind] for kind in ("loading", "secant", "broken", "compressed")), 20)

    def one_bond(self, law, mode, seen):
        reference = numpy.array([[0.0], [1.0]])
        sets = {"left": numpy.array([True, False]), "right": numpy.array([False, True])}
        supports = [{"set": "left", "displacement": [0]},
                    {"set": "right", "displacement": [random_path(self.random, 0.04)]}]  # fmt: skip
        tables = self.tables(1, reference, sets, law, mode, supports)
        results = self.results(tables)
        weight = 100.0 * results.volume.prod()  # c w; the length is 1
        formula = Law.of_table(Case(toml(tables))["material"]["damage"] | {"rate": law.get("rate", 3.0)})
        largest = past = 0.0
        rows = results.table("history")[1:]  # without step 0, at rest
        self.assertGreaterEqual(len(rows), 25)
        for row, step in zip(rows, results.steps, strict=True):
            right = results.sets["right"]
            stretch = numpy.array([(step.displacement[right] - step.displacement[~right])[0, 0]])
            if stretch[0] > max(largest, formula.onset):
                largest = float(stretch[0])
                seen["loading"] += 1
            else:
                seen["secant" if largest else "elastic"] += 1
            kept = formula.integrity(numpy.array([largest]))[0] if largest else 1.0
            worn = numpy.array([largest])
            dissipated = weight * (formula.moment(worn)[0] - kept * largest**2 / 2) if largest else 0.0
            seen["broken"] += kept == 0
            seen["compressed"] += stretch[0] < 0
            # Strains of 1e-2 have lost two digits of 16; forces and energies are a few products each.
            self.assertAlmostEqual(row["reaction_x:right"], weight * kept * stretch[0], delta=1e-14 * weight)
            self.assertAlmostEqual(row["stored_energy"], weight * kept * stretch[0] ** 2 / 2, delta=1e-15 * weight)
            self.assertAlmostEqual(row["dissipated_energy"], dissipated, delta=1e-15 * weight)
            self.assertGreaterEqual(row["dissipated_energy"], past)
            past = row["dissipated_energy"]

    def test_six_bonds_follow_the_reference(self):
        seen = collections.Counter()
        # All laws in all modes; each law and each mode in both dimensions.
        for (law, mode), dimension in zip(itertools.product(LAWS, MODES), itertools.cycle((2, 3))):
            with self.subTest(dimension=dimension, law=law, mode=mode):
                self.six_bonds(dimension, law, mode, seen)
        self.assertGreater(seen["steps"], 300)
        self.assertGreater(min(seen["broken"], seen["softening"], seen["unloading"]), 50)

    def six_bonds(self, dimension, law, mode, seen):
        corners = numpy.array([[0, 0, 0], [1, 0, 0], [0.5, 0.87, 0], [0.5, 0.3, 0.8]])
        if dimension == 2:
            corners = numpy.array([[0, 0], [1, 0], [0, 1], [1, 1]])
        reference = corners + self.random.uniform(-0.08, 0.08, corners.shape)
        sets = {name: numpy.array([place == k for place in range(4)]) for k, name in enumerate("abcd")}
        still = [0] * dimension
        moved = [random_path(self.random, 0.05) for _ in range(dimension)]
        turned = ["free", *(random_path(self.random, 0.02) for _ in range(dimension - 1))]
        supports = [{"set": "a", "displacement": still}, {"set": "b", "displacement": moved},
                    {"set": "c", "displacement": turned}]  # fmt: skip
        tables = self.tables(dimension, reference, sets, law, mode, supports)
        verification = Verification(self.run_case(tables, code=(0, 3)), toml(tables), self.folder)
        self.assertEqual(verification.run(), [], self.ended.said)
        mechanics, history = verification.mechanics, verification.mechanics.no_history()
        self.assertEqual(len(mechanics.body.bonds), 6)
        for step in verification.results.steps:
            grown = mechanics.grown(history, step.displacement)
            seen["steps"] += 1
            seen["broken"] += int(mechanics.is_broken(grown).any())
            seen["softening"] += int((grown > history).any())
            seen["unloading"] += int(((grown > 0) & (mechanics.stretch(step.displacement) < grown)).any())
            history = grown


if __name__ == "__main__":
    unittest.main()
