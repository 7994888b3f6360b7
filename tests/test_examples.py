"""Every example runs as it is written, uses the public names only, and leaves a picture that is not blank."""

from __future__ import annotations

import ast
import runpy
from pathlib import Path

import pytest

EXAMPLES = sorted((Path(__file__).resolve().parents[1] / "examples").glob("*.py"))


def test_there_are_ten_examples():
    assert len(EXAMPLES) >= 10


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_is_short_and_imports_the_front_door_only(path):
    text = path.read_text(encoding="utf-8")
    tree = ast.parse(text)
    assert ast.get_docstring(tree).count("\n") >= 2, "what it shows, and how"
    code = [line for line in text.split('"""', 2)[2].splitlines() if line.strip() and not line.startswith("#")]
    assert 15 <= len(code) <= 40
    names = {alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names}
    names |= {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    assert {name for name in names if name.startswith("geofit")} <= {"geofit", "geofit.io"}


@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs_and_draws(path, tmp_path, monkeypatch):
    matplotlib = pytest.importorskip("matplotlib")
    monkeypatch.setattr("sys.argv", [str(path), str(tmp_path / "new")])
    matplotlib.use("Agg")
    try:
        runpy.run_path(str(path), run_name="__main__")
    finally:
        matplotlib.pyplot.close("all")
    from matplotlib.image import imread

    picture = imread(tmp_path / "new" / f"{path.stem}.png")
    assert picture.shape[0] > 200
    assert picture[..., :3].std() > 0.02, "the picture is blank"
