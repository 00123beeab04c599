"""Mode dynamics: motions compared with velocity Verlet in NumPy, conserved quantities, symmetry and restarts."""

import json
import unittest

import h5py
import numpy

from tests.acceptance.folder import Folder
from tests.acceptance.motions import BAR, BREAKING, SQUARE, columns, fields, random_case
from tests.reference.motion import Motion
from tests.reference.results import Results


class AgainstNumPy(Folder):
    """Random bodies with every law, followed by the reference with its own bonds, step by step."""

    def judge(self, text, dt, end):
        folder = self.run_case(text, name=f"case_{len(list(self.folder.iterdir()))}")
        motion, rows, at = Motion(folder, text), columns(folder), fields(folder)
        scale = {"u": 1e-9 * 0.02, "v": 1e-9 * 0.2}
        seen, began = 0, None
        for state in motion.follow(dt, end):
            if began is None:
                dissipated = state.mechanics.dissipated(state.history)
                began = state.stored + state.kinetic + dissipated
            if state.number in at:
                field = at[state.number]
                self.assertAlmostEqual(field["time"], state.time, delta=1e-12)
                numpy.testing.assert_allclose(field["displacement"], state.u, rtol=1e-9, atol=scale["u"])
                velocity = numpy.where(state.free, field["velocity"], 0.0)
                numpy.testing.assert_allclose(velocity, state.v, rtol=1e-9, atol=scale["v"])
                seen += 1
            where = numpy.flatnonzero(rows["step"] == state.number)
            if not len(where):
                continue
            row = {name: values[where[0]] for name, values in rows.items()}
            dissipated = state.mechanics.dissipated(state.history)
            energies = {"stored_energy": state.stored, "kinetic_energy": state.kinetic, "dissipated_energy": dissipated,
                        "external_work": began + state.work}  # fmt: skip
            energies["balance_error"] = began + state.work - state.stored - state.kinetic - dissipated
            if state.time < end:
                energies["modified_energy"] = state.kinetic + state.stored - dt**2 / 8 * state.modified
            for name, energy in energies.items():
                self.assertAlmostEqual(row[name], energy, delta=1e-10 * began, msg=name)
            self.assertEqual(row["broken_bonds"], state.mechanics.is_broken(state.history).sum())
            momentum = (state.mass * state.v).sum(axis=0)
            for axis, component in zip("xyz", momentum):
                self.assertAlmostEqual(row[f"momentum_{axis}"], component, delta=1e-10 * motion.mass.sum() * 0.1)
        self.assertGreaterEqual(seen, 5)
        return rows["broken_bonds"][-1]

    def test_random_bodies(self):
        broken = []
        for seed in range(24):
            with self.subTest(seed=seed):
                broken.append(self.judge(*random_case(seed)))
        self.assertGreater(sum(count > 0 for count in broken), 4)  # otherwise damage was not tested

    def test_triangles_and_tetrahedra(self):
        for dimension, constants in ((2, "c1 = 300\nc2 = 6e4"), (3, "c1 = 300\nc2 = 2e5\nc3 = 1e8")):
            with self.subTest(dimension=dimension):
                box = f"min = {[0.0] * dimension}\nmax = {[0.7, 0.5, 0.4][:dimension]}"
                text = SQUARE.replace("dimension = 2", f"dimension = {dimension}").replace("youngs_modulus = 1.0", f'model = "cpd"\n{constants}')
                text = text.replace("min = [-0.8, -0.8]\nmax = [0.8, 0.8]", box).replace("[lattice]", "[lattice]\nhorizon_ratio = 2.015")
                still = ', "0"' * (dimension - 2)
                text = text.replace('(x^2 + y^2)/0.1)"]', f'(x^2 + y^2)/0.1)"{still}]').replace("end_time = 2.0", "end_time = 0.5")
                dt = 0.8 * columns(self.run_case(text, name="share"))["time_step"].min()
                self.judge(text.replace("every = 10", "every = 2").replace("step_share = 0.5", f"time_step = {dt}"), dt, 0.5)


