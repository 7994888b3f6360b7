"""A survey of passages in the windows: opened and dropped, its tables, scene, strata, files, report, and undo."""

from __future__ import annotations

import json
import threading

import numpy as np
import pytest
from faulted import ORIGIN, faulted_site, truth
from PySide6.QtCore import QMimeData, QPointF, Qt, QUrl
from PySide6.QtGui import QDropEvent

from geofit.data.errors import Cancelled
from geofit.gui.dialogs.survey import SurveyDialog
from geofit.gui.lengths import show_lengths_in
from geofit.gui.translate import speak
from geofit.project.cave_run import measure_passages, read_survey
from geofit.project.cave_view import shot_states, view_files, wall_distance_counts, wall_rings, write_view

#: Two squares, the first with a blunder of 4 m; the walls of d are missing.
LOOPS = (
    "*begin loop\n*fix a 0 0 100\n*data normal from to tape compass clino\n"
    "a b 10 90 0\nb c 10 0 0\nc d 10 270 0\nd a 14 180 0\n"
    "b e 10 90 0\ne f 10 0 0\nf c 10 270 0\n"
    "*data passage station left right up down\na 1 1 1 1\nb 1 1 1 1\nc 1 1 1 1\ne 1 1 1 1\nf 1 1 1 1\n*end loop\n"
)
#: One shot without walls.
LINE = "*fix a 0 0 0\n*data normal from to tape compass clino\na b 10 90 0\n"
#: Three of its four shots cannot be used.
REJECTED = (
    "*fix a 0 0 0\n*data normal from to tape compass clino\na b 10 400 0\nb c 10 90 120\nc d ten 90 0\n"
    "d e 20000 90 0\n*data passage station left right up down\na 1 1 1 1\nb 1 1 1 1\n"
)
TUBE = "x,y,z,radius\n500900,3100900,100,2\n500920,3100900,100,2\n"


class Level:
    """A horizon at one elevation."""

    def __init__(self, height):
        self.height = height

    def elevation(self, x, y):
        return np.full(np.broadcast(x, y).shape, float(self.height))


@pytest.fixture
def loops(tmp_path):
    path = tmp_path / "loop.svx"
    path.write_text(LOOPS)
    return path


@pytest.fixture
def tube(tmp_path):
    path = tmp_path / "tube.csv"
    path.write_text(TUBE)
    return path


@pytest.fixture
def horizons():
    return {}


@pytest.fixture
def dialog(qtbot, horizons):
    dialog = SurveyDialog(lambda: horizons, lambda: False)
    qtbot.addWidget(dialog)
    dialog.show()
    qtbot.waitExposed(dialog)
    yield dialog
    dialog.close()


def rests(qtbot, dialog):
    qtbot.waitUntil(lambda: not dialog.running and dialog.run is not None, timeout=120_000)


def opened(qtbot, dialog, path):
    dialog.read(path)
    rests(qtbot, dialog)


def read(qtbot, dialog, path):
    """Open a file, whether or not it has a body."""
    dialog.say("")
    dialog.read(path)
    qtbot.waitUntil(lambda: not dialog.running and dialog.message.text() != "", timeout=60_000)


def make(qtbot, dialog, distance):
    """Give a wall distance, and make the body."""
    dialog.radius.setValue(distance)
    qtbot.mouseClick(dialog.go, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: not dialog.running, timeout=120_000)
    assert dialog.run is not None


def listed_title(dialog):
    return dialog.tabs.tabText(dialog.tabs.indexOf(dialog.tables["rows"]))


def rows(table):
    model = table.model()
    return [
        [model.index(row, column).data() for column in range(model.columnCount())] for row in range(model.rowCount())
    ]


def drop(window, file):
    data = QMimeData()
    data.setUrls([QUrl.fromLocalFile(str(file))])
    window.dropEvent(
        QDropEvent(
            QPointF(5, 5), Qt.DropAction.CopyAction, data, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
        )
    )


