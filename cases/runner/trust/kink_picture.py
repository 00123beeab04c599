"""The picture of kinked cracks: directions that were found over those of fracture mechanics."""

from pathlib import Path

import kink_table
from own_files import PICTURE, picture, write_own

COLOURS = {"0°": "tab:red", "18°": "tab:orange", "27°": "tab:purple", "45°": "tab:brown", kink_table.NOISE: "tab:blue",
           kink_table.FINER: "tab:cyan"}  # fmt: skip


def draw(found: kink_table.Results, path: Path) -> None:
    import matplotlib

    matplotlib.use("Agg")
    matplotlib.rcParams["svg.hashsalt"] = "peristat"  # the same picture in every run
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(6, 5.4), layout="constrained")
    ends = [min(kink_table.REFERENCE.values()) - 8, 0]
    axes.fill_between(ends, [end - kink_table.ALLOWED for end in ends], [end + kink_table.ALLOWED for end in ends],
                      color="tab:green", alpha=0.15)  # fmt: skip
    axes.plot(ends, ends, color="black", linewidth=0.8)
    for loading, _ in found:
        marker = "o" if loading.stress == 0 else "v" if loading.stress < 0 else "^"
        for name, ones in kink_table.columns(found, loading).items():
            axes.plot([kink_table.REFERENCE[loading]] * len(ones), [one.direction for one in ones], marker,
                      color=COLOURS[name], fillstyle="full" if loading.stress == 0 else "none")  # fmt: skip
    for name, colour in COLOURS.items():
        axes.plot([], [], "o", color=colour, label=f"lattice {name}" if name.endswith("°") else name)
    for marker, name in (("o", "T = 0"), ("v", "T < 0"), ("^", "T > 0")):
        axes.plot([], [], marker, color="black", fillstyle="full" if marker == "o" else "none", label=name)
    axes.set_xlabel("path with $K_{II}$ = 0 [degrees]")
    axes.set_ylabel("direction of the crack [degrees]")
    axes.legend(fontsize=8)
    write_own(path, picture(figure, "svg"), PICTURE)
    pyplot.close(figure)
