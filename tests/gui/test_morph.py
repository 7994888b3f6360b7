"""Metamorphosis in the window: bodies in order, what is not reached, slider, play, onion skin, take, export."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QFileDialog, QInputDialog, QMessageBox

from geofit.data.files import file_stems
from geofit.geometry.mesh import Mesh
from geofit.implicit import Sphere, Torus
from geofit.implicit.isosurface import isosurface
from geofit.implicit.lattice import Lattice
from geofit.io.export.triangles import write_ply
from geofit.project.body_record import MorphFrame
from geofit.project.morph_run import morph_files

CENTRE = np.array([500900.0, 3100900.0, 1450.0])


def write(path, *fields):
    """Write fields about the site's middle as one closed mesh."""
    vertices, triangles, start = [], [], 0
    for field in fields:
        low, high = field.bounds
        mesh = isosurface(field, Lattice.around(np.asarray(low) - 6, np.asarray(high) + 6, cells=40), capped=True)
        vertices.append(mesh.vertices)
        triangles.append(mesh.triangles + start)
        start += len(mesh.vertices)
    faces = np.concatenate(triangles)
    n = len(faces)
    uv = np.zeros((n, 3, 2))
    drawn = Mesh(np.concatenate(vertices), faces, np.zeros(n, np.int64), uv, CENTRE, (path.stem,))
    write_ply({path.stem: drawn}, path)
    return path


@pytest.fixture
def bodies(app, sample, tmp_path):
    app.window.files.open(sample / "site.toml")
    app.idle()
    write(tmp_path / "ball.ply", Sphere([0, 0, 0], 30.0))
    write(tmp_path / "ring.ply", Torus([0, 0, 0], [0, 0, 1], 40.0, 14.0))
    for name in ("ball", "ring"):
        app.window.bodies.take_mesh(tmp_path / f"{name}.ply")
        app.idle()
    app.panel, app.morphing = app.window.panels.morph, app.window.morphing
    app.window.panels.reveal("morph")
    return app


def check(app, *names):
    rows = app.panel.list
    for k in range(rows.count()):
        on = rows.item(k).data(Qt.ItemDataRole.UserRole) in names
        rows.item(k).setCheckState(Qt.CheckState.Checked if on else Qt.CheckState.Unchecked)


def join(app, *names):
    check(app, *names)
    app.qtbot.mouseClick(app.panel.run, Qt.MouseButton.LeftButton)
    app.idle()


def rested(app):
    app.qtbot.waitUntil(lambda: app.morphing.idle, timeout=60_000)


