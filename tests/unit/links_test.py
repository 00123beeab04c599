"""Links of README, pages and the changelog lead to files and headings that exist."""

import posixpath
import re
import unittest

from tests.printed.fences import PAGES
from tests.reference.program import ROOT

ALL = [*PAGES, ROOT / "CHANGELOG.md", ROOT / "benchmarks/RESULTS.md"]
LINK = re.compile(r"\]\(([^)\s]+)\)")


def prose(path):
    """The page without fenced blocks and code."""
    text = re.sub(r"^```.*?^```", "", path.read_text("utf-8"), flags=re.DOTALL | re.MULTILINE)
    return re.sub(r"`[^`\n]*`", lambda code: re.sub(r"\]\(", "] (", code[0]), text)


def anchors(path):
    """Anchors of a page: those of its headings, as git hosts make them, and those that it sets."""
    found = {}
    for heading in re.findall(r"^#+ (.*)$", re.sub(r"^```.*?^```", "", path.read_text("utf-8"), flags=re.DOTALL | re.MULTILINE), re.MULTILINE):
        text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        slug = re.sub(r"[^\w\- ]", "", text.strip().lower()).replace(" ", "-")
        found[slug] = found.get(slug, -1) + 1
    named = set(re.findall(r'<a (?:id|name)="([^"]+)">', path.read_text("utf-8")))
    return named | {slug if k == 0 else f"{slug}-{k}" for slug, count in found.items() for k in range(count + 1)}


class Links(unittest.TestCase):
    def test_lead_somewhere(self):
        tried = 0
        for page in ALL:
            for link in LINK.findall(prose(page)):
                if "://" in link or link.startswith("mailto:"):
                    continue
                target, _, anchor = link.partition("#")
                path = page.parent / target if target else page
                with self.subTest(page=page.relative_to(ROOT).as_posix(), link=link):
                    self.assertTrue(path.exists(), "no such file")
                    self.assertFalse(posixpath.isabs(target))
                    if anchor:
                        self.assertIn(anchor, anchors(path), "no such heading")
                    tried += 1
        self.assertGreater(tried, 300)

    def test_every_page_can_be_reached_from_readme(self):
        reached, todo = set(), [ROOT / "README.md"]
        while todo:
            page = todo.pop().resolve()
            if page in reached or page.suffix != ".md":
                continue
            reached.add(page)
            todo += [page.parent / link.partition("#")[0] for link in LINK.findall(prose(page)) if "://" not in link and link[0] != "#"]
        hidden = {ROOT / "docs/index.md"}  # the first page of the site
        self.assertEqual({page.relative_to(ROOT).as_posix() for page in set(ALL) - reached - hidden}, set())


if __name__ == "__main__":
    unittest.main()
