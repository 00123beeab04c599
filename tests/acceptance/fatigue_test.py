"""Mode fatigue: cycles of the load, compared with closed forms and with tests/reference/fatigue.py."""

import json

import numpy

from tests.acceptance.programme_test import Programmes
from tests.reference.fatigue import Lattice, events
from tests.reference.results import Results, table

CHAIN = """\
dimension = 1
[lattice]
spacing = 1e-3
horizon_ratio = 2.015
area = 1e-4
[[lattice.shape]]
add = "box"
min = [0.0]
max = [0.01]
[[lattice.layer]]
name = "left"
side = "x-"
[[lattice.layer]]
name = "right"
side = "x+"
[quadrature]
volume_correction = "none"
surface_correction = "none"
[material]
youngs_modulus = 200e9
[material.damage]
law = "critical_stretch"
critical = 0.1
[[support]]
set = "left"
displacement = [0]
[[support]]
set = "right"
displacement = ["2e-5*load"]
[solver]
mode = "fatigue"
relative_tolerance = 1e-13
[fatigue]
load_ratio = 0.1
nucleation = { coefficient = 1e9, exponent = 4, limit = 1e-4 }
"""
# 10 x 8 points between two held layers, with a crack from the left; pulled and sheared.
PLATE = CHAIN.replace("dimension = 1", "dimension = 2").replace("area = 1e-4", "thickness = 1e-3").replace(
    "min = [0.0]\nmax = [0.01]", "min = [0.0, 0.0]\nmax = [0.01, 0.008]").replace(
    'side = "x-"', 'side = "y-"').replace('side = "x+"', 'side = "y+"').replace(
    "displacement = [0]", "displacement = [0, 0]").replace(
    '["2e-5*load"]', '["2e-6*load", "2e-5*load"]').replace(
    "nucleation =", "growth = { coefficient = 3e9, exponent = 3 }\nnucleation =") + """\
[[crack]]
from = [-1e-3, 4e-3]
to = [3.1e-3, 4e-3]
"""  # fmt: skip
LOADED = 'support=[{set="left", displacement=[0, 0]}]', 'load=[{set="right", total_force=[0, "LOAD*load"]}]'


def loaded(newtons):
    return [change.replace("LOAD", str(newtons)) for change in LOADED]


class Fatigue(Programmes):
    def reason(self, name="out"):
        summary = json.loads((self.folder / name / "summary.json").read_text())
        self.assertEqual(summary["status"], "completed")
        return summary.get("reason", "")

    def blocks(self, *arguments, **options):
        """Rows of the history that end a block."""
        return [row for row in self.rows(*arguments, **options) if row["mode"] == "fatigue"]


class SameAsTheReference(Fatigue):
    def compare(self, text, lattice, pull, blocks, **laws):
        rows = self.blocks(text, f"fatigue.blocks={blocks}")
        made = Results(self.folder / "out")
        places, left, right = made.reference, made.sets["left"], made.sets["right"]
        body = lattice(places)
        start = numpy.zeros_like(places)
        start[right] = pull
        found = events(body, start, numpy.broadcast_to((left | right)[:, None], start.shape), blocks, ratio=0.1, **laws)
        self.assertEqual(len(rows), len(found))
        self.assertGreater(len(found), 2)
        broken = table(self.folder / "out/broken_bonds.csv")
        for row, (cycles, bonds) in zip(rows, found):
            self.assertLess(abs(row["cycles"] / cycles - 1.0), 1e-9)
            mine = {(b["first_point"], b["second_point"]) for b in broken if b["step"] == row["step"]}
            self.assertEqual(mine, {tuple(bond) for bond in bonds.tolist()})

    def test_chain(self):
        self.compare(CHAIN, lambda places: Lattice(places, 2.015e-3), 2e-5, 8, nucleation=(1e9, 4, 1e-4))

    def test_plate_with_a_crack(self):
        def is_cut(a, b):
            if (a[1] - 4e-3) * (b[1] - 4e-3) > 0.0:
                return False
            return a[0] + (4e-3 - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) < 3.1e-3

        self.compare(PLATE, lambda places: Lattice(places, 2.015e-3, is_cut), (2e-6, 2e-5), 25,
                     nucleation=(1e9, 4, 1e-4), growth=(3e9, 3, 0.0))  # fmt: skip


