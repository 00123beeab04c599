"""Convolutions beyond planes of symmetry and periods, in statics and in motion."""

import unittest

import numpy

from tests.acceptance.linear_kinematics_test import CommandLine
from tests.reference.results import table

CELL = """\
dimension = 2
[lattice]
spacing = 1e-3
horizon_ratio = 3.015
thickness = 2e-3
shape = [{ add = "box", min = [-0.01, -0.008], max = [0.01, 0.008] },
         { subtract = "disk", centre = [2e-3, 1e-3], radius = 3.2e-3 }]
[material]
kinematics = "linear"
youngs_modulus = 70e9
density = 2440
[[period]]
axis = "x"
from = -0.01
to = 0.01
gradient = ["1e-4*load", "2e-5*load"]
[[period]]
axis = "y"
from = -0.008
to = 0.008
gradient = [0, "free"]
[loading]
steps = 2
[solver]
relative_tolerance = 1e-12
linear_tolerance = 1e-6
"""
PLATE = """\
dimension = 2
[lattice]
spacing = 1e-3
horizon_ratio = 3.015
thickness = 2e-3
shape = [{ add = "box", min = [-0.012, -0.008], max = [0.012, 0.008] },
         { subtract = "disk", centre = [0.0, 0.0], radius = 3.2e-3 }]
[[set]]
name = "ends"
where = "abs(x) > 0.009"
[material]
youngs_modulus = 70e9
density = 2440
[solver]
operator = "fft"
relative_tolerance = 1e-11
linear_tolerance = 1e-6
"""
PULLED = """\
[loading]
steps = 1
[[support]]
set = "ends"
displacement = ["0.05*x*load", "-0.01*y*load"]
"""
MOVED = """\
mode = "dynamics"
[dynamics]
end_time = 2e-6
time_step = 1e-7
[[load]]
set = "ends"
body_force = ["1e12*x", 0]
"""
PLANES = '[[symmetry]]\naxis = "x"\nat = 0.0\n[[symmetry]]\naxis = "y"\nat = 0.0\n'
MODELS = {
    "bonds": ["material.kinematics=linear"],
    "lps": ["material.model=lps", "material.poisson_ratio=0.2", "quadrature.form=energy"],
    "green_bond": ["material.model=green_bond"],
    "correspondence": ["material.model=correspondence", "material.poisson_ratio=0.2"],
}
BLOCK = """\
dimension = 3
lattice = {spacing = 0.1, horizon_ratio = 2.015, shape = [{add = "box", min = [0, 0, 0], max = [0.6, 0.5, 0.7]}]}
material = {youngs_modulus = 1e9, kinematics = "linear"}
quadrature = {volume_correction = "linear"}
set = [{name = "low", where = "z < 0.2"}, {name = "high", where = "z > 0.5"}]
support = [{set = "low", displacement = [0, 0, 0]}, {set = "high", displacement = [0, "1e-3*load", "2e-3*load"]}]
period = [{axis = "x", from = 0, to = 0.6, gradient = ["free", 0, "1e-3*load"]}]
symmetry = [{axis = "y", at = 0.0}]
solver = {relative_tolerance = 1e-12, linear_tolerance = 1e-6}
"""


class Images(CommandLine):
    def columns(self, start=""):
        last = table(self.folder / "out/history.csv")[-1]
        return {name: value for name, value in last.items() if name.startswith(start) and isinstance(value, float)}

    def both_with_reactions(self, case, *settings, share=1e-9):
        found = {}
        for name in ("bonds", "fft"):
            run = self.results(case, f'solver.operator="{name}"', *settings)
            found[name] = run, self.columns("reaction")
        self.same(found["bonds"][0], found["fft"][0], share)
        largest = max(map(abs, found["bonds"][1].values()))
        self.assertGreater(largest, 0.0)
        self.assertEqual(found["bonds"][1].keys(), found["fft"][1].keys())
        for name, reaction in found["bonds"][1].items():
            self.assertAlmostEqual(found["fft"][1][name], reaction, delta=share * largest, msg=name)
        return found["fft"][0]


