"""Everything that a case file can say can be said in Python, by one table of keys: the schema's."""

import contextlib
import keyword
import os
import pathlib
import sys
import tempfile
import tomllib
import unittest

from tests.reference.program import ROOT

sys.path.insert(0, str(ROOT / "python"))
import peristat as ps  # noqa: E402
from peristat import _schema, tables  # noqa: E402

CASES = sorted((ROOT / "cases").rglob("*.toml"))


def attribute(name):
    return name + "_" if keyword.iskeyword(name) else name


def fill(table, values):
    """Sets keys as a script does, by attributes and by `add_` for arrays of tables."""
    for name, value in values.items():
        schema = table._schema["properties"][name]
        if _schema.is_array_of_tables(schema):
            for one in value:
                fill(getattr(table, f"add_{name}")(), one)
        elif _schema.is_table(schema):
            fill(getattr(table, name), value)
        else:
            setattr(table, attribute(name), value)


def leaves(values, schema, path=""):
    """Dotted keys and values, as `--set` names them."""
    for name, value in values.items():
        inner, key = schema["properties"][name], path + name
        if _schema.is_array_of_tables(inner):
            for k, one in enumerate(value):
                yield from leaves(one, inner["items"], f"{key}[{k}].")
        elif _schema.is_table(inner):
            yield from leaves(value, inner, f"{key}.")
        else:
            yield key, value


def every_table(schema, path=""):
    """Dotted names and schemas of all tables; the document's name is empty."""
    yield path, schema
    for name, inner in schema["properties"].items():
        inner = inner["items"] if _schema.is_array_of_tables(inner) else inner
        if _schema.is_table(inner):
            yield from every_table(inner, f"{path}.{name}" if path else name)


def table_of(path):
    """A table of a new case, by attributes and `add_`."""
    table = ps.Case("keys")
    del table.title
    for name in filter(None, path.split(".")):
        is_array = _schema.is_array_of_tables(table._schema["properties"][name])
        table = getattr(table, f"add_{name}")() if is_array else getattr(table, name)
    return table


class Keys(unittest.TestCase):
    def assert_same(self, case, of_file, file):
        """The same values in force; the default of output.directory comes from the name of the file."""
        told, expected = tomllib.loads(case.resolved()), tomllib.loads(of_file.resolved())
        if of_file.get("output.directory") is None:
            del told["output"]["directory"], expected["output"]["directory"]
        self.assertEqual(told, expected, file)

    def test_every_shipped_case_can_be_said_by_attributes(self):
        self.assertGreater(len(CASES), 40)
        for file in CASES:
            with self.subTest(case=str(file.relative_to(ROOT))), contextlib.chdir(file.parent):
                case = ps.Case(file.stem)
                fill(case, tomllib.loads(file.read_text("utf-8")))
                self.assert_same(case, ps.load_case(file), file)

    def test_every_shipped_case_can_be_said_by_a_dict_and_saved(self):
        with tempfile.TemporaryDirectory() as folder:
            for file in CASES:
                with self.subTest(case=str(file.relative_to(ROOT))), contextlib.chdir(file.parent):
                    values = tomllib.loads(file.read_text("utf-8"))
                    case = ps.Case(file.stem, **values)
                    self.assertEqual(case.plain(), values)
                    saved = pathlib.Path(folder, f"{len(os.listdir(folder))}.toml")
                    case.save(saved)
                    self.assertEqual(tomllib.loads(saved.read_text("utf-8")), values)

    def test_every_value_of_the_shipped_cases_can_be_set(self):
        count = 0
        for file in CASES:
            with self.subTest(case=str(file.relative_to(ROOT))):
                case, of_file = ps.load_case(file), ps.load_case(file)
                for key, value in leaves(tomllib.loads(file.read_text("utf-8")), _schema.document()):
                    self.assertEqual(case.get(key), value, key)
                    case.set(key, value)
                    count += 1
                self.assert_same(case, of_file, file)
        self.assertGreater(count, 1000)

    def test_every_key_of_the_schema_is_taken_and_a_misspelt_one_refused(self):
        count = 0
        for path, schema in every_table(_schema.document()):
            for name, inner in schema["properties"].items():
                key = f"{path}.{name}" if path else name
                with self.subTest(key=key):
                    count += 1
                    table = table_of(path)
                    if _schema.is_array_of_tables(inner):
                        self.assertIsInstance(getattr(table, f"add_{name}")(), tables.Table)
                        self.assertEqual(table.plain(), {name: [{}]})
                    elif _schema.is_table(inner):
                        self.assertIsInstance(getattr(table, name), tables.Table)
                    else:
                        setattr(table, attribute(name), 1)
                        self.assertEqual((table.plain(), getattr(table, attribute(name))), ({name: 1}, 1))
                    self.assertIn(name, dir(table))
                    for refused in (lambda: setattr(table, name + name[-1], 1), lambda: table.update({name + name[-1]: 1})):
                        with self.assertRaises(ps.InputError) as error:
                            refused()
                        self.assertIn(f"did you mean {name}?", str(error.exception))
        self.assertGreater(count, 300)

    def test_one_key_alone_has_the_name_of_a_method(self):
        """`case["set"]` and `case.add_set` remain for it."""
        hidden = [f"{path}.{name}" for path, schema in every_table(_schema.document()) for name in schema["properties"]
                  if hasattr(tables.Table if path else ps.Case, name)]  # fmt: skip
        self.assertEqual(hidden, [".set"])
        case = ps.Case("sets")
        case.add_set(name="left", where="x < 0")
        self.assertEqual(case["set"].plain(), [{"name": "left", "where": "x < 0"}])

    def test_words_of_python_get_an_underscore(self):
        words = {name for _, schema in every_table(_schema.document()) for name in schema["properties"] if keyword.iskeyword(name)}
        self.assertEqual(words, {"from", "with"})
        self.assertEqual(table_of("crack").plain(), {})
        for filled in (ps.Case("a").add_crack(from_=[0, 0]), ps.Case("b", crack=[{"from": [0, 0]}]).crack[0]):
            self.assertEqual((filled.plain(), filled.from_), ({"from": [0, 0]}, [0, 0]))


if __name__ == "__main__":
    unittest.main()
