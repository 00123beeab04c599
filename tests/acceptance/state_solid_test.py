"""Model state, the state-based solid at finite strain, from the command line: compared with the reference of
tests/reference/states.py, elastic and through fracture, and with the bond model where both are the same."""

import csv
import json

import numpy

from tests.acceptance.folder import Folder
from tests.acceptance.motions import columns
from tests.acceptance.states_test import CRACK, PLATE, PULL, REGION, cut, solid
from tests.reference.case import evaluate
from tests.reference.results import Results
from tests.reference.stretched_bar import nominal_stress

SOLID = PLATE.replace('[quadrature]\nform = "energy"\n', "").replace('"lps"', '"state"')
DAMAGE = '[material.damage]\nlaw = "critical_stretch"\ncritical = 0.01\nno_fail = ["low", "high"]\n'
SOFT = DAMAGE.replace("critical_stretch", "linear") + "onset = 0.005\n"
HELD = "".join(f'[[support]]\nset = "{name}"\ndisplacement = [0, 0]\n' for name in ("low", "high"))


class StateSolid(Folder):
    def test_energy_forces_and_tangent_are_those_of_the_reference(self):
        deformation = ["1.2*x + 0.3*y + 0.05*sin(3*x + y)", "0.9*y - 0.1*x + 0.1*x*y"]
        cases = {"stress": SOLID, "cracked": SOLID + CRACK, "regions": SOLID + REGION,
                 "strain": SOLID + 'plane = "strain"\n', "nearly_incompressible": cut(SOLID, poisson_ratio=0.49) + 'plane = "strain"\n',
                 "auxetic": cut(SOLID, poisson_ratio=-0.5), "gaussian": SOLID + 'influence = "gaussian"\n',
                 "linear_volumes": SOLID.replace("[material]", '[quadrature]\nvolume_correction = "linear"\n[material]')}  # fmt: skip
        for name, text in cases.items():
            with self.subTest(name):
                small = cut(text, max="[1.0, 0.8]") if "crack" not in name and "regions" not in name else text
                ended = self.command("check-tangent", small, words=("--deformation", "; ".join(deformation)))
                told = self.assert_completed(ended).json()
                results = self.results(small + HELD, name="points")
                own = solid(results, small)
                u = numpy.stack([evaluate(e, results.reference) for e in deformation], 1) - results.reference
                expected = {"energy": own.energies(u).sum(), "residual_norm": numpy.linalg.norm(own.forces(u)),
                            "tangent_frobenius_norm": numpy.linalg.norm(own.matrix(u))}  # fmt: skip
                for key, value in expected.items():
                    self.assertAlmostEqual(told[key] / value, 1, delta=1e-11, msg=key)
                self.assertLess(max(told["tangent_error"], told["residual_error"]), 1e-9)
                self.assertLess(max(told["force_sum"], told["moment_sum"]), 1e-12)

    def judge(self, folder, text, law):
        """Every state is an equilibrium of the reference, no bond is driven beyond what it bears, and what is dissipated
        is what the bonds have taken. Returns the last row."""
        results = Results(folder)
        own, rows = solid(results, text), {row["step"]: row for row in results.table("history")}
        free = numpy.ones_like(results.reference, bool)
        free[results.sets["low"]] = False
        free[results.sets["high"], 1] = False
        spared = results.sets["low"] | results.sets["high"]
        breakable = own.left & ~(spared[own.first] | spared[own.second])
        largest = numpy.zeros(len(own.first))
        for step in results.steps:
            if step.history is not None:
                names = ("first_point", "second_point", "largest_stretch")
                for first, second, stretch in zip(*(step.history[name].tolist() for name in names)):
                    largest[own.number[first, second]] = max(stretch, 0)
            own.integrity = law["integrity"](largest)
            row, u = rows[step.number], step.displacement
            force = own.forces(u)
            self.assertLess(numpy.linalg.norm(force[free]), 1e-8 * max(numpy.linalg.norm(force), 1e-3))
            self.assertAlmostEqual(row["stored_energy"], own.energies(u).sum(), delta=1e-10 * (row["stored_energy"] + 1e-9))
            driving = own.equivalent_stretches(u, law["drop"])[breakable]
            borne = numpy.maximum(largest[breakable], law["onset"])
            alive = largest[breakable] < law["critical"]
            self.assertLess((driving / borne)[alive].max(), 1 + 1e-8)
            taken = (own.taken(1.0) * law["work"](largest))[breakable].sum()
            self.assertAlmostEqual(row["dissipated_energy"], taken, delta=1e-9 * taken)
        return row

    BRITTLE = {"onset": 0.01, "critical": 0.01, "drop": 1.0, "integrity": lambda k: (k < 0.01).astype(float),
               "work": lambda k: 0.5e-4 * (k >= 0.01)}  # fmt: skip

    @staticmethod
    def force(s):
        return numpy.where(s < 0.005, s, numpy.maximum(0.01 - s, 0))

    @staticmethod
    def softened(k):
        k = numpy.minimum(k, 0.01)
        work = numpy.where(k < 0.005, k**2 / 2, 0.5 * 0.005 * 0.01 - (0.01 - k) ** 2 / 2)
        return work - StateSolid.force(k) * k / 2

    def test_every_state_of_a_torn_plate_is_an_equilibrium(self):
        softening = {"onset": 0.005, "critical": 0.01, "drop": 0.0, "work": self.softened,
                     "integrity": lambda k: numpy.where(k > 0.005, self.force(k) / numpy.maximum(k, 1e-9), 1.0)}  # fmt: skip
        for nu in (0.05, 0.45):
            for damage, law in ((DAMAGE, self.BRITTLE), (SOFT, softening)):
                with self.subTest(nu=nu, law=damage.split('"')[1]):
                    text = cut(SOLID, poisson_ratio=nu) + damage + CRACK + PULL
                    folder = self.run_case(text, "solver.mode=adaptive", name="torn")
                    last = self.judge(folder, cut(SOLID, poisson_ratio=nu) + CRACK, law)
                    self.assertGreater(last["broken_bonds"], 20)
                    rows = columns(folder)
                    self.assertTrue((numpy.diff(rows["dissipated_energy"]) >= 0).all())
                    self.assertGreaterEqual(rows["drained_energy"].min(), 0)
                    self.assertLess(abs(rows["balance_error"]).max(), 0.02 * rows["external_work"].max())
                    total = rows["stored_energy"] + rows["dissipated_energy"] + rows["drained_energy"] + rows["balance_error"]
                    numpy.testing.assert_allclose(total, rows["external_work"] + rows["numerical_work"], rtol=1e-9, atol=1e-12)

    def test_how_the_tangent_is_held_changes_no_result(self):
        """Stored for a factor, stored for conjugate gradients, or not stored at all."""
        ways = {"stored, CHOLMOD": ("solver.linear=cholesky",),
                "stored": ("solver.linear=pcg", "solver.tangent=stored"),
                "matrix-free": ("solver.linear=pcg",)}  # fmt: skip
        for nu in (0.05, 0.45):
            text = cut(SOLID, poisson_ratio=nu) + DAMAGE + CRACK + PULL
            found = []
            for way, changes in ways.items():
                folder = self.run_case(text, "solver.mode=adaptive", *changes, name="held")
                if way == "matrix-free":
                    self.assertIn("tangent matrix-free", self.ended.output)
                elif way == "stored":
                    self.assertNotIn("tangent matrix-free", self.ended.output)
                found.append((columns(folder), Results(folder).steps[-1].displacement))
            for rows, displacement in found[1:]:
                self.assertGreater(rows["broken_bonds"][-1], 20)
                numpy.testing.assert_array_equal(rows["broken_bonds"], found[0][0]["broken_bonds"])
                numpy.testing.assert_allclose(displacement, found[0][1], rtol=0, atol=1e-9 * abs(displacement).max())

    def test_every_state_of_the_linear_solid_is_one_by_release(self):
        """Model lps as an energy: the same rules with linear stretches, also for laws that soften."""
        softening = {"onset": 0.005, "critical": 0.01, "drop": 0.0, "work": self.softened,
                     "integrity": lambda k: numpy.where(k > 0.005, self.force(k) / numpy.maximum(k, 1e-9), 1.0)}  # fmt: skip
        for nu, damage, law in ((0.05, DAMAGE, self.BRITTLE), (0.45, DAMAGE, self.BRITTLE), (0.2, SOFT, softening)):
            with self.subTest(nu=nu, law=damage.split('"')[1]):
                text = cut(PLATE, poisson_ratio=nu) + damage + 'drive = "release"\n' + CRACK
                folder = self.run_case(text + PULL, 'solver.mode="newton"', name="torn")
                last = self.judge(folder, text, law)
                self.assertGreater(last["broken_bonds"], 20)
                rows = columns(folder)
                self.assertGreaterEqual(numpy.diff(rows["drained_energy"]).min(), -1e-12)
                self.assertLess(abs(rows["balance_error"]).max(), 0.02 * rows["external_work"].max())

    def test_the_linear_solid_refuses_what_release_alone_has(self):
        soft = PLATE + SOFT + PULL
        self.assertIn("material.damage.law", self.refusal(soft))
        strain = cut(PLATE, poisson_ratio=0.41) + 'plane = "strain"\n' + DAMAGE
        self.assertIn("poisson_ratio = 0.41", self.refusal(strain + 'drive = "release"\n' + PULL))
        self.assert_completed(self.command("check", strain + PULL))

    def test_fracture_energy_is_what_a_torn_plate_takes(self):
        """The same fracture energy at any Poisson's ratio: a crack through the plate takes it along its ligament."""
        damage = '[material.damage]\nlaw = "linear"\nfracture_energy = 0.02\nno_fail = ["low", "high"]\n'
        taken = {}
        for nu in (0.0, 0.2, 0.45):
            text = cut(SOLID, poisson_ratio=nu) + damage + CRACK + PULL.replace("steps = 6", "steps = 15")
            rows = columns(self.run_case(text, "solver.mode=adaptive", name="torn"))
            self.assertLess(abs(rows["reaction_y:high"][-1]), 0.1 * abs(rows["reaction_y:high"]).max())
            taken[nu] = rows["dissipated_energy"][-1] / (0.02 * 1.2 * 0.5)
        for nu, ratio in taken.items():  # damage beside the crack adds to it; few points across
            self.assertGreater(ratio, 0.85, nu)
            self.assertLess(ratio, 1.35, nu)

    def test_a_bar_has_the_uniaxial_law_of_the_solid_at_large_stretches(self):
        """Its force over that of the tangent at rest, against the law of the bulk; faces have a small share in both."""
        bar = cut(SOLID, max="[3.2, 2.0]").replace("y-", "x-").replace("y+", "x+")
        drawn = "".join(f'[[support]]\nset = "{name}"\ndisplacement = ["0.5*load*x", "free"]\n' for name in ("low", "high"))
        drawn += '[[roller]]\nname = "middle"\nat = [0.0, 1.0]\nnormal = [0, 1]\n[loading]\ntable = [0, 2e-6, 0.2, 1]\n'
        for nu in (0.0, 0.22, 0.45):
            rows = columns(self.run_case(cut(bar, poisson_ratio=nu) + drawn, name="bar"))
            force = rows["reaction_x:high"][-3:]
            for stretch, pull in zip((1.1, 1.5), force[1:]):
                ratio = pull / (stretch - 1) / (force[0] / 1e-6)
                expected = nominal_stress(stretch, nu) / (stretch - 1)
                self.assertAlmostEqual(ratio, expected, delta=0.01, msg=f"{nu} {stretch}")
            self.assertGreater(ratio, 1.05)  # neither linear nor softening

    def test_newton_converges_quadratically_in_every_increment(self):
        """A sheet with a hole, drawn to one and a half times its height: |r+| < 10 |r|^2 until round-off."""
        hole = '[[lattice.shape]]\nsubtract = "disk"\ncentre = [0.8, 0.6]\nradius = 0.3\n[[lattice.layer]]\nname = "low"'
        sheet = cut(SOLID, poisson_ratio=0.45).replace('[[lattice.layer]]\nname = "low"', hole)
        sheet += PULL.replace("0.012*load", "0.6*load")
        folder = self.run_case(sheet, "solver.linear=cholesky", "solver.relative_tolerance=1e-12", "loading.steps=5")
        with open(folder / "convergence.csv", newline="") as file:
            table = list(csv.DictReader(file))
        steps = [name for name in table[0] if name.startswith("step_")]
        self.assertEqual(len(steps), 5)
        for step in steps:
            residuals = [float(row[step]) for row in table[:-1] if row[step]]
            self.assertLess(residuals[-1], 1e-12)
            self.assertLess(len(residuals), 8)
            pairs = [(r, after) for r, after in zip(residuals, residuals[1:]) if r < 0.01]
            self.assertGreaterEqual(len(pairs), 2, step)
            for r, after in pairs:
                self.assertLess(after, 10 * r**2 + 1e-14, step)

    def test_bodies_expand_freely(self):
        text = SOLID + 'thermal_expansion = 1e-3\n[temperature]\nchange = "100*load"\n[loading]\nsteps = 1\n'
        for name, where, held in (("corner", "x < 0.1 && y < -0.1", '[0, 0]'), ("other", "x > 1.5 && y < -0.1", '["free", 0]')):
            text += f'[[set]]\nname = "{name}"\nwhere = "{where}"\n[[support]]\nset = "{name}"\ndisplacement = {held}\n'
        results = self.results(text)
        corner = results.reference[results.sets["corner"]][0]
        numpy.testing.assert_allclose(results.steps[-1].displacement, 0.1 * (results.reference - corner), atol=1e-9)

    def test_what_it_does_not_do_is_refused(self):
        for change, key in (('material.kinematics="linear"', "kinematics"),
                            ("material.poisson_ratio=0.5", "poisson_ratio"), ('material.damage.law="energy_density"', "law")):  # fmt: skip
            with self.subTest(change):
                self.assertIn(key, self.refusal(SOLID + DAMAGE + PULL, change))

    def test_cracks_that_would_run_late_are_refused_or_warned_of(self):
        """lambda/mu = 2 nu / (1 - 2 nu) in plane strain."""
        strain = SOLID + 'plane = "strain"\n' + DAMAGE + PULL
        self.assertIn("poisson_ratio = 0.41", self.refusal(cut(strain, poisson_ratio=0.41)))
        for nu, warns in ((0.35, False), (0.37, True), (0.4, True)):
            ended = self.assert_completed(self.command("check", cut(strain, poisson_ratio=nu)))
            self.assertEqual("to run where lambda/mu" in ended.output + ended.errors, warns, nu)
        self.assert_completed(self.command("check", cut(SOLID + PULL, poisson_ratio=0.49) + ""))

    def test_steps_that_pass_over_the_softening_are_warned_of(self):
        """In one step bonds are driven far beyond their law, and most of what they set free is drained."""
        whole = cut(SOLID, poisson_ratio=0.45)
        for damage, steps, warns in ((SOFT, 1, True), (SOFT, 60, False), (DAMAGE, 1, True)):
            text = whole + damage + CRACK + PULL
            folder = self.run_case(text, "solver.mode=newton", "loading.adaptive=false", f"loading.steps={steps}", name="over")
            warnings = json.loads((folder / "summary.json").read_text())["warnings"]
            self.assertEqual([warning for warning in warnings if "times what they bear" in warning] != [], warns, warnings)

    def test_a_load_far_beyond_the_onset_is_warned_of(self):
        text = SOLID + DAMAGE + CRACK + PULL
        for factor, warns in (("0.012*load", False), ("1.2*load", True)):
            folder = self.run_case(text.replace("0.012*load", factor), "solver.mode=adaptive", name="far", code=(0, 3))
            warnings = json.loads((folder / "summary.json").read_text())["warnings"]
            self.assertEqual(any("is not a peak of the body" in one for one in warnings), warns, warnings)

    def test_softening_takes_the_steps_that_are_asked_for(self):
        """In mode newton: a body whose bonds soften early took 496 steps in the place of ten."""
        law = SOFT.replace("0.01\n", "0.03\n").replace("0.005", "0.003")
        text = cut(SOLID, poisson_ratio=0.45, max="[1.0, 1.2]") + law + CRACK + PULL
        few = columns(self.run_case(text, 'solver.mode="newton"', "loading.steps=10", name="few"))
        more = columns(self.run_case(text, 'solver.mode="newton"', "loading.steps=40", name="more"))
        self.assertLess(len(few["step"]), 14)
        self.assertGreater(few["dissipated_energy"][-1], 0.01)
        for rows in (few, more):
            self.assertGreaterEqual(numpy.diff(rows["drained_energy"]).min(), 0)
            self.assertLess(abs(rows["balance_error"]).max(), 1e-4 * rows["external_work"].max())
        drained = [rows["drained_energy"][-1] / rows["external_work"][-1] for rows in (few, more)]
        self.assertLess(drained[1], 0.5 * drained[0])
        peaks = [abs(rows["reaction_y:high"]).max() for rows in (few, more)]
        self.assertAlmostEqual(peaks[0] / peaks[1], 1, delta=0.03)

    def test_an_interrupted_tear_goes_on_to_the_same_bits(self):
        text = SOLID + DAMAGE + CRACK + PULL
        whole = self.run_case(text, "solver.mode=adaptive", name="whole")
        self.run_case(text, "solver.mode=adaptive", name="split", words=("--stop-after", 3), code=130)
        split = self.resume("split")
        self.assertEqual(split.code, 0)
        for table in ("history.csv", "broken_bonds.csv"):
            self.assertEqual((whole / table).read_text(), (self.folder / "split" / table).read_text())

    def test_motions_balance(self):
        text = SOLID + DAMAGE.replace("0.01", "0.006") + CRACK + '[[initial]]\nvelocity = ["0", "0.6*(y - 0.6)"]\n'
        text += '[solver]\nmode = "dynamics"\n[dynamics]\nend_time = 0.06\nhistory_every = 5\n'
        rows = columns(self.run_case(text))
        self.assertGreater(rows["broken_bonds"][-1], 20)
        whole = rows["stored_energy"] + rows["kinetic_energy"] + rows["dissipated_energy"]
        numpy.testing.assert_allclose(whole, whole[0], rtol=0.08)  # first order in the step, as with bonds