class ClosedForms(Fatigue):
    def test_strain_life_line(self):
        for pull in (5e-6, 1e-5, 4e-5):
            rows = self.rows(CHAIN, f'support[1].displacement=["{pull}*load"]', "fatigue.blocks=1")
            reach = 0.9 * rows[0]["max_stretch"]
            self.assertAlmostEqual(rows[-1]["cycles"] * 1e9 * (reach - 1e-4) ** 4, 1.0, delta=1e-12)
        self.assertIn("ends with block 1", self.reason())

    def test_load_ratio(self):
        lives = [self.rows(CHAIN, "fatigue.blocks=1", "fatigue.nucleation.limit=0", f"fatigue.load_ratio={ratio}")[-1]
                 ["cycles"] for ratio in (-1, 0, 0.5)]  # fmt: skip
        self.assertAlmostEqual(lives[0] / lives[1], 2.0**-4, delta=1e-12)
        self.assertAlmostEqual(lives[2] / lives[1], 0.5**-4, delta=1e-9)

    def test_bonds_below_the_limit_do_not_age(self):
        rows = self.rows(CHAIN, "fatigue.nucleation.limit=0.01", "fatigue.cycles=1e6")
        self.assertEqual([row["cycles"] for row in rows], [0.0, 1e6])
        self.assertEqual(rows[-1]["broken_bonds"], 0)
        rows = self.rows(CHAIN, "fatigue.nucleation.limit=0.01")
        self.assertEqual(len(rows), 1)
        self.assertIn("no bond ages any more", self.reason())

    def test_the_run_ends_at_its_cycles(self):
        whole = self.rows(CHAIN)
        middle = 0.5 * (whole[1]["cycles"] + whole[2]["cycles"])
        rows = self.rows(CHAIN, f"fatigue.cycles={middle!r}")
        self.assertEqual(rows[-1]["cycles"], middle)
        self.assertEqual(rows[-1]["broken_bonds"], whole[1]["broken_bonds"])

    def test_a_torn_chain_stops(self):
        rows = self.rows(CHAIN)
        self.assertLess(abs(rows[-1]["reaction_x:right"]), 1e-9 * rows[0]["reaction_x:right"])
        self.assertIn("no bond ages any more", self.reason())

    def test_energies_balance(self):
        rows = self.rows(PLATE, *loaded(300))
        for row in rows:
            self.assertLess(abs(row["balance_error"]), 1e-3 * row["external_work"])
            self.assertGreaterEqual(row["drained_energy"], 0.0)
        self.assertGreater(rows[-1]["dissipated_energy"], 0.0)


class FinalFailure(Fatigue):
    def test_dead_load(self):
        rows = self.rows(PLATE, *loaded(300))
        self.assertIn(f"final failure after {rows[-1]['cycles']:.9g} cycles", self.reason())
        self.assertEqual(rows[-1]["broken_bonds"], rows[-2]["broken_bonds"])  # the last state that bears the load
        self.assertGreater(rows[-1]["cycles"], rows[-2]["cycles"])
        self.resume("out")
        again = self.history()
        self.assertEqual(again, rows)

    def test_a_crack_runs_by_the_critical_stretch(self):
        tough = self.rows(PLATE, *loaded(300))
        rows = self.rows(PLATE, "material.damage.critical=0.004", *loaded(300))
        self.assertIn("final failure", self.reason())
        self.assertLess(rows[-1]["cycles"], tough[-1]["cycles"])

    def test_force_that_falls_ends_the_run(self):
        rows = self.rows(PLATE, "loading.stop_below=0.5")
        self.assertLess(rows[-1]["reaction_y:right"], 0.5 * rows[0]["reaction_y:right"])
        self.assertGreater(rows[-2]["reaction_y:right"], 0.5 * rows[0]["reaction_y:right"])


class SameLife(Fatigue):
    """Settings that must not matter."""

    def lives(self, *changes, text=PLATE, **options):
        rows = self.blocks(text, "fatigue.blocks=30", *changes, **options)
        return numpy.array([[row["cycles"], row["broken_bonds"]] for row in rows])

    def assert_same(self, one, other, within=1e-8):
        self.assertEqual(one.shape, other.shape)
        self.assertTrue((one[:, 1] == other[:, 1]).all())
        self.assertLess(abs(one[:, 0] / other[:, 0] - 1.0).max(), within)

    def test_steps_of_the_load(self):
        self.assert_same(self.lives(), self.lives("loading.steps=7"))

    def test_threads(self):
        self.assert_same(self.lives(), self.lives(threads=2))

    def test_size(self):
        text = PLATE
        for small, large in (("1e-3", "1e-1"), ("0.01,", "1.0,"), ("0.008", "0.8"), ("2e-6", "2e-4"), ("2e-5", "2e-3"),
                             ("4e-3", "0.4")):  # fmt: skip
            self.assertIn(small, text)
            text = text.replace(small, large)
        self.assert_same(self.lives(), self.lives(text=text))

    def test_units(self):
        millimetres = PLATE
        for metres, other in (("1e-3", "1"), ("0.01,", "10,"), ("0.008", "8"), ("2e-6", "2e-3"), ("2e-5", "2e-2"),
                              ("4e-3", "4"), ("200e9", "200e3")):  # fmt: skip
            millimetres = millimetres.replace(metres, other)
        self.assert_same(self.lives(), self.lives(text=millimetres + '[units]\nlength = "mm"\nstress = "MPa"\n'))

    def test_linear_solver(self):
        self.assert_same(self.lives(), self.lives('solver.linear="pcg"'), within=1e-7)

    def test_bonds_that_break_together(self):
        exact = self.rows(PLATE, *loaded(300))
        joint = self.rows(PLATE, "fatigue.life_tolerance=0.02", *loaded(300))
        self.assertLess(len(joint), len(exact))
        self.assertLess(abs(joint[-1]["cycles"] / exact[-1]["cycles"] - 1.0), 0.02)


