"""Mode path with model state: from event to event by release, followed by the reference of
tests/reference/state_events.py and compared with mode adaptive."""

import numpy

from tests.acceptance.folder import Folder
from tests.acceptance.motions import columns
from tests.acceptance.state_solid_test import SOLID
from tests.acceptance.states_test import CRACK, PULL, REGION, cut, solid
from tests.reference.events import AT_STRENGTH, TIE
from tests.reference.results import Results
from tests.reference.state_events import StateEvents
from tests.same_results import differences

# 10 x 16 points, of which two rows at each end are held, with a notch.
PLATE = cut(SOLID, max="[1.0, 1.2]") + CRACK + PULL
BRITTLE = {"law": "critical_stretch", "critical": 0.01}
LINEAR = {"law": "linear", "onset": 0.006, "critical": 0.015}
OPENING = {"law": "cornelissen", "onset": 0.0015, "critical": 0.03}


def damage(law):
    lines = (f"{key} = {value!r}" for key, value in law.items())
    return "[material.damage]\n" + "\n".join(lines).replace("'", '"') + '\nno_fail = ["low", "high"]\n'


def plate(law=BRITTLE, nu=0.2, more=""):
    head, crack, tail = cut(PLATE, poisson_ratio=nu).partition("[[crack]]")
    return head + damage(law) + crack + tail + more + '[solver]\nmode = "path"\n'


def linear(text):
    """The same of the linear solid, model lps as an energy."""
    text = text.replace('"state"', '"lps"').replace("[material]", '[quadrature]\nform = "energy"\n[material]', 1)
    return text.replace("[material.damage]\n", '[material.damage]\ndrive = "release"\n')


class Paths(Folder):
    def followed(self, text, law, *changes, teeth=10, name="out", settled=16):
        """The rows of a run whose events are those of the reference, which settles after one in `settled`."""
        folder = self.run_case(text, *changes, name=name)
        results, rows = Results(folder), columns(folder)
        own = solid(results, text)
        spared = results.sets["low"] | results.sets["high"]
        fails = own.left & ~(spared[own.first] | spared[own.second])
        fixed = numpy.zeros_like(results.reference, bool)
        fixed[results.sets["low"]], fixed[results.sets["high"], 1] = True, True
        events, history = StateEvents(own, fails, fixed, law, teeth=teeth), numpy.zeros(len(fails))
        before, found, compared, held = None, 0, 0, 0
        row_of = {int(number): k for k, number in enumerate(rows["step"])}
        for step in results.steps:
            names = ("first_point", "second_point", "largest_stretch")
            old, history = history, history.copy()
            for first, second, stretch in zip(*(step.history[name].tolist() for name in names)):
                bond = own.number[first, second]
                history[bond] = events.told(numpy.array([bond]), numpy.array([stretch]))[0] if stretch > 0 else 0.0
            row, u = {key: of[row_of[step.number]] for key, of in rows.items()}, step.displacement
            energy = events.energy(u, history)
            self.assertLess(numpy.abs(own.forces(u)[~fixed]).max(), 1e-9 * max(numpy.abs(own.forces(u)).max(), 1e-3))
            self.assertAlmostEqual(row["stored_energy"], energy, delta=1e-11 * (energy + 1e-6))
            self.assertAlmostEqual(row["dissipated_energy"], events.taken(history), delta=1e-11 * (1e-6 + events.taken(history)))
            most = events.utilisation(u, history).max()
            self.assertLess(most, AT_STRENGTH + 2e-9)
            if before is not None and before["most"] > 1 - TIE:
                self.assertAlmostEqual(before["most"], AT_STRENGTH, delta=2e-9)
                drops = numpy.flatnonzero(history != old)
                batch, is_held = events.batch(events.utilisation(before["u"], old)), row["stage"] == before["row"]["stage"]
                held += is_held  # others may follow
                self.assertTrue(set(batch) <= set(drops) if is_held else set(batch) == set(drops))
                numpy.testing.assert_array_equal(history[batch], events.next(old)[batch])
                found += 1
                if not is_held and found % settled == 1:
                    event = events.event(before["u"], old)
                    self.assertLess(event["rest"], 1e-9)
                    drained = row["drained_energy"] - before["row"]["drained_energy"]
                    self.assertAlmostEqual(drained, event["drained"], delta=1e-8 * row["external_work"])
                    compared += 1
            elif before is not None:
                numpy.testing.assert_array_equal(history, old)
            before = {"most": most, "row": row, "u": u}
        self.assertGreater(compared, 5)
        self.held = held
        self.judge_ledger(rows)
        return rows

    def judge_ledger(self, rows):
        work = rows["external_work"]
        for name in ("dissipated_energy", "drained_energy", "released_energy"):
            self.assertGreaterEqual(numpy.diff(rows[name], prepend=0).min(), -1e-12 * work.max(), name)
        self.assertGreaterEqual(rows["stored_energy"].min(), 0)
        self.assertLess(numpy.abs(rows["balance_error"]).max(), 1e-12 * work.max())
        self.assertLess(numpy.abs(rows["numerical_work"]).max(), 2e-3 * work.max())


