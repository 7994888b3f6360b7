"""A page of the acceptance tests of a method: the tests of the suite for each, how many cases passed, how long."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

__all__ = ["ROOT", "Outcome", "write_page"]

ROOT = Path(__file__).parents[1]


class Outcome(NamedTuple):
    """Cases of one test that passed, that were left out, that there are, and their seconds."""

    passed: int = 0
    skipped: int = 0
    count: int = 0
    seconds: float = 0.0


def write_page(
    page: Path, head: Sequence[str], asked: str, short: Mapping[str, str], environment: Mapping[str, str] | None = None
) -> int:
    """Run every test of a list once and write the page; return how many cases failed.

    Parameters
    ----------
    page : Path
    head : sequence of str
        Lines above the table.
    asked : str
        Lines "key what is asked", each followed by indented tests of it, as pytest names them below ``tests``.
    short : mapping
        By key, where a test asks for less than the method.
    environment : mapping, optional
        Variables that the tests are run with.
    """
    rows: list[tuple[str, str, str]] = []
    key, what = "", ""
    for line in asked.strip().splitlines():
        if line.startswith(" "):
            rows.append((key, what, line.strip()))
        else:
            key, _, what = line.partition(" ")
    nodes = sorted({f"tests/{test}" for _, _, test in rows})
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "tests.xml"
        command = [sys.executable, "-m", "pytest", "-q", f"--junitxml={path}", *nodes]
        subprocess.run(command, cwd=ROOT, check=False, env={**os.environ, **(environment or {})})
        found = _outcomes(path)
    lines = [*head, "", "| | what | test | passed | s | short of the method |", "|---|---|---|---:|---:|---|"]
    failed = 0
    for key, what, test in rows:
        file, _, name = test.partition("::")
        one = found.get((Path(file).stem, name), Outcome())
        failed += one.count - one.passed - one.skipped + (one.count == 0)
        cells = [key, what, test, f"{one.passed} of {one.count}", f"{one.seconds:.1f}", short.get(key, "")]
        lines.append("| " + " | ".join(cells) + " |")
    page.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return failed


def _outcomes(path: Path) -> dict[tuple[str, str], Outcome]:
    found: dict[tuple[str, str], Outcome] = {}
    for case in ElementTree.parse(path).getroot().iter("testcase"):
        key = case.get("classname", "").rpartition(".")[2], case.get("name", "").partition("[")[0]
        passed, skipped, count, seconds = found.get(key, Outcome())
        left_out = case.find("skipped") is not None
        failed = any(case.find(word) is not None for word in ("failure", "error"))
        seconds += float(case.get("time", 0))
        found[key] = Outcome(passed + (not failed and not left_out), skipped + left_out, count + 1, seconds)
    return found
