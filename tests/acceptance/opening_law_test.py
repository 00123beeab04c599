"""The laws of damage `bilinear` and `cornelissen`: the force of a bond over its opening."""

import math
import re
import unittest

import numpy

from tests.acceptance.folder import Folder
from tests.acceptance.strip import LATTICE
from tests.acceptance.table_law_test import MODELS, torn
from tests.reference.torn_strip import ANGLES, TornStrip

ONSET, CRITICAL = 1e-3, 1e-2
LAWS = {name: f'law = "{name}"\nonset = {ONSET}\ncritical = {CRITICAL}\n' for name in ("bilinear", "cornelissen")}
THIRD = ONSET / 3
TABLE = f'law = "table"\nstretches = [{ONSET}, {THIRD + CRITICAL * 2 / 9!r}, {CRITICAL}]\nforces = [{ONSET}, {THIRD!r}, 0]\n'
STATE = 'model = "state"\nyoungs_modulus = 200e9\npoisson_ratio = 0.2\n'
PULLED = """\
dimension = 1
[lattice]
spacing = 1
horizon_ratio = 1.2
area = 1
[[lattice.shape]]
add = "box"
min = [0]
max = [2]
[[set]]
name = "left"
where = "x < 1"
[[set]]
name = "right"
where = "x > 1"
[material]
youngs_modulus = 1e9
[[support]]
set = "left"
displacement = [0]
[[support]]
set = "right"
displacement = ["2e-3*load"]
[loading]
table = [0, 3, 1, 6]
steps = 40
[material.damage]
"""


def share_of(name, opening):
    """The curves as published: stress over strength, of the opening over the one at which no stress is left."""
    if name == "bilinear":  # Petersson 1981: the kink at 0.8 G_F/f_t and f_t/3, the end at 3.6 G_F/f_t
        return numpy.interp(opening, [0, 0.8 / 3.6, 1], [1, 1 / 3, 0])
    return (1 + (3 * opening) ** 3) * numpy.exp(-6.93 * opening) - opening * (1 + 27) * math.exp(-6.93)


