"""Mode path with model state: from event to event by release, followed by the reference of
tests/reference/state_events.py and compared with mode adaptive."""

import numpy

from tests.acceptance.folder import Folder
from tests.acceptance.motions import columns
from tests.acceptance.state_solid_test import DAMAGE, SOLID
from tests.acceptance.states_test import CRACK, PULL, REGION, cut, solid
from tests.reference.events import AT_STRENGTH, TIE
from tests.reference.results import Results
from tests.reference.state_events import StateEvents
from tests.same_results import differences

# 10 x 16 points, of which two rows at each end are held, with a notch.
PLATE = cut(SOLID, max="[1.0, 1.2]") + CRACK + PULL
BRITTLE = {"law": "critical_stretch", "critical": 0.01}
LINEAR = {"law": "linear", "onset": 0.006, "critical": 0.015}


def damage(law):
    lines = (f"{key} = {value!r}" for key, value in law.items())
    return "[material.damage]\n" + "\n".join(lines).replace("'", '"') + '\nno_fail = ["low", "high"]\n'


def plate(law=BRITTLE, nu=0.2, more=""):
    head, crack, tail = cut(PLATE, poisson_ratio=nu).partition("[[crack]]")
    return head + damage(law) + crack + tail + more + '[solver]\nmode = "path"\n'


class Paths(Folder):
    def followed(self, text, law, *changes, teeth=10, name="out", settled=8):
        """The rows of a run whose events are those of the reference, which settles after one in `settled`."""
        folder = self.run_case(text, *changes, name=name)
        results, rows = Results(folder), columns(folder)
        own = solid(results, text)
        spared = results.sets["low"] | results.sets["high"]
        fails = own.left & ~(spared[own.first] | spared[own.second])
        held = numpy.zeros_like(results.reference, bool)
        held[results.sets["low"]], held[results.sets["high"], 1] = True, True
        events, history = StateEvents(own, fails, held, law, teeth=teeth), numpy.zeros(len(fails))
        before, found, compared, held_loads = None, 0, 0, 0
        row_of = {int(number): k for k, number in enumerate(rows["step"])}
        for step in results.steps:
            names = ("first_point", "second_point", "largest_stretch")
            old, history = history, history.copy()
            for first, second, stretch in zip(*(step.history[name].tolist() for name in names)):
                bond = own.number[first, second]
                history[bond] = events.told(numpy.array([bond]), numpy.array([stretch]))[0] if stretch > 0 else 0.0
            row, u = {key: of[row_of[step.number]] for key, of in rows.items()}, step.displacement
            energy = events.energy(u, history)
            self.assertLess(numpy.abs(own.forces(u)[~held]).max(), 1e-9 * max(numpy.abs(own.forces(u)).max(), 1e-3))
            self.assertAlmostEqual(row["stored_energy"], energy, delta=1e-11 * (energy + 1e-6))
            self.assertAlmostEqual(row["dissipated_energy"], events.taken(history), delta=1e-11 * (1e-6 + events.taken(history)))
            most = events.utilisation(u, history).max()
            self.assertLess(most, AT_STRENGTH + 2e-9)
            if before is not None and before["most"] > 1 - TIE:
                self.assertAlmostEqual(before["most"], AT_STRENGTH, delta=2e-9)
                drops = numpy.flatnonzero(history != old)
                if row["stage"] == before["row"]["stage"]:  # more events while the load is held
                    held_loads += 1
                    self.assertTrue(set(events.batch(events.utilisation(before["u"], old))) <= set(drops))
                else:
                    self.assertEqual(set(events.batch(events.utilisation(before["u"], old))), set(drops))
                    numpy.testing.assert_array_equal(history[drops], events.next(old)[drops])
                    found += 1
                if row["stage"] != before["row"]["stage"] and found % settled == 1:
                    event = events.event(before["u"], old)
                    self.assertLess(event["rest"], 1e-9)
                    drained = row["drained_energy"] - before["row"]["drained_energy"]
                    self.assertAlmostEqual(drained, event["drained"], delta=1e-8 * row["external_work"])
                    compared += 1
            elif before is not None:
                numpy.testing.assert_array_equal(history, old)
            before = {"most": most, "row": row, "u": u}
        self.assertGreater(compared, 5)
        self.held_loads = held_loads
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

    def test_softening(self):
        for nu in (0.2, 0.45):
            with self.subTest(nu):
                rows = self.followed(plate(LINEAR, nu, "teeth = 2\n"), LINEAR, teeth=2)
                self.assertGreater(rows["broken_bonds"][-1], 10)
