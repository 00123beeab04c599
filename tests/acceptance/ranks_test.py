"""Runs on several MPI ranks have the results of one, and the page lists the supported keys."""

import json
import re
import unittest

import h5py
import numpy

from tests.acceptance.on_ranks import (
    BAR,
    BEAM,
    BLOCK,
    CUBE,
    PIECES,
    PLATE,
    SHORT_BAR,
    SOLVER,
    SQUARE,
    STATES,
    STORED,
    Comparison,
    OnRanks,
    linear_iterations,
    on,
    rows,
)
from tests.reference.program import PROGRAM, ROOT


class SameResults(Comparison):
    def test_a_bar(self):
        self.compare(BAR, (2, 3))

    def test_a_plate_with_a_hole(self):
        one = self.compare(PLATE, (2, 3, 4))
        self.assertEqual(len(rows(one, "history.csv")), 3)

    def test_a_perturbed_block_with_corrections_under_its_weight(self):
        self.compare(BLOCK)

    def test_pre_cracks(self):
        in_plane = PLATE + '[[crack]]\nfrom = [0, 1.02]\nto = [0.33, 1.05]\n[[crack]]\nfrom = [0.7, 0.3]\nto = [1, 0.3]\n'
        one = self.compare(in_plane, (4,), "output.count_cracks=true")
        with h5py.File(one / "results.h5") as file:
            self.assertGreater(file["steps/000002/damage"][()].max(), 0.2)
        in_space = BLOCK + "[[crack]]\nvertices = [[0, 0, 0.5], [0.4, 0, 0.5], [0.4, 0.6, 0.52], [0, 0.6, 0.52]]\n"
        one = self.compare(in_space, (2,))
        with h5py.File(one / "results.h5") as file:
            self.assertEqual(file["steps/000002/damage"][()].max(), 0.0)

    def test_a_body_thinner_than_the_horizon_and_ranks_without_a_point(self):
        self.compare(SHORT_BAR, (2, 8))

    def test_keys_of_the_list(self):
        """With other values than those of the other tests."""
        for settings in (
            ('lattice.origin="nodes"', "lattice.spacing=[0.05, 0.06]", 'material.plane="strain"', 'solver.predictor="none"',
             "loading.adaptive=false", 'solver.preconditioner="jacobi"', 'lattice.layer[1].where="x < 0.5"',
             'lattice.shape[1].name="hole"', "dimension=2"),
            ('solver.tangent="stored"', "loading.largest_step=0.5", "loading.smallest_step=1e-3", "loading.table=[0, 0.5]",
             "loading.table2=[0, 1]", 'quadrature.surface_correction="energy"',
             'load=[{set="corner", body_force=["1e6*load2", "0"]}, {set="corner", total_force=["1e4*load", "2e3"]}]'),
        ):  # fmt: skip
            with self.subTest(settings=settings):
                self.compare(PLATE, (2,), *settings)

    def test_triangles(self):
        one = self.compare(SQUARE, (4,), solver=STORED)
        self.expect_same_counts(one, 4)
        thin = 'lattice.shape=[{add="box", min=[0, 0], max=[0.4, 0.2]}]'
        self.compare(SQUARE, (2,), thin, 'quadrature.weights="bulk"', solver=STORED)
        moduli = 'material={model="cpd", youngs_modulus=2e9, poisson_ratio=0.25, influence="gaussian"}'
        self.compare(SQUARE, (2,), moduli, solver=STORED)  # its c2 is negative

    def test_tetrahedra(self):
        one = self.compare(CUBE, (3,), solver=STORED)
        self.expect_same_counts(one, 3)

    def test_states(self):
        self.compare(STATES, (4,), solver=STORED)
        block = BLOCK.replace('model = "bond"', 'model = "lps"\npoisson_ratio = 0.3').replace(
            'surface_correction = "volume"', 'form = "energy"')
        self.compare(block, (2,), 'material.influence="gaussian"', solver=STORED)

    def expect_same_counts(self, one, ranks):
        expected, found = (json.loads((folder / "summary.json").read_text()) for folder in (one, self.folder / f"on_{ranks}"))
        self.assertGreater(expected["triangles"], 0)
        for kind in ("bonds", "triangles", "tetrahedra"):
            self.assertEqual(expected.get(kind), found.get(kind), kind)

    def test_probes_of_sets(self):
        probes = """
            [[probe]]
            name = "moved"
            set = "corner"
            [[probe]]
            name = "pulled"
            set = "top"
            field = "force"
            component = "y"
            [[probe]]
            name = "least"
            set = "corner"
            field = "stretch"
            statistic = "min"
            [[probe]]
            name = "most"
            set = "corner"
            field = "energy_density"
            statistic = "max"
            [[probe]]
            name = "opened"
            set = "top"
            field = "opening"
            other = "corner"
            [[probe]]
            name = "off"
            set = "corner"
            statistic = "rms_error"
            expected = ["1e-3*load", "0.03*load*y"]
            [[probe]]
            name = "farthest"
            set = "corner"
            statistic = "max_error"
            expected = ["1e-3*load", "0.03*load*y"]
        """
        one = self.compare(PLATE + probes, (2,))
        last = rows(one, "history.csv")[-1]
        names = [name for name in last if "moved" in name or "opened" in name]
        self.assertEqual(len(names), 4)
        for name in (*names, "pulled", "least", "most", "off", "farthest"):
            found = [key for key in last if key.startswith(name) or key.endswith(":" + name)]
            self.assertTrue(found, (name, list(last)))
            self.assertNotEqual(float(last[found[0]]), 0.0)

    def test_probes_at_places_and_along_lines_and_of_stress(self):
        probes = """
            [[probe]]
            name = "place"
            at = [0.77, 0.3]
            [[probe]]
            name = "pulled"
            at = [0.02, 1.4]
            field = "stress"
            component = "yy"
            [[probe]]
            name = "row"
            from = [0.1, 1.2]
            to = [0.9, 1.0]
            field = "strain"
            component = "yy"
            [[probe]]
            name = "upright"
            from = [0.5, 1.0]
            to = [0.5, 1.4]
            [[probe]]
            name = "hardest"
            set = "corner"
            field = "von_mises"
            statistic = "max"
            [[probe]]
            name = "ratio"
            set = "corner"
            field = "poisson_ratio"
            axis = "y"
            [[probe]]
            name = "divergence"
            set = "top"
            field = "divergence"
            [[probe]]
            name = "crack"
            set = "corner"
            field = "crack_length"
            axis = "x"
            [[output]]
        """
        text = PLATE + probes.replace("[[output]]", "[output]\nstress = true")
        one = self.compare(text, (4,))
        with h5py.File(one / "results.h5") as file:
            self.assertGreater(numpy.abs(file["steps/000002/cauchy_stress"]).max(), 1e6)
            self.assertEqual(len(file["lines/row/point"]), 2 * len(set(file["lines/row/point"])))
            self.assertGreater(len(file["lines/row/point"]), 20)
        last = rows(one, "history.csv")[-1]
        for name in ("place_y", "pulled", "hardest", "ratio", "divergence"):
            self.assertNotEqual(float(last[name]), 0.0, name)

    def test_stress_in_three_dimensions_and_of_a_bar_shorter_than_the_horizon(self):
        stress = "[output]\nstress = true\n"
        probe = '[[probe]]\nname = "ratio"\nset = "foot"\nfield = "poisson_ratio"\naxis = "z"\n'
        self.compare(BLOCK + stress + probe, (3,))
        self.compare(SHORT_BAR + stress, (8,))

    def test_steps_that_are_cut(self):
        few = ("solver.max_iterations=3", "loading.steps=1")
        one = self.compare(PLATE.replace("0.05*load", "0.3*load"), (2,), *few)
        self.assertIn("cut", [row["action"] for row in rows(one, "decisions.csv")])

    def test_fields_of_some_steps_only(self):
        text = PLATE.replace("steps = 2", "steps = 3") + "[output]\nevery = 2\n"
        one = self.compare(text, (2,))
        with h5py.File(one / "results.h5") as file:
            self.assertEqual(list(file["steps"]), ["000002", "000003"])

    def test_operators(self):
        for operator in ("auto", "bonds"):
            self.compare(PLATE, (2,), f'solver.operator="{operator}"')

    def test_automatic_choices(self):
        one = self.run_on(1, PLATE)
        several = self.run_on(2, PLATE, "solver.relative_tolerance=1e-12")
        self.assertIn("rigid pieces", self.ended.output)
        self.assertIn("factorisations and sines are for one rank", self.ended.output.replace("\n    ", " "))
        self.expect_same_displacements(one, several)

    def test_rigid_pieces(self):
        """Of a body whose pieces stand on several ranks, and of one that is thinner than the horizon."""
        for text, ranks in ((BLOCK, (3,)), (BEAM, (2, 4))):
            self.compare(text, ranks, 'solver.preconditioner="rigid_pieces"')

    def test_rigid_pieces_of_triangles_tetrahedra_and_states(self):
        for text, ranks in ((SQUARE, (8,)), (CUBE, (3,)), (STATES, (2,))):
            found = linear_iterations(self.compare(text, ranks, solver=PIECES))
            self.assertLess(found, 0.7 * linear_iterations(self.run_on(1, text + STORED)))

    def test_other_linear_solvers(self):
        self.expect_same_with(PLATE + SOLVER, 3, *(
            (f'solver.linear="{solver}"', f'solver.preconditioner="{preconditioner}"', 'solver.tangent="auto"')
            for solver, preconditioner in (
                ("pcg", "surrogate"), ("pcg", "multigrid"), ("pcg", "riluk"), ("pcg", "chebyshev"),
                ("minres", "rigid_pieces"), ("gmres", "surrogate"),
            )))  # fmt: skip
        self.expect_same_with(SQUARE + STORED, 2, *((f'solver.preconditioner="{kind}"',) for kind in ("surrogate", "multigrid")))

    def expect_same_with(self, text, ranks, *settings):
        """Results of one rank, with each of these settings on several."""
        case, names = self.case(text), [f"with_{k}" for k in range(len(settings))]
        commands = [self.words_of_run(case, *of, name=name, words=on(ranks)) for of, name in zip(settings, names)]
        runs = self.side_by_side([self.words_of_run(case, name="on_1"), *commands])
        for run, name, of in zip(runs, ["on_1", *names], [(), *settings]):
            with self.subTest(settings=of):
                self.assert_completed(run)
                self.expect_same(self.folder / "on_1", self.folder / name)

    def expect_same_displacements(self, one, several):
        with h5py.File(one / "results.h5") as expected, h5py.File(several / "results.h5") as found:
            u = expected["steps/000002/displacement"][()]
            difference = numpy.abs(u - found["steps/000002/displacement"][()]).max()
            self.assertLess(difference, 1e-9 * numpy.abs(u).max())

    def test_threads_of_ranks(self):
        one = self.run_on(1, PLATE + SOLVER)
        self.expect_same(one, self.run_on(2, PLATE + SOLVER, threads=2))

    def test_ranks_of_mpirun(self):
        one = self.run_on(1, PLATE + SOLVER)
        output = self.folder / "of_mpirun"
        words = [PROGRAM, "run", self.folder / "case.toml", "--output", output]
        run = self.execute(["mpirun", "--oversubscribe", "-np", 3, *words])
        self.assert_completed(run)
        self.expect_same(one, output)
        self.assertEqual(run.output.count("completed in"), 1)


