"""Data of points and tables of files in expressions, compared with the same values typed in; loads over time."""

import unittest

import h5py
import numpy

from tests.acceptance.folder import Folder
from tests.acceptance.motions import columns as history_of
from tests.reference.results import Results

# Places in the columns, exactly: products of them are the same numbers in Python and in the program.
RANDOM = numpy.random.default_rng(7)
PLACES = numpy.stack(numpy.meshgrid(numpy.arange(9.0), numpy.arange(6.0), indexing="ij"), -1).reshape(-1, 2)
PLACES = PLACES + RANDOM.uniform(-0.2, 0.2, PLACES.shape)

CLOUD = """
dimension = 2
[points]
file = "points.csv"
horizon = 2.5
[material]
youngs_modulus = 1e3
density = 1.0
thermal_expansion = 1e-3
[[set]]
name = "left"
where = "x < 1.4"
[[set]]
name = "right"
where = "{right}"
"""
STILL = """
[[material.scatter]]
of = "stiffness"
factor = "1 + {xy}/80"
[temperature]
change = "10*{xy}*load"
[[eigenstrain]]
set = "right"
strain = "1e-3*{x}"
[[support]]
set = "left"
displacement = [0, "1e-3*{x}*load"]
[[load]]
set = "right"
body_force = ["{xy}*load", "-{x}"]
[[foundation]]
name = "ground"
set = "right"
stiffness = [10.0, 5.0]
displacement = ["0.01*{xy}*load", 0]
[loading]
steps = 2
[[probe]]
name = "error"
set = "right"
field = "displacement"
statistic = "rms_error"
expected = ["{xy}", "{x}"]
"""
MOVING = """
[[initial]]
displacement = ["1e-3*{xy}", 0]
velocity = ["0.1*{x}", "-1e-2*{xy}"]
[[absorbing]]
set = "right"
rate = "0.1*{x}"
[[support]]
set = "left"
displacement = [0, "1e-3*{xy}*sin(t)"]
[solver]
mode = "dynamics"
[dynamics]
end_time = 0.5
"""
TYPED = {"x": "x", "xy": "(x*y)", "right": "x > 6.5"}
NAMED = {"x": "copy_of_x", "xy": "product", "right": "is_right > 0.5"}

STRIP = """
dimension = 1
[lattice]
spacing = 0.1
[[lattice.shape]]
add = "box"
min = [0]
max = [2]
[[lattice.layer]]
name = "left"
side = "x-"
[[lattice.layer]]
name = "right"
side = "x+"
[material]
youngs_modulus = 1.0
density = 1.0
[[support]]
set = "left"
displacement = [0]
"""
PULLED = STRIP + """
[[support]]
set = "right"
displacement = ['{value}']
[loading]
steps = 8
"""
SHAKEN = STRIP + """
[[support]]
set = "right"
displacement = ['{value}']
[solver]
mode = "dynamics"
[dynamics]
end_time = 2.0
time_step = 0.03125
"""
POLYGON = "1e-3*({0} < 0.5 ? 2*{0} : {0} < 0.75 ? 1 : 4 - 4*{0})"
AMPLITUDE = "# from a measurement\ntime, other, u\n0, 7, 0\n0.5, 7, 1\n0.75, 7, 1\n1, 7, 0\n2, 7, -4\n"


def data_of(folder, *names):
    with h5py.File(folder / "results.h5") as file:
        found = {}
        file["steps"].visititems(lambda name, item: found.update({name: item[...]}) if isinstance(item, h5py.Dataset) else None)
        return found


