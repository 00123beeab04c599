"""Model lps as an energy, from the command line: compared with the reference of tests/reference/states.py, in all
modes."""

import re

import numpy

from tests.acceptance.folder import Folder
from tests.acceptance.motions import columns
from tests.reference.case import evaluate
from tests.reference.results import Results
from tests.reference.states import solid_of
from tests.same_results import differences

PLATE = """\
dimension = 2
[lattice]
spacing = 0.1
horizon_ratio = 3.015
thickness = 0.5
[[lattice.shape]]
add = "box"
min = [0, 0]
max = [1.6, 1.2]
[[lattice.layer]]
name = "low"
side = "y-"
thickness = 2
[[lattice.layer]]
name = "high"
side = "y+"
thickness = 2
[quadrature]
form = "energy"
[material]
model = "lps"
youngs_modulus = 3e3
poisson_ratio = 0.2
density = 2.0
"""
REGION = """\
[[set]]
name = "right"
where = "x > 0.8"
[[region]]
set = "right"
[region.material]
youngs_modulus = 9e3
poisson_ratio = 0.4
"""
CRACK = '[[crack]]\nfrom = [0, 0.6]\nto = [0.4, 0.6]\n'
DAMAGE = '[material.damage]\nlaw = "critical_stretch"\ncritical = 0.01\nno_fail = ["low", "high"]\n'
PULL = """\
[[support]]
set = "low"
displacement = [0, 0]
[[support]]
set = "high"
displacement = ["free", "0.012*load"]
[loading]
steps = 6
"""
PULLED = PLATE + DAMAGE + CRACK + PULL
SHAKEN = PLATE + DAMAGE.replace("0.01", "0.006") + CRACK + """\
[[initial]]
velocity = ["0", "0.6*(y - 0.6)"]
[solver]
mode = "dynamics"
[dynamics]
end_time = 0.06
history_every = 5
"""


def cut(text, **changes):
    for key, value in changes.items():
        text, count = re.subn(rf"(?m)^{key} = .*$", f"{key} = {value}", text)
        assert count == 1, key
    return text


def solid(results, text, **more):
    whole, text = text, text.replace(REGION, "")
    material = {key: float(value) for key, value in re.findall(r"(?m)^(youngs_modulus|poisson_ratio) = (.*)$", text)}
    material |= dict(re.findall(r'(?m)^(model|plane|influence|drive) = "(.*)"$', text))
    spacing = float(re.search(r"(?m)^spacing = (.*)$", text)[1])
    ratio = float(re.search(r"(?m)^horizon_ratio = (.*)$", text)[1])
    size = spacing if 'volume_correction = "linear"' in text else None
    cracks = [{"from": [0, 0.6], "to": [0.4, 0.6]}] if "[[crack]]" in text else []
    own = solid_of(material, results.reference, results.volume, ratio * spacing, size=size, cracks=cracks, **more)
    if REGION in whole:
        other = solid_of(material | {"youngs_modulus": 9e3, "poisson_ratio": 0.4}, results.reference, results.volume, ratio * spacing)
        right = results.reference[:, 0] > 0.8
        own.lame_lambda, own.mu = (numpy.where(right, *pair) for pair in ((other.lame_lambda, own.lame_lambda), (other.mu, own.mu)))
    return own


