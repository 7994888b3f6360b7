from __future__ import annotations

import json
import logging
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from faulted import BOUNDARY, ORIGIN, START, WAY, armed_site, faulted_site, off, throw

from geofit import FitSettings
from geofit.data.site import Orientations
from geofit.gui.panels.curtain import Curtain
from geofit.gui.panels.section_painter import SectionData
from geofit.io.project import open_project
from geofit.project.building import make
from geofit.project.commands import ExcludeRows, IncludeRows, SetSettings, SetSurface, SplitAtFaults
from geofit.project.document import Document
from geofit.project.fault_blocks import cuts_measured, split_at_faults
from geofit.project.ordering import comparable
from geofit.project.provenance import DocumentError, Row
from geofit.project.reporting import write_report_files
from geofit.project.saving import project_of, read_saved_surfaces, state_of, write_project
from geofit.report.result import HorizonResult
from geofit.site.fit_site import fit_site

BLOCKS = ["T2 (A)", "T2 (B)"]


def quiet(stage, fraction):
    return True


def opened(site=None):
    document = Document()
    document.open(site or faulted_site(), Path("site.toml"))
    return document


def part(document):
    given, left_out = document.inputs_for_blocks("T2")
    found = split_at_faults("T2", document.faults("T2"), left_out, given, document.given("T2"), progress=quiet)
    for provenance, surface in found.faults.items():
        document.put(provenance, surface)
        SetSurface(provenance).redo(document)
    return found


def fit(document, names):
    for name in names:
        provenance = document.provenance(name)
        document.put(provenance, make(provenance, document.given_for(provenance)))
        SetSurface(provenance).redo(document)


def rows_of(points):
    return {Row.of(points, i) for i in range(len(points))}


def rows(document):
    """Rows of all points of the blocks that take part."""
    return rows_of(document.points(BLOCKS[0])) | rows_of(document.points(BLOCKS[1]))


@pytest.fixture(scope="module")
def parted():
    """A document whose horizon was split, and its blocks fitted."""
    document = opened()
    SplitAtFaults("T2", dict(part(document).blocks)).redo(document)
    fit(document, BLOCKS)
    return document


def test_blocks_stand_in_the_place_of_the_horizon(parted):
    assert list(parted.horizons) == [*BLOCKS, "F1"]
    whole = faulted_site().horizons["T2"]
    sides = [off(*parted.points(name).xyz.T) > 0 for name in BLOCKS]
    assert sum(len(side) for side in sides) == len(whole)
    assert {bool(side.all() or (~side).all()) for side in sides} == {True}
    assert sides[0][0] != sides[1][0]
    assert list(parted.site_in_use().horizons) == [*BLOCKS, "F1"]


def test_the_window_and_the_command_line_make_the_same_surfaces(parted):
    given = fit_site(faulted_site(), ["T2"])
    assert list(given.surfaces) == BLOCKS
    for name in BLOCKS:
        mine, theirs = parted.surface(name), given.surfaces[name]
        np.testing.assert_array_equal(mine.outline, theirs.outline)
        for one, other in zip(mine.patches, theirs.patches, strict=True):
            np.testing.assert_array_equal(one.control, other.control)
        assert [c.name for c in mine.accuracy.checks] == [c.name for c in theirs.accuracy.checks]


def test_the_throw_is_that_of_the_truth(parted):
    (cut,) = cuts_measured(parted.blocks("T2"), progress=quiet)
    along = (cut.trace[:, :2] - ORIGIN - START) @ WAY
    assert (cut.fault, cut.horizon) == ("F1", "T2")
    assert cut.throw.mean() == pytest.approx(throw(along).mean(), abs=0.25)


def test_a_block_is_as_old_as_its_fault_and_its_site(parted):
    document = opened()
    document.become(parted.state)
    assert not document.stale("T2 (A)")
    assert not document.needs_split("T2 (A)")
    other = SetSettings("F1", FitSettings(frame="best-plane", interior_tolerance=0.2))
    other.redo(document)
    assert document.needs_split("T2 (A)")
    assert document.stale("T2 (A)")
    other.undo(document)
    assert not document.stale("T2 (B)")
    site = faulted_site()
    fewer = replace(site, horizons={**site.horizons, "T2": site.horizons["T2"][1:]})
    document.open(fewer, None, parted.state)
    assert document.needs_split("T2 (B)")
    assert document.missing() == (document.state.provenances["F1"],)


