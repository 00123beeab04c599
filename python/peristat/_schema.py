"""The keys of cases, as the program describes them (`peristat schema`)."""

import functools
import json

from ._package import load_core
from .errors import unknown


@functools.cache
def document():
    """Schema of a whole case."""
    return json.loads(load_core().schema())


def is_table(schema):
    return "properties" in schema


def is_array_of_tables(schema):
    return schema.get("type") == "array" and is_table(schema.get("items") or {})


def entry(schema, name, path):
    """Schema of a key in a table.

    Raises:
        InputError: the table has no such key.
    """
    known = schema["properties"]
    if name in known:
        return known[name]
    where = f"[{path}]" if path else "a case"
    raise unknown(f"key in {where}", name, known)