# Actions at load 0: a weight, a temperature, a support that is displaced from the start.
LASTING = {
    "weight": ('material={model="bond", youngs_modulus=1e9, density=1000}', 'load=[{gravity=["2e3", "-3e4*(1 + x)"]}]'),
    "temperature": ('material={model="bond", youngs_modulus=1e9, thermal_expansion=1e-5}', 'temperature={change="300*y + 100*load"}'),
    "support": ('support=[{set="bottom", displacement=[0, "1e-3*(1 + x)"]}, {set="top", displacement=["free", "0.01*load"]}]',),
}  # fmt: skip


class LoadZero(Comparison):
    """Step 0 is a row of each run, and its fields are written if something acts at load 0."""

    def compare_from_zero(self, name, *settings, text=PLATE, ranks=(2,)):
        one = self.compare(text, ranks, *LASTING[name], *settings)
        history = rows(one, "history.csv")
        self.assertEqual([row["step"] for row in history], ["0", "1", "2"])
        self.assertGreater(float(history[0]["stored_energy"]), 0.0)
        for count in ranks:
            with h5py.File(self.folder / f"on_{count}/results.h5") as file:
                self.assertGreater(numpy.abs(file["steps/000000/displacement"][()]).max(), 1e-5)
                self.assertEqual(rows(one, "decisions.csv")[0]["action"], rows(self.folder / f"on_{count}", "decisions.csv")[0]["action"])
        return one

    def test_by_newtons_method(self):
        for name in LASTING:
            self.compare_from_zero(name, 'solver.mode="newton"')

    def test_by_relaxation(self):
        for name in LASTING:
            self.compare_from_zero(name, 'solver.mode="relaxation"', "lattice.spacing=0.1")

    def test_by_both(self):
        for name in LASTING:
            self.compare_from_zero(name, 'solver.mode="adaptive"')

    def test_where_nothing_acts(self):
        one = self.compare(PLATE, (2,))
        self.assertEqual(float(rows(one, "history.csv")[0]["stored_energy"]), 0.0)
        with h5py.File(self.folder / "on_2/results.h5") as file:
            self.assertNotIn("000000", file["steps"])

    def test_damage_at_load_zero(self):
        """The support softens bonds before the first step."""
        law = 'damage={law="tanh", onset=0.01, critical=0.5, rate=3}'
        moved = 'support=[{set="bottom", displacement=[0, 0]}, {set="top", displacement=[0, "2e-2 + 1e-4*load"]}]'
        material = f'material={{model="bond", youngs_modulus=1e9, {law}}}'
        one = self.compare(PLATE, (2,), material, 'solver.mode="newton"', moved)
        self.assertGreater(float(rows(one, "history.csv")[0]["dissipated_energy"]), 0.0)


