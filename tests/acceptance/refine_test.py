"""[[lattice.refine]]: blue noise whose points, and horizons, are finer in some regions."""

import json
import unittest

import h5py
import numpy

from tests.acceptance.crack_tip_test import williams
from tests.acceptance.folder import Folder
from tests.reference.verify import verify
from tests.same_results import differences

COARSE, FINE, GROWTH, RADIUS = 2e-3, 0.5e-3, 0.1, 0.01  # m
E, FRACTURE_ENERGY, THICKNESS = 70e9, 10.0, 1e-3

BODY = f"""\
dimension = 2
[lattice]
points = "blue_noise"
spacing = {COARSE}
horizon_ratio = 3.015
thickness = {THICKNESS}
shape = [{{ add = "box", min = [-0.04, -0.04], max = [0.04, 0.04] }}]
refine = [{{ shape = "disk", centre = [0, 0], radius = {RADIUS}, spacing = {FINE} }}]
[quadrature]
volume_correction = "linear"
surface_correction = "energy"
[material]
model = "bond"
youngs_modulus = {E}
"""
HELD = '[[set]]\nname = "rim"\nwhere = "max(abs(x), abs(y)) > 0.04 - 0.012"\n'
PATCH = BODY + HELD + '[[support]]\nset = "rim"\ndisplacement = ["1e-4*load*x", "-1e-4/3*load*y"]\n'

# Halves that move apart as rigid bodies: every bond across the axis y = 0 breaks.
TEAR = BODY + f"""\
[material.damage]
law = "linear"
fracture_energy = {FRACTURE_ENERGY}
[[set]]
name = "above"
where = "y > 0"
[[set]]
name = "below"
where = "y < 0"
[[support]]
set = "above"
displacement = ["0", "0.02*load"]
[[support]]
set = "below"
displacement = ["0", "0"]
[solver]
mode = "relaxation"
[relaxation]
steps = 1
"""


def field(places):
    """The spacing that is asked for at places."""
    return numpy.minimum(COARSE, FINE + GROWTH * numpy.maximum(0, numpy.hypot(*places.T) - RADIUS))


