"""The document without Qt: commands change it and take their change back; results go stale; the shelf has bounds."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geofit.bodies.settings import BodySettings
from geofit.data.errors import GeofitError
from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.data.site import Ground, Orientations, Site
from geofit.project import shelf as shelf_module
from geofit.project.body_commands import DeleteBody, RenameBody, SetBody, StyleBody
from geofit.project.body_record import (
    BetweenHorizons,
    BodyProvenance,
    BodyRecord,
    BodyStyle,
    ClosedMesh,
    Intervals,
    MorphFrame,
    Outlines,
    SurfacePicks,
)
from geofit.project.building import make
from geofit.project.commands import (
    COMMANDS,
    AdjustControlPoint,
    ChangeData,
    ChangeWeight,
    ExcludeRows,
    IncludeRows,
    MergeHorizons,
    MoveToPoint,
    RemoveHorizons,
    RenameHorizon,
    RenameSite,
    SeparateHorizons,
    SetArea,
    SetCore,
    SetOrder,
    SetSettings,
    SetSurface,
    SplitAtFaults,
    command_from,
)
from geofit.project.document import Document
from geofit.project.fit_command import TakeFit
from geofit.project.provenance import (
    DocumentError,
    Earlier,
    Move,
    MoveToPointEdit,
    Part,
    Provenance,
    Row,
    SeparationEdit,
    Weigh,
    fingerprint,
    indices,
    runs,
)
from geofit.project.shelf import Shelf
from geofit.project.signal import Signal
from geofit.project.state import State


def site():
    x, y = np.meshgrid(np.linspace(0, 90, 6), np.linspace(0, 90, 6))
    flat = np.column_stack([x.ravel(), y.ravel(), 0.05 * x.ravel()])
    rows = np.arange(2, 38)
    upper = PointSet(flat + np.array([0, 0, 20]), file="a.csv", row=rows)
    # Two points of one row, as an interval that is met twice gives them.
    lower = PointSet(flat, file="a.csv", row=np.where(rows == 5, 4, rows))
    return Site("Dam", {"up": upper, "low": lower}, {"low": FitSettings(epsilon=0.2)})


def document():
    opened = Document()
    opened.open(site(), None)
    return opened


numbers = st.floats(-1e6, 1e6)
rows = st.builds(Row, st.text(max_size=5), st.integers(0, 99), st.integers(0, 3))
polygon = st.lists(st.tuples(numbers, numbers), min_size=3, max_size=5).map(tuple)
cores = st.sampled_from(["auto", "all", "none"]) | polygon
settings_ = st.builds(FitSettings, epsilon=st.floats(1e-6, 1e3), core=cores)
edits = (
    st.builds(Move, st.text(max_size=4), st.integers(), st.integers(), numbers)
    | st.builds(MoveToPointEdit, st.integers(), numbers)
    | st.builds(Weigh, st.text(max_size=4), st.integers(), st.integers(), numbers)
)
stacked = st.builds(
    SeparationEdit,
    st.just(("up", "low")),
    numbers,
    st.just((Provenance("up", FitSettings(), "x", (), (MoveToPointEdit(1, 0.5),)),)),
)
provenances = st.builds(
    Provenance,
    st.just("low"),
    settings_,
    st.text(max_size=4),
    st.lists(rows).map(tuple),
    st.lists(edits | stacked).map(tuple),
)
block = st.builds(
    Part,
    st.just("low"),
    st.text(max_size=4),
    st.lists(st.builds(Provenance, st.just("up"), settings_, st.text(max_size=4)), max_size=2).map(tuple),
    st.lists(st.integers(-1, 1), max_size=2).map(tuple),
    st.lists(st.integers(0, 40), unique=True).map(lambda numbers: runs(np.sort(np.array(numbers, int)))),
    polygon,
)
names = st.sampled_from(["ORE", "VOID", "矿体"])
styles = st.builds(BodyStyle, st.sampled_from(["#112233", "#445566"]), st.floats(0, 1), st.booleans())
body_settings = st.builds(
    BodySettings,
    epsilon=st.floats(0.01, 10),
    ranges=st.tuples(*[st.floats(0.1, 10)] * 3),
    box=st.none() | st.just(((0.0, 0.0, -10.0), (5.0, 6.0, 7.0))),
    step=st.none() | st.floats(0.1, 5),
)
given_data = st.text("0123456789abcdef", min_size=16, max_size=16)
fitted_bodies = st.builds(
    BodyProvenance,
    st.builds(Intervals, st.lists(st.text(min_size=1), min_size=1).map(tuple), st.text(max_size=5))
    | st.builds(ClosedMesh, st.text(max_size=5))
    | st.builds(Outlines, st.text(max_size=5), st.lists(st.text(max_size=3)).map(tuple))
    | st.builds(SurfacePicks, st.text(max_size=5))
    | st.builds(BetweenHorizons, st.just("up"), st.just("low") | numbers),
    body_settings,
    given_data,
)
frames = st.builds(
    MorphFrame, st.tuples(fitted_bodies, fitted_bodies), st.just(("A", "B")), st.sampled_from(["arrival", "blend"]),
    st.just("progress"), st.sampled_from([(), ("2024-01-01", "2025-01-01")]), st.just(96), st.floats(0, 1),
)  # fmt: skip
records = st.builds(BodyRecord, fitted_bodies | st.builds(BodyProvenance, frames, body_settings, given_data), styles)
BODY = BodyRecord(BodyProvenance(Intervals(("ORE",)), BodySettings(), "0" * 16), BodyStyle("#112233"))
FRAME = replace(
    BODY,
    provenance=replace(
        BODY.provenance,
        source=MorphFrame((BODY.provenance, BODY.provenance), ("A", "B"), "arrival", "progress", (), 96, 0.5),
    ),
)
commands = st.one_of(
    st.builds(
        SplitAtFaults, st.just("low"), st.dictionaries(st.sampled_from(["low (A)", "low (B)"]), block, min_size=1)
    ),
    st.builds(SetSettings, st.just("low (A)"), settings_),
    st.builds(ExcludeRows, st.just("low (A)"), st.tuples(rows)),
    st.builds(SetSettings, st.just("low"), settings_),
    st.builds(SetCore, st.just("low"), cores),
    st.builds(ExcludeRows, st.just("low"), st.tuples(rows)),
    st.builds(IncludeRows, st.just("low"), st.tuples(rows)),
    st.builds(SetSurface, provenances),
    st.builds(AdjustControlPoint, st.just("low"), st.text(max_size=4), st.integers(), st.integers(), numbers),
    st.builds(ChangeWeight, st.just("low"), st.text(max_size=4), st.integers(), st.integers(), st.floats(0.01, 100)),
    st.builds(MoveToPoint, st.just("low"), st.integers(), numbers),
    st.builds(SeparateHorizons, st.just(("low",)), st.just(("up", "low")), st.floats(0, 10)),
    st.builds(SetOrder, st.permutations(["up", "low"]).map(tuple)),
    st.builds(RenameSite, st.text(min_size=1)),
    st.builds(SetArea, polygon | st.none()),
    st.builds(RenameHorizon, st.sampled_from(["low", "up", "new"]), st.sampled_from(["new", "low", " x"])),
    st.builds(RemoveHorizons, st.sampled_from([("low",), ("up",), ("new",), ("low", "up")])),
    st.builds(MergeHorizons, st.sampled_from([("up", "low"), ("low", "low"), ("new", "up")]), st.just("one")),
    st.builds(
        ChangeData,
        st.text(max_size=4),
        st.just(("a.csv",)),
        st.lists(st.text(max_size=9), max_size=2).map(tuple),
        st.just({"low": FitSettings(), "up": FitSettings(epsilon=0.1)}),
        st.just({}),
        st.dictionaries(st.sampled_from(["low", "up"]), st.tuples(rows)),
        st.dictionaries(st.just("low"), st.builds(Earlier, st.text(max_size=4), provenances)),
    ),
    st.builds(SetBody, names, records),
    st.builds(TakeFit, provenances),
    st.builds(RenameBody, names, names),
    st.builds(DeleteBody, names),
    st.builds(StyleBody, names, styles),
)


@settings(max_examples=200, deadline=None)
@given(command=commands)
def test_every_command_comes_back_from_its_data(command):
    again = command_from(json.loads(json.dumps(command.to_data())))
    assert again == command
    assert type(again) is type(command)
    assert str(command.text)


@settings(max_examples=100, deadline=None)
@given(done=st.lists(commands, max_size=12))
def test_undoing_everything_leads_back_and_states_come_back_from_their_data(done):
    opened = document()
    first, stack = opened.state, []
    for command in done:
        before = opened.state
        try:
            command.redo(opened)
        except DocumentError:
            assert opened.state is before
            continue
        stack.append((before, command))
        assert State.from_data(json.loads(json.dumps(opened.state.to_data()))) == opened.state
    for before, command in reversed(stack):
        command.undo(opened)
        assert opened.state == before
    assert opened.state == first
    assert not opened.dirty


def test_every_command_is_told_in_words_that_can_be_translated():
    from chinese import english_left

    provenance = document().provenance("low")
    samples = [
        SetSettings("low", FitSettings()), SetCore("low", "all"), ExcludeRows("low", (Row("a", 1),)),
        IncludeRows("low", (Row("a", 1),)), SetSurface(provenance), AdjustControlPoint("low", "core", 1, 2, 0.5),
        ChangeWeight("low", "core", 1, 2, 0.5), SeparateHorizons(("low",), ("up", "low"), 0.5),
        SplitAtFaults("low", {"low (A)": Part("low", "", (provenance,), (1,), "0-9", ())}),
        MoveToPoint("low", 3, 1.0), SetOrder(("up", "low")), RenameSite("x"),
        RenameHorizon("low", "deep"), RemoveHorizons(("low",)), MergeHorizons(("up", "low"), "both"),
        SetArea(None), SetArea(((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))),
        ChangeData("x", ("a.csv", "b.csv"), (), {"low": FitSettings()}, {}, {}, {}),
        SetBody("a", BODY), SetBody("a", FRAME), RenameBody("a", "b"), DeleteBody("a"), StyleBody("a", BODY.style),
        TakeFit(provenance),
    ]  # fmt: skip
    assert {type(command) for command in samples} == set(COMMANDS.values())
    assert not [left for command in samples for left in english_left(command.text)]


@given(numbers=st.lists(st.integers(0, 1000), unique=True))
def test_numbers_come_back_from_their_runs(numbers):
    ascending = np.sort(np.array(numbers, int))
    assert np.array_equal(indices(runs(ascending)), ascending)


def test_a_state_without_bodies_writes_no_word_of_them():
    assert "bodies" not in document().state.to_data()


def test_bodies_come_go_and_change_in_their_place():
    opened = document()
    heard = []
    opened.bodies_changed.connect(lambda: heard.append(tuple(opened.state.bodies)))
    SetBody("ORE", BODY).redo(opened)
    SetBody("VOID", BODY).redo(opened)
    rename = RenameBody("ORE", "矿体")
    rename.redo(opened)
    assert list(opened.state.bodies) == ["矿体", "VOID"]
    style = StyleBody("矿体", BodyStyle("#445566", 0.3, False))
    style.redo(opened)
    assert opened.state.bodies["矿体"].style.opacity == 0.3
    with pytest.raises(DocumentError, match="already"):
        RenameBody("矿体", "VOID").redo(opened)
    with pytest.raises(DocumentError, match=r"no body 'ORE'.*VOID"):
        DeleteBody("ORE").redo(opened)
    with pytest.raises(DocumentError, match="no name"):
        SetBody("  ", BODY).redo(opened)
    style.undo(opened)
    rename.undo(opened)
    assert list(opened.state.bodies) == ["ORE", "VOID"]
    assert heard == [("ORE",), ("ORE", "VOID"), ("矿体", "VOID"), ("矿体", "VOID"), ("矿体", "VOID"), ("ORE", "VOID")]


def test_data_without_horizons_are_for_sites_that_have_none():
    change = ChangeData("x", ("a.csv",), (), {}, {}, {}, {})
    assert change.on(State()).data == "x"
    with pytest.raises(DocumentError, match="no horizon"):
        change.on(document().state)


def test_a_row_names_one_point():
    points = site().horizons["low"]
    for index in range(len(points)):
        row = Row.of(points, index)
        assert row.find(points) == index
    assert Row("a.csv", 4, 1).find(points) == 3
    assert Row("a.csv", 4, 2).find(points) is None
    assert Row("b.csv", 4).find(points) is None


def test_the_order_that_a_site_states_is_that_of_its_horizons_and_follows_the_document():
    points = PointSet(np.eye(3))
    site = Site("dam", dict.fromkeys(("c", "W", "a", "b"), points), order=("a", "b", "c"))
    document = Document()
    document.open(site, None)
    assert document.horizons == ("a", "W", "b", "c")
    assert document.site_in_use().order == ("a", "b", "c")
    assert document.site_in_use() is document.site_in_use()
    SetOrder(("c", "W", "a", "b")).redo(document)
    assert document.site_in_use().order == ("c", "a", "b")
    assert list(document.site_in_use().horizons) == ["c", "W", "a", "b"]


def test_excluded_rows_take_no_part():
    opened = document()
    heard = []
    opened.points_changed.connect(heard.append)
    command = ExcludeRows("low", (Row("a.csv", 4, 1),))
    command.redo(opened)
    assert heard == ["low"]
    assert len(opened.points("low")) == 35
    assert opened.points("low") is opened.points("low")
    assert opened.site_in_use().horizons["low"] is opened.points("low")
    assert opened.site_in_use() is opened.site_in_use()
    with pytest.raises(DocumentError, match="already"):
        ExcludeRows("low", (Row("a.csv", 4, 1),)).redo(opened)
    with pytest.raises(DocumentError, match=r"no horizon 'mid'.*up, low"):
        ExcludeRows("mid", (Row("a.csv", 4, 1),)).redo(opened)
    IncludeRows("low", (Row("a.csv", 4, 1),)).redo(opened)
    assert len(opened.points("low")) == 36


def test_results_go_stale_and_come_back():
    opened = document()
    provenance = opened.provenance("low")
    surface = make(provenance, opened.given_for(provenance))
    opened.put(provenance, surface)
    assert opened.surface("low") is None
    fit = SetSurface(provenance)
    fit.redo(opened)
    assert opened.surface("low") is surface
    assert not opened.stale("low")
    assert opened.dirty
    other = SetSettings("low", FitSettings(interior_tolerance=0.2))
    other.redo(opened)
    assert opened.stale("low")
    other.undo(opened)
    assert not opened.stale("low")
    MoveToPoint("low", 3, 1.0).redo(opened)
    # Changed by hand: not stale, but not made yet.
    assert not opened.stale("low")
    assert opened.surface("low") is None
    (missing,) = opened.missing()
    assert missing.edits == (MoveToPointEdit(3, 1.0),)
    changed = replace(opened.site, horizons={"low": opened.site.horizons["low"][1:]})
    opened.open(changed, None, opened.state)
    assert opened.stale("low")
    assert opened.missing() == ()
    assert opened.lost() == ("low",)


def test_the_fingerprint_sees_whatever_a_fit_depends_on():
    empty, points = Site("", {}), site().horizons["low"]
    area = np.array([[0.0, 0], [1, 0], [1, 1]])
    changed = [
        points.with_(xyz=points.xyz + np.array([0, 0, 1e-9])), points.with_(accuracy=0.1), points.with_(section="S"),
        points.with_(kind="adit"), points.with_(hole="B1"), points[1:],
    ]  # fmt: skip
    ground = Ground(np.arange(2.0), np.arange(2.0), np.zeros((2, 2)))
    nothing, none = np.zeros(1), np.zeros(1, np.int64)
    dips = Orientations(np.zeros((1, 3)), nothing, nothing, np.array(["low"]), np.array(["d.csv"]), none)
    around = [replace(empty, boundary=area), replace(empty, ground=ground), replace(empty, orientations=dips)]
    prints = [fingerprint(points, one) for one in (empty, *around)] + [fingerprint(one, empty) for one in changed]
    assert len(set(prints)) == len(prints)
    assert fingerprint(site().horizons["low"], empty) == prints[0]


def test_the_shelf_stays_within_its_bounds(monkeypatch):
    monkeypatch.setattr(shelf_module, "SPARE", 3)
    opened = document()
    surface = make(opened.provenance("low"), opened.given_for(opened.provenance("low")))
    shelf = Shelf()
    made = [replace(opened.provenance("low"), given=str(k)) for k in range(8)]
    for provenance in made:
        shelf.put(provenance, surface, {made[0]})
    assert len(shelf) == 5  # on show, just made, and three more
    assert shelf.surface(made[0]) is surface
    assert shelf.surface(made[1]) is None
    monkeypatch.setattr(shelf_module, "SPARE_POINTS", 40)
    shelf.put(made[1], surface, {made[0]})
    assert len(shelf) == 3


def test_a_signal_calls_in_order_and_stops():
    heard = []
    signal: Signal[[int]] = Signal()
    first = signal.connect
    first(lambda n: heard.append(("a", n)))
    signal.connect(heard.append)
    signal.emit(1)
    signal.disconnect(heard.append)
    signal.emit(2)
    assert heard == [("a", 1), 1, ("a", 2)]
    with pytest.raises(ValueError, match="not in list"):
        signal.disconnect(print)


def test_errors_of_the_document_are_geofits():
    assert issubclass(DocumentError, GeofitError)
    with pytest.raises(DocumentError, match="not done yet"):
        RenameSite("a").undo(document())
    with pytest.raises(DocumentError, match="no surface to adjust"):
        AdjustControlPoint("low", "core", 0, 0, 1.0).redo(document())
    with pytest.raises(DocumentError, match="each horizon once"):
        SetOrder(("up", "up")).redo(document())
    with pytest.raises(DocumentError, match="empty"):
        RenameSite(" ").redo(document())
