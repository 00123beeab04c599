"""Implicit steps of mode dynamics, compared with the reference's forces, closed forms and explicit steps."""

import numpy

from tests.acceptance.folder import Folder
from tests.acceptance.motions import BAR, BREAKING, SQUARE, columns, fields, random_case
from tests.reference.motion import ImplicitMotion
from tests.reference.results import Results


def implicit(text, step, spectral_radius=1, end=None):
    """A case with implicit steps in place of its own."""
    head, tail = text.split("[dynamics]\n")
    lines = [line for line in tail.splitlines() if not line.startswith(("time_step", "step_share"))]
    lines = [f"end_time = {end}" if end is not None and line.startswith("end_time") else line for line in lines]
    keys = ['scheme = "newmark"', f"time_step = {step}", f"spectral_radius = {spectral_radius}"]
    return head + "\n".join(["[dynamics]", *keys, *lines]) + "\n"


class AgainstTheReference(Folder):
    def test_every_step_of_random_bodies_is_in_balance(self):
        broken = 0
        for seed in range(16):
            text, _, end = random_case(seed)
            radius, dt = (1, 0.6, 0)[seed % 3], (0.02, 0.05)[seed % 2]
            text = implicit(text, dt, radius).replace("history_every = 5", "history_every = 1").replace("every = 10", "every = 1")
            with self.subTest(seed=seed):
                folder = self.run_case(text, name=f"case_{seed}")
                rows, at = columns(folder), fields(folder)
                motion = ImplicitMotion(folder, text, radius)
                began = motion.stored + motion.kinetic + motion.mechanics.dissipated(motion.history)
                for row in range(1, len(rows["time"])):
                    step = int(rows["step"][row])
                    lacks = motion.take(at[step]["displacement"], rows["time"][row] - rows["time"][row - 1])
                    # The search's 1e-10 is relative to the larger forces right after the step's jump.
                    self.assertLess(lacks, 1e-7, f"step {step}")
                    velocity = numpy.where(motion.free, at[step]["velocity"], 0.0)
                    numpy.testing.assert_allclose(velocity, motion.v, rtol=1e-7, atol=1e-7 * 0.2)
                    self.assertAlmostEqual(rows["stored_energy"][row], motion.stored, delta=1e-8 * began)
                    self.assertAlmostEqual(rows["kinetic_energy"][row], motion.kinetic, delta=1e-7 * began)
                    self.assertAlmostEqual(rows["external_work"][row], began + motion.work, delta=1e-7 * began)
                    self.assertEqual(rows["broken_bonds"][row], motion.mechanics.is_broken(motion.history).sum())
                broken += rows["broken_bonds"][-1] > 0
        self.assertGreater(broken, 3)  # otherwise damage was not tested


class ClosedForms(Folder):
    def test_average_acceleration_keeps_the_energy_of_a_linear_body_at_any_step(self):
        for dt in (0.02, 0.4, 2.0):  # the stable step is 0.13 s
            rows = columns(self.run_case(implicit(BAR, dt), name=f"bar_{dt}"))
            energy = rows["kinetic_energy"] + rows["stored_energy"]
            numpy.testing.assert_allclose(energy, energy[0], rtol=1e-12)

    def test_a_motion_that_is_quadratic_in_time_is_exact(self):
        text = BAR.replace('"1e-3*exp(-(x - 1.4)^2/0.09)"', "0").replace('"1e-3*sin(x)"', "0.25")
        text += '[[set]]\nname = "all"\nwhere = "x > 0"\n[[load]]\nset = "all"\nbody_force = [3.0]\n'
        for radius in (1, 0.3, 0):
            at = fields(self.run_case(implicit(text, 0.7, radius).replace("every = 20", "every = 1")))
            for state in at.values():
                t = state["time"]
                numpy.testing.assert_allclose(state["displacement"], 0.25 * t + 0.75 * t**2, rtol=1e-9, atol=1e-12)
                numpy.testing.assert_allclose(state["velocity"], 0.25 + 1.5 * t, rtol=1e-9)

    def test_an_oscillator_follows_the_recursion(self):
        text = BAR.replace("max = [3]", "max = [0.3]").replace("3.015", "1.5").replace('"1e-3*exp(-(x - 1.4)^2/0.09)"', '"1e-4"')
        text = text.replace('"1e-3*sin(x)"', "0").replace("every = 20", "every = 1")
        text += '[[set]]\nname = "ends"\nwhere = "abs(x - 0.15) > 0.05"\n[[support]]\nset = "ends"\ndisplacement = [0]\n'
        for radius in (1, 0.7, 0):
            for step in (0.02, 0.05):
                folder = self.run_case(implicit(text, step, radius, end=20 * step), name=f"oscillator_{radius}_{step}")
                rows, at = columns(folder), fields(folder)
                self.assertTrue((rows["time_step"] == step).all(), "a step was cut")
                squared_frequency = 2 * rows["stored_energy"][0] / 1e-8 / 0.1  # density 2 in 0.05 m3
                of_inertia, of_force = (2 * radius - 1) / (radius + 1), radius / (radius + 1)
                gamma, beta = 0.5 - of_inertia + of_force, (1 - of_inertia + of_force) ** 2 / 4
                u, v, a = 1e-4, 0.0, -squared_frequency * 1e-4
                for state in list(at.values())[1:]:
                    place = u + step * v + step**2 * (0.5 - beta) * a
                    pull = squared_frequency * ((1 - of_force) * place + of_force * u) + of_inertia * a
                    new = -pull / (1 - of_inertia + (1 - of_force) * squared_frequency * beta * step**2)
                    u, v, a = place + step**2 * beta * new, v + step * ((1 - gamma) * a + gamma * new), new
                    self.assertAlmostEqual(state["displacement"][1, 0], u, delta=1e-10 * 1e-4)
                    self.assertAlmostEqual(state["velocity"][1, 0], v, delta=1e-9 * 1e-4 * squared_frequency**0.5)
                faded = (rows["kinetic_energy"] + rows["stored_energy"])[-1] / rows["stored_energy"][0]
                self.assertTrue(abs(faded - 1) < 1e-10 if radius == 1 else faded < 1 - 1e-5, faded)

    def test_agrees_with_explicit_steps_to_second_order(self):
        text = SQUARE.replace("end_time = 2.0", "end_time = 1.0").replace("/0.1)", "/0.3)").replace("every = 10", "every = 100000")
        last = lambda folder: (lambda at: at[max(at)])(fields(folder))
        fine = last(self.run_case(text.replace("step_share = 0.5", "time_step = 0.001"), name="fine"))
        for name in ("displacement", "velocity"):
            errors = [abs(last(self.run_case(implicit(text, dt)))[name] - fine[name]).max()
                      for dt in (0.05, 0.025, 0.0125)]  # fmt: skip
            for coarse, half in zip(errors, errors[1:]):
                self.assertAlmostEqual(coarse / half, 4.0, delta=0.25)