class RefinedPoints(Folder):
    def points(self, output):
        with h5py.File(output / "results.h5") as file:
            return tuple(file["points/" + name][()] for name in ("reference", "volume", "horizon"))

    def test_points_have_the_spacing_of_the_regions_and_horizons_of_their_sizes(self):
        places, volumes, horizons = self.points(self.run_case(PATCH))
        sizes = numpy.sqrt(volumes / THICKNESS)
        self.assertLess(abs(volumes.sum() / (0.08**2 * THICKNESS) - 1), 1e-12)
        self.assertLess(abs(horizons / (3.015 * sizes) - 1).max(), 1e-13)
        wanted, radius = field(places), numpy.hypot(*places.T)
        for low, high in ((0, 0.005), (0.005, 0.01), (0.01, 0.025), (0.025, 0.06)):
            among = (radius >= low) & (radius < high)
            self.assertGreater(among.sum(), 200)
            self.assertLess(abs((sizes / wanted)[among].mean() - 1), 0.015, (low, high))
            self.assertLess((sizes / wanted)[among].std(), 0.07, (low, high))

    def test_moduli_are_right_and_the_reference_agrees(self):
        for seed in (1, 2):
            output = self.run_case(PATCH, f"lattice.seed={seed}")
            stored = json.loads((output / "summary.json").read_text())["energy"]["stored"]
            exact = 0.5 * E * 1e-8 * 0.08**2 * THICKNESS  # plane stress with the bonds' Poisson's ratio
            self.assertLess(abs(stored / exact - 1), 0.002)
            with h5py.File(output / "results.h5") as file:
                density, displacement = (file["steps/000001/" + name][()] for name in ("energy_density", "displacement"))
                places = file["points/reference"][()]
                resolved = file["case/as_resolved"].asstr()[()]
            # Half of a bond's energy counts at either end, which shifts some of it from fine to coarse points.
            radius = numpy.hypot(*places.T)
            for low, high in ((0, 0.0085), (0.0085, 0.012), (0.012, 0.02), (0.02, 0.028)):
                among = (radius >= low) & (radius < high)
                self.assertLess(abs(density[among].mean() / (0.5 * E * 1e-8) - 1), 0.02, (low, high))
            moved = places * [1e-4, -1e-4 / 3]
            self.assertLess(abs(displacement - moved).max(), 0.01 * 1e-4 * 0.04)
            self.assertEqual(verify(output, resolved, self.folder)[0], [])

    def test_a_refined_body_in_space(self):
        case = {"dimension": 3, "lattice": {
            "points": "blue_noise", "spacing": 2.0, "horizon_ratio": 2.515,
            "shape": [{"add": "box", "min": [0, 0, 0], "max": [20, 20, 20]}],
            "refine": [{"shape": "sphere", "centre": [0, 0, 0], "radius": 5.0, "spacing": 1.0, "growth": 0.3}]},
            "quadrature": {"volume_correction": "linear", "surface_correction": "energy"},
            "material": {"model": "bond", "youngs_modulus": 1e3},
            "set": [{"name": "all", "where": "1"}],
            "support": [{"set": "all", "displacement": ["1e-4*load*x", "-0.25e-4*load*y", "-0.25e-4*load*z"]}]}  # fmt: skip
        output = self.run_case(case)
        places, volumes, _ = self.points(output)
        radius = numpy.linalg.norm(places, axis=1)
        sizes = volumes ** (1 / 3)
        wanted = numpy.minimum(2.0, 1.0 + 0.3 * numpy.maximum(0, radius - 5.0))
        self.assertLess(abs(volumes.sum() / 8000 - 1), 1e-5)
        self.assertLess(abs((sizes / wanted).mean() - 1), 0.02)
        stored = json.loads((output / "summary.json").read_text())["energy"]["stored"]
        self.assertLess(abs(stored / (0.5 * 1e3 * 1e-8 * 8000) - 1), 0.01)

    def test_a_tear_through_all_sizes_takes_the_fracture_energy(self):
        for seed in (1, 2, 3):
            output = self.run_case(TEAR, f"lattice.seed={seed}")
            energy = json.loads((output / "summary.json").read_text())["energy"]
            # The axis is no boundary of cells: a strip about half a spacing wide belongs to either side.
            self.assertLess(abs(energy["dissipated"] / (FRACTURE_ENERGY * 0.08 * THICKNESS) - 1), 0.01)

    def test_a_ring_about_a_tip_in_the_fine_region_may_be_small(self):
        nu = 1 / 3
        u, v, _ = williams(0, E / (2 * (1 + nu)), (3 - nu) / (1 + nu))
        case = (BODY.replace("radius = 0.01", "radius = 0.016") + HELD + f"""\
[[support]]
set = "rim"
displacement = ["{u}", "{v}"]
[[crack]]
from = [-0.05, 0]
to = [0, 0]
[[crack_tip]]
name = "tip"
at = [0, 0]
direction = [1, 0]
""")  # fmt: skip
        row = self.results(case).table("history")[-1]
        self.assertLess(abs(row["tip_K1"] / 1e6 - 1), 0.03)
        self.assertLess(abs(row["tip_K2"] / 1e6), 0.02)
        said = self.refusal(case, "crack_tip=[{name='tip', at=[0,0], direction=[1,0], inner=2e-3}]")
        self.assertIn("at least 2 horizons, 0.003", said)  # of the fine points, not 0.012

    def test_derivatives_threads_and_runs_that_continue(self):
        case = BODY + HELD + f"""\
[material.damage]
law = "linear"
fracture_energy = {FRACTURE_ENERGY}
no_fail = ["rim"]
[[crack]]
from = [-0.05, 0]
to = [0, 0]
[[support]]
set = "rim"
displacement = ["0", "6.2e-5*load*y"]
[loading]
steps = 4
"""
        told = self.assert_completed(self.command("check-tangent", case)).json()
        for key in ("residual_error", "tangent_error", "force_sum", "moment_sum"):
            self.assertLess(told[key], 1e-8, key)
        whole = self.run_case(case, name="whole")
        with h5py.File(whole / "results.h5") as file:
            self.assertGreater(file["steps/000004/damage"][()].max(), 0.1)
        part = self.run_case(case, name="part", words=("--stop-after", 2), code=130)
        self.resume(part)
        self.assertEqual(differences(whole, part), [])
        two = self.run_case(case, name="two", threads=2)
        self.assertEqual(*(self.points(output)[0].tolist() for output in (whole, two)))

    def test_what_cannot_be_refined_is_refused(self):
        region = '{ shape = "disk", centre = [0, 0], radius = 0.01, spacing = 5e-4 }'
        self.assertIn(region.split(",")[0][2:], PATCH)
        for changes, words in (
            (['lattice.points="lattice"'], ("lattice.refine", 'points = "blue_noise"')),
            (['lattice.refine=[{shape="disk", centre=[0,0], radius=0.01, spacing=2e-3}]'], ("refine[0].spacing", "below lattice.spacing")),
            (['lattice.refine=[{shape="disk", centre=[0,0], radius=0.01, spacing=2e-5}]'], ("refine[0].spacing", "1/64")),
            (['lattice.refine=[{shape="disk", centre=[0,0], radius=0.01, spacing=1e-3, growth=0.7}]'], ("refine[0].growth", "0.01 to 0.5")),
            (['lattice.refine=[{shape="disk", centre=[0.5,0], radius=0.01, spacing=1e-3}]'], ("refine[0]", "no effect")),
            (['lattice.refine=[{shape="sphere", centre=[0,0,0], radius=0.01, spacing=1e-3}]'], ("refine[0]", "no sphere in dimension 2")),
            (['lattice.refine=[{shape="disk", center=[0,0], radius=0.01, spacing=1e-3}]'], ("refine[0].center", "did you mean centre")),
            (['lattice.refine=[{shape="disk", centre=[0,0], radius=0.01, spacing=1e-3, name="a"}]'], ("refine[0].name",)),
            (["material.model=state", "material.poisson_ratio=0.2"], ("lattice.refine", 'model "bond"')),
            (["material.model=cpd", "material.poisson_ratio=0.35", "quadrature={}"], ("lattice.refine", 'model "bond"')),
            (['material.damage={law="critical_stretch", critical="1e-3*horizon"}'],
             ("material.damage.critical", "lattice.refine gives every point its own")),
            (['material.damage={law="linear", critical=1e-3, onset=1e-4}', "solver.mode=adaptive",
              "solver.elastic_horizon_ratio=2"], ("elastic_horizon_ratio", "lattice.refine")),
            (['quadrature.volume_correction="exact"'], ("quadrature.volume_correction", '"linear"'))):  # fmt: skip
            with self.subTest(changes=changes):
                said = self.refusal(PATCH, *changes)
                for word in words:
                    self.assertIn(word, said)
        self.assert_refused(self.command("calibrate", PATCH), "lattice.refine", "a length")


if __name__ == "__main__":
    unittest.main()