def test_tables_and_scene_show_what_the_library_finds(qtbot, dialog, loops, here):
    opened(qtbot, dialog, loops)
    truth = measure_passages(read_survey(loops))
    figures = dict(rows(dialog.tables["figures"]))
    assert figures["stations, shots"] == "6, 7"
    assert figures["loops, to be checked"].startswith(f"{len(truth.adjusted.loops)}, ")
    causes = [figures[f"part of it from {name}"] for name in ("measured walls", "missing walls", "shot lengths")]
    shares = [float(cause.split("(")[1].rstrip(" %)")) for cause in causes]
    assert sum(shares) == pytest.approx(100, abs=1.5)
    assert shares[0] == pytest.approx(100 * (truth.volume.walls / truth.volume.sigma) ** 2, abs=0.5)
    table = rows(dialog.tables["loops"])
    assert [float(row[2]) for row in table] == [round(loop.distance, 2) for loop in truth.adjusted.loops]
    assert table[0][-1] == "to be checked"
    shown = {name for name, table in dialog.tables.items() if dialog.tabs.isTabVisible(dialog.tabs.indexOf(table))}
    assert shown == {name for name, table in dialog.tables.items() if rows(table)}
    assert {"figures", "loops"} <= shown <= {"figures", "loops", "walls", "rows"}, "no horizons, no strata"
    assert "expected misclosure" in dialog.message.text()
    missing = rows(dialog.tables["walls"])
    assert {row[0] for row in missing} == {wall.station for wall in truth.body.sections.filled}
    assert len(missing) == 4
    assert dialog.scene.shown == ("line", "stations", "walls", "body")
    dialog.shows["body"].setChecked(False)
    dialog.shows["walls"].setChecked(False)
    assert dialog.scene.shown == ("line", "stations")


@pytest.fixture
def feet():
    show_lengths_in("ft")
    yield
    show_lengths_in("m")


def test_the_window_in_feet(qtbot, feet, dialog, tmp_path, here):
    path = tmp_path / "line.svx"
    path.write_text("*begin line\n*fix a 0 0 100\n*data normal from to tape compass clino\na b 20 90 0\n*end line\n")
    read(qtbot, dialog, path)
    assert dialog.radius.suffix() == " ft"
    make(qtbot, dialog, 3.28)
    walls = np.array([wall.distance for wall in dialog.run.body.sections.filled])
    np.testing.assert_allclose(walls, 3.28 * 0.3048)
    figures = dict(rows(dialog.tables["figures"]))
    assert figures["surveyed length, ft"] == "65.6"
    assert float(figures["spacing of the triangles, ft"]) == pytest.approx(dialog.run.spacing / 0.3048, rel=1e-2)
    distances = [float(row[2]) for row in rows(dialog.tables["walls"])]
    assert distances == [3.28] * len(walls)


def test_a_chosen_loop_is_drawn_along_its_stations(qtbot, dialog, loops, here):
    opened(qtbot, dialog, loops)
    dialog.tables["loops"].selectRow(0)
    adjusted = dialog.adjusted
    place = [adjusted.survey.stations.index(name) for name in adjusted.loops[0].stations]
    drawn = np.asarray(dialog.scene.actors["chosen"].mapper.dataset.points) + dialog.scene.origin
    np.testing.assert_allclose(drawn, adjusted.xyz[place], atol=1e-4)


def test_shots_know_their_loops(loops):
    run = measure_passages(read_survey(loops))
    suspicious = [loop.suspicious for loop in run.adjusted.loops]
    assert any(suspicious)
    states = shot_states(run.adjusted)
    assert states.min() >= 1
    worst = next(loop for loop in run.adjusted.loops if loop.suspicious)
    survey = run.adjusted.survey
    for k in np.flatnonzero(states == 1):
        assert not {survey.stations[survey.start[k]], survey.stations[survey.end[k]]} <= set(worst.stations)


def test_rings_lie_at_the_walls(tube, loops):
    rings = wall_rings(measure_passages(read_survey(tube)).body)
    middle = rings.corners.mean(axis=1)
    np.testing.assert_allclose(np.linalg.norm(rings.corners - middle[:, None], axis=2), 2.0, atol=1e-6)
    assert rings.measured.all()
    body = measure_passages(read_survey(loops)).body
    # Two shots meet in d, whose walls are missing: two rings of the fourteen.
    assert (~wall_rings(body).measured).sum() == 2
    assert len(wall_rings(body).corners) == 14


