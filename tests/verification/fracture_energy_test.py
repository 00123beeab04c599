"""Fracture energy and strength: tears and tension tests, compared with the requested and the predicted values."""

import itertools
import unittest

import h5py
import numpy

from tests.acceptance.folder import Folder
from tests.reference.case import Case
from tests.reference.laws import Law
from tests.reference.pull import Pull, uniaxial
from tests.reference.sheets import Bulk, resolve
from tests.reference.tear import directions
from tests.reference.torn_strip import ANGLES, TornStrip

LAWS = ("critical_stretch", "tanh", "tanh_continuous", "linear", "exponential", "blended", "bilinear", "cornelissen")
# Parts of a brittle strength that the laws of the opening resolve less of.
OPENING = {"bilinear": 0.6, "cornelissen": 0.45}
CORRECTIONS = {"none": {}, "linear": {"volume_correction": "linear"},
               "energy": {"volume_correction": "linear", "surface_correction": "energy"}}  # fmt: skip
# Sums of a few hundred bonds by independent means.
ROUND_OFF = 1e-12
# Relative errors of a strength that is searched for, and of its stretches: a peak is flat.
STRENGTH, STRETCH = 1e-7, 1e-6


class FractureEnergy(Folder):
    threads = 2

    def strip(self, length, angle, ratio, material, quadrature, dimension=2):
        """Two halves are pulled apart as rigid blocks, until no bond joins them."""
        return TornStrip(material, ratio, angle, 1.0, dimension, quadrature).tables(length, length)

    def tear(self, angle, period, ratio, material, quadrature, dimension=2):
        """Dissipated energy over area in the middle of a strip: the increase from a shorter to a longer strip."""
        return TornStrip(material, ratio, angle, period, dimension, quadrature).energy(self.folder)

    def test_a_straight_tear_takes_what_is_foretold_for_its_direction(self):
        found = {}
        tried = [(law, 3.015, "linear", "continuum") for law in LAWS]
        tried += [("linear", 3.015, name, "lattice") for name in CORRECTIONS]
        tried += [("blended", 4.0, "linear", "continuum"), ("exponential", 6.0, "linear", "continuum")]
        for law, ratio, correction, calibration in tried:
            material = {"youngs_modulus": 70e9, "calibration": calibration,
                        "damage": {"law": law, "fracture_energy": 10.0}}  # fmt: skip
            for angle, period in ANGLES:
                with self.subTest(law=law, ratio=ratio, correction=correction, angle=angle, calibration=calibration):
                    took = self.tear(angle, period, ratio, material, CORRECTIONS[correction])
                    bulk = Bulk(Case(self.strip(1, angle, ratio, material, CORRECTIONS[correction])))
                    foretold = 10.0 * bulk.crossing_of([0, 1]) / bulk.crossing
                    self.assertAlmostEqual(took / foretold, 1.0, delta=1e-10)  # a difference of two sums
                    found.setdefault((ratio, correction), {})[angle] = took
        for (ratio, correction), by_angle in found.items():
            # 0 and 45 degrees are the ends of the range of directions, 26.6 counts twice in it.
            flat, between, diagonal = by_angle.values()
            self.assertAlmostEqual((flat + 2 * between + diagonal) / 40, 1.0, delta=0.02 if correction == "none" else 0.01,
                                   msg=f"{ratio} {correction}")  # fmt: skip

    def test_in_space_a_straight_tear_takes_what_is_foretold(self):
        for law, (angle, period) in (("critical_stretch", ANGLES[0]), ("linear", ANGLES[2])):
            with self.subTest(law=law, angle=angle):
                material = {"youngs_modulus": 70e9, "damage": {"law": law, "fracture_energy": 10.0}}
                took = self.tear(angle, period, 2.015, material, CORRECTIONS["linear"], 3)
                bulk = Bulk(Case(self.strip(1, angle, 2.015, material, CORRECTIONS["linear"], 3)))
                foretold = 10.0 * bulk.crossing_of([0, 1, 0]) / bulk.crossing
                self.assertAlmostEqual(took / foretold, 1.0, delta=1e-10)  # differences of sums

    def test_a_tear_and_calibrate_heed_the_influence_function(self):
        whole = None
        for influence in ("constant", "cubic", "gaussian", "inverse"):
            for calibration, (angle, period) in zip(("continuum", "lattice"), (ANGLES[0], ANGLES[2]), strict=True):
                with self.subTest(influence=influence, calibration=calibration):
                    material = {"youngs_modulus": 70e9, "calibration": calibration, "influence": influence,
                                "damage": {"law": "linear", "fracture_energy": 10.0}}  # fmt: skip
                    strip = self.strip(0.03, angle, 3.015, material, CORRECTIONS["linear"])
                    took = self.tear(angle, period, 3.015, material, CORRECTIONS["linear"])
                    bulk = Bulk(Case(strip))
                    self.assertAlmostEqual(took / (10.0 * bulk.crossing_of([0, 1]) / bulk.crossing), 1.0, delta=1e-10)
                    told = self.command("calibrate", strip).json()
                    modulus = 70e9 * (bulk.lattice_of_modulus if calibration == "lattice" else bulk.of_modulus)
                    self.assertAlmostEqual(told["micromodulus"] / modulus, 1.0, delta=ROUND_OFF)
                    self.assertAlmostEqual(told["damage"]["fracture_energy"]["mean"] / 10.0, 1.0, delta=ROUND_OFF)
                    whole = whole or told["micromodulus"]
                    if influence != "constant":
                        self.assertGreater(abs(told["micromodulus"] / whole - 1), 0.2)

    def test_scatter_of_strength_takes_the_mean_square_of_the_factors(self):
        damage = {"law": "linear", "fracture_energy": 10.0}
        scattered = {"youngs_modulus": 70e9, "damage": damage, "scatter": [{"of": "strength", "weibull_modulus": 5, "seed": 3}]}
        strip = lambda material: TornStrip.dissipated(self.strip(0.02, 0.0, 3.015, material, {}), self.folder)
        whole, took = strip({"youngs_modulus": 70e9, "damage": damage}), strip(scattered)
        with h5py.File(self.folder / "out/results.h5") as file:
            factor, places = file["points/strength_factor"][:], file["points/reference"][:]
            bonds = numpy.stack([file["broken_bonds/first_point"][:], file["broken_bonds/second_point"][:]])
        length = numpy.linalg.norm(places[bonds[1]] - places[bonds[0]], axis=1)
        square = (factor[bonds].mean(axis=0) ** 2 * length).sum() / length.sum()  # a bond has c V^2 length W
        self.assertGreater(abs(square - 1), 0.005)
        self.assertAlmostEqual(took / whole / square, 1.0, delta=1e-10)

    def test_calibrate_foretells_the_tears_along_and_across_the_lattice(self):
        material = {"youngs_modulus": 70e9, "damage": {"law": "linear", "fracture_energy": 10.0, "strength": 8e6}}
        for (angle, period), key in zip(ANGLES[::2], ("axes", "diagonals"), strict=True):
            strip = self.strip(0.03, 0.0, 3.015, material, CORRECTIONS["linear"])
            told = self.command("calibrate", strip).json()["damage"]["fracture_energy"]
            took = self.tear(angle, period, 3.015, material, CORRECTIONS["linear"])
            for value in told[key]:
                self.assertAlmostEqual(value / took, 1.0, delta=1e-10)
            self.assertLessEqual(told["least"], took * (1 + ROUND_OFF))
            self.assertGreaterEqual(told["most"], took * (1 - ROUND_OFF))

    def question(self, dimension, law, **more):
        options = {"dimension": dimension, "spacing": 2e-4, "horizon-ratio": 3.015, "youngs-modulus": 30e9, "law": law} | more
        if law == "blended":
            options.setdefault("hardening", 0.8)
        return [word for name, value in options.items() for word in (f"--{name}", repr(value) if isinstance(value, float) else str(value))]

    def calibrated(self, dimension, law, **more):
        question = self.question(dimension, law, **more)
        return self.assert_completed(self.peristat("calibrate", "--model", "bond", *question)).json()

    def test_calibrate_goes_there_and_back(self):
        # All laws in all dimensions; each law and each dimension with both calibrations.
        calibrations = itertools.cycle(("lattice", "continuum"))
        tried = [*zip(itertools.product(LAWS, (1, 2, 3)), calibrations), (("tanh", 2), "continuum")]
        for (law, dimension), calibration in tried:
            with self.subTest(dimension=dimension, law=law, calibration=calibration):
                self.there_and_back(dimension, law, calibration)

    def there_and_back(self, dimension, law, calibration):
        data, strength = {"fracture-energy": 60.0}, 0.0
        if law != "critical_stretch":
            brittle = self.calibrated(dimension, "critical_stretch", calibration=calibration, **data)["damage"]
            data["strength"] = strength = OPENING.get(law, 0.8) * brittle["strength"]
        there = self.calibrated(dimension, law, calibration=calibration, **data)["damage"]
        self.assertAlmostEqual(there["fracture_energy"]["mean"] / 60, 1.0, delta=ROUND_OFF)
        if law != "critical_stretch":
            self.assertAlmostEqual(there["strength"] / strength, 1.0, delta=STRENGTH)
        stretches = {key: there[key] for key in ("onset", "peak", "critical") if key in there}
        back = self.calibrated(dimension, law, calibration=calibration, **stretches)["damage"]
        for key in ("strength", "characteristic_length", "largest_spacing"):
            self.assertAlmostEqual(back[key] / there[key], 1.0, delta=STRENGTH)
        for key in ("mean", "least", "most"):
            self.assertAlmostEqual(back["fracture_energy"][key] / there["fracture_energy"][key], 1.0, delta=ROUND_OFF)
        # also compared with the reference, whose bonds are those of a body; its strengths take seconds in a plane, more
        # in space
        if strength and dimension > 1 and (dimension, law, calibration) not in ((2, "linear", "lattice"), (2, "tanh", "continuum")):
            return
        tables = {"dimension": dimension, "lattice": {"spacing": 2e-4, "horizon_ratio": 3.015},
                  "material": {"youngs_modulus": 30e9, "calibration": calibration,
                               "damage": {"law": law} | {key.replace("-", "_"): value for key, value in data.items()}}}  # fmt: skip
        if law == "blended":
            tables["material"]["damage"]["hardening"] = 0.8
        case = Case(tables)
        resolve(case)
        for key, value in stretches.items():
            self.assertAlmostEqual(case["material"]["damage"][key] / value, 1.0, delta=STRETCH)

    def test_moduli_of_the_lattice_are_right_in_the_mean(self):
        for dimension in (1, 2, 3):
            told = self.calibrated(dimension, "linear", **{"fracture-energy": 60.0}, calibration="lattice")
            self.assertAlmostEqual(told["youngs_modulus"]["mean"] / 30e9, 1.0, delta=ROUND_OFF)
            free = self.calibrated(dimension, "linear", **{"fracture-energy": 60.0})
            self.assertGreater(abs(free["youngs_modulus"]["mean"] / 30e9 - 1), 1e-3)
            if dimension > 1:
                self.assertLess(min(*told["youngs_modulus"]["axes"], *list(told["youngs_modulus"].values())[-1]), 30e9)

    def test_modulus_along_an_axis_is_that_of_a_pulled_body(self):
        """A square cut along the axes with every point stretched by a given amount; its inner points have E."""
        told = self.calibrated(2, "linear", **{"fracture-energy": 60.0, "horizon-ratio": 3.015})
        bulk = Bulk(Case({"dimension": 2, "lattice": {"spacing": 2e-4, "horizon_ratio": 3.015}, "material": {"youngs_modulus": 30e9}}))
        c = 30e9 * bulk.of_modulus
        n, weight = bulk.direction, bulk.weight * bulk.length * c / 2
        c11, c12 = (weight * n[:, 0] ** 4).sum(), (weight * n[:, 0] ** 2 * n[:, 1] ** 2).sum()
        self.assertAlmostEqual(told["youngs_modulus"]["axes"][0] / (c11 - c12**2 / c11), 1.0, delta=ROUND_OFF)

    def test_the_largest_spacing_is_where_a_law_is_refused(self):
        data = {"fracture-energy": 60.0, "strength": 14e6}
        largest = self.calibrated(2, "linear", **data)["damage"]["largest_spacing"]
        below = self.calibrated(2, "linear", **data, spacing=largest * (1 - 1e-3))["damage"]["strength"]
        self.assertAlmostEqual(below / 14e6, 1.0, delta=STRENGTH)
        beyond = self.question(2, "linear", **data, spacing=largest * (1 + 1e-6))
        ended = self.peristat("calibrate", "--model", "bond", *beyond)
        self.assert_refused(ended, f"a spacing below {largest:.4g} m resolves it")

    def test_strengths_of_a_lattice_are_those_of_its_pull(self):
        """One direction of a lattice in space, and every stress of a planar one, against an independent calculation."""
        question = self.question(2, "linear", onset=1e-4, critical=8e-4)
        planar = self.peristat("calibrate", "--strengths", "--model", "bond", *question).json()
        case = lambda d: Case({"dimension": d, "lattice": {"spacing": 2e-4, "horizon_ratio": 3.015}, "material": {"youngs_modulus": 30e9}})
        law = Law("linear", 1e-4, 8e-4, 3.0)
        bulk = Bulk(case(2))
        pull, c = Pull.of_bulk(bulk), planar["micromodulus"]
        told = planar["damage"]["strengths"]
        self.assertAlmostEqual(c * bulk.strength({"law": "linear", "onset": 1e-4, "critical": 8e-4}) / told["uniaxial"]["peak"]["mean"], 1, delta=1e-7)
        self.assertAlmostEqual(c * pull.peak(law, numpy.eye(2)) / told["biaxial"]["peak"]["mean"], 1, delta=1e-7)
        normals, weights = directions(2)
        shear = sum(w * pull.peak(law, uniaxial(n) - uniaxial([-n[1], n[0]])) for n, w in zip(normals, weights, strict=True))
        self.assertAlmostEqual(c * shear / told["shear"]["peak"]["mean"], 1, delta=1e-7)
        # A third of the force per stretch is lost to the lateral contraction: nu = 1/3.
        self.assertAlmostEqual(told["compression"]["onset"]["mean"] / told["uniaxial"]["onset"]["mean"], 3, delta=0.15)
        space = self.calibrated(3, "linear", onset=1e-4, critical=8e-4)
        along = space["micromodulus"] * Pull.of_bulk(Bulk(case(3))).peak(law, uniaxial([1, 0, 0]))
        spread = space["damage"]["uniaxial_strength"]
        self.assertLess(spread["least"] * (1 - 1e-7), along)
        self.assertGreater(spread["most"] * (1 + 1e-7), along)

    def test_a_bar_bears_its_strength(self):
        """Every bond of a bar under a homogeneous strain has the same stretch, so the force is largest at the peak."""
        for law in LAWS:
            with self.subTest(law=law):
                strength = 0.4e6 if law in OPENING else 2e6
                damage = {"law": law, "strength": strength} | ({} if law == "critical_stretch" else {"critical": 4e-3})
                tables = {"dimension": 1, "lattice": {"spacing": 0.1, "horizon_ratio": 3.0, "shape": [{"add": "box", "min": [0], "max": [3]}]},
                          "set": [{"name": "all", "where": "1"}], "material": {"youngs_modulus": 1e9, "calibration": "lattice", "damage": damage},
                          "support": [{"set": "all", "displacement": ["4.0e-3*x*load"]}], "loading": {"steps": 400},
                          "output": {"every": 400}}  # fmt: skip
                rows = self.results(tables).table("history")[1:]  # after step 0
                stored = numpy.array([row["stored_energy"] for row in rows])
                strain = 4e-3 * numpy.arange(1, len(stored) + 1) / 400
                # Inner points store half the force times the strain; the ends reduce all values alike.
                stress = stored / strain
                self.assertAlmostEqual(stress.max() / stress[0] * strain[0] * 1e9 / strength, 1.0, delta=0.01)


if __name__ == "__main__":
    unittest.main()
