"""Motions on several MPI ranks equal those on one."""

import unittest

import h5py
import numpy

from tests.acceptance import dynamics_test
from tests.acceptance.on_ranks import BLOCK, CUBE, PLATE, SHEET, SQUARE, STATES, Comparison, rows
from tests.acceptance.ranks_bodies_test import CELL
from tests.reference.program import ROOT

# Torn from a pre-crack and a hole by a suddenly applied load; fragments fly away.
TORN = """
dimension = 2
[lattice]
spacing = 0.1
thickness = 0.01
shape = [{ add = "box", min = [0, 0], max = [1.2, 1.6] }, { subtract = "disk", centre = [0.72, 0.83], radius = 0.2 }]
layer = [{ name = "bottom", side = "y-" }]
[[crack]]
from = [0, 0.9]
to = [0.22, 0.93]
[[set]]
name = "upper"
where = "y > 1.3 + 0.1*x"
[material]
youngs_modulus = 1e9
density = 1000
[material.damage]
law = "critical_stretch"
critical = 0.02
no_fail = ["bottom"]
[[support]]
set = "bottom"
displacement = [0, "1e-3*sin(4000*t)"]
[[load]]
set = "upper"
body_force = ["2e7*t/1e-3", "4e7*(1 + x)"]
[[initial]]
velocity = ["6*(x - 0.5)*y", "22*y*y"]
[solver]
mode = "dynamics"
[dynamics]
end_time = 3e-3
history_every = 3
[output]
every = 6
count_cracks = true
[[probe]]
name = "length"
set = "upper"
field = "crack_length"
axis = "x"
[[probe]]
name = "taken"
set = "upper"
field = "work_of_fracture"
"""
BAR_IN_FLIGHT = """
dimension = 1
[lattice]
spacing = 0.1
area = 2.0
shape = [{ add = "box", min = [0], max = [0.5] }]
[material]
micromodulus = 7.0
density = 3.0
[[initial]]
velocity = ["0.01*x + 0.1"]
[solver]
mode = "dynamics"
[dynamics]
end_time = 3.0
"""
# Torn at its plane of symmetry, too.
HALF = 'symmetry=[{axis="x", at=1.2}]'
# A periodic cell whose periods change.
CELL_IN_MOTION = CELL.split("[loading]")[0]
for text, moving in (("1e-2*load", "1e-2*sin(2000*t)"), ("2e-3*load", "2*t"), ('[0, "free"]', '["t", 0]'),
                     ("[material]", "[material]\ndensity = 1000"), ("2e4*load", "2e7*t")):  # fmt: skip
    CELL_IN_MOTION = CELL_IN_MOTION.replace(text, moving)
CELL_IN_MOTION += """
[[initial]]
velocity = ["0.1*sin(5*x)", "0.2*y"]
[solver]
mode = "dynamics"
[dynamics]
end_time = 1e-3
history_every = 2
[output]
every = 6
"""
LAW = 'material.damage={law="tanh", onset=0.01, critical=0.03, rate=3, no_fail=["bottom"]}'
NEWMARK = ('dynamics.scheme="newmark"', "dynamics.time_step=1e-4", 'solver.linear="pcg"',
           'solver.preconditioner="block_jacobi"', "solver.linear_tolerance=1e-12",
           "solver.relative_tolerance=1e-12")  # fmt: skip
# Other models, in slow motion.
SQUARE_IN_MOTION = SQUARE.replace('["0.4*load", "0.1*load"]', '["0.1*sin(2*t)", "free"]')
CUBE_IN_MOTION = CUBE.replace('["0.2*load", 0, "0.05*load"]', '["0.05*t", "free", "free"]')
STATES_IN_MOTION = STATES.replace('"0.05*load"', '"1e-4*sin(2000*t)"').replace("1e6*load*y", "1e3*y")
SLOWLY = """
[solver]
mode = "dynamics"
[dynamics]
end_time = 1.0
history_every = 4
[output]
every = 8
stress = true
[[initial]]
velocity = ["0.2*x", "0.1*y*y"]
"""


