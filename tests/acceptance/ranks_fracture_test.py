"""Fracture on several ranks equals that on one."""

import unittest

import h5py
import numpy

from tests.acceptance.on_ranks import CUBE, SHEET, SOLVER, STORED, Comparison, rows

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
    """The same bonds break in the same steps as on one rank, and all fields agree."""

    def broken(self, output):
        return [(row["step"], row["first_point"], row["second_point"]) for row in rows(output, "broken_bonds.csv")]

    def compare_torn(self, ranks, *settings, text=TORN + SOLVER):
        runs = self.ended_on_each((1, *ranks), text, *settings, code=(0, 3))
        one, expected = runs[1]
        for count in ranks:
            several, found = runs[count]
            with self.subTest(ranks=count, settings=settings):
                self.assertEqual(several.code, one.code, several.said)
                self.assertEqual(self.broken(expected), self.broken(found))
                self.expect_same(expected, found)
                decisions = [[(row["step"], row["action"], row["outcome"]) for row in rows(at, "decisions.csv")]
                             for at in (expected, found)]  # fmt: skip
                self.assertEqual(*decisions)
        return expected

    def test_bonds_that_soften_in_implicit_steps(self):
        for ranks, law in ((3, '"tanh", onset=0.03, critical=0.5, rate=3'), (2, '"linear", onset=0.03, critical=0.6'),
                           (2, '"exponential", onset=0.05, critical=0.9'), (3, '"critical_stretch", critical=0.1')):  # fmt: skip
            one = self.compare_torn((ranks,), f"material.damage={{law={law}}}", 'solver.mode="newton"')
            with h5py.File(one / "results.h5") as file:
                self.assertGreater(file["history/dissipated_energy"][-1], 0.0)

    def test_a_plate_that_is_torn(self):
        one = self.compare_torn((2,), 'solver.mode="adaptive"')
        actions = [row["action"] for row in rows(one, "decisions.csv")]
        self.assertIn("hand over to relaxation", actions)
        self.compare_torn((2,), 'solver.mode="adaptive"', "solver.elastic_horizon_ratio=2.015")
        self.assertGreater(len(rows(one, "broken_bonds.csv")), 50)
        self.compare_torn((3,), 'solver.mode="adaptive"', "solver.elastic_horizon_ratio=2.015", "loading.steps=12", self.HALF,
                          text=TORN + STORED)  # fmt: skip

    def test_a_rigid_set_goes_on_with_another_number_of_ranks(self):
        """The centre of rotation is the same, to the last bit."""
        text = TORN.replace('[[support]]\nset = "top"', '[[rigid]]\nset = "top"\nrotation = ["0.01*load"]') + STORED
        options = ('solver.mode="adaptive"', "loading.steps=8")
        one = self.run_on(1, text, *options)
        output = self.run_on(2, text, *options, words=("--stop-after", 6), code=130)
        self.resume_on(3, output)
        self.expect_same(one, output)

    def test_several_materials(self):
        upper = ('damage={law="tanh", onset=0.03, critical=0.5, rate=3}, scatter=[{of="strength", distribution="weibull", '
                 'weibull_modulus=8, correlation_length=0.2, seed=3}]')  # fmt: skip
        one = self.compare_torn(
            (2,), 'material.damage={law="linear", onset=0.03, critical=0.6}', 'solver.mode="newton"',
            'set=[{name="upper", where="y > 0.9"}]', f'region=[{{set="upper", material={{youngs_modulus=2e9, {upper}}}}}]',
            'interface=[{between=["upper", "material"], material={youngs_modulus=1e9, damage={law="critical_stretch", critical=0.11}}}]')  # fmt: skip
        with h5py.File(one / "results.h5") as file:
            self.assertGreater(file["history/dissipated_energy"][-1], 0.0)
        self.assertGreater(len(rows(one, "broken_bonds.csv")), 0)

    def test_ends_of_fracture(self):
        for ranks, *settings in (
            (2, 'solver.mode="newton"', "loading.max_broken_bonds=3", 'material.damage={law="critical_stretch", critical=0.06}',
             "output.count_cracks=true", "loading.smallest_step=0.01"),
            (3, 'solver.mode="adaptive"', "loading.stop_below=0.5", 'solver.projection="always"'),
            (2, 'solver.mode="relaxation"', 'solver.fragments="stop"'),
        ):  # fmt: skip
            self.compare_torn((ranks,), *settings)

    def test_ways_of_relaxation(self):
        for ranks, *settings in (
            (3, 'solver.mode="relaxation"', 'relaxation.breaking="transient"'),
            (2, 'solver.mode="relaxation"', 'relaxation.load="moving"', "relaxation.iterations=1200", 'relaxation.damping="kinetic"'),
            (2, 'solver.mode="adaptive"', 'relaxation.method="flow"'),
            (2, 'solver.mode="adaptive"', "relaxation.peak_tolerance=0.01", 'solver.fragments="remove"'),
        ):
            self.compare_torn((ranks,), *settings)

    HALF = 'symmetry=[{axis="x", at=1.2}]'

    def broken_to_images(self, output):
        return sum(row["second_image"] != "0" for row in rows(output, "broken_bonds.csv"))

    def test_half_a_plate_that_is_torn(self):
        one = self.compare_torn((3,), 'solver.mode="adaptive"', self.HALF, text=TORN + STORED)
        self.assertGreater(self.broken_to_images(one), 5)
        for ranks, *settings in (
            (3, 'solver.mode="relaxation"', 'relaxation.breaking="transient"'),
            (2, 'solver.mode="adaptive"', 'relaxation.method="flow"'),
            (2, 'solver.mode="newton"', 'material.damage={law="tanh", onset=0.03, critical=0.5, rate=3}'),
        ):
            self.compare_torn((ranks,), *settings, self.HALF, text=TORN + STORED)

    def test_a_cell_that_is_torn(self):
        one = self.compare_torn((2,), 'solver.mode="adaptive"', text=TORN + STORED + """
            [[period]]
            axis = "x"
            from = 0
            to = 1.2
            gradient = ["0.01*load", "free"]
        """)  # fmt: skip
        self.assertGreater(self.broken_to_images(one), 5)

    def test_a_plate_that_a_rigid_set_tears(self):
        text = TORN.replace('[[support]]\nset = "top"', '[[rigid]]\nset = "top"\nrotation = ["0.01*load"]')
        text = text.replace('"0.01*load", "0.08*load"', '"free", "0.08*load"')
        for mode, ranks in (("adaptive", 3), ("relaxation", 2)):
            one = self.compare_torn((ranks,), f'solver.mode="{mode}"', text=text + STORED)
            self.assertGreater(len(rows(one, "broken_bonds.csv")), 50)
            self.assertNotEqual(float(rows(one, "history.csv")[1]["moment_z:top"]), 0.0)

    def test_half_a_plate_that_goes_on(self):
        text, options = TORN + STORED, ('solver.mode="relaxation"', self.HALF)
        whole = self.run_on(1, text, *options).rename(self.folder / "whole")
        on_two = self.run_on(2, text, *options).rename(self.folder / "on_two")
        for ranks in (3, 2):
            output = self.run_on(2, text, *options, words=("--stop-after", 6), code=130)
            self.assertGreater(self.broken_to_images(output), 0)
            self.resume_on(ranks, output)
            self.assertEqual(self.broken(whole), self.broken(output))
            self.expect_same(whole, output)
        with h5py.File(on_two / "results.h5") as expected, h5py.File(output / "results.h5") as found:
            last = list(expected["steps"])[-1]
            for name in (f"steps/{last}/displacement", "history/external_work", "history/dissipated_energy"):
                self.assertTrue(numpy.array_equal(expected[name], found[name]), name)

    SHEET_UNDER_LOAD = SHEET + """displacement = ["0.18*load", "0.03*load"]
        [loading]
        steps = 4
        [relaxation]
        steps = 10
    """ + STORED

    def test_triangles_that_are_lost_with_their_bonds(self):
        one = self.compare_torn((2,), 'solver.mode="adaptive"', 'material.damage.drive="stretch"', text=self.SHEET_UNDER_LOAD)
        self.assertIn("hand over to relaxation", [row["action"] for row in rows(one, "decisions.csv")])
        self.assertGreater(len(rows(one, "broken_bonds.csv")), 50)
        softening = 'material.damage={law="tanh", onset=0.03, critical=0.6, rate=3}'
        self.compare_torn((2,), 'solver.mode="newton"', softening, "loading.table=[0, 0.8]", "solver.relative_tolerance=1e-12",
                          text=self.SHEET_UNDER_LOAD)  # fmt: skip

    def test_tetrahedra_that_are_lost_with_their_bonds(self):
        one = self.compare_torn((2,), 'solver.mode="relaxation"', 'material.damage={law="critical_stretch", critical=0.07}',
                                "loading.table=[0, 0.8]", "relaxation.steps=2", text=CUBE + STORED)  # fmt: skip
        self.assertGreater(len(rows(one, "broken_bonds.csv")), 20)

    def test_triangles_that_go_on_with_another_number_of_ranks(self):
        text, mode = self.SHEET_UNDER_LOAD, 'solver.mode="relaxation"'
        whole = self.run_on(1, text, mode).rename(self.folder / "whole")
        for first, then in ((2, 3), (3, 1), (1, 2)):
            output = self.run_on(first, text, mode, words=("--stop-after", 4), code=130)
            self.assertGreater(len(self.broken(output)), 20)
            self.resume_on(then, output)
            self.assertEqual(self.broken(whole), self.broken(output))
            self.expect_same(whole, output)

    STATES = TORN.replace('model = "bond"\n', 'model = "state"\npoisson_ratio = 0.45\n') + STORED
    TORN_STATES = (  # law, mode, Poisson's ratio, last load, least number of broken bonds
        ('{law="critical_stretch", critical=0.03, no_fail=["bottom", "top"]}', "adaptive", 0.45, 0.35, 50),
        ('{law="linear", onset=0.02, critical=0.05, no_fail=["bottom", "top"]}', "adaptive", 0.1, 0.4, 50),
        ('{law="linear", onset=0.03, critical=0.6}', "newton", 0.45, 0.36, 0),
    )

    def of_states(self, law, mode, ratio, last):
        return f"material.damage={law}", f'solver.mode="{mode}"', f"material.poisson_ratio={ratio}", f"loading.table=[0, {last}]"

    def test_states_that_are_torn_by_what_their_bonds_release(self):
        for *case, broken in self.TORN_STATES:
            one = self.compare_torn((2, 3), *self.of_states(*case), "loading.steps=2", text=self.STATES)
            with h5py.File(one / "results.h5") as file:
                self.assertGreater(file["history/dissipated_energy"][-1], 0.0)
            self.assertGreaterEqual(len(self.broken(one)), broken)

    def test_states_beside_planes_are_refused(self):
        self.assertIn("is for one rank with planes", self.refusal(self.STATES, self.HALF))

    def test_torn_states_go_on_with_another_number_of_ranks(self):
        options = (*self.of_states(*self.TORN_STATES[2][:-1]), "loading.steps=8", "loading.adaptive=false")
        whole = self.run_on(1, self.STATES, *options).rename(self.folder / "whole")
        for first, then in ((2, 3), (3, 1), (1, 2)):
            output = self.run_on(first, self.STATES, *options, words=("--stop-after", 7), code=130)
            self.assertGreater(float(rows(output, "history.csv")[-1]["dissipated_energy"]), 0.0)
            self.resume_on(then, output)
            self.assertEqual(self.broken(whole), self.broken(output))
            self.expect_same(whole, output)


    CPD = TORN.replace('model = "bond"\n', 'model = "cpd"\npoisson_ratio = 0.45\n') + STORED
    # Tetrahedra: bonds that share no point depend on each other.
    BLOCK = """
    dimension = 3
    [lattice]
    spacing = 0.1
    horizon_ratio = 1.8
    shape = [{ add = "box", min = [0, 0, 0], max = [0.5, 0.7, 0.4] }]
    layer = [{ name = "bottom", side = "y-" }, { name = "top", side = "y+" }]
    [[crack]]
    vertices = [[-0.1, 0.38, -0.1], [0.22, 0.38, -0.1], [0.22, 0.38, 0.5], [-0.1, 0.38, 0.5]]
    [material]
    model = "cpd"
    youngs_modulus = 1e9
    poisson_ratio = 0.35
    [[support]]
    set = "bottom"
    displacement = [0, 0, 0]
    [[support]]
    set = "top"
    displacement = ["0.01*load", "0.08*load", 0]
    """ + STORED

    def of_release(self, law, *more):
        return self.of_states(law.replace("{", '{drive="release", '), *more)

    def test_triangles_that_are_torn_by_what_their_bonds_release(self):
        brittle, _, softening = self.TORN_STATES
        for *case, broken in (brittle, softening, (*softening[:2], 0.1, *softening[3:])):
            one = self.compare_torn((2, 3), *self.of_release(*case), "loading.steps=2", text=self.CPD)
            with h5py.File(one / "results.h5") as file:
                self.assertGreater(file["history/dissipated_energy"][-1], 0.0)
            self.assertGreaterEqual(len(self.broken(one)), broken)

    def test_tetrahedra_that_are_torn_by_what_their_bonds_release(self):
        for law, ratio in (('{law="linear", onset=0.02, critical=0.6}', 0.35), ('{law="linear", onset=0.02, critical=0.6}', 0.1)):
            one = self.compare_torn((2, 3), *self.of_release(law, "newton", ratio, 0.5), "loading.steps=2", text=self.BLOCK)
            with h5py.File(one / "results.h5") as file:
                self.assertGreater(file["history/dissipated_energy"][-1], 0.0)

    def test_triangles_beside_planes_are_refused(self):
        settings = self.of_release(*self.TORN_STATES[0][:-1])
        self.assertIn("is for one rank with planes", self.refusal(self.CPD, *settings, self.HALF))


