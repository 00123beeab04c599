"""A horizon per point: patch tests of graded meshes, runs that continue, and refusals."""

import json
import unittest

import h5py

from tests.acceptance.folder import Folder
from tests.reference.graded import GradedRing, errors, patch_test
from tests.same_results import differences

RATIO = 4.015
OWN = f"{{ ratio = {RATIO} }}"
LINEAR = 'volume_correction = "linear"'
CORRECTED = LINEAR + '\nsurface_correction = "energy"'
TEARING = '[material.damage]\nlaw = "linear"\nfracture_energy = 1.0'
PULL = 'support=[{set="held", displacement=["3e-5*load*x*y", "1e-5*load*x"]}]'


class HorizonsOfPoints(Folder):
    def ring(self, along, depth=RATIO + 1):
        """A ring whose points within `depth` of their sizes from the edges are held."""
        ring = GradedRing(along)
        ring.write(self.folder / "points.csv", ring.depth() < depth * ring.sizes)
        return ring

    def errors(self, ring, horizon, inside):
        """Errors inside of a patch test, and its number of bonds."""
        output = self.run_case(patch_test("points.csv", horizon, CORRECTED))
        with h5py.File(output / "results.h5") as file:
            return errors(file, ring, inside)[:3], json.loads((output / "summary.json").read_text())["bonds"]

    def test_a_patch_test_of_sizes_of_4_to_1_is_within_3_per_cent(self):
        ring = self.ring(48, depth=2 * RATIO + 1)
        self.assertGreater(ring.sizes.max() / ring.sizes.min(), 4)
        inside = ring.depth() >= (2 * RATIO + 1) * ring.sizes
        self.assertGreater(inside.sum(), 500)
        own, bonds = self.errors(ring, OWN, inside)
        self.assertLess(max(own), 0.03)
        self.assertGreater(min(own), 1e-4)
        # One horizon of more bonds: small elements have too many, large ones too few.
        one, more = self.errors(ring, RATIO * ring.areas.mean() ** 0.5, inside)
        self.assertGreater(more, bonds)
        self.assertGreater(one[0], 1.5 * own[0])

    def test_results_have_the_horizons(self):
        ring = self.ring(16)
        with h5py.File(self.run_case(patch_test("points.csv", OWN)) / "results.h5") as file:
            found, row = file["points/horizon"][()], file["points/source_row"][()]
            resolved = file["case/as_resolved"].asstr()[()]
        self.assertLess(abs(found / (RATIO * ring.sizes[row]) - 1).max(), 1e-14)
        self.assertIn(f"horizon = {OWN}", resolved)

    def test_the_derivatives_are_right_with_torn_bonds(self):
        self.ring(16, depth=2)
        for quadrature in ("", LINEAR + '\nsurface_correction = "volume"', CORRECTED):
            with self.subTest(quadrature=quadrature):
                case = patch_test("points.csv", OWN, quadrature, TEARING)
                told = self.assert_completed(self.command("check-tangent", case)).json()
                for key in ("residual_error", "tangent_error", "force_sum", "moment_sum"):
                    self.assertLess(told[key], 1e-8, key)
                self.assertGreater(told["residual_norm"], 0)

    def test_a_run_continues_as_it_would_have_gone_on(self):
        self.ring(16, depth=2)
        case = patch_test("points.csv", OWN, LINEAR, TEARING)
        steps = "loading.steps=4"
        whole = self.run_case(case, PULL, steps, name="whole")
        part = self.run_case(case, PULL, steps, name="part", words=("--stop-after", 2), code=130)
        self.resume(part)
        self.assertEqual(differences(whole, part), [])
        two = self.run_case(case, PULL, steps, name="two", threads=2)
        with h5py.File(whole / "results.h5") as file, h5py.File(two / "results.h5") as other:
            damage, of_two = (results["steps/000004/damage"][()] for results in (file, other))
        self.assertGreater(damage.max(), 0.01)
        self.assertLess(abs(damage - of_two).max(), 1e-9)

    def test_what_needs_one_horizon_is_refused_by_file_and_key(self):
        self.ring(16)
        case = patch_test("points.csv", OWN)
        stretch = 'material.damage={law="critical_stretch", critical="1e-3*horizon"}'
        for changes, words in (
            (["material.model=cpd", "material.poisson_ratio=0.3"], ("case.toml:4:", "points.horizon", 'model "bond"')),
            ([stretch], ("material.damage.critical", "points.horizon gives every point its own")),
            (['quadrature.volume_correction="exact"'], ("quadrature.volume_correction", '"linear"')),
            (["points.horizon={ratio=0.9}"], ("points.horizon.ratio", "from 1 to 1000")),
            (["points.horizon={rato=3}"], ("did you mean ratio",)),
            (["material.kinematics=linear", "solver.operator=fft"], ("solver.operator", '"bonds"')),
            (['material.damage={law="blended", fracture_energy=1, strength=1e5}'], ("material.damage.strength", "alone")),
            (['material.damage={law="linear", critical=1e-3, onset=1e-4}', "solver.mode=adaptive",
              "solver.elastic_horizon_ratio=3"], ("elastic_horizon_ratio", "points.horizon"))):  # fmt: skip
            with self.subTest(changes=changes):
                said = self.refusal(case, *changes)
                for word in words:
                    self.assertIn(word, said)
        self.assert_refused(self.command("calibrate", case), "points.horizon", "a length")


if __name__ == "__main__":
    unittest.main()
