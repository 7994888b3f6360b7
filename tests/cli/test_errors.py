"""Errors of the command: a document on stdout where JSON was asked for."""

from __future__ import annotations

import json
import os
from contextlib import suppress
from pathlib import Path

import pytest
from commands import run

from geofit.cli import console


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (["fit", "{t}/none.csv", "--out", "{t}/o"], "data.file-missing"),
        (["fit", "{t}/bad.csv", "--out", "{t}/o"], None),
        (["report", "{t}/bad.toml", "--out", "{t}/o"], None),
        (["check", "{t}/bad.step", "{t}/bad.csv"], None),
        (["info", "{t}/bad.step"], None),
        (["compare", "{t}/bad.toml", "{t}/bad.toml"], None),
        (["import", "{t}/bad.csv", "--site", "{t}/s.csv"], "cli.site-file-not-toml"),
        (["export", "{t}/bad.step", "--to", "dxf", "--out", "{t}/o.dxf"], None),
        (["section", "{t}/bad.step", "--line", "0,0,1,1", "--out", "{t}/o"], None),
        (["body", "{t}/bad.csv", "--out", "{t}/o"], None),
        (["morph", "{t}/bad.stl", "{t}/bad.stl", "--out", "{t}/o"], None),
        (["pores", "{t}/bad.npy", "--pore", "0", "--out", "{t}/o"], None),
        (["metaballs", "{t}/bad.npy", "--pore", "0", "--out", "{t}/o"], None),
        (["cave", "{t}/bad.svx", "--out", "{t}/o"], None),
        (["fit", "{t}/bad.csv", "--out", "{t}/bad.csv/o"], None),
        (["fit", "{t}/bad.csv", "--unknown", "1"], "cli.wrong-usage"),
        (["fit", "{t}/bad.csv"], "cli.wrong-usage"),
        (["fits"], "cli.wrong-usage"),
        (["morph", "{t}/bad.stl", "{t}/bad.stl", "--sd", "a,b", "--out", "{t}/o"], None),
    ],
    ids=lambda value: "-".join(value[:1]) if isinstance(value, list) else "",
)
def test_an_error_is_a_document_on_stdout_where_json_was_asked_for(arguments, code, tmp_path, monkeypatch, capsys):
    """A script that parses stdout learns what is wrong and what to do, instead of failing on an empty text."""
    for ending in ("csv", "toml", "step", "stl", "npy", "svx"):
        (tmp_path / f"bad.{ending}").write_text("x,y,z\n1,2,a\n", encoding="utf-8")
    given = [word.replace("{t}", str(tmp_path)) for word in arguments]
    left, silent, told = run(monkeypatch, capsys, *given)
    assert (left, silent) == (2, ""), "without --json nothing stands on stdout"
    left, out, err = run(monkeypatch, capsys, *given, "--json")
    assert left == 2
    assert err.splitlines()[-1] == told.splitlines()[-1]
    data = json.loads(out)
    assert (data["kind"], data["schema_version"], data["exit_code"]) == ("error", 1, 2)
    assert data["reason"]["text"] in data["text"]
    assert data["reason"]["text"] in err
    assert data["reason"]["severity"] == "error"
    assert data["remedy"] is None or data["remedy"]["text"] in data["text"]
    if code:
        assert data["reason"]["code"] == code
    jsonschema = pytest.importorskip("jsonschema", reason="validates the results; it comes with the extra 'test'")
    from geofit.report.schema import result_schema

    jsonschema.Draft202012Validator(result_schema()).validate(data)


def test_the_error_document_holds_place_remedy_and_rows(tmp_path, monkeypatch, capsys):
    (tmp_path / "p.csv").write_text("x,y,z\n1,2,a\n2,3,b\n", encoding="utf-8")
    left, out, _ = run(monkeypatch, capsys, "fit", tmp_path / "p.csv", "--out", tmp_path / "o", "--json")
    data = json.loads(out)
    assert left == data["exit_code"] == 2
    assert data["file"].endswith("p.csv")
    assert data["remedy"]["text"]
    assert [(one["row"], one["column"], one["value"]) for one in data["rejected"]] == [(2, "z", "a"), (3, "z", "b")]


def test_a_stop_is_a_document_with_130(capsys):
    @console.with_exit_code
    def command(as_json: bool) -> int:
        raise KeyboardInterrupt

    with pytest.raises(Exception) as stop:  # noqa: PT011 - typer's Exit has moved between its releases
        command(as_json=True)
    data = json.loads(capsys.readouterr().out)
    assert stop.value.exit_code == data["exit_code"] == 130
    assert data["reason"]["code"] == "cli.stopped"


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="Linux has a disk that is always full")
def test_a_full_disk_under_stdout_is_one_line_too(tmp_path, monkeypatch, capsys):
    """Writing the error's document there had ended in a traceback."""
    with Path("/dev/full").open("w", buffering=1) as full, monkeypatch.context() as patched:
        patched.setattr("sys.stdout", full)
        left, _, told = run(patched, capsys, "check", tmp_path / "none.step", tmp_path / "none.csv", "--json")
        patched.undo()
        with suppress(OSError):
            full.close()
    assert left == 2
    assert told.splitlines()[-1].startswith("geofit: ")
