"""The site of the pages: /usr/bin/python3 -B benchmarks/site.py [--pictures FOLDER]

Builds it three times by `./peristat site`, and prints seconds, counts and the bytes that pages load. With --pictures headless
Chromium draws pages at the widths of a screen and of a phone into the folder (python3-selenium, chromium-driver).
"""

import argparse
import io
import re
import subprocess
import time
import urllib.parse
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SITE = ROOT / "build/site"
PAGES = ["index.html", "start/first-crack.html", "gallery.html", "theory.html", "case-file.html", "trustworthy-peaks.html"]
DRAWN = ["index.html", "case-file.html#materialdamage"]
SIZES = {1280: 800, 390: 844}  # pixels


def seconds_to_build() -> float:
    since = time.monotonic()
    subprocess.run([ROOT / "peristat", "site"], check=True, capture_output=True)
    return time.monotonic() - since


def loaded(page: str) -> tuple[int, int]:
    """Bytes of a page, and of it with its scripts, styles and pictures (without fonts of formulas, and without the index of the search)."""
    text = (SITE / page).read_text("utf-8")
    found = set(re.findall(r'<(?:img|script)[^>]* src="([^"]+)"|<link[^>]* rel="stylesheet"[^>]* href="([^"]+)"', text))
    paths = {(SITE / page).parent.joinpath(urllib.parse.unquote(a or b)).resolve() for a, b in found if not (a or b).startswith(("data:", "$"))}
    return len(text.encode()), len(text.encode()) + sum(path.stat().st_size for path in paths)


def size(folder: Path) -> float:
    """Megabytes of the files of a folder."""
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file()) / 1e6


def draw(folder: Path) -> None:
    from PIL import Image
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service

    options = webdriver.ChromeOptions()
    for word in ("--headless=new", "--no-sandbox", "--hide-scrollbars"):
        options.add_argument(word)
    browser = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
    for width, height in SIZES.items():
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500})  # fmt: skip
        for page in DRAWN:
            browser.get(f"{SITE.as_uri()}/{page}")
            time.sleep(1)
            picture = Image.open(io.BytesIO(browser.get_screenshot_as_png())).convert("RGB")
            picture.thumbnail((800, 844))
            picture.save(folder / f"site_{page.partition('.')[0]}_{width}.webp", quality=60, method=6)
    browser.quit()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pictures", type=Path, metavar="FOLDER")
    options = parser.parse_args()
    seconds = sorted(seconds_to_build() for _ in range(3))
    pages = [path for path in SITE.rglob("*.html") if path.relative_to(SITE).parts[0] != "cpp"]
    print("| measured | value |\n|---|---|")
    print(f"| seconds of `./peristat site`, three times | {', '.join(f'{value:.1f}' for value in seconds)} |")
    print(f"| pages without the C++ reference | {len(pages)} |")
    print(f"| pages of the C++ reference | {len(list((SITE / 'cpp').rglob('*.html')))} |")
    print(f"| the site; of that the C++ reference | {size(SITE):.1f} MB; {size(SITE / 'cpp'):.1f} MB |")
    print(f"| index of the search | {(SITE / 'search/search_index.js').stat().st_size / 1e6:.2f} MB |")
    print("\n| page | its HTML [kB] | with scripts, styles and pictures [kB] |\n|---|---|---|")
    for page in PAGES:
        own, whole = loaded(page)
        print(f"| {page} | {own / 1e3:.0f} | {whole / 1e3:.0f} |")
    if options.pictures:
        draw(options.pictures)


if __name__ == "__main__":
    main()
