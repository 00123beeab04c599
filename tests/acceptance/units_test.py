"""One case in SI units, in the units of a table [units], and with units in strings."""

import unittest

import h5py
import numpy

from tests.acceptance.folder import Folder

# Statics with cracks: supports, pressure, a body force and toughness.
SI = """\
title = "Plate"
dimension = 2
[lattice]
spacing = 0.001
thickness = 0.0025
[[lattice.shape]]
add = "box"
min = [0, 0]
max = [0.012, 0.02]
[[lattice.layer]]
name = "bottom"
side = "y-"
[[lattice.layer]]
name = "top"
side = "y+"
[[set]]
name = "right"
where = "x > 0.009"
[[crack]]
from = [-0.001, 0.01]
to = [0.0032, 0.01]
[material]
youngs_modulus = 70e9
density = 2500.0
[material.damage]
law = "linear"
fracture_toughness = 0.8e6
no_fail = ["bottom", "top"]
[[support]]
set = "bottom"
displacement = [0, 0]
[[support]]
set = "top"
displacement = ["free", "2e-6*load"]
[[load]]
side = "x+"
pressure = "1.2e5*load"
[[load]]
set = "right"
body_force = ["7e4*load", 0]
[loading]
steps = 2
[solver]
mode = "adaptive"
"""
IN_MM = [("[lattice]", '[units]\nlength = "mm"\nstress = "MPa"\n[lattice]'), ("0.001\n", "1\n"), ("0.0025", "2.5"), ("[0.012, 0.02]", "[12, 20]"),
         ("x > 0.009", "x > 9"), ("[-0.001, 0.01]", "[-1, 10]"), ("[0.0032, 0.01]", "[3.2, 10]"), ("70e9", "70e3"), ("2500.0", "2.5e-9"),
         ("0.8e6", '"0.8 MPa*sqrt(m)"'), ("2e-6*load", "0.002*load"), ("1.2e5*load", "0.12*load"), ("7e4*load", "7e-5*load")]  # fmt: skip
IN_WORDS = [("0.001\n", '"1 mm"\n'), ("0.0025", '"0.25 cm"'), ("[0.012, 0.02]", '["12 mm", "2 cm"]'),
            ("x > 0.009", "x > 9 mm"), ("[-0.001, 0.01]", '["-1 mm", "10 mm"]'), ("[0.0032, 0.01]", '[0.0032, "10 mm"]'), ("70e9", '"70 GPa"'),
            ("2500.0", '"2.5 kg/dm3"'), ("0.8e6", '"0.8 MPa√m"'), ("2e-6*load", "2 um * load"),
            ("1.2e5*load", "120 kPa*load"), ("7e4*load", "70 kN/m^3*load")]  # fmt: skip

# A motion with fields of place and time, whose variables are converted when they are evaluated.
MOTION = """\
title = "Plate"
dimension = 2
[lattice]
spacing = 0.001
[[lattice.shape]]
add = "box"
min = [0, 0]
max = [0.02, 0.008]
[[lattice.layer]]
name = "left"
side = "x-"
[[set]]
name = "end"
where = "x > 0.015 + spacing/4"
[material]
youngs_modulus = 70e9
density = 2500.0
[[support]]
set = "left"
displacement = ["1e-6*sin(2*pi*t/1e-5)", 0]
[[load]]
set = "end"
body_force = [0, "2e8*(t - 1e-6)*1e6 + 1e9*y/0.008"]
[[initial]]
velocity = ["0.5*x/0.02", 0]
[[absorbing]]
set = "end"
rate = "5e4"
[solver]
mode = "dynamics"
[dynamics]
end_time = 4e-6
time_step = 5e-8
[output]
every = 20
"""
MOTION_IN_MS = [("[lattice]", '[units]\nlength = "mm"\ntime = "ms"\nforce = "N"\n[lattice]'), ("0.001\n", "1\n"), ("[0.02, 0.008]", "[20, 8]"), ("0.015", "15"),
                ("70e9", "70e3"), ("2500.0", "2.5e-3"), ("1e-6*sin(2*pi*t/1e-5)", "1e-3*sin(2*pi*t/1e-2)"),
                ("2e8*(t - 1e-6)*1e6 + 1e9*y/0.008", "0.2*(t - 1e-3)*1e3 + y/8"), ("0.5*x/0.02", "0.5*x/20"), ("5e4", "50"),
                ("4e-6", "4e-3"), ("5e-8", "5e-5")]  # fmt: skip
