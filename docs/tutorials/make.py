"""Makes notebooks of the tutorials: /usr/bin/python3 docs/tutorials/make.py [NAME ...]

The sources are the Python files beside this one, whose cells begin with "# %%" (code) and "# %% [markdown]". Each
notebook is executed in a temporary folder and contains what its cells print and draw, without what differs from one
machine to the next.
"""

import base64
import io
import os
import pathlib
import re
import sys
import tempfile

import nbformat

HERE = pathlib.Path(__file__).resolve().parent
PACKAGE = HERE.parents[1] / "python"
DOTS_PER_INCH, LARGEST = 72, 1000  # of pictures, the largest side in pixels
# "memory  about 84 MB of ...", ", 2 threads", "completed in 1.47 s: ..."
OF_THIS_MACHINE = re.compile(
    r"^(memory|time|solver|linear solver:) .*\n|, \d+ threads\b|(?<=^completed) in [^:]*(?=:)", re.M
)


def names() -> list[str]:
    """Names of the tutorials."""
    return sorted(path.stem for path in HERE.glob("*.py") if path.name != "make.py")


def notebook(name: str) -> nbformat.NotebookNode:
    """The notebook of a tutorial, not executed."""
    text = (HERE / f"{name}.py").read_text("utf-8")
    before, *pieces = re.split(r"^# %%(.*)\n", text, flags=re.M)
    if before.strip():
        raise ValueError(f"{name}.py: text before the first cell")
    cells = []
    for kind, source in zip(pieces[::2], pieces[1::2], strict=True):
        source = source.strip("\n")
        if kind.strip() == "[markdown]":
            cells.append(nbformat.v4.new_markdown_cell(re.sub(r"^# ?", "", source, flags=re.M)))
        else:
            cells.append(nbformat.v4.new_code_cell(source))
    for number, cell in enumerate(cells):
        cell.id = f"cell-{number}"
    made = nbformat.v4.new_notebook(cells=cells)
    made.metadata.kernelspec = {"name": "python3", "display_name": "Python 3", "language": "python"}
    return made


def execute(made: nbformat.NotebookNode) -> None:
    """Executes a notebook in a temporary folder."""
    import nbclient  # the test that compares sources goes without

    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [str(PACKAGE), os.environ.get("PYTHONPATH")]))
    os.environ |= {"OMP_WAIT_POLICY": "passive", "PYDEVD_DISABLE_FILE_VALIDATION": "1"}
    os.environ.pop("MPLBACKEND", None)  # pictures belong into the notebook
    pictures = f"%config InlineBackend.print_figure_kwargs = {{'dpi': {DOTS_PER_INCH}, 'bbox_inches': 'tight'}}"
    made.cells.insert(0, nbformat.v4.new_code_cell(pictures))
    with tempfile.TemporaryDirectory() as folder:
        nbclient.NotebookClient(made, timeout=600, resources={"metadata": {"path": folder}}).execute()
    del made.cells[0]
    made.metadata.pop("language_info", None)
    for cell in made.cells:
        cell.metadata.clear()  # times of execution
        if cell.cell_type == "code":
            cell.execution_count = None
            cell.outputs = _joined([_cleaned(output, folder) for output in cell.outputs])


def _cleaned(output: nbformat.NotebookNode, folder: str) -> nbformat.NotebookNode:
    """The output without what differs from one machine to the next."""
    if "execution_count" in output:
        output.execution_count = None
    if "text" in output:
        output.text = OF_THIS_MACHINE.sub("", output.text).replace(f"{folder}/", "")
    if "image/png" in output.get("data", {}):
        output.data = {"image/png": _smaller(output.data["image/png"])}
    return output


def _smaller(picture: str) -> str:
    """A PNG, in base64, made smaller if it is larger than LARGEST."""
    from PIL import Image

    file = io.BytesIO()
    drawn = Image.open(io.BytesIO(base64.b64decode(picture))).convert("RGB")
    drawn.thumbnail((LARGEST, LARGEST), Image.Resampling.LANCZOS)
    drawn.save(file, "png", optimize=True)
    return base64.b64encode(file.getvalue()).decode()


def _joined(outputs: list[nbformat.NotebookNode]) -> list[nbformat.NotebookNode]:
    """Texts that follow each other as one: how they were divided depends on the time."""
    joined: list[nbformat.NotebookNode] = []
    for output in outputs:
        if "text" in output and joined and joined[-1].get("name") == output.name:
            joined[-1].text += output.text
        elif output.get("text") != "":
            joined.append(output)
    return joined


if __name__ == "__main__":
    for name in sys.argv[1:] or names():
        made = notebook(name)
        execute(made)
        nbformat.write(made, HERE / f"{name}.ipynb")
        print(name)