def without_steps(text, density):
    text = text.replace("[loading]\nsteps = 1\n", "").replace("[loading]\nsteps = 2\n", "")
    return text.replace("[material]\n", f"[material]\ndensity = {density}\n")


class Motions(Comparison):
    """Explicit steps: waves, supports and loads that move, absorbing layers."""

    MOVING = (
        PLATE.replace('"0.05*load"', '"1e-3*sin(2000*t)"')
        .replace('["1e6*load*y", 0]', '["1e6*t*2000*y", "1e5*exp(-t*5000)"]')
        .replace("youngs_modulus", "density = 1000\nyoungs_modulus")
        .replace("[loading]\nsteps = 2\n", "")
    )
    STEPS = """
        [solver]
        mode = "dynamics"
        [dynamics]
        end_time = 1e-3
        history_every = 2
        [[initial]]
        set = "corner"
        velocity = ["0.1", "0.2*x"]
        displacement = ["1e-4*exp(-(y - 1.2)^2*50)", "0"]
        [[absorbing]]
        rate = "x < 0.3 ? 3000*(0.3 - x) : 0"
        [output]
        every = 6
        [[probe]]
        name = "swing"
        set = "corner"
        field = "velocity"
        component = "y"
    """

    def move(self, text, ranks, *options):
        return self.compare(text, ranks, *options, solver="")

    def test_a_plate_whose_supports_and_loads_move(self):
        one = self.move(self.MOVING + self.STEPS, (2, 4))
        last = rows(one, "history.csv")[-1]
        for name in ("kinetic_energy", "external_work", "drained_energy", "momentum_x", "swing"):
            self.assertNotEqual(float(last[next(key for key in last if key.startswith(name))]), 0.0, name)

    def test_given_steps_and_a_row_each(self):
        self.move(self.MOVING + self.STEPS, (2,), "dynamics.time_step=5e-6", "dynamics.history_every=1",
                  "dynamics.end_time=1e-4", "output.every=7")  # fmt: skip

    def test_a_free_body_and_ranks_without_a_point(self):
        self.move(BAR_IN_FLIGHT, (2, 7))

    def test_planes_and_periods(self):
        half = self.move(self.MOVING + self.STEPS, (3,), 'symmetry=[{axis="x", at=1}]')
        self.assertNotEqual(float(rows(half, "history.csv")[-1]["reaction_x:symmetry_x"]), 0.0)
        cell = self.move(CELL_IN_MOTION, (2,))
        self.assertNotEqual(float(rows(cell, "history.csv")[-1]["external_work"]), 0.0)

    def test_two_pieces(self):
        apart = self.MOVING.replace('{ subtract = "disk", centre = [0.5, 0.7], radius = 0.2 }',
                                    '{ subtract = "box", min = [-1, 0.5], max = [2, 0.8] }')  # fmt: skip
        self.move(apart + self.STEPS, (3,))

    def test_a_block_under_its_weight(self):
        block = BLOCK.replace("load*", "").replace("[loading]\ntable = [0, 1, 0.5]", "")
        self.move(block + """
            [solver]
            mode = "dynamics"
            [dynamics]
            end_time = 0.05
            step_share = 0.5
            history_every = 5
        """, (2,))  # fmt: skip

    def test_a_wave(self):
        wave = (ROOT / "cases/bond_models/wave_propagation.toml").read_text()
        wave = wave.replace("[[initial]]", '[[initial]]\nvelocity = ["0.1", "0.05*x"]')  # a momentum
        self.move(wave, (2,), "lattice.spacing=0.1", "dynamics.end_time=0.6")

    def test_steps_that_are_refused(self):
        for ranks in (1, 2):
            said = self.refusal(self.MOVING + self.STEPS, "dynamics.time_step=1e-3", ranks=ranks)
            self.assertIn("longer than the stable step", said)
            said = self.refusal(self.MOVING + self.STEPS.replace("0.2*x", "x > 0.96 ? 1/0 : 0"), ranks=ranks)
            self.assertIn("it must be finite", said)

    def ends_of(self, text, *options):
        found = []
        for run, output in self.ended_on_each((1, 3), text, *options, code=(0, 3)).values():
            decision = rows(output, "decisions.csv")[-1]
            found.append((run.code, decision["outcome"], decision["reason"], decision["stage"]))
        self.assertEqual(found[0], found[1])
        return found[0]

    def test_a_load_without_a_value_on_one_rank(self):
        missing = self.MOVING.replace('"1e5*exp(-t*5000)"', '"x > 0.96 && t > 4e-4 && t < 4.5e-4 ? 1/0 : 0"')
        code, outcome, reason, _ = self.ends_of(missing + self.STEPS)
        self.assertEqual((code, outcome), (3, "undefined_condition"))
        self.assertIn("finite", reason)

    def test_a_support_without_a_value_on_one_rank(self):
        missing = self.MOVING.replace('"1e-3*sin(2000*t)"', '"x > 0.96 && t > 4e-4 && t < 4.5e-4 ? 1/0 : 0"')
        self.assertEqual(self.ends_of(missing + self.STEPS)[1], "undefined_condition")

    def test_a_run_that_is_stopped_and_goes_on(self):
        whole = self.run_on(1, self.MOVING + self.STEPS).rename(self.folder / "whole")
        output = self.run_on(2, self.MOVING + self.STEPS, words=("--stop-after", 3), code=130)
        self.assertEqual([row["step"] for row in rows(output, "history.csv")], ["0", "2", "4", "6"])
        self.resume_on(3, output)
        self.expect_same(whole, output)


