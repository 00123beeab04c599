"""Struts, from the command line: faces of a crack that opens and slides part, with the energy in the ledger."""

import numpy

from tests.acceptance.folder import Folder
from tests.acceptance.motions import columns
from tests.same_results import differences

# Torn in two by a pull and a larger shear.
TORN = """\
dimension = 2
[lattice]
spacing = 1e-3
horizon_ratio = 3.015
thickness = 1e-3
shape = [{ add = "box", min = [0, 0], max = [0.016, 0.012] }]
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
displacement = ["1.5e-4*load", "2e-4*load"]
[loading]
steps = 20
[solver]
mode = "relaxation"
[relaxation]
steps = 20
"""
KEEP = 'material.damage.struts="keep"'


def tail(history):
    """The largest reaction at the end over that of the run."""
    size = numpy.hypot(history["reaction_x:right"], history["reaction_y:right"])
    return size[-1] / size.max()


class Struts(Folder):
    def test_faces_part_and_the_ledger_balances(self):
        for mode in ("relaxation", "adaptive"):
            with self.subTest(mode):
                kept = columns(self.run_case(TORN, KEEP, f"solver.mode={mode}", name="kept"))
                cut = columns(self.run_case(TORN, f"solver.mode={mode}", name="cut"))
                self.assertGreater(tail(kept), 0.02)
                self.assertLess(tail(cut), 1e-9)
                self.assertEqual(kept["strut_energy"].max(), 0.0)
                self.assertGreater(cut["strut_energy"][-1], 0.0)
                self.assertLess(cut["strut_energy"][-1], 0.1 * cut["dissipated_energy"][-1])
                self.assertGreaterEqual(numpy.diff(cut["dissipated_energy"]).min(), 0.0)
                self.assertLess(abs(cut["balance_error"]).max(), 1e-9 * cut["external_work"][-1])

    def test_a_bond_and_its_image_are_cut_together(self):
        """Half of a body that is symmetric does as the whole one."""
        whole = TORN.replace("from = [0.008, 0.006]\nto = [0.008, 0.013]", "from = [0.005, 0.007]\nto = [0.011, 0.005]")
        whole = whole.replace('["1.5e-4*load", "2e-4*load"]', '["3e-4*load", 0]')
        half = whole.replace("min = [0, 0]", "min = [0, 0.006]") + '[[symmetry]]\naxis = "y"\nat = 0.006\n'
        del half

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
            (["material.damage={law=\"none\",struts=\"cut\"}"], ["material.damage.struts"]),
            (["material.damage={struts=\"cut\"}"], ["material.damage.struts", "needs a law"]),
            (["material.damage.struts=break"], ["material.damage.struts", "keep", "cut"]),
        ):  # fmt: skip
            with self.subTest(changes):
                told = self.refusal(TORN, *changes)
                for word in words:
                    self.assertIn(word, told)

    def test_all_materials_have_the_same_rule(self):
        other = """\
[[region]]
name = "low"
where = "y < 0.004"
[region.material]
model = "bond"
youngs_modulus = 100e9
[region.material.damage]
law = "linear"
onset = 0.002
critical = 0.01
"""
        self.assertIn("must be the same for all materials", self.refusal(TORN + other))
