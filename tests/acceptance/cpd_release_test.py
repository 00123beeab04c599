"""Damage of cpd by what a bond would set free, from the command line: compared with the reference, which knows the energy
alone; with bonds; and what it refuses."""

import json

import h5py
import numpy

from tests.acceptance.folder import Folder
from tests.acceptance.motions import columns
from tests.reference.body import Body
from tests.reference.case import Case
from tests.reference.mechanics import Mechanics
from tests.reference.results import Results

SPACING, THICKNESS = 0.1, 0.5
PLATE = {
    "dimension": 2,
    "lattice": {"spacing": SPACING, "horizon_ratio": 3.015, "thickness": THICKNESS,
                "shape": [{"add": "box", "min": [0, 0], "max": [1.6, 1.2]}],
                "layer": [{"name": name, "side": side, "thickness": 2} for name, side in (("low", "y-"), ("high", "y+"))]},
    "support": [{"set": "low", "displacement": [0, 0]}, {"set": "high", "displacement": ["free", "0.012*load"]}],
    "loading": {"steps": 6}, "solver": {"mode": "newton"},
}  # fmt: skip
BLOCK = {
    "dimension": 3,
    "lattice": {"spacing": SPACING, "horizon_ratio": 2.015,
                "shape": [{"add": "box", "min": [0, 0, 0], "max": [0.5, 0.3, 0.8]}],
                "layer": [{"name": name, "side": side, "thickness": 2} for name, side in (("low", "z-"), ("high", "z+"))]},
    "support": [{"set": "low", "displacement": [0, 0, 0]}, {"set": "high", "displacement": ["free", "free", "0.012*load"]}],
    "loading": {"steps": 6}, "solver": {"mode": "newton"},
}  # fmt: skip
CRACK = [{"from": [0, 0.6], "to": [0.4, 0.6]}]
NO_FAIL = {"no_fail": ["low", "high"], "drive": "release"}
BRITTLE = {"law": "critical_stretch", "critical": 0.01} | NO_FAIL
SOFT = {"law": "linear", "onset": 0.005, "critical": 0.01} | NO_FAIL
REGION = {"set": [{"name": "right", "where": "x > 0.8"}]}


