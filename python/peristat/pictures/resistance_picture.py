"""Picture of R-curves: dissipated energy per crack area as the crack grew."""

import numpy as np

from .curve_page import curve_page, settle
from .style import GHOST, INK, LINES, points
from .units import LENGTHS, number, scaled, unit_for

RELEASES = scaled("J/m²")
PLACES = {"crack_length": "crack length", "crack_area": "crack area"}  # probes that an R-curve may be drawn over
AREAS = (("m²", 1.0), ("cm²", 1e-4), ("mm²", 1e-6))


def _probes(results, field: str) -> list[dict]:
    found = [probe for probe in results.tables("probe") if probe.get("field") == field]
    return [probe for probe in found if results.numbers(str(probe.get("name"))) is not None]


def _place(results, probe: dict) -> dict | None:
    """The probe to draw a resistance over: one of the same set if possible, a length before an area."""
    found = [other for field in PLACES for other in _probes(results, field)]
    return min(found, key=lambda other: other.get("set") != probe.get("set"), default=None)


def resistances(results) -> list[tuple[dict, dict]]:
    """Probes of a crack that has grown, each with the probe that it is drawn over."""
    pairs = []
    for probe in _probes(results, "crack_resistance"):
        if not np.any(results.numbers(str(probe["name"])) > 0.0):
            continue
        place = _place(results, probe)
        if place is None:
            results.missing.append(f"no resistance of {probe['name']}: it is drawn over a probe of crack_length or crack_area")
        else:
            pairs.append((probe, place))
    return pairs


def draw_resistances(results, pairs):
    """Resistance over crack length or area, with a mark per step in which the crack grew, beside the material's
    fracture energy."""
    figure, [axes] = curve_page()
    curves = [(results.numbers(str(probe["name"])), results.numbers(str(place["name"]))) for probe, place in pairs]
    asked = fracture_energy(results)
    unit, size = unit_for(max(max(values.max() for values, _ in curves), asked), RELEASES, 1.0)
    fields = {place["field"] for _, place in pairs}
    field = fields.pop() if len(fields) == 1 else "crack_length"
    shown = [(probe, *curve) for (probe, place), curve in zip(pairs, curves) if place["field"] == field]
    length_unit, length = unit_for(max(places.max() for *_, places in shown), AREAS if field == "crack_area" else LENGTHS)
    for k, (probe, values, places) in enumerate(shown):
        grew = values > 0.0
        axes.plot(places[grew] / length, values[grew] / size, marker="o", markersize=points(6), color=LINES[k % len(LINES)],
                  markeredgecolor=INK, markeredgewidth=points(0.5), label=str(probe["name"]))  # fmt: skip
    if asked > 0.0:
        axes.axhline(asked / size, color=GHOST, linewidth=points(1.5), linestyle="--", zorder=1, label="fracture energy of the material")
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel(f"{PLACES[field]} [{length_unit}]")
    axes.set_ylabel(f"dissipated energy per area grown [{unit}]")
    steps = sum(int((values > 0.0).sum()) for _, values, _ in shown)
    words = ["resistance to the crack (R-curve)", f"{number(steps)} step{'s' * (steps != 1)} in which it grew"]
    settle(figure, results, words, *axes.get_legend_handles_labels())
    return figure


def fracture_energy(results) -> float:
    """Fracture energy of the case's material [J/m²]; 0 if it gives none."""
    material = results.case.get("material")
    damage = material.get("damage") if isinstance(material, dict) else None
    asked = damage.get("fracture_energy") if isinstance(damage, dict) else None
    return float(asked) if isinstance(asked, (int, float)) and not isinstance(asked, bool) else 0.0