class Conserved(Folder):
    def energies(self, dt):
        text = BAR.replace("0.02\n", f"{dt}\n").replace("every = 20", f"every = {round(0.4 / dt)}")
        rows = columns(self.run_case(text, name=f"bar_{dt}"))
        return rows["kinetic_energy"] + rows["stored_energy"], rows["modified_energy"]

    def test_modified_energy_of_a_linear_body_and_the_order_of_the_plain_one(self):
        errors = []
        for dt in (0.04, 0.02, 0.01):
            plain, modified = self.energies(dt)
            self.assertLess(numpy.ptp(modified) / plain[0], 1e-12)
            errors.append(numpy.ptp(plain) / plain[0])
        self.assertGreater(errors[-1], 1e-6)  # not round-off
        for coarse, fine in zip(errors, errors[1:]):
            self.assertAlmostEqual(coarse / fine, 4.0, delta=0.3)

    def test_momentum_of_a_free_body(self):
        rows = columns(self.run_case(BAR))
        self.assertGreater(abs(rows["momentum_x"][0]), 1e-4)
        self.assertLess(numpy.ptp(rows["momentum_x"]) / abs(rows["momentum_x"][0]), 1e-12)

    def test_a_constant_force_on_a_free_body(self):
        """The centre falls like a point: u = g t^2 / 2, for which velocity Verlet is exact."""
        text = BAR.replace('displacement = ["1e-3*exp(-(x - 1.4)^2/0.09)"]\nvelocity = ["1e-3*sin(x)"]', 'velocity = [0.25]')
        text += '[[load]]\ngravity = [-9.81]\n[[probe]]\nname = "fall"\nset = "all"\nfield = "displacement"\n'
        text += '[[set]]\nname = "all"\nwhere = "1"\n'
        rows = columns(self.run_case(text))
        numpy.testing.assert_allclose(rows["fall"], 0.25 * rows["time"] - 9.81 * rows["time"] ** 2 / 2, atol=1e-10)
        self.assertLess(numpy.abs(rows["balance_error"]).max(), 1e-10 * rows["kinetic_energy"][-1])


class Waves(Folder):
    def test_a_long_wave_travels_at_the_speed_of_sound(self):
        """sqrt(E/rho) = sqrt(2) m/s: half a standing wave of the free bar oscillates with the period 2 L / c."""
        text = BAR.replace("max = [3]", "max = [12]").replace("4.0\ntime_step = 0.02", "17.0\ntime_step = 0.05")
        text = text.replace('["1e-3*exp(-(x - 1.4)^2/0.09)"]\nvelocity = ["1e-3*sin(x)"]', '["1e-3*cos(pi*x/12)"]')
        text = text.replace("[lattice]", '[quadrature]\nvolume_correction = "linear"\nsurface_correction = "volume"\n[lattice]')
        text += '[[probe]]\nname = "end"\nat = [0]\nfield = "displacement"\n'
        rows = columns(self.run_case(text.replace("every = 20", "every = 2")))
        after = rows["time"] > 12.0
        period = rows["time"][after][rows["end"][after].argmax()]
        self.assertAlmostEqual(period, 2 * 12 / numpy.sqrt(2.0), delta=0.02 * period)


class Symmetry(Folder):
    def test_four_fold_symmetry_is_kept_to_round_off(self):
        at = fields(self.run_case(SQUARE))
        u = at[max(at)]["displacement"]
        with h5py.File(self.folder / "out/results.h5") as file:
            x = file["points/reference"][...]
        order = lambda places: numpy.lexsort(numpy.round(places / 0.05).astype(int).T)
        for turn in ([[0, -1], [1, 0]], [[-1, 0], [0, 1]]):
            turned = u @ numpy.array(turn).T
            difference = turned[order(x @ numpy.array(turn).T)] - u[order(x)]
            self.assertGreater(numpy.abs(u).max(), 1e-3)
            self.assertLess(numpy.abs(difference).max(), 1e-13)

    def test_planes_of_symmetry_give_the_whole_body(self):
        self.quarter_is_whole("time_step = 0.05", 1e-13)
        self.quarter_is_whole('scheme = "newmark"\ntime_step = 0.05', 1e-10)  # to the tolerance of its searches

    def quarter_is_whole(self, steps, tolerance):
        text = SQUARE.replace("step_share = 0.5", steps)
        whole = fields(self.run_case(text))
        quarter = text.replace("min = [-0.8, -0.8]", "min = [0, 0]")
        quarter += '[[symmetry]]\naxis = "x"\nat = 0\n[[symmetry]]\naxis = "y"\nat = 0\n'
        part = fields(self.run_case(quarter, name="quarter"))
        places = {}
        for name in ("out", "quarter"):
            with h5py.File(self.folder / name / "results.h5") as file:
                places[name] = file["points/reference"][...]
        of = {tuple(numpy.round(place, 6)): k for k, place in enumerate(places["out"])}
        same = [of[tuple(numpy.round(place, 6))] for place in places["quarter"]]
        last = max(part)
        for name in ("displacement", "velocity"):
            numpy.testing.assert_allclose(part[last][name], whole[last][name][same], atol=tolerance)
        rows, quarter_rows = columns(self.folder / "out"), columns(self.folder / "quarter")
        for name in ("kinetic_energy", "stored_energy"):
            numpy.testing.assert_allclose(4 * quarter_rows[name], rows[name], rtol=1e3 * tolerance, atol=1e-16)


