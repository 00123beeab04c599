"""Fenced blocks of pages: commands, case files and parts of them."""

import re
import shlex
import typing

from tests.reference.program import ROOT

PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]


class Block(typing.NamedTuple):
    language: str
    text: str
    before: str  # the last paragraph before the block


def blocks(path):
    """The page's fenced blocks in their order."""
    pieces = re.split(r"^```", path.read_text("utf-8"), flags=re.MULTILINE)
    if len(pieces) % 2 == 0:
        raise AssertionError(f"{path.name}: a fence is not closed")
    found = []
    for before, block in zip(pieces[::2], pieces[1::2]):
        language, _, text = block.partition("\n")
        found.append(Block(language.strip(), text, before.strip().rpartition("\n\n")[2]))
    return found


def cases(path):
    """Case files of the page, by name. Blocks whose paragraph names the same file in `…` are parts of it."""
    files = {}
    for block in blocks(path):
        named = re.findall(r"`([\w-]+\.toml)`", block.before)
        if block.language == "toml" and named:
            files[named[-1]] = files.get(named[-1], "") + block.text + "\n"
    return files


def parts(path, mark):
    """Case and text of the blocks below a line `<!-- mark: STUDY/NAME -->`."""
    found = [(re.search(rf"<!-- {mark}: (\S+) -->$", block.before), block.text) for block in blocks(path) if block.language == "toml"]
    return [(told[1], text) for told, text in found if told]


def lines(path):
    """Command lines of the page as lists of words. Blocks without a language count if they begin with a command."""
    said = [block.text for block in blocks(path) if block.language == "sh"]
    said += [block.text for block in blocks(path)
             if block.language == "" and re.match(r"(\./peristat|peristat|cmake|apt|docker) ", block.text)]  # fmt: skip
    text = "\n".join(said).replace("\\\n", " ")
    return [words for line in re.sub(r"\"\n.*?\n[^\n]*\"", '""', text, flags=re.DOTALL).splitlines()
            if (words := shlex.split(line, comments=True))]  # fmt: skip
