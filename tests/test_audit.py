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
    assert "refused licences: bad" in capsys.readouterr().out
