"""Horizons renamed, removed and merged: what belongs to them goes along, and every step can be undone."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from geofit.bodies.settings import BodySettings
from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.data.site import Orientations, Site
from geofit.io.site_file import read_site
from geofit.prediction.examine import examine
from geofit.project.body_building import make_body
from geofit.project.body_commands import SetBody
from geofit.project.body_record import BetweenHorizons, BodyProvenance, BodyRecord, BodyStyle, MorphFrame
from geofit.project.building import edited, make
from geofit.project.commands import ExcludeRows, MergeHorizons, MoveToPoint, RemoveHorizons, RenameHorizon, SetSurface
from geofit.project.data_change import change_of_data
from geofit.project.document import Document
from geofit.project.horizon_edits import HorizonEdit, present_name, present_provenance
from geofit.project.provenance import DocumentError, MoveToPointEdit, Provenance, Row
from geofit.project.saving import read_project, save_state
from geofit.project.staleness import stale_body_causes


def points(seed, shift, file="a.csv"):
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(0, 200, (2, 40))
    return PointSet(np.column_stack([x, y, shift + 0.1 * x]), row=np.arange(40) + 2, file=file)


def opened(**extra):
    horizons = {"top": points(1, 50), "low": points(2, 20), "deep": points(3, 0)}
    document = Document()
    settings = {"low": FitSettings(epsilon=0.2)}
    document.open(Site("Dam", horizons, settings, order=("top", "low", "deep"), **extra), None)
    return document


def fitted(document, name):
    provenance = document.provenance(name)
    document.put(provenance, make(provenance, document.given_for(provenance)))
    SetSurface(provenance).redo(document)


def test_a_renamed_horizon_keeps_settings_rows_and_surface():
    document = opened()
    ExcludeRows("low", (Row("a.csv", 5),)).redo(document)
    fitted(document, "low")
    before, control = document.state, document.surface("low").patches[0].control
    step = RenameHorizon("low", "base of T2")
    step.redo(document)
    assert document.horizons == ("top", "base of T2", "deep")
    assert document.site.order == ("top", "base of T2", "deep")
    assert document.settings("base of T2").epsilon == 0.2
    assert document.state.excluded["base of T2"] == {Row("a.csv", 5)}
    assert not document.stale("base of T2")
    assert document.missing() == ()
    assert document.surface("base of T2").name == "base of T2"
    wanted = document.state.provenances["base of T2"]
    again = make(wanted, document.given_for(wanted))
    assert again.name == "base of T2"
    assert np.array_equal(again.patches[0].control, control)
    step.undo(document)
    assert document.state == before
    assert document.missing() == ()
    assert document.surface("low").name == "low"


def test_a_renamed_horizon_keeps_manual_edits_and_examination_even_of_data_that_are_gone():
    document = opened()
    fitted(document, "low")
    former = document.state.provenances["low"]
    document.put(
        replace(former, edits=(MoveToPointEdit(3, 1.0),)), edited(document.surface("low"), MoveToPointEdit(3, 1.0))
    )
    MoveToPoint("low", 3, 1.0).redo(document)
    moved, found = document.surface("low"), examine(document.surface("low"))
    document.put_prediction(document.state.provenances["low"], found)
    other = replace(document.read, horizons={**document.read.horizons, "low": points(7, 21)})
    document.know(other)
    change_of_data(document.state, document.read, other).command.redo(document)
    step = RenameHorizon("low", "T2")
    for name in ("T2", "low", "T2"):
        (step.redo if name == "T2" else step.undo)(document)
        assert document.lost() == ()
        assert np.array_equal(document.surface(name).patches[0].control, moved.patches[0].control)
        assert document.prediction(name) is found
        provenance, _, surface = document.earlier(name)
        assert provenance.horizon == surface.name == name
        assert provenance.edits == (MoveToPointEdit(3, 1.0),)


def test_a_horizon_that_takes_the_name_of_one_that_was_removed_does_not_take_its_fits():
    document = opened()
    fitted(document, "top")
    fitted(document, "low")
    low = document.surface("low").patches[0].control
    remove, rename = RemoveHorizons(("top",)), RenameHorizon("low", "top")
    remove.redo(document)
    rename.redo(document)
    assert np.array_equal(document.surface("top").patches[0].control, low)
    assert len(document.shelf.fits_of("top")) == 1
    rename.undo(document)
    assert len(document.shelf.fits_of("low")) == 1
    remove.undo(document)
    # It can be made again from the same data.
    assert [one.horizon for one in document.missing()] == ["top"]


def test_bodies_between_horizons_follow_the_name():
    document = opened()
    fitted(document, "top")
    fitted(document, "low")
    settings, site = BodySettings(), (document.site.boreholes, Path())
    closed, result = make_body(BetweenHorizons("top", "low"), settings, "clay", *site, document.surfaces())
    document.sources.made(closed, dict(document.state.provenances))
    document.put_body(closed, result)
    SetBody("clay", BodyRecord(closed, BodyStyle("#112233"))).redo(document)
    frame = BodyProvenance(MorphFrame((closed, closed), ("a", "b"), "arrival", "progress", (), 32, 0.5), settings, "f")
    SetBody("frame", BodyRecord(frame, BodyStyle("#112233"))).redo(document)
    step = RenameHorizon("low", "T2")
    for name in ("T2", "low", "T2"):
        (step.redo if name == "T2" else step.undo)(document)
        source = document.state.bodies["clay"].provenance.source
        assert source == BetweenHorizons("top", name)
        assert document.state.bodies["frame"].provenance.source.ends[1].source == source
        assert document.body("clay") is result
        assert stale_body_causes(document, "clay") == ()
    again, _ = make_body(source, settings, "clay", *site, document.surfaces())
    assert again == document.state.bodies["clay"].provenance


def test_names_as_they_are_now_are_found_from_then():
    renamed, merged = HorizonEdit("renamed", ("a",), "b"), HorizonEdit("merged", ("b", "c"), "d")
    removed = HorizonEdit("removed", ("c",))
    for name, then, now, expected in (
        ("a", (), (renamed,), "b"), ("b", (renamed,), (), "a"), ("c", (), (renamed,), "c"),
        ("a", (), (renamed, merged), None), ("d", (renamed, merged), (renamed,), None), ("c", (), (removed,), None),
        ("c", (removed,), (), "c"), ("b", (renamed,), (removed, renamed), "b"),
    ):  # fmt: skip
        assert present_name(name, then, now) == expected
        found = present_provenance(Provenance(name, FitSettings(), "x"), then, now)
        assert (None if found is None else found.horizon) == expected


def test_merged_horizons_have_all_points_and_the_rows_that_were_out_stay_out():
    # Both have row 5 of one file: the second of the merged points of that row must stay out.
    document = opened()
    out = document.site.horizons["low"].xyz[3]
    ExcludeRows("low", (Row("a.csv", 5),)).redo(document)
    document.merging(("top", "low"), "one").redo(document)
    assert document.horizons == ("one", "deep")
    assert document.site.order == ("one", "deep")
    used = document.points("one").xyz
    assert len(used) == 79
    assert not (used == out).all(axis=1).any()
    assert (used == points(1, 50).xyz[3]).all(axis=1).any()


def test_a_removed_horizon_is_gone_and_comes_back():
    document = opened()
    step = RemoveHorizons(("low",))
    step.redo(document)
    assert document.horizons == ("top", "deep")
    assert list(document.site.horizons) == ["top", "deep"]
    step.undo(document)
    assert document.horizons == ("top", "low", "deep")
    assert len(document.points("low")) == 40


def test_dips_follow_the_name():
    dips = Orientations(np.zeros((2, 3)), np.zeros(2), np.full(2, 5.0), np.array(["low", ""]), np.array(["d", "d"]),
                        np.array([2, 3]))  # fmt: skip
    document = opened(orientations=dips)
    fitted(document, "low")
    fitted(document, "top")
    RenameHorizon("low", "T2").redo(document)
    assert document.site.orientations.horizon.tolist() == ["T2", ""]
    # A fingerprint of the dips has their horizons: the name alone makes nothing stale.
    assert not document.stale("T2")
    assert not document.stale("top")


@pytest.mark.parametrize(
    "command",
    [
        RenameHorizon("low", "TOP"), RenameHorizon("low", ""), RenameHorizon("low", " x"), RenameHorizon("no", "x"),
        RemoveHorizons(("top", "low", "deep")), MergeHorizons(("low",), "x"), MergeHorizons(("top", "low"), "deep"),
    ],
    ids=str,
)  # fmt: skip
def test_what_makes_no_sense_is_refused(command):
    document = opened()
    with pytest.raises(DocumentError):
        command.on(document.state)


def test_a_project_keeps_the_names(tmp_path):
    (tmp_path / "p.csv").write_text(
        "x,y,z,horizon\n" + "\n".join(f"{7 * k % 83},{k},{k * 0.1:.2f},{'ab'[k % 2]}" for k in range(40)),
        encoding="utf-8",
    )
    (tmp_path / "site.toml").write_text('[site]\nname = "S"\n[[picks]]\nfile = "p.csv"\n', encoding="utf-8")
    document = Document()
    document.open(read_site(tmp_path / "site.toml"), tmp_path / "site.toml")
    RenameHorizon("a", "T1").redo(document)
    document.merging(("T1", "b"), "all").redo(document)
    state = document.state
    save_state(state, document.read, document.site_file, tmp_path / "s.geofit", {}, False,
               progress=lambda stage, share: True)  # fmt: skip
    again = read_project(tmp_path / "s.geofit")
    assert again.state == state
    back = Document()
    back.open(again.site, document.site_file, again.state)
    assert {name: len(one) for name, one in back.site.horizons.items()} == {"all": 40}
