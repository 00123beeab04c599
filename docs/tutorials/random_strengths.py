# %% [markdown]
# # Bars of random strength
#
# A chain is as strong as its weakest link, and a long chain is weaker than a short one. Two hundred bars with
# random strengths are pulled until they break: by a sweep over the seeds of the random field. Their peak loads are
# compared with the weakest bond of each bar, one by one, and with the distribution that probability theory gives.

# %%
import matplotlib.pyplot as plt
import numpy as np
import peristat as ps

# %% [markdown]
# ## A bar
#
# One dimension, points 1 mm apart, a section of 1 mm2. The horizon is one spacing, so that the bar is a chain of bonds.
# A bond breaks at a stretch of 1e-3 times the mean of its two points' random factors, which are Weibull-distributed
# with mean 1 and modulus 8. Mode `path` goes from one breaking bond to the next, so that the peak load is exact whatever
# the steps (`event_tolerance=0`: bonds that are nearly as weak do not break with it); the run ends when the force has fallen below half of its peak.

# %%
modulus, area, stretch, weibull = 70e9, 1e-6, 1e-3, 8.0  # Pa, m2, -, -
bars = 100  # of each length


def bar(points):
    case = ps.Case(f"bar_{points}", dimension=1)
    case.lattice.update(spacing="1 mm", area=area, horizon_ratio=1.0)
    case.lattice.add_shape(add="box", min=[0], max=[points * 1e-3])
    case.lattice.add_layer(name="left", side="x-", thickness=1)
    case.lattice.add_layer(name="right", side="x+", thickness=1)
    case.quadrature.volume_correction = "linear"  # a neighbour at the edge of the horizon counts half
    case.material.youngs_modulus = modulus
    case.material.damage = {"law": "critical_stretch", "critical": stretch}
    case.material.add_scatter(of="strength", weibull_modulus=weibull)
    case.add_support(set="left", displacement=["0"])
    case.add_support(set="right", displacement=[f"{1.5 * stretch * points * 1e-3} * load"])
    case.loading.update(stop_below=0.5, event_tolerance=0)
    case.solver.mode = "path"
    return case


# %%
lengths = [10, 100]
sweeps = {
    points: ps.sweep(bar(points), {"material.scatter[0].seed": range(1, bars + 1)}, quiet=True)
    for points in lengths
}


def peak(run):
    return run.history["reaction_x:right"].max()


peaks = {points: sweep.of(peak) for points, sweep in sweeps.items()}
for points, loads in peaks.items():
    print(f"{points} points: {loads.mean():.2f} N, standard deviation {loads.std(ddof=1):.2f} N")
sweeps[100][0].curve()

# %% [markdown]
# ## Each bar breaks at its weakest bond
#
# The results contain the factors of the points, in the order of the body. The force in the chain is the same
# everywhere, so that the bar must break at $E A$ times the smallest critical stretch, where this bond is.


# %%
def weakest(run):
    """Load of the weakest bond [N] and its place [m]."""
    order = run.positions[:, 0].argsort()
    factor, place = run.points["strength_factor"][order], run.positions[order, 0]
    means = (factor[1:] + factor[:-1]) / 2
    k = means.argmin()
    return modulus * area * stretch * means[k], (place[k] + place[k + 1]) / 2


worst = 0.0
for points, sweep in sweeps.items():
    for run, load in zip(sweep, peaks[points]):
        expected, place = weakest(run)
        broken = run.broken_bonds
        ends = run.positions[[broken["first_point"][0], broken["second_point"][0]], 0]
        assert abs(ends.mean() - place) < 1e-6
        worst = max(worst, abs(load / expected - 1))
print(f"largest deviation of a peak load from its weakest bond: {worst:.1e}")

# %% [markdown]
# ## The distribution
#
# Were the bonds independent of each other, the strengths of chains of $n$ of them would be Weibull-distributed again, with
# the same modulus $m$ and a mean smaller by $n^{-1/m}$. But neighbouring bonds share a point, and a mean of two
# factors varies less than one factor. The exact probability that all bonds survive a load is that of a chain in which each point
# depends on the one before: an integral per point, here a sum over 2000 equally probable factors.

# %%
from math import gamma

probable = (-np.log1p(-(np.arange(2000) + 0.5) / 2000)) ** (1 / weibull) / gamma(1 + 1 / weibull)  # ascending


def survival(points, loads):
    """Probability that a bar and its two points of layers bear a load [N]."""
    result = []
    for load in loads:
        needed = 2 * load / (modulus * area * stretch) - probable  # of the neighbour
        first = np.searchsorted(probable, needed)  # the first factor that suffices
        alive = np.ones(len(probable))
        for _ in range(points + 1):
            alive = np.append(np.cumsum(alive[::-1])[::-1], 0)[first] / len(probable)
        result.append(alive.mean())
    return np.array(result)


loads = np.linspace(0, 100, 401)  # N
chances = {points: survival(points, loads) for points in lengths}
figure, axes = plt.subplots(figsize=(7, 3.6), layout="constrained")
means, fits = {}, {}
for points, colour in zip(lengths, ("C0", "C1")):
    sorted_peaks = np.sort(peaks[points])
    ranks = (np.arange(bars) + 0.7) / (bars + 0.4)  # median ranks
    fits[points], offset = np.polyfit(np.log(sorted_peaks), np.log(-np.log1p(-ranks)), 1)
    scale = np.exp(-offset / fits[points])
    means[points] = np.trapz(chances[points], loads)
    axes.hist(sorted_peaks, bins=15, density=True, alpha=0.4, color=colour, label=f"{points} points")
    axes.plot(loads, -np.gradient(chances[points], loads), color=colour, label="exact")
    fitted = np.exp(-((loads / scale) ** fits[points]))
    axes.plot(loads, -np.gradient(fitted, loads), color=colour, ls="--", label=f"Weibull fit, m = {fits[points]:.1f}")
    error = peaks[points].std(ddof=1) / np.sqrt(bars)
    print(f"{points} points: mean {peaks[points].mean():.2f} +- {error:.2f} N, exact {means[points]:.2f} N")
    print(f"    were its bonds independent: {modulus * area * stretch * (points + 1) ** (-1 / weibull):.2f} N")
axes.set(xlabel="peak load [N]", ylabel="density [1/N]", xlim=(25, 75))
axes.legend();

# %% [markdown]
# The longer bars are weaker by a sixth, and each set's mean agrees with the exact one within the error of a sample of a
# hundred. The Weibull modulus of the bars is above that of the factors, 8, because a bond has the mean of two factors:
# what is put into a random field is not what a test of bars gives back.
#
# **For your own problem.** `weibull_modulus` and the mean are to be fitted to the tests, not taken from them.
# A `correlation_length` gives flaws a size that does not depend on the spacing. In 2D and 3D the same sweep works, with
# mode `adaptive` for large bodies; `ps.sweep(..., jobs=2)` runs bodies side by side.

# %%
assert worst < 1e-6
for points in lengths:
    error = peaks[points].std(ddof=1) / np.sqrt(bars)
    assert abs(peaks[points].mean() - means[points]) < 3 * error
    assert 0.8 * weibull < fits[points] < 2 * weibull
assert np.isclose(survival(1, loads)[0], 1.0)
# A bar without points of its own would be one bond: the mean of two factors has the mean 1.
assert abs(np.trapz(survival(0, np.linspace(0, 140, 1401)), dx=0.1) - modulus * area * stretch) < 0.1