# The ring around a tip extends over several parts; the load is of mixed mode.
TIP = """
dimension = 2
[lattice]
spacing = 0.1
horizon_ratio = 2.015
thickness = 0.01
shape = [{ add = "box", min = [0, 0], max = [2.4, 2.3] }]
layer = [{ name = "bottom", side = "y-" }, { name = "top", side = "y+" }]
[[crack]]
from = [0, 1.2]
to = [1.2, 1.2]
[material]
youngs_modulus = 1e9
[[support]]
set = "bottom"
displacement = [0, 0]
[[support]]
set = "top"
displacement = ["0.002*load", "0.01*load"]
[[crack_tip]]
name = "tip"
at = [1.2, 1.2]
direction = [1, 0]
[solver]
relative_tolerance = 1e-11
"""
FRONT = TIP.replace("dimension = 2", "dimension = 3").replace("horizon_ratio = 2.015\nthickness = 0.01", "horizon_ratio = 1.515")
FRONT = FRONT.replace("min = [0, 0], max = [2.4, 2.3]", "min = [0, 0, 0], max = [1.6, 1.7, 0.3]")
FRONT = FRONT.replace("from = [0, 1.2]\nto = [1.2, 1.2]", "vertices = [[0, 0.9, -1], [0.8, 0.9, -1], [0.8, 0.9, 1], [0, 0.9, 1]]")
FRONT = FRONT.replace("[0, 0]", "[0, 0, 0]").replace('"0.01*load"]', '"0.01*load", "0.003*load"]')
FRONT = FRONT.replace("at = [1.2, 1.2]\ndirection = [1, 0]", "at = [0.8, 0.9, 0]\ndirection = [1, 0, 0]")


