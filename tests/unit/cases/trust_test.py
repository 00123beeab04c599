"""Parts of the suite of known answers: closed forms against handbook values, peaks, verdicts."""

import math
import sys
import tempfile
import tomllib
import unittest
from pathlib import Path

import h5py

RUNNER = Path(__file__).resolve().parents[3] / "cases" / "runner"
sys.path[:0] = [str(RUNNER / "trust"), str(RUNNER / "sweep")]

import lefm  # noqa: E402
import surfing  # noqa: E402
import trapping  # noqa: E402
import double_cantilever  # noqa: E402
from given import GLASS, RATIO, WrongSetting, in_case, poisson_ratio, read_settings  # noqa: E402
from compliance import elastic_factor, toughness  # noqa: E402
from specimen import Lattice, Measure, Specimen, peak  # noqa: E402
from strip import Strip  # noqa: E402
from verdict import Verdict, extension_of, row  # noqa: E402


FALLS = lambda by: 1 / (1 + 10 * by)  # decreases with the crack length


def bar(measure: Measure) -> Specimen:
    return Specimen("bar", "Bar", "theory", 1.0, lambda lattice, h: "", (measure,))


def verdict(values, failures=None, extension=None, **of_measure) -> Verdict:
    measure = Measure("load", lambda folder: 1.0, **({"of_longer_crack": FALLS} | of_measure))
    return Verdict(bar(measure), measure, values, failures or {}, 0.0, extension or {})


class ClosedForms(unittest.TestCase):
    def test_factors_of_the_standard(self):
        """ASTM E399 tabulates f(a/W): 2.66 for beams and 9.66 for compact tension at 0.5."""
        self.assertAlmostEqual(lefm.bend_factor(0.5), 2.66, delta=0.005)
        self.assertAlmostEqual(lefm.bend_factor(0.45), 2.29, delta=0.005)
        self.assertAlmostEqual(lefm.tension_factor(0.5), 9.66, delta=0.005)
        self.assertAlmostEqual(lefm.tension_factor(0.45), 8.34, delta=0.005)

    def test_openings_of_the_standard(self):
        """E B V / P of compact tension is tabulated as 54.7 at the edge for a/W = 0.5; the mouth of a short edge crack
        opens by 4 * 1.454 sigma a / E [Tada, Paris and Irwin 2000], sigma = 6 P / (B W). Both increase with the
        crack."""
        self.assertAlmostEqual(lefm.tension_opening(0.5), 54.7, delta=0.5)
        self.assertAlmostEqual(lefm.bend_opening(1e-3) / (4 * 1.454 * 6e-3), 1, delta=0.03)
        for opening in (lefm.bend_opening, lefm.tension_opening):
            values = [opening(0.3 + 0.05 * k) for k in range(9)]
            self.assertEqual(values, sorted(values))

    def test_williams_opening_is_that_of_irwin(self):
        """Behind the tip the faces are 8 K / E sqrt(r / 2 pi) apart; ahead of it nothing opens."""
        names = {name: getattr(math, name) for name in ("sqrt", "atan2", "cos", "sin")}
        at = lambda x, y: [eval(text.replace("^", "**"), names | {"x": x, "y": y})
                           for text in lefm.williams_opening(2.0, 70e9, 1 / 3, "x", "y")]  # fmt: skip
        gap = at(-0.01, 1e-15)[1] - at(-0.01, -1e-15)[1]
        self.assertAlmostEqual(gap / (8 * 2.0 / 70e9 * math.sqrt(0.01 / (2 * math.pi))), 1, delta=1e-9)
        self.assertEqual(at(0.01, 0.0)[1], 0)

    def test_a_cantilever_opens_until_its_energy_is_that_of_the_crack(self):
        """G = (P a')^2 12 / (E B^2 h^3) with a' = a + 0.64 h."""
        modulus, energy, arm, thickness, opening = 70e9, 10.0, 0.01, 0.001, 1e-4
        crack = lefm.cantilever_crack(modulus, energy, arm, opening)
        load = lefm.cantilever_load(modulus, arm, thickness, crack, opening)
        self.assertAlmostEqual((load * (crack + 0.64 * arm)) ** 2 * 12 / (modulus * thickness**2 * arm**3), energy, delta=1e-9)


