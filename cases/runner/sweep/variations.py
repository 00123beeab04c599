"""What is varied: reads --vary and --set, and names the folders of the combinations."""

import hashlib
import os
import re
from itertools import product

CLOSING = {"[": "]", "{": "}", "(": ")"}
LONGEST_NAME = 150  # of a folder, in characters


class WrongInput(Exception):
    """A sentence for a person: what is wrong and what is allowed."""


def split_values(text: str) -> list[str]:
    """Parts between the commas that are outside of brackets and quotes."""
    parts, begin, expected, quote, escaped = [], 0, [], "", False
    for position, character in enumerate(text):
        if quote:
            if escaped:
                escaped = False
            elif character == "\\" and quote == '"':
                escaped = True
            elif character == quote:
                quote = ""
        elif character in "\"'":
            quote = character
        elif character in CLOSING:
            expected.append(CLOSING[character])
        elif character in CLOSING.values():
            if not expected or expected.pop() != character:
                raise WrongInput(f"{character} closes nothing")
        elif character == "," and not expected:
            parts.append(text[begin:position])
            begin = position + 1
    if quote or expected:
        raise WrongInput(f"{quote or expected[-1]} is missing")
    return [part.strip() for part in [*parts, text[begin:]]]


def read_variation(text: str) -> tuple[str, list[str]]:
    """Key and values of "key=v1,v2,…"."""
    key, equals, values = text.partition("=")
    key = key.strip()
    if not equals or not key:
        raise WrongInput(f"--vary {text}: needs the form key=value1,value2,... e.g. loading.steps=10,20")
    try:
        parts = split_values(values)
    except WrongInput as error:
        raise WrongInput(f"--vary {text}: {error}") from error
    if "" in parts:
        raise WrongInput(f"--vary {text}: a value is empty (an empty text is written '{key}=\"\"')")
    twice = [value for number, value in enumerate(parts) if value in parts[:number]]
    if twice:
        raise WrongInput(f"--vary {text}: the value {twice[0]} stands twice")
    return key, parts


def read_variations(texts: list[str], settings: list[str]) -> dict[str, list[str]]:
    """Values by key, in the order given; refuses a key that is given twice, also by --set."""
    if not texts:
        raise WrongInput("nothing is varied: give --vary key=value1,value2,... at least once")
    variations = {}
    for text in texts:
        key, values = read_variation(text)
        if key in variations:
            raise WrongInput(f"--vary {text}: {key} is varied twice; give all its values at once")
        variations[key] = values
    set_keys = [setting.partition("=")[0].strip() for setting in settings]
    for key in variations:
        if key in set_keys:
            raise WrongInput(f"{key} is both varied and set; leave one out")
    if "output.directory" in [*variations, *set_keys]:
        raise WrongInput("output.directory: the combinations have folders of their own, below --output")
    return variations


def combinations(variations: dict[str, list[str]]) -> list[tuple[str, ...]]:
    """Every combination of the values; those of the last key change fastest."""
    return list(product(*variations.values()))


def folder_name(settings: list[str]) -> str:
    """The settings as a file name: "key=value,key2=value2".

    Where characters had to be replaced, or the name cut, a checksum keeps names apart.
    """
    wanted = ",".join(settings)
    parts = [setting.partition("=") for setting in settings]
    name = ",".join(f"{_plain(key)}={_plain(value)}" for key, _, value in parts)
    if name == wanted and len(name) <= LONGEST_NAME:
        return name
    return f"{name[:LONGEST_NAME]}_{hashlib.sha256(os.fsencode(wanted)).hexdigest()[:8]}"


def _plain(text: str) -> str:
    return re.sub(r"[^A-Za-z0-9._+\[\]-]+", "_", text)