def test_the_scene_stays_near_its_origin_in_map_coordinates(qtbot, dialog, tube, here):
    opened(qtbot, dialog, tube)
    points = np.asarray(dialog.scene.actors["stations"].mapper.dataset.points)
    assert np.abs(points).max() < 20
    np.testing.assert_allclose(points + dialog.scene.origin, dialog.adjusted.xyz, atol=1e-4)


@pytest.mark.parametrize("horizons", [{"T2": Level(101), "T1": Level(100)}])
def test_horizons_cut_the_passages_and_the_parts_add_up(qtbot, dialog, tube, here):
    opened(qtbot, dialog, tube)
    assert rows(dialog.tables["strata"]) == []
    dialog.cut.setChecked(True)
    qtbot.waitUntil(lambda: not dialog.running and bool(dialog.run.strata), timeout=60_000)
    table = rows(dialog.tables["strata"])
    assert [row[0] for row in table] == ["above T2", "T2 to T1", "below T1"]
    volumes = [float(row[2]) for row in table]
    assert sum(volumes) == pytest.approx(dialog.run.volume.volume, rel=0.02)
    assert volumes[2] == pytest.approx(dialog.run.volume.volume / 2, rel=0.02)
    dialog.cut.setChecked(False)
    qtbot.waitUntil(lambda: not dialog.running, timeout=60_000)
    assert rows(dialog.tables["strata"]) == []


def test_without_a_site_nothing_can_be_cut_or_added(qtbot, dialog, tube, here):
    assert not dialog.go.isEnabled()
    opened(qtbot, dialog, tube)
    assert not dialog.cut.isEnabled()
    assert not dialog.add.isEnabled()
    assert dialog.export.isEnabled()
    assert dialog.report.isEnabled()


def test_files_and_report_are_those_of_the_command(qtbot, dialog, tube, tmp_path, here):
    opened(qtbot, dialog, tube)
    out = tmp_path / "out"
    with qtbot.waitSignal(dialog.written, timeout=60_000) as written:
        dialog.write(out)
    names = {file.name for file in written.args[0]}
    assert {"tube.json", "tube.stl", "tube.vtp", "tube_stations.csv", "tube_loops.csv"} <= names
    assert all(file.is_file() for file in written.args[0])
    figures = json.loads((out / "tube.json").read_text())
    assert figures["volume"]["volume"] == pytest.approx(dialog.run.volume.volume)
    qtbot.waitUntil(lambda: not dialog.running, timeout=60_000)
    with qtbot.waitSignal(dialog.written, timeout=120_000) as written:
        dialog.write(out, report=True)
    assert [file.suffix for file in written.args[0]] == [".html", ".pdf"]
    qtbot.waitUntil(lambda: not dialog.running, timeout=60_000)


def test_a_survey_without_walls_gets_its_body_once_a_distance_is_given(qtbot, dialog, tmp_path, here):
    path = tmp_path / "line.svx"
    path.write_text(LINE)
    read(qtbot, dialog, path)
    assert "wall distance" in dialog.message.text()
    assert dialog.run is None
    assert dialog.scene.shown == ("line", "stations")
    dialog.radius.setValue(1.0)
    qtbot.mouseClick(dialog.go, Qt.MouseButton.LeftButton)
    rests(qtbot, dialog)
    assert dialog.run.volume.volume == pytest.approx(np.pi * (10 + 4 / 3), rel=0.03)


def test_unconnected_stations_are_an_error_in_words(qtbot, dialog, tmp_path):
    path = tmp_path / "two.svx"
    path.write_text("*fix a 0 0 0\n*data normal from to tape compass clino\na b 10 90 0\nc d 10 90 0\n")
    dialog.read(path)
    qtbot.waitUntil(lambda: not dialog.running and bool(dialog.message.text()), timeout=60_000)
    assert "c" in dialog.message.text()
    assert dialog.adjusted is None
    assert not dialog.go.isEnabled()


