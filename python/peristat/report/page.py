"""The file of a page: title, sections, numbers and program in one text that needs no network."""

import os
from dataclasses import dataclass, field
from pathlib import Path

from ..errors import InputError
from .markup import as_json, escaped
from .packing import compressed

SIGN = "<!-- made by peristat report -->"  # in the second line, by which a later report knows its own file
MOST_BYTES = 2_000_000
POLICY = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:"


@dataclass
class Page:
    """What a page shows.

    head      HTML above the sections
    sections  HTML of the sections, in order, by name and heading
    curves    drawn where a section has an element of their id
    body      what the page says about a body, and its numbers (body.py)
    """

    title: str
    head: str
    sections: list[str]
    curves: list[dict] = field(default_factory=list)
    body: tuple[dict, str] | None = None

    def text(self) -> str:
        program = program_folder()
        about, numbers = self.body or (None, "")
        content = as_json({"curves": self.curves, "body": about})
        parts = {name: (program / name).read_text("utf-8") for name in ("main.css", "loader.js", "licences.txt")}
        return f"""<!doctype html>
{SIGN}
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="{POLICY}">
<link rel="icon" href="data:,">
<title>{escaped(self.title)}</title>
<style>{parts["main.css"]}</style>
</head>
<body>
<header>
{self.head}
</header>
<main>
{"".join(self.sections)}
</main>
<footer>
<details><summary>Licences of what draws this page</summary><pre class="folded">{escaped(parts["licences.txt"])}</pre></details>
</footer>
<script type="application/json" id="content">{content}</script>
<script type="text/plain" id="numbers">{numbers}</script>
<script type="text/plain" id="program">{compressed((program / "main.js").read_bytes())}</script>
<script>{parts["loader.js"]}</script>
</body>
</html>
"""


def program_folder() -> Path:
    """The folder of the page's program: that of an installed package, or that which the launcher has built."""
    here = Path(__file__).resolve()
    places = [here.parent / "program", here.parents[3] / "build/report"]
    if named := os.environ.get("PERISTAT_REPORT_PROGRAM"):
        places = [Path(named)]
    for place in places:
        if (place / "main.js").is_file():
            return place
    raise InputError("the page's program has not been built: `./peristat report DIR` builds it once")
