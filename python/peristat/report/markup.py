"""Pieces of HTML. Whatever comes from a run is escaped here."""

import html
import json
from collections.abc import Iterable, Sequence

MOST_ROWS = 400
MOST_LETTERS = 120_000  # of a text that the page shows


def escaped(value) -> str:
    return html.escape(str(value))


def section(name: str, heading: str, content: str, is_open: bool = True) -> str:
    """A part of the page that can be folded; empty if it has nothing to show."""
    if not content:
        return ""
    state = " open" if is_open else ""
    return f'<details id="{name}"{state}><summary><h2>{escaped(heading)}</h2></summary>\n{content}\n</details>\n'


def paragraph(text: str, kind: str = "note") -> str:
    return f'<p class="{kind}">{escaped(text)}</p>' if text else ""


def items(sentences: Iterable[str], kind: str = "") -> str:
    rows = "".join(f"<li>{escaped(sentence)}</li>" for sentence in sentences)
    return f'<ul class="{kind}">{rows}</ul>' if rows else ""


def table(names: Sequence[str], rows: Sequence[Sequence], numbers: Iterable[int] = ()) -> str:
    """A table; of a long one the first and last rows, with a row that says so. `numbers` are columns of numbers."""
    right, half = set(numbers), MOST_ROWS // 2
    if len(rows) <= MOST_ROWS:
        shown = [_row("td", row, right) for row in rows]
    else:
        words = f"… {len(rows) - MOST_ROWS} rows are left out; the tables of the results folder have them …"
        shown = [_row("td", row, right) for row in rows[:half]]
        shown.append(f'<tr><td colspan="{len(names)}">{words}</td></tr>')
        shown += [_row("td", row, right) for row in rows[-half:]]
    head = f"<thead>{_row('th', names, right)}</thead>"
    return f'<div class="scroll" tabindex="0"><table>{head}<tbody>{"".join(shown)}</tbody></table></div>'


def _row(kind: str, row: Sequence, right: set[int]) -> str:
    """A row of cells; those of numbers stand to the right."""
    cells = [value if isinstance(value, Raw) else escaped(value) for value in row]
    marks = [" class=number" * (place in right) for place in range(len(cells))]
    return "<tr>" + "".join(f"<{kind}{mark}>{cell}</{kind}>" for mark, cell in zip(marks, cells)) + "</tr>"


class Raw(str):
    """HTML that this package has made."""


def text(content: str, kind: str = "") -> str:
    """A longer text as it is; its end is left out if it is very long."""
    if not content.strip():
        return ""
    cut = "" if len(content) <= MOST_LETTERS else paragraph(f"The first {MOST_LETTERS} of {len(content)} characters:")
    return f'{cut}<pre class="{kind}" tabindex="0">{escaped(content[:MOST_LETTERS])}</pre>'


def as_json(content) -> str:
    """JSON within a script element, which no text can end. Raises ValueError for numbers that JSON does not have."""
    return json.dumps(content, allow_nan=False, separators=(",", ":"), ensure_ascii=False).replace("<", "\\u003c")
