"""Varied keys: reads --vary and --with, and names the folders of the combinations."""

import hashlib
import os
import re
from dataclasses import dataclass
from itertools import product

CLOSING = {"[": "]", "{": "}", "(": ")"}
LONGEST_NAME = 150  # limit on a folder's name, in characters


class WrongInput(Exception):
    """An error message for the user: what is wrong and what is allowed."""


def split_values(text: str) -> list[str]:
    """Splits at the commas that are outside brackets and quotes."""
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


@dataclass
class Axis:
    """Keys that vary together: at the k-th position each has its k-th value."""

    keys: list[str]
    values: list[list[str]]  # one list per key

    def __len__(self) -> int:
        return len(self.values[0])


def read_variation(option: str, text: str) -> tuple[str, list[str]]:
    """Key and values of "key=v1,v2,…"."""
    key, equals, values = text.partition("=")
    key = key.strip()
    if key.endswith(":"):
        raise WrongInput(f"{option} {text}: takes values; a key is computed by --with {key}=EXPRESSION")
    if not equals or not key:
        raise WrongInput(f"{option} {text}: needs the form key=value1,value2,... e.g. loading.steps=10,20")
    try:
        parts = split_values(values)
    except WrongInput as error:
        raise WrongInput(f"{option} {text}: {error}") from error
    if "" in parts:
        raise WrongInput(f"{option} {text}: a value is empty (an empty text is written '{key}=\"\"')")
    return key, parts


def vary(text: str) -> Axis:
    """Axis of --vary."""
    key, parts = read_variation("--vary", text)
    twice = [value for number, value in enumerate(parts) if value in parts[:number]]
    if twice:
        raise WrongInput(f"--vary {text}: the value {twice[0]} is given twice")
    return Axis([key], [parts])


def vary_with(axes: list[Axis], text: str) -> None:
    """Adds the key of --with to the last axis."""
    key, parts = read_variation("--with", text)
    if not axes:
        raise WrongInput(f"--with {text}: needs a --vary before it, with which {key} varies")
    if len(parts) != len(axes[-1]):
        raise WrongInput(f"--with {text}: has {len(parts)} values and {axes[-1].keys[0]} has {len(axes[-1])}")
    axes[-1].keys.append(key)
    axes[-1].values.append(parts)


def check_keys(varied: list[str], settings: list[str]) -> None:
    """Refuses keys that are given twice, also by --set, and the key of the results folder."""
    set_keys = [setting.partition("=")[0].strip().removesuffix(":").strip() for setting in settings]
    for place, key in enumerate(varied):
        if key in varied[:place]:
            raise WrongInput(f"{key} is varied twice; give all its values at once")
        if key in set_keys:
            raise WrongInput(f"{key} is both varied and set; leave one out")
    if "output.directory" in [*varied, *set_keys]:
        raise WrongInput("output.directory: the combinations have folders of their own, below --output")


def combinations(axes: list[Axis]) -> list[tuple[str, ...]]:
    """All combinations of the axes' positions, as values of all keys; the last axis changes fastest."""
    places = product(*(range(len(axis)) for axis in axes))
    return [tuple(values[k] for axis, k in zip(axes, place) for values in axis.values) for place in places]


def folder_name(settings: list[str]) -> str:
    """The settings as a file name: "key=value,key2=value2".

    If characters had to be replaced, or the name was cut, a checksum keeps names distinct.
    """
    wanted = ",".join(settings)
    parts = [setting.partition("=") for setting in settings]
    name = ",".join(f"{_plain(key)}={_plain(value)}" for key, _, value in parts)
    if name == wanted and len(name) <= LONGEST_NAME:
        return name
    return f"{name[:LONGEST_NAME]}_{hashlib.sha256(os.fsencode(wanted)).hexdigest()[:8]}"


def _plain(text: str) -> str:
    return re.sub(r"[^A-Za-z0-9._+\[\]-]+", "_", text)