class Restarts(Folder):
    def same(self, a, b):
        for name in ("history.csv", "broken_bonds.csv"):
            self.assertEqual((a / name).read_text(), (b / name).read_text(), name)
        first, second = fields(a), fields(b)
        self.assertEqual(first.keys(), second.keys())
        for step, values in first.items():
            for name, value in values.items():
                numpy.testing.assert_array_equal(value, second[step][name], f"{step} {name}")

    def test_a_run_that_goes_on_is_the_same_to_the_last_bit(self):
        text = BREAKING.replace("every = 10", "every = 16")
        text = text.replace("step_share = 0.5", "step_share = 0.2\nhistory_every = 4")
        whole = self.run_case(text, name="whole")
        self.assertGreater(columns(whole)["broken_bonds"][-1], 10)
        for name, steps in (("early", 3), ("late", 9)):
            folder = self.run_case(text, name=name, words=("--stop-after", steps), code=130)
            self.resume(folder)
            self.same(whole, folder)

    def test_a_longer_end_extends_a_run(self):
        text = BREAKING.replace("step_share = 0.5", "time_step = 0.04")
        whole = self.run_case(text.replace("end_time = 2.0", "end_time = 3.0"), name="whole")
        part = self.run_case(text, name="part")
        self.resume(part, "dynamics.end_time=3.0")
        a, b = columns(whole), columns(part)
        self.assertAlmostEqual(a["time"][-1], b["time"][-1])
        self.assertAlmostEqual(a["kinetic_energy"][-1], b["kinetic_energy"][-1], delta=1e-9 * a["kinetic_energy"][-1])
        self.assertIn("dynamics.end_time", self.resume(part, "dynamics.end_time=1.0", code=2).errors)

    def test_rows_do_not_change_the_motion(self):
        often = columns(self.run_case(BREAKING.replace("every = 10", "every = 2"), name="often"))
        seldom = columns(self.run_case(BREAKING, name="seldom"))
        for name in ("time", "kinetic_energy", "broken_bonds"):
            self.assertEqual(often[name][-1], seldom[name][-1], name)

    def test_threads_agree_to_round_off(self):
        one, two = (self.run_case(BREAKING, name=f"t{threads}", threads=threads) for threads in (1, 2))
        self.same(two, self.run_case(BREAKING, name="t2b", threads=2))
        a, b = columns(one), columns(two)
        numpy.testing.assert_allclose(a["kinetic_energy"], b["kinetic_energy"], rtol=1e-9)
        numpy.testing.assert_array_equal(a["broken_bonds"], b["broken_bonds"])


class Supports(Folder):
    def test_the_velocity_of_what_is_moved(self):
        rows = columns(self.run_case(BREAKING))
        numpy.testing.assert_allclose(rows["speed"], 0.05, rtol=1e-9)

    def test_a_support_that_sets_off_at_once_does_the_work_that_balances(self):
        text = BREAKING.replace("critical = 0.015", "critical = 10")
        rows = columns(self.run_case(text))
        error = numpy.abs(rows["balance_error"]).max() / rows["external_work"][-1]
        self.assertLess(error, 0.05)
        self.assertLess(rows["balance_error"][0], 1e-14)
        finer = columns(self.run_case(text.replace("share = 0.5", "share = 0.125")))
        # First order, because the velocity jumps.
        self.assertLess(numpy.abs(finer["balance_error"]).max() / finer["external_work"][-1], error / 3)


