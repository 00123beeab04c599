"""Editors and type checkers know the package: its stubs say what it has, and mypy refuses what is wrong."""

import ast
import importlib.util
import inspect
import re
import subprocess
import sys
import tempfile
import unittest

from tests.reference.program import ROOT

PACKAGE = ROOT / "python/peristat"
sys.path.insert(0, str(ROOT / "python"))
import peristat as ps  # noqa: E402
from peristat._package import load_core  # noqa: E402

RIGHT = """
import numpy
import peristat as ps

case = ps.Case("strip", dimension=2)
case.lattice.spacing = "1 mm"
case.lattice.add_shape(add="box", min=[0, 0], max=numpy.array([0.05, 0.01])).name = "all"
case.material.damage.law = "critical_stretch"
case.add_support(set="left", displacement=[0, lambda load: 1e-3 * load, ps.Dial()])
case.solver = {"linear": "pcg"}
case.crack = [{"to": [0, 0]}]
case.crack[0].from_ = [1, 2]
case["set"][0]["where"] = "x < 0"
case.set("loading.steps", 50)
run: ps.Run = case.body().solve(mode="adaptive", on_step=lambda step: step.stop("enough"))
furthest: float = run.displacement().max()
for step in case.steps():
    loads: float = step.load + step.field("damage").max()
found: ps.Fit = ps.fit(case, "curve.csv", ["material.youngs_modulus"], start={"material.youngs_modulus": "70 GPa"}, jobs=2)
values: dict[str, float] = found.values
results: ps.Results = ps.open_results("results/strip")
print(results.history["load_factor"], ps.resume("results/strip", {"loading.steps": 3}).converged, ps.versions()["peristat"])
"""
WRONG = {
    "case.latice.spacing = 1": 'has no attribute "latice"',
    "case.latice = {}": 'has no attribute "latice"',
    "case.material.youngs_modulus = [1]": "Incompatible types in assignment",
    "case.lattice = 3": "Incompatible types in assignment",
    "case.add_support(sett='left')": 'Unexpected keyword argument "sett"',
    "case.solver.mode = 'newtn'": "Incompatible types in assignment",
    "case.check().warning": 'has no attribute "warning"',
    "next(case.steps()).displacment": 'has no attribute "displacment"',
    "case.solve().plot(3)": "incompatible type",
    "ps.load_cas('x.toml')": 'has no attribute "load_cas"',
}


def public(names):
    return {name for name in names if not name.startswith("_")}


class Types(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.cache = cls.enterClassContext(tempfile.TemporaryDirectory())  # of the types of NumPy

    def check(self, text):
        """What mypy says about a script, by line."""
        if importlib.util.find_spec("mypy") is None:
            self.skipTest("mypy is missing (apt install mypy)")
        command = [sys.executable, "-m", "mypy", "--strict", "--follow-imports=silent", "--cache-dir", self.cache, "-c", text]
        checked = subprocess.run(command, env={"MYPYPATH": str(PACKAGE.parent)}, capture_output=True, text=True)
        self.assertEqual(checked.stderr, "")
        self.assertLess(checked.returncode, 2, checked.stdout)
        return {int(line): said for line, said in re.findall(r"^<string>:(\d+): error: (.*)", checked.stdout, re.MULTILINE)}

    def test_a_right_script_is_accepted(self):
        self.assertEqual(self.check(RIGHT), {})

    def test_each_mistake_is_found(self):
        head = "import peristat as ps\ncase = ps.Case('a')\n"
        said = self.check(head + "\n".join(WRONG))
        for number, (line, expected) in enumerate(WRONG.items(), 3):
            self.assertIn(expected, said.get(number, ""), line)

    def test_the_stub_of_the_package_has_its_names(self):
        tree = ast.parse((PACKAGE / "__init__.pyi").read_text("utf-8"))
        names = {name.asname: one.module for one in tree.body if isinstance(one, ast.ImportFrom) for name in one.names}
        self.assertEqual(names, ps.NAMES)
        functions = {one.name for one in tree.body if isinstance(one, ast.FunctionDef)}
        self.assertEqual(functions, set(ps.__all__) - set(names))
        self.assertTrue((PACKAGE / "py.typed").is_file())

    def test_what_is_public_has_types_and_a_docstring(self):
        count = 0
        for name, module in ps.NAMES.items():
            found = next(
                one
                for file in (f"{module.replace('.', '/')}.py", "_core.pyi")  # of C++: Step
                for one in ast.parse((PACKAGE / file).read_text("utf-8")).body
                if isinstance(one, (ast.ClassDef, ast.FunctionDef)) and one.name == name
            )
            members = found.body if isinstance(found, ast.ClassDef) else [found]
            self.assertTrue(getattr(ps, name).__doc__, name)
            for one in members:
                if isinstance(one, ast.FunctionDef) and not one.name.startswith("_"):
                    count += 1
                    self.assertIsNotNone(one.returns, f"{module}.py: {name}.{one.name} has no type")
                    untyped = [a.arg for a in one.args.args + one.args.kwonlyargs if a.arg != "self" and a.annotation is None]
                    self.assertEqual(untyped, [], f"{module}.py: {name}.{one.name}")
        self.assertGreater(count, 40)

    def test_the_stub_of_the_compiled_part_has_what_it_has(self):
        core = load_core()
        tree = ast.parse((PACKAGE / "_core.pyi").read_text("utf-8"))
        stub = {one.name: one for one in tree.body if isinstance(one, (ast.ClassDef, ast.FunctionDef))}
        self.assertEqual(public(stub), public(dir(core)))
        parameters = lambda text: re.findall(r"(\w+): ", text.partition("(")[2].rpartition(" -> ")[0])
        for name, one in stub.items():
            compiled = getattr(core, name)
            if isinstance(one, ast.FunctionDef):
                self.assertEqual([a.arg for a in one.args.args], parameters(compiled.__doc__), name)
                continue
            members = {member.name: member for member in one.body if isinstance(member, ast.FunctionDef)}
            self.assertEqual(public(members), public(dir(compiled)), name)
            for key, member in members.items():
                if not member.decorator_list:
                    found = [a for a in parameters(getattr(compiled, key).__doc__)]
                    self.assertEqual([a.arg for a in member.args.args], found, f"{name}.{key}")
                elif inspect.getdoc(getattr(compiled, key)):
                    self.assertEqual(ast.get_docstring(member), inspect.getdoc(getattr(compiled, key)), f"{name}.{key}")


if __name__ == "__main__":
    unittest.main()
