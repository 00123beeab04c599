"""Tables of Python as the text of a case file."""

import math
import re

import numpy

from .errors import input_error

BARE = re.compile(r"[A-Za-z0-9_-]+\Z")


def text_of(document):
    """TOML of a dict of tables, arrays of tables and values."""
    lines = []
    _add_table(lines, document, "", "")
    return "\n".join(lines).strip() + "\n"


def value_text(value, key=""):
    """TOML of one value: text, a number, a truth value, a list of these, or a table on one line.

    Numbers and arrays of numpy count as those of Python.
    """
    if isinstance(value, (bool, numpy.bool_)):
        return "true" if value else "false"
    if isinstance(value, str):
        return _string(value, key)
    if isinstance(value, (int, numpy.integer)):
        return str(int(value))
    if isinstance(value, (float, numpy.floating)):
        return _number(float(value), key)
    if isinstance(value, dict):
        pairs = (f"{_name(name)} = {value_text(item, f'{key}.{name}')}" for name, item in value.items())
        return "{ " + ", ".join(pairs) + " }"
    if isinstance(value, numpy.ndarray):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(value_text(item, f"{key}[{k}]") for k, item in enumerate(value)) + "]"
    if hasattr(value, "__fspath__"):
        return _string(value.__fspath__(), key)
    raise input_error(
        key,
        repr(value)[:80],
        f"is a {type(value).__name__}; allowed are text, numbers, truth values, functions where an "
        "expression may stand, and lists and tables of these",
    )


def _add_table(lines, table, header, path):
    """Adds the lines of a table; its path has numbers of elements, which its header has not."""
    inner = []
    for name, value in table.items():
        key = f"{path}.{name}" if path else name
        if isinstance(value, dict) or _is_array_of_tables(value):
            inner.append((f"{header}.{_name(name)}" if header else _name(name), key, value))
        else:
            lines.append(f"{_name(name)} = {value_text(value, key)}")
    for inner_header, key, value in inner:
        if isinstance(value, dict):
            lines.extend(["", f"[{inner_header}]"])
            _add_table(lines, value, inner_header, key)
            continue
        for k, element in enumerate(value):
            lines.extend(["", f"[[{inner_header}]]"])
            _add_table(lines, element, inner_header, f"{key}[{k}]")


def _is_array_of_tables(value):
    return isinstance(value, list) and bool(value) and all(isinstance(item, dict) for item in value)


def _number(value, key):
    if not math.isfinite(value):
        raise input_error(key, repr(value), "must be finite")
    return repr(value)


def _name(name):
    return name if BARE.match(name) else _string(name, name)


def _string(text, key):
    try:
        text.encode("utf-8")
    except UnicodeEncodeError:  # such as the name of a file that is no text
        raise input_error(key, repr(text)[:80], "must be text of Unicode") from None
    if "\0" in text:
        raise input_error(key, repr(text)[:80], "must have no zero character")
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    controls = {"\n": "\\n", "\t": "\\t", "\r": "\\r"}
    return '"' + "".join(
        controls.get(c, f"\\u{ord(c):04x}" if ord(c) < 32 or ord(c) == 127 else c) for c in escaped
    ) + '"'
