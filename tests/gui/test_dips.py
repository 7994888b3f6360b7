"""Measured dips through the window: added as a file, in the net, the table and the scene, as data of the fit."""

from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt

from geofit.io.site_file import read_site
from geofit.project.provenance import Row

NAME = "base of clay"
OFFSET = np.array([512_000.0, 3_455_000.0])


def height(x, y):
    return 100 + 0.15 * x + 20 * np.sin(x / 70) * np.cos(y / 90)


@pytest.fixture
def opened(app, tmp_path):
    """A site of twenty holes that is fitted, with the file of dips beside it."""
    folder = tmp_path / "site"
    folder.mkdir()
    rng = np.random.default_rng(1)
    x, y = rng.uniform(0, 400, (2, 20))
    rows = [
        f"B{k},{a + OFFSET[0]:.2f},{b + OFFSET[1]:.2f},{height(a, b):.3f},{NAME}"
        for k, (a, b) in enumerate(zip(x, y, strict=True))
    ]
    (folder / "picks.csv").write_text("hole,x,y,z,horizon\n" + "\n".join(rows) + "\n", encoding="utf-8")
    (folder / "site.toml").write_text(
        '[site]\nname = "Dam"\n[[picks]]\nfile = "picks.csv"\nkind = "borehole"\n', encoding="utf-8"
    )
    x, y = rng.uniform(40, 360, (2, 12))
    gx = 0.15 + 20 / 70 * np.cos(x / 70) * np.cos(y / 90)
    gy = -20 / 90 * np.sin(x / 70) * np.sin(y / 90)
    azimuth, dip = np.degrees(np.arctan2(-gx, -gy)) % 360, np.degrees(np.arctan(np.hypot(gx, gy)))
    rows = [
        f"{a + OFFSET[0]:.2f},{b + OFFSET[1]:.2f},{height(a, b):.2f},{c:.1f},{d:.1f},{NAME if k else ''}"
        for k, (a, b, c, d) in enumerate(zip(x, y, azimuth, dip, strict=True))
    ]
    (folder / "dips.csv").write_text("x,y,z,dip direction,dip,horizon\n" + "\n".join(rows) + "\n", encoding="utf-8")
    app.desktop.session.begin(read_site(folder / "site.toml"), folder / "site.toml")
    app.idle()
    app.window.fitting.fit(NAME)
    app.idle()
    app.document.select(NAME)
    app.idle()
    return folder


@pytest.fixture
def with_dips(app, opened):
    app.window.living.add([opened / "dips.csv"])
    app.idle()
    app.window.panels.reveal("stereonet")
    app.idle()
    return app.window.panels.stereonet


def test_a_site_without_dips_says_how_to_add_some(app, opened):
    panel = app.window.panels.stereonet
    assert "No dips were measured" in panel.pages.text
    assert panel.pages.button.text() == "Add data…"


def test_added_dips_are_listed_with_the_surface_at_their_places(app, qtbot, with_dips):
    panel = with_dips
    assert panel.pages.text == ""
    assert panel.table.rows.total == len(panel.shown) == 11
    assert "11 measurements" in panel.words.text()
    assert "angle to the surface" in panel.words.text()
    assert np.isfinite(panel.shown.angle).all()
    panel.which.setCurrentIndex(1)
    panel.which.activated.emit(1)
    assert panel.table.rows.total == 12
    assert np.isnan(panel.shown.angle).sum() == 1
    # Undo takes the file out again, redo brings it back.
    app.window.menus.undo.trigger()
    app.idle()
    assert "No dips" in panel.pages.text
    app.window.menus.redo.trigger()
    app.idle()
    assert len(app.document.site.orientations) == 12


def test_net_table_and_scene_have_one_selection(app, qtbot, with_dips):
    panel, view = with_dips, app.window.panels.view
    qtbot.wait(100)
    chosen = []
    panel.dip_chosen.connect(chosen.append)
    # How large the net is depends on the screen: the pole farthest from all others is the one to hit.
    places = np.array([panel.place_of(k) for k in panel.shown.index])
    apart = np.linalg.norm(places[:, None] - places[None], axis=-1) + np.diag(np.full(len(places), np.inf))
    lonely = int(apart.min(axis=1).argmax())
    dip = int(panel.shown.index[lonely])
    x, y = places[lonely]
    qtbot.mouseClick(panel.canvas, Qt.MouseButton.LeftButton, pos=QPoint(round(x), round(y)))
    assert chosen == [dip]
    assert panel.table.current == lonely
    assert "towards" in view.pointer.ring.text
    assert np.allclose(view.pointer.ring.xyz, app.document.site.orientations.xyz[dip])
    # A row of the table.
    panel.table.selectRow(0)
    first = int(panel.shown.index[panel.table.model().source(0)])
    assert chosen[-1] == first
    # A disc in the scene.
    for layer in view.layers:
        if layer.kind in ("points", "surface"):
            view.layers.change(layer.key, visible=False)
    app.trigger("top")
    qtbot.wait(900)
    place = view.canvas.projector().screen(app.document.site.orientations.xyz[7:8])[0]
    hit = view.pointer.under(QPointF(place[0], place[1]))
    assert hit.layer.kind == "dips"
    assert int(hit.which) == 7
    assert "dips.csv, row" in app.window.context.words(hit)
    qtbot.mouseClick(view.canvas, Qt.MouseButton.LeftButton, pos=QPoint(round(place[0]), round(place[1])))
    assert panel.chosen == 7
    assert app.window.statusBar().currentMessage().startswith("dip ")


def test_dips_become_data_of_the_fit_and_the_project_keeps_it(app, qtbot, with_dips, tmp_path):
    panel, fit = with_dips, app.window.panels.fit
    before = float(np.nanmean(panel.shown.angle))
    grid = np.stack(np.meshgrid(np.linspace(20, 380, 25), np.linspace(20, 380, 25)), -1).reshape(-1, 2)

    def error():
        z = app.document.surface(NAME).elevation(*(grid + OFFSET).T)
        return float(np.sqrt(np.nanmean((z - height(*grid.T)) ** 2)))

    without = error()
    fit.fields["dips"].put("fit")
    fit.fields["dip_accuracy"].put(0.5)
    fit.fit_button.click()
    app.idle()
    assert app.document.settings(NAME).dips == "fit"
    assert not app.document.stale(NAME)
    assert float(np.nanmean(panel.shown.angle)) < 0.6 * before
    assert error() < 0.9 * without
    notes = {note.code for note in app.document.surface(NAME).accuracy.notes}
    assert "fitting.dips-fitted" in notes
    # The same from the project file: settings, dips and surface.
    net = app.document.surface(NAME).patches[0].control
    file = tmp_path / "dam.geofit"
    app.window.files.save_to(file)
    app.idle()
    app.window.files.open(file)
    app.idle()
    assert app.document.settings(NAME).dip_accuracy == 0.5
    assert np.array_equal(app.document.surface(NAME).patches[0].control, net)
    app.document.select(NAME)
    app.idle()
    assert len(app.window.panels.stereonet.shown) == 11


def test_a_point_left_out_keeps_the_dips(app, with_dips):
    app.window.fitting.exclude(NAME, [Row("picks.csv", 5)])
    app.idle()
    assert len(with_dips.shown) == 11
