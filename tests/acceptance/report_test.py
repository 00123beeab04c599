"""./peristat report: pages of runs of every kind, their sizes and refusals, and what a browser shows of them."""

import contextlib
import io
import json
import os
import re
import shutil
import signal
import sys
import tempfile
import time
import unittest

import h5py
import numpy as np
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import Select

from tests.acceptance.folder import Folder
from tests.acceptance.motions import BAR, SQUARE
from tests.acceptance.resume_test import CELL, HALF, TORN
from tests.acceptance.strip import PULLED
from tests.reference.program import PROGRAM, ROOT, Ended, execute

sys.path.insert(0, str(ROOT / "python"))

from peristat.pictures.results_folder import read_results_folder  # noqa: E402
from peristat.report.body import body_content  # noqa: E402
from peristat.report.command import main  # noqa: E402
from peristat.results import open_results  # noqa: E402
from peristat.report.packing import Ranges, quantised  # noqa: E402

MOST = 2_000_000  # bytes of a page
CONTENT = re.compile(r'<script type="application/json" id="content">(.*?)</script>', re.DOTALL)
BLOCK = """\
title = "Block <b>& wedge"
dimension = 3
[lattice]
spacing = 1e-3
horizon_ratio = 2.0
shape = [{ add = "box", min = [0, 0, 0], max = [8e-3, 10e-3, 4e-3] }]
layer = [{ name = "bottom", side = "y-" }, { name = "top", side = "y+" }]
[[crack]]
vertices = [[-1e-3, 5e-3, -1e-3], [3e-3, 5e-3, -1e-3], [3e-3, 5e-3, 5e-3], [-1e-3, 5e-3, 5e-3]]
[material]
youngs_modulus = 70e9
[material.damage]
law = "critical_stretch"
critical = 1e-3
[[support]]
set = "bottom"
displacement = [0, 0, 0]
[[support]]
set = "top"
displacement = [0, "2e-5*load", 0]
[loading]
steps = 4
[solver]
mode = "relaxation"
"""
CLOUD = """\
dimension = 2
[lattice]
spacing = 1e-3
thickness = 1e-3
points = "blue_noise"
shape = [{ add = "box", min = [0, 0], max = [0.02, 0.01] }]
[[set]]
name = "left"
where = "x < 2e-3"
[[set]]
name = "right"
where = "x > 18e-3"
[material]
youngs_modulus = 200e9
[material.damage]
law = "critical_stretch"
critical = 1e-2
[[support]]
set = "left"
displacement = [0, 0]
[[support]]
set = "right"
displacement = ["3e-4*load", 0]
[loading]
steps = 4
[solver]
mode = "relaxation"
"""


def setUpModule():
    """The launcher builds the program of the pages at its first use, also for a folder that it then refuses."""
    with tempfile.TemporaryDirectory() as folder:
        ended = execute([ROOT / "peristat", "report", folder], limited=False, seconds=300)  # npm takes memory
    if ended.code != 2:
        raise AssertionError(ended.said)


class Reports(Folder):
    def report(self, *words, code=0):
        output, errors = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
            found = main([str(word) for word in words])
        ended = Ended(words, found, output.getvalue(), errors.getvalue())
        self.assert_code(ended, code)
        return ended

    def assert_has(self, text, *parts):
        """Names what a page lacks, and not the whole page."""
        self.assertEqual([part for part in parts if part not in text], [])