MOTION_IN_WORDS = [("0.015 +", "15 mm +"), ("70e9", '"70 GPa"'), ("1e-6*sin(2*pi*t/1e-5)", "1 um*sin(2*pi*t/(10 us))"),
                   ("2e8*(t - 1e-6)*1e6 + 1e9*y/0.008", "200 MN/m3*(t - 1 us)/(1 us) + 1 GN/m3*y/(8 mm)"),
                   ("0.5*x/0.02", "0.5 m/s*x/(20 mm)"), ('"5e4"', '"50 1/ms"'), ("4e-6", '"4 us"'), ("5e-8", '"50 ns"')]  # fmt: skip


def rewritten(text, pairs):
    for old, new in pairs:
        assert old in text, old
        text = text.replace(old, new)
    return text


def fields(folder):
    """Every array of numbers of the points, steps and the history, except times of computation."""
    found = {}

    def collect(group, path):
        for name, item in group.items():
            if isinstance(item, h5py.Group):
                collect(item, f"{path}/{name}")
            elif item.dtype.kind in "fiu" and "seconds" not in name:
                found[f"{path}/{name}"] = item[...]

    with h5py.File(folder / "results.h5") as file:
        for top in ("points", "steps", "history"):
            collect(file[top], top)
        found["case"] = file["case/as_resolved"][()]
    return found


class ThreeWays(Folder):
    def test_statics_are_the_same_to_the_last_bit(self):
        known = fields(self.run_case(SI, name="si"))
        self.assertGreater(abs(known["history/broken_bonds"][-1]), 0)
        for name, pairs in (("mm", IN_MM), ("words", IN_WORDS)):
            with self.subTest(name):
                other = fields(self.run_case(rewritten(SI, pairs), name=name))
                self.assertEqual(list(other), list(known))
                for key, values in known.items():
                    if key != "case":
                        numpy.testing.assert_array_equal(other[key], values, err_msg=key)

    def test_motions_are_the_same_to_round_off(self):
        known = fields(self.run_case(MOTION, name="si"))
        self.assertGreater(len([name for name in known if name.endswith("velocity")]), 3)
        for name, pairs in (("ms", MOTION_IN_MS), ("words", MOTION_IN_WORDS)):
            with self.subTest(name):
                other = fields(self.run_case(rewritten(MOTION, pairs), name=name))
                self.assertEqual(list(other), list(known))
                for key, values in known.items():
                    if key == "case" or "balance_error" in key:
                        continue
                    scale = abs(values).max() if values.size else 0.0
                    numpy.testing.assert_allclose(other[key], values, rtol=0, atol=1e-14 * scale, err_msg=key)

    def test_the_resolved_case_is_in_si_units_and_gives_the_same_body(self):
        folder = self.run_case(rewritten(SI, IN_MM), name="mm")
        known = fields(folder)
        resolved = known["case"].decode()
        self.assertNotIn("[units]", resolved)
        self.assertIn("thickness = 0.0025", resolved)
        again = fields(self.run_case(resolved, name="again"))
        for key in ("points/reference", "points/volume", "history/stored_energy", "history/broken_bonds"):
            numpy.testing.assert_array_equal(again[key], known[key], err_msg=key)

    def test_points_of_a_file_are_in_the_unit_of_length(self):
        rows = [(x, y) for x in range(12) for y in range(5)]
        name = {0: "held", 11: "pulled"}
        for unit, tens in (("m", "e-3"), ("mm", "")):
            lines = [f"{x}.1{tens},{y}{tens},1{tens and 'e-9'},{name.get(x, '')}" for x, y in rows]
            self.write(f"points_{unit}.csv", "\n".join(["x,y,volume,set", *lines]))
        text = ('dimension = 2\n[points]\nfile = "points_m.csv"\nhorizon = 3.1e-3\nthickness = 1e-3\n[material]\nyoungs_modulus = 1e9\n'
                '[[support]]\nset = "held"\ndisplacement = [0, 0]\n[[support]]\nset = "pulled"\ndisplacement = ["1e-6*load", 0]\n')  # fmt: skip
        ways = [text, rewritten(text, [("points_m", "points_mm"), ("horizon = 3.1e-3", 'horizon = 3.1e-3\nlength_unit = "1 mm"')]),
                '[units]\nlength = "mm"\n' + rewritten(text, [("points_m", "points_mm"), ("3.1e-3", "3.1"), ("1e-3", "1"), ("1e9", "1e3"), ("1e-6", "1e-3")])]  # fmt: skip
        ways[2] = "dimension = 2\n" + ways[2].replace("dimension = 2\n", "")
        found = [fields(self.run_case(way, name=f"way_{k}")) for k, way in enumerate(ways)]
        for other in found[1:]:
            numpy.testing.assert_array_equal(other["points/reference"], found[0]["points/reference"])
            numpy.testing.assert_array_equal(other["points/volume"], found[0]["points/volume"])
            numpy.testing.assert_array_equal(other["points/source_row"], found[0]["points/source_row"])