class Steps(Folder):
    def stable(self, text):
        return columns(self.run_case(text, name="share"))["time_step"][0] / 0.5

    def test_the_stable_step_is_that_of_the_highest_frequency(self):
        """Dense: the tangent at rest by complex steps, and its largest eigenvalue with the masses."""
        text = SQUARE.replace("0.05*x", "0*x").replace("0.05*y", "0*y")
        text = text.replace("min = [-0.8, -0.8]\nmax = [0.8, 0.8]", "min = [0, 0]\nmax = [0.6, 0.6]")
        stable = self.stable(text.replace("[[initial]]", "[[initial]]\nvelocity = [0.1, 0]"))
        motion = Motion(self.folder / "share", text)
        tangent = motion.mechanics.tangent(numpy.zeros_like(motion.u))
        highest = numpy.linalg.eigvalsh(tangent).max() / motion.mass.max()
        self.assertLess(stable, 2 / numpy.sqrt(highest))
        self.assertGreater(stable, 0.99 * 2 / numpy.sqrt(highest))

    def test_a_longer_step_is_refused_and_a_shorter_one_is_not(self):
        stable = self.stable(SQUARE)
        said = self.refusal(SQUARE.replace("step_share = 0.5", f"time_step = {1.02 * stable}"))
        for words in ("case.toml:", "dynamics.time_step", "stable step"):
            self.assertIn(words, said)
        self.run_case(SQUARE.replace("step_share = 0.5", f"time_step = {0.98 * stable}"), name="shorter")

    def test_a_step_follows_the_stiffness(self):
        """Compression stiffens a body: the stable step shrinks, and a prescribed step ends the run."""
        text = SQUARE.replace("0.05*x", "0*x").replace("0.05*y", "0*y").replace("end_time = 2.0", "end_time = 24.0")
        text += '[[set]]\nname = "edge"\nwhere = "abs(x) > 0.7"\n[[support]]\nset = "edge"\ndisplacement = ["x*(exp(t/24) - 1)", "free"]\n'
        text = text.replace("step_share = 0.5", "step_share = 0.95")
        rows = columns(self.run_case(text))
        self.assertLess(rows["time_step"].min(), 0.99 * rows["time_step"][0])
        decided = [row["action"] for row in Results(self.folder / "out").table("decisions")]
        self.assertIn("change time step", decided)
        first = rows["time_step"][0]
        folder = self.run_case(text.replace("step_share = 0.95", f"time_step = {first * 0.999 / 0.95}"), code=3)
        self.assertIn("unstable_step", self.ended.said)
        self.assertEqual(json.loads((folder / "summary.json").read_text())["status"], "not_converged")

    def test_points_without_bonds_fly_on_with_the_last_step(self):
        dust = """\
dimension = 1
[lattice]
spacing = 1.0
horizon_ratio = 1.015
shape = [{ add = "box", min = [0], max = [8] }]
[[set]]
name = "held"
where = "x < 4"
[material]
micromodulus = 1e6
density = 1
[material.damage]
law = "critical_stretch"
critical = 1e-3
[[initial]]
velocity = ["x > 4 ? 100*(x - 3) : 0"]
[solver]
mode = "dynamics"
[dynamics]
end_time = 0.03
history_every = 1
"""
        for support in ("", '[[support]]\nset = "held"\ndisplacement = [0]\n'):
            folder = self.run_case(dust + support, name=f"dust_{len(support)}")
            *_, last = fields(folder).values()
            moving = last["velocity"][4:, 0]
            numpy.testing.assert_allclose(moving, 100 * (numpy.arange(4) + 1.5), rtol=1e-12)
            numpy.testing.assert_allclose(last["displacement"][4:, 0], 0.03 * moving, rtol=1e-12)

    def test_loads_that_begin_with_nothing(self):
        """Nothing has moved in the first loaded step: kinetic energy without work."""
        bar = """\
dimension = 1
[lattice]
spacing = 1
shape = [{ add = "box", min = [0], max = [8] }]
[material]
youngs_modulus = 1
density = 1
[[set]]
name = "held"
where = "x < 3"
[[set]]
name = "pulled"
where = "x > 7"
[[support]]
set = "held"
displacement = [0]
[solver]
mode = "dynamics"
[dynamics]
end_time = 22
time_step = 0.1
history_every = 1
"""
        ramp = '[[load]]\nset = "pulled"\ntotal_force = ["LOAD"]\n'
        for number, (load, scheme) in enumerate((
            ("1e-3*t", ""),
            ("t < 20 ? 0 : 1e-3", ""),
            ("1e-6 + (t < 20 ? 0 : 1e-3)", ""),  # in a motion that continues
            ("t < 20 ? 0 : 1e-3", 'scheme = "newmark"\nspectral_radius = 0.0\n'),
        )):  # fmt: skip
            with self.subTest(load=load, scheme=scheme):
                case = bar.replace("time_step", scheme + "time_step") + ramp.replace("LOAD", load)
                rows = columns(self.run_case(case, name=f"onset_{number}"))
                self.assertEqual(rows["step"][-1], 220)
                self.assertGreater(rows["external_work"][-1], 0.0)

    def test_a_load_that_sets_in_on_forces_without_a_potential(self):
        printed = """\
dimension = 2
[lattice]
spacing = 1e-3
thickness = 2e-3
shape = [{ add = "box", min = [0.0, 0.0], max = [0.014, 0.010] }]
[[set]]
name = "pulled"
where = "x > 12e-3"
[[load]]
set = "pulled"
body_force = ["t < 5.5e-7 ? 0 : 3e10", 0]
[solver]
mode = "dynamics"
operator = "fft"
[dynamics]
end_time = 2e-6
time_step = 1e-7
history_every = 1
[quadrature]
form = "printed"
[material]
model = "lps"
youngs_modulus = 72e9
poisson_ratio = 0.22
density = 2440
"""
        self.assertGreater(columns(self.run_case(printed))["external_work"][-1], 0.0)

    def test_points_that_meet_end_the_run_with_the_last_state(self):
        text = SQUARE.replace('"0.05*x*exp(-(x^2 + y^2)/0.1)", "0.05*y*exp(-(x^2 + y^2)/0.1)"', "0, 0")
        text += '[[load]]\nset = "far"\nbody_force = ["1e300*t", 0]\n[[set]]\nname = "far"\nwhere = "x > 0.7"\n'
        folder = self.run_case(text.replace("every = 10", "every = 4"), code=3)
        for values in fields(folder).values():
            self.assertTrue(numpy.isfinite(values["displacement"]).all())
        self.assertTrue((folder / "dossier.txt").exists())


    def test_a_motion_that_the_step_does_not_resolve(self):
        def shaken(per_spacing):
            return SQUARE.replace('"0.05*x*exp(-(x^2 + y^2)/0.1)", "0.05*y*exp(-(x^2 + y^2)/0.1)"',
                                  f'"1e-4*cos({numpy.pi * per_spacing / 0.1}*(x - 0.05))*cos({numpy.pi * per_spacing / 0.1}*(y - 0.05))", 0').replace("step_share = 0.5", "step_share = 0.98")  # fmt: skip

        self.run_case(shaken(0.1))
        folder = self.run_case(shaken(1), name="zigzag", code=3)
        self.assertIn("the time step does not resolve the motion", (folder / "dossier.txt").read_text())
        self.run_case(shaken(1).replace("step_share = 0.98", "step_share = 0.2"), name="shorter")

    def test_a_displacement_that_is_no_start(self):
        wild = SQUARE.replace('"0.05*x*exp(-(x^2 + y^2)/0.1)"', '"1/x"')
        self.assertIn("times its length", self.refusal(wild))
        self.assertIn("initial", self.ended.errors)


