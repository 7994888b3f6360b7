"""The list of packages and licences."""

from __future__ import annotations

from email.message import Message

import audit
import pytest


def stated(**fields):
    message = Message()
    for name, values in fields.items():
        for value in values if isinstance(values, list) else [values]:
            message[name.replace("_", "-")] = value

    class Package:
        metadata = message

    return Package()


@pytest.mark.parametrize(
    ("fields", "licence"),
    [
        ({"License_Expression": "MIT", "License": "x"}, "MIT"),
        ({"Classifier": ["Topic :: X", "License :: OSI Approved :: BSD License"]}, "BSD License"),
        ({"License": "Apache-2.0\nlong text"}, "Apache-2.0"),
        ({}, "not stated"),
    ],
)
def test_a_licence_is_found_wherever_it_is_stated(fields, licence):
    assert audit.licence_of(stated(**fields)) == licence


def test_every_package_is_listed_once_and_a_refused_licence_fails(monkeypatch, capsys):
    names = [name for name, _, _ in audit.packages()]
    assert {"numpy", "scipy", "typer"} <= set(names)
    assert len(names) == len(set(names))
    monkeypatch.setattr(audit.importlib.util, "find_spec", lambda name: None)
    monkeypatch.setattr(audit, "packages", lambda: [("bad", "1", "GNU AGPLv3")])
    assert audit.main() == 1
    told = capsys.readouterr().out
    assert "refused licences: bad" in told
    assert "Advisories were not looked up: pip-audit is not installed" in told


@pytest.mark.parametrize(
    ("code", "known", "why"),
    [
        ('print(\'{"dependencies": [{"name": "a", "version": "1", "vulns": []}, {"name": "b", "skip_reason": "x"}]}\')',
         [], ""),
        ('print(\'{"dependencies": [{"name": "a", "version": "1","vulns": [{"id": "C-1", "fix_versions": ["2"]}]}]}\')'
         '; sys.exit(1)', ["a 1: C-1, mended in 2"], ""),
        ('sys.exit("ERROR: the index cannot be reached")', [], "ERROR: the index cannot be reached"),
        ("import time; time.sleep(60)", [], "pip-audit had no answer after 2 s"),
    ],
    ids=["none", "one", "unreachable", "no answer"],
)  # fmt: skip
def test_advisories_are_listed_or_the_reason_why_not(code, known, why, tmp_path, monkeypatch):
    (tmp_path / "pip_audit.py").write_text(f"import sys\n{code}\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    assert audit.advisories(2) == (known, why)