def test_a_ball_becomes_a_ring_under_the_slider(bodies, tmp_path, monkeypatch):
    panel, layers = bodies.panel, bodies.window.panels.view.layers
    assert not panel.run.isEnabled()
    assert not panel.timeline.isEnabled()
    assert "not a record of the process" in panel.note.text()
    assert panel.note.isVisible()
    join(bodies, "ball", "ring")
    view = bodies.morphing.view
    assert view.full is not None
    assert view.full.lattice.spacing < view.preview.lattice.spacing
    assert panel.timeline.events == tuple(event.tau for event in view.events)
    assert len(panel.timeline.events) == 1
    assert not panel.said.isVisible()
    # Onion skins: both ends, clear.
    assert [layer.horizon for layer in layers if layer.kind == "morph end"] == ["ball", "ring"]
    panel.skin.setChecked(False)
    assert not [layer for layer in layers if layer.kind == "morph end"]
    # Dragged, the preview is shown; let go, the full grid.
    timeline, plot = panel.timeline, panel.timeline.plot()
    at = QPoint(round(plot.left() + 0.5 * plot.width()), 12)
    QTest.mousePress(timeline, Qt.MouseButton.LeftButton, pos=at)
    assert timeline.tau == pytest.approx(0.5, abs=0.01)
    bodies.qtbot.waitUntil(lambda: "50 %" in panel.where.text(), timeout=20_000)
    assert "morph" in layers
    QTest.mouseRelease(timeline, Qt.MouseButton.LeftButton, pos=at)
    rested(bodies)
    volumes = [row.volume for row in view.rows]
    assert volumes[0] == pytest.approx(bodies.document.body("ball").mesh.volume)
    assert volumes[-1] == pytest.approx(bodies.document.body("ring").mesh.volume)
    # Keys and steps move it, the play ends at the last body.
    QTest.keyClick(timeline, Qt.Key.Key_Home)
    assert timeline.tau == 0.0
    bodies.qtbot.mouseClick(panel.forth, Qt.MouseButton.LeftButton)
    assert timeline.tau == pytest.approx(1 / 60)
    timeline.put(0.95)
    panel.play.setChecked(True)
    bodies.qtbot.waitUntil(lambda: not panel.play.isChecked(), timeout=20_000)
    assert timeline.tau == 1.0
    rested(bodies)
    assert "Euler number 0" in panel.where.text()
    # A frame is a body of the project like any other, made from what its ends are made from.
    timeline.put(0.25)
    monkeypatch.setattr(QInputDialog, "getText", lambda *_, **__: ("quarter", True))
    bodies.qtbot.mouseClick(panel.take, Qt.MouseButton.LeftButton)
    bodies.idle()
    record = bodies.document.state.bodies["quarter"]
    assert isinstance(record.provenance.source, MorphFrame)
    assert record.provenance.source.names == ("ball", "ring")
    taken = bodies.document.body("quarter")
    assert taken.mesh.volume == pytest.approx(np.interp(0.25, np.linspace(0, 1, 25), volumes), rel=0.03)
    assert "body:quarter" in layers
    assert "not a record" in bodies.window.panels.bodies.source.frame.text()
    from geofit.project.body_building import make_body

    folder = bodies.document.site_file.resolve().parent
    source, settings = record.provenance.source, record.provenance.settings
    again, made = make_body(source, settings, "quarter", (), folder, {})
    assert again == record.provenance
    np.testing.assert_array_equal(made.mesh.vertices, taken.mesh.vertices)
    # A body that is there already is kept, and so is a file.
    kept = bodies.document.state.bodies["ball"]
    bodies.morphing.take("ball")
    assert "already" in str(bodies.failures.pop())
    assert bodies.document.state.bodies["ball"] is kept
    mine = tmp_path / f"{file_stems(['ball - ring'])['ball - ring']}.json"
    mine.write_text("mine", encoding="utf-8")
    monkeypatch.setattr(QFileDialog, "getExistingDirectory", lambda *_, **__: str(tmp_path))
    monkeypatch.setattr(QMessageBox, "exec", lambda _: QMessageBox.StandardButton.No)
    bodies.morphing.ask_export()
    bodies.idle()
    assert mine.read_text("utf-8") == "mine"
    # Frames and table; no film, which needs no window to be right.
    bodies.morphing.export(tmp_path / "out", frames=3, film=None)
    bodies.idle()
    written = morph_files(tmp_path / "out", "ball - ring", film=None)
    assert sorted((tmp_path / "out").iterdir()) == sorted(written)
    assert {file.suffix for file in (tmp_path / "out").iterdir() if file.is_file()} >= {".pvd", ".glb", ".csv", ".json"}
    assert "not a record of the process" in bodies.window.statusBar().currentMessage()
    # Without one of its ends there is no way any more.
    bodies.window.bodies.styles.delete("ring")
    bodies.idle()
    assert bodies.morphing.view is None
    assert "morph" not in layers
    assert not panel.timeline.isEnabled()


def test_what_is_never_reached_is_told_before_the_run(bodies, tmp_path):
    write(tmp_path / "two.ply", Sphere([10, 0, 0], 30.0), Sphere([120, 0, 0], 20.0))
    bodies.window.bodies.take_mesh(tmp_path / "two.ply")
    bodies.idle()
    panel = bodies.panel
    join(bodies, "ball", "two")
    view = bodies.morphing.view
    assert len(view.preview.unreached) == 1
    assert view.full is None
    assert "Not reached by any front: 1 parts" in panel.said.text()
    assert not panel.take.isEnabled()
    panel.seeds.setChecked(True)
    assert bodies.morphing.view is None
    join(bodies, "ball", "two")
    seeded = bodies.morphing.view
    assert seeded.way.seeds
    assert seeded.full is not None
    assert seeded.rows[-1].components == 2
    panel.seeds.setChecked(False)
    join(bodies, "ball", "two")
    bodies.qtbot.mouseClick(panel.run, Qt.MouseButton.LeftButton)
    bodies.idle()
    assert bodies.morphing.view.full is not None