class Torn(Comparison):
    """The same bonds break in the same steps for any partition."""

    def broken(self, output):
        return [(row["step"], row["first_point"], row["second_point"]) for row in rows(output, "broken_bonds.csv")]

    def compare_torn(self, text, ranks, *of):
        one = self.compare(text, ranks, *of, solver="")
        for count in ranks:
            self.assertEqual(self.broken(one), self.broken(self.folder / f"on_{count}"))
        self.assertGreater(len({step for step, _, _ in self.broken(one)}), 2)
        return one

    def test_a_plate_that_flies_apart(self):
        one = self.compare_torn(TORN, (2, 3))
        self.assertGreater(len(rows(one, "broken_bonds.csv")), 200)
        self.assertIn("change time step", {row["action"] for row in rows(one, "decisions.csv")})
        with h5py.File(one / "results.h5") as file:
            self.assertGreater(file["history/max_damage"][-1], 0.8)
            step = list(file["steps"])[-1]
            moved = file[f"steps/{step}/displacement"][()]
            self.assertGreater(numpy.ptp(moved[:, 1]), 0.2)

    def to_images(self, output):
        return [row for row in rows(output, "broken_bonds.csv") if row["second_image"] != "0"]

    def test_half_a_plate_that_flies_apart(self):
        one = self.compare_torn(TORN, (3,), HALF)
        self.assertGreater(len(self.to_images(one)), 10)

    def test_a_cell_that_is_torn(self):
        cell = CELL_IN_MOTION.replace("density", 'damage = { law = "critical_stretch", critical = 0.03 }\ndensity')
        one = self.compare_torn(cell, (3,), 'crack=[{from=[-0.6, -0.3], to=[-0.3, -0.32]}]', "dynamics.history_every=1")
        self.assertGreater(len(self.to_images(one)), 10)

    def test_an_impact_on_half_a_plate(self):
        impact = (ROOT / "cases/bond_models/kalthoff_winkler.toml").read_text()
        self.compare_torn(impact, (4,), "lattice.spacing=2.5e-3", "output.every=20")

    def test_bonds_that_soften_under_steps_that_are_given(self):
        self.compare_torn(TORN, (2,), LAW, "dynamics.time_step=5e-5", "dynamics.history_every=1", "output.every=7")

    def test_triangles_that_are_lost_with_their_bonds(self):
        text = SHEET + 'displacement = ["0.5*t", "0.1*t"]' + SLOWLY
        self.compare_torn(text, (2,), "dynamics.end_time=1.2", 'initial=[{velocity=["0.1*x*x", "0.1*y"]}]')

    def test_a_bar_thinner_than_the_horizon_and_ranks_without_a_point(self):
        bar = BAR_IN_FLIGHT.replace("0.01*x", "0.12*x*x") + 'time_step = 0.1\nhistory_every = 1\n'
        bar = bar.replace("density", 'damage = { law = "critical_stretch", critical = 0.02 }\ndensity')
        self.compare_torn(bar, (2, 7))
        codes = set()
        for ranks in (1, 3):  # all bonds break
            torn = bar.replace("0.12*x*x", "x*x").replace("time_step = 0.1", "step_share = 0.9")
            run, output = self.ended_on(ranks, torn)
            row, decision = rows(output, "history.csv")[-1], rows(output, "decisions.csv")[-1]
            codes.add((run.code, row["broken_bonds"], decision["reason"]))
        self.assertEqual(len(codes), 1)
        self.assertEqual(codes.pop()[:2], (0, "9"))  # its points fly on, with the last stable step

    def test_tears_that_go_on_with_other_numbers_of_ranks(self):
        # Lengths have other last bits on other numbers of ranks. Bonds that continue to soften by these
        # alone would be listed again. So half a plate continues with the same number.
        for k, (of, then) in enumerate((((LAW,), 3), ((LAW, *NEWMARK), 3), ((LAW, HALF), 2))):
            with self.subTest(settings=of):
                options = (*of, "dynamics.history_every=1")
                whole = self.run_on(1, TORN, *options).rename(self.folder / f"whole_{k}")
                output = self.run_on(2, TORN, *options, words=("--stop-after", 7), code=130)
                count = len(self.broken(output))
                self.assertGreater(count, 20)
                self.resume_on(then, output)
                self.assertGreater(len(self.broken(output)), count)
                self.assertEqual(self.broken(whole), self.broken(output))
                self.expect_same(whole, output)


