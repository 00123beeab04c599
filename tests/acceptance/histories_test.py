"""The histories of bonds in the results: a reader can reconstruct every state from them."""

import math
import pathlib
import tempfile
import tomllib
import unittest

import h5py
import numpy

from tests.acceptance.strip import LATTICE
from tests.reference.program import peristat, settings
from tests.reference.results import table

NEVER_FAILS = -1.0

# 20 x 10 points, half cut at x = 10 mm; a row along the upper edge never fails.
STRIP = LATTICE + """\
[[set]]
name = "strong"
where = "y > 9e-3"
[[crack]]
from = [0.01, -1e-3]
to = [0.01, 0.0043]
[material]
micromodulus = 1e22
[material.damage]
law = "tanh"
onset = 0.015
critical = 0.020
no_fail = ["strong"]
[[support]]
set = "left"
displacement = [0, 0]
[[support]]
set = "right"
displacement = ["5e-4*load", "0"]
[solver]
mode = "adaptive"
[relaxation]
steps = 20
"""


class Run:
    """The files of a run, and the histories as a reader reconstructs them."""

    def __init__(self, folder):
        with h5py.File(folder / "results.h5") as file:
            case = tomllib.loads(file["case/as_resolved"][()].decode())
            self.law, self.micromodulus = case["material"]["damage"], case["material"]["micromodulus"]
            self.places, self.volume = file["points/reference"][...], file["points/volume"][...]
            sets = list(file["points/set_ids"].attrs["sets"])
            in_set = lambda name: file["points/set_ids"][:, sets.index(name)] == 1
            self.strong, self.held = in_set("strong"), in_set("left") | in_set("right")
            self.steps = [{name: item[...] for name, item in group.items() if name != "history"}
                          | {"number": group.attrs["step"]} for group in file["steps"].values()]  # fmt: skip
            self.changes = [{name: item[...] for name, item in group["history"].items()}
                            for group in file["steps"].values()]  # fmt: skip
        self.broken = [(row["step"], row["first_point"], row["second_point"])
                       for row in table(folder / "broken_bonds.csv")]  # fmt: skip

    def histories(self):
        """After each step with fields: bond -> largest stretch, for the bonds whose history has changed."""
        known = {}
        for changed in self.changes:
            bonds = zip(changed["first_point"].tolist(), changed["second_point"].tolist())
            known |= dict(zip(bonds, changed["largest_stretch"].tolist()))
            yield dict(known)

    def bonds(self):
        """Bonds of the lattice within the horizon that do not touch the crack."""
        reach = 3.015e-3
        for i, at in enumerate(self.places):
            for j in range(i + 1, len(self.places)):
                there = self.places[j]
                if math.dist(at, there) > reach:
                    continue
                if (at[0] - 0.01) * (there[0] - 0.01) < 0.0:
                    share = (0.01 - at[0]) / (there[0] - at[0])
                    if at[1] + share * (there[1] - at[1]) <= 0.0043:
                        continue
                yield i, j

    def integrity(self, largest):
        """Eq. 12 of [ADAPT]."""
        onset, critical, rate = self.law["onset"], self.law["critical"], self.law["rate"]
        if largest <= onset:
            return 1.0
        if largest >= critical:
            return 0.0
        return 0.5 * (1.0 - math.tanh(rate * (onset + critical - 2.0 * largest) / (onset - critical)))