class Columns(Folder):
    def write_points(self, order=slice(None)):
        lines = ["copy_of_x, x, y, product, volume, is_right"]
        for x, y in PLACES[order].tolist():
            lines.append(", ".join(map(repr, (x, x, y, x * y, 1.0, float(x > 6.5)))))
        self.write("points.csv", "\n".join(lines) + "\n")

    def expect_same(self, one, other):
        one, other = data_of(one), data_of(other)
        self.assertEqual(one.keys(), other.keys())
        self.assertGreater(len(one), 5)
        for name in one:
            numpy.testing.assert_array_equal(one[name], other[name], name)

    def test_columns_equal_what_is_typed(self):
        """To the last bit, in any order of the points; in equilibrium and in motion."""
        for name, rest in (("still", STILL), ("moving", MOVING)):
            with self.subTest(name):
                self.write_points()
                typed = self.run_case((CLOUD + rest).format(**TYPED), name=f"{name}_typed")
                named = self.run_case((CLOUD + rest).format(**NAMED), name=f"{name}_named")
                self.expect_same(typed, named)
                self.assertGreater(numpy.abs(Results(named).steps[-1].displacement).max(), 1e-3)
                self.write_points(RANDOM.permutation(len(PLACES)))
                self.expect_same(typed, self.run_case((CLOUD + rest).format(**NAMED), name=f"{name}_mixed"))

    def test_results_have_the_columns(self):
        self.write_points()
        folder = self.run_case((CLOUD + STILL).format(**NAMED))
        with h5py.File(folder / "results.h5") as file:
            places = file["points/reference"][...]
            self.assertEqual(set(file["points/columns"]), {"copy_of_x", "product", "is_right"})
            numpy.testing.assert_array_equal(file["points/columns/product"][...], places[:, 0] * places[:, 1])
            numpy.testing.assert_array_equal(file["points/stiffness_factor"][...], 1 + places[:, 0] * places[:, 1] / 80)
        self.assertIn("columns     copy_of_x, is_right, product", self.peristat("check", self.folder / "case.toml").output)

    def test_images_have_the_columns_of_their_sources(self):
        """Half a body with a plane of symmetry, in which a column has the values of the whole one."""
        whole = CLOUD.split("[[set]]")[0] + """
[[material.scatter]]
of = "stiffness"
factor = "1 + warm"
[[eigenstrain]]
strain = "1e-3*warm"
"""
        half = whole + '[[symmetry]]\naxis = "x"\n'
        places = numpy.array([(x, y) for x in (0.5, 1.5, 2.5, 3.5) for y in (0.0, 1.0, 2.0)])
        displacement = {}
        for name, points, text in (("whole", numpy.concatenate([places, places * [-1, 1]]), whole), ("half", places, half)):
            rows = [f"{x},{y},1,{abs(x) * y / 7}" for x, y in points.tolist()]
            self.write("points.csv", "\n".join(["x,y,volume,warm", *rows]) + "\n")
            foot = '[[set]]\nname = "foot"\nwhere = "y < 0.5"\n[[support]]\nset = "foot"\ndisplacement = [0, 0]\n'
            results = self.results(text + foot, name=name)
            at = {tuple(place): u for place, u in zip(results.reference.tolist(), results.steps[-1].displacement)}
            displacement[name] = numpy.array([at[tuple(place)] for place in places.tolist()])
        self.assertGreater(numpy.abs(displacement["half"]).max(), 1e-4)
        numpy.testing.assert_allclose(displacement["half"], displacement["whole"], rtol=0, atol=1e-14)

    def test_factors_of_strength(self):
        """A bar breaks where its column says that it is weak."""
        rows = [f"{x + 0.5},1,{0.5 if x == 13 else 1.0}" for x in range(20)]
        self.write("points.csv", "\n".join(["x,volume,strength", *rows]) + "\n")
        text = """
dimension = 1
[points]
file = "points.csv"
horizon = 1.5
[material]
youngs_modulus = 1.0
damage = { law = "critical_stretch", critical = 0.01 }
[[material.scatter]]
of = "strength"
factor = "strength"
[[set]]
name = "left"
where = "x < 2"
[[set]]
name = "right"
where = "x > 18"
[[support]]
set = "left"
displacement = [0]
[[support]]
set = "right"
displacement = ["0.15*load"]
[loading]
steps = 10
[solver]
mode = "relaxation"
[relaxation]
steps = 10
"""
        results = self.results(text)
        damaged = results.reference[results.steps[-1].damage > 0, 0]
        self.assertTrue(13.5 in damaged and len(damaged) in (2, 3), damaged)
        self.assertEqual(results.factors["strength"][13], 0.5)

    def test_the_tangent_with_given_factors(self):
        self.write_points()
        ended = self.assert_completed(self.command("check-tangent", (CLOUD + STILL).format(**NAMED)))
        self.assertIn('"tangent_order"', ended.output)

    def test_refused_columns(self):
        self.write_points()
        text = (CLOUD + STILL).format(**NAMED)
        for old, new, *said in (
            ("1e-3*copy_of_x*load", "1e-3*copy_of_y*load", "copy_of_y", "copy_of_x, is_right, product", "did you mean copy_of_x?"),
            ('body_force = ["product*load", "-copy_of_x"]', 'total_force = ["product*load", "0"]', "load[0].total_force[0]",
             "column product has a value at each point, but this number does not belong to a point"),
            ('factor = "1 + product/80"', 'factor = "product"', "scatter[0].factor", "a factor must be from 1e-6 to 1e6"),
            ('factor = "1 + product/80"', 'factor = "1"\nseed = 3', "seed", "leave it out if factor is given"),
            ('factor = "1 + product/80"', 'factor = "load"', "unknown variable load"),
            ('of = "stiffness"', 'of = "strength"', "strength needs a law of damage"),
            ("is_right > 0.5", "1/(is_right - 1)", "set[1].where", "inf"),
        ):  # fmt: skip
            with self.subTest(new=new):
                self.assertIn(old, text)
                errors = self.refusal(text.replace(old, new))
                for fragment in ("case.toml:", *said):
                    self.assertIn(fragment, errors)
        lattice = self.refusal(PULLED.replace("{value}", "product*load"))
        self.assertIn("unknown variable product; allowed are x, load", lattice)
        text = (CLOUD + STILL).format(**TYPED)
        for header, value, said in (("t", "1", "points.csv:1: the name 't' of a column already has another meaning"), ("sin", "1", "points.csv:1"),
                                    ("horizon", "1", "points.csv:1: the name 'horizon' of a column already has another meaning"),
                                    ("a b", "1", "points.csv:1: the name 'a b'"), ("T", "inf", "points.csv:2: T = 'inf' is not finite"),
                                    ("T", "hot", "points.csv:2"), ("T", "", "points.csv:2")):  # fmt: skip
            with self.subTest(header=header, value=value):
                self.write("points.csv", f"x,y,volume,{header}\n0,0,1,{value}\n1,0,1,1\n")
                self.assertIn(said, self.refusal(text))

    def test_a_resumed_run_needs_the_same_columns(self):
        self.write_points()
        self.run_case((CLOUD + MOVING).format(**NAMED), name="out")
        self.resume("out", "dynamics.end_time=0.6")
        rows = (self.folder / "points.csv").read_text().split("\n")
        rows[5] = rows[5].replace(rows[5].split(", ")[0], "0.125", 1)  # of copy_of_x alone
        self.write("points.csv", "\n".join(rows))
        ended = self.resume("out", "dynamics.end_time=0.7", code=2)
        self.assertIn("points.csv: has changed since the run began", ended.errors)


