"""Values computed from those of other keys: "loading.steps:=round(0.02/lattice.spacing)"."""

import ast
import contextlib
import math
import operator
import re
import tomllib

from variations import WrongInput

# Units of [units] that a length may have, in m; with others a sweep over lattices is refused.
LENGTHS = {"m": 1.0, "dm": 1e-1, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "μm": 1e-6, "nm": 1e-9, "km": 1e3,
           "in": 0.0254, "ft": 0.3048}  # fmt: skip
FUNCTIONS = {"abs": abs, "min": min, "max": max, "round": round, "floor": math.floor, "ceil": math.ceil,
             "sqrt": math.sqrt, "exp": math.exp, "log": math.log, "sin": math.sin, "cos": math.cos,
             "tan": math.tan}  # fmt: skip
OPERATORS = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
             ast.Pow: operator.pow, ast.USub: operator.neg, ast.UAdd: operator.pos}  # fmt: skip
LARGEST_OF_POWER = 1000


def split_computed(text: str) -> tuple[str, str] | None:
    """Key and expression of "key:=expression"; None for any other text."""
    key, equals, expression = text.partition("=")
    if not equals or not key.rstrip().endswith(":"):
        return None
    return key.rstrip()[:-1].strip(), expression.strip()


class Keys:
    """The values of a combination's keys: those of the case file, replaced by the combination's settings."""

    def __init__(self, case_text: bytes, settings: list[str], later: set[str] = frozenset()):
        """later: keys that will be computed later, so that their values in the case file must not be used"""
        self._later = later
        self.fault = ""  # why the case file can't be read
        try:
            self._case = tomllib.loads(case_text.decode())
        except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
            self._case = {}  # the program reports the error, too
            self.fault = str(error)
        for setting in settings:
            key, _, value = setting.partition("=")
            self._put(_parts(key), _toml_value(value))

    def number(self, key: str) -> float | int:
        """@raises WrongInput if there is none"""
        if key in self._later:
            raise WrongInput(f"{key} is computed later, or from itself: give the keys that it needs before it")
        value = self.given(key)
        if value is None:
            raise WrongInput(f"{key} is neither in the case file nor on the command line")
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise WrongInput(f"{key} is not a number; a number with a unit in quotes can't be used in an expression")
        return value

    def given(self, key: str):
        """The value of a key as it was given, of any type; None without one."""
        value = self._case
        for part in _parts(key):
            try:
                value = value[part]
            except (KeyError, IndexError, TypeError):
                return None
        return value

    def length_unit(self) -> float:
        """The unit of plain lengths [m]. @raises WrongInput for an unusual one"""
        units = self._case.get("units")
        name = units.get("length", "m") if isinstance(units, dict) else "m"
        if name not in LENGTHS:
            raise WrongInput(f"units.length = {name}: must be one of {', '.join(LENGTHS)}")
        return LENGTHS[name]

    def numbers(self, key: str) -> list[float | int]:
        """A number, or the numbers of a list. @raises WrongInput if there is none"""
        try:
            return [self.number(key)]
        except WrongInput as error:
            found = []
            with contextlib.suppress(WrongInput):
                while True:
                    found.append(self.number(f"{key}[{len(found)}]"))
            if found:
                return found
            raise error

    def count(self, key: str) -> int:
        """Number of elements of a list; 0 without one."""
        value = self._case
        for part in _parts(key):
            value = value.get(part) if isinstance(value, dict) else None
        return len(value) if isinstance(value, list) else 0

    def _put(self, parts: list[str | int], value) -> None:
        table = self._case
        for part, following in zip(parts, parts[1:]):
            if isinstance(table, dict) and part not in table:
                table[part] = [] if isinstance(following, int) else {}
            try:
                table = table[part]
            except (IndexError, TypeError):
                return  # the program refuses it
        if isinstance(table, dict) or (isinstance(table, list) and parts[-1] in range(len(table))):
            table[parts[-1]] = value


def _parts(key: str) -> list[str | int]:
    """Splits "a.b[0].c" into names and indices."""
    return [int(part[1:-1]) if part[0] == "[" else part.strip() for part in re.findall(r"\[\d+\]|[^.\[\]]+", key)]


def _toml_value(text: str):
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text


def compute(expression: str, keys: Keys) -> str:
    """The expression's value in the form of a case file: an integer if its operations give one, as round does.

    @raises WrongInput with the reason
    """
    try:
        tree = ast.parse(expression.replace("^", "**"), mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise WrongInput("is not an expression of numbers and keys") from None
    try:
        value = _value(tree.body, keys)
        is_finite = not isinstance(value, complex) and math.isfinite(value)
    except (ArithmeticError, TypeError, ValueError, RecursionError) as error:
        raise WrongInput(f"has no value ({error})") from None
    if not is_finite:
        raise WrongInput("has no finite value")
    return repr(value)


def _value(node: ast.expr, keys: Keys):
    if isinstance(node, ast.Constant) and type(node.value) in (int, float):
        return node.value
    if isinstance(node, (ast.BinOp, ast.UnaryOp)) and type(node.op) in OPERATORS:
        apply = OPERATORS[type(node.op)]
        if isinstance(node, ast.UnaryOp):
            return apply(_value(node.operand, keys))
        left, right = _value(node.left, keys), _value(node.right, keys)
        if isinstance(node.op, ast.Pow) and max(abs(left), abs(right)) > LARGEST_OF_POWER:
            left = float(left)  # integer powers could take forever
        return apply(left, right)
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
        if node.func.id not in FUNCTIONS:
            raise WrongInput(f"has no function {node.func.id}; there are {', '.join(FUNCTIONS)}")
        return FUNCTIONS[node.func.id](*(_value(argument, keys) for argument in node.args))
    if isinstance(node, ast.Name) and node.id == "pi":
        return math.pi
    return keys.number(_key(node))


def _key(node: ast.expr) -> str:
    """Text of a key: a.b[0].c"""
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute):
        return f"{_key(node.value)}.{node.attr}"
    if isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Constant) and type(node.slice.value) is int:
        return f"{_key(node.value)}[{node.slice.value}]"
    raise WrongInput("may only contain numbers, keys, pi, + - * / ^, brackets and functions")
