"""A survey of passages in the windows: opened and dropped, its tables, scene, strata, files, report, and undo."""

from __future__ import annotations

import json
import threading

import numpy as np
import pytest
from PySide6.QtCore import QMimeData, QPointF, Qt, QUrl
from PySide6.QtGui import QDropEvent

from geofit.data.errors import Cancelled
from geofit.gui.dialogs.survey import SurveyDialog
from geofit.gui.lengths import show_lengths_in
from geofit.project.cave_run import measure_passages, read_survey
from geofit.project.cave_view import shot_states, wall_rings

#: Two squares, the first with a blunder of 4 m; the walls of d are missing.
LOOPS = (
    "*begin loop\n*fix a 0 0 100\n*data normal from to tape compass clino\n"
    "a b 10 90 0\nb c 10 0 0\nc d 10 270 0\nd a 14 180 0\n"
    "b e 10 90 0\ne f 10 0 0\nf c 10 270 0\n"
    "*data passage station left right up down\na 1 1 1 1\nb 1 1 1 1\nc 1 1 1 1\ne 1 1 1 1\nf 1 1 1 1\n*end loop\n"
)
TUBE = "x,y,z,radius\n3500000,500000,100,2\n3500020,500000,100,2\n"


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
def here(monkeypatch):
    """Run tasks in a thread: a process of its own takes seconds to start."""
    from geofit.gui.dialogs import task_dialog

    monkeypatch.setattr(task_dialog, "run_in_process", task_dialog.run)


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
    dialog.radius.setValue(3.28)
    assert dialog.radius.suffix() == " ft"
    opened(qtbot, dialog, path)
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
    path.write_text("*fix a 0 0 0\n*data normal from to tape compass clino\na b 10 90 0\n")
    dialog.read(path)
    qtbot.waitUntil(lambda: not dialog.running and "radius" in dialog.message.text().lower(), timeout=60_000)
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
    assert "Stopped" in dialog.message.text()


@pytest.mark.parametrize("stage", ["adjust", "volume", "triangles", "strata"])
def test_every_stage_can_be_stopped(tube, stage):
    seen = []

    def listen(name, fraction):
        seen.append(fraction)
        return name != stage

    with pytest.raises(Cancelled):
        measure_passages(read_survey(tube), horizons={"T1": Level(100)}, progress=listen)
    assert seen == sorted(seen)


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
