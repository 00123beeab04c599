"""`./peristat site`: every link leads somewhere, search and formulas work in pages that are opened as files."""

import html.parser
import http.server
import pathlib
import re
import threading
import time
import unittest
import urllib.parse

from tests.printed.fences import PAGES
from tests.reference.program import ROOT, execute

SITE = ROOT / "build/site"
WIDTHS = 1280, 390  # pixels of a screen and of a phone


class Page(html.parser.HTMLParser):
    """Links and anchors of a page."""

    def __init__(self, text):
        super().__init__()
        self.links, self.resources, self.anchors = [], [], set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.anchors.update(value for key in ("id", "name") if (value := given.get(key)))
        if tag == "a" and "href" in given:
            self.links.append(given["href"])
        target = given.get("src") or (given.get("href") if tag == "link" else None)
        if target and not target.startswith("data:"):
            self.resources.append(target)


def setUpModule():
    since = time.monotonic()
    ended = execute([ROOT / "peristat", "site"], seconds=300, limited=False)
    if ended.code != 0:
        raise AssertionError(ended.said)
    print(f"built in {time.monotonic() - since:.0f} s")


def pages():
    """Pages of the site by path, without those of doxygen, which refer to one another."""
    return {path.relative_to(SITE).as_posix(): Page(path.read_text("utf-8")) for path in sorted(SITE.rglob("*.html"))
            if path.relative_to(SITE).parts[0] not in ("cpp", "404.html")}  # fmt: skip


class Site(unittest.TestCase):
    def test_no_link_is_dead(self):
        all_pages = pages()
        self.assertGreater(len(all_pages), 90)
        tried, dead = 0, []
        for name, page in all_pages.items():
            for link in page.links + page.resources:
                target, _, anchor = urllib.parse.unquote(link).partition("#")
                if re.match(r"[a-z]+:", target):
                    self.assertIn(link, page.links, f"{name} loads {link} from the network")
                    continue
                path = (SITE / name).parent.joinpath(target).resolve() if target else SITE / name
                found = all_pages.get(path.relative_to(SITE).as_posix())
                if not path.is_file() or (anchor and found and anchor not in found.anchors):
                    dead.append(f"{name}: {link}")
                tried += 1
        self.assertEqual(dead, [])
        self.assertGreater(tried, 5000)

    def test_every_page_is_in_the_navigation(self):
        named = set(re.findall(r": ((?:docs/)?\S+\.md)$", (ROOT / "mkdocs.yml").read_text(), re.MULTILINE))
        self.assertEqual(named, {page.relative_to(ROOT).as_posix() for page in PAGES} - {"README.md"}
                         | {"CHANGELOG.md", "benchmarks/RESULTS.md"})  # fmt: skip

    def test_every_case_has_a_page(self):
        for path in (ROOT / "cases").glob("*/*.toml"):
            self.assertIn("youngs_modulus" if "youngs_modulus" in path.read_text() else "material",
                          (SITE / f"{path.relative_to(ROOT)}.html").read_text())  # fmt: skip

    def test_classes_of_the_library_have_pages(self):
        for name in ("index.html", "classperistat_1_1Assembler.html", "search/search.js"):
            self.assertTrue((SITE / "cpp" / name).is_file(), name)
        self.assertIn("cpp/index.html", (SITE / "library.html").read_text())


class Quiet(http.server.SimpleHTTPRequestHandler):
    def __init__(self, *arguments):
        super().__init__(*arguments, directory=SITE)

    def log_message(self, *_):
        pass


class InABrowser(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        from selenium import webdriver
        from selenium.webdriver.chrome.service import Service

        options = webdriver.ChromeOptions()
        options.binary_location = "/usr/bin/chromium"
        for word in ("--headless=new", "--no-sandbox", "--disable-gpu", f"--window-size={WIDTHS[0]},900"):
            options.add_argument(word)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        cls.browser = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
        cls.addClassCleanup(cls.browser.quit)

    def open(self, name):
        self.browser.get((SITE / name).as_uri())
        self.assertEqual([said for said in self.browser.get_log("browser") if said["level"] == "SEVERE"], [])

    def script(self, text, *arguments):
        return self.browser.execute_script(text, *arguments)

    def wait_for(self, text):
        latest = time.monotonic() + 30
        while not (found := self.script(text)):
            self.assertLess(time.monotonic(), latest, text)
            time.sleep(0.1)
        return found

    def find(self, words):
        """Addresses and text of the results of a search."""
        field = self.browser.find_element("css selector", "[data-md-component=search-query]")
        self.script("document.getElementById('__search').checked = true")
        field.clear()
        field.send_keys(words)
        self.wait_for("return document.querySelectorAll('.md-search-result__link').length")
        return self.script("return [...document.querySelectorAll('.md-search-result__link')].map(a => [a.href, a.textContent])")

    def test_search_finds_a_key_from_any_page(self):
        """Pages that are opened as files, and a page of a server."""
        server = http.server.ThreadingHTTPServer(("localhost", 0), Quiet)
        self.addCleanup(server.server_close)
        self.addCleanup(server.shutdown)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        served = f"http://localhost:{server.server_port}/index.html"
        for address in ((SITE / "index.html").as_uri(), (SITE / "how-to/restart.html").as_uri(), served):
            self.browser.get(address)
            found = self.find("horizon_ratio")
            self.assertTrue(any("case-file.html" in address for address, _ in found), found)
            path = urllib.parse.unquote(urllib.parse.urlparse(found[0][0]).path)
            self.assertTrue(pathlib.Path(path if address != served else f"{SITE}{path}").is_file())

    def test_formulas_are_rendered(self):
        sources = {name: len(re.findall(r'class="arithmatex"', (SITE / name).read_text())) for name in pages()}
        counted = 0
        for name, count in sources.items():
            if count:
                self.open(name)
                self.assertEqual(self.script("return document.querySelectorAll('.katex').length"), count, name)
                wrong = self.script("return [...document.querySelectorAll('.katex-error')].map(e => e.textContent)")
                self.assertEqual(wrong, [], name)
                counted += count
        self.assertGreater(counted, 800)

    def test_no_formula_is_left_as_text(self):
        """A dollar outside code is the sign of a formula that Markdown did not see."""
        for name in pages():
            text = re.sub(r"<(script|style|code|pre)\b.*?</\1>", "", (SITE / name).read_text(), flags=re.DOTALL)
            self.assertEqual(re.findall(r"\$[^$\n]{0,40}", re.sub(r"<[^>]+>", "", text)), [], name)

    def test_pages_fit_a_phone(self):
        self.addCleanup(self.browser.execute_cdp_cmd, "Emulation.clearDeviceMetricsOverride", {})
        for width in WIDTHS:
            size = {"width": width, "height": 844, "deviceScaleFactor": 1, "mobile": width < 500}
            self.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
            for name in ("index.html", "gallery.html", "case-file.html", "trustworthy-peaks.html", "theory.html", "commands.html"):
                self.open(name)
                self.assertLessEqual(self.script("return document.documentElement.scrollWidth"), width, name)


if __name__ == "__main__":
    unittest.main()