class Tables(Folder):
    def test_a_table_equals_its_polygon(self):
        """To the last bit where the arithmetic is exact."""
        self.write("data/amplitude.csv", AMPLITUDE)
        typed = self.run_case(PULLED.format(value=POLYGON.format("load")), name="typed")
        table = PULLED.format(value='1e-3*table("data/amplitude.csv", "u", load)')
        read = self.run_case(table, name="read")
        displacements = [[step.displacement for step in Results(folder).steps] for folder in (typed, read)]
        numpy.testing.assert_array_equal(*displacements)
        self.assertGreater(numpy.abs(displacements[0]).max(), 9e-4)
        for case in (f"{self.folder}/case.toml", "case.toml"):  # from elsewhere, too
            ended = self.peristat("check", case, folder=self.folder if case == "case.toml" else "/")
            self.assert_completed(ended)
        # The resolved case is complete: it may be moved.
        with h5py.File(read / "results.h5") as file:
            resolved = file["case/as_resolved"].asstr()[()]
            self.assertIn("amplitude.csv", file["case/files"].asstr()[()])
        moved = self.run_case(self.write("elsewhere/case.toml", resolved), name="moved")
        numpy.testing.assert_array_equal(displacements[1], [step.displacement for step in Results(moved).steps])

    def test_a_table_in_motion_and_of_place(self):
        self.write("amplitude.csv", AMPLITUDE)
        polygon = "1e-3*(t < 0.5 ? 2*t : t < 0.75 ? 1 : 4 - 4*t)"
        initial = '[[initial]]\nvelocity = ["{}"]\n'
        typed = self.run_case(SHAKEN.format(value=polygon) + initial.format(polygon.replace("t", "x/2")), name="typed")
        text = SHAKEN.format(value='1e-3*table("amplitude.csv", "u", t)')
        text += initial.format("table('amplitude.csv', 'u', min(max(x, 0), 2)/2)*1e-3")
        read = self.run_case(text, name="read")
        one, other = (Results(folder).steps[-1].displacement for folder in (typed, read))
        self.assertGreater(numpy.abs(one).max(), 1e-3)
        numpy.testing.assert_allclose(one, other, rtol=0, atol=1e-16)

    def test_loads_over_time(self):
        """The expressions of a quasi-static case, in motion."""
        for newmark in ("", 'scheme = "newmark"\n'):
            with self.subTest(newmark):
                text = SHAKEN.replace("time_step", newmark + "time_step")
                typed = text.format(value=POLYGON.format("t")) + '[[load]]\nset = "right"\nbody_force = ["1e-3*t/2"]\n'
                typed = typed.replace('set = "right"\nbody', 'set = "inner"\nbody') + '[[set]]\nname = "inner"\nwhere = "x > 1"\n'
                tables = "[loading]\ntable = [[0, 0], [0.5, 1], [0.75, 1], [2, -4]]\ntable2 = [[0, 0], [4, 2]]\n"
                named = typed.replace(POLYGON.format("t"), "1e-3*load").replace("1e-3*t/2", "1e-3*load2") + tables
                one, other = (self.run_case(case, name=name) for name, case in (("one", typed), ("other", named)))
                self.assertEqual(list(history_of(one)), list(history_of(other)))
                u, v = (Results(folder).steps[-1].displacement for folder in (one, other))
                self.assertGreater(numpy.abs(u).max(), 1e-3)
                numpy.testing.assert_allclose(u, v, rtol=0, atol=1e-15)
                with h5py.File(other / "results.h5") as file:
                    resolved = file["case/as_resolved"].asstr()[()]
                again = Results(self.run_case(resolved, name="again")).steps[-1].displacement
                numpy.testing.assert_array_equal(v, again)

    def test_refused_loads_over_time(self):
        text = SHAKEN.format(value="1e-3*load") + "[loading]\ntable = {}\n"
        for table, *said in (
            ("[[0, 0], [1, 1]]", "dynamics.end_time = 2", "ends before the motion"),
            ("[[0, 0]]", "loading.table", "at least two pairs"),
            ("[[0.5, 0], [2, 1]]", "loading.table", "must begin at the time 0"),
            ("[[0, 0], [2, 1], [1, 1]]", "loading.table", "the times of a table ascend"),
            ("[0, 1]", "loading.table[0]", "must be one of the pairs"),
            ('"t"', "loading.table", "in mode dynamics a table has pairs"),
            ("[[0, 0], [2, 1]]\ntable3 = [[0, 0], [2, 1]]", "loading.table2", "is missing"),
            ("[[0, 0], [2, 1]]\ntable2 = [[0, 0], [2, 1]]", "loading.table2", "no displacement and no load uses"),
            ("[[0, 0], [2, 1]]\nsteps = 4", "loading.steps", "only tables over time"),
        ):
            with self.subTest(table=table):
                errors = self.refusal(text.replace("{}", table))
                for fragment in said:
                    self.assertIn(fragment, errors)
        self.assertIn("unknown variable load", self.refusal(SHAKEN.format(value="1e-3*load")))
        still = PULLED.format(value="1e-3*load").replace("steps = 8", "table = [[0, 0], [1, 1]]")
        self.assertIn("loading.table[0]", self.refusal(still))

    def test_refused_tables(self):
        self.write("amplitude.csv", AMPLITUDE)
        self.write("bad.csv", "0 1\n1 2\n1 3\n")
        for value, *said in (
            ('table("missing.csv", load)', "no such file", "missing.csv"),
            ('table("bad.csv", load)', "bad.csv:3", "must ascend"),
            ('table("amplitude.csv", load)', "amplitude.csv:2", "3 columns"),
            ('table("amplitude.csv", "v", load)', "amplitude.csv:2", "no column 'v'"),
            ('table("amplitude.csv", "u", 3*load)', "goes from 0 to 2", "load = 1"),
            ('table(load, load)', "name of a file in quotes"),
            ('"load"', "quotes are only for"),
            ('table("amplitude.csv", "u)', "this quote is not closed"),
            ('table(".", load)', "no such file"),
        ):
            with self.subTest(value=value):
                errors = self.refusal(PULLED.format(value=value))
                for fragment in ("case.toml:", "support[1].displacement[0]", *said):
                    self.assertIn(fragment, errors)

    def test_a_load_whose_table_is_too_short_is_refused_before_the_run(self):
        self.write("amplitude.csv", AMPLITUDE)
        text = SHAKEN.format(value="0") + "[[load]]\nset = 'right'\nbody_force = [\"table('amplitude.csv', 'u', 2*t)\"]\n"
        self.assertIn("load[0].body_force[0]", self.refusal(text))
        self.assertIn("goes from 0 to 2, but its value at 4 is needed", self.ended.errors)

    def test_a_resumed_run_needs_the_same_table(self):
        self.write("amplitude.csv", AMPLITUDE)
        text = SHAKEN.format(value='1e-3*table("amplitude.csv", "u", t)').replace("end_time = 2.0", "end_time = 1.0")
        self.run_case(text)
        whole = self.run_case(text, "dynamics.end_time=2.0", name="whole")
        self.write("amplitude.csv", AMPLITUDE.replace("-4", "-5"))
        ended = self.resume("out", "dynamics.end_time=2.0", code=2)
        self.assertIn("amplitude.csv: has changed since the run began", ended.errors)
        self.write("amplitude.csv", AMPLITUDE)
        self.resume("out", "dynamics.end_time=2.0")
        self.resume("out", "dynamics.end_time=2.0")  # at its end
        numpy.testing.assert_array_equal(*(Results(folder).steps[-1].displacement for folder in (self.folder / "out", whole)))

    def test_loads_over_time_may_be_extended(self):
        text = SHAKEN.format(value="1e-3*load").replace("end_time = 2.0", "end_time = 1.0") + "[loading]\ntable = [[0, 0], [1, 1]]\n"
        self.run_case(text)
        longer = ("dynamics.end_time=2.0", "loading.table=[[0, 0], [1, 1], [2, -1]]")
        whole = self.run_case(text, *longer, name="whole")
        ended = self.resume("out", "dynamics.end_time=2.0", "loading.table=[[0, 0], [0.5, 1], [2, -1]]", code=2)
        self.assertIn("the loads at 1 s have changed", ended.errors)
        self.resume("out", *longer)
        numpy.testing.assert_array_equal(*(Results(folder).steps[-1].displacement for folder in (self.folder / "out", whole)))

    def test_the_inputs_of_a_run_are_kept(self):
        self.write("amplitude.csv", AMPLITUDE)
        text = PULLED.format(value='1e-3*table("amplitude.csv", "u", load)')
        ended = self.execute(self.words_of_run(text, words=("--log", "amplitude.csv")))
        self.assert_refused(ended, "is an input of the run")
        self.assertEqual((self.folder / "amplitude.csv").read_text(), AMPLITUDE)


if __name__ == "__main__":
    unittest.main()
