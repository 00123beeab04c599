"""Weibull's distribution of strengths, P(strength < x) = 1 - exp(-(x / scale)^m), by maximum likelihood."""

from dataclasses import dataclass

import numpy as np

FEWEST = 5  # values of a sample
SAMPLES, SEED = 4000, 20240229  # of the simulation that gives confidence intervals: their ends vary by about 1 %
TAILS = (0.025, 0.975)


@dataclass(frozen=True)
class Weibull:
    """Estimates with their 95 % confidence intervals."""

    modulus: float
    modulus_ends: tuple[float, float]
    scale: float
    scale_ends: tuple[float, float]


def likeliest(samples: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Moduli and scales of the largest likelihood of samples in rows, whose values differ.

    The modulus m solves sum(x^m log x) / sum(x^m) - 1/m = mean(log x), of which the left side grows with m; then
    scale^m = mean(x^m).
    """
    logs = np.log(samples)
    logs = logs - logs.max(axis=1, keepdims=True)  # powers do not overflow
    m = np.pi / 6.0**0.5 / logs.std(axis=1)  # by moments
    for _ in range(60):
        powers = np.exp(m[:, None] * logs)
        total = powers.sum(axis=1)
        first, second = (powers * logs).sum(axis=1) / total, (powers * logs**2).sum(axis=1) / total
        value = first - 1.0 / m - logs.mean(axis=1)
        step = value / (second - first**2 + 1.0 / m**2)
        m = np.maximum(m - step, 0.1 * m)
        if (np.abs(step) <= 1e-12 * m).all():
            break
    scale = np.exp(np.log(np.exp(m[:, None] * logs).mean(axis=1)) / m + np.log(samples).max(axis=1))
    return m, scale


def fit_weibull(values: np.ndarray) -> Weibull:
    """Estimates from a sample of at least FEWEST different values.

    The intervals are exact but for their simulation: the distributions of estimate / m and of
    estimate * log(estimated scale / scale) depend on nothing but the number of values [Thoman et al. 1969].
    """
    (modulus,), (scale,) = likeliest(values[None, :])
    ratio, shift = likeliest(np.random.default_rng(SEED).weibull(1.0, (SAMPLES, len(values))))
    low, high = np.quantile(ratio, TAILS)
    below, above = np.quantile(ratio * np.log(shift), TAILS)
    return Weibull(float(modulus), (float(modulus / high), float(modulus / low)), float(scale),
                   (float(scale * np.exp(-above / modulus)), float(scale * np.exp(-below / modulus))))  # fmt: skip


def median_ranks(count: int) -> np.ndarray:
    """Probabilities at which the values of a sorted sample are drawn [Benard and Bos-Levenbach 1953]."""
    return (np.arange(1, count + 1) - 0.3) / (count + 0.4)
