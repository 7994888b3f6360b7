"""What tests may rely on: what modules, classes and windows offer, not what they keep to themselves."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

TESTS = Path(__file__).parent
#: Names of the standard library that are public by its documentation.
DOCUMENTED = {"os._exit"}


def is_private(name: str) -> bool:
    """Whether a name belongs to its owner: ``_name``, but no ``__dunder__`` and no protocol as ``_repr_html_``."""
    return name.startswith("_") and not name.endswith("_")


def private_access(tree: ast.AST) -> list[tuple[int, str]]:
    """Return line and text of what reaches into others: attributes, imports, names that monkeypatch takes."""
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and is_private(node.attr):
            own = isinstance(node.value, ast.Name) and node.value.id in ("self", "cls")
            if not own and ast.unparse(node) not in DOCUMENTED:
                found.append((node.lineno, ast.unparse(node)))
        elif isinstance(node, ast.ImportFrom):
            parts = [*(node.module or "").split("."), *(alias.name for alias in node.names)]
            found += [(node.lineno, f"import of {part}") for part in parts if is_private(part)]
        elif isinstance(node, ast.Call) and ast.unparse(node.func).split(".")[-1] in ("getattr", "setattr", "delattr"):
            texts = [arg.value for arg in node.args if isinstance(arg, ast.Constant) and isinstance(arg.value, str)]
            found += [(node.lineno, f"'{text}'") for text in texts if is_private(text.split(".")[-1])]
    return found


def test_tests_reach_into_nobody():
    wrong = [
        f"{path.relative_to(TESTS)}:{line}: {text}"
        for path in sorted(TESTS.rglob("*.py"))
        for line, text in private_access(ast.parse(path.read_text(encoding="utf-8")))
    ]
    assert not wrong, "use what is public (a property, a signal, the Driver of tests/gui):\n" + "\n".join(wrong)


@pytest.mark.parametrize(
    "code",
    ["panel._task", "app.window.view._stage.items()", "from geofit.io.axes import _crowd", "module._x()",
     "monkeypatch.setattr(scene, '_found', 1)", "monkeypatch.setattr('geofit.io.axes._BINS', 1)", "getattr(a, '_b')"],
)  # fmt: skip
def test_what_is_private_is_found(code):
    assert len(private_access(ast.parse(code))) == 1


@pytest.mark.parametrize("code", ["self._found", "os._exit(1)", "fit._repr_html_()", "a.__class__", "_own(1)"])
def test_what_is_public_or_own_is_not(code):
    assert not private_access(ast.parse(code))
