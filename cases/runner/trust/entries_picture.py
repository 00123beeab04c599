"""The picture of the suite: every quantity over its reference against the horizon, with its uncertainty."""

from pathlib import Path

from own_files import PICTURE, picture, write_own
from verdict import Verdict

COLUMNS = 4


def draw(found: list[Verdict], path: Path) -> None:
    import matplotlib

    matplotlib.use("Agg")
    matplotlib.rcParams["svg.hashsalt"] = "peristat"  # the same picture in every run
    from matplotlib import pyplot

    shown = [verdict for verdict in found if verdict.values]
    lines = -(-len(shown) // COLUMNS)
    figure, axes = pyplot.subplots(lines, COLUMNS, figsize=(4 * COLUMNS, 3.1 * lines), squeeze=False, layout="constrained")
    for place, verdict in zip(axes.flat, shown):
        _draw_entry(place, verdict)
    for place in list(axes.flat)[len(shown) :]:
        place.set_axis_off()
    write_own(path, picture(figure, "svg"), PICTURE)
    pyplot.close(figure)


def _draw_entry(axes, of: Verdict) -> None:
    horizon = lambda lattice: 1e3 * of.specimen.spacing(lattice) * lattice.ratio
    axes.axhspan(1 - of.measure.allowed, 1 + of.measure.allowed, color="tab:green", alpha=0.15)
    axes.axhline(1, color="black", linewidth=0.8)
    straight = of.straight
    axes.plot([horizon(lattice) for lattice in straight], [of.values[lattice] for lattice in straight], "o-", color="tab:blue")
    limit, uncertainty = of.extrapolated
    if uncertainty is not None:
        axes.errorbar(horizon(straight[-1]), of.values[straight[-1]], yerr=uncertainty, color="tab:blue", capsize=4)
    if limit is not None:
        axes.plot(0, limit, "s", color="tab:blue", fillstyle="none")
    others = [lattice for lattice in of.values if not lattice.is_straight]
    axes.plot([horizon(lattice) for lattice in others], [of.values[lattice] for lattice in others], "x", color="tab:orange")
    if of.corrected is not None and of.measure.of_longer_crack is not None and of.extension:
        axes.plot(horizon(of.judged_at), of.corrected, "d", color="tab:green")
    axes.set_title(f"{of.specimen.name}: {of.measure.quantity}" + ("" if of.passes else " (red)"), fontsize=9,
                   color="black" if of.passes else "tab:red")  # fmt: skip
    axes.set_xlim(left=0)
    axes.set_ylim(min(0.7, *of.values.values()) - 0.03, max(1.15, *of.values.values()) + 0.03)
    axes.set_xlabel("horizon [mm]", fontsize=8)
    axes.tick_params(labelsize=8)
