"""Absorbing layers: energy that they take, reflection, and the decay of the reference's own integration."""

import numpy

from tests.acceptance.folder import Folder
from tests.acceptance.motions import BAR, SQUARE, columns, fields
from tests.reference.motion import Motion

# A pulse travels to the right at sqrt(4 / 2) m/s, over a layer from x = 6 m to the end.
PULSE = BAR.replace("max = [3]", "max = [9]").replace("end_time = 4.0", "end_time = 8.0")
PULSE = PULSE.replace('"1e-3*exp(-(x - 1.4)^2/0.09)"', '"1e-3*exp(-(x - 3)^2/0.25)"')
PULSE = PULSE.replace('"1e-3*sin(x)"', f'"{2 * 2**0.5}*(x - 3)/0.25*1e-3*exp(-(x - 3)^2/0.25)"')


def layer(rate, where="x > 6"):
    return f'[[set]]\nname = "layer"\nwhere = "{where}"\n[[absorbing]]\nset = "layer"\nrate = "{rate}"\n'


class Absorbed(Folder):
    def test_a_layer_swallows_a_pulse_that_an_end_sends_back(self):
        open_end = columns(self.run_case(PULSE, name="open"))
        rate = 3 * 2**0.5 / 3 * numpy.log(1e2)  # from docs/theory.md, for a reflection of 1e-2
        for name, scheme in (("explicit", "time_step = 0.02"), ("implicit", 'scheme = "newmark"\ntime_step = 0.02')):
            text = PULSE.replace("time_step = 0.02", scheme) + layer(f"{rate}*((x - 6)/3)^2")
            rows = columns(self.run_case(text, name=name))
            left = (rows["kinetic_energy"] + rows["stored_energy"])[-1] / rows["external_work"][0]
            self.assertLess(left, 0.01)  # the pulse is dispersed: some of it travels left at first
            self.assertGreater((open_end["kinetic_energy"] + open_end["stored_energy"])[-1], 0.99 * open_end["external_work"][0])
            self.assertAlmostEqual(rows["drained_energy"][-1] / rows["external_work"][0], 1 - left, delta=2e-3)

    def test_energies_balance_to_the_schemes_order(self):
        errors = []
        for step in (0.04, 0.02, 0.01):
            rows = columns(self.run_case(PULSE.replace("time_step = 0.02", f"time_step = {step}") + layer("5")))
            errors.append(abs(rows["balance_error"]).max())
            missing = rows["modified_energy"] + rows["drained_energy"]
            self.assertLess(abs(missing - missing[0]).max(), 1e-11 * missing[0] if step == 0 else 0.02 * missing[0])
        for coarse, half in zip(errors, errors[1:]):
            self.assertAlmostEqual(coarse / half, 4.0, delta=0.5)

    def test_steps_of_the_reference(self):
        text = PULSE.replace("every = 20", "every = 1").replace("end_time = 8.0", "end_time = 3.0") + layer("2 + x", "x > 3")
        folder = self.run_case(text)
        motion, at = Motion(folder, text), fields(folder)
        rate = numpy.where(motion.results.reference > 3, 2 + motion.results.reference, 0.0)
        for state in at.values():
            if state["time"] == 0.0:
                continue
            motion.step(0.02, state["time"], rate)
            numpy.testing.assert_allclose(state["displacement"], motion.u, rtol=1e-9, atol=1e-14)
            numpy.testing.assert_allclose(state["velocity"], motion.v, rtol=1e-9, atol=1e-13)

    def test_a_free_body_slows_down_exactly(self):
        text = BAR.replace('"1e-3*exp(-(x - 1.4)^2/0.09)"', "0").replace('"1e-3*sin(x)"', "0.5") + '[[absorbing]]\nrate = "0.7"\n'
        for name, scheme in (("explicit", "time_step = 0.02"), ("implicit", 'scheme = "newmark"\ntime_step = 0.5')):
            at = fields(self.run_case(text.replace("time_step = 0.02", scheme), name=name))
            for state in at.values():
                numpy.testing.assert_allclose(state["velocity"], 0.5 * numpy.exp(-0.7 * state["time"]), rtol=1e-9)

    def test_a_pulled_bar_moves_exactly_at_any_rate(self):
        load = '[[set]]\nname = "all"\nwhere = "1"\n[[load]]\nset = "all"\nbody_force = [6.0]\n'  # 3 m/s2
        text = BAR.split("[[initial]]")[0] + "[solver]" + BAR.split("[solver]")[1] + load
        for scheme in ("time_step = 0.02", 'scheme = "newmark"\ntime_step = 0.02'):
            for rate in (10.0, 1e3, 1e4):
                case = text.replace("time_step = 0.02", scheme) + f"[[absorbing]]\nrate = {rate}\n"
                folder = self.run_case(case, name=f"rate_{rate}_{len(scheme)}")
                for state in fields(folder).values():
                    t = state["time"]
                    lost = -numpy.expm1(-rate * t)
                    numpy.testing.assert_allclose(state["velocity"], 3 / rate * lost, rtol=1e-8)
                    numpy.testing.assert_allclose(state["displacement"], 3 / rate * (t - lost / rate), rtol=1e-8, atol=1e-15)
                rows = columns(folder)
                numpy.testing.assert_allclose(rows["drained_energy"] + rows["kinetic_energy"], rows["external_work"], rtol=1e-8)

    def test_layers_add_up_and_goes_on_to_the_last_bit(self):
        text = SQUARE.replace("step_share = 0.5", "step_share = 0.2") + '[[absorbing]]\nrate = "1"\n' + layer("x^2", "x > 0")
        whole = self.run_case(text, name="whole")
        part = self.run_case(text, name="part", words=("--stop-after", 2), code=130)
        self.resume(part)
        self.assertEqual((whole / "history.csv").read_text(), (part / "history.csv").read_text())
        text = SQUARE.replace("step_share = 0.5", "step_share = 0.2") + '[[absorbing]]\nrate = "1 + x^2*(x > 0)"\n'
        one = columns(self.run_case(text))
        numpy.testing.assert_allclose(columns(whole)["kinetic_energy"], one["kinetic_energy"], rtol=1e-12)


class Refusals(Folder):
    def test_rates_that_can_not_be(self):
        for tables, words in (
            ('[[absorbing]]\nrate = "x - 1"\n', ("absorbing[0].rate", "must not be negative")),
            ('[[absorbing]]\nrate = "1/(x - x)"\n', ("absorbing[0].rate", "must be finite")),
            ('[[absorbing]]\nrate = "t"\n', ("absorbing[0].rate",)),
            ('[[absorbing]]\nset = "ends"\n[[set]]\nname = "ends"\nwhere = "x > 1"\n', ("absorbing[0].rate", "missing")),
            ('[[absorbing]]\nset = "nowhere"\nrate = 1\n', ("absorbing[0].set",)),
        ):
            said = self.refusal(BAR + tables)
            for word in words:
                self.assertIn(word, said)
        static = BAR.split("[[initial]]")[0] + "[[absorbing]]\nrate = 1\n"
        self.assertIn("absorbing", self.refusal(static))
