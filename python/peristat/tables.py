"""Tables of a case, whose keys are those of case files."""

import collections.abc
import re

import numpy

from . import _schema
from .errors import input_error


class Copied:
    """Copies of a table are of their own; functions and dials in them are the same."""

    def __copy__(self):
        return type(self)(self._schema, self._path, self.plain())

    def __deepcopy__(self, _):
        return self.__copy__()


class Table(Copied, collections.abc.MutableMapping):
    """A table of keys, as mapping and by attributes: `case.material.youngs_modulus = "192 GPa"`.

    The keys are those of case files (`peristat keys`, docs/case-file.md); an unknown one is refused.
    A value is text, a number, a truth value, a list or array of these, or, where an expression may
    stand, a function of Python. Python's own words get an underscore: `from_`. Arrays of tables are
    lists, to which `add_NAME(key=value, ...)` adds a table.
    """

    def __init__(self, schema, path="", values=None):
        object.__setattr__(self, "_schema", schema)
        object.__setattr__(self, "_path", path)
        object.__setattr__(self, "_values", {})
        self.update(values or {})

    def _key(self, name):
        if not isinstance(name, str):
            raise input_error(self._path, repr(name)[:80], "keys are text")
        name = name[:-1] if name.endswith("_") else name
        path = f"{self._path}.{name}" if self._path else name
        return name, path, _schema.entry(self._schema, name, self._path)

    def __getitem__(self, name):
        """Value of a key. A table that is not there yet is made, a value is not: KeyError."""
        name, path, schema = self._key(name)
        if name not in self._values:
            if _schema.is_table(schema):
                return self._values.setdefault(name, Table(schema, path))
            if _schema.is_array_of_tables(schema):
                return self._values.setdefault(name, TableList(schema["items"], path))
        return self._values[name]

    def __setitem__(self, name, value):
        name, path, schema = self._key(name)
        if _schema.is_table(schema):
            value = Table(schema, path, _mapping(path, value))
        elif _schema.is_array_of_tables(schema):
            value = TableList(schema["items"], path, value)
        elif value is None:
            raise input_error(path, "None", "is not a value; `del` removes a key")
        self._values[name] = value if isinstance(value, (Table, TableList)) else _plain(value)

    def __delitem__(self, name):
        del self._values[self._key(name)[0]]

    def __iter__(self):
        return iter(self._values)

    def __len__(self):
        return len(self._values)

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        if name.startswith("add_") and _is_array(self._schema, name[4:]):
            return self[name[4:]].add
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f"{self._path or 'the case'} has no value for {name}") from None
        except ValueError as error:
            raise AttributeError(str(error)) from None

    def __setattr__(self, name, value):
        self[name] = value

    def __delattr__(self, name):
        del self[name]

    def __dir__(self):
        arrays = [name for name in self._schema["properties"] if _is_array(self._schema, name)]
        return [*super().__dir__(), *self._schema["properties"], *(f"add_{name}" for name in arrays)]

    def __repr__(self):
        return f"{self._path or 'case'} = {self.plain()}"

    def plain(self):
        """The table as dicts and lists, without tables that are empty."""
        return {
            name: _plain(value)
            for name, value in self._values.items()
            if not isinstance(value, (Table, TableList)) or len(value)
        }


class TableList(Copied, collections.abc.MutableSequence):
    """An array of tables, such as the supports of a case."""

    def __init__(self, schema, path, tables=()):
        self._schema, self._path, self._tables = schema, path, []
        if isinstance(tables, (str, collections.abc.Mapping)) or not hasattr(tables, "__iter__"):
            raise input_error(path, repr(tables)[:80], "must be a list of tables")
        self.extend(tables)

    def _table(self, k, values):
        path = f"{self._path}[{k}]"
        return Table(self._schema, path, _mapping(path, values))

    def add(self, **values):
        """Adds a table and returns it."""
        self.append(values)
        return self._tables[-1]

    def insert(self, k, values):
        self._tables.insert(k, self._table(k, values))

    def __getitem__(self, k):
        return self._tables[k]

    def __setitem__(self, k, values):
        self._tables[k] = self._table(k, values)

    def __delitem__(self, k):
        del self._tables[k]

    def __len__(self):
        return len(self._tables)

    def __repr__(self):
        return f"{self._path} = {self.plain()}"

    def plain(self):
        return [table.plain() for table in self._tables]


def parted(key):
    """Key and number of an element, such as "support[0].displacement" and 1, or None.

    Raises:
        InputError: the key is no text.
    """
    if not isinstance(key, str):
        raise input_error("key", repr(key)[:80], 'must be text, such as "loading.steps"')
    match = re.fullmatch(r"(.*)\[([0-9]+)\]", key)
    return (match[1], int(match[2])) if match else (key, None)


def find(table, key):
    """Table and last name of a dotted key such as "support[0].displacement".

    Raises:
        InputError: there is no such key or element.
    """
    parts = key.split(".")
    for k, part in enumerate(parts):
        name, _, number = part.partition("[")
        is_last = k + 1 == len(parts)
        if not number:
            if is_last:
                return table, name
            table = table[name]
        else:
            table = _element(table[name], number, key)
            if is_last:
                raise input_error(key, "", "is a table; name a key in it")
        if not isinstance(table, Table):
            raise input_error(key, "", f"{part} is no table")
    raise input_error(key, "", "is no key")


def _element(tables, number, key):
    count = len(tables) if isinstance(tables, TableList) else 0
    if not re.fullmatch(r"[0-9]+\]", number) or int(number[:-1]) >= count:
        raise input_error(key, "", f"[{number} is none of the {count} tables, which count from 0")
    return tables[int(number[:-1])]


def _plain(value):
    """Dicts and lists of one's own for tables, lists and arrays; other values as they are."""
    if isinstance(value, (Table, TableList)):
        return value.plain()
    if isinstance(value, dict):
        return {name: _plain(item) for name, item in value.items()}
    if isinstance(value, numpy.ndarray):
        return value.tolist()
    return [_plain(item) for item in value] if isinstance(value, (list, tuple)) else value


def _is_array(schema, name):
    return _schema.is_array_of_tables(schema["properties"].get(name, {}))


def _mapping(path, value):
    if isinstance(value, Table):
        return value.plain()
    if isinstance(value, collections.abc.Mapping):
        return value
    raise input_error(path, repr(value)[:80], "must be a table: a dict of its keys")
