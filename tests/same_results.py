"""Whether two results folders are equal to the last bit."""

import json
import pathlib

import h5py
import numpy

TABLES = ["history.csv", "iterations.csv", "decisions.csv", "broken_bonds.csv", "convergence.csv",
          "results.xdmf", "load_displacement.csv"]  # fmt: skip
# Durations, and files that an interruption rewrites, are no results.
COSTS = ["seconds", "peak_memory_bytes", "factorisations", "linear_iterations"]


def _datasets(file):
    found = {}
    for group in ("points", "steps", "xdmf", "cracks", "history", "iterations", "decisions", "broken_bonds"):
        if group in file:
            file[group].visititems(lambda name, object, of=group: found.update({f"{of}/{name}": object[...]})
                                   if isinstance(object, h5py.Dataset) else None)  # fmt: skip
    return found


def differences(folder, other):
    """Names of files and datasets that differ."""
    folder, other = pathlib.Path(folder), pathlib.Path(other)
    different = [name for name in TABLES if (folder / name).read_bytes() != (other / name).read_bytes()]
    with h5py.File(folder / "results.h5") as one, h5py.File(other / "results.h5") as two:
        some, others = _datasets(one), _datasets(two)
    different += sorted(some.keys() ^ others.keys())
    different += [name for name in some.keys() & others.keys()
                  if not numpy.array_equal(some[name], others[name])]  # fmt: skip
    summaries = [json.loads((path / "summary.json").read_text()) for path in (folder, other)]
    return different + [f"summary.json {key}" for key in summaries[0]
                        if key not in COSTS and summaries[0][key] != summaries[1][key]]  # fmt: skip
