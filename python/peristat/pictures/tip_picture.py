"""Picture of running cracks: positions of their tips over time, and their speeds."""

import numpy as np

from .curve_page import curve_page, settle
from .style import LINES
from .units import LENGTHS, number, time_unit, unit_for

TIP_FIELDS = ("crack_end", "crack_begin")
SPACINGS = 4  # to each side, over which a speed is averaged, because a tip advances by a spacing at a time


def running_tips(results) -> list[tuple[str, np.ndarray, np.ndarray]]:
    """Name, times and positions of probes of tips that move while the body does."""
    times = results.numbers("time") if results.is_of_motion else None
    if times is None:
        return []
    found = []
    for probe in results.tables("probe"):
        places = results.numbers(str(probe.get("name"))) if probe.get("field") in TIP_FIELDS else None
        if places is not None and len(set(places)) > 2:
            found.append((str(probe["name"]), times, places))
    return found


def tip_speeds(times, places, reach) -> tuple[np.ndarray, np.ndarray]:
    """Times and slopes of least-squares lines through the rows within `reach` of tip travel to both sides.

    Covers only rows at which the tip has that much travel behind and ahead of it.
    """
    way = np.abs(np.diff(places)).cumsum()
    way = np.append(0.0, way)
    at, speeds = [], []
    for k, time in enumerate(times):
        near = abs(way - way[k]) <= reach
        if way[k] < reach or way[-1] - way[k] < reach or np.ptp(times[near]) == 0.0:
            continue
        at.append(time)
        speeds.append(np.polyfit(times[near] - time, places[near], 1)[0])
    return np.array(at), np.array(speeds)


def draw_tips(results, tips):
    figure, (above, below) = curve_page(2, 3.0, is_stacked=True, sharex=True)
    unit, size = time_unit(max(times.max() for _, times, _ in tips))
    length_unit, length = unit_for(max(abs(places).max() for *_, places in tips), LENGTHS)
    reach = SPACINGS * results.spacing
    largest = 0.0
    for k, (name, times, places) in enumerate(tips):
        there = places != 0.0
        options = {"color": LINES[k % len(LINES)], "linestyle": ("-", "--", ":")[k % 3]}
        above.plot(times[there] / size, places[there] / length, label=name, **options)
        at, speeds = tip_speeds(times[there], places[there], reach)
        below.plot(at / size, speeds, **options)
        largest = max([largest, *abs(speeds)])
    above.set_ylabel(f"tip [{length_unit}]")
    below.set_xlabel(f"time [{unit}]")
    below.set_ylabel("speed [m/s]")
    told = [f"speeds over {2 * SPACINGS} spacings", f"at most {number(round(largest))} m/s"] if largest > 0.0 else []
    settle(figure, results, ["tips of cracks", *told], *above.get_legend_handles_labels())
    return figure
