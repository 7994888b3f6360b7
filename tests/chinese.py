"""What the sources say, and what is left in English of it where it is told in Chinese."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import get_args

from geofit.data.errors import GeofitError
from geofit.data.prediction import Scheme
from geofit.report.language import ZH, tell

__all__ = ["english_left", "literals"]

ROOT = Path(__file__).resolve().parents[1]
#: Which arguments are told: what readers list (methods of theirs, not of the exporters) and refuse, and what needs a
#: package; a check's name; and the stages of a task.
TOLD = {
    "add": slice(2, None),
    "reject": slice(2, None),
    "warn": slice(2, None),
    "set_aside": slice(2, 4),
    "fail": slice(0, 2),
    "need": slice(2, 3),
    "ImportIssue": slice(5, None),
    "Check": slice(0, 1),
    "tell": slice(1, 2),
    "stage": slice(0, 1),
    "progress": slice(0, 1),
}
#: The command line speaks English, and so does what is said before a window is open.
ENGLISH = ("app.py", "ready.py", "opengl.py")

#: Keys, file names and code: quoted, in brackets, or with a sign that prose does not have.
_TOKENS = re.compile(r"“[^”]*”|\[\[?\w+\]?\]|\{[^}]*\}|\S*[=_./]\S*")


def english_left(text: str) -> list[str]:
    """Return runs of two and more words with small letters, which Chinese readers would meet."""
    return re.findall(r"\b\w*[a-z]{2}[\w']*(?: [\w']*[a-z]{2}[\w']*)+", _TOKENS.sub("，", tell(text, ZH)), re.ASCII)


def literals(folders: Iterable[str], told: Mapping[str, slice] = TOLD) -> dict[str, str]:
    """Return every text that said(), the report's t(), errors and the calls of ``told`` are given, and where.

    A text with values that is not by said() is returned as it stands in the source, which has no Chinese.
    """
    errors = _kinds(GeofitError) - {"Cancelled"} | {"DocumentError"}
    found: dict[str, str] = {}
    for path in sorted(path for folder in folders for path in (ROOT / folder).rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        variables = _assigned(tree)
        for node in ast.walk(tree):
            if not isinstance(node, ast.Call) or path.name in ENGLISH or path.parent.name == "cli":
                continue
            name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
            given: list[ast.expr] = []
            if name in ("said", "t"):
                given = node.args[:1]
            elif name in errors:
                given = node.args[:2]
            elif name in told and not ("export" in path.parts and name == "add"):
                given = node.args[told[name]]
            where = f"{path.relative_to(ROOT).as_posix()}:{node.lineno}"
            found |= dict.fromkeys((text for one in given for text in _texts(one, variables)), where)
    return {text: where for text, where in found.items() if text}


def _kinds(base: type[Exception]) -> set[str]:
    return {base.__name__}.union(*(_kinds(each) for each in base.__subclasses__()))


def _assigned(tree: ast.AST) -> dict[str, list[ast.expr]]:
    """Return what is assigned to each variable of a module."""
    found: dict[str, list[ast.expr]] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            found.setdefault(node.targets[0].id, []).append(node.value)
    return found


def _texts(node: ast.expr, variables: Mapping[str, list[ast.expr]]) -> list[str]:
    """Return the texts that an argument can be; a scheme of cross-validation is one of three by its type."""
    if isinstance(node, ast.Attribute) and node.attr == "scheme":
        return list(get_args(Scheme))
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return [node.value]
    if isinstance(node, (ast.JoinedStr, ast.BinOp)):
        return [ast.unparse(node)]
    if isinstance(node, ast.IfExp):
        return [text for each in (node.body, node.orelse) for text in _texts(each, variables)]
    if isinstance(node, ast.Name):
        return [text for value in variables.get(node.id, []) for text in _texts(value, {})]
    return []