class CpdRelease(Folder):
    threads = 2

    def constants(self, nu, dimension=2):
        """C1, C2 and C3 of E = 3 kPa."""
        lattice = BLOCK["lattice"] if dimension == 3 else PLATE["lattice"]
        words = ["--thickness", THICKNESS] if dimension == 2 else []
        told = self.assert_completed(self.peristat("calibrate", "--dimension", dimension, "--spacing", SPACING, "--horizon-ratio",
                                                   lattice["horizon_ratio"], *words, "--youngs-modulus", "3e3",
                                                   "--poisson-ratio", nu)).json()["lattice"]  # fmt: skip
        return {key: told[key] for key in ("c1", "c2", "c3")[:dimension]}

    def body(self, nu, damage, crack=True, **more):
        return PLATE | {"material": {"model": "cpd"} | self.constants(nu) | {"damage": damage}} | ({"crack": CRACK} if crack else {}) | more

    def judge(self, tables):
        """Every state is an equilibrium, no bond is driven beyond what it bears, and what is dissipated is what the bonds
        have taken. Returns the rows."""
        results = Results(self.run_case(tables, name="torn"))
        rows = {row["step"]: row for row in results.table("history")}
        mechanics = Mechanics(Body(Case(tables), results.reference, results.volume, sets=results.sets))
        mechanics.spare(results.sets)
        body, history = mechanics.body, mechanics.no_history()
        free, scale = ~(results.sets["low"] | results.sets["high"]), 0.0
        for step in results.steps:
            if step.history is not None:
                names = ("first_point", "second_point", "largest_stretch")
                first, second, stretch = (step.history[name] for name in names)
                for i, j, s in zip(first.tolist(), second.tolist(), stretch.tolist()):
                    history[body.bond_number[i * len(body.volume) + j]] = max(s, 0)
            row, u = rows[step.number], step.displacement
            force = mechanics.gradient(u, history, held=True)
            scale = max(scale, numpy.linalg.norm(force))  # torn bodies have little force left
            self.assertLess(numpy.linalg.norm(force[free]), 1e-9 * scale)
            self.assertAlmostEqual(row["stored_energy"], mechanics.energy(u, history, held=True), delta=1e-10 * (row["stored_energy"] + 1e-9))
            driving = mechanics.equivalent_stretches(u, history)[mechanics.fails]
            borne = numpy.maximum(history, mechanics.law.onset)[mechanics.fails]
            alive = ~mechanics.is_broken(history)[mechanics.fails]
            self.assertLess((driving / borne)[alive].max(), 1 + 1e-8)
            self.assertAlmostEqual(row["dissipated_energy"], mechanics.dissipated(history), delta=1e-9 * row["dissipated_energy"])
        return list(rows.values())

    def judge_ledger(self, rows, work=0.02):
        column = {name: numpy.array([row[name] for row in rows]) for name in rows[0] if name.endswith(("energy", "work", "error"))}
        self.assertTrue((numpy.diff(column["dissipated_energy"]) >= 0).all())
        self.assertTrue((numpy.diff(column["drained_energy"]) >= -1e-12 * column["external_work"].max()).all())
        self.assertGreaterEqual(column["stored_energy"].min(), 0)
        self.assertLess(abs(column["balance_error"]).max(), work * column["external_work"].max())

    # ---- every state ------------------------------------------------------------------------------

    def test_every_state_of_a_torn_plate_is_an_equilibrium(self):
        for nu in (0.0, 0.2, 0.45):
            for damage in (BRITTLE, SOFT):
                with self.subTest(nu=nu, law=damage["law"]):
                    mode = "adaptive" if nu == 0.2 and damage is BRITTLE else "newton"
                    rows = self.judge(self.body(nu, damage, solver={"mode": mode}))
                    self.assertGreater(rows[-1]["broken_bonds"], 20)
                    self.judge_ledger(rows)

    def test_every_state_of_a_block_is_an_equilibrium(self):
        for nu, damage in ((0.05, SOFT), (0.4, BRITTLE)):
            with self.subTest(nu=nu):
                tables = BLOCK | {"material": {"model": "cpd"} | self.constants(nu, 3) | {"damage": damage}}
                rows = self.judge(tables)
                self.assertGreater(rows[-1]["dissipated_energy"], 0)
                self.judge_ledger(rows)

    def test_every_state_of_two_materials_is_an_equilibrium(self):
        soft = self.constants(0.1)
        stiff = {key: 3 * value for key, value in self.constants(0.4).items()}
        for rule in ("arithmetic", "weaker"):
            tables = PLATE | REGION | {
                "material": {"model": "cpd"} | soft | {"damage": SOFT}, "crack": CRACK,
                "region": [{"set": "right", "material": stiff | {"damage": SOFT | {"critical": 0.008, "onset": 0.004}}}],
                "interface": [{"rule": rule}]}  # fmt: skip
            rows = self.judge(tables)
            self.assertGreater(rows[-1]["broken_bonds"], 20)
            self.judge_ledger(rows)

    def test_bodies_expand_freely(self):
        """A free expansion far beyond the onset damages nothing."""
        tables = self.body(0.2, BRITTLE, crack=False) | {"temperature": {"change": "100*load"}, "loading": {"steps": 1}}
        tables["material"]["thermal_expansion"] = 1e-3
        tables["set"] = [{"name": "corner", "where": "x < 0.1 && y < -0.1"}, {"name": "other", "where": "x > 1.5 && y < -0.1"}]
        tables["support"] = [{"set": "corner", "displacement": [0, 0]}, {"set": "other", "displacement": ["free", 0]}]
        results = self.results(tables)
        corner = results.reference[results.sets["corner"]][0]
        numpy.testing.assert_allclose(results.steps[-1].displacement, 0.1 * (results.reference - corner), atol=1e-9)
        self.assertEqual(results.summary["broken_bonds"], 0)

    # ---- energy of a crack ------------------------------------------------------------------------

    def data_sheet(self, nu, **more):
        damage = {"law": "critical_stretch", "fracture_energy": 0.02, "no_fail": ["low", "high"]} | more
        material = {"model": "cpd", "youngs_modulus": 3e3, "poisson_ratio": nu, "damage": damage}
        return PLATE | {"material": material, "crack": CRACK}

    def test_fracture_energy_is_what_a_torn_plate_takes(self):
        for nu in (0.0, 0.2, 0.45):
            rows = columns(self.run_case(self.data_sheet(nu), name="torn"))
            self.assertLess(abs(rows["reaction_y:high"][-1]), 0.1 * abs(rows["reaction_y:high"]).max())
            taken = rows["dissipated_energy"][-1] / (0.02 * 1.2 * THICKNESS)
            self.assertGreater(taken, 0.85, nu)
            self.assertLess(taken, 1.35, nu)

    def begun(self, tables, name):
        """History and resolved case of the first steps of a run."""
        folder = self.run_case(tables, "solver.mode=adaptive", name=name, words=("--stop-after", 5), code=(0, 130))
        with h5py.File(folder / "results.h5") as file:
            resolved = file["case/as_resolved"].asstr()[()]
        rows = columns(folder)
        return [(name, rows[name].tolist()) for name in rows if name != "seconds"], resolved

    def test_release_is_the_default_with_a_fracture_energy(self):
        given, default = (self.begun(self.data_sheet(0.4, **more), name) for name, more in (("given", {"drive": "release"}), ("default", {})))
        stretch = self.begun(self.data_sheet(0.4, drive="stretch"), "stretch")
        self.assertEqual(given[0], default[0])
        self.assertNotEqual(given[0], stretch[0])
        self.assertIn('drive = "release"', default[1])

    def test_stretch_is_the_default_with_stretches(self):
        damage = {key: value for key, value in BRITTLE.items() if key != "drive"}
        given, default = (self.begun(self.body(0.4, damage | more), name) for name, more in (("given", {"drive": "stretch"}), ("default", {})))
        self.assertEqual(given[0], default[0])
        self.assertIn('drive = "stretch"', default[1])

    def test_a_fracture_energy_may_have_any_horizon(self):
        for dimension, ratio in ((2, "13"), (3, "4")):
            ended = self.peristat("calibrate", "--dimension", dimension, "--spacing", "0.02", "--horizon-ratio", ratio, "--youngs-modulus", "3e3",
                                  "--poisson-ratio", "0.1", "--law", "tanh", "--rate", "40", "--fracture-energy", "0.02")  # fmt: skip
            told = self.assert_completed(ended).json()["damage"]["fracture_energy"]
            self.assertAlmostEqual(told["mean"] / 0.02, 1, delta=1e-12)
            self.assertGreater(told["most"], told["least"])

    def test_calibrated_stretches_take_the_bonds_share_alone(self):
        words = ["calibrate", "--dimension", "2", "--spacing", SPACING, "--horizon-ratio", "3.015", "--thickness", THICKNESS,
                 "--youngs-modulus", "3e3", "--law", "critical_stretch", "--fracture-energy", "0.02"]  # fmt: skip
        told = {nu: self.assert_completed(self.peristat(*words, "--poisson-ratio", nu)).json() for nu in (0.0, 0.2, 0.45)}
        # G_c = C1 A s0^2 / 2 with the A of the lattice, whatever C2 is.
        scaled = [one["lattice"]["c1"] * one["damage"]["critical"] ** 2 for one in told.values()]
        numpy.testing.assert_allclose(scaled, scaled[0], rtol=1e-12)
        for one in told.values():
            self.assertAlmostEqual(one["damage"]["fracture_energy"]["mean"] / 0.02, 1, delta=1e-12)
        by_stretch = self.assert_completed(self.peristat(*words, "--poisson-ratio", "0.45", "--drive", "stretch")).json()
        self.assertLess(by_stretch["damage"]["critical"], 0.99 * told[0.45]["damage"]["critical"])

    # ---- from event to event ----------------------------------------------------------------------

    def test_a_path_goes_from_drop_to_drop(self):
        """Every row is an equilibrium in which no bond is driven beyond what it bears; the peak is that of fine steps."""
        for nu in (0.2, 0.45):
            with self.subTest(nu):
                tables = self.body(nu, BRITTLE)
                rows = self.judge(tables | {"solver": {"mode": "path"}})
                self.judge_ledger(rows, work=1e-11)
                self.assertGreater(rows[-1]["broken_bonds"], 20)
                work = max(row["external_work"] for row in rows)
                self.assertLess(max(abs(row["numerical_work"]) for row in rows), 2e-3 * work)
                if nu < 0.45:
                    continue  # the steps take a minute
                steps = columns(self.run_case(tables | {"loading": {"steps": 60}}, name="steps"))
                peak = max(row["reaction_y:high"] for row in rows)
                self.assertAlmostEqual(peak / steps["reaction_y:high"].max(), 1, delta=0.02)
                taken = rows[-1]["dissipated_energy"]
                self.assertGreater(steps["dissipated_energy"][-1] / taken, 0.98)
                self.assertLess(steps["dissipated_energy"][-1] / taken, 1.25)

    def test_a_path_takes_laws_that_soften_and_blocks(self):
        block = BLOCK | {"material": {"model": "cpd"} | self.constants(0.05, 3) | {"damage": BRITTLE}}
        for tables in (self.body(0.2, SOFT), block):
            rows = columns(self.run_case(tables, "solver.mode=path", "loading.teeth=2"))
            self.assertGreater(rows["dissipated_energy"][-1], 0)
            work = rows["external_work"].max()
            for name in ("dissipated_energy", "drained_energy"):
                self.assertGreaterEqual(numpy.diff(rows[name]).min(), -1e-12 * work)
            self.assertLess(abs(rows["balance_error"]).max(), 1e-11 * work)
            self.assertLess(abs(rows["numerical_work"]).max(), 5e-3 * work)

    def test_an_interrupted_path_goes_on_to_the_same_bits(self):
        tables = self.body(0.2, BRITTLE) | {"solver": {"mode": "path"}}
        whole = columns(self.run_case(tables, name="whole"))
        self.run_case(tables, name="split", words=("--stop-after", 7), code=130)
        self.resume("split")
        split = columns(self.folder / "split")
        for name in (name for name in whole if name != "seconds"):
            numpy.testing.assert_array_equal(whole[name], split[name], name)

    # ---- going on, and refusals -------------------------------------------------------------------

    def test_an_interrupted_tear_goes_on_to_the_same_bits(self):
        tables = self.body(0.2, SOFT)
        whole = self.run_case(tables, name="whole")
        self.run_case(tables, name="split", words=("--stop-after", 3), code=130)
        split = self.resume("split")
        self.assertEqual(split.code, 0)
        names = [name for name in columns(whole) if name != "seconds"]
        for name in names:
            numpy.testing.assert_array_equal(columns(whole)[name], columns(self.folder / "split")[name], name)

    def test_a_run_does_not_go_on_with_another_drive(self):
        self.run_case(self.body(0.4, BRITTLE), name="split", words=("--stop-after", 3), code=130)
        ended = self.peristat("resume", self.folder / "split", "--set", 'material.damage.drive="stretch"')
        self.assert_refused(ended, "material.damage.drive")

    def test_what_it_does_not_do_is_refused(self):
        tables = self.body(0.2, BRITTLE)
        for change, words in (
            ('material.damage={law="critical_stretch", critical=0.01}', ("material.damage.law", "damage by stretch", 'drive = "release"')),
            ('material={model="cpd", youngs_modulus=1e3, poisson_ratio=-0.1, damage={law="linear", fracture_energy=0.02}}',
             ("material.poisson_ratio", "at least 0")),
            ('material={youngs_modulus=1e3, damage={law="critical_stretch", critical=0.01, drive="release"}}',
             ("material.damage.drive", 'is for models "cpd", "state" and "lps" as an energy')),
            ('material={model="lps", youngs_modulus=1e3, poisson_ratio=0.2, damage={law="critical_stretch", critical=0.01, drive="stretch"}}',
             ("material.damage.drive", 'is for models "cpd", "state" and "lps" as an energy')),
            ('material={model="state", youngs_modulus=1e3, poisson_ratio=0.2, damage={law="critical_stretch", critical=0.01, drive="stretch"}}',
             ("material.damage.drive", 'must be "release"')),
            ('material={model="cpd", youngs_modulus=1e3, poisson_ratio=0.2, damage={drive="release"}}', ("material.damage.drive", "needs a law")),
            ('region=[{set="low", material={c1=1.0, c2=0.1, damage={law="critical_stretch", critical=0.01, drive="stretch"}}}]',
             ("region[0].material.damage.drive", "the same for all materials")),
        ):  # fmt: skip
            with self.subTest(change):
                self.refusal(tables, change)
                self.assert_refused(self.ended, *words)

    def test_planes_that_give_an_interaction_a_bond_twice_are_refused(self):
        block = BLOCK | {"material": {"model": "cpd"} | self.constants(0.05, 3) | {"damage": BRITTLE}}
        strip = self.body(0.2, BRITTLE, crack=False) | {"symmetry": [{"axis": "y"}]}
        strip |= {"period": [{"axis": "x", "from": 0, "to": 0.1, "gradient": ["free", 0]}]}
        strip["lattice"] = strip["lattice"] | {"shape": [{"add": "box", "min": [0, 0], "max": [0.1, 1.2]}], "layer": PLATE["lattice"]["layer"][1:]}
        strip["support"], strip["material"]["damage"] = PLATE["support"][1:], BRITTLE | {"no_fail": ["high"]}
        for tables, planes in ((block, ["x", "y"]), (strip, ["y"])):
            refusal = self.refusal(tables | {"symmetry": [{"axis": axis} for axis in planes]})
            self.assertIn("material.damage.drive", refusal)
            self.assertIn("plane", refusal)
        self.assert_completed(self.command("check", block | {"symmetry": [{"axis": "x"}]}))

    def test_the_record_names_bonds_that_are_driven(self):
        """A step far beyond the onset: all that is driven breaks in one avalanche, and no more energy than there is."""
        tables = self.body(0.2, BRITTLE) | {"loading": {"steps": 1}}
        rows = self.judge(tables)
        self.judge_ledger(rows, work=0.05)
        summary = json.loads((self.folder / "torn/summary.json").read_text())
        self.assertEqual(summary["broken_bonds"], rows[-1]["broken_bonds"])