class OpeningLaw(Folder):
    threads = 2

    def pulled(self, text):
        """Stretches of a bond of length 1, and its forces over the stiffness of the undamaged bond."""
        rows = self.results(text).table("history")
        pull = numpy.array([float(row["displacement_x:right"]) for row in rows])
        force = numpy.array([float(row["reaction_x:right"]) for row in rows])
        self.assertLess(pull[1], ONSET)
        return pull, force * pull[1] / force[1]

    def test_one_bond_has_the_published_curve_over_its_opening(self):
        for name, law in LAWS.items():
            with self.subTest(name):
                pull, force = self.pulled(PULLED + law)
                most = numpy.maximum.accumulate(pull)
                loading = (pull == most) & (pull > ONSET)
                opening = (pull - force)[loading] / CRITICAL
                expected = numpy.where(opening < 1, share_of(name, numpy.minimum(opening, 1)), 0.0)
                numpy.testing.assert_allclose(force[loading] / ONSET, expected, atol=1e-9)
                self.assertGreater(numpy.count_nonzero((opening > 0) & (opening < 1)), 20)
                # Unloading goes along the secant.
                secant = (pull < most) & (most < CRITICAL)
                peak = dict(zip(pull.tolist(), (force / numpy.where(pull, pull, 1)).tolist(), strict=True))
                self.assertGreater(numpy.count_nonzero(secant), 10)
                for stretch, found, before in zip(pull[secant], force[secant], most[secant], strict=True):
                    self.assertAlmostEqual(found, peak[before] * stretch, delta=1e-12)

    def test_two_lines_have_the_history_of_a_table(self):
        for model, mode in (("bond", "relaxation"), ("bond", "adaptive"), ("cpd", "relaxation")):
            with self.subTest(model=model, mode=mode):
                found = []
                for law in (LAWS["bilinear"], TABLE):
                    text = torn(law, model).replace("1e-4*load", "2e-4*load")
                    found.append(self.results(text, f"solver.mode={mode}", code=(0, 3)).table("history"))
                self.assertEqual(len(found[0]), len(found[1]))
                for key in ("reaction_x:right", "stored_energy", "dissipated_energy", "broken_bonds"):
                    one, other = (numpy.array([float(row[key]) for row in rows]) for rows in found)
                    self.assertGreater(abs(one).max(), 0.0, key)
                    self.assertLessEqual(abs(one - other).max(), 1e-10 * abs(one).max(), key)

    def test_a_tear_takes_what_is_given_also_along_the_path(self):
        """A M(s_c) to round-off, whatever the law; in mode path by saw-teeth, which dissipate the same."""
        for name, share in (("bilinear", 1 / 3.6), ("cornelissen", 1 / 5.136)):
            with self.subTest(name):
                material = {"youngs_modulus": 70e9, "damage": {"law": name, "fracture_energy": 10.0, "strength": 4e6}}
                angle, period = ANGLES[0]
                strip = TornStrip(material, 3.015, angle, period, 2, {"volume_correction": "linear"})
                flat = strip.tables(0.03, 0.0)
                told = self.assert_completed(self.command("calibrate", flat)).json()["damage"]
                took = strip.energy(self.folder)
                self.assertAlmostEqual(told["fracture_energy"]["mean"] / 10, 1, delta=1e-12)
                self.assertAlmostEqual(told["strength"] / 4e6, 1, delta=1e-7)
                for value in told["fracture_energy"]["axes"]:
                    self.assertAlmostEqual(value / took, 1, delta=1e-10)
                # The work of a bond by its stretches alone: 2 W = s^2 of a brittle bond.
                brittle = {"youngs_modulus": 70e9, "damage": {"law": "critical_stretch", "fracture_energy": 10.0}}
                one = TornStrip(brittle, 3.015, angle, period, 2, {"volume_correction": "linear"})
                sudden = self.command("calibrate", one.tables(0.03, 0.0)).json()["damage"]["critical"]
                self.assertAlmostEqual(2 * share * told["onset"] * told["critical"] / sudden**2, 1, delta=1e-4)
                smooth = TornStrip.dissipated(flat, self.folder)
                toothed = flat | {"solver": {"mode": "path"}, "loading": {"teeth": 4}}
                del toothed["output"]
                self.assertAlmostEqual(TornStrip.dissipated(toothed, self.folder) / smooth, 1, delta=1e-7)

    def test_has_an_exact_tangent(self):
        for law in LAWS.values():
            for model in MODELS:
                self.assert_completed(self.command("check-tangent", torn(law, model)))
            state = torn(law).replace("youngs_modulus = 200e9\n", STATE)
            self.assert_completed(self.command("check-tangent", state))

    def test_check_and_calibrate_tell_the_same_fracture_energy(self):
        for law in LAWS.values():
            told = self.assert_completed(self.command("calibrate", torn(law))).json()["damage"]
            text = self.assert_completed(self.command("check", torn(law))).output
            [energy] = re.findall(r"fracture energy ([\d.e+-]+)", text)
            self.assertAlmostEqual(float(energy) / told["fracture_energy"]["mean"], 1, delta=1e-4)

    def test_is_refused_where_a_bond_would_snap_back(self):
        for name, limit in (("bilinear", 1 / 3), ("cornelissen", 1 / (6.93 + 28 * math.exp(-6.93)))):
            law = LAWS[name]
            for factor, code in ((1 - 1e-6, 0), (1 + 1e-6, 2)):
                ended = self.command("check", torn(law.replace(f"onset = {ONSET}", f"onset = {CRITICAL * limit * factor!r}")))
                self.assert_code(ended, code)
            self.assertIn("snap back", ended.errors)
            # The largest spacing that calibrate tells is where a strength is refused.
            data = {"fracture-energy": 60.0, "strength": 5e6, "law": name, "youngs-modulus": 30e9, "dimension": 2, "horizon-ratio": 3.015}
            words = lambda spacing: ["--model", "bond", *(w for k, v in (data | {"spacing": spacing}).items() for w in (f"--{k}", str(v)))]
            largest = self.peristat("calibrate", *words(1e-3)).json()["damage"]["largest_spacing"]
            below = self.peristat("calibrate", *words(largest * (1 - 1e-3))).json()["damage"]["strength"]
            self.assertAlmostEqual(below / 5e6, 1, delta=1e-6)
            self.assert_refused(self.peristat("calibrate", *words(largest * (1 + 1e-6))), "snap back", f"below {largest:.4g} m")

    def test_its_data_are_checked(self):
        law = LAWS["cornelissen"]
        for damage, fragments in (
            (law + "rate = 3\n", ("rate", "tanh laws")),
            (law + "peak = 2e-3\n", ("peak", "blended")),
            (law.replace(f"onset = {ONSET}\n", ""), ("onset",)),
            (law + "strength = 1e6\n", ("onset", "strength")),
            (law.replace(f"onset = {ONSET}", "onset = -1e-3"), ("onset",)),
        ):
            with self.subTest(damage):
                self.assert_refused(self.command("check", torn(damage)), *fragments)
        solid = LATTICE + '[material]\nmodel = "lps"\nyoungs_modulus = 1e9\npoisson_ratio = 0.2\n[material.damage]\n' + law
        self.assert_refused(self.command("check", solid), "material.damage.law")

    def test_a_bond_of_two_materials_has_the_mean_of_their_stretches(self):
        """The ratio of onset to critical stretch differs, which a table would keep."""
        for name, law in LAWS.items():
            with self.subTest(name):
                region = '[[region]]\nset = "right"\n[region.material]\nyoungs_modulus = 1e9\n[region.material.damage]\n'
                other = f'law = "{name}"\nonset = {1.4 * ONSET}\ncritical = {3 * CRITICAL}\n'
                text = PULLED.replace("2e-3*load", "4e-3*load") + law + region + other + '[[interface]]\nrule = "arithmetic"\n'
                onset, critical = 1.2 * ONSET, 2 * CRITICAL
                pull, force = self.pulled(text)
                loading = (pull == numpy.maximum.accumulate(pull)) & (pull > onset)
                opening = (pull - force)[loading] / critical
                expected = numpy.where(opening < 1, share_of(name, numpy.minimum(opening, 1)), 0.0)
                numpy.testing.assert_allclose(force[loading] / onset, expected, atol=1e-9)
                self.assertGreater(numpy.count_nonzero((opening > 0) & (opening < 1)), 20)


if __name__ == "__main__":
    unittest.main()