class Pages(Reports):
    def page(self, *arguments, **options):
        """The text of the page of a run, and what it says about curves and body."""
        folder = self.run_case(*arguments, **options)
        self.report(folder)
        text = (folder / "report.html").read_text()
        return text, json.loads(CONTENT.search(text)[1])

    def test_a_run_that_tears_has_every_section(self):
        text, content = self.page(TORN)
        names = re.findall(r'<details id="(\w+)"', text)
        self.assertEqual(names, ["model", "preflight", "body", "curves", "ledger", "convergence", "decisions", "timings", "case"])
        self.assert_has(text, "The run completed.")
        self.assert_has(text, "support right: displacement = [3e-4*load, 0]")
        self.assert_has(text, "1 crack from the start")
        self.assertLess(len(text), MOST)
        self.assertEqual({curve["id"] for curve in content["curves"]},
                         {"displacement-curve", "load-curve", "energy-curve", "convergence-curve"})  # fmt: skip
        with h5py.File(self.folder / "out/results.h5") as file:
            steps = [group.attrs["step"] for group in file["steps"].values()]
            self.assertEqual([frame["step"] for frame in content["body"]["frames"]], steps)
            self.assertEqual(content["body"]["bonds"], len(file["broken_bonds/step"]))
            curve = next(curve for curve in content["curves"] if curve["id"] == "load-curve")
            self.assertEqual(curve["x"], "load factor")
            peak = max(max(series["y"]) for series in curve["series"])
            unit = {"reaction [kN]": 1e3, "reaction [N]": 1.0, "reaction [MN]": 1e6}[curve["y"]]
            self.assertAlmostEqual(peak * unit, np.abs(file["history/reaction_x:right"][...]).max(), delta=1e-9 * peak * unit)

    def test_the_launcher_makes_it(self):
        folder = self.run_case(PULLED)
        ended = self.execute([ROOT / "peristat", "report", folder], limited=False)
        self.assert_code(ended, 0)
        self.assertIn(f"report: {folder}/report.html: 0.", ended.output)
        self.assert_has((folder / "report.html").read_text(), "<td>body</td><td>")

    def test_a_page_asks_for_nothing_else(self):
        text, _ = self.page(PULLED)
        self.assert_has(text, "default-src 'none'")
        before = text[: text.index('id="numbers"')]
        self.assertEqual([link for link in re.findall(r'(?:href|src)="([^"]*)"', before) if not link.startswith(("#", "data:"))], [])

    def test_texts_of_a_run_are_no_markup(self):
        text, _ = self.page(PULLED.replace("dimension = 2", 'title = "</script><img src=x onerror=alert(1)>"\ndimension = 2', 1))
        self.assertFalse("<img" in text)
        self.assert_has(text, "&lt;/script&gt;&lt;img")

    def test_pages_of_other_bodies_and_modes(self):
        kinds = {"bar in motion": (BAR, 1, "lattice"), "plate in motion": (SQUARE, 2, "lattice"), "cloud": (CLOUD, 2, "polygons"),
                 "half": (HALF, 2, "lattice"), "cell": (CELL, 2, "lattice"), "solid": (BLOCK, 3, "lattice")}  # fmt: skip
        for name, (case, dimension, kind) in kinds.items():
            with self.subTest(name):
                _, content = self.page(case, name=name)
                body = content["body"]
                self.assertEqual((body["dimension"], body["kind"], body["told"]), (dimension, kind, []))
                self.assertEqual(body["count"], body["points"])
                self.assertEqual("images" in body, name in ("half", "cell"))
        self.assertIn("time", body_words(self.folder / "bar in motion"))

    def test_a_run_that_failed_shows_its_dossier_first(self):
        text, content = self.page(TORN, "solver.mode=newton", "loading.adaptive=false", "solver.max_iterations=2", code=3)
        self.assert_has(text, "The run did not converge: ")
        self.assertEqual(re.search(r'<details id="(\w+)"', text)[1], "dossier")
        self.assert_has(text, "What to do")
        self.assert_has(text, "No step has fields.")
        self.assertIsNone(content["body"])

    def test_a_field_that_some_steps_lack_is_no_zero(self):
        folder = self.run_case(TORN)
        with h5py.File(folder / "results.h5", "r+") as file:
            del file["steps/000002/stretch"]
            file["steps/000003/energy_density"][5] = np.nan
        self.report(folder)
        text = (folder / "report.html").read_text()
        fields = [field["name"] for field in json.loads(CONTENT.search(text)[1])["body"]["fields"]]
        self.assertEqual([name for name in ("damage", "stretch", "energy_density") if name in fields], ["damage"])
        self.assert_has(text, "largest stretch of a bond is left out: it is missing or not finite in step 2",
                        "energy density is left out: it is missing or not finite in step 3")  # fmt: skip

    def test_a_run_that_was_killed(self):
        steps = TORN.replace("steps = 10", "steps = 400")
        process = self.start(self.words_of_run(steps))
        parts = self.folder / "out/parts"
        until = time.monotonic() + 60
        while len(list(parts.glob("0*.h5"))) < 3 and time.monotonic() < until:
            time.sleep(0.01)
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
        self.report(self.folder / "out")
        text = (self.folder / "out/report.html").read_text()
        self.assert_has(text, "The run was interrupted.")
        self.assert_has(text, "there is no readable summary.json")
        self.assertGreaterEqual(len(json.loads(CONTENT.search(text)[1])["body"]["frames"]), 2)

    def test_what_is_no_results_is_refused(self):
        (self.folder / "empty").mkdir()
        self.assert_refused(self.report(self.folder / "empty", code=2), "no results of a run")
        self.assert_refused(self.report(self.folder / "nowhere", code=2), "no such folder")
        self.assert_refused(self.report(code=2), "DIR")
        broken = self.run_case(PULLED)
        content = (broken / "results.h5").read_bytes()
        (broken / "results.h5").write_bytes(content[: len(content) // 3])
        self.assert_refused(self.report(broken, code=2), "results.h5")
        self.assertFalse((broken / "report.html").exists())

    def test_nothing_but_an_earlier_page_is_replaced(self):
        folder = self.run_case(PULLED)
        page = folder / "report.html"
        page.write_text("<html>mine</html>")
        self.assert_refused(self.report(folder, code=2), "no page of this command")
        self.assertEqual(page.read_text(), "<html>mine</html>")
        page.unlink()
        target = self.write("target.html", "")
        page.symlink_to(target)
        self.assert_refused(self.report(folder, code=2), "no plain file")
        self.assertEqual(target.read_text(), "")
        page.unlink()
        self.report(folder)
        first = page.read_text()
        self.report(folder)
        self.assertEqual(page.read_text(), first)
        other = self.folder / "elsewhere.html"
        self.report(folder, "--output", other)
        self.assertEqual(other.read_text(), first)
        self.assert_refused(self.report(folder, "--output", self.folder / "nowhere/page.html", code=2), "there is no folder")

    def test_python_makes_the_same_page(self):
        folder = self.run_case(PULLED)
        self.report(folder)
        page = open_results(folder).report(self.folder / "page.html")
        self.assertEqual(page, self.folder / "page.html")
        self.assertEqual(page.read_text(), (folder / "report.html").read_text())

    def test_a_new_run_removes_the_page_of_the_earlier_one(self):
        folder = self.run_case(PULLED)
        self.report(folder)
        self.run_case(PULLED, "loading.steps=2")
        self.assertFalse((folder / "report.html").exists())
        (folder / "report.html").write_text("mine")
        self.run_case(PULLED)
        self.assertEqual((folder / "report.html").read_text(), "mine")


class Comparisons(Reports):
    def tool(self, name, *words):
        script = ROOT / f"cases/runner/{name}/{name}.py"
        return self.execute(["/usr/bin/python3", "-BEs", script, *words], limited=False, environment={"PERISTAT_PROGRAM": PROGRAM})

    def test_a_sweep(self):
        sweep = self.folder / "a sweep"
        self.assert_code(self.tool("sweep", self.case(TORN), "--vary", "loading.steps=2,4", "--output", sweep), 0)
        first = next(sweep.glob("loading.steps=2*"))
        self.report(first)
        self.report(sweep)
        text = (sweep / "report.html").read_text()
        self.assertLess(len(text), MOST)
        self.assert_has(text, "2 combinations: 2 completed.", f'href="{first.name.replace("=", "%3D")}/report.html">2</a>', "<td>4</td>")
        curve = json.loads(CONTENT.search(text)[1])["curves"][0]
        self.assertEqual([series["label"] for series in curve["series"]], ["loading.steps=2", "loading.steps=4"])
        with h5py.File(first / "results.h5") as file:
            peak = np.abs(file["history/reaction_x:right"][...]).max()
        self.assertIn(curve["y"], ("largest reaction [kN]", "largest reaction [N]"))
        self.assertAlmostEqual(max(curve["series"][0]["y"]) * (1e3 if "kN" in curve["y"] else 1.0), peak, delta=1e-9 * peak)
        self.assertEqual(text.count('<img class="thumbnail"'), 2)

    def test_a_trust_suite(self):
        suite = self.folder / "suite"
        self.assert_code(self.tool("trust", "--quick", "--jobs", "1", "--output", suite, "strength_uniaxial"), (0, 3))
        self.report(suite)
        text = (suite / "report.html").read_text()
        self.assert_has(text, "<code>strength_uniaxial</code>", '<img class="thumbnail"', "1 quantities: ")
        self.assertEqual([curve["title"] for curve in json.loads(CONTENT.search(text)[1])["curves"]], ["strength_uniaxial"])

    def test_other_tables_are_refused(self):
        self.write("one/sweep.csv", "a,b\n1,2\n")
        self.assert_refused(self.report(self.folder / "one", code=2), "no table of a sweep")
        self.write("two/table.md", "# Notes\n")
        self.assert_refused(self.report(self.folder / "two", code=2), "no table of a trust suite")


def body_words(folder):
    content = json.loads(CONTENT.search((folder / "report.html").read_text())[1])
    return content["body"]["frames"][-1]["load"]


class Sizes(Reports):
    """Bodies that no test has the time to run: smooth displacements with noise, energy and a damaged band."""

    def body(self, shape, steps):
        axes = [np.arange(length) for length in shape]
        places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(shape)) * 1e-3 + 5e-4
        random = np.random.default_rng(3)
        folder = self.folder / "large"
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        with h5py.File(folder / "results.h5", "w") as file:
            file["points/reference"] = places
            file["points/volume"] = np.full(len(places), 1e-9)
            file["points"].attrs["spacing"] = 1e-3
            text = f"dimension = {len(shape)}\n[lattice]\nspacing = 1e-3\nhorizon_ratio = 3.015\n"
            file["case/as_resolved"] = text
            for step in range(1, steps + 1):
                group = file.create_group(f"steps/{step:06d}")
                group.attrs["load_factor"] = step / steps
                wave = np.sin(places @ np.linspace(90.0, 200.0, len(shape)) + 0.05 * step)
                moved = step * 1e-6 * (places / places.max() + 0.1 * wave[:, None]) * (1 + 1e-3 * random.normal(size=places.shape))
                group["displacement"] = moved
                group["energy_density"] = (moved**2).sum(axis=1) * 1e15
                near = np.exp(-((places[:, 1] / places[:, 1].max() - 0.5) ** 2) * 400)
                group["damage"] = np.where(places[:, 0] < places[:, 0].max() * step / steps, 0.5 * near, 0.0)
                group["stretch"] = 1e-3 * np.abs(wave)
                group["force"] = 1e3 * moved
                group["fragment"] = np.zeros(len(places))
        return folder

    def page(self, folder):
        self.report(folder)
        text = (folder / "report.html").read_text()
        self.assertLess(len(text.encode()), MOST)
        return text, json.loads(CONTENT.search(text)[1])["body"]

    def test_ten_thousand_points_and_thirty_steps_are_whole(self):
        for shape in ((100, 100), (25, 20, 20)):
            with self.subTest(shape):
                _, body = self.page(self.body(shape, 30))
                self.assertEqual((body["count"], len(body["frames"]), body["told"]), (10_000, 30, []))

    def test_larger_ones_are_thinned_and_told(self):
        text, body = self.page(self.body((250, 160), 40))
        shown = len(body["frames"])
        self.assertLess(shown, 40)
        self.assert_has(text, f"{shown} of the 40 steps with fields are shown")
        self.assertEqual((body["frames"][0]["step"], body["frames"][-1]["step"]), (1, 40))

    def test_points_are_thinned_after_the_steps(self):
        results = read_results_folder(self.body((120, 100), 14))
        content, text = body_content(results, 200_000)
        self.assertLessEqual(len(text), 200_000)
        self.assertEqual(len(content["frames"]), 12)
        self.assertLess(content["count"], 12_000)
        self.assertFalse(content["is_whole"])
        self.assertIn("cells are shown for 12\u2009000 points", " ".join(content["told"]))


class Quantised(unittest.TestCase):
    def test_errors_are_within_half_a_step(self):
        values = np.random.default_rng(1).normal(size=(3, 2, 500)) * np.array([1.0, 1e-9, 1e12])[:, None, None]
        for bits in (8, 12, 16):
            numbers, ranges = quantised(values, bits)
            back = ranges.low[:, :, None] + numbers * ranges.step[:, :, None]
            self.assertLessEqual((np.abs(back - values) / ranges.step[:, :, None]).max(), 0.5 + 1e-9)
            self.assertGreater((np.abs(back - values) / ranges.step[:, :, None]).max(), 0.3)

    def test_a_constant_is_exact(self):
        numbers, ranges = quantised(np.full((1, 1, 7), -3.7), 16)
        self.assertEqual((numbers.max(), ranges.low[0, 0], ranges.step[0, 0]), (0, -3.7, 0.0))
        self.assertIsInstance(ranges, Ranges)


def browser(*further):
    options = webdriver.ChromeOptions()
    for word in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--hide-scrollbars", *further):
        options.add_argument(word)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    options.binary_location = "/usr/bin/chromium"
    return webdriver.Chrome(options=options, service=Service("/usr/bin/chromedriver"))


class InABrowser(Reports):
    """Each page once at the width of a desk and of a phone."""

    @classmethod
    def setUpClass(cls):
        cls.chrome = browser("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
        cls.addClassCleanup(cls.chrome.quit)

    def open(self, page, width=1280, chrome=None):
        chrome = chrome or self.chrome
        chrome.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                               {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 600})  # fmt: skip
        chrome.get(page.as_uri())
        self.until(lambda: chrome.execute_script("return document.documentElement.dataset.ready") == "yes")
        self.assertEqual([entry for entry in chrome.get_log("browser") if "GL Driver" not in entry["message"]], [])
        self.assertEqual(chrome.execute_script("return performance.getEntriesByType('resource').map(e => e.name)"), [])

    def until(self, holds, seconds=30):
        end = time.monotonic() + seconds
        while not holds():
            self.assertLess(time.monotonic(), end, "the page does not come so far")
            time.sleep(0.05)

    def element(self, name):
        return self.chrome.find_element(By.CSS_SELECTOR, name)

    def pixels(self):
        """Colours of the canvas and how often each occurs."""
        return self.chrome.execute_script("""
            const canvas = document.querySelector("#body-view canvas");
            const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
            const paper = copy.getContext("2d");
            paper.drawImage(canvas, 0, 0);
            const data = paper.getImageData(0, 0, copy.width, copy.height).data;
            const found = {};
            for (let i = 0; i < data.length; i += 4) if (data[i + 3]) {
              const key = `${data[i]},${data[i + 1]},${data[i + 2]}`;
              found[key] = (found[key] ?? 0) + 1;
            }
            return found;""")

    def go_to(self, frame):
        self.chrome.execute_script("const step = document.getElementById('step'); step.value = arguments[0]; step.dispatchEvent(new Event('input'))", frame)

    def read(self, point=None):
        """Values and errors of a point, as the page shows them, by name."""
        if point is not None:
            self.chrome.execute_script("const p = document.getElementById('point'); p.value = arguments[0]; p.dispatchEvent(new Event('change'))", point)
        cells = self.chrome.find_elements(By.CSS_SELECTOR, "#values td[data-name]")
        return {cell.get_attribute("data-name"): (float(cell.get_attribute("data-value")), float(cell.get_attribute("data-error"))) for cell in cells}

    def compare(self, folder, frame, point):
        """What the page shows of a point is in the results, within the error that it states."""
        shown = self.read(point)
        with h5py.File(folder / "results.h5") as file:
            group = list(file["steps"].values())[frame]
            dimension = file["points/reference"].shape[1]
            moved, reference = group["displacement"][...], file["points/reference"][...]
            true = {f"displacement_{axis}": moved[:, c] for c, axis in enumerate("xyz"[:dimension])}
            true |= {f"position_{axis}": reference[:, c] for c, axis in enumerate("xyz"[:dimension])}
            true |= {"displacement": np.linalg.norm(moved, axis=1), "force": np.linalg.norm(group["force"][...], axis=1)}
            true |= {name: group[name][...] for name in ("damage", "energy_density", "stretch") if name in shown}
        self.assertGreaterEqual(len(shown), len(true))
        for name, values in true.items():
            value, error = shown[name]
            size = max(abs(values).max(), 1e-300)
            self.assertLessEqual(abs(value - values[point]), error * (1 + 1e-6) + 1e-9 * size, name)
            self.assertLess(error, 2e-3 * size, f"{name}: so large an error would hold anything")

    def test_a_plate_at_the_width_of_a_desk(self):
        folder = self.run_case(TORN)
        self.report(folder)
        self.open(folder / "report.html")
        last = self.pixels()
        self.assertGreater(len(last), 20)
        self.assertGreater(sum(last.values()), 10_000)
        self.assertEqual(len(self.chrome.find_elements(By.CSS_SELECTOR, ".uplot")), 4)
        self.go_to(0)
        first = self.pixels()
        self.assertNotEqual(first, last)
        self.assertIn("step 1 ", self.element(".step-words").text)
        Select(self.element("#field")).select_by_value("energy_density")
        self.assertNotEqual(self.pixels(), first)
        for frame, point in ((0, 0), (4, 17), (9, 205)):
            self.go_to(frame)
            self.compare(folder, frame, point)
        # A click reads the point below it.
        canvas = self.element("#body-view canvas")
        self.chrome.execute_script("arguments[0].scrollIntoView({ block: 'center' })", canvas)
        ActionChains(self.chrome).move_to_element_with_offset(canvas, -200, 5).click().perform()
        point = int(self.element("#point").get_attribute("value"))
        shown = self.read()
        with h5py.File(folder / "results.h5") as file:
            reference = file["points/reference"][point]
        np.testing.assert_allclose([shown["position_x"][0], shown["position_y"][0]], reference, rtol=1e-9)
        self.assertLess(reference[0], 0.01, "the click was left of the middle")
        self.element("#play").click()
        self.until(lambda: "step 1 " not in self.element(".step-words").text and "Play" in self.element("#play").text)
        with h5py.File(folder / "results.h5") as file:
            last = max(group.attrs["step"] for group in file["steps"].values())
        self.assertIn(f"step {last} ", self.element(".step-words").text)

    def test_a_plate_at_the_width_of_a_phone(self):
        folder = self.run_case(HALF, "loading.steps=4")
        self.report(folder)
        self.open(folder / "report.html", width=390)
        self.assertLessEqual(self.chrome.execute_script("return document.documentElement.scrollWidth"), 390)
        self.assertGreater(len(self.pixels()), 10)

    def test_a_solid(self):
        folder = self.run_case(BLOCK)
        self.report(folder)
        self.open(folder / "report.html")
        whole = self.pixels()
        self.assertGreater(len(whole), 20)
        with h5py.File(folder / "results.h5") as file:
            count = len(file["points/volume"])
        for frame in (0, 3):
            self.go_to(frame)
            for point in (0, count // 2, count - 1):
                self.compare(folder, frame, point)
        self.chrome.execute_script("const cut = document.getElementById('cut'); cut.value = 40; cut.dispatchEvent(new Event('input'))")
        self.assertLess(sum(self.pixels().values()), sum(whole.values()))

    def test_a_cloud(self):
        folder = self.run_case(CLOUD)
        self.report(folder)
        self.open(folder / "report.html")
        self.assertGreater(len(self.pixels()), 10)
        for point in (0, 50, 150):
            self.compare(folder, 3, point)

    def test_without_webgl_the_rest_is_there(self):
        folder = self.run_case(PULLED)
        self.report(folder)
        chrome = browser("--disable-3d-apis")
        self.addCleanup(chrome.quit)
        chrome.get((folder / "report.html").as_uri())
        self.until(lambda: chrome.execute_script("return document.documentElement.dataset.ready") == "yes")
        self.assertIn("no WebGL", chrome.find_element(By.CSS_SELECTOR, "#body-view").text)
        self.assertEqual(len(chrome.find_elements(By.CSS_SELECTOR, ".uplot")), 4)
        chrome.execute_script("const p = document.getElementById('point'); p.value = 3; p.dispatchEvent(new Event('change'))")
        self.assertIn("point 3", chrome.find_element(By.CSS_SELECTOR, "#values").text)


if __name__ == "__main__":
    unittest.main()
