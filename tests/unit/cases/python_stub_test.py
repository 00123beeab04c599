"""python/peristat/case_tables.pyi has the keys of docs/case.schema.json, with their types.

    /usr/bin/python3 -BEs tests/unit/cases/python_stub_test.py --write

rewrites it after a key has changed.
"""

import ast
import json
import keyword
import pathlib
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
SCHEMA = ROOT / "docs/case.schema.json"
STUB = ROOT / "python/peristat/case_tables.pyi"
HEAD = '''# Written by tests/unit/cases/python_stub_test.py --write from docs/case.schema.json.
"""Types of the tables of a case: the keys of case files, for editors and type checkers."""

from collections.abc import Callable, Iterable, Mapping, MutableMapping, MutableSequence
from typing import Any, Generic, Literal, TypeAlias, TypeVar

from numpy.typing import ArrayLike

Quantity: TypeAlias = float | str
"""A number in SI units or those of the case, or a text with its unit: "210 GPa"."""
Expression: TypeAlias = float | str | Callable[..., Any]
"""A number, a text such as "0.1 mm * load", or a function of Python whose parameters say on what it depends."""
List: TypeAlias = ArrayLike | list[Any] | tuple[Any, ...]
"""Values in a list, tuple or array, or lists of them."""

_Kind = TypeVar("_Kind")

class Inner(Generic[_Kind]):
    """A table in a table, to which a dict can be assigned."""

    def __get__(self, table: Any, owner: Any) -> _Kind: ...
    def __set__(self, table: Any, value: Mapping[str, Any]) -> None: ...

class Array(Generic[_Kind]):
    """An array of tables, to which a list of dicts can be assigned."""

    def __get__(self, table: Any, owner: Any) -> MutableSequence[_Kind]: ...
    def __set__(self, table: Any, value: Iterable[Mapping[str, Any]]) -> None: ...

class Table(MutableMapping[str, Any]):
    def __getitem__(self, key: str) -> Any: ...
    def __setitem__(self, key: str, value: Any) -> None: ...
    def __delitem__(self, key: str) -> None: ...
    def __iter__(self) -> Any: ...
    def __len__(self) -> int: ...
    def plain(self) -> dict[str, Any]: ...
'''
TYPES = {"string": "str", "boolean": "bool", "integer": "int", "number": "float", "array": "List", "object": "dict[str, Any]"}


def type_of(schema):
    """Annotation of a value."""
    if "enum" in schema:
        return f"Literal[{', '.join(map(json.dumps, schema['enum']))}]"
    if "anyOf" in schema:
        kinds = [kind for one in schema["anyOf"] for kind in type_of(one).split(" | ")]
        if "Quantity" in kinds and "str" in kinds:  # a text that is no quantity is an expression
            kinds = ["Expression", *(kind for kind in kinds if kind not in ("Quantity", "str"))]
        return " | ".join(dict.fromkeys(kinds))
    kinds = schema["type"] if isinstance(schema["type"], list) else [schema["type"]]
    if {"number", "string"} <= set(kinds):
        return "Quantity" if "pattern" in schema else "Expression"
    return " | ".join(TYPES[kind] for kind in kinds)


def attribute(name):
    return name + "_" if keyword.iskeyword(name) else name


class Writer:
    """Writes a class per table; tables with the same keys share one."""

    def __init__(self):
        self.classes = {}  # name by body

    def table(self, schema, name, top=False):
        lines = []
        for key, value in schema["properties"].items():
            items = value.get("items", {})
            inner = next((one for one in (value, items) if "properties" in one), None)
            if inner is not None:
                of = self.table(inner, (name if not top else "") + key.title().replace("_", ""))
            if inner is items:
                kind = f"Array[{of}]"
                keys = ", ".join(f"{attribute(k)}: {self.argument(v)} = ..." for k, v in inner["properties"].items())
                lines.append(f"    def add_{key}(self, *, {keys}) -> {of}: ...")
                if top and key == "set":  # Case.set is a method; the array is case["set"]
                    continue
            else:
                kind = type_of(value) if inner is None else f"Inner[{of}]"
            text = ". ".join(value.get("description", "").split("\n\n")).replace("\n", " ").replace("\\", "\\\\").replace('"', "'")
            lines.append(f"    {attribute(key)}: {kind}")
            if text:
                lines.append(f'    """{text}"""')
        body = "\n".join(lines) + "\n"
        return self.classes.setdefault(body, name)

    @staticmethod
    def argument(schema):
        if "properties" in schema:
            return "dict[str, Any] | Table"
        return "List" if "properties" in schema.get("items", {}) else type_of(schema)


def stub():
    writer = Writer()
    writer.table(json.loads(SCHEMA.read_text("utf-8")), "CaseTable", top=True)
    return HEAD + "".join(f"\nclass {name}(Table):\n{body}" for body, name in writer.classes.items())


class Stub(unittest.TestCase):
    def test_the_file_has_the_keys_of_the_schema(self):
        command = f"/usr/bin/python3 -BEs {pathlib.Path(__file__).relative_to(ROOT)} --write"
        self.assertTrue(STUB.read_text("utf-8") == stub(), f"{STUB.name} is out of date; write it anew by\n{command}")

    def test_names_of_classes_differ(self):
        names = [one.name for one in ast.parse(stub()).body if isinstance(one, ast.ClassDef)]
        self.assertEqual(len(names), len(set(names)))
        self.assertLessEqual({"Table", "CaseTable", "Material", "Support", "LatticeShape", "SetShapeBox"}, set(names))

    def test_types_are_those_of_the_values(self):
        self.assertEqual(type_of({"type": "integer"}), "int")
        self.assertEqual(type_of({"type": ["number", "string"], "pattern": "x"}), "Quantity")
        self.assertEqual(type_of({"type": ["number", "string"]}), "Expression")
        self.assertEqual(type_of({"type": "string", "enum": ["a", "b"]}), 'Literal["a", "b"]')
        either = {"anyOf": [{"type": ["number", "string"], "pattern": "x"}, {"type": "array"}]}
        self.assertEqual(type_of(either), "Quantity | List")
        self.assertEqual(type_of({"anyOf": [either["anyOf"][0], {"type": "string"}]}), "Expression")


if __name__ == "__main__":
    if sys.argv[1:] == ["--write"]:
        STUB.write_text(stub(), "utf-8")
    else:
        unittest.main()
