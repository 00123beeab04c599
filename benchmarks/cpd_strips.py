"""A crack of cpd that runs through a clamped strip by release takes the fracture energy, at any Poisson's ratio:

    PERISTAT_PROGRAM=build/release/peristat /usr/bin/python3 -m unittest benchmarks/cpd_strips.py
"""

import math

from tests.acceptance.folder import Folder
from tests.acceptance.motions import columns

LENGTH, HEIGHT, TIP, G = 60, 24, 24, 60.0


class CpdStrip(Folder):
    def strip(self, nu, tip, opening, damage=None, steps=1):
        return {
            "dimension": 2,
            "lattice": {"spacing": 1e-3, "horizon_ratio": 3.015, "thickness": 1e-3,
                        "shape": [{"add": "box", "min": [0, 0], "max": [LENGTH * 1e-3, HEIGHT * 1e-3]}],
                        "layer": [{"name": "low", "side": "y-"}, {"name": "high", "side": "y+"}]},
            "material": {"model": "cpd", "youngs_modulus": 3e9, "poisson_ratio": nu} | ({"damage": damage} if damage else {}),
            "crack": [{"from": [-1e-3, HEIGHT / 2e3], "to": [tip * 1e-3, HEIGHT / 2e3]}],
            "support": [{"set": "low", "displacement": [0, 0]}, {"set": "high", "displacement": [0, f"{opening!r}*load"]}],
            "loading": {"steps": steps}, "solver": {"mode": "newton"},
        }  # fmt: skip

    def critical_opening(self, nu):
        """Opening at which an elastic strip has G, by its energy at two lengths of the crack."""
        small = 1e-5
        short, long = (columns(self.run_case(self.strip(nu, tip, small)))["stored_energy"][-1] for tip in (TIP, TIP + 8))
        return small * math.sqrt(G / ((short - long) / (8e-3 * 1e-3)))

    def test_a_crack_runs_at_its_fracture_energy_and_takes_it(self):
        damage = {"law": "linear", "fracture_energy": G, "drive": "release", "no_fail": ["low", "high"]}
        for nu in (0.0, 0.2):
            with self.subTest(nu=nu):
                rows = columns(self.run_case(self.strip(nu, TIP, 1.2 * self.critical_opening(nu), damage, 30)))
                broken = rows["broken_bonds"]
                runs = int((broken > 500).argmax())  # through the strip
                self.assertGreater(broken[runs], 500)
                released = (1.2 * rows["load_factor"][runs]) ** 2  # in multiples of G
                self.assertGreater(released, 1.0)
                # Steps of 8 % in G, the growth of the process zone, and what is left of the lattice's trapping.
                self.assertLess(released, 1.25)
                # Process zones at the tip and at the end of the strip take a little beside the crack.
                taken = rows["dissipated_energy"][runs] / (G * (LENGTH - TIP) * 1e-6)
                self.assertAlmostEqual(taken, 1.0, delta=0.04)

    def test_brittle_bonds_trap_a_crack_more_below_a_third(self):
        """Triangles of negative energy hold brittle bonds back: at 1.69 G_c a crack has run above, and not yet below."""
        damage = {"law": "critical_stretch", "fracture_energy": G, "drive": "release", "no_fail": ["low", "high"]}
        for nu, runs in ((0.45, True), (0.334, True), (0.2, False)):
            with self.subTest(nu=nu):
                rows = columns(self.run_case(self.strip(nu, TIP, 1.3 * self.critical_opening(nu), damage, 65)))
                self.assertEqual(rows["broken_bonds"][-1] > 500, runs)
                self.assertLess(rows["broken_bonds"][-1], 800 if runs else 100)
