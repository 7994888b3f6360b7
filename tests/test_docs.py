"""The documentation: every page is in the navigation, every link has its target, every picture is there."""

from __future__ import annotations

import re
from pathlib import Path

import build_docs
import pytest

import geofit

ROOT = Path(__file__).resolve().parents[1]
WRITTEN = sorted((ROOT / "docs").glob("*.md"))
#: Pages that make docs generates.
MADE = {
    "index.md",
    "changes.md",
    "security.md",
    "gallery/index.md",
    "api/geofit.md",
    "api/io.md",
    "api/results.md",
    "api/errors.md",
}


@pytest.mark.parametrize("page", [ROOT / "README.md", *WRITTEN], ids=lambda page: page.name)
def test_links_of_a_page_have_targets(page):
    text = page.read_text(encoding="utf-8")
    missing = [
        target for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", text) if not (page.parent / target).exists()
    ]
    assert not missing


def test_every_page_is_in_the_navigation():
    nav = set(re.findall(r": (\S+\.md)$", (ROOT / "mkdocs.yml").read_text(encoding="utf-8"), re.MULTILINE))
    assert nav == {page.name for page in WRITTEN} | MADE


def test_every_public_name_has_an_entry_in_the_reference(monkeypatch, tmp_path):
    monkeypatch.setattr(build_docs, "PAGES", tmp_path)
    build_docs.write_api()
    pages = {path.name: path.read_text(encoding="utf-8") for path in (tmp_path / "api").iterdir()}
    own, files = build_docs.public(geofit), build_docs.public(geofit.io)
    assert len(own) > 20
    for name, value in own.items():
        assert f"::: {value.__module__}.{name}\n" in pages["geofit.md"] or name == "GeofitError"
    for name, value in files.items():
        assert f"{value.__module__}.{name}" in pages["io.md"]
    entries = re.findall(r"^::: (\S+)", "\n".join(pages.values()), re.MULTILINE)
    assert len(entries) == len(set(entries)), "a name is described once"


def test_the_glossary_explains_each_word_once_with_its_code():
    rows = re.findall(r"^\| (.+?) \| (.+?) \| (.+?) \|$", (ROOT / "docs" / "glossary.md").read_text("utf-8"), re.M)
    words = [word for word, _, _ in rows if word != "word" and not set(word) <= {"-"}]
    assert len(words) > 50
    assert len(words) == len(set(words))
    assert all("`" in code or code == "code" for _, _, code in rows)


def test_broken_links_are_found(tmp_path):
    (tmp_path / "sub").mkdir()
    (tmp_path / "index.html").write_text(
        '<h1 id="top"><a href="sub/b.html#here">b</a><a href="gone.html">gone</a><a href="#nowhere">x</a>'
        '<a href="https://example.org">elsewhere</a><script src="https://example.org/a.js"></script>',
        encoding="utf-8",
    )
    (tmp_path / "sub" / "b.html").write_text('<p id="here"><a href="../index.html#top">a</a>', encoding="utf-8")
    assert build_docs.broken_links(tmp_path) == [
        "index.html loads https://example.org/a.js",
        "index.html links to gone.html: there is no such file",
        "index.html links to #nowhere: there is no such anchor",
    ]
