"""The tables of docs/case-file.md, and of docs/cluster.md, are the output of `peristat keys`.

    PERISTAT_PROGRAM=build/release/peristat /usr/bin/python3 -BEs tests/unit/cases/case_file_page_test.py --write

rewrites them after a key has changed; the text around them is written by hand.
"""

import os
import pathlib
import re
import subprocess
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
PAGE = ROOT / "docs/case-file.md"
CLUSTER = ROOT / "docs/cluster.md"
PROGRAM = os.environ["PERISTAT_PROGRAM"]
# <!-- keys: TABLE --> ... <!-- end -->, below a heading
BLOCK = re.compile(r"(?<=<!-- keys: )([\w.]+) -->\n(.*?)(?=<!-- end -->)", re.DOTALL)
ON_RANKS = re.compile(r"(?<=<!-- keys on ranks -->\n)(.*?)(?=<!-- end -->)", re.DOTALL)
HEADING = re.compile(r"^(?:(The document)|\[+([\w.]+)\]+)\n\n", re.MULTILINE)


def keys(*table):
    return subprocess.run([PROGRAM, "keys", *table], capture_output=True, text=True, timeout=60)


def printed_tables():
    """Tables by name, split at the headings."""
    _, *parts = HEADING.split(keys().stdout)
    return {"document" if parts[k] else parts[k + 1]: parts[k + 2].rstrip("\n") + "\n" for k in range(0, len(parts), 3)}


class CaseFilePage(unittest.TestCase):
    maxDiff = None

    def test_has_the_tables_that_the_program_prints(self):
        on_page = dict(BLOCK.findall(PAGE.read_text()))
        printed = printed_tables()
        self.assertGreater(len(printed), 15)
        self.assertEqual(list(on_page), list(printed))
        for table, text in printed.items():
            command = f"PERISTAT_PROGRAM={PROGRAM} /usr/bin/python3 -BEs {pathlib.Path(__file__).relative_to(ROOT)} --write"
            self.assertEqual(on_page[table], text, f"[{table}] in {PAGE.name} is out of date; write it anew by\n{command}")

    def test_the_page_on_clusters_has_the_keys_that_run_on_ranks(self):
        printed = keys("--ranks").stdout
        self.assertGreater(printed.count("`"), 2 * 80)
        self.assertEqual(ON_RANKS.search(CLUSTER.read_text())[0], printed)

    def test_has_a_heading_for_every_table(self):
        page = PAGE.read_text()
        for table in printed_tables():
            if table != "document":
                self.assertRegex(page, rf"(?m)^#+ `\[+{re.escape(table)}\]+`$")

    def test_each_value_with_a_meaning_has_a_row(self):
        rows = re.findall(r"^\| `(\w+)(?: = \"(\w+)\")?` \| (.*?) \|.*\| ?(.*?) ?\|$", keys().stdout, re.MULTILINE)
        allowed, found = {}, {}
        for key, value, meaning, limits in rows:
            self.assertLess(len(re.findall(r'`"\w+"`: ', meaning)), 2, f"{key}: several values in one cell")
            self.assertNotEqual(meaning, "")
            if value:
                self.assertIn(value, allowed[key])
                found.setdefault(key, [set()])[-1].add(value)
            else:
                allowed[key] = set(re.findall(r'`"(\w+)"`', limits))
                found.setdefault(key, []).append(set())
            if value:
                self.assertTrue(found[key][-1] <= allowed[key])
        complete = {key for key, sets in found.items() if any(sets)}
        self.assertLessEqual({"law", "mode", "model", "influence", "volume_correction", "linear", "form"}, complete)
        laws = next(values for values in found["law"] if values)
        self.assertEqual(laws, {"none", "critical_stretch", "tanh", "tanh_continuous", "linear", "exponential", "blended", "bilinear",
                                "cornelissen", "table",
                                "energy_density"})  # fmt: skip

    def test_one_table_is_printed_by_name(self):
        printed = keys("material.damage")
        self.assertEqual(printed.returncode, 0)
        self.assertEqual(printed.stdout, "[material.damage]\n\n" + printed_tables()["material.damage"])
        refused = keys("solvr")
        self.assertEqual((refused.returncode, refused.stdout), (2, ""))
        self.assertIn("did you mean solver?", refused.stderr)


if __name__ == "__main__":
    if sys.argv[1:] == ["--write"]:
        tables = printed_tables()
        PAGE.write_text(BLOCK.sub(lambda block: f"{block[1]} -->\n{tables[block[1]]}", PAGE.read_text()))
        CLUSTER.write_text(ON_RANKS.sub(lambda _: keys("--ranks").stdout, CLUSTER.read_text()))
    else:
        unittest.main()
