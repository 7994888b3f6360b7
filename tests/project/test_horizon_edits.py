"""Horizons renamed, removed and merged: what belongs to them goes along, and every step can be undone."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.data.site import Orientations, Site
from geofit.io.site_file import read_site
from geofit.project.building import make
from geofit.project.commands import ExcludeRows, MergeHorizons, RemoveHorizons, RenameHorizon, SetSurface
from geofit.project.document import Document
from geofit.project.provenance import DocumentError, Row
from geofit.project.saving import read_project, save_state


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
    (wanted,) = document.missing()
    document.put(wanted, make(wanted, document.given_for(wanted)))
    again = document.surface("base of T2")
    assert again.name == "base of T2"
    assert np.array_equal(again.patches[0].control, control)
    step.undo(document)
    assert document.state == before
    assert document.surface("low") is not None


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
    RenameHorizon("low", "T2").redo(document)
    assert document.site.orientations.horizon.tolist() == ["T2", ""]


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
