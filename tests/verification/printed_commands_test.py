"""Commands in README, pages and headers of cases are accepted, and do what the text says."""

import re
import shlex
import unittest

from tests.acceptance.folder import Folder
from tests.reference.program import ROOT, settings
from tests.reference.results import table

PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


def blocks(path, language):
    """Texts of the page's code blocks in a language ("": none is named)."""
    fenced = path.read_text().split("```")[1::2]
    return [text for head, _, text in (block.partition("\n") for block in fenced) if head == language]


def commands(path):
    """Words of the command lines in the page's shell blocks, without `./peristat`."""
    lines = "\n".join(blocks(path, "sh") + blocks(path, "")).replace("\\\n", " ").splitlines()
    return [shlex.split(line, comments=True)[1:] for line in lines if line.startswith("./peristat ")]


class Commands(Folder):
    def setUp(self):
        super().setUp()
        (self.folder / "cases").symlink_to(ROOT / "cases")
        (strip,) = (text for text in blocks(ROOT / "README.md", "toml") if 'title = "Pulled strip"' in text)
        (self.folder / "strip.toml").write_text(strip)

    def assert_accepted(self, words):
        """Runs `check`, which reads a case as `run` does; for `sweep` with its first values."""
        command, *rest = words
        sets = [rest[k + 1] for k, word in enumerate(rest) if word == "--set"]
        sets += [re.split(r",(?![^\[]*\])", rest[k + 1])[0] for k, word in enumerate(rest) if word == "--vary"]
        ended = self.peristat(*words) if command == "calibrate" else self.peristat("check", rest[0], *settings(*sets))
        self.assertEqual(ended.code, 0, f"{' '.join(words)}\n{ended.said}")

    def test_are_accepted(self):
        asked = [(page.name, words) for page in PAGES for words in commands(page)
                 if words[0] in ("run", "check", "check-tangent", "sweep", "calibrate")]  # fmt: skip
        self.assertGreater(len(asked), 20)
        for page, words in asked:
            with self.subTest(page=page, command=" ".join(words)):
                self.assert_accepted(words)

    def test_settings_within_the_text_are_accepted(self):
        """`--set …` within the tutorial's sentences, for the case of the last command before them."""
        text, case, tried = (ROOT / "docs/tutorial-fracture.md").read_text(), None, 0
        for line in text.splitlines():
            if named := re.match(r"\./peristat \w+ (cases/\S+)", line):
                case = named[1]
            for quoted in re.findall(r"`(--set [^`…]*)`", line):
                mode = ["--set", "solver.mode=relaxation"] if "relaxation.load" in quoted else []
                self.assert_accepted(["check", case, *mode, *shlex.split(quoted)])
                tried += 1
        self.assertGreater(tried, 0)

    def test_strip_of_readme(self):
        elastic, torn, cycle = (words for words in commands(ROOT / "README.md") if words[:2] == ["run", "strip.toml"])
        self.assert_completed(self.peristat(*elastic, "--quiet"))
        self.assertEqual(len(table(self.folder / "results/strip/history.csv")), 11)  # step 0 is one
        self.assert_completed(self.peristat(*torn, "--quiet", "--output", "torn", limited=False))
        last = table(self.folder / "torn/history.csv")[-1]
        self.assertGreater(last["broken_bonds"], 0)  # "until it breaks"
        peak = max(abs(row["reaction_x:left"]) for row in table(self.folder / "torn/history.csv"))
        self.assertLess(abs(last["reaction_x:left"]), 1e-2 * peak)  # carried by loose points between the pieces
        self.assert_completed(self.peristat(*cycle, "--quiet", "--output", "cycle"))
        self.assertEqual([row["load_factor"] for row in table(self.folder / "cycle/history.csv")], [0, 1, 0, 1.2])


if __name__ == "__main__":
    unittest.main()
