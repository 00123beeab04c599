"""Fracture on ranks is that of one rank."""

import unittest

import h5py

from tests.acceptance.on_ranks import SOLVER, Comparison, rows

# Torn through, from a pre-crack and a hole, without any symmetry.
TORN = """
dimension = 2
[lattice]
spacing = 0.1
thickness = 0.01
shape = [{ add = "box", min = [0, 0], max = [1.2, 1.6] }, { subtract = "disk", centre = [0.72, 0.83], radius = 0.2 }]
layer = [{ name = "bottom", side = "y-" }, { name = "top", side = "y+" }]
[[crack]]
from = [0, 0.9]
to = [0.22, 0.93]
[material]
model = "bond"
youngs_modulus = 1e9
[material.damage]
law = "tanh"
onset = 0.02
critical = 0.03
rate = 3
no_fail = ["bottom", "top"]
[[support]]
set = "bottom"
displacement = [0, 0]
[[support]]
set = "top"
displacement = ["0.01*load", "0.08*load"]
[loading]
steps = 4
[relaxation]
steps = 12
"""


class Fracture(Comparison):
    """Which bonds break, in which step, and all fields are those of one rank."""

    def broken(self, output):
        return [(row["step"], row["first_point"], row["second_point"]) for row in rows(output, "broken_bonds.csv")]

    def compare_torn(self, ranks, *settings):
        text = TORN + SOLVER
        options = [word for setting in settings for word in ("--set", setting)]
        runs = {count: self.start(count, text, *options) for count in (1, *ranks)}
        one, expected = runs[1]
        for count in ranks:
            several, found = runs[count]
            with self.subTest(ranks=count, settings=settings):
                self.assertEqual(several.returncode, one.returncode, several.stderr)
                self.assertEqual(self.broken(expected), self.broken(found))
                self.expect_same(expected, found)
                decisions = [[(row["step"], row["action"], row["outcome"]) for row in rows(at, "decisions.csv")]
                             for at in (expected, found)]  # fmt: skip
                self.assertEqual(*decisions)
        return expected

    def test_bonds_that_soften_in_implicit_steps(self):
        for law in ('"tanh", onset=0.03, critical=0.5, rate=3', '"linear", onset=0.03, critical=0.6',
                    '"exponential", onset=0.05, critical=0.9', '"critical_stretch", critical=0.1'):  # fmt: skip
            one = self.compare_torn((3,), f"material.damage={{law={law}}}", 'solver.mode="newton"')
            with h5py.File(one / "results.h5") as file:
                self.assertGreater(file["history/dissipated_energy"][-1], 0.0)

    def test_a_plate_that_is_torn(self):
        one = self.compare_torn((2, 3), 'solver.mode="adaptive"')
        actions = [row["action"] for row in rows(one, "decisions.csv")]
        self.assertIn("hand over to relaxation", actions)
        self.compare_torn((3,), 'solver.mode="adaptive"', "solver.elastic_horizon_ratio=2.015")
        self.assertGreater(len(rows(one, "broken_bonds.csv")), 50)

    def test_ends_of_fracture(self):
        for settings in (
            ('solver.mode="newton"', "loading.max_broken_bonds=3", 'material.damage={law="critical_stretch", critical=0.06}',
             "output.count_cracks=true", "loading.smallest_step=0.01"),
            ('solver.mode="adaptive"', "loading.stop_below=0.5", 'solver.projection="always"'),
            ('solver.mode="relaxation"', 'solver.fragments="stop"'),
        ):  # fmt: skip
            self.compare_torn((3,), *settings)

    def test_ways_of_relaxation(self):
        for settings in (
            ('solver.mode="relaxation"', 'relaxation.breaking="transient"'),
            ('solver.mode="relaxation"', 'relaxation.load="moving"', "relaxation.iterations=1200", 'relaxation.damping="kinetic"'),
            ('solver.mode="adaptive"', 'relaxation.method="flow"'),
            ('solver.mode="adaptive"', "relaxation.peak_tolerance=0.01", 'solver.fragments="remove"'),
        ):
            self.compare_torn((3,), *settings)


if __name__ == "__main__":
    unittest.main()
