"""The command as a user runs it."""

from __future__ import annotations

import sys

import pytest

from geofit.cli.main import main

__all__ = ["run"]


def run(monkeypatch, capsys, *arguments) -> tuple[int, str, str]:
    """Run the command in this process; return exit code, stdout, stderr."""
    monkeypatch.setattr(sys, "argv", ["geofit", *map(str, arguments)])
    with pytest.raises(SystemExit) as stop:
        main()
    captured = capsys.readouterr()
    return int(stop.value.code or 0), captured.out, captured.err
