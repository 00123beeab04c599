"""Numbers that a page prints, found by the words around them."""

import functools
import re

from tests.reference.program import ROOT

_DIGITS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻−", "0123456789--")
_NUMBER = r"[−+-]?\d+(?: \d{3}(?!\d))*(?:\.\d+)?(?:e[+-]?\d+|·10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?"


class Printed:
    """A number as printed; `rounding` is half a unit of its last digit."""

    def __init__(self, text):
        self.text = text
        mantissa, _, exponent = text.translate(_DIGITS).replace(" ", "").replace("·10", "e").partition("e")
        decimals = len(mantissa.partition(".")[2])
        self.value = float(f"{mantissa}e{exponent or 0}")
        self.rounding = 0.5 * 10.0 ** (int(exponent or 0) - decimals)


@functools.cache
def text_of(path):
    """The page on one line; comments of a case without their # signs."""
    text = (ROOT / path).read_text()
    if path.endswith(".toml"):
        text = re.sub(r"^# ?", "", text, flags=re.MULTILINE)
    return " ".join(text.split())


def numbers(path, phrase):
    """The numbers that the page has at the {} of `phrase`; the phrase must occur exactly once."""
    pattern = f"({_NUMBER})".join(re.escape(part) for part in " ".join(phrase.split()).split("{}"))
    found = [match.groups() for match in re.finditer(pattern, text_of(path))]
    if len(found) != 1:
        raise AssertionError(f'{path} has "{phrase}" {len(found)} times instead of once')
    return [Printed(text) for text in found[0]]