class Judged(Paths):
    def test_brittle(self):
        for nu in (0.2, 0.45):
            with self.subTest(nu):
                rows = self.followed(plate(nu=nu), BRITTLE)
                self.assertGreater(rows["broken_bonds"][-1], 20)
                self.assertTrue((rows["on_response"] == 0).any())
                steps = self.run_case(plate(nu=nu), 'solver.mode="adaptive"', "loading.steps=60", name="adaptive")
                self.judge_against_steps(rows, columns(steps))

    def test_of_the_linear_solid(self):
        for nu, law, teeth in ((0.2, BRITTLE, 10), (0.45, BRITTLE, 10), (0.2, LINEAR, 2)):
            with self.subTest(nu=nu, law=law["law"]):
                text = linear(plate(law, nu, f"teeth = {teeth}\n"))
                rows = self.followed(text, law, teeth=teeth)
                self.assertGreater(rows["broken_bonds"][-1], 10)
                self.assertTrue((rows["on_response"] == 0).any())
                if law is BRITTLE:
                    steps = self.run_case(text.replace(f"teeth = {teeth}\n", ""), 'solver.mode="adaptive"', "loading.steps=60", name="adaptive")
                    self.judge_against_steps(rows, columns(steps))

    def judge_against_steps(self, rows, steps):
        """The peak is that of mode adaptive, but for a step of its load."""
        peaks = [numpy.abs(of["reaction_y:high"]).max() for of in (rows, steps)]
        self.assertAlmostEqual(peaks[0] / peaks[1], 1, delta=0.02)
        # Both tear the plate; what the steps have overshot is drained, and breaks some more bonds.
        taken = [of["dissipated_energy"][-1] for of in (rows, steps)]
        self.assertGreater(taken[1] / taken[0], 0.98)
        self.assertLess(taken[1] / taken[0], 1.25)

    def test_softening(self):
        for nu in (0.2, 0.45):
            with self.subTest(nu):
                rows = self.followed(plate(LINEAR, nu, "teeth = 2\n"), LINEAR, teeth=2)
                self.assertGreater(rows["broken_bonds"][-1], 10)

    def test_softening_by_the_opening(self):
        rows = self.followed(plate(OPENING, more="teeth = 2\n"), OPENING, teeth=2)
        self.assertGreater(rows["broken_bonds"][-1], 10)

    def test_avalanches_at_held_loads(self):
        """A path that would go back behind an entry of the table."""
        first = columns(self.run_case(plate(nu=0.45)))
        load = first["load_factor"][first["broken_bonds"] > 0][0]
        self.followed(plate(nu=0.45, more=f"table = [0, {load - 1e-3}, 1]\n"), BRITTLE, name="held", settled=8)
        self.assertGreater(self.held, 0)


