"""Keys of the setting that the user gives other values: `trust --set KEY=VALUE`."""

import tomllib

# Poisson's ratio of glass, for models that take one, if none is given. In plane stress neither the references of the
# specimens nor their stiffness depend on it.
GLASS = 0.22
MODEL, RATIO = "material.model", "material.poisson_ratio"
OF_BONDS = ("bond", "green_bond")  # models whose ratio is not free


class WrongSetting(Exception):
    """An error message for the user."""


def read_settings(pairs: list[str]) -> dict[str, str]:
    """The values by key, with the ratio of glass if the model needs one and none is given.

    @raise WrongSetting for a pair without a key or a value, and for a key given twice
    """
    given: dict[str, str] = {}
    for pair in pairs:
        key, equals, value = (part.strip() for part in pair.partition("="))
        if not equals or not key or not value:
            raise WrongSetting(f"--set {pair}: must be KEY=VALUE")
        if key in given:
            raise WrongSetting(f"--set {pair}: {key} is given twice")
        given[key] = value
    if given.get(MODEL, "bond").strip("\"'") not in OF_BONDS:
        given.setdefault(RATIO, str(GLASS))
    return given


def poisson_ratio(given: dict[str, str]) -> float | None:
    """The given ratio, for closed forms that depend on it.

    @raise WrongSetting unless it is a number
    """
    try:
        return float(given[RATIO]) if RATIO in given else None
    except ValueError:
        raise WrongSetting(f"--set {RATIO}={given[RATIO]}: must be a number") from None


def in_case(given: dict[str, str], text: str) -> list[str]:
    """The pairs KEY=VALUE for a case. Its materials may be those of regions and interfaces; only an interface has
    damage then."""
    case, pairs = tomllib.loads(text), []
    for key, value in given.items():
        places = [""]
        if key.startswith("material.") and "material" not in case:
            tables = ("interface",) if key.startswith("material.damage.") else ("region", "interface")
            places = [f"{table}[{number}]." for table in tables for number in range(len(case.get(table, [])))]
        pairs += [f"{place}{key}={value}" for place in places]
    return pairs