class Verdicts(unittest.TestCase):
    def test_a_peak_between_rows(self):
        self.assertAlmostEqual(peak([5 - 0.1 * (x - 2.3) ** 2 for x in range(5)]), 5, delta=1e-12)
        self.assertEqual(peak([1.0, 2.0, 3.0]), 3)

    def test_a_snap_is_no_parabola(self):
        """Rows of a plate that tears within one step, whose parabola has 1.10 times the largest load."""
        self.assertEqual(peak([0.540, 0.560, 0.602, 0.022]), 0.602)

    def test_every_entry_has_three_spacings_two_horizons_and_four_angles(self):
        found = bar(None).lattices(quick=False)
        self.assertEqual(len({lattice.refinement for lattice in found}), 3)
        self.assertEqual(len({lattice.ratio for lattice in found}), 2)
        self.assertEqual(len({lattice.angle for lattice in found}), 4)
        self.assertEqual(len(bar(None).lattices(quick=True)), 1)

    def test_a_finite_horizon_is_taken_off(self):
        kappa, resistance = 0.4, 0.99
        value = resistance / (1 + 10 * kappa * 0.25 * 3.015)
        lattice = Lattice(0.25)
        beam = verdict({Lattice(): 0.5, lattice: value})
        self.assertAlmostEqual(extension_of(beam, lattice, resistance), kappa, delta=1e-12)
        found = verdict({Lattice(): 0.5, lattice: value}, extension={lattice: kappa})
        self.assertAlmostEqual(found.corrected, resistance, delta=1e-12)
        self.assertTrue(found.passes)
        self.assertIn("| pass |", row(found))

    def test_what_is_off_is_red_and_says_by_how_much(self):
        found = verdict({Lattice(): 0.9})
        self.assertFalse(found.passes)
        self.assertIn("**red**: -10.0 % where 2 % are allowed", row(found))
        failed = verdict({Lattice(): 1.0}, {Lattice(0.5): "no memory"})
        self.assertFalse(failed.passes)
        self.assertIn("h0.5_m3.015_0: no memory", row(failed))

    def test_a_quantity_is_judged_on_its_own_spacing(self):
        values = {Lattice(): 0.8, Lattice(0.5): 1.0, Lattice(0.25): 1.2}
        self.assertTrue(verdict(values, at=0.5, of_longer_crack=None).passes)
        self.assertFalse(verdict(values, of_longer_crack=None).passes)

    def test_one_that_is_asked_on_every_lattice_is_judged_by_the_worst(self):
        values = {Lattice(0.25): 1.0, Lattice(0.5, angle=45.0): 0.9}
        self.assertTrue(verdict(values, of_longer_crack=None).passes)
        strict = verdict(values, of_longer_crack=None, on_every_lattice=True)
        self.assertIn("-10.0 % on h0.5_m3.015_45", row(strict))

    def test_peaks_go_to_their_limit_as_a_size_effect(self):
        """1 / P^2 = 1 + h: first order, 1 at spacing 0, and for the finest lattice 1.25 times its distance from it."""
        values = {Lattice(h): (1 + h) ** -0.5 for h in (1.0, 0.5, 0.25)}
        limit, uncertainty = verdict(values).extrapolated
        self.assertAlmostEqual(limit, 1, delta=1e-9)
        self.assertAlmostEqual(uncertainty, 0.5 * 1.25 * 0.25 / 1.25 * 1.25**-0.5, delta=1e-9)
        self.assertEqual(verdict({Lattice(): 1.0}).extrapolated, (None, None))


class Settings(unittest.TestCase):
    """`--set KEY=VALUE` of the suite."""

    def test_models_with_a_free_ratio_have_that_of_glass(self):
        self.assertEqual(read_settings(["material.model=state"])[RATIO], str(GLASS))
        self.assertEqual(read_settings(["material.model = 'state'", f"{RATIO}=0.3"])[RATIO], "0.3")
        for of_bonds in (["material.model=bond"], ["material.damage.law=exponential"], []):
            self.assertNotIn(RATIO, read_settings(of_bonds))
        self.assertEqual(poisson_ratio(read_settings(["material.model=state"])), GLASS)
        self.assertIsNone(poisson_ratio({}))

    def test_pairs_without_key_or_value_are_refused(self):
        for pairs in (["material.model"], ["=state"], ["material.model="], ["a=1", "a=2"]):
            with self.assertRaises(WrongSetting):
                read_settings(pairs)
        with self.assertRaises(WrongSetting):
            poisson_ratio({RATIO: "glass"})

    def test_materials_of_regions_have_the_keys_too(self):
        given = {"material.model": "state", "material.damage.law": "linear", "loading.steps": "9"}
        specimen = double_cantilever.SPECIMENS[0]
        self.assertEqual(in_case(given, specimen.text(Lattice())),
                         ["region[0].material.model=state", "region[1].material.model=state", "interface[0].material.model=state",
                          "interface[0].material.damage.law=linear", "loading.steps=9"])  # fmt: skip
        plain = surfing.SPECIMENS[0]
        self.assertEqual(in_case(given, plain.text(Lattice())), [f"{key}={value}" for key, value in given.items()])

    def test_the_field_of_the_strip_is_that_of_the_ratio(self):
        of = lambda ratio: surfing.specimen(Strip(given_ratio=ratio)).text(Lattice())
        self.assertEqual(of(None), surfing.SPECIMENS[0].text(Lattice()))
        self.assertEqual(of(1 / 3), of(None))
        self.assertNotEqual(of(0.22), of(None))