class CrackTips(Comparison):
    """J, stress intensity factors and T are sums over the ring."""

    def compare_tip(self, text, ranks, names, *settings):
        one = self.compare(text, ranks, 'solver.linear="pcg"', 'solver.preconditioner="block_jacobi"',
                           "solver.linear_tolerance=1e-12", *settings, solver="")  # fmt: skip
        last = rows(one, "history.csv")[-1]
        for name in names:
            self.assertGreater(abs(float(last[f"tip_{name}"])), 0.0)

    def test_of_a_plate(self):
        self.compare_tip(TIP, (2,), ("J", "J_spread", "K1", "K2", "T", "T_star"))

    def test_beside_a_rigid_set(self):
        pulled = TIP.replace('[[support]]\nset = "top"', '[[rigid]]\nset = "top"\nrotation = ["0.001*load"]')
        self.compare_tip(pulled, (3,), ("J", "K1", "K2", "T"), 'solver.tangent="stored"')

    def test_of_a_half(self):
        half = TIP.replace("min = [0, 0]", "min = [0, 1.2]").replace('{ name = "bottom", side = "y-" }, ', "")
        half = half.replace('[[support]]\nset = "bottom"\ndisplacement = [0, 0]\n', '[[symmetry]]\naxis = "y"\nat = 1.2\n')
        self.compare_tip(half, (3,), ("J", "J_spread", "K1", "T"), 'solver.tangent="stored"')

    def test_of_triangles(self):
        self.compare_tip(TIP, (2,), ("J", "K1", "K2"), 'material.model="cpd"', "material.poisson_ratio=0.4")

    def test_of_a_front(self):
        self.compare_tip(FRONT, (2,), ("J", "K1", "K2", "K3", "T"))

    def test_rings_that_are_refused(self):
        for ranks in (1, 2):
            for setting, what in (("crack_tip=[{name='tip', at=[1.7, 1.2], direction=[1, 0]}]", "ahead of the tip"),
                                  ('region=[{set="top", material={youngs_modulus=2e9}},{set="right", material={youngs_modulus=3e9}}]',
                                   "two materials")):  # fmt: skip
                said = self.refusal(TIP + '[[set]]\nname = "right"\nwhere = "x > 1.5 && y < 2.3"\n', setting, ranks=ranks)
                self.assertIn(what, said)
        self.assertIn("is for one rank", self.refusal(TIP.replace("[1, 0]", "[1, 0]\ncut = 0.3")))


if __name__ == "__main__":
    unittest.main()
