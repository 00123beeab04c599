"""Where a crack turns under mixed mode, on lattices at several angles and on blue noise, beside fracture mechanics."""

import itertools
from collections.abc import Callable
from pathlib import Path

import kink_picture
import kink_table
import kinked_disk
from kinked_disk import Loading, Points
from own_files import PICTURE, write_own
from run_all import Failed, Ran, Runs
from specimen import ANGLES

FILES = {"kink.md": kink_table.TABLE, "kink.csv": kink_table.SIGN, "kink.svg": PICTURE}  # and their signatures
QUICK = (Loading(0.577, 0.0), Loading(0.364, -0.2))
POINTS = [*map(Points, ANGLES), *(Points(seed=seed, finer=finer) for finer in (1, 2) for seed in (1, 2, 3))]


def settings(quick: bool) -> list[tuple[Loading, Points]]:
    """Without and with T-stress; quick: two of the loadings, along the lattice."""
    return list(itertools.product(QUICK, POINTS[:1]) if quick else itertools.product(kink_table.REFERENCE, POINTS))


def measure(runs: Runs, directory: Path, quick: bool, tell: Callable[[str], None]) -> bool:
    """Writes kink.md, kink.csv and, if several kinds of points were run, kink.svg. Returns whether every direction is
    within what is allowed."""
    by_name = {f"kink/{loading.name}_{points.name}": (loading, points) for loading, points in settings(quick)}
    found = {}
    for ran in runs.run({name: kinked_disk.text(*of) for name, of in by_name.items()}):
        found[by_name[ran.name]] = of_run(ran, *by_name[ran.name], tell)
    if runs.interrupted:
        return False
    found = {setting: found[setting] for setting in by_name.values()}
    table = kink_table.table(found)
    write_own(directory / "kink.csv", kink_table.values(found).encode(), FILES["kink.csv"])
    write_own(directory / "kink.md", table.encode(), FILES["kink.md"])
    if not quick:
        kink_picture.draw(found, directory / "kink.svg")
    tell("\n" + table)
    return not any(kink_table.faults(found, loading) for loading, _ in found)


def of_run(ran: Ran, loading: Loading, points: Points, tell: Callable[[str], None]) -> kinked_disk.Found:
    try:
        found = ran.value(lambda folder: kinked_disk.find(loading, points, folder))
        tell(f"{ran.name}: {found.direction:.1f} degrees where {kink_table.REFERENCE[loading]:.1f} are due")
    except Failed as failure:
        found = kinked_disk.Found(note=str(failure))
        tell(f"{ran.name}: {failure}")
    return found
