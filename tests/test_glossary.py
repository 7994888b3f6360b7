"""Retired words and rejected phrases: none in the project, and each is found where it is planted."""

from __future__ import annotations

from pathlib import Path

import prose
import pytest

ROOT = Path(__file__).resolve().parents[1]
SOURCE = '''"""A module."""


def {name}(x: float) -> float:
    """{text}"""
    return x
'''
EXAMPLES = [
    "The file is no TOML.",
    "Horizons are pushed apart.",
    "Points that their neighbours do not bear out.",
    "How far off where nobody drilled.",
    "The error off the data.",
    "The seams gape by a metre.",
    "Fit and lay a surface.",
    "Made if it is not there.",
    "What to do where a check does not hold.",
    "None stands for the fit's choice.",
    "A change by hand.",
    "Points that gave way.",
    "Two points at one place.",
    "The recipe of a surface.",
    "The note says why.",
    "The ground as it lay before.",
]


def planted(folder: Path, name: str = "value", text: str = "Return the value.") -> Path:
    (folder / "geofit/locale/zh_CN/LC_MESSAGES").mkdir(parents=True)
    (folder / prose.CATALOGUE).write_text(f'msgid ""\nmsgstr ""\n\nmsgid "{text}"\nmsgstr ""\n', "utf-8")
    (folder / "README.md").write_text(text, "utf-8")
    (folder / "geofit" / "module.py").write_text(SOURCE.format(name=name, text=text), "utf-8")
    return folder


def test_no_retired_name_and_no_rejected_phrase():
    assert [*prose.names(), *prose.phrases()] == []


@pytest.mark.parametrize("word", prose.NAMES)
def test_a_retired_name_is_found(tmp_path, word):
    (found,) = prose.names(planted(tmp_path, name=f"{word}_of"))
    assert found.startswith("geofit/module.py:4")
    assert found.endswith(prose.NAMES[word])


@pytest.mark.parametrize("text", EXAMPLES)
def test_a_rejected_phrase_is_found_in_code_messages_and_pages(tmp_path, text):
    found = list(prose.phrases(planted(tmp_path, text=text)))
    assert [line.split(": ")[0].split(" '")[0] for line in found] == ["geofit/module.py:4", "message", "README.md"]


def test_every_phrase_has_an_example():
    for pattern in prose.COMPILED:
        assert sum(bool(pattern.search(text)) for text in EXAMPLES) == 1, pattern.pattern


def test_the_glossary_of_the_project_retires_no_word_that_it_uses():
    text = (ROOT / "docs" / "glossary.md").read_text(encoding="utf-8")
    assert not [pattern.pattern for pattern in prose.COMPILED if pattern.search(text)]