class Statics(Images):
    def test_cells_are_those_of_the_bonds(self):
        thin = "lattice.shape=[{add=\"box\", min=[-0.01, -0.001], max=[0.01, 0.001]}]"
        thin_period = 'period=[{axis="x", from=-0.01, to=0.01, gradient=["1e-4*load", 0]}, {axis="y", from=-0.001, to=0.001, gradient=["1e-5*load", "free"]}]'
        for settings in ([], ["quadrature.volume_correction=linear"], [thin, thin_period],
                         ['period=[{axis="x", from=-0.01, to=0.01, gradient=["1e-4*load", 0]}]'],
                         ["solver.mode=relaxation", "loading.steps=1"]):  # fmt: skip
            with self.subTest(settings=settings):
                self.both_with_reactions(CELL, *settings, share=1e-6 if "solver.mode=relaxation" in settings else 1e-9)

    def test_blocks_between_a_period_and_a_plane(self):
        self.both_with_reactions(BLOCK)

    def test_points_that_fail(self):
        failing = 'material.damage={law="energy_density", fracture_energy=5.0}'
        found = []
        for name in ("bonds", "fft"):
            found.append(self.results(CELL, f'solver.operator="{name}"', failing, "loading.steps=1",
                                      'period=[{axis="x", from=-0.01, to=0.01, gradient=["1e-4*load", 0]}, {axis="y", from=-0.008, to=0.008}]'))  # fmt: skip
        bonds, run = found
        # Every pass of a tear is solved to a tolerance of its own.
        for name in ("displacement", "damage", "energy_density"):
            self.assertLess(abs(bonds.fields[name] - run.fields[name]).max(), 1e-7 * abs(bonds.fields[name]).max(), name)
        for name in ("external_work", "dissipated", "stored"):
            self.assertAlmostEqual(run.summary["energy"][name] / bonds.summary["energy"][name], 1.0, delta=1e-7, msg=name)
        self.assertEqual(bonds.summary["broken_bonds"], run.summary["broken_bonds"])
        self.assertGreater((run.damage == 1.0).sum(), 3)
        self.assertGreater(((run.damage > 0.0) & (run.damage < 1.0)).sum(), 3)

    def test_a_quarter_is_a_quarter(self):
        for name, model in MODELS.items():
            for ends in (PULLED, MOVED):
                with self.subTest(name=name, ends=ends):
                    whole = PLATE + ends
                    if ends == MOVED:
                        whole = PLATE.replace("relative_tolerance = 1e-11\nlinear_tolerance = 1e-6\n", "") + ends
                    quarter = whole.replace("min = [-0.012, -0.008]", "min = [0.0, 0.0]") + PLANES
                    all_of, part = self.results(whole, *model), self.results(quarter, *model)
                    self.compare(all_of, part)
                    self.assertAlmostEqual(4 * part.summary["energy"]["stored"] / all_of.summary["energy"]["stored"], 1.0, delta=1e-9)

    def compare(self, whole, part, away=(0, 0)):
        number = lambda places: [tuple(place) for place in numpy.round(places[:, :2] / 1e-4).astype(int)]
        of = {place: k for k, place in enumerate(number(whole.reference))}
        same = [of[place] for place in number(part.reference)]
        for name in ("displacement", "energy_density"):
            scale = abs(whole.fields[name]).max()
            self.assertGreater(scale, 0.0)
            self.assertLess(abs(part.fields[name] - whole.fields[name][same]).max(), 1e-9 * scale, name)

    def test_a_cell_of_two_is_two(self):
        """At large strains, which also shear the cell."""
        one = PLATE.replace("min = [-0.012", "min = [0.0").replace("[0.0, 0.0], radius = 3.2e-3", "[0.006, 0.0], radius = 2.2e-3")
        two = PLATE.replace("max = [0.012", "max = [0.024").replace("min = [-0.012", "min = [0.0").replace(
            'centre = [0.0, 0.0], radius = 3.2e-3 }', 'centre = [0.006, 0.0], radius = 2.2e-3 }, { subtract = "disk", centre = [0.018, 0.0], radius = 2.2e-3 }')  # fmt: skip
        ends = """\
[loading]
steps = 1
[[support]]
set = "foot"
displacement = [0, 0]
[[set]]
name = "foot"
where = "y < -0.007"
[[period]]
axis = "x"
from = 0.0
to = {to}
gradient = ["0.04*load", "0.02*load"]
"""
        slip = 'support=[{set="foot", displacement=["0.04*load*x", "0.02*load*x"]}]'
        for name, model in MODELS.items():
            with self.subTest(name=name):
                found = []
                for case, to in ((one, 0.012), (two, 0.024)):
                    run = self.results(case + ends.replace("{to}", str(to)), slip, *model)
                    found.append((run, self.columns("reaction_x:period")["reaction_x:period_x"]))
                (single, pull), (double, pull_of_two) = found
                self.compare(double, single)
                self.assertAlmostEqual(pull, pull_of_two, delta=1e-9 * abs(pull))
                self.assertAlmostEqual(2 * single.summary["energy"]["stored"] / double.summary["energy"]["stored"], 1.0, delta=1e-9)
                self.assertGreater(abs(pull), 0.0)

    def test_the_tangent_is_the_derivative(self):
        for name, model in MODELS.items():
            with self.subTest(name=name):
                case = CELL.replace('kinematics = "linear"\n', "")
                self.assert_completed(self.command("check-tangent", case, "solver.operator=fft", *model))


