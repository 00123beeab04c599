"""The keys of cases, as the program describes them (`peristat schema`)."""

import difflib
import functools
import json

from ._package import load_core
from .errors import input_error


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
    near = difflib.get_close_matches(name, known, 1)
    meant = f"; did you mean {near[0]}?" if near else ""
    where = f"[{path}]" if path else "a case"
    raise input_error(
        f"{path}.{name}" if path else name, "", f"{where} has no such key{meant} It has {', '.join(known)}"
        if meant else f"{where} has no such key; it has {', '.join(known)}"
    )


def arrays_of_tables(schema=None, path=""):
    """Dotted names of all arrays of tables, such as "support" and "lattice.shape"."""
    found = []
    for name, inner in (schema or document())["properties"].items():
        key = f"{path}.{name}" if path else name
        if is_array_of_tables(inner):
            found.append(key)
        elif is_table(inner):
            found.extend(arrays_of_tables(inner, key))
    return found