class Implicit(Comparison):
    """Newmark's steps, whose tangent includes masses."""

    def test_a_plate_whose_supports_and_loads_move(self):
        one = self.compare(Motions.MOVING + Motions.STEPS, (2,), *NEWMARK, "dynamics.spectral_radius=0.8", solver="")
        self.assertGreater(float(rows(one, "history.csv")[-1]["newton_iterations"]), 0)

    def test_a_plate_that_is_torn(self):
        self.compare(TORN, (3,), HALF, *NEWMARK, solver="")
        one = self.compare(TORN, (2,), *NEWMARK, solver="")
        self.assertGreater(len(rows(one, "broken_bonds.csv")), 200)

    def test_preconditioners(self):
        for kind in ("jacobi", "rigid_pieces", "auto"):
            self.compare(TORN, (2,), *NEWMARK, f'solver.preconditioner="{kind}"', "dynamics.end_time=3e-4", solver="")

    def test_ranks_without_a_point(self):
        self.compare(BAR_IN_FLIGHT.replace("x +", "x*x +"), (7,), *NEWMARK, "dynamics.time_step=0.2", solver="")

    def test_steps_that_are_refused(self):
        for ranks in (1, 2):
            said = self.refusal(TORN, *NEWMARK, "dynamics.time_step=1e-9", ranks=ranks)
            self.assertIn("shorter than a thousandth of the stable explicit step", said)


