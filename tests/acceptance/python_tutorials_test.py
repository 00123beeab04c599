"""Tutorials run as scripts, whose assertions compare with closed forms; the notebooks beside them have the same cells."""

import importlib.util
import os
import shutil
import sys
import unittest

import nbformat

from tests.acceptance.folder import Folder
from tests.reference.program import ROOT

TUTORIALS = ROOT / "docs/tutorials"
sys.path.insert(0, str(TUTORIALS))

import make  # noqa: E402

NEEDED = {"mesh_from_gmsh": "gmsh"}  # modules that the package itself does without
LARGEST = 300_000  # bytes of a notebook


class Tutorials(Folder):
    def test_runs(self):
        for name in make.names():
            with self.subTest(name):
                if name in NEEDED and importlib.util.find_spec(NEEDED[name]) is None:
                    self.skipTest(f"Python's {NEEDED[name]} is missing; install python3-{NEEDED[name]}")
                shutil.copy(TUTORIALS / f"{name}.py", self.folder)
                path = os.pathsep.join(filter(None, [str(make.PACKAGE), os.environ.get("PYTHONPATH")]))
                environment = {"PYTHONPATH": path, "MPLBACKEND": "Agg"}
                self.assert_completed(self.execute(["/usr/bin/python3", f"{name}.py"], environment=environment))

    def test_notebook_has_the_cells_of_its_source(self):
        for name in make.names():
            with self.subTest(name):
                written = nbformat.read(TUTORIALS / f"{name}.ipynb", 4)
                nbformat.validate(written)
                told = "is of another text: docs/tutorials/make.py makes it anew"
                self.assertEqual(_cells(written), _cells(make.notebook(name)), f"{name}.ipynb {told}")

    def test_notebook_is_small_and_of_no_machine(self):
        for name in make.names():
            with self.subTest(name):
                path = TUTORIALS / f"{name}.ipynb"
                self.assertLess(path.stat().st_size, LARGEST)
                outputs = [output for cell in nbformat.read(path, 4).cells for output in cell.get("outputs", [])]
                self.assertTrue(any("image/png" in output.get("data", {}) for output in outputs))
                for output in outputs:
                    self.assertNotEqual(output.output_type, "error")
                    self.assertNotRegex(output.get("text", ""), r"(^|[\s'\"])/\w|\d threads|completed in")

    def test_page_lists_the_tutorials(self):
        page = (TUTORIALS / "README.md").read_text("utf-8")
        for name in make.names():
            self.assertIn(f"({name}.ipynb)", page)


def _cells(notebook):
    return [(cell.cell_type, cell.source) for cell in notebook.cells]


if __name__ == "__main__":
    unittest.main()
