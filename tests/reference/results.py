"""Contents of a results folder (docs/results.md)."""

import csv
import json
import pathlib

import h5py
import numpy


def table(path):
    """Rows of a table, numbers as floats."""
    with open(path, newline="") as file:
        return [{key: number_or_text(value) for key, value in row.items()} for row in csv.DictReader(file)]


class Step:
    """An accepted step that was written with fields."""

    def __init__(self, group):
        self.number, self.load = int(group.attrs["step"]), float(group.attrs["load_factor"])
        mode = group.attrs["mode"]
        self.mode = mode.decode() if isinstance(mode, bytes) else str(mode)
        self.fields = {name: item[...] for name, item in group.items() if isinstance(item, h5py.Dataset)}
        self.history = None
        if "history" in group:
            self.history = {name: item[...] for name, item in group["history"].items()}

    def __getattr__(self, name):
        try:
            return self.__dict__["fields"][name]
        except KeyError:
            raise AttributeError(name) from None


class Results:
    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        with h5py.File(self.folder / "results.h5") as file:
            self.reference = file["points/reference"][...]
            self.volume = file["points/volume"][...]
            ids = file["points/set_ids"]
            names = [name.decode() if isinstance(name, bytes) else str(name) for name in ids.attrs.get("sets", [])]
            self.sets = {name: ids[:, k] == 1 for k, name in enumerate(names)}
            self.image_kinds = ()  # mirrors and shifts of images beyond planes and periods
            if "points/images" in file:
                self.image_kinds = (file["points/images/mirror"][...], file["points/images/shift"][...])
            names = [name for name in ("stiffness", "strength") if f"points/{name}_factor" in file]
            self.factors = {name: file[f"points/{name}_factor"][...] for name in names}
            self.steps = [Step(group) for _, group in sorted(file["steps"].items())] if "steps" in file else []
        path = self.folder / "summary.json"
        self.summary = json.loads(path.read_text()) if path.exists() else None

    def table(self, name):
        return table(self.folder / f"{name}.csv")


def number_or_text(text):
    try:
        return float(text)
    except ValueError:
        return text


def not_finite(folder):
    """Names of files and datasets in a results folder with values that are not finite."""
    folder, found = pathlib.Path(folder), []
    words = {"nan", "-nan", "inf", "-inf", "infinity", "-infinity"}
    for path in sorted(folder.glob("*.csv")):
        if path.name == "convergence.csv" or path.stat().st_size < 50_000_000:
            with open(path, newline="") as file:
                if any(cell.strip().lower() in words for row in csv.reader(file) for cell in row):
                    found.append(path.name)
    path = folder / "summary.json"
    if path.exists():
        json.loads(path.read_text(), parse_constant=lambda word: found.append(f"summary.json: {word}"))
    path = folder / "results.h5"
    if path.exists():
        with h5py.File(path) as file:

            def visit(name, item):
                if isinstance(item, h5py.Dataset) and item.dtype.kind == "f" and not numpy.isfinite(item[...]).all():
                    found.append(f"results.h5:/{name}")

            file.visititems(visit)
    return found