def test_excluded_rows_stay_excluded_however_the_horizon_is_parted_and_can_be_included_again():
    document = opened()
    points = document.points("T2")
    first, second = Row.of(points, 3), Row.of(points, 40)
    ExcludeRows("T2", (first,)).redo(document)
    SplitAtFaults("T2", dict(part(document).blocks)).redo(document)
    assert rows(document) == rows_of(points) - {first}
    home = next(name for name in BLOCKS if first.find(document.site.horizons[name]) is not None)
    ExcludeRows("T2 (A)", (second,)).redo(document)
    SplitAtFaults("T2", dict(part(document).blocks)).redo(document)
    assert rows(document) == rows_of(points) - {first, second}
    IncludeRows(home, (first,)).redo(document)
    assert rows(document) == rows_of(points) - {second}


def test_excluded_rows_belong_to_the_arm_in_which_they_lie():
    document = opened(armed_site())
    points = document.points("T2")
    x, y = points.xyz[:, :2].T
    arms = [x < 400, (x > 600) & (y < 400), (x > 600) & (y > 600)]
    excluded = np.concatenate([np.flatnonzero(arm)[:8] for arm in arms])
    ExcludeRows("T2", tuple(Row.of(points, int(i)) for i in excluded)).redo(document)
    SplitAtFaults("T2", dict(part(document).blocks)).redo(document)
    homes = [
        {
            name
            for name in document.site.horizons
            if Row.of(points, int(i)).find(document.site.horizons[name]) is not None
        }
        for i in range(len(points))
    ]
    found = [{name for i in np.flatnonzero(arm) for name in homes[i]} for arm in arms]
    assert [len(names) for names in found] == [1, 1, 1]
    assert len(set.union(*found)) == 3


def test_excluded_rows_that_lie_in_no_block_are_told():
    site = faulted_site()
    east = site.horizons["F1"].with_(xyz=site.horizons["F1"].xyz + np.array([300.0, 0, 0]))
    document = opened(
        replace(
            site,
            horizons={**site.horizons, "F2": east},
            settings={**site.settings, "F2": FitSettings(frame="best-plane")},
            faults={"F1": ("T2",), "F2": ("T2",)},
        )
    )
    points = document.points("T2")
    between = np.flatnonzero((off(*points.xyz.T) < 0) & (off(*(points.xyz - (300.0, 0, 0)).T) > 0))
    for index in between:
        ExcludeRows("T2", (Row.of(points, int(index)),)).redo(document)
    found = part(document)
    assert len(found.blocks) == 2
    (note,) = (note for note in found.notes if "in no block" in str(note))
    assert str(note).count("holes.csv row") == len(between) > 10
    SplitAtFaults("T2", dict(found.blocks)).redo(document)
    assert rows(document) == rows_of(points) - {Row.of(points, int(index)) for index in between}


def test_parting_is_one_step_and_names_no_other_horizon():
    document = opened()
    blocks = dict(part(document).blocks)
    before = document.state
    command = SplitAtFaults("T2", blocks)
    command.redo(document)
    document.select("T2 (B)")
    command.undo(document)
    assert document.state == before
    assert document.selection.horizon == "T2"
    taken = {("F1" if name == "T2 (B)" else name): one for name, one in blocks.items()}
    with pytest.raises(DocumentError, match="called 'F1', and so is a horizon"):
        SplitAtFaults("T2", taken).redo(document)


def test_a_fault_beside_all_points_parts_nothing():
    site = faulted_site()
    far = site.horizons["F1"].with_(xyz=site.horizons["F1"].xyz + np.array([1000.0, 0, 0]))
    document = opened(replace(site, horizons={**site.horizons, "F1": far}))
    found = part(document)
    assert not found.blocks
    assert any("lie on one side of F1" in str(note) for note in found.notes)


def test_a_block_hears_of_the_dips_measured_on_its_side():
    site = faulted_site()
    place = site.horizons["T2"].xyz[:1]
    dips = Orientations(place, np.zeros(1), np.array([80.0]), np.array(["T2"]), np.array(["d.csv"]), np.array([2]))
    document = opened(replace(site, orientations=dips))
    SplitAtFaults("T2", dict(part(document).blocks)).redo(document)
    fit(document, BLOCKS)
    asked = {name: [c for c in document.surface(name).accuracy.checks if c.name == "dips"] for name in BLOCKS}
    mine = next(name for name in BLOCKS if (document.points(name).xyz == place).all(axis=1).any())
    assert [check.passed for check in asked.pop(mine)] == [False]
    assert list(asked.values()) == [[]]