class Strips(unittest.TestCase):
    def displacement(self, strip, x, y, load):
        case = tomllib.loads(strip.text(Lattice(), 1e-3))
        text = next(s for s in case["support"] if s["set"] == "rim")["displacement"][:2]
        names = {name: getattr(math, name) for name in ("sqrt", "atan2", "cos", "sin")} | {"x": x, "y": y, "load": load}
        return [eval(one.replace("^", "**"), names) for one in text]

    def test_half_way_an_arc_is_level(self):
        straight, arc = Strip(way=10.0), Strip(way=10.0, turn=0.5)
        for x, y in ((0.02, 0.01), (-0.01, 0.03), (-0.02, -0.01)):
            for one, other in zip(self.displacement(straight, x, y, 0.5), self.displacement(arc, x, y, 0.5)):
                self.assertAlmostEqual(one / other, 1, delta=1e-9)

    def test_an_arc_ends_turned(self):
        """The field at the end is the field in the middle, turned by half the angle about the arc's centre."""
        arc, half = Strip(way=10.0, turn=0.5), 0.25
        radius = 10.0 * 3.015e-3 / 0.5
        x, y = 0.02, 0.01
        turned = (math.cos(half) * x - math.sin(half) * (y - radius), radius + math.sin(half) * x + math.cos(half) * (y - radius))
        u, v = self.displacement(arc, x, y, 0.5)
        found = self.displacement(arc, *turned, 1.0)
        self.assertAlmostEqual(found[0] / (math.cos(half) * u - math.sin(half) * v), 1, delta=1e-9)
        self.assertAlmostEqual(found[1] / (math.sin(half) * u + math.cos(half) * v), 1, delta=1e-9)

    def test_a_strip_in_3d_is_one_of_plane_strain(self):
        """Behind the tip its faces are 8 K / E' sqrt(r / 2 pi) apart."""
        strip = Strip(dimension=3)
        self.assertAlmostEqual(strip.modulus, 70e9 / (1 - 1 / 16), delta=1)
        tip = -0.5 * strip.way * 3.015e-3
        gap = self.displacement(strip, tip - 0.01, 1e-12, 0.0)[1] - self.displacement(strip, tip - 0.01, -1e-12, 0.0)[1]
        self.assertAlmostEqual(gap / (8 * strip.toughness / strip.modulus * math.sqrt(0.01 / (2 * math.pi))), 1, delta=1e-6)

    def test_dissipation_is_that_of_the_last_half(self):
        """The field moves 8 horizons of 3 mm in a strip of 1 mm thickness: half of the way at 9 J/m2, over G_c = 10."""
        folder = Path(self.enterContext(tempfile.TemporaryDirectory())) / "out"
        folder.mkdir()
        with h5py.File(folder / "results.h5", "w") as file:
            file["case/as_resolved"] = "[lattice]\nspacing = 1e-3\nhorizon_ratio = 3.0\n"
        energies = [0.0, 7.0, 7.0 + 9.0 * 4 * 3e-3 * 1e-3]
        lines = ["load_factor,dissipated_energy", *(f"{0.5 * k},{energy!r}" for k, energy in enumerate(energies))]
        (folder / "history.csv").write_text("\n".join(lines))
        self.assertAlmostEqual(surfing.dissipation(folder), 0.9, delta=1e-9)

    def test_every_setting_of_the_lattices_has_a_run_of_its_own(self):
        settings = trapping.settings(quick=False)
        self.assertEqual(len({setting.name for setting in settings}), len(settings))
        for setting in settings:
            tomllib.loads(trapping.text(setting))


class Compliance(unittest.TestCase):
    def history(self, *forces_and_openings) -> Path:
        folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        lines = ["force,control", *(f"{force},{opening}" for force, opening in forces_and_openings)]
        (folder / "history.csv").write_text("\n".join(lines))
        return folder

    def test_toughness_of_a_growing_crack(self):
        """Opening over load is the squared crack length, and it grows at the load 1.1 / crack instead of 1 / crack."""
        cracks = [1.0, 1.2, 1.6, 2.0]
        folder = self.history((0, 0), (0.5, 0.5), *((1.1 / a, 1.1 * a) for a in cracks))
        of = lambda least: toughness(folder, "force", lambda a: a * a, lambda a: 1 / a, 1.0, 3.0, least)
        self.assertAlmostEqual(of(0.3), 1.1, delta=1e-9)
        with self.assertRaisesRegex(ValueError, "has not grown by 1.5 m"):
            of(1.5)
        self.assertAlmostEqual(elastic_factor(folder, "force", 0.8), 1.25, delta=1e-12)


if __name__ == "__main__":
    unittest.main()
