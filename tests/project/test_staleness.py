"""Why a surface is stale: data and files with their hashes, settings, excluded rows."""

from __future__ import annotations

import hashlib
from dataclasses import replace

import pytest

from geofit.data.stale import StaleCause
from geofit.io.site_file import read_site
from geofit.project.building import make
from geofit.project.commands import ExcludeRows, SetArea, SetSettings, SetSurface
from geofit.project.data_change import change_of_data
from geofit.project.document import Document
from geofit.project.provenance import Row
from geofit.project.staleness import stale_causes

NAME = "base"


def sha256(file):
    return hashlib.sha256(file.read_bytes()).hexdigest()


@pytest.fixture
def fitted(tmp_path):
    """A document with a fitted plane, and the file of its points."""
    file = tmp_path / "picks.csv"
    rows = [f"{10 * i},{10 * j},{100 + i - 0.5 * j},{NAME}" for i in range(6) for j in range(6)]
    file.write_text("x,y,z,horizon\n" + "\n".join(rows) + "\n", encoding="utf-8")
    (tmp_path / "site.toml").write_text('[site]\nname = "S"\n[[picks]]\nfile = "picks.csv"\n', encoding="utf-8")
    document = Document()
    document.open(read_site(tmp_path / "site.toml"), tmp_path / "site.toml")
    provenance = document.provenance(NAME)
    document.put(provenance, make(provenance, document.given_for(provenance)))
    SetSurface(provenance).redo(document)
    return document, file


def reread(document):
    site = read_site(document.site_file)
    document.know(site)
    change_of_data(document.state, document.read, site).command.redo(document)


def test_a_file_that_changed_is_named_with_its_hash_of_the_fit(fitted):
    document, file = fitted
    assert stale_causes(document, NAME) == ()
    then, given = sha256(file), document.given(NAME)
    for moved in ("199.0", "299.0"):
        # Read again twice: what counts is the fit, not the reading before.
        lines = file.read_text(encoding="utf-8").splitlines()
        file.write_text("\n".join([lines[0], f"0,0,{moved},{NAME}", *lines[2:]]) + "\n", encoding="utf-8")
        reread(document)
        assert stale_causes(document, NAME) == (
            StaleCause("data", "", given, document.given(NAME)),
            StaleCause("file", "picks.csv", then, sha256(file)),
        )


def test_a_study_area_that_was_drawn_is_other_data_in_the_same_files(fitted):
    document, _ = fitted
    SetArea(((0.0, 0.0), (50.0, 0.0), (50.0, 50.0))).redo(document)
    (cause,) = stale_causes(document, NAME)
    assert cause.kind == "data"
    assert cause.fitted != cause.now


def test_settings_and_excluded_rows_are_named(fitted):
    document, _ = fitted
    settings = document.settings(NAME)
    # The control error judges a surface and does not shape it.
    SetSettings(NAME, replace(settings, epsilon=0.9)).redo(document)
    assert stale_causes(document, NAME) == ()
    SetSettings(NAME, replace(settings, smoothing=0.25)).redo(document)
    ExcludeRows(NAME, (Row("picks.csv", 5),)).redo(document)
    assert document.stale(NAME)
    assert stale_causes(document, NAME) == (
        StaleCause("setting", "smoothing", settings.smoothing, 0.25),
        StaleCause("excluded", "", (), ("picks.csv:5",)),
    )