class Fields(Fatigue):
    probe = '[[probe]]\nname = "least"\nset = "right"\nfield = "life"\nstatistic = "min"\n'

    def test_field(self):
        rows = self.rows(PLATE + self.probe, "fatigue.blocks=12")
        made = Results(self.folder / "out")
        first, last, right = made.steps[0].life, made.steps[-1].life, made.sets["right"]
        self.assertTrue((first == 1.0).all())
        self.assertTrue(((last >= 0.0) & (last <= 1.0)).all())
        self.assertLess(last.min(), 0.5)
        self.assertEqual(rows[-1]["least"], last[right].min())

    def test_other_modes_have_none(self):
        self.assert_refused(self.command("check", PLATE.replace('mode = "fatigue"', 'mode = "newton"')),
                            'fatigue: is for solver.mode = "fatigue"')  # fmt: skip
        text = PLATE[: PLATE.index("[fatigue]")] + PLATE[PLATE.index("[[crack]]") :]
        self.assert_refused(self.command("check", text), "needs a table [fatigue]")
        text = text.replace('mode = "fatigue"', 'mode = "newton"')
        self.assert_refused(self.command("check", text + self.probe), 'is for solver.mode = "fatigue"')
        rows = self.rows(text)
        self.assertNotIn("cycles", rows[0])

    def test_check_tells_the_laws(self):
        told = self.assert_completed(self.command("check", PLATE)).said
        self.assertIn("load ratio 0.1", told)
        self.assertIn("bonds near a crack lose 3e+09 (range - 0)^3", told)
        self.assertIn("bonds without a crack near lose 1e+09 (range - 0.0001)^4", told)

    def test_a_threshold_without_a_law_of_growth_is_told(self):
        told = self.assert_completed(self.command("check", CHAIN, "fatigue.crack_damage=0.4")).said
        self.assertRegex(told, r"warning: fatigue\.crack_damage.*fatigue\.growth")

    def test_growth_needs_a_crack(self):
        self.assertIn("the body has none", self.refusal(CHAIN, "fatigue={growth={coefficient=1, exponent=3}}"))

    def test_tangent_at_fixed_life(self):
        told = json.loads(self.assert_completed(self.command("check-tangent", PLATE)).output)
        self.assertLess(told["tangent_error"], 1e-6)


class Refusals(Fatigue):
    def test_what_is_not_followed(self):
        for change, words in {
            'material.damage={law="linear", onset=0.01, critical=0.02}': 'must be "critical_stretch" in mode fatigue',
            'material.damage.law="none"': "critical",
            'material.damage={law="none"}': 'needs material.damage.law = "critical_stretch"',
            'material.kinematics="linear"': "kinematics",
            'material.damage.compression="kept"': "compression",
            'support[1].displacement=["0", "2e-5*load + 1e-6"]': "act at load 0",
            "fatigue={load_ratio=0}": "needs a law by which bonds age",
            "fatigue.load_ratio=1": "load_ratio",
            "fatigue.load_ratio=-2": "load_ratio",
            "fatigue.growth={coefficient=1}": "exponent",
            "fatigue.growth={coefficient=-1, exponent=3}": "coefficient",
            "fatigue.growth={coefficient=1, exponent=0}": "exponent",
            "fatigue.cycles=-1": "cycles",
            "fatigue.crack_damage=2": "crack_damage",
            "fatigue.frequency=1": "frequency",
            'symmetry=[{axis="x"}]': "give the whole body",
            "contact=[{}]": "contacts close and open",
            "temperature={change=1}": "temperature",
            'region=[{set="right", material={youngs_modulus=1e9, damage={law="critical_stretch", critical=0.1}}}]':
                "one material",
        }.items():  # fmt: skip
            with self.subTest(change):
                self.assertIn(words, self.refusal(PLATE, change))
        two = PLATE.replace("2e-6*load", "2e-6*load2") + "[loading]\ntable = [0, 1]\ntable2 = [0, 1]\n"
        self.assertIn("one load parameter", self.refusal(two))