class CutBonds(Comparison):
    """A subtracted shape that bonds must not cross."""

    def test_a_slit_that_is_narrower_than_the_horizon(self):
        slit = '{{subtract="box", min=[-0.1, 1.09], max=[0.4, 1.16], cuts_bonds={}}}'
        box = '{add="box", min=[0, 0], max=[1, 1.5]}'
        hole = '{subtract="disk", centre=[0.5, 0.7], radius=0.2, cuts_bonds=true}'
        bonds = {}
        for word in ("true", "false"):
            self.compare(PLATE, (2,), f"lattice.shape=[{box}, {hole}, {slit.format(word)}]")
            found = {json.loads((self.folder / name / "summary.json").read_text())["bonds"] for name in ("on_1", "on_2")}
            self.assertEqual(len(found), 1)
            bonds[word] = found.pop()
        self.assertLess(bonds["true"], bonds["false"])

    def test_in_space(self):
        solid = '{add="box", min=[0, 0, 0], max=[0.7, 0.6, 0.9]}, {subtract="sphere", centre=[0.35, 0.3, 0.6], radius=0.16, cuts_bonds=true}'
        self.compare(BLOCK, (2,), f"lattice.shape=[{solid}]")


class Page(OnRanks):
    """docs/cluster.md"""

    def test_counts_of_messages(self):
        lines = (ROOT / "docs/cluster.md").read_text().splitlines()
        first = next(k for k, line in enumerate(lines) if "cases/plate_with_hole/elastic.toml --ranks N` |" in line)
        table = [[cell.strip() for cell in lines[k].strip("|").split("|")] for k in range(first, first + 6)]
        case = (ROOT / "cases/plate_with_hole/elastic.toml").read_text()
        runs = self.ended_on_each([int(ranks) for ranks in table[0][1:]], case, "loading.steps=1")
        self.assertEqual(len(runs), 4)
        for column, (run, _) in enumerate(runs.values(), 1):
            points, ghosts, messages, size = (row[column] for row in table[2:])
            self.assertIn(f"at most {points} points on a rank, {ghosts} ghosts", run.output)
            self.assertIn(f"{messages} messages, {size} bytes each", run.output.replace("\n    ", " "))


if __name__ == "__main__":
    unittest.main()
