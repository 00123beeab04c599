"""Motions on several MPI ranks are those of one."""

import unittest

from tests.acceptance.on_ranks import BLOCK, PLATE, ROOT, Comparison, resume, rows


class Motions(Comparison):
    """Explicit steps: waves, supports and loads that move, layers that absorb."""

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

    def move(self, text, ranks=(2, 3), *options):
        return self.compare(text, ranks, *options, solver="")

    def test_a_plate_whose_supports_and_loads_move(self):
        one = self.move(self.MOVING + self.STEPS, (2, 3, 4))
        last = rows(one, "history.csv")[-1]
        for name in ("kinetic_energy", "external_work", "drained_energy", "momentum_x", "swing"):
            self.assertNotEqual(float(last[next(key for key in last if key.startswith(name))]), 0.0, name)

    def test_given_steps_and_a_row_each(self):
        self.move(self.MOVING + self.STEPS, (3,), "--set", "dynamics.time_step=5e-6", "--set", "dynamics.history_every=1",
                  "--set", "dynamics.end_time=1e-4", "--set", "output.every=7")  # fmt: skip

    def test_a_free_body_and_ranks_without_a_point(self):
        bar = """
            dimension = 1
            [lattice]
            spacing = 0.1
            area = 2.0
            shape = [{ add = "box", min = [0], max = [0.5] }]
            [material]
            model = "bond"
            micromodulus = 7.0
            density = 3.0
            [solver]
            mode = "dynamics"
            [dynamics]
            end_time = 3.0
            [[initial]]
            velocity = ["0.01*x + 0.1"]
        """
        self.move(bar, (2, 7))

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
        """, (2, 3))  # fmt: skip

    def test_a_wave(self):
        wave = (ROOT / "cases/bond_models/wave_propagation.toml").read_text()
        wave = wave.replace("[[initial]]", '[[initial]]\nvelocity = ["0.1", "0.05*x"]')  # a momentum
        self.move(wave, (2, 3), "--set", "lattice.spacing=0.1", "--set", "dynamics.end_time=0.6")

    def test_steps_that_are_refused(self):
        for ranks in (1, 2):
            said = self.refusal(self.MOVING + self.STEPS, "--set", "dynamics.time_step=1e-3", ranks=ranks)
            self.assertIn("longer than the stable step", said)
            said = self.refusal(self.MOVING + self.STEPS.replace("0.2*x", "x > 0.96 ? 1/0 : 0"), ranks=ranks)
            self.assertIn("it must be finite", said)

    def ends_of(self, text, *options):
        found = []
        for ranks in (1, 2, 3):
            run, output = self.start(ranks, text, *options)
            decision = rows(output, "decisions.csv")[-1]
            found.append((run.returncode, decision["outcome"], decision["reason"], decision["stage"]))
        self.assertEqual(found[0], found[1])
        self.assertEqual(found[0], found[2])
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
        whole = self.results(1, self.MOVING + self.STEPS).rename(self.folder / "whole")
        run, output = self.start(2, self.MOVING + self.STEPS, "--stop-after", "3")
        self.assertEqual(run.returncode, 130, run.stderr)
        self.assertEqual(len(rows(output, "history.csv")), 3)
        again = resume(3, output)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.expect_same(whole, output)


if __name__ == "__main__":
    unittest.main()
