"""Why surfaces and bodies are stale: data and files with their hashes, settings, excluded rows, horizons."""

from __future__ import annotations

import hashlib
from dataclasses import replace

import pytest

from geofit.bodies.settings import BodySettings
from geofit.data.stale import StaleCause
from geofit.io.site_file import read_site
from geofit.project.body_building import BodyResult
from geofit.project.body_commands import SetBody
from geofit.project.body_record import (
    BetweenHorizons,
    BodyProvenance,
    BodyRecord,
    BodySource,
    BodyStyle,
    Intervals,
    MorphFrame,
    SurfacePicks,
)
from geofit.project.body_sources import data_now
from geofit.project.building import make
from geofit.project.commands import ExcludeRows, SetArea, SetSettings, SetSurface
from geofit.project.data_change import change_of_data
from geofit.project.document import Document
from geofit.project.known_sources import file_sources
from geofit.project.provenance import Row
from geofit.project.staleness import dated_body, stale_body_causes, stale_causes

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


def add_body(document: Document, name: str, source: BodySource, given: str) -> BodyProvenance:
    """Add a body that was made from a source when its data had a hash; its shape does not matter here."""
    made = BodyProvenance(source, BodySettings(), given)
    SetBody(name, BodyRecord(made, BodyStyle("#aa5533"))).redo(document)
    return made


def read_sources(document: Document) -> None:
    """Read the files of all bodies again, as a window does when it comes to the front."""
    found = data_now(list(file_sources(document.state.bodies.values())), document.site_folder)
    document.know_sources({source: given for source, (given, _) in found.items()})


def frame(*ends: BodyProvenance) -> MorphFrame:
    return MorphFrame(ends, tuple("AB"), "field", "even", (), 32, 0.5)


def test_a_body_names_its_file_with_the_data_then_and_now(fitted):
    document, file = fitted
    points = file.with_name("lens.csv")
    points.write_text("x,y,z\n0,0,0\n1,0,0\n", encoding="utf-8")
    then = sha256(points)[:16]
    lens = add_body(document, "lens", SurfacePicks("lens.csv"), then)
    add_body(document, "frame", frame(lens, lens), "0123")
    assert stale_body_causes(document, "lens") == ()
    read_sources(document)
    assert stale_body_causes(document, "lens") == stale_body_causes(document, "frame") == ()
    points.write_text("x,y,z\n0,0,0\n1,0,9\n", encoding="utf-8")
    changed = []
    document.bodies_changed.connect(lambda: changed.append(True))
    read_sources(document)
    assert changed
    causes = (StaleCause("source", "lens.csv", then, sha256(points)[:16]),)
    # What was interpolated between stale bodies is stale for the same reason.
    assert stale_body_causes(document, "lens") == stale_body_causes(document, "frame") == causes
    points.unlink()
    read_sources(document)
    assert stale_body_causes(document, "lens") == (StaleCause("source", "lens.csv", then, None),)


def test_a_body_goes_on_being_stale_when_the_site_is_read_again(fitted):
    document, file = fitted
    points = file.with_name("lens.csv")
    points.write_text("x,y,z\n0,0,0\n", encoding="utf-8")
    add_body(document, "lens", SurfacePicks("lens.csv"), "earlier")
    read_sources(document)
    file.write_text(file.read_text(encoding="utf-8").replace("0,0,100.0", "0,0,199.0"), encoding="utf-8")
    reread(document)
    assert [cause.kind for cause in stale_body_causes(document, "lens")] == ["source"]


def test_a_body_between_horizons_is_stale_until_it_follows_a_horizon_that_was_fitted_again(fitted):
    document, file = fitted
    source = BetweenHorizons(NAME, 50.0)
    first = dict(document.state.provenances)
    made = add_body(document, "wedge", source, "before")
    assert stale_body_causes(document, "wedge") == ()
    document.sources.made(made, first)
    assert stale_body_causes(document, "wedge") == ()
    # The control error judges a surface and does not shape it.
    SetSettings(NAME, replace(document.settings(NAME), epsilon=0.9)).redo(document)
    assert stale_body_causes(document, "wedge") == ()
    # The horizon is stale, and so is what was made from it; after another fit the body still is.
    file.write_text(file.read_text(encoding="utf-8").replace("0,0,100.0", "0,0,199.0"), encoding="utf-8")
    reread(document)
    (cause,) = stale_body_causes(document, "wedge")
    assert (cause.kind, cause.name) == ("horizon", NAME)
    refit = SetSurface(document.provenance(NAME))
    refit.redo(document)
    assert stale_body_causes(document, "wedge") == (cause,)
    again = add_body(document, "wedge", source, "after")
    document.sources.made(again, dict(document.state.provenances))
    assert stale_body_causes(document, "wedge") == ()
    refit.undo(document)
    assert [one.kind for one in stale_body_causes(document, "wedge")] == ["horizon"]


def test_a_body_that_the_same_horizons_make_otherwise_is_stale(fitted):
    document, _ = fitted
    source = BetweenHorizons(NAME, 50.0)
    add_body(document, "wedge", source, "saved")
    document.sources.made(BodyProvenance(source, BodySettings(), "again"), dict(document.state.provenances))
    assert stale_body_causes(document, "wedge") == (StaleCause("horizon", NAME, "saved", "again"),)


def test_a_body_of_logs_names_the_files_of_the_site_that_changed(tmp_path):
    (tmp_path / "picks.csv").write_text(f"x,y,z,horizon\n0,0,100,{NAME}\n40,0,101,{NAME}\n", encoding="utf-8")
    (tmp_path / "collars.csv").write_text("hole,x,y,z,depth\nA,0,0,100,50\nB,40,0,100,50\n", encoding="utf-8")
    log = tmp_path / "lithology.csv"
    log.write_text("hole,from,to,code\nA,0,20,ORE\nA,20,50,ROCK\nB,0,10,ORE\nB,10,50,ROCK\n", encoding="utf-8")
    (tmp_path / "site.toml").write_text(
        '[site]\nname = "S"\n[[picks]]\nfile = "picks.csv"\n'
        '[boreholes]\ncollar = "collars.csv"\nintervals = ["lithology.csv"]\n',
        encoding="utf-8",
    )
    document = Document()
    document.open(read_site(tmp_path / "site.toml"), tmp_path / "site.toml")
    then, given = sha256(log), document.logs(document.state.data)
    add_body(document, "ORE", Intervals(("ORE",)), given)
    assert stale_body_causes(document, "ORE") == ()
    log.write_text(log.read_text(encoding="utf-8").replace("A,0,20", "A,0,21"), encoding="utf-8")
    reread(document)
    assert stale_body_causes(document, "ORE") == (
        StaleCause("logs", "", given, document.logs(document.state.data)),
        StaleCause("file", "lithology.csv", then, sha256(log)),
    )


def test_what_leaves_the_document_of_a_body_has_its_causes(fitted):
    document, _ = fitted
    made = add_body(document, "lens", SurfacePicks("lens.csv"), "earlier")
    assert dated_body(document, "lens") is None
    document.put_body(made, BodyResult(None))
    assert dated_body(document, "lens").stale == ()
    read_sources(document)
    assert dated_body(document, "lens").stale == (StaleCause("source", "lens.csv", "earlier", None),)