def test_stop_leaves_the_centre_line(qtbot, dialog, tube, monkeypatch, here):
    gate = threading.Event()

    def slow(*_, progress):
        gate.wait(20)
        if progress("volume", 0.5) is False:
            raise Cancelled("stopped")

    monkeypatch.setattr("geofit.gui.dialogs.survey.measured_view", slow)
    dialog.read(tube)
    qtbot.waitUntil(dialog.stop.isVisible, timeout=20_000)
    qtbot.waitUntil(lambda: dialog.adjusted is not None, timeout=20_000)
    qtbot.mouseClick(dialog.stop, Qt.MouseButton.LeftButton)
    gate.set()
    qtbot.waitUntil(lambda: not dialog.running, timeout=20_000)
    assert dialog.run is None
    assert dialog.scene.shown == ("line", "stations")
    assert dialog.message.text() == "Stopped. No body was made."


@pytest.mark.parametrize("stage", ["adjust", "volume", "triangles", "strata"])
def test_every_stage_can_be_stopped(tube, stage):
    seen = []

    def listen(name, fraction):
        seen.append(fraction)
        return name != stage

    with pytest.raises(Cancelled):
        measure_passages(read_survey(tube), horizons={"T1": Level(100)}, progress=listen)
    assert seen == sorted(seen)


@pytest.fixture
def line(tmp_path):
    path = tmp_path / "line.svx"
    path.write_text(LINE)
    return path


@pytest.fixture
def answers(monkeypatch):
    """Refuse every question; return their texts."""
    from PySide6.QtWidgets import QMessageBox

    asked = []
    monkeypatch.setattr(QMessageBox, "exec", lambda box: asked.append(box.text()) or QMessageBox.StandardButton.No)
    return asked


@pytest.mark.parametrize("report", [False, True])
def test_files_of_others_are_not_replaced_unasked(qtbot, dialog, tube, tmp_path, here, answers, report):
    opened(qtbot, dialog, tube)
    theirs = tmp_path / ("tube_report.pdf" if report else "tube.json")
    theirs.write_text("mine")
    dialog.write(tmp_path, report=report)
    qtbot.waitUntil(lambda: not dialog.running, timeout=60_000)
    (question,) = answers
    assert theirs.name in question
    assert theirs.read_text() == "mine"


@pytest.mark.parametrize("report", [False, True])
def test_the_files_that_are_asked_about_are_those_that_are_written(loops, tmp_path, report):
    run = measure_passages(read_survey(loops), horizons={"T1": Level(100)})
    assert set(view_files(run, tmp_path, report)) == set(write_view(run, tmp_path, report).files)


def test_a_body_with_another_wall_distance_is_out_of_date(qtbot, dialog, line, here):
    read(qtbot, dialog, line)
    make(qtbot, dialog, 1.0)
    assert dialog.export.isEnabled()
    dialog.radius.setValue(3.0)
    assert not dialog.export.isEnabled()
    assert not dialog.report.isEnabled()
    assert "wall distance has changed" in dialog.message.text()
    dialog.radius.setValue(1.0)
    assert dialog.export.isEnabled(), "the field has again what the body is made with"
    assert "wall distance has changed" not in dialog.message.text()
    make(qtbot, dialog, 3.0)
    assert dialog.report.isEnabled()
    assert "wall distance has changed" not in dialog.message.text()


def test_the_wall_distance_is_of_one_file(qtbot, dialog, line, tmp_path, here):
    assert not dialog.radius.isEnabled(), "nothing is open"
    read(qtbot, dialog, line)
    assert dialog.radius.isEnabled()
    make(qtbot, dialog, 3.0)
    other = tmp_path / "other.svx"
    other.write_text(LINE)
    read(qtbot, dialog, other)
    assert dialog.radius.value() == 0
    assert dialog.run is None
    assert "wall distance" in dialog.message.text()


def test_a_survey_with_walls_takes_no_distance(qtbot, dialog, line, tube, here):
    read(qtbot, dialog, line)
    ready = dialog.radius.toolTip()
    opened(qtbot, dialog, tube)
    assert not dialog.radius.isEnabled()
    assert dialog.radius.toolTip() != ready
    read(qtbot, dialog, line)
    assert dialog.radius.isEnabled()
    assert dialog.radius.toolTip() == ready