class Start(Folder):
    """Start from the equilibrium of supports and loads at t = 0."""

    HANGING = (BAR.split("[[initial]]")[0] + """\
[[set]]
name = "top"
where = "x < 0.3"
[[support]]
set = "top"
displacement = [0]
[[load]]
set = "rest"
gravity = ["1e-2*(1 + LATER)"]
[[set]]
name = "rest"
where = "x > 0.3"
[solver]
mode = "dynamics"
[dynamics]
end_time = 4.0
start = "equilibrium"
time_step = 0.02
[output]
every = 20
""")

    def hanging(self, scheme="", start="equilibrium", later="0"):
        text = self.HANGING.replace("LATER", later).replace('"equilibrium"', f'"{start}"')
        return text.replace("time_step", scheme + "time_step")

    def test_a_bar_that_hangs_stays_where_it_is(self):
        for number, scheme in enumerate(("", 'scheme = "newmark"\n')):
            rows = columns(self.run_case(self.hanging(scheme), name=f"still_{number}"))
            self.assertLess(rows["kinetic_energy"].max(), 1e-15 * rows["stored_energy"][0])
            numpy.testing.assert_allclose(rows["stored_energy"], rows["stored_energy"][0], rtol=1e-9)
            numpy.testing.assert_allclose(rows["external_work"], rows["stored_energy"][0], rtol=1e-9)
            swings = columns(self.run_case(self.hanging(scheme, "rest"), name=f"swings_{number}"))
            self.assertGreater(swings["kinetic_energy"].max(), 0.1 * rows["stored_energy"][0])

    def test_a_load_more_is_the_motion_about_the_preload(self):
        """The bar is linear to about 1e-6 of its strains: the effect of the further load adds up."""
        small = self.HANGING.replace("1e-2", "1e-6")

        def run(name, start, load):
            text = small.replace('"equilibrium"', f'"{start}"').replace('"1e-6*(1 + LATER)"', f'"1e-6*({load})"')
            return fields(self.run_case(text, name=name))

        whole, further = run("whole", "equilibrium", "1 + (t > 0)"), run("further", "rest", "t > 0")
        still = whole[0]["displacement"]
        self.assertGreater(abs(still).max(), 1e-7)
        for number, state in whole.items():
            numpy.testing.assert_allclose(state["displacement"] - still, further[number]["displacement"], atol=1e-5 * abs(still).max())

    def test_a_motion_without_a_start_says_when_it_failed(self):
        """A motion has a time, not a load factor."""
        text = self.HANGING.replace("LATER", "0").replace("[solver]", '[material.damage]\nlaw = "critical_stretch"\ncritical = 1e-6\n[solver]')
        self.run_case(text, name="no_start", code=3)
        self.assertIn("damage_begins before the first time step", self.ended.said)

    def test_a_point_on_a_spring(self):
        """A point between two held ones oscillates about its equilibrium under the further load. The load sets in with
        the first step, of which each scheme takes half; the rest of the error is of second order."""
        text = BAR.split("[[initial]]")[0].replace("max = [3]", "max = [0.3]").replace("3.015", "1.5")
        text = text.replace("youngs_modulus = 4.0", "micromodulus = 500.0") + """\
            [[set]]
            name = "ends"
            where = "abs(x - 0.15) > 0.05"
            [[set]]
            name = "mass"
            where = "abs(x - 0.15) < 0.05"
            [[support]]
            set = "ends"
            displacement = [0]
            [[load]]
            set = "mass"
            total_force = ["2e-4 + 3e-4*(t > 0)"]
            [solver]
            mode = "dynamics"
            [dynamics]
            start = "equilibrium"
            end_time = 0.6
            [output]
            every = 1
        """  # fmt: skip
        volume, spacing = 0.05, 0.1
        stiffness, mass = 2 * 500.0 * volume**2 / spacing, 2.0 * volume
        preload, step_load, frequency = 2e-4 / stiffness, 3e-4 / stiffness, (stiffness / mass) ** 0.5
        for scheme in ("verlet", "newmark"):
            for dt in (4e-3, 2e-3):
                keys = f'[dynamics]\nscheme = "{scheme}"\ntime_step = {dt}\n'
                at = fields(self.run_case(text.replace("[dynamics]\n", keys), name=f"{scheme}_{dt}"))
                self.assertAlmostEqual(at[0]["displacement"][1, 0], preload, delta=1e-9 * preload)
                for state in list(at.values())[1:]:
                    exact = preload + step_load * (1 - numpy.cos(frequency * (state["time"] - dt / 2)))
                    self.assertAlmostEqual(state["displacement"][1, 0], exact, delta=(frequency * dt) ** 2 * step_load)

    def test_goes_on_to_the_last_bit(self):
        whole = self.run_case(self.hanging(later="0.1*t"), name="whole")
        part = self.run_case(self.hanging(later="0.1*t"), name="part", words=("--stop-after", 2), code=130)
        self.resume(part)
        self.assertEqual((whole / "history.csv").read_text(), (part / "history.csv").read_text())

    def test_starts_that_are_none(self):
        text = self.hanging()
        self.assertIn("initial[0].displacement", self.refusal(text + '[[initial]]\ndisplacement = ["1e-3*x"]\n'))
        free = text.replace('[[support]]\nset = "top"\ndisplacement = [0]\n', "")
        self.assertIn("do not hold the body", self.refusal(free))
        brittle = '[material.damage]\nlaw = "critical_stretch"\ncritical = 1e-3\n'
        folder = self.run_case(text + brittle, code=3)
        self.assertIn("damage_begins", self.ended.said)
        self.assertIn("t = 0", (folder / "dossier.txt").read_text())


