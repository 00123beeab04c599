"""The library: the page quotes the example, which is built against an installed peristat and gives
the same results as the case."""

import os
import pathlib
import re
import shutil
import tempfile
import unittest

from tests.acceptance.folder import Folder
from tests.reference.program import PROGRAM, ROOT, execute
from tests.reference.results import table

EXAMPLES = ROOT / "docs/examples"
THE_SAME_CASE = """
dimension = 2
[lattice]
spacing = 1e-3
horizon_ratio = 3.015
thickness = 1e-3
[[lattice.shape]]
add = "box"
min = [-0.075, -0.025]
max = [0.075, 0.025]
[[lattice.shape]]
subtract = "disk"
centre = [0.0, 0.0]
radius = 5e-3
[[lattice.layer]]
name = "left"
side = "x-"
[[lattice.layer]]
name = "right"
side = "x+"
[material]
model = "bond"
youngs_modulus = 192e9
[[support]]
set = "left"
displacement = [0.0, 0.0]
[[load]]
set = "right"
total_force = ["12.8e3*load", "0"]
[loading]
steps = 2
[[probe]]
name = "end"
set = "right"
field = "displacement"
[[probe]]
name = "above_hole"
at = [0.0, 5.5e-3]
field = "stress"
component = "xx"
"""
# Follows a case file and prints its probes.
READER = """
#include <cstdio>
#include <peristat/peristat.hpp>
using namespace peristat;
int main(int, char** arguments) {
  const Case from = read_case(arguments[1]);
  const auto body = make_body(from, 2);
  const StudyResult result = solve(*body, study_options(from, 2));
  Observation observed(*body, result.state);
  for (const ProbeSpecification& probe : from.probes) std::printf("%.17g\\n", probe_values(probe, observed)[0]);
}
"""
# Another program with its own src/, and in it a header with the name of one of ours.
OTHERS_POINTS = "#error the program's own header was taken for peristat's\n"


def run(*command, **options):
    ended = execute(command, seconds=600, limited=False, **options)
    assert ended.code == 0, f"{command} ends with {ended.code}:\n{ended.said}"
    return ended.output


class Library(Folder):
    @classmethod
    def setUpClass(cls):
        cls.prefix = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory(prefix="peristat library ")))
        run("cmake", "--install", pathlib.Path(PROGRAM).parent, "--prefix", cls.prefix)

    def build(self, source, build):
        compiler = os.environ.get("PERISTAT_CXX", "c++")
        run("cmake", "-S", source, "-B", build, f"-DCMAKE_PREFIX_PATH={self.prefix}",
            f"-DCMAKE_CXX_COMPILER={compiler}", "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Werror")  # fmt: skip
        run("cmake", "--build", build)

    def test_the_page_quotes_the_example(self):
        page = (ROOT / "docs/library.md").read_text("utf-8")
        for language, file in (("cpp", "plate.cpp"), ("cmake", "CMakeLists.txt")):
            quoted = re.findall(rf"```{language}\n(.*?)```", page, re.DOTALL)
            self.assertIn((EXAMPLES / file).read_text("utf-8"), quoted)

    def test_the_example_gives_what_the_case_gives(self):
        self.build(EXAMPLES, self.folder / "build")
        told = run(self.folder / "build/plate", environment={"OMP_NUM_THREADS": "2", "OMP_WAIT_POLICY": "passive"})
        displacement, reaction, stress = (float(value) for value in re.findall(r"(\S+) (?:m|N|Pa)\n", told))

        # The installed program finds its module in the same prefix.
        results = self.folder / "results"
        run(self.prefix / "bin/peristat", "run", self.case(THE_SAME_CASE), "--output", results, "--threads", 2)
        last = table(results / "history.csv")[-1]
        # The same computation: only the number of printed digits differs.
        self.assertAlmostEqual(displacement / last["end_x"], 1.0, delta=1e-12)
        self.assertAlmostEqual(reaction / last["reaction_x:left"], 1.0, delta=1e-12)
        self.assertAlmostEqual(stress / last["above_hole"], 1.0, delta=1e-12)
        # F L / (E w h) of the plate without its hole; the hole and the ends, which are pulled across three rows, make
        # it softer by a tenth or so.
        whole = 12.8e3 * 0.15 / (192e9 * 0.05 * 1e-3)
        self.assertAlmostEqual(displacement / whole, 1.1, delta=0.1)

    def test_a_case_file_is_read(self):
        shutil.copytree(EXAMPLES, self.folder / "reader")
        (self.folder / "reader/plate.cpp").write_text(READER, "utf-8")
        self.build(self.folder / "reader", self.folder / "reader_build")
        environment = {"OMP_NUM_THREADS": "2", "OMP_WAIT_POLICY": "passive"}
        told = run(self.folder / "reader_build/plate", self.case(THE_SAME_CASE), environment=environment)
        run(self.prefix / "bin/peristat", "run", self.case(THE_SAME_CASE), "--output", self.folder / "read", "--threads", 2)
        last = table(self.folder / "read/history.csv")[-1]
        for value, name in zip(told.split(), ("end_x", "above_hole"), strict=True):
            self.assertAlmostEqual(float(value) / last[name], 1.0, delta=1e-12)

    def test_headers_do_not_collide_with_a_program_s_own(self):
        source = self.folder / "other"
        self.write("other/src/geometry/points.hpp", OTHERS_POINTS)
        shutil.copy(EXAMPLES / "CMakeLists.txt", source)
        with open(source / "CMakeLists.txt", "a", encoding="utf-8") as file:
            file.write("target_include_directories(plate BEFORE PRIVATE ${CMAKE_SOURCE_DIR})\n")
        (source / "plate.cpp").write_text(
            "#include <peristat/src/geometry/points.hpp>\nint main() { return peristat::Points().count(); }\n"
        )
        self.build(source, self.folder / "other_build")
        run(self.folder / "other_build/plate")

    def test_a_wrong_value_is_told_in_words(self):
        source = self.folder / "wrong"
        shutil.copytree(EXAMPLES, source)
        text = (source / "plate.cpp").read_text("utf-8").replace("horizon = 3.015e-3", "horizon = 3.015e-4")
        (source / "plate.cpp").write_text(text, "utf-8")
        self.build(source, self.folder / "wrong_build")
        ended = self.execute([self.folder / "wrong_build/plate"])
        self.assert_refused(ended, "horizon = 0.0003015: horizon smaller than the mean spacing")
        self.assertEqual(ended.output, "")


if __name__ == "__main__":
    unittest.main()