@pytest.mark.parametrize(
    ("walls", "counts"),
    [
        ("", True),
        ("a 1 1 - -\n", True),
        ("a 1 1 0 0\n", True),
        ("a 0 0 - -\nb - - 1 1\n", True),
        ("a 1 - 0 1\n", False),
    ],
)
def test_the_wall_distance_counts_where_sides_or_heights_lack(line, walls, counts):
    line.write_text(LINE + "*data passage station left right up down\n" + walls)
    survey = read_survey(line)
    assert wall_distance_counts(survey) == counts
    if walls:
        near, far = (measure_passages(survey, radius=radius).volume.volume for radius in (0.5, 3.0))
        assert (near != far) == counts


def test_rows_that_are_not_used_are_a_warning(qtbot, dialog, tmp_path, here):
    path = tmp_path / "rejected.svx"
    path.write_text(REJECTED)
    opened(qtbot, dialog, path)
    assert "3 rows were not used" in dialog.message.text()
    assert listed_title(dialog) == "Listed rows (4)"
    dialog.write(tmp_path / "out")
    qtbot.waitUntil(lambda: not dialog.running, timeout=60_000)
    assert "Wrote" in dialog.message.text()
    assert "3 rows were not used" in dialog.message.text()


def test_a_refused_file_shows_its_own_rows(qtbot, dialog, tmp_path, tube, here):
    path = tmp_path / "rejected.svx"
    path.write_text(REJECTED)
    opened(qtbot, dialog, path)
    bad = tmp_path / "one & two.csv"
    bad.write_text("x,y,z,radius\n0,0,0,2\nten,0,0,2\n")
    read(qtbot, dialog, bad)
    assert "See the listed rows" in dialog.message.text()
    assert dialog.tabs.currentWidget() is dialog.tables["rows"]
    assert listed_title(dialog) == f"Listed rows of one && two.csv ({len(rows(dialog.tables['rows']))})"
    assert "ten" in {row[2] for row in rows(dialog.tables["rows"])}
    assert "rejected.svx" in dialog.windowTitle()
    read(qtbot, dialog, tmp_path / "missing.svx")
    assert listed_title(dialog) == "Listed rows (4)", "those of the survey that is shown"


def test_rows_that_disconnect_a_survey_are_shown(qtbot, dialog, tmp_path):
    path = tmp_path / "two.svx"
    path.write_text("*fix a 0 0 0\n*data normal from to tape compass clino\na b 10 90 0\nb c ten 90 0\nc d 10 90 0\n")
    read(qtbot, dialog, path)
    assert dialog.adjusted is None
    assert [row[:2] for row in rows(dialog.tables["rows"])] == [["4", "not used"]]


def test_findings_about_the_whole_file_have_no_row(qtbot, dialog, tube, here):
    opened(qtbot, dialog, tube)
    assert {row[0] for row in rows(dialog.tables["rows"])} <= {""}


@pytest.fixture
def chinese():
    speak("zh_CN")
    yield
    speak("en")


def test_listed_rows_in_chinese_are_chinese_sentences(qtbot, chinese, dialog, tmp_path, here):
    path = tmp_path / "rejected.svx"
    path.write_text(REJECTED)
    opened(qtbot, dialog, path)
    texts = [row[-1] for row in rows(dialog.tables["rows"])]
    assert len(texts) == 4
    for text in texts:
        assert "compass 不" not in text.casefold()
        assert "The " not in text
        assert ". " not in text
        assert text.endswith("。")


def test_the_table_of_loops_fits(qtbot, dialog, loops, here):
    opened(qtbot, dialog, loops)
    table = dialog.tables["loops"]
    dialog.tabs.setCurrentWidget(table)
    qtbot.waitUntil(table.isVisible)
    assert table.horizontalHeader().length() <= table.viewport().width()
    header = table.horizontalHeader()
    assert header.sectionSize(0) >= 100, "the names of a loop may be cut off, but not to nothing"
    for column in range(1, header.count()):
        assert max(table.sizeHintForColumn(column), header.sectionSizeHint(column)) <= header.sectionSize(column)