class Check(Folder):
    def test_neighbours_by_round_off_are_told(self):
        for ratio, correction, is_told in (("3", "none", True), ("3.015", "none", False), ("3", "exact", False)):
            for perturbation in ("0", "1e-6"):
                if correction == "exact" and perturbation != "0":
                    continue  # refused
                lattice = f"spacing = 0.1\nhorizon_ratio = {ratio}\nperturbation = {perturbation}"
                text = SQUARE.replace("spacing = 0.1", lattice) + f'[quadrature]\nvolume_correction = "{correction}"\n'
                ended = self.assert_completed(self.command("check", text))
                self.assertEqual("of the bonds are exactly as long as the horizon" in ended.output, is_told, ended.output)

    def test_tells_the_steps(self):
        ended = self.assert_completed(self.command("check", SQUARE))
        self.assertRegex(ended.output, r"motion      stable time step 0\.1\d+ s; 2\d steps of 0\.0\d+ s")
        ended = self.command("check", SQUARE.replace("step_share = 0.5", "time_step = 0.5"))
        self.assert_refused(ended, "dynamics.time_step")


class Refusals(Folder):
    def test_what_does_not_go_with_dynamics(self):
        for change, words in {
            ("density = 1.0", ""): "material.density",
            ("end_time = 2.0", ""): "dynamics.end_time",
            ("end_time = 2.0", "end_time = -1"): "dynamics.end_time",
            ("step_share = 0.5", "step_share = 1.0"): "dynamics.step_share",
            ("step_share = 0.5", "step_share = 0.5\ntime_step = 0.01"): "dynamics.step_share",
            ("[output]", "[loading]\nsteps = 3\n[output]"): "loading",
            ("[output]", "[relaxation]\nsteps = 3\n[output]"): "relaxation",
            ("[output]", "[arc_length]\nsteps = 3\n[output]"): "arc_length",
            ("[output]", '[[crack_tip]]\nname = "tip"\nat = [0, 0]\ndirection = [1, 0]\n[output]'): "crack_tip",
            ('mode = "dynamics"', 'mode = "dynamics"\nlinear = "cholesky"'): "solver.linear",
            ('mode = "dynamics"', 'mode = "dynamics"\nrelative_tolerance = 1e-6'): "solver.relative_tolerance",
            ('mode = "dynamics"', 'mode = "newton"'): "dynamics",
            ('"0.05*x*exp(-(x^2 + y^2)/0.1)"', '"load"'): "unknown variable load",
            ('"0.05*x*exp(-(x^2 + y^2)/0.1)"', '"t"'): "unknown variable t",
            ('"0.05*x*exp(-(x^2 + y^2)/0.1)"', '"sqrt(x)"'): "(-0.75, ",
            ("every = 10", "every = 10\n[[support]]\nset = \"none\"\ndisplacement = [0, 0]"): "none",
            ("step_share = 0.5", "step_share = 0.5\nhistory_every = 3"): "output.every",
        }.items():  # fmt: skip
            with self.subTest(change=change):
                self.assertIn(change[0], SQUARE)
                self.assertIn(words, self.refusal(SQUARE.replace(*change)))

    def test_constraints_with_masses_of_their_own(self):
        sets = '[[set]]\nname = "top"\nwhere = "y > 0.7"\n'
        for table in ('[[rigid]]\nset = "top"\ndisplacement = [0, "free"]\nrotation = ["free"]\n',
                      '[[roller]]\nset = "top"\nnormal = [1, 1]\n', '[[period]]\naxis = "x"\nfrom = -0.8\nto = 0.8\ngradient = ["free", 0]\n'):  # fmt: skip
            with self.subTest(table=table):
                self.assertIn("dynamics", self.refusal(SQUARE + sets + table))

    def test_a_probe_of_velocity_in_another_mode(self):
        text = '[[probe]]\nname = "speed"\nat = [0, 0]\nfield = "velocity"\n'
        text = SQUARE.replace('mode = "dynamics"\n[dynamics]\nend_time = 2.0\nstep_share = 0.5', 'mode = "newton"') + text
        text = text[: text.index("[[initial]]")] + text[text.index("[solver]") :]
        self.assertIn('solver.mode = "dynamics"', self.refusal(text))


if __name__ == "__main__":
    unittest.main()
