"""The pages of ``make docs``: the written ones, the gallery and the API reference; and a check of the built site.

``python tools/build_docs.py pages`` fills ``build/docs/pages``; ``... links`` checks ``build/docs/site``.
"""

from __future__ import annotations

import ast
import inspect
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Mapping
from html.parser import HTMLParser
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any
from urllib.parse import unquote, urlsplit

import geofit

ROOT = Path(__file__).resolve().parents[1]
BUILD = ROOT / "build" / "docs"
PAGES, PACKAGE, SITE = BUILD / "pages", BUILD / "package", BUILD / "site"

#: Chapters of the API reference by the room that a name is defined in, in this order.
CHAPTERS = {
    "data": "Data and settings",
    "io": "Files",
    "fitting": "Fitting, checking, manual edits",
    "site": "Several horizons and faults",
    "prediction": "Prediction",
    "bodies": "Bodies",
    "morphing": "Metamorphosis",
    "sampling": "Sections and contours",
    "project": "Reports",
}
#: What functions return: modules whose public classes are described on one page.
RESULTS = (
    "geofit.surfaces.protocol", "geofit.surfaces.patch_surface", "geofit.surfaces.trimmed",
    "geofit.surfaces.mesh_surface", "geofit.splines.patch", "geofit.data.accuracy", "geofit.data.prediction",
    "geofit.site.fit_site", "geofit.site.order", "geofit.site.separate", "geofit.site.fault_blocks",
    "geofit.streaming.fit", "geofit.bodies.body", "geofit.pores.sliced",
    "geofit.site.throw", "geofit.morphing.sequence", "geofit.morphing.body", "geofit.morphing.change",
    "geofit.sampling.contours", "geofit.sampling.cut", "geofit.data.site",
)  # fmt: skip


def _linked(name: str) -> str:
    """Return a page of the root with the links that it has among the documents."""
    text = (ROOT / name).read_text(encoding="utf-8").replace("](docs/", "](")
    text = text.replace("](CHANGELOG.md)", "](changes.md)").replace("](SECURITY.md)", "](security.md)")
    return text.replace("[CITATION.cff](CITATION.cff)", "`CITATION.cff`")


def write_pages() -> None:
    """Write every page: what is in ``docs/``, the README as the start page, the gallery and the API reference."""
    shutil.rmtree(PAGES, ignore_errors=True)
    shutil.copytree(ROOT / "docs", PAGES)
    write("index.md", _linked("README.md"))
    write("security.md", _linked("SECURITY.md"))
    write("changes.md", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"))
    write_gallery(sorted((ROOT / "examples").glob("*.py")))
    write_api()
    plain_roles()


def write(name: str, text: str) -> None:
    """Write one page."""
    path = PAGES / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text.strip() + "\n", encoding="utf-8")


def write_gallery(examples: list[Path]) -> None:
    """Run the examples, and write a page for each, with its picture and its source, and one with all pictures."""
    folder = PAGES / "gallery"
    cards = []
    for path in examples:
        subprocess.run(
            [sys.executable, str(path), str(folder)], check=True, cwd=ROOT, env=os.environ | {"MPLBACKEND": "Agg"}
        )
        source = path.read_text(encoding="utf-8")
        title, _, rest = (ast.get_docstring(ast.parse(source)) or "").partition("\n")
        title = title.rstrip(".")
        film = f"![{title}, the film]({path.stem}.gif)\n\n" if (folder / f"{path.stem}.gif").is_file() else ""
        write(
            f"gallery/{path.stem}.md",
            f"# {title}\n\n{rest.strip()}\n\n![{title}]({path.stem}.png)\n\n{film}```python\n{source}```",
        )
        cards.append(f"[![{title}]({path.stem}.png){{ width=320 }}<br>{title}]({path.stem}.md)")
    cards += [""] * (len(cards) % 2)
    table = "\n".join(f"| {left} | {right} |" for left, right in zip(cards[::2], cards[1::2], strict=True))
    write(
        "gallery/index.md",
        "# Examples\n\nEach is a script of 15 to 40 lines in `examples/`, which writes its picture into the folder "
        f"that it is given.\n\n|  |  |\n|---|---|\n{table}",
    )


