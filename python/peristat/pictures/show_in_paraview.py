"""Shows a results folder in ParaView: damage on the displaced cells, and the broken bonds as lines.

    paraview --script=FOLDER/plots/show_in_paraview.py
    pvpython FOLDER/plots/show_in_paraview.py [--vtkhdf] --picture FILE.png

`./peristat plot FOLDER --paraview` puts this file into the folder. The second command draws the last step without a
window; with --vtkhdf the cells come from results.vtkhdf. The lines always come from results.xdmf.
"""

import argparse
import math
import sys
from pathlib import Path

from paraview import simple

FOLDER = None  # where the results were when this file was written
LARGEST = 0.02  # displacement that is shown, per size of the body
SIZE = [1200, 800]  # of a picture, in pixels


def results_folder() -> Path:
    """The folder around this file, or where it was written: ParaView's window does not tell a script its file."""
    own = globals().get("__file__")
    beside = Path(own).resolve().parent.parent if own else None
    return beside if beside and (beside / "results.xdmf").is_file() else Path(FOLDER or ".")


def read_grids(folder: Path, name: str):
    """A reader of the grids `name` of all steps of results.xdmf; None if there are none."""
    reader = simple.XDMFReader(registrationName=name, FileNames=[str(folder / "results.xdmf")])
    reader.UpdatePipelineInformation()
    grids = [grid for grid in reader.GetProperty("GridStatus").Available if grid.partition("[")[0] == name]
    if not grids:
        simple.Delete(reader)
        return None
    reader.GridStatus = grids
    return reader


def largest(source, name: str, where: str) -> float:
    """Largest size of an array."""
    data = source.CellData if where == "CELLS" else source.PointData
    array = data.GetArray(name)
    if array is None:
        return 0.0
    if array.GetNumberOfComponents() == 1:
        return max(map(abs, array.GetRange(0)))
    return array.GetRange(-1)[1]


def round_factor(displacement: float, size: float) -> float:
    """Factor 1, 2 or 5 times a power of ten that makes displacements visible; not below 1."""
    if not displacement > 0.0:
        return 1.0
    wanted = LARGEST * size / displacement
    power = 10.0 ** math.floor(math.log10(wanted))
    return max(1.0, max(step * power for step in (1, 2, 5) if step * power <= wanted))


def displaced(source, factor: float):
    """The source with its points moved by `factor` times the displacement."""
    warped = simple.WarpByVector(Input=source)
    warped.Vectors = ["POINTS", "displacement"]
    warped.ScaleFactor = factor
    return warped


def show(folder: Path, uses_vtkhdf: bool):
    """Builds the pipeline and returns the view."""
    view = simple.GetActiveViewOrCreate("RenderView")
    view.ViewSize = SIZE
    bodies, lines = read_grids(folder, "body"), read_grids(folder, "broken_bonds")
    last = bodies.TimestepValues[-1] if len(bodies.TimestepValues) else 0.0  # a single step is no list of times
    view.ViewTime = last
    if uses_vtkhdf:
        bodies = simple.VTKHDFReader(registrationName="body in results.vtkhdf",
                                     FileName=[str(folder / "results.vtkhdf")])  # fmt: skip
    bodies.UpdatePipeline(last)
    bounds = bodies.GetDataInformation().GetBounds()
    size = max(bounds[1] - bounds[0], bounds[3] - bounds[2], bounds[5] - bounds[4])
    factor = round_factor(largest(bodies, "displacement", "CELLS"), size)

    # Each cell has corners of its own, so that its displacement becomes that of its corners and cells come apart. In
    # a body without cracks corners are shared, and get the mean displacement of the cells around them.
    whole = bodies
    if lines is None:
        whole = simple.CleantoGrid(Input=simple.MergeBlocks(Input=bodies))
        whole.ToleranceIsAbsolute, whole.AbsoluteTolerance = 1, 1e-9 * size
    cells = displaced(simple.CellDatatoPointData(Input=whole, PassCellData=1), factor)
    shown = simple.Show(cells, view)
    shown.Representation = "Surface"
    damage = largest(bodies, "damage", "CELLS")
    field = "damage" if damage > 0.0 else "displacement"
    simple.ColorBy(shown, ("CELLS", field))
    table = simple.GetColorTransferFunction(field)
    table.ApplyPreset("Viridis (matplotlib)", True)
    if field == "damage":
        table.RescaleTransferFunction(0.0, damage)
    shown.SetScalarBarVisibility(view, True)
    if lines is not None:
        cracks = simple.Show(displaced(lines, factor), view)
        cracks.Representation = "Wireframe"
        cracks.ColorArrayName = ["POINTS", ""]
        cracks.AmbientColor = cracks.DiffuseColor = [0.85, 0.1, 0.1]
        cracks.LineWidth, cracks.Opacity = 1.0, 0.3  # what is below them stays visible
    words = simple.Show(simple.Text(Text=f"{folder.name}: step {last:g}, displacements x {factor:g}"), view)
    words.Color, words.FontSize = [0.0, 0.0, 0.0], 16

    view.UseColorPaletteForBackground = 0
    view.Background = [1.0, 1.0, 1.0]
    view.OrientationAxesVisibility = 0
    bar = simple.GetScalarBar(table, view)
    bar.TitleColor = bar.LabelColor = [0.0, 0.0, 0.0]
    bar.WindowLocation = "Lower Right Corner"
    is_flat = bounds[5] - bounds[4] <= 1e-9 * size
    if is_flat:
        view.InteractionMode = "2D"
        simple.ResetCamera(view)
    else:
        view.CameraPosition = [1.6 * size, -2.2 * size, 1.4 * size]
        view.CameraFocalPoint = [0.0, 0.0, 0.0]
        view.CameraViewUp = [0.0, 0.0, 1.0]
        simple.ResetCamera(view)
    simple.Render(view)
    return view


def main(words: list) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=Path, help="results folder (default: the one around this file)")
    parser.add_argument("--vtkhdf", action="store_true", help="read the cells from results.vtkhdf")
    parser.add_argument("--picture", type=Path, help="PNG to write")
    arguments = parser.parse_args(words)
    folder = (arguments.folder or results_folder()).resolve()
    if not (folder / "results.xdmf").is_file():
        sys.exit(f"{folder}: no results folder with steps (it has no results.xdmf)")
    view = show(folder, arguments.vtkhdf)
    if arguments.picture:
        simple.SaveScreenshot(str(arguments.picture), view, ImageResolution=SIZE, CompressionLevel="9")


main(sys.argv[1:] if globals().get("__file__") else [])