class Words(Folder):
    def test_a_wrong_dimension_is_refused_with_the_place(self):
        run = self.command("check", SI.replace("0.0025", '"2.5 MPa"'))
        self.assert_refused(run, ":5:1: lattice.thickness = \"2.5 MPa\"", "must be a length, e.g. 2.5 mm", "MPa is the unit of a stress")
        run = self.command("check", SI, 'lattice.thickness="2.5 kg"')
        self.assert_refused(run, "--set lattice.thickness", "kg is the unit of a mass")

    def test_warnings_show_values_as_they_are_typed(self):
        for text, value in ((rewritten(SI, IN_MM).replace("0.002*load", "0.002"), "0.002"), (SI.replace("2e-6*load", "2 um"), "2 um")):
            said = self.assert_completed(self.command("check", text)).said
            self.assertIn(f'support[1].displacement[1] = {value} does not depend on load', said)
            self.assertIn(f'write "{value}*load"', said)

    def test_the_warning_on_a_soft_body_names_the_units(self):
        said = self.assert_completed(self.command("check", rewritten(SI, IN_MM), "material.youngs_modulus=7e-4", "material.damage.law=none")).said
        self.assertIn("youngs_modulus = 700 Pa is softer than any solid", said)
        self.assertIn("in SI units, or in those of [units]", said)

    def test_symbols_lead_to_their_keys(self):
        for line, key in (("E = 70e9", "youngs_modulus"), ("nu = 0.3", "poisson_ratio"), ("rho = 2500", "density"),
                          ("alpha = 1e-5", "thermal_expansion"), ("G_c = 10", "material.damage.fracture_energy"),
                          ("f_t = 3e6", "material.damage.strength"), ("K_Ic = 1e6", "material.damage.fracture_toughness")):  # fmt: skip
            with self.subTest(line):
                run = self.command("check", SI.replace("density = 2500.0", line))
                self.assert_refused(run, "unknown key; the key is " + key)
        run = self.command("check", SI.replace("fracture_toughness", "KIc"))
        self.assert_refused(run, "material.damage.KIc", "the key is fracture_toughness")

    def test_check_prints_toughness_and_fracture_energy(self):
        said = self.assert_completed(self.command("check", SI)).said
        self.assertIn("toughness   800000 Pa sqrt(m): fracture energy 9.14286 J/m2 by a modulus of 7e+10 Pa", said)
        self.assertIn("fracture energy 9.14286 J/m2", said.split("fracture    ")[1])


if __name__ == "__main__":
    unittest.main()
