"""The Chinese catalogue: nothing that the report or the core says is missing, and no placeholder is lost."""

from __future__ import annotations

import ast
import string
from pathlib import Path
from typing import get_args

import pytest

from geofit.errors import SettingsError
from geofit.offdata import Scheme
from geofit.report.language import EN, ZH, language, sentence, tell
from geofit.words import said

ROOT = Path(__file__).resolve().parents[1]


def literals() -> dict[str, str]:
    """Every text that said(), the report's t() and Check() are given, and where: all of them must be literals."""
    found: dict[str, str] = {}
    for folder in ("geofit", "io"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Name) or not node.args:
                    continue
                name, first = node.func.id, node.args[0]
                where = f"{path.relative_to(ROOT).as_posix()}:{node.lineno}"
                if name in ("said", "t"):
                    texts = _texts(first)
                    assert texts, f"{where}: {name}() wants a literal, so that translations can be checked"
                elif name == "Check":
                    texts = _texts(first)
                else:
                    continue
                found |= dict.fromkeys(texts, where)
    return found


def _texts(node: ast.expr) -> list[str]:
    """The literals that an argument can be; a scheme of cross-validation is one of three by its type."""
    if isinstance(node, ast.Attribute) and node.attr == "scheme":
        return list(get_args(Scheme))
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return [node.value]
    if isinstance(node, ast.IfExp):
        one, other = _texts(node.body), _texts(node.orelse)
        return one + other if one and other else []
    return []


def _fields(template: str) -> set[str]:
    return {name for _, name, _, _ in string.Formatter().parse(template) if name}


def test_every_text_has_a_chinese_one():
    absent = {text: where for text, where in literals().items() if text not in ZH.texts}
    assert not absent, "add to geofit/report/chinese_said.py or chinese.py:\n" + "\n".join(
        f"{where}: {text!r}" for text, where in absent.items()
    )


def test_every_translation_keeps_the_placeholders():
    wrong = [english for english, chinese in ZH.texts.items() if _fields(english) != _fields(chinese)]
    assert not wrong


def test_a_sentence_of_the_core_is_told_with_its_values():
    text = said("{count} of {total} places folded or degenerate", count=3, total=40)
    assert tell(text, EN) == "3 of 40 places folded or degenerate"
    assert tell(text, ZH) == "40 处中有 3 处折叠或退化"
    inner = said(
        "{reason}, but all points are approximated: {error}", reason=said("the dense points fill the area"), error="x"
    )
    assert tell(inner, ZH) == "密集点布满全区，但全部点采用逼近：x"


def test_words_alone_are_told_and_names_are_left():
    assert (tell("borehole", ZH), tell("ZK101", ZH)) == ("钻孔", "ZK101")
    assert sentence("largest angle at a seam", EN) == "Largest angle at a seam."
    assert sentence(said("largest angle at a seam"), ZH) == "拼接缝处的最大夹角。"
    assert sentence("Not told", ZH) == "Not told."


def test_an_unknown_language_names_the_known_ones():
    assert language("zh") is ZH
    with pytest.raises(SettingsError, match="en or zh"):
        language("fr")