class FromEquilibrium(Comparison):
    """A motion that starts in the equilibrium of supports and loads at t = 0."""

    STEADY = Motions.MOVING.replace('["1e6*t*2000*y", "1e5*exp(-t*5000)"]', '["1e6*(1 + 2000*t)*y", "-1e6"]')
    STEPS = Motions.STEPS.replace('displacement = ["1e-4*exp(-(y - 1.2)^2*50)", "0"]', "").replace(
        'mode = "dynamics"', 'mode = "dynamics"\n'
        + "\n".join(setting.replace("=", " = ", 1) for setting in NEWMARK if setting.startswith("solver.")).replace("solver.", "")).replace(
        "[dynamics]", '[dynamics]\nstart = "equilibrium"')  # fmt: skip

    def test_explicit_and_implicit_steps(self):
        for of in ((), NEWMARK[:2]):
            one = self.compare(self.STEADY + self.STEPS, (2,), *of, solver="")
            first = rows(one, "history.csv")[0]
            self.assertGreater(float(first["stored_energy"]), 0.0)
            with h5py.File(one / "results.h5") as file:
                self.assertGreater(numpy.abs(file["steps/000000/displacement"][()]).max(), 1e-4)

    def test_automatic_choices(self):
        """One rank has a factorisation, several iterate to a tolerance."""
        tight = "solver.relative_tolerance=1e-12", "solver.linear_tolerance=1e-12"
        text = dynamics_test.Start.HANGING.replace("LATER", "0.1*t")
        one, several = (self.run_on(ranks, text, *tight) for ranks in (1, 2))
        self.expect_same(one, several)

    def test_goes_on(self):
        whole = self.run_on(1, self.STEADY + self.STEPS).rename(self.folder / "whole")
        output = self.run_on(2, self.STEADY + self.STEPS, words=("--stop-after", 3), code=130)
        self.resume_on(3, output)
        self.expect_same(whole, output)

    def test_starts_that_are_none(self):
        free = self.STEADY.replace('displacement = [0, 0]', 'displacement = ["free", 0]').replace('[0, "1e-3*sin(2000*t)"]', '["free", 0]')
        brittle = self.STEADY.replace("density", 'damage = { law = "critical_stretch", critical = 1e-4 }\ndensity')
        for text, code, words in ((free, 2, "do not hold the body"), (brittle, 3, "no equilibrium found at the start")):
            for ranks in (1, 2):
                self.run_on(ranks, text + self.STEPS, code=code)
                self.assertIn(words, self.ended.said)


class OtherModels(Comparison):
    """Triangles, tetrahedra and state-based bodies in motion, with their stress."""

    def compare_slow(self, text, ranks, density, *of):
        text = without_steps(text, density)
        one = self.compare(text + SLOWLY, ranks, *of, solver="")
        self.assertGreater(len(rows(one, "history.csv")), 2)
        with h5py.File(one / "results.h5") as file:
            last = file["steps"][list(file["steps"])[-1]]
            self.assertGreater(numpy.abs(last["cauchy_stress"][()]).max(), 0.0)

    def test_triangles(self):
        self.compare_slow(SQUARE_IN_MOTION, (2,), 0.002, 'set=[{name="corner", where="x > 0.7 && y > 0.3"}]',
                          'region=[{set="corner", material={c1=2.0, c2=20.0, density=0.003}}]',
                          'eigenstrain=[{set="corner", strain="0.01*t*x"}]')  # fmt: skip

    def test_tetrahedra(self):
        self.compare_slow(CUBE_IN_MOTION, (2,), 0.002, "dynamics.end_time=0.5", 'initial=[{velocity=["0.1*x","0.1*y*y","0.1*z"]}]')

    def test_states(self):
        """The second material has another ratio of moduli, so that ranks know other bounds of the stable step."""
        self.compare_slow(STATES_IN_MOTION, (2,), 1000, "dynamics.end_time=1e-3",
                          'region=[{set="corner", material={youngs_modulus=2e9, poisson_ratio=0.1, density=900}}]')  # fmt: skip

    def test_implicit_steps(self):
        self.compare_slow(SQUARE_IN_MOTION, (2,), 0.002, *NEWMARK, "dynamics.time_step=0.1", "dynamics.history_every=1")
        self.compare_slow(STATES_IN_MOTION, (2,), 1000, *NEWMARK, "dynamics.end_time=1e-3", "dynamics.history_every=1")


if __name__ == "__main__":
    unittest.main()