def test_frames_that_were_stopped_are_said_to_lack_and_can_be_made(bodies):
    panel, morphing = bodies.panel, bodies.morphing
    check(bodies, "ball", "ring")
    bodies.qtbot.mouseClick(panel.run, Qt.MouseButton.LeftButton)
    for field in (panel.list, panel.mode, panel.pace, panel.dates, panel.seeds):
        assert not field.isEnabled()
    bodies.qtbot.waitUntil(lambda: morphing.view is not None, timeout=60_000)
    bodies.qtbot.mouseClick(panel.stop, Qt.MouseButton.LeftButton)
    bodies.idle()
    assert morphing.view.full is None
    assert "not made" in panel.said.text()
    assert panel.mode.isEnabled()
    assert not panel.take.isEnabled()
    bodies.qtbot.mouseClick(panel.run, Qt.MouseButton.LeftButton)
    bodies.idle()
    assert morphing.view.full is not None
    assert not panel.said.isVisible()


def test_a_way_whose_body_went_meanwhile_is_not_shown(bodies):
    panel, morphing = bodies.panel, bodies.morphing
    check(bodies, "ball", "ring")
    bodies.qtbot.mouseClick(panel.run, Qt.MouseButton.LeftButton)
    assert bodies.window.activity.busy
    bodies.window.bodies.styles.delete("ring")
    bodies.idle()
    assert morphing.view is None
    assert not panel.timeline.isEnabled()
    assert "morph" not in bodies.window.panels.view.layers


def test_notes_on_the_full_grid_are_shown(bodies, tmp_path):
    """A part of 20 m in bodies of 520 m is 5 of its cells thick: as the command line says, so does the panel."""
    for name, radius in (("old", 9.0), ("new", 10.0)):
        write(tmp_path / f"{name}.ply", Sphere([0, 0, 0], 30.0), Sphere([480, 0, 0], radius))
        bodies.window.bodies.take_mesh(tmp_path / f"{name}.ply")
        bodies.idle()
    join(bodies, "old", "new")
    notes = bodies.morphing.view.notes
    coarse = [note.params["name"] for note in notes if note.code == "morphing.cells-too-coarse"]
    assert coarse == ["old", "new"]
    assert bodies.panel.said.isVisible()
    assert bodies.panel.said.text() == "\n".join(map(str, notes))


def test_dates_and_order_are_those_of_the_list(bodies):
    panel = bodies.panel
    panel.list.insertItem(0, panel.list.takeItem(1))
    panel.dates.setText("2024-01-01，2025-01-01")
    join(bodies, "ball", "ring")
    view = bodies.morphing.view
    assert view.way.names == ("ring", "ball")
    panel.timeline.put(0.5)
    panel.moved.emit(0.5)
    rested(bodies)
    assert "2024-07-02" in panel.where.text()
    panel.dates.setText("2025-01-01, 2024-01-01")
    bodies.qtbot.mouseClick(panel.run, Qt.MouseButton.LeftButton)
    bodies.qtbot.waitUntil(lambda: bool(bodies.failures), timeout=60_000)
    assert "2024-01-01" in str(bodies.failures.pop())
    bodies.qtbot.waitUntil(panel.run.isVisible)


def test_another_language_keeps_the_way(bodies):
    panel, morphing = bodies.panel, bodies.morphing
    panel.list.insertItem(0, panel.list.takeItem(1))
    panel.mode.setCurrentIndex(panel.mode.findData("blend"))
    panel.dates.setText("2024-01-01, 2025-01-01")
    join(bodies, "ball", "ring")
    panel.skin.setChecked(False)
    panel.timeline.put(0.5)
    panel.moved.emit(0.5)
    panel.rested.emit(0.5)
    rested(bodies)
    view, shown = morphing.view, panel.where.text()
    # A key or a click moves and rests in one event: the full grid wins over the preview.
    assert f"{view.full(0.5).overview.volume:,.0f}".replace(",", "\N{NO-BREAK SPACE}") in shown
    bodies.desktop.change_language("zh_CN")
    bodies.idle()
    bodies.desktop.change_language("en")
    bodies.idle()
    panel, morphing = bodies.window.panels.morph, bodies.window.morphing
    bodies.qtbot.waitUntil(lambda: morphing.idle, timeout=60_000)
    assert morphing.view is view
    assert panel.chosen() == ("ring", "ball")
    assert (panel.mode.currentData(), panel.dates.text()) == ("blend", "2024-01-01, 2025-01-01")
    assert (panel.timeline.tau, panel.timeline.events) == (0.5, tuple(event.tau for event in view.events))
    assert panel.where.text() == shown
    assert panel.take.isEnabled()
    layers = bodies.window.panels.view.layers
    assert "morph" in layers
    assert not [layer for layer in layers if layer.kind == "morph end"]
    panel.skin.setChecked(True)
    assert [layer.horizon for layer in layers if layer.kind == "morph end"] == ["ring", "ball"]


