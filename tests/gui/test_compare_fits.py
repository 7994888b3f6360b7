"""Two fits of a horizon side by side, through the window: cameras, figures, the one that is taken, and undo."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.io.site_file import read_site

NAME = "base of clay"


@pytest.fixture
def opened(app, tmp_path):
    rng = np.random.default_rng(1)
    x, y = rng.uniform(0, 400, (2, 40))
    z = 100 + 0.1 * x + 12 * np.sin(x / 60) * np.cos(y / 80) + rng.normal(0, 0.4, 40)
    rows = [f"B{k},{a:.2f},{b:.2f},{c:.3f},{NAME}" for k, (a, b, c) in enumerate(zip(x, y, z, strict=True))]
    (tmp_path / "picks.csv").write_text("hole,x,y,z,horizon\n" + "\n".join(rows) + "\n", encoding="utf-8")
    (tmp_path / "site.toml").write_text('[site]\nname = "Dam"\n[[picks]]\nfile = "picks.csv"\n', encoding="utf-8")
    app.desktop.session.begin(read_site(tmp_path / "site.toml"), tmp_path / "site.toml")
    app.document.select(NAME)
    app.idle()
    app.window.panels.fit.fit_button.click()
    app.idle()
    return app


@pytest.fixture
def dialog(opened):
    """The dialog on two fits: automatic, and without an exact core and much smoother."""
    fit = opened.window.panels.fit
    fit.fields["core"].put("none")
    fit.fields["smoothing"].put(5.0)
    fit.fit_button.click()
    opened.idle()
    opened.trigger("compare_fits")
    dialog = opened.window.comparing_fits.dialog
    assert dialog is not None
    opened.qtbot.waitExposed(dialog)
    yield dialog
    opened.window.comparing_fits.close()


def cells(dialog):
    table = dialog.table
    return {
        table.item(k, 0).text(): (table.item(k, 1).text(), table.item(k, 2).text()) for k in range(table.rowCount())
    }


def test_one_fit_alone_says_what_to_do(opened):
    opened.trigger("compare_fits")
    assert opened.window.comparing_fits.dialog is None
    assert "change its settings, fit again" in opened.window.statusBar().currentMessage()


def test_the_settings_that_differ_and_the_figures_of_both(opened, dialog):
    found = cells(dialog)
    assert found["Smoothing"] == ("Automatic", "5")
    assert found["Exact core"] == ("Automatic", "None")
    assert "Interior tolerance, m" not in found
    surfaces = [dialog.shown(side).surface for side in (0, 1)]
    assert found["σ, m"] == tuple(f"{one.accuracy.sigma:.3g}" for one in surfaces)
    assert found["RMS of points left out, m"] == ("not examined", "not examined")
    # What the sentence says is measured on the surfaces.
    grid = np.stack(np.meshgrid(np.linspace(20, 380, 60), np.linspace(20, 380, 60)), -1).reshape(-1, 2)
    d = surfaces[1].elevation(*grid.T) - surfaces[0].elevation(*grid.T)
    said = float(dialog.words.text().split("rms ")[1].split(" m")[0])
    assert said == pytest.approx(float(np.sqrt(np.nanmean(d**2))), rel=0.35)


def test_both_views_look_from_one_place(opened, dialog, qtbot):
    first, second = (view.canvas for view in dialog.views)
    where = [canvas.origin + canvas.viewpoint.centre for canvas in (first, second)]
    assert np.allclose(*where)
    first.look(first.viewpoint.turned(30.0, 10.0))
    assert second.viewpoint.azimuth == first.viewpoint.azimuth
    second.look(second.viewpoint.nearer(2.0))
    assert first.viewpoint.distance == pytest.approx(second.viewpoint.distance)
    place = np.array([[200.0, 200.0, 110.0]])
    seen = [canvas.projector(400, 300).screen(place)[0, :2] for canvas in (first, second)]
    assert np.allclose(*seen)


def test_the_other_fit_is_taken_and_undone(opened, dialog, qtbot):
    document = opened.document
    before, wanted = document.state.provenances[NAME], dialog.shown(0).provenance
    assert not dialog.use[1].isEnabled()
    dialog.use[0].click()
    opened.idle()
    assert document.state.provenances[NAME] == wanted
    assert document.settings(NAME).smoothing == "auto"
    assert not document.stale(NAME)
    assert opened.window.comparing_fits.dialog is None
    opened.window.menus.undo.trigger()
    opened.idle()
    assert document.state.provenances[NAME] == before
    assert document.settings(NAME).smoothing == 5.0


def test_another_pair_is_shown_anew(opened, dialog):
    dialog.chosen[1].setCurrentIndex(0)
    assert "Smoothing" not in cells(dialog)
    assert "mean +0 m" in dialog.words.text()