class Histories(unittest.TestCase):
    RUNS = {
        "adaptive": [],
        "transient": ["solver.mode=relaxation", "relaxation.breaking=transient"],
        "adaptive and transient": ["relaxation.breaking=transient"],
        "every third": ["relaxation.breaking=transient", "output.every=3"],
        "newton": ["solver.mode=newton", "loading.steps=40", "loading.smallest_step=0.005",
                   'material.damage.law="tanh_continuous"'],
    }  # fmt: skip

    @classmethod
    def setUpClass(cls):
        base = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory(prefix="peristat test ")))
        (base / "strip.toml").write_text(STRIP)
        cls.runs = {}
        for name, changes in cls.RUNS.items():
            ended = peristat("run", base / "strip.toml", "--quiet", "--threads", 2, "--output", base / name,
                             *settings(*changes), seconds=300)  # fmt: skip
            # Mode newton ends at the limit point, when 10 bonds are broken.
            assert ended.code == (3 if name == "newton" else 0), f"{name}: {ended.said}"
            cls.runs[name] = Run(base / name)

    def test_replayed_they_give_the_broken_bonds_of_every_step(self):
        for name, run in self.runs.items():
            with self.subTest(name):
                self.assertGreater(len(run.steps), 3)
                for step, known in zip(run.steps, run.histories()):
                    broken = {bond for bond, largest in known.items() if largest >= run.law["critical"]}
                    told = {(first, second) for number, first, second in run.broken if number <= step["number"]}
                    self.assertEqual(broken, told)
                self.assertGreater(len(broken), 20 if name != "newton" else 5)

    def test_they_are_told_when_they_change_and_never_heal(self):
        for name, run in self.runs.items():
            with self.subTest(name):
                known = {}
                for changed in run.changes:
                    bonds = list(zip(changed["first_point"].tolist(), changed["second_point"].tolist()))
                    self.assertEqual(bonds, sorted(set(bonds)))
                    for bond, largest in zip(bonds, changed["largest_stretch"].tolist()):
                        if largest != NEVER_FAILS:
                            self.assertGreater(largest, known.get(bond, run.law["onset"]))
                            self.assertLess(known.get(bond, 0.0), run.law["critical"])
                        known[bond] = largest
        # Relaxation begins at load 0, long before damage: steps without a change are listed, too.
        self.assertEqual(len(self.runs["transient"].changes[1]["largest_stretch"]), 0)

    def test_bonds_that_never_fail_are_told_once_and_cut_ones_never(self):
        for name, run in self.runs.items():
            with self.subTest(name):
                bonds = set(run.bonds())
                never = {bond for bond in bonds if run.strong[list(bond)].any()}
                first, last = list(run.histories())[0], list(run.histories())[-1]
                for known in (first, last):
                    self.assertEqual({bond for bond, largest in known.items() if largest == NEVER_FAILS}, never)
                self.assertLessEqual(set(last), bonds)

    def test_with_them_every_accepted_state_is_rebuilt(self):
        for name in ("transient", "adaptive and transient", "every third", "adaptive"):
            run = self.runs[name]
            bonds = numpy.array(list(run.bonds()))
            i, j = bonds.T
            length = numpy.linalg.norm(run.places[j] - run.places[i], axis=1)
            for step, known in list(zip(run.steps, run.histories()))[-3:]:
                with self.subTest(f"{name}, step {step['number']}"):
                    left = numpy.array([run.integrity(known.get(bond, 0.0)) for bond in map(tuple, bonds.tolist())])
                    whole, lost = numpy.zeros(len(run.places)), numpy.zeros(len(run.places))
                    for end in (i, j):
                        numpy.add.at(whole, end, 1.0)
                        numpy.add.at(lost, end, 1.0 - left)
                    # sums of thirty numbers of order one, in another order
                    numpy.testing.assert_allclose(step["damage"], lost / whole, atol=1e-13)

                    arm = run.places[j] - run.places[i] + step["displacement"][j] - step["displacement"][i]
                    present = numpy.linalg.norm(arm, axis=1)
                    size = run.micromodulus * left * (present / length - 1.0) * run.volume[i] * run.volume[j]
                    force = numpy.zeros_like(run.places)
                    for end, sign in ((i, 1.0), (j, -1.0)):
                        numpy.add.at(force, end, sign * (size / present)[:, None] * arm)
                    # stretches of 1e-2 as differences of two lengths: 1e-16 / 1e-2 of the largest force
                    numpy.testing.assert_allclose(force, step["force"], atol=1e-13 * abs(size).max() * 30)
                    # equilibrium to the default tolerance of 1e-10
                    free = ~run.held
                    scale = numpy.linalg.norm(step["force"][run.held])
                    self.assertLess(numpy.linalg.norm(force[free]), 1e-9 * scale)


if __name__ == "__main__":
    unittest.main()