class Motions(Images):
    def test_cells_move_as_those_of_bonds(self):
        """Gradients that grow with time, over both periods."""
        moving = CELL.replace('"free"', '"-3e-5*t/2e-6"').replace("*load", "*t/2e-6").replace("[loading]\nsteps = 2\n", "")
        moving = moving.replace("relative_tolerance = 1e-12\nlinear_tolerance = 1e-6\n", 'mode = "dynamics"\n')
        moving += "[dynamics]\nend_time = 4e-6\ntime_step = 5e-8\n"
        run = self.both_with_reactions(moving)
        energy = run.summary["energy"]
        self.assertGreater(energy["external_work"], 0.0)
        self.assertLess(abs(energy["balance_error"]), 1e-2 * energy["external_work"])
        self.both_with_reactions(moving, "dynamics.scheme=newmark", share=1e-6)

    def test_a_free_jump_has_no_inertia(self):
        moving = CELL.replace("*load", "").replace("[loading]\nsteps = 2\n", "[dynamics]\nend_time = 1e-6\n")
        self.assert_refused(self.command("check", moving, "solver={mode='dynamics', operator='fft'}"), "free gradient")


class Refusals(CommandLine):
    def test_what_has_no_image(self):
        crack = "crack=[{from=[0.0062, 0.004], to=[0.0062, 0.02]}]"
        printed = ["material={model='lps', youngs_modulus=70e9, poisson_ratio=0.2, density=2440}", "quadrature.form=printed"]
        for settings, words in (
            ([crack], ("solver.operator", "pre-cracks", "bonds")),
            (printed, ("printed",)),
            (["solver.preconditioner=sines"], ("sines", "block_jacobi")),
            (['set=[{name="top", where="y > 0.006"}]', 'rigid=[{set="top", displacement=[0, 0]}]'], ("rigid sets", "bonds")),
        ):  # fmt: skip
            with self.subTest(settings=settings):
                self.assert_refused(self.command("check", CELL, "solver.operator=fft", *settings), *words)


if __name__ == "__main__":
    unittest.main()