class Breaking(Folder):
    TEXT = implicit(BREAKING.replace("every = 10", "every = 4"), 0.04)

    def test_bonds_break_as_by_explicit_steps(self):
        texts = BREAKING.replace("step_share = 0.5", "time_step = 0.01"), implicit(BREAKING, 0.01)
        explicit, found = (columns(self.run_case(text))["broken_bonds"][-1] for text in texts)
        self.assertGreater(explicit, 20)
        self.assertLess(abs(found - explicit), 0.1 * explicit)

    def test_long_steps_gain_no_energy_from_bonds_that_break(self):
        for radius in (1, 0.8, 0):
            for step in (0.1, 0.5, 2.0):
                with self.subTest(radius=radius, step=step):
                    rows = columns(self.run_case(implicit(BREAKING, step, radius), name=f"long_{radius}_{step}"))
                    self.assertGreater(rows["broken_bonds"][-1], 10)
                    self.assertGreater((rows["balance_error"] / rows["external_work"].max()).min(), -0.0501)

    def test_goes_on_to_the_last_bit(self):
        for radius in (1, 0.5):
            text = self.TEXT.replace("spectral_radius = 1", f"spectral_radius = {radius}")
            whole = self.run_case(text, name="whole")
            part = self.run_case(text, name="part", words=("--stop-after", 4), code=130)
            self.resume(part)
            self.assertEqual((whole / "history.csv").read_text(), (part / "history.csv").read_text())
            self.assertGreater(columns(whole)["broken_bonds"][-1], 10)

    def test_solvers_and_threads_agree(self):
        found = [columns(self.run_case(self.TEXT.replace('mode = "dynamics"', f'mode = "dynamics"\n{keys}')))
                 for keys in ('linear = "cholesky"', 'linear = "pcg"', 'linear = "pcg"\ntangent = "stored"')]  # fmt: skip
        for other in found[1:]:
            numpy.testing.assert_array_equal(found[0]["broken_bonds"], other["broken_bonds"])
            numpy.testing.assert_allclose(found[0]["kinetic_energy"], other["kinetic_energy"], rtol=1e-7)

    def test_a_step_that_finds_nothing_is_halved_and_grows_again(self):
        text = implicit(SQUARE, 0.2).replace('mode = "dynamics"', 'mode = "dynamics"\nmax_iterations = 2\nrelative_tolerance = 1e-9')
        folder = self.run_case(text.replace("every = 10", "every = 1").replace("/0.1)", "/0.4)"))
        actions = [row for row in Results(folder).table("decisions") if row["action"] == "change time step"]
        self.assertTrue(any(row["next_increment"] < row["increment"] for row in actions))
        self.assertTrue(any(row["next_increment"] > row["increment"] for row in actions))
        self.assertAlmostEqual(columns(folder)["time"][-1], 2.0)


class Refusals(Folder):
    def test_keys_that_do_not_go_together(self):
        newmark = implicit(BAR, 0.1)
        for text, key in (
            (newmark.replace("time_step = 0.1", ""), "time_step"),
            (newmark.replace("time_step = 0.1", "step_share = 0.5"), "time_step"),
            (newmark.replace("spectral_radius = 1", "spectral_radius = 1.5"), "dynamics.spectral_radius"),
            (newmark.replace('"newmark"', '"implicit"').replace("spectral_radius = 1", ""), "dynamics.scheme"),
            (newmark.replace('"newmark"', '"verlet"'), "dynamics.spectral_radius"),
            (newmark.replace("time_step = 0.1", "time_step = 1e-5"), "round-off of the inertia"),
            (BAR.replace('mode = "dynamics"', 'mode = "dynamics"\nrelative_tolerance = 1e-8'), "solver.relative_tolerance"),
        ):
            self.assertIn(key, self.refusal(text))


class CheckTangent(Folder):
    def test_inertia_is_in_it(self):
        self.assert_completed(self.command("check-tangent", implicit(SQUARE, 1e-3)))