class States(Folder):
    def check_tangent(self, text, deformation):
        return self.assert_completed(self.command("check-tangent", text, words=("--deformation", deformation))).json()

    def points(self, text):
        """For a run without any load."""
        held = "".join(f'[[support]]\nset = "{name}"\ndisplacement = {[0] * (3 if "dimension = 3" in text else 2)}\n'
                       for name in ("low", "high"))  # fmt: skip
        return self.results(text + held, name="points")

    def test_energy_forces_and_tangent_are_those_of_the_reference(self):
        space = cut(PLATE, dimension=3, horizon_ratio=2.015, min="[0, 0, 0]", max="[0.5, 0.6, 0.4]").replace("thickness = 0.5\n", "")
        cases = {"stress": PLATE, "cracked": PLATE + CRACK, "space": space,
                 "strain": PLATE + 'plane = "strain"\n', "nearly_incompressible": cut(PLATE, poisson_ratio=0.49) + 'plane = "strain"\n',
                 "auxetic": cut(PLATE, poisson_ratio=-0.5), "regions": PLATE + REGION, "cracked_regions": PLATE + CRACK + REGION,
                 "perturbed": PLATE.replace("thickness = 0.5", "thickness = 0.5\nperturbation = 0.2")}  # fmt: skip
        for kernel in ("constant", "quintic", "gaussian"):
            cases[kernel] = PLATE + f'influence = "{kernel}"\n'
        for case in ("stress", "quintic"):
            cases[case + "_linear"] = cases[case].replace('form = "energy"', 'form = "energy"\nvolume_correction = "linear"')
        for name, text in cases.items():
            with self.subTest(name):
                deformation = ["x + 2e-3*sin(3*x + y)", "y + 1e-3*x*y - 2e-3*cos(2*y)"]
                deformation += ["z + 1e-3*x*z"] if "dimension = 3" in text else []
                told = self.check_tangent(text, "; ".join(deformation))
                results = self.points(text)
                own = solid(results, text)
                u = numpy.stack([evaluate(e, results.reference) for e in deformation], 1) - results.reference
                expected = {"energy": own.energies(u).sum(), "residual_norm": numpy.linalg.norm(own.forces(u)),
                            "tangent_frobenius_norm": numpy.linalg.norm(own.matrix())}  # fmt: skip
                for key, value in expected.items():
                    self.assertGreater(value, 0)
                    self.assertAlmostEqual(told[key] / value, 1, delta=1e-11, msg=key)
                self.assertLess(told["asymmetry"], 1e-13)
                self.assertLess(told["tangent_error"], 1e-11)
                self.assertLess(told["residual_error"], 1e-11)
                self.assertLess(told["force_sum"], 1e-12)

    def judge(self, folder, text, spared=("low", "high"), critical=0.01):
        """Every state is an equilibrium of the reference, and no bond exceeds its strength; returns the broken
        bonds."""
        results = Results(folder)
        whole, rows = solid(results, text), {row["step"]: row for row in results.table("history")}
        free = numpy.ones_like(results.reference, bool)
        free[results.sets["low"]] = False
        free[results.sets["high"], 1] = False
        whole_ones = {pair for pair in whole.number if any(results.sets[name][list(pair)].any() for name in spared)}
        broken, forces_of = set(), []
        for step in results.steps:
            if step.history is not None:
                names = ("first_point", "second_point", "largest_stretch")
                for first, second, stretch in zip(*(step.history[name].tolist() for name in names)):
                    if stretch >= critical:
                        broken.add((first, second))
            self.assertFalse(broken & whole_ones)
            own, row = whole.without(broken), rows[step.number]
            force = own.forces(step.displacement)
            self.assertLess(numpy.linalg.norm(force[free]), 1e-8 * max(numpy.linalg.norm(force), 1e-3))
            self.assertAlmostEqual(row["stored_energy"], own.energies(step.displacement).sum(), delta=1e-10 * (row["stored_energy"] + 1e-9))
            self.assertEqual(row["broken_bonds"], len(broken))
            breakable = own.left & ~numpy.array([pair in whole_ones for pair in whole.number])
            self.assertLess(own.stretches(step.displacement)[breakable].max(initial=0), critical * (1 + 1e-9))
            reaction = force[results.sets["high"], 1].sum()
            self.assertAlmostEqual(row["reaction_y:high"], reaction, delta=1e-8 * (abs(reaction) + 1e-3))
            forces_of.append(reaction)
        self.assertGreater(max(forces_of), 0)
        return broken

    def test_every_state_of_a_torn_plate_is_an_equilibrium(self):
        # Implicit steps alone can't follow a running crack: few bonds may break there.
        near = PULLED.replace('["low", "high"]', '["far"]') + '[[set]]\nname = "far"\nwhere = "max(abs(x - 0.45), abs(y - 0.6)/4) > 0.06"\n'
        for mode, case, spared, least in (("newton", near, ("far",), 3), ("adaptive", PULLED, ("low", "high"), 20),
                                          ("relaxation", PULLED, ("low", "high"), 20)):  # fmt: skip
            with self.subTest(mode):
                text = case + f'[solver]\nmode = "{mode}"\n'
                folder = self.run_case(text, name=mode)
                self.assertGreaterEqual(len(self.judge(folder, text, spared)), least)
                rows = columns(folder)
                self.assertGreater(rows["dissipated_energy"][-1], 0)
                # A bond that breaks against the dilatation dissipates nothing, up to the round-off of two sums.
                round_off = 1e-15 * rows["dissipated_energy"][-1]
                self.assertTrue((numpy.diff(rows["dissipated_energy"]) >= -round_off).all())
                total = rows["stored_energy"] + rows["dissipated_energy"] + rows["drained_energy"] + rows["balance_error"]
                work = rows["external_work"] + rows["numerical_work"]
                numpy.testing.assert_allclose(total, work, rtol=1e-9, atol=1e-12)

    def test_elastic_work_is_stored(self):
        text = PLATE + PULL
        rows = columns(self.run_case(text, name="elastic"))
        numpy.testing.assert_allclose(rows["stored_energy"], rows["external_work"], rtol=1e-8)
        self.assertGreater(rows["stored_energy"][-1], 0)

    def test_motions_keep_energy_and_momentum(self):
        told = {}
        for scheme, more in (("verlet", ""), ("newmark", "time_step = 1e-3\n")):
            with self.subTest(scheme):
                elastic = SHAKEN.replace(DAMAGE.replace("0.01", "0.006"), "")
                rows = columns(self.run_case(elastic + f'scheme = "{scheme}"\n{more}', name=f"elastic_{scheme}"))
                self.assertGreater(rows["stored_energy"].max(), 0.1 * rows["kinetic_energy"][0])
                # For linear forces the explicit scheme conserves the modified energy, the implicit one the energy.
                kept = rows["stored_energy"] + rows["kinetic_energy"] if scheme == "newmark" else rows["modified_energy"]
                numpy.testing.assert_allclose(kept, kept[0], rtol=1e-8)
                numpy.testing.assert_allclose(rows["momentum_y"], 0, atol=1e-12)
                rows = columns(self.run_case(SHAKEN + f'scheme = "{scheme}"\n{more}', name=scheme))
                self.assertGreater(rows["broken_bonds"][-1], 20)
                self.assertGreater(rows["dissipated_energy"][-1], 0)
                whole = rows["stored_energy"] + rows["kinetic_energy"] + rows["dissipated_energy"]
                numpy.testing.assert_allclose(whole, whole[0], rtol=0.05)  # first order in the step, as with bonds
                told[scheme] = rows["broken_bonds"][-1]
        self.assertAlmostEqual(told["verlet"] / told["newmark"], 1, delta=0.3)

    def test_threads_and_solvers_agree(self):
        text = PLATE + CRACK + PULL
        alone = self.results(text, name="alone").steps[-1].displacement
        for linear, preconditioner in (("cholesky", "auto"), ("pcg", "rigid_pieces"), ("pcg", "block_jacobi"),
                                       ("minres", "jacobi"), ("pcg", "multigrid")):  # fmt: skip
            results = self.results(text, f'solver.linear="{linear}"', f'solver.preconditioner="{preconditioner}"')
            other = results.steps[-1].displacement
            self.assertLess(abs(other - alone).max(), 1e-8 * abs(alone).max(), (linear, preconditioner))
        for threads in (2, 3):
            other = self.results(text, threads=threads).steps[-1].displacement
            self.assertLess(abs(other - alone).max(), 1e-8 * abs(alone).max(), threads)

    def test_a_run_that_is_resumed_is_the_whole_run(self):
        text = PULLED + '[solver]\nmode = "adaptive"\n'
        whole = self.run_case(text, name="whole")
        steps = len(columns(whole)["step"])
        for after in (2, steps - 2):
            part = self.run_case(text, name=f"part_{after}", words=("--stop-after", after), code=130)
            self.assertLess(len(columns(part)["step"]), steps)
            self.resume(part)
            self.assertEqual(differences(whole, part), [])

    def test_a_control_finds_its_load(self):
        supports, _ = PULL.split('[[support]]\nset = "high"')
        text = PLATE + CRACK + supports + "[loading]\nsteps = 2\ntable = [0, 1e-3]\n"
        text += '[[load]]\nset = "high"\ntotal_force = ["0", "load"]\n[[control]]\nset = "high"\nweights = [0, 1]\n'
        rows = columns(self.run_case(text, name="controlled"))
        self.assertAlmostEqual(rows["control"][-1], 1e-3, delta=1e-12)
        self.assertGreater(rows["load_factor"][-1], 0)

    def test_goes_with_other_terms_and_constraints(self):
        # Around the whole body: otherwise the stiffness of a pressure is not symmetric.
        pressed = PLATE + '[[set]]\nname = "all"\nwhere = "x > 0"\n[[load]]\nset = "all"\npressure = 20.0\n'
        told = self.check_tangent(pressed, "x + 1e-2*sin(3*x + y); y + 1e-2*x*y")
        self.assertLess(told["tangent_error"], 1e-8)
        self.assertLess(told["residual_error"], 1e-8)
        # A support and a roller that hold the same; a rigid set, and a set that is moved as a rigid body.
        ways = [PULL, PULL.replace('[[support]]\nset = "high"\ndisplacement = ["free", "0.012*load"]',
                                   '[[roller]]\nset = "high"\nnormal = [0, 1]\ndisplacement = "0.012*load"')]  # fmt: skip
        self.assertNotEqual(*ways)
        one, other = (self.results(PLATE + CRACK + way).steps[-1].displacement for way in ways)
        self.assertLess(abs(one - other).max(), 1e-9 * abs(one).max())
        held = PULL.replace('["free", "0.012*load"]', '[0, "0.012*load"]')
        rigid = PULL.replace('[[support]]\nset = "high"\ndisplacement = ["free", "0.012*load"]',
                             '[[rigid]]\nset = "high"\ndisplacement = [0, "0.012*load"]\nrotation = [0]')  # fmt: skip
        self.assertNotIn('set = "high"\ndisplacement = ["free"', rigid)
        one, other = (self.results(PLATE + CRACK + way).steps[-1].displacement for way in (held, rigid))
        self.assertLess(abs(one - other).max(), 1e-9 * abs(one).max())

    def test_refusals(self):
        collocated = PLATE.replace('form = "energy"\n', "")
        for text, words in (
            (PLATE.replace('form = "energy"', 'form = "energy"\ndegree = 4') + PULL, ("degree", "collocation")),
            (PLATE.replace('form = "energy"', 'form = "energy"\ntraction_form = "paper"') + PULL, ("traction_form",)),
            (PLATE.replace('form = "energy"', 'form = "energy"\nsurface_correction = "volume"') + PULL, ("surface_correction",)),
            (PLATE.replace('form = "energy"', 'form = "force"') + PULL, ("quadrature.form", "energy")),
            (PULLED + '[solver]\nmode = "path"\n', ("mode", "path")),
            (PLATE + REGION + '[[interface]]\nrule = "weaker"\n' + PULL, ("interface", '"lps" by collocation')),
            (PLATE + PULL + '[[symmetry]]\naxis = "x"\n', ("symmetry",)),
            (PLATE + PULL + '[[load]]\nside = "y+"\ntraction = [0, 1]\ndepth = "surface"\n', ("depth",)),
            (collocated.replace("[quadrature]", '[quadrature]\nvolume_correction = "linear"') + PULL, ("volume_correction",)),
            (collocated + 'influence = "cubic"\n' + PULL, ("influence", "inverse")),
            (PLATE.replace('model = "lps"\n', "").replace("poisson_ratio = 0.2\n", "") + PULL, ("form", "lps")),
        ):  # fmt: skip
            with self.subTest(words):
                said = self.refusal(text)
                for word in words:
                    self.assertIn(word, said)

    def test_check_reports_the_fracture_energy_that_was_given(self):
        """With any kernel: its critical stretch is that of this energy."""
        for kernel in ("inverse", "constant"):
            text = PLATE + f'influence = "{kernel}"\n' + DAMAGE.replace("critical = 0.01", "fracture_energy = 0.3") + PULL
            for drive, words in (("stretch", "under a uniform dilation"), ("release", "in the mean over the directions of a crack")):
                said = self.assert_completed(self.command("check", text, f'material.damage.drive="{drive}"')).said
                self.assertIn("fracture energy 0.3 J/m2 " + words, said)

    def test_its_constants_need_no_calibration(self):
        self.assert_refused(self.command("calibrate", PLATE + PULL), "material.model = lps", "as they are given")

    def test_the_kernel_is_the_inverse_one_unless_told(self):
        told = [self.check_tangent(PLATE + more, "1.01*x; y")["energy"]
                for more in ("", 'influence = "inverse"\n', 'influence = "constant"\n')]  # fmt: skip
        self.assertEqual(told[0], told[1])
        self.assertNotEqual(told[0], told[2])
        region = '[[set]]\nname = "right"\nwhere = "x > 0.8"\n[[region]]\nset = "right"\n[region.material]\n'
        region += "youngs_modulus = 3e3\npoisson_ratio = 0.2\n"
        for kernel, energy in (("inverse", told[0]), ("constant", told[2])):
            text = PLATE + f'influence = "{kernel}"\n' + region
            self.assertAlmostEqual(self.check_tangent(text, "1.01*x; y")["energy"] / energy, 1, delta=1e-13)