def test_only_blocks_on_one_side_lie_above_each_other(parted):
    parts = parted.state.parts
    upper = {f"T1 ({letter})": replace(parts[f"T2 ({letter})"], horizon="T1") for letter in "AB"}
    pairs = comparable(("W", *upper, *BLOCKS), {**parts, **upper})
    assert pairs == (
        ("W", "T1 (A)"), ("W", "T1 (B)"), ("W", "T2 (A)"), ("W", "T2 (B)"), ("T1 (A)", "T2 (A)"), ("T1 (B)", "T2 (B)"),
    )  # fmt: skip


def test_a_project_brings_the_blocks_back(parted, tmp_path):
    surfaces = {parted.state.provenances[name]: parted.surface(name).with_(model=None) for name in parted.horizons}
    path = tmp_path / "dam.geofit"
    site_file = tmp_path / "site.toml"
    write_project(project_of(parted.state, faulted_site(), site_file, path, None), path, surfaces)
    project = open_project(path)
    state = state_of(project, faulted_site())
    assert state == replace(parted.state, name=state.name)
    document = opened()
    document.open(faulted_site(), site_file, state, path)
    read = read_saved_surfaces(project, tmp_path, document.site, progress=quiet)
    assert set(read) == set(surfaces)
    for provenance, surface in read.items():
        document.put(provenance, surface)
        assert surface.accuracy.sigma == pytest.approx(surfaces[provenance].accuracy.sigma, abs=1e-6)
    assert not any(document.stale(name) for name in document.horizons)


def test_fit_all_parts_fits_and_measures(app, caplog):
    caplog.set_level(logging.INFO)
    app.desktop.session.begin(faulted_site(), None)
    app.window.fitting.fit_all()
    app.idle()
    document, stack = app.document, app.window.session.stack
    assert list(document.surfaces()) == [*BLOCKS, "F1"]
    assert all(surface.accuracy.passed for surface in document.surfaces().values())
    assert any("F1 throws T2 down by" in record.getMessage() for record in caplog.records)
    steps = [stack.text(k) for k in range(stack.count())]
    assert steps == ["Fit F1", "Split T2 at F1", "Fit T2 (A)", "Fit T2 (B)"]
    # By hand a block is changed as any horizon is.
    document.select("T2 (B)")
    before = document.surface("T2 (B)")
    app.window.fitting.move_to("T2 (B)", Row.of(before.points, before.accuracy.worst[0]), 1.0)
    app.idle()
    after = document.surface("T2 (B)")
    assert after is not before
    np.testing.assert_array_equal(after.outline, before.outline)
    for _ in range(4):
        stack.undo()
    app.idle()
    assert list(document.horizons) == ["T2", "F1"]
    assert document.selection.horizon == "T2"
    for _ in range(4):
        stack.redo()
    app.idle()
    assert document.surface("T2 (B)") is after
    # Another fault plane: the blocks are parted anew.
    document.select("T2 (A)")
    app.window.fitting.set_settings("F1", FitSettings(frame="best-plane", epsilon=0.2))
    app.window.fitting.fit("T2 (A)")
    app.idle()
    assert not any(document.stale(name) for name in document.horizons)


def colours_shown(app):
    """Return the colour of each horizon in the scene, the section and the plan."""
    panels, document = app.window.panels, app.document
    layers = {layer.horizon: layer.colour for layer in panels.view.layers if layer.kind == "points"}
    site = document.site_in_use()
    section = SectionData(site, Curtain.along(BOUNDARY[:2]), 50.0)
    shown = {}
    for name in document.horizons:
        document.select(name)
        app.idle()
        shown[name] = {layers[name], section.colour(name), panels.plan.view.data.colour}
    assert all(len(colours) == 1 for colours in shown.values())
    return {name: colours.pop() for name, colours in shown.items()}


def test_blocks_have_the_colour_of_their_horizon_and_the_others_keep_theirs(app, parted):
    app.desktop.session.begin(faulted_site(), None)
    app.idle()
    before = colours_shown(app)
    app.window.fitting.push(SplitAtFaults("T2", dict(parted.state.parts)))
    app.idle()
    assert colours_shown(app) == {**dict.fromkeys(BLOCKS, before["T2"]), "F1": before["F1"]}
    app.window.session.stack.undo()
    app.idle()
    assert colours_shown(app) == before


def test_the_report_of_the_window_tells_the_throw(parted, tmp_path):
    site = parted.site_in_use()
    results = [HorizonResult(surface, site) for surface in parted.surfaces().values()]
    made = write_report_files(results, parted.blocks(), tmp_path, "en", ("json",), False, "2026-01-01", progress=quiet)
    report = json.loads(made.files["json"].read_text(encoding="utf-8"))
    (cut,) = report["cuts"]
    assert cut["horizon"] == "T2"
    assert cut["throw_mean"] == pytest.approx(6.0, abs=0.3)