def test_horizons_are_closed_to_bodies_and_joined(app, sample, tmp_path):
    from geofit.gui.dialogs.horizon_bodies import HorizonBodies
    from geofit.project.body_record import BetweenHorizons

    app.window.files.open(sample / "site.toml")
    app.idle()
    panel, morphing = app.window.panels.morph, app.window.morphing
    app.window.panels.reveal("morph")
    for name in list(app.document.horizons)[:2]:
        app.window.fitting.fit(name)
        app.idle()
    upper, lower = list(app.document.surfaces())
    low = min(float(surface.bounds[0][2]) for surface in app.document.surfaces().values())
    dialog = HorizonBodies(tuple(app.document.surfaces()), low, app.window)
    ok = dialog.buttons.button(dialog.buttons.StandardButton.Ok)
    assert not ok.isEnabled()
    for k in range(2):
        dialog.list.item(k).setCheckState(Qt.CheckState.Checked)
    assert ok.isEnabled()
    assert dialog.chosen() == (upper, lower)
    base = dialog.base()
    assert base < low
    dialog.under.setCurrentIndex(dialog.under.findData(lower))
    assert dialog.chosen() == (upper,)
    assert dialog.base() == lower
    morphing.close_horizons((upper, lower), base)
    app.idle()
    made = app.document.made_bodies()
    assert made[upper].body.closed is not None
    assert made[upper].mesh.is_closed
    assert app.document.state.bodies[upper].provenance.source == BetweenHorizons(upper, base)
    app.panel, app.morphing = panel, morphing
    join(app, upper, lower)
    rows = morphing.view.rows
    assert rows[0].volume > rows[-1].volume
    assert max(row.drift for row in rows) <= 1e-4 * rows[-1].volume
    shown = app.document.surfaces()
    x, y = (np.linspace(*[b[k] for b in shown[upper].bounds], 60)[10:-10] for k in (0, 1))
    px, py = (v.ravel() for v in np.meshgrid(x, y))
    apart = shown[upper].elevation(px, py) - shown[lower].elevation(px, py)
    assert np.nanmean(apart) > 0


def test_a_film_shows_the_way_as_the_view_does(bodies, tmp_path, monkeypatch):
    from PIL import Image

    from geofit.data.errors import MissingDependencyError

    join(bodies, "ball", "ring")
    morphing, panel, view = bodies.morphing, bodies.panel, bodies.window.panels.view
    panel.timeline.put(0.3)
    panel.rested.emit(0.3)
    rested(bodies)
    shown_before, written = panel.where.text(), []
    morphing.filming.written.connect(written.append)
    morphing.film(tmp_path / "way.gif", pictures=5)
    assert bodies.window.busy, "another language would cut the film off"
    bodies.qtbot.waitUntil(lambda: bool(written), timeout=60_000)
    bodies.idle()
    assert panel.timeline.tau == 0.3
    # The frame of the full grid is back, not its preview.
    rested(bodies)
    assert panel.where.text() == shown_before
    with Image.open(tmp_path / "way.gif") as film:
        assert film.n_frames == 5
        shown = view.picture()
        assert film.size == (shown.width(), shown.height())
        frames = []
        for k in range(5):
            film.seek(k)
            frames.append(np.asarray(film.convert("RGB"), float))
    assert all(np.abs(a - b).max() > 50 for a, b in pairwise(frames))
    monkeypatch.setenv("PATH", str(tmp_path))
    morphing.film(tmp_path / "way.mp4")
    assert isinstance(bodies.failures.pop(), MissingDependencyError)
    assert not (tmp_path / "way.mp4").exists()


def test_the_empty_panel_names_the_three_ways_to_bodies_and_offers_two_of_them(qtbot):
    from PySide6.QtWidgets import QPushButton

    from geofit.gui.panels.morph import MorphPanel

    panel = MorphPanel()
    qtbot.addWidget(panel)
    panel.resize(900, 400)
    panel.show()
    qtbot.waitExposed(panel)
    for words in ("panel Bodies", "files", "close horizons to bodies"):
        assert words in panel.pages.text
    shown = [button for button in panel.findChildren(QPushButton) if button.isVisible()]
    for text, signal in ((panel.add.text(), panel.add_requested), (panel.horizons.text(), panel.horizons_requested)):
        (button,) = [button for button in shown if button.text() == text]
        with qtbot.waitSignal(signal, timeout=1000):
            button.click()
    panel.show_bodies((("a", "report"),))
    assert panel.pages.text == ""
    assert panel.horizons.isVisible()