def test_each_body_has_a_file_of_its_own(app, sample, line, here, answers):
    app.window.files.open(sample / "site.toml")
    app.idle()
    before = set(app.document.state.bodies)
    theirs = app.document.folder / "line_passages.ply"
    theirs.write_text("mine")
    app.window.surveys.open(line)
    dialog = app.window.surveys.dialog
    app.qtbot.waitUntil(lambda: not dialog.running and dialog.message.text() != "", timeout=60_000)
    volumes = []
    for distance in (1.0, 3.0):
        make(app.qtbot, dialog, distance)
        volumes.append(dialog.run.triangles.volume)
        count = len(app.document.state.bodies)
        app.qtbot.mouseClick(dialog.add, Qt.MouseButton.LeftButton)
        app.qtbot.waitUntil(lambda count=count: len(app.document.state.bodies) == count + 1, timeout=120_000)
        app.idle()
    records = {name: record for name, record in app.document.state.bodies.items() if name not in before}
    assert {record.provenance.source.file for record in records.values()} == {
        "line_passages_2.ply", "line_passages_3.ply"
    }  # fmt: skip
    assert [app.document.body(name).mesh.volume for name in records] == pytest.approx(volumes, rel=1e-6)
    assert theirs.read_text() == "mine"
    assert answers == []
    dialog.close()


def test_a_dropped_survey_is_added_to_the_site_and_can_be_undone(app, sample, tube, here):
    app.window.files.open(sample / "site.toml")
    app.idle()
    before = dict(app.document.state.bodies)
    drop(app.window, tube)
    dialog = app.window.surveys.dialog
    rests(app.qtbot, dialog)
    assert app.document.is_open
    app.qtbot.mouseClick(dialog.add, Qt.MouseButton.LeftButton)
    app.qtbot.waitUntil(lambda: len(app.document.state.bodies) == len(before) + 1, timeout=120_000)
    app.idle()
    (name,) = set(app.document.state.bodies) - set(before)
    mesh = app.document.body(name).mesh
    assert mesh.volume == pytest.approx(dialog.run.triangles.volume, rel=1e-6)
    assert name in app.window.panels.view.bodies.names
    app.window.menus.undo.trigger()
    app.idle()
    assert dict(app.document.state.bodies) == before
    dialog.close()
    assert app.window.surveys.dialog is None


def test_passages_are_cut_by_the_strata_whose_blocks_are_one_and_not_by_a_steep_fault(app, tmp_path, here):
    app.desktop.session.begin(faulted_site(), None)
    app.window.fitting.fit_all()
    app.idle()
    assert app.document.horizons == ("T2 (A)", "T2 (B)", "F1")
    # A shaft through each block, joined by a drive far below the horizon, which crosses the fault.
    path, (x, y) = tmp_path / "shafts.csv", (float(ORIGIN[0]) + 300.0, float(ORIGIN[1]) + 500.0)
    places = [(x, y, 1600.0), (x, y, 1300.0), (x + 600.0, y, 1300.0), (x + 600.0, y, 1600.0)]
    path.write_text("x,y,z,radius\n" + "".join(f"{a},{b},{c},2\n" for a, b, c in places))
    app.window.surveys.open(path)
    dialog = app.window.surveys.dialog
    rests(app.qtbot, dialog)
    dialog.cut.click()
    app.qtbot.waitUntil(lambda: not dialog.running and dialog.run.strata != (), timeout=60_000)
    above, below, unknown = dialog.run.strata
    assert (above.base, below.top) == ("T2", "T2")
    heights = [truth(np.array([a]), np.array([y]))[0] for a in (x, x + 600.0)]
    assert above.length == pytest.approx(3200.0 - sum(heights), abs=1.0)
    assert unknown.length < 20.0, "where the fault has pulled the blocks apart"
    assert below.length + unknown.length == pytest.approx(sum(heights) - 2600.0 + 600.0, abs=1.0)
    dialog.close()


def test_the_file_menu_opens_a_survey_without_closing_anything(app, loops, here, monkeypatch):
    from PySide6.QtWidgets import QFileDialog

    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(loops), ""))
    app.trigger("open")
    dialog = app.window.surveys.dialog
    rests(app.qtbot, dialog)
    assert "loop.svx" in dialog.windowTitle()
    assert not app.document.is_open
    app.window.surveys.close()
    assert app.window.surveys.dialog is None
    app.trigger("survey")
    assert app.window.surveys.dialog.adjusted is None
    app.window.surveys.close()
