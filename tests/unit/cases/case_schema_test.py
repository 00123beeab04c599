"""docs/case.schema.json is the output of `peristat schema`, and has what the key tables say.

    PERISTAT_PROGRAM=build/release/peristat /usr/bin/python3 -BEs tests/unit/cases/case_schema_test.py --write

rewrites it after a key has changed. tests/acceptance/taplo_test.py checks cases by it.
"""

import json
import os
import pathlib
import re
import subprocess
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
FILE = ROOT / "docs/case.schema.json"
PROGRAM = os.environ["PERISTAT_PROGRAM"]
HEADING = re.compile(r"^(?:(The document)|\[+([\w.]+)\]+)\n\n", re.MULTILINE)
TYPES = {"string": str, "boolean": bool, "integer": int, "number": (int, float)}


def printed(command):
    return subprocess.run([PROGRAM, command], capture_output=True, text=True, timeout=60, check=True).stdout


def keys_by_table():
    """Names of the keys in each table that `peristat keys` prints; the document's table is empty."""
    _, *parts = HEADING.split(printed("keys"))
    return {parts[k + 1] or "": re.findall(r"^\| `(\w+)` \|", parts[k + 2], re.MULTILINE) for k in range(0, len(parts), 3)}


def inner(schema):
    """The table that a key has, may have, or that the items of its array are; none for a value."""
    tables = (one.get("items", one) for one in schema.get("anyOf", [schema]))
    return next((table for table in tables if "properties" in table), None)


def values(table, path=""):
    """Dotted names and schemas of all keys that have values."""
    for name, schema in table["properties"].items():
        if inner(schema):
            yield from values(inner(schema), f"{path}{name}.")
        else:
            yield path + name, schema


class CaseSchema(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.text = printed("schema")
        cls.schema = json.loads(cls.text)

    def table(self, name):
        schema = self.schema
        for part in filter(None, name.split(".")):
            schema = inner(schema["properties"][part])
        return schema

    def test_the_file_is_what_the_program_prints(self):
        command = f"PERISTAT_PROGRAM={PROGRAM} /usr/bin/python3 -BEs {pathlib.Path(__file__).relative_to(ROOT)} --write"
        # not assertEqual, which compares texts of thousands of lines for minutes
        self.assertTrue(FILE.read_text() == self.text, f"{FILE.name} is out of date; write it anew by\n{command}")
        self.assertLess(len(self.text), 1_000_000)
        self.assertEqual(self.schema["$schema"], "http://json-schema.org/draft-07/schema#")

    def test_has_every_key_of_every_table_and_no_other(self):
        tables = keys_by_table()
        self.assertGreater(sum(map(len, tables.values())), 200)
        for name, keys in tables.items():
            table = self.table(name)
            if keys:  # [set.shape] has tables only
                self.assertEqual(set(table["properties"]), set(keys), name)
            self.assertIs(table["additionalProperties"], False, name)
        for name in ("region.material", "interface.material", "region.material.damage"):
            self.assertEqual(set(self.table(name)["properties"]), set(tables[name.split(".", 1)[1]]), name)

    def test_every_value_has_a_type_a_description_and_a_default_of_its_type(self):
        count = 0
        for name, schema in values(self.schema):
            self.assertTrue(schema.keys() & {"type", "anyOf"}, name)
            self.assertTrue(schema["description"], name)
            self.assertNotIn("](", schema["description"], name)
            if "default" not in schema:
                continue
            count += 1
            allowed = schema.get("type", "number")
            types = [TYPES[one] for one in (allowed if isinstance(allowed, list) else [allowed])]
            self.assertTrue(any(isinstance(schema["default"], one) for one in types), name)
            self.assertIn(schema["default"], schema.get("enum", [schema["default"]]), name)
        self.assertGreater(count, 60)

    def test_gives_limits_choices_and_what_is_required(self):
        document, lattice = self.schema, self.table("lattice")
        self.assertEqual(document["required"], ["dimension"])
        self.assertEqual(document["oneOf"], [{"required": ["lattice"]}, {"required": ["points"]}])
        dimension = document["properties"]["dimension"]
        self.assertEqual((dimension["type"], dimension["minimum"], dimension["maximum"]), ("integer", 1, 3))
        self.assertEqual(lattice["required"], ["spacing", "shape"])
        self.assertEqual(lattice["properties"]["shape"]["minItems"], 1)
        perturbation = lattice["properties"]["perturbation"]
        self.assertEqual((perturbation["minimum"], perturbation["maximum"], perturbation["default"]), (0, 0.49, 0))
        modulus = self.table("material")["properties"]["youngs_modulus"]
        self.assertEqual((modulus["type"], modulus["exclusiveMinimum"]), (["number", "string"], 0))
        self.assertIn("[Pa]", modulus["description"])
        for text, is_quantity in {"210 GPa": 1, "2.5e-3mm": 1, "-1 N/m": 1, "5 °C": 1, "1e-5 1/K": 1, "GPa": 0, "210": 0, "2e3": 0, "1.5.2": 0}.items():
            self.assertEqual(bool(re.search(modulus["pattern"], text)), bool(is_quantity), text)
        self.assertIn("adaptive", self.table("solver")["properties"]["mode"]["enum"])
        vertices = self.table("set.shape.polygon")["properties"]["vertices"]
        self.assertEqual((vertices["minItems"], vertices["items"]["minItems"], vertices["items"]["maxItems"]), (3, 2, 2))


if __name__ == "__main__":
    if sys.argv[1:] == ["--write"]:
        FILE.write_text(printed("schema"))
    else:
        unittest.main()
