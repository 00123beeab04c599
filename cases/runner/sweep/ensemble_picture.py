"""The picture of an ensemble: peaks on Weibull's paper, and their means over the volume of the body."""

import numpy as np
from ensemble import Sample, SizeEffect
from peristat.pictures.style import GHOST, INK, LINES, WIDE, heading, new_figure, own_settings
from peristat.pictures.units import number
from weibull import median_ranks

PERCENT = (1, 2, 5, 10, 20, 50, 80, 90, 99)


class _Heading:
    status = "completed"

    def __init__(self, title: str):
        self.title = title


@own_settings(WIDE)
def draw_ensemble(title: str, keys: list[str], quantity: str, samples: list[Sample], effect: SizeEffect | None):
    figure = new_figure(16.0, 7.4)
    left = figure.add_axes([0.065, 0.115, 0.41 if effect else 0.62, 0.67])
    ends = [np.inf, -np.inf]
    for color, each in zip(LINES * len(samples), samples):
        peaks = np.sort(each.peaks)
        ends = [min(ends[0], peaks[0]), max(ends[1], peaks[-1])]
        probability = median_ranks(len(peaks))
        left.plot(peaks, _paper(probability), "o", color=color, markersize=5, zorder=3, label=_label(keys, each))
        if each.weibull is not None:
            line = np.linspace(peaks[0] * 0.97, peaks[-1] * 1.03, 50)
            left.plot(line, each.weibull.modulus * np.log(line / each.weibull.scale), color=color, zorder=2, linewidth=1.6)
    left.set_xscale("log")
    ticks = [tick for tick in _round_ticks(*ends)]
    left.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    left.xaxis.set_minor_formatter(lambda value, place: "")
    count = max(len(each.peaks) for each in samples)
    shown = [percent for percent in PERCENT if 0.2 / count <= percent / 100.0 <= 1.0 - 0.1 / count]
    left.set_yticks([_paper(percent / 100.0) for percent in shown], [f"{percent} %" for percent in shown])
    left.set_xlabel(quantity.replace("$", r"\$"))
    left.set_ylabel("probability of failure")
    left.legend(loc="lower right")
    if effect:
        _draw_sizes(figure.add_axes([0.58, 0.115, 0.385, 0.67]), quantity, samples, effect)
    words = [f"{number(sum(len(each.peaks) for each in samples))} runs"] + ([effect.told()] if effect else [])
    heading(figure, _Heading(title), words)
    return figure


def _paper(probability):
    """Scale on which Weibull's distribution is a straight line of slope m."""
    return np.log(-np.log1p(-np.asarray(probability)))


def _round_ticks(low: float, high: float) -> list[float]:
    step = 10.0 ** np.floor(np.log10((high - low) / 2.0)) if high > low else high
    step = next(step * factor for factor in (1, 2, 5, 10) if (high - low) / (step * factor) <= 6.0)
    return [step * k for k in range(int(np.ceil(low / step)), int(np.floor(high / step)) + 1)] or [low]


def _label(keys: list[str], each: Sample) -> str:
    values = ", ".join(f"{key.rpartition('.')[2]} = {value}" for key, value in zip(keys, each.values))
    told = f"m = {each.weibull.modulus:.3g}" if each.weibull is not None else "no modulus"
    return ": ".join(filter(None, [values, told])).replace("$", r"\$")


def _draw_sizes(axes, quantity: str, samples: list[Sample], effect: SizeEffect) -> None:
    known = [each for each in samples if each.weibull is not None]
    volumes, means = np.array([each.volume for each in known]), np.array([each.mean for each in known])
    errors = [1.96 * each.deviation / len(each.peaks) ** 0.5 for each in known]
    for color, volume, mean, error in zip(LINES * len(known), volumes, means, errors):
        axes.errorbar(volume, mean, error, color=color, marker="o", markersize=7, capsize=4, zorder=3)
    line = np.geomspace(volumes.min() / 1.2, volumes.max() * 1.2, 50)
    weights = np.array([(mean / error) ** 2 for mean, error in zip(means, errors)])
    middle = np.exp(np.average(np.log(means) - effect.exponent * np.log(volumes), weights=weights))
    axes.plot(line, middle * line**effect.exponent, color=INK, linewidth=1.4, label=f"power {effect.exponent:.3f}", zorder=2)
    modulus = float(np.mean([each.weibull.modulus for each in known]))
    link = means[0] * (line / volumes[0]) ** (-1.0 / modulus)
    axes.plot(line, link, color=GHOST, linewidth=2.4, linestyle="--", zorder=1, label=f"weakest link of m = {modulus:.3g}")
    axes.set_xscale("log")
    axes.set_yscale("log")
    ticks = _round_ticks(min(*means, *link), max(*means, *link))
    axes.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.yaxis.set_minor_formatter(lambda value, place: "")
    axes.set_xlabel("volume [m³]")
    axes.set_ylabel(f"mean {quantity}".replace("$", r"\$"))
    axes.legend(loc="upper right")