class OnePath(Paths):
    def broken(self, folder):
        return [(row["first_point"], row["second_point"]) for row in Results(folder).table("broken_bonds")]

    def test_loads_on_the_way_do_not_matter(self):
        """Steps, threads, unloading, loads from the start and loads turned round break the same bonds in the same order."""
        text = plate(nu=0.45)
        expected, rows = self.broken(self.run_case(text)), columns(self.folder / "out")
        self.assertGreater(len(expected), 50)
        preloaded = text.replace("0.012*load", "0.012*(0.1 + 0.9*load)")
        for name, (changed, *changes) in {
            "steps": (text, "loading.steps=37"), "threads": (text,), "preloaded": (preloaded,),
            "unloaded": (text, "loading.table=[0, 0.8, 0.2, 1]"), "turned": (text, "loading.table=[0, 0.7, -0.7, 1]"),
            "iterated": (text, 'solver.linear="pcg"'),
        }.items():  # fmt: skip
            with self.subTest(name):
                folder = self.run_case(changed, *changes, name=name, threads=2 if name == "threads" else 1)
                self.assertEqual(self.broken(folder), expected)
                others = columns(folder)
                self.judge_ledger(others)
                for key in ("dissipated_energy", "drained_energy"):
                    self.assertAlmostEqual(others[key][-1], rows[key][-1], delta=1e-7 * rows["external_work"][-1])
                peaks = [numpy.abs(of["reaction_y:high"]).max() for of in (rows, others)]
                self.assertAlmostEqual(peaks[0], peaks[1], delta=1e-7 * peaks[0])

    def test_points_off_their_places_by_little_hardly_matter(self):
        text = plate(nu=0.45).replace("[0.4, 0.6]", "[0.42, 0.6]")  # no bond passes through the tip
        expected, rows = self.broken(self.run_case(text)), columns(self.folder / "out")
        moved = text.replace("[lattice]\n", "[lattice]\nperturbation = 1e-6\n")
        others = self.broken(self.run_case(moved, name="moved"))
        self.assertEqual(set(others), set(expected))
        for key in ("reaction_y:high", "dissipated_energy"):
            peaks = [numpy.abs(of[key]).max() for of in (rows, columns(self.folder / "moved"))]
            self.assertAlmostEqual(peaks[1] / peaks[0], 1, delta=1e-4, msg=key)

    def test_it_goes_on_from_any_step_as_if_nothing_had_been(self):
        text = plate(nu=0.45)
        self.run_case(text)
        for stop in (3, 40):
            with self.subTest(stop):
                folder = self.run_case(text, name=f"split{stop}", words=("--stop-after", stop), code=130)
                self.resume(folder)
                self.assertEqual(differences(self.folder / "out", folder), [])

    def test_it_stays_symmetric(self):
        """Mirrored bonds share a point, and what they give back together is less than one by one for lambda > mu."""
        text = plate(nu=0.45).replace(CRACK, "[[crack]]\nfrom = [0.2, 0.6]\nto = [0.7, 0.6]\n").replace("[1.0, 1.2]", "[0.9, 1.2]")
        results, rows = Results(self.run_case(text)), columns(self.folder / "out")
        mirrored = results.reference * [-1, 1] + [0.9, 0]
        image = numpy.abs(results.reference[None] - mirrored[:, None]).max(axis=2).argmin(axis=1)
        self.assertGreater(rows["broken_bonds"][-1], 20)
        for step in results.steps:
            off = numpy.abs(step.displacement - step.displacement[image] * [-1, 1]).max()
            self.assertLess(off, 1e-7 * numpy.abs(step.displacement).max())
            self.assertLess(numpy.abs(step.damage - step.damage[image]).max(), 1e-15)
        work = rows["external_work"].max()
        self.assertGreater(rows["numerical_work"][-1], 1e-6 * work)
        self.judge_ledger(rows)


    def test_of_small_stretches_the_linear_solid_has_that_of_finite_strain(self):
        text = plate(BRITTLE | {"critical": 1e-8}, 0.45).replace("0.012*load", "1.2e-8*load").replace("[0.4, 0.6]", "[0.42, 0.6]")
        expected, rows = self.broken(self.run_case(text)), columns(self.folder / "out")
        self.assertGreater(len(expected), 50)
        for changes in ((), ("loading.steps=37",), ("loading.table=[0, 0.7, -0.7, 1]",), ('solver.linear="pcg"',)):
            with self.subTest(changes):
                folder = self.run_case(linear(text), *changes, name="linear", threads=1 if changes else 2)
                self.assertEqual(self.broken(folder), expected)
                others = columns(folder)
                self.judge_ledger(others)
                for key in ("dissipated_energy", "drained_energy"):
                    self.assertAlmostEqual(others[key][-1] / rows[key][-1], 1, delta=1e-6)
                peaks = [numpy.abs(of["reaction_y:high"]).max() for of in (rows, others)]
                self.assertAlmostEqual(peaks[1] / peaks[0], 1, delta=1e-7)


class Limits(Paths):
    def test_bonds_that_are_only_compressed_never_fail(self):
        rows = columns(self.run_case(plate(nu=0.45).replace("0.012*load", "-0.006*load")))
        self.assertEqual(rows["broken_bonds"][-1], 0)

    def test_by_stretch_it_is_refused(self):
        refusal = self.refusal(linear(plate()), 'material.damage.drive="stretch"')
        self.assertIn('and "state"', refusal)
        self.assertIn('drive = "release"', refusal)