def write_api() -> None:
    """Write the API reference: the names of ``geofit`` and ``geofit.io``, results, errors; each name once."""
    own = {name: value for name, value in public(geofit).items() if value.__module__ != "geofit.data.errors"}
    write("api/geofit.md", f"# geofit\n\n{chapters('geofit', own)}")
    files = public(geofit.io)
    shared = ", ".join(f"[{name}][{value.__module__}.{name}]" for name, value in files.items() if name in own)
    rest = {name: value for name, value in files.items() if name not in own}
    write("api/io.md", f"# geofit.io\n\nAlso here: {shared}.\n\n{chapters('geofit.io', rest)}")
    known = {*own.values(), *rest.values()}
    results = [
        f"::: {module}.{name}"
        for module in RESULTS
        for name, value in public(import_module(module)).items()
        if inspect.isclass(value) and value not in known
    ]
    write("api/results.md", "# Results and surfaces\n\nWhat the functions return.\n\n" + "\n\n".join(results))
    write("api/errors.md", "# Errors\n\n::: geofit.data.errors\n    options: {show_root_heading: false}")


def public(package: ModuleType) -> dict[str, Any]:
    """Return the functions and classes that a package lists, by name."""
    values = {name: getattr(package, name) for name in package.__all__}
    return {name: value for name, value in values.items() if inspect.isfunction(value) or inspect.isclass(value)}


def chapters(package: str, names: Mapping[str, Any]) -> str:
    """Return a directive for each name of a package, in chapters by the rooms that they are defined in."""
    found: dict[str, list[str]] = {room: [] for room in CHAPTERS}
    for name, value in names.items():
        heading = f"::: {value.__module__}.{name}\n    options: {{heading: {package}.{name}}}"
        found.setdefault(value.__module__.split(".")[1], []).append(heading)
    full = {CHAPTERS.get(room, room): "\n\n".join(headings) for room, headings in found.items() if headings}
    return "\n\n".join(f"## {title}\n\n{text}" for title, text in full.items())


def plain_roles() -> None:
    """Turn Sphinx roles in the docstrings of the copied package into code, which Markdown knows."""
    for path in (PACKAGE / "geofit").rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        plain = re.sub(r":(?:func|class|mod|meth|data|attr|exc):`~?([^`]+)`", r"``\1``", text)
        if plain != text:
            path.write_text(plain, encoding="utf-8")


class _Links(HTMLParser):
    """Collect what a page links to, what it loads, and the anchors it has."""

    def __init__(self) -> None:
        super().__init__()
        self.links: list[str] = []
        self.loads: list[str] = []
        self.anchors: set[str] = set()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Look at one element."""
        given = dict(attrs)
        if given.get("id"):
            self.anchors.add(str(given["id"]))
        if tag == "a" and given.get("href"):
            self.links.append(str(given["href"]))
        for key in ("src", "href"):
            if tag in ("script", "link", "img") and given.get(key) and given.get("rel") != "canonical":
                self.loads.append(str(given[key]))


def broken_links(site: Path) -> list[str]:
    """Return what is wrong with the links of a built site: targets that are missing, files that come from elsewhere."""
    pages: dict[Path, _Links] = {}
    for path in sorted(site.rglob("*.html")):
        pages[path] = _Links()
        pages[path].feed(path.read_text(encoding="utf-8"))
    wrong = []
    for path, page in pages.items():
        where = path.relative_to(site).as_posix()
        wrong += [f"{where} loads {link}" for link in page.loads if urlsplit(link).scheme in ("http", "https")]
        for link in page.links + page.loads:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc or path.name == "404.html":
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            target = target / "index.html" if target.is_dir() else target
            if not target.is_file():
                wrong.append(f"{where} links to {link}: there is no such file")
            elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].anchors:
                wrong.append(f"{where} links to {link}: there is no such anchor")
    return wrong


def main(what: str) -> int:
    """Write the pages, or check the links of the built site; return the exit code."""
    if what == "pages":
        write_pages()
        return 0
    wrong = broken_links(SITE)
    print("\n".join(wrong) or f"{len(list(SITE.rglob('*.html')))} pages, no broken link")
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
