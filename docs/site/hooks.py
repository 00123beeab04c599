"""Makes a site of pages that are written for a git host: see ./peristat site.

Pages keep their links: files of the site have their paths in the repository, whether they are in docs/ or not. A text that a
page links to and that is no page, such as a case, becomes a page that shows it. Notebooks are shown with their results.
"""

import json
import pathlib
import posixpath
import re
import shutil
import tomllib

from mkdocs.structure.files import File
from mkdocs.structure.nav import Link
from mkdocs.utils import get_relative_url

ROOT = pathlib.Path(__file__).resolve().parents[2]
OUTSIDE = "README.md", "CONTRIBUTING.md", "CHANGELOG.md", "benchmarks/RESULTS.md"  # pages outside docs/
KATEX = pathlib.Path("/usr/share/javascript/katex")
CPP = ROOT / "build/cpp_reference/html"  # written by doxygen
LINK = re.compile(r"\]\(([^)#\s]+)(?:#[^)]*)?\)")
WITHOUT_ENDING = "LICENSE", "Dockerfile"
LANGUAGES = {".toml": "toml", ".py": "python", ".cpp": "cpp", ".json": "json", ".geo": "text"}


class PageOf(File):
    """A file of the repository; pages below docs/ come to the top of the site."""

    def __init__(self, path, config):
        super().__init__(path, str(ROOT), config["site_dir"], False)
        if not self.is_page_of_text() and not path.endswith(".md"):
            self.move(path.removeprefix("docs/"), config)
        else:
            stem = path.removesuffix(".md").removeprefix("docs/")
            if posixpath.basename(stem) == "README":
                stem = posixpath.join(posixpath.dirname(stem), "index") if "/" in stem else "readme"
            self.move(f"{stem}.html", config)

    def move(self, target, config):
        self.dest_uri = target
        self.abs_dest_path = str(pathlib.Path(config["site_dir"]) / target)
        self.url = target

    def is_page_of_text(self):
        """True if the site shows the text of a file that is no page."""
        suffix = pathlib.Path(self.src_uri).suffix
        return suffix in LANGUAGES or suffix == ".ipynb" or self.src_uri in WITHOUT_ENDING

    def is_documentation_page(self):
        return self.src_uri.endswith(".md") or self.is_page_of_text()

    def is_media_file(self):
        return not self.is_documentation_page()

    def is_static_page(self):
        return False


def linked_texts(pages):
    """Paths of existing files that pages link to and that are no pages."""
    found = set()
    for page in pages:
        for target in LINK.findall((ROOT / page).read_text("utf-8")):
            path = posixpath.normpath(posixpath.join(posixpath.dirname(page), target))
            if "://" not in target and not path.endswith(".md") and (ROOT / path).is_file():
                found.add(path)
    return found


def on_config(config):
    config["mdx_configs"]["toc"]["slugify"] = slug
    return config


def slug(text, _separator):
    """Anchor of a heading, as git hosts make it."""
    return re.sub(r"[^\w\- ]", "", text.strip().lower()).replace(" ", "-")


def on_files(files, config):
    pages = [f"docs/{path.relative_to(ROOT / 'docs').as_posix()}" for path in sorted((ROOT / "docs").rglob("*.md"))]
    pages += OUTSIDE
    theme = [file for file in files if not file.abs_src_path.startswith(str(ROOT / "docs"))]  # assets of the theme
    for file in list(files):
        if file not in theme:
            files.remove(file)
    # A case that a page names without a link is still worth a page.
    cases = {path.relative_to(ROOT).as_posix() for path in (ROOT / "cases").glob("*/*.toml")}
    assets = {path.relative_to(ROOT).as_posix() for path in (ROOT / "docs/site/assets").iterdir()}
    for path in [*pages, *sorted(linked_texts(pages) | cases | assets)]:
        files.append(PageOf(path, config))
    return files


def on_nav(nav, config, files):
    (reference,) = (item for item in nav.items if item.title == "Reference")
    if CPP.is_dir():
        link = Link("C++: classes and functions", "cpp/index.html")
        link.parent = reference
        reference.children.append(link)
    return nav


def on_page_read_source(page, config):
    path = pathlib.Path(page.file.abs_src_path)
    if path.suffix == ".md":
        return None
    text = path.read_text("utf-8")
    if path.suffix == ".ipynb":
        return notebook(json.loads(text))
    if path.suffix == ".toml":
        title = tomllib.loads(text).get("title", path.name)
    else:
        title = path.name
    return f"# {title}\n\n`{page.file.src_uri}`\n\n````{LANGUAGES.get(path.suffix, 'text')}\n{text.rstrip()}\n````\n"


def notebook(cells):
    """A notebook in Markdown, with its printed and drawn results."""
    parts = []
    for cell in cells["cells"]:
        text = "".join(cell["source"])
        parts.append(text if cell["cell_type"] == "markdown" else f"```python\n{text}\n```")
        for output in cell.get("outputs", []):
            data = output.get("data", {})
            if "image/png" in data:
                parts.append(f"![Picture](data:image/png;base64,{''.join(data['image/png']).strip()})".replace("\n", ""))
            elif said := "".join(output.get("text", data.get("text/plain", ""))):
                parts.append(f"```text\n{said.rstrip()}\n```")
    return "\n\n".join(parts)


def on_page_markdown(markdown, page, config, files):
    """Lists as git hosts read them: they may follow a line of text, and two blanks suffice for what belongs to an entry."""
    lines, fence = [], ""
    for line in markdown.splitlines():
        before = lines[-1] if lines else ""
        if mark := re.match(r"\s*(`{3,})", line):
            fence = "" if fence and mark[1] == fence else fence or mark[1]
        elif not fence:
            if re.match(r" {2,3}([-*] |\d+\. )", line) or (re.match(r" {2,3}\S", line) and not before.strip()):
                line = f"    {line.lstrip()}"
            if re.match(r"(- |1\. )", line) and before.strip() and not re.match(r"\s*([-*] |\d+\. )|\s{2,}|#|<!--", before):
                lines.append("")
        lines.append(line)
    return "\n".join(lines)


def on_page_content(html, page, config, files):
    """Links to texts whose names have no ending, which mkdocs leaves alone."""
    names = "|".join(WITHOUT_ENDING)
    return re.sub(rf'href="(?:\.\./)*({names})"', lambda link: f'href="{get_relative_url(f"{link[1]}.html", page.url)}"', html)


def on_post_build(config):
    site = pathlib.Path(config["site_dir"])
    # Debian's KaTeX has links to files of other packages; the site has copies.
    katex = site / "site/assets/katex"
    katex.mkdir(parents=True, exist_ok=True)
    for source in (KATEX / "katex.min.js", KATEX / "katex.min.css", KATEX / "contrib/auto-render.js"):
        shutil.copy(source, katex)
    shutil.copytree(KATEX / "fonts", katex / "fonts", dirs_exist_ok=True, ignore=shutil.ignore_patterns("*.ttf", "*.woff"))
    # A page that is opened as a file may not fetch the index of the search.
    index = json.loads((site / "search/search_index.json").read_text("utf-8"))
    for entry in index["docs"]:  # the keys of cases would hide the pages that explain them
        if entry["location"].startswith("cases/"):
            entry["text"] = ""
    index = json.dumps(index, ensure_ascii=False)
    (site / "search/search_index.json").write_text(index, "utf-8")
    (site / "search/search_index.js").write_text(f"var __search = {{ index: Promise.resolve({index}) }};\n", "utf-8")
    if CPP.is_dir():
        shutil.copytree(CPP, site / "cpp", dirs_exist_ok=True)
