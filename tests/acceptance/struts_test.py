"""Struts, from the command line: faces of a crack that opens and slides part, with the energy in the ledger."""

import numpy

from tests.acceptance.folder import Folder
from tests.acceptance.motions import columns
from tests.same_results import differences

PULL = '["1.5e-4*load", "2e-4*load"]'
# Torn in two by a pull and a larger shear.
TORN = f"""\
dimension = 2
[lattice]
spacing = 1e-3
horizon_ratio = 3.015
thickness = 1e-3
shape = [{{ add = "box", min = [0, 0], max = [0.016, 0.012] }}]
[[lattice.layer]]
name = "left"
side = "x-"
thickness = 3
[[lattice.layer]]
name = "right"
side = "x+"
thickness = 3
[material]
youngs_modulus = 200e9
[material.damage]
law = "linear"
onset = 0.002
critical = 0.01
struts = "cut"
no_fail = ["left", "right"]
[[crack]]
from = [0.008, 0.006]
to = [0.008, 0.013]
[[support]]
set = "left"
displacement = [0, 0]
[[support]]
set = "right"
displacement = {PULL}
[loading]
steps = 20
[solver]
mode = "relaxation"
[relaxation]
steps = 20
"""
KEEP = 'material.damage.struts="keep"'


def straight_tear():
    """The same body, whose halves move straight apart."""
    head, end = TORN.split("[[support]]")[0], TORN.split("[loading]")[1]
    halves = "".join(
        f'[[set]]\nname = "{name}"\nwhere = "x {sign} 0.008"\n[[support]]\nset = "{name}"\ndisplacement = [{moved}, 0]\n'
        for name, sign, moved in (("west", "<", 0), ("east", ">", '"3e-4*load"'))
    )
    return head + halves + "[loading]" + end


def tail(history):
    """The largest reaction at the end over that of the run."""
    size = numpy.hypot(history["reaction_x:right"], history["reaction_y:right"])
    return size[-1] / size.max()


class Struts(Folder):
    def test_faces_part_and_the_ledger_balances(self):
        straight = columns(self.run_case(straight_tear(), "relaxation.steps=1", name="straight"))["dissipated_energy"][-1]
        for mode in ("relaxation", "adaptive"):
            with self.subTest(mode):
                kept = columns(self.run_case(TORN, KEEP, f"solver.mode={mode}", name="kept"))
                cut = columns(self.run_case(TORN, f"solver.mode={mode}", name="cut"))
                self.assertGreater(tail(kept), 0.02)
                self.assertLess(tail(cut), 1e-7)
                self.assertEqual(kept["strut_energy"].max(), 0.0)
                self.assertGreater(cut["strut_energy"][-1], 0.0)
                # The tear is straight, and takes what its bonds take; tied faces take two thirds more.
                self.assertAlmostEqual(cut["dissipated_energy"][-1] / straight, 1, delta=0.06)
                self.assertGreater(kept["dissipated_energy"][-1] / straight, 1.5)
                self.assertGreater(numpy.diff(cut["dissipated_energy"]).min(), -1e-12)  # J, round-off
                self.assertLess(abs(cut["balance_error"]).max(), 1e-4 * cut["external_work"][-1])

    def test_faces_part_in_newtons_steps_under_a_control(self):
        """Steps of a controlled opening; what settling after the cut of struts releases is drained."""
        controlled = TORN.replace(PULL, '["0.75*load", "load"]') + """\
[[set]]
name = "one"
where = "x < 0.008 && x > 0.007 && y > 0.011"
[[set]]
name = "other"
where = "x > 0.008 && x < 0.009 && y > 0.011"
[[control]]
set = "other"
weights = [1, 0]
[[control]]
set = "one"
weights = [-1, 0]
"""
        table = "loading={table=[0, 2e-4], steps=100}"
        cut = columns(self.run_case(controlled, "solver.mode=newton", table, name="newton"))
        self.assertGreater(cut["strut_energy"][-1], 0.0)
        self.assertLess(tail(cut), 1e-6)
        self.assertLess(abs(cut["balance_error"]).max(), 2e-2 * cut["external_work"][-1])

    def test_threads_and_stops_change_nothing(self):
        whole = self.run_case(TORN, name="whole")
        self.assertGreater(columns(whole)["strut_energy"][-1], 0.0)
        self.run_case(TORN, name="split", words=("--stop-after", 9), code=130)
        self.resume("split")
        self.assertEqual(differences(whole, self.folder / "split"), [])

    def test_what_cannot_cut_struts_says_so(self):
        for changes, words in (
            (["solver.mode=path"], ["solver.mode", "can't cut struts"]),
            (["solver.mode=arc_length"], ["solver.mode", "can't cut struts"]),
            (["material.model=state", "material.poisson_ratio=0.3"], ["material.damage.struts", "is for model"]),
            (["material.model=cpd", "material.poisson_ratio=0.35"], ["material.damage.struts", "is for model"]),
            (["material.damage={struts=\"cut\"}"], ["material.damage.struts", "needs a law"]),
            (["material.damage.struts=break"], ["material.damage.struts", "keep", "cut"]),
        ):  # fmt: skip
            with self.subTest(changes):
                told = self.refusal(TORN, *changes)
                for word in words:
                    self.assertIn(word, told)

    def test_all_materials_have_the_same_rule(self):
        other = """\
[[set]]
name = "low"
where = "y < 0.004"
[[region]]
set = "low"
[region.material]
model = "bond"
youngs_modulus = 100e9
[region.material.damage]
law = "linear"
onset = 0.002
critical = 0.01
"""
        self.assertIn("must be the same for all materials", self.refusal(TORN + other))
