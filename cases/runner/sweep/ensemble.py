"""An ensemble: one case with many seeds of its random fields, and the statistics of its peaks."""

import csv
import io
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from computed import Keys
from own_files import write_own
from variations import Axis, WrongInput
from weibull import FEWEST, Weibull, fit_weibull

SIGN = b"weibull_modulus,modulus_low,modulus_high"  # in the header of the table
FAILED = 0.8  # share of the peak below which the last reaction of a body that has failed is


def seeds(text: str, keys: Keys) -> Axis:
    """Axis of --seeds: of all random fields, those of the case first; fields that share a seed go on sharing one."""
    if not text.isdecimal() or not FEWEST <= int(text) <= 100_000:
        raise WrongInput(f"--seeds {text}: must be a number of seeds from {FEWEST} to 100000")
    if keys.fault:
        raise WrongInput(f"the case file can't be read: {keys.fault}")
    fields = _random_fields(keys)
    if not fields:
        raise WrongInput(f"--seeds {text}: the case has no random field; give it a [[material.scatter]] with a weibull_modulus")
    span = max(fields.values()) - min(fields.values()) + 1
    return Axis(list(fields), [[str(seed + k * span) for k in range(int(text))] for seed in fields.values()])


def _random_fields(keys: Keys) -> dict[str, int]:
    """The seeds of the random fields, by key."""
    found = {}
    materials = ["material", *(f"region[{k}].material" for k in range(keys.count("region")))]
    for material in materials:
        tables = keys.given(f"{material}.scatter")
        for k, table in enumerate(tables if isinstance(tables, list) else []):
            if isinstance(table, dict) and "factor" not in table:
                seed = table.get("seed", 1)
                if isinstance(seed, bool) or not isinstance(seed, int):
                    raise WrongInput(f"{material}.scatter[{k}].seed = {seed}: must be a whole number")
                found[f"{material}.scatter[{k}].seed"] = seed
    return found


@dataclass(frozen=True)
class Sample:
    """Peaks of the runs that differ in their seeds alone."""

    values: tuple[str, ...]  # of the other varied keys
    peaks: np.ndarray  # largest reaction, or that divided by --per
    failed: int  # number of them behind whose peak the reaction has fallen
    volume: float  # of the body, without layers [m3]
    weibull: Weibull | None  # if all have failed, at different peaks

    @property
    def mean(self) -> float:
        return float(self.peaks.mean())

    @property
    def deviation(self) -> float:
        return float(self.peaks.std(ddof=1)) if len(self.peaks) > 1 else math.nan

    def told(self) -> str:
        text = f"{len(self.peaks)} runs, mean {self.mean:.5g}, standard deviation {self.deviation:.3g}"
        if self.weibull is not None:
            low, high = self.weibull.modulus_ends
            return f"{text}, Weibull modulus {self.weibull.modulus:.3g} ({low:.3g} to {high:.3g})"
        if self.failed < len(self.peaks):
            return f"{text}; {len(self.peaks) - self.failed} runs end before the reaction has fallen: no Weibull modulus"
        return f"{text}; no Weibull modulus: it needs {FEWEST} different peaks"


def sample(values: tuple[str, ...], folders: list[Path], name: str, divisor: float) -> Sample:
    """@param name of the support set whose reaction counts"""
    norms = [_norms(folder, name) for folder in folders]
    peaks = np.array([norm.max() for norm in norms]) / divisor
    failed = sum(bool(norm[-1] <= FAILED * norm.max()) for norm in norms)
    differ = len(peaks) >= FEWEST and np.ptp(peaks) > 1e-9 * peaks.max()
    is_known = failed == len(peaks) and differ and peaks.min() > 0.0
    return Sample(values, peaks, failed, _volume(folders[0]), fit_weibull(peaks) if is_known else None)


def _norms(folder: Path, name: str) -> np.ndarray:
    """Norm of a set's reaction at the accepted steps [N]."""
    with open(folder / "history.csv", newline="", encoding="utf-8") as file:
        return np.array([math.hypot(*(float(row[f"reaction_{axis}:{name}"]) for axis in "xyz")) for row in csv.DictReader(file)])


def _volume(folder: Path) -> float:
    from peristat.pictures.results_folder import read_results_folder

    results = read_results_folder(folder)
    inside = np.ones(len(results.volume), dtype=bool)
    for layer in results.case.get("lattice", {}).get("layer", []):
        inside[results.sets.get(layer.get("name"), [])] = False
    return float(np.sum(results.volume[inside]))


@dataclass(frozen=True)
class SizeEffect:
    """The power law mean ~ volume^(-1/m) through the means of samples; the weakest link has the Weibull modulus as m."""

    exponent: float  # -1/m
    error: float  # its standard deviation, by those of the means

    def told(self) -> str:
        text = f"the mean goes with the volume to the power of {self.exponent:.4f} ± {self.error:.4f}"
        return text + (f", as weakest links of modulus {-1.0 / self.exponent:.3g} do" if self.exponent < -self.error else "")


def size_effect(samples: list[Sample]) -> SizeEffect | None:
    """Weighted least squares of the logarithms; None without samples of different volumes that have failed."""
    known = [each for each in samples if each.weibull is not None]
    logs = np.log([each.volume for each in known])
    if len(known) < 2 or np.ptp(logs) < 1e-3:
        return None
    weights = np.array([len(each.peaks) * (each.mean / each.deviation) ** 2 for each in known])  # 1 / variance of log mean
    centred = logs - np.average(logs, weights=weights)
    spread = float((weights * centred**2).sum())
    return SizeEffect(float((weights * centred * np.log([each.mean for each in known])).sum() / spread), spread**-0.5)


def write_ensemble(path: Path, keys: list[str], quantity: str, samples: list[Sample]) -> None:
    """One row per sample. Cells without a value are empty."""
    text = io.StringIO(newline="")
    table = csv.writer(text, lineterminator="\n")
    table.writerow([*keys, "quantity", "runs", "failed", "volume", "mean", "standard_deviation", *SIGN.decode().split(","),
                    "scale", "scale_low", "scale_high"])  # fmt: skip
    for each in samples:
        of = each.weibull
        told = ["", "", "", "", "", ""] if of is None else [of.modulus, *of.modulus_ends, of.scale, *of.scale_ends]
        table.writerow([*each.values, quantity, len(each.peaks), each.failed, each.volume, each.mean, each.deviation, *told])
    write_own(path, text.getvalue().encode("utf-8", "surrogateescape"), SIGN)
