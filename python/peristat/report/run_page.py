"""The page of one run."""

from pathlib import Path

from ..pictures.hdf5_reader import require_plain_file
from ..pictures.results_folder import ResultsFile, read_results_folder
from ..results import open_results
from . import overview, tables
from .body import body_content
from .curves import convergence, curves_of_run
from .markup import Raw, escaped, items, paragraph, section, text
from .page import MOST_BYTES, Page
from .sketch import sketch

MARGIN = 20_000  # bytes of what surrounds the numbers of the body
MOST_DOSSIER = 4 << 20


def run_page(directory: Path, _page_folder: Path) -> Page:
    """Everything that a results folder holds, as far as it can be read. Raises InputError if it is none, or damaged."""
    status = open_results(directory).status
    results = read_results_folder(directory)
    curves = curves_of_run(results)
    residuals = convergence(results)
    dossier = section("dossier", "Why it ended", text(_dossier(results), "folded"))
    parts = [
        "" if status == "completed" else dossier,
        section("model", "Model", sketch(results)),
        section("preflight", "Before the run", overview.preflight(results)),
        section("body", "Body", '<div id="body-view"></div>' if results.step_numbers else paragraph("No step has fields.")),
        section("curves", "Load, displacement and energies", _places(curves, "two")),
        section("ledger", "Ledger of energies", tables.ledger(results)),
        section("convergence", "Convergence", _places([residuals] if residuals else []) + tables.orders(results)),
        section("decisions", "Decisions of the load stepping", tables.decisions(results)),
        section("timings", "Timings", tables.timings(results)),
        dossier if status == "completed" else "",
        section("case", "Resolved case", text(_case_text(results)), is_open=False),
    ]  # fmt: skip
    page = Page(results.title, overview.head(results, status), parts, curves + ([residuals] if residuals else []))
    page.body = body_content(results, MOST_BYTES - len(page.text().encode()) - MARGIN)
    if page.body and page.body[0]["told"]:
        parts[3] = section("body", "Body", items(page.body[0]["told"], "warnings") + '<div id="body-view"></div>')
    parts.append(section("missing", "What this page lacks", items(results.missing)))
    page.sections = [Raw(_contents(parts)), *parts]
    return page


def _places(curves: list[dict], kind: str = "") -> str:
    """Elements in which the page's program draws the curves."""
    if not curves:
        return ""
    return (
        f'<div class="grid {kind}">'
        + "".join(f'<div class="curve" id="{curve["id"]}"></div>' for curve in curves)
        + "</div>"
    )


def _contents(parts: list[str]) -> str:
    """Links to the sections that there are."""
    links = []
    for part in filter(None, parts):
        name = part.partition('id="')[2].partition('"')[0]
        heading = part.partition("<h2>")[2].partition("</h2>")[0]
        links.append(f'<a href="#{name}">{heading}</a>')
    return f'<nav aria-label="sections">{"".join(links)}</nav>'


def _dossier(results) -> str:
    path = results.path / "dossier.txt"
    if not path.exists():
        return ""
    if require_plain_file(path) > MOST_DOSSIER:
        return f"{escaped(path.name)} is too long to be shown."
    return path.read_text("utf-8", errors="replace")


def _case_text(results) -> str:
    with ResultsFile(results.path) as file:
        return file.text("case/as_resolved") if "case/as_resolved" in file else ""
