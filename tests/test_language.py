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
#: Methods by which readers list rows: severity and file, or row and role, then reason and remedy.
LISTING = ("add", "reject", "warn")


def literals() -> dict[str, str]:
    """Every text that said(), the report's t() and Check() are given, and where: all of them must be literals."""
    found: dict[str, str] = {}
    for folder in ("geofit", "io"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if not isinstance(node, ast.Call) or not node.args:
                    continue
                if (
                    folder == "io"
                    and "export" not in path.parts
                    and isinstance(node.func, ast.Attribute)
                    and node.func.attr in LISTING
                ):
                    # What readers list: reasons and remedies, each a literal or by said(); other words are names.
                    where = f"{path.relative_to(ROOT).as_posix()}:{node.lineno}"
                    found |= dict.fromkeys((text for one in node.args[2:] for text in _texts(one)), where)
                if not isinstance(node.func, ast.Name):
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


def test_what_the_readers_list_is_told_in_chinese(tmp_path):
    from geofit.io.picks import read_points

    (tmp_path / "p.csv").write_text(
        "x,y,z,surface,hole\n1,2,3,T1,B1\n1,2,4,T1,B2\n5,6,abc,T1,B3\n7,8,,T1,B4\n", encoding="utf-8"
    )
    found = {issue.row: issue for issue in read_points(tmp_path / "p.csv").issues if issue.severity != "note"}
    assert found[4].reason == "The z is no finite number"
    assert tell(found[4].reason, ZH) == "z不是有限数"
    assert tell(found[5].reason, ZH) + tell(found[5].remedy, ZH) == "z为空请补全该单元格。"
    assert tell(found[3].reason, ZH) == "层面 T1：同一位置有两个高程，与 点 B1，p.csv 第 2 行 相差 +1.000 m"


def test_words_alone_are_told_and_names_are_left():
    assert (tell("borehole", ZH), tell("ZK101", ZH)) == ("钻孔", "ZK101")
    assert sentence("largest angle at a seam", EN) == "Largest angle at a seam."
    assert sentence(said("largest angle at a seam"), ZH) == "拼接缝处的最大夹角。"
    assert sentence("Not told", ZH) == "Not told."


def test_an_unknown_language_names_the_known_ones():
    assert language("zh") is ZH
    with pytest.raises(SettingsError, match="en or zh"):
        language("fr")
