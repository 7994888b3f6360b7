"""Lengths in feet: what the windows show is converted on its way to the screen, and nothing else is."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
from panel_samples import SITE, WITH_PERIPHERY, fitted, sample_site
from PySide6.QtWidgets import QDialog

from geofit.gui.dialogs.preferences import PreferencesDialog
from geofit.gui.lengths import count_coordinates_in, in_lengths, in_title, show_lengths_in, shown_length
from geofit.gui.panels.residuals import ResidualTable
from geofit.gui.panels.verdict import VerdictBadge
from geofit.gui.preferences import Preferences
from geofit.gui.view3d.axes import ticks

FOOT, SURVEY = 0.3048, 1200 / 3937


@pytest.fixture(autouse=True)
def metres_again():
    yield
    show_lengths_in("m")
    count_coordinates_in(None)


@pytest.mark.parametrize(
    ("metres", "feet"),
    [
        ("σ 0.3048 m < ε 0.5 m", "σ 1.0000 ft < ε 1.64 ft"),
        ("over 0.01 m, 120 m", "over 0.0328 ft, 394 ft"),
        ("max |d| 12.345 m of 1 234 points", "max |d| 40.502 ft of 1 234 points"),
        ("from 1–2 m to 3 – 4 m", "from 3–7 ft to 10 – 13 ft"),
        ("E 304.80  N 609.60  Z -30.48 m\nresidual +0.305 m", "E 1000.00  N 2000.00  Z -100.00 ft\nresidual +1.001 ft"),
        ("d −0.305 m", "d −1.001 ft"),
        ("d +0.305 m", "d +1.001 ft"),
        ("4.20e-06 m", "1.38e-5 ft"),
        ("12.5 m², 7 m³, 3 mm, 4 m/s, 5 km", "12.5 m², 7 m³, 3 mm, 4 m/s, 5 km"),
        ("T3-2 mudstone, hole ZK12", "T3-2 mudstone, hole ZK12"),
        ("最大 |d| 0.305 m，共 3 点", "最大 |d| 1.001 ft，共 3 点"),
    ],
)
def test_lengths_in_texts(metres, feet):
    assert in_lengths(metres) == metres
    show_lengths_in("ft")
    assert in_lengths(metres) == feet


def test_titles_and_numbers():
    show_lengths_in("ft-us")
    assert [in_title(text) for text in ("Easting, m", "东坐标，m", "Dip, °", "Hole", "d, m (below < 0)")] == [
        "Easting, ft", "东坐标，ft", "Dip, °", "Hole", "d, ft (below < 0)"
    ]  # fmt: skip
    assert shown_length(1.0) == pytest.approx(3937 / 1200)
    # Round in feet, given in metres.
    assert (ticks(1500.0, 1600.0, 20.0) / SURVEY) % 50 == pytest.approx(0, abs=1e-5)


@pytest.mark.usefixtures("own_settings")
def test_table_and_verdict_in_feet(qtbot):
    surface = fitted(WITH_PERIPHERY)

    def panels():
        table, badge = ResidualTable(), VerdictBadge()
        for widget in (table, badge):
            qtbot.addWidget(widget)
        table.show_surface(surface)
        badge.show_accuracy(surface.accuracy)
        columns = {column.title: column.values for column in table.table.rows.columns}
        return columns, badge.text

    metres, words = panels()
    show_lengths_in("ft")
    feet, words_in_feet = panels()
    assert feet["Easting, ft"] == pytest.approx(metres["Easting, m"] / FOOT)
    assert feet["|d|, ft"] == pytest.approx(metres["|d|, m"] / FOOT)
    assert not [title for title in feet if title.endswith(", m")]
    epsilon = surface.settings.epsilon
    assert re.search(rf"{epsilon:g}\s?m\b", words)
    assert not re.search(r"\d\s?m\b", words_in_feet), words_in_feet
    assert re.search(rf"{epsilon / FOOT:.2f}\s?ft\b", words_in_feet)


def test_the_preference_makes_the_window_anew(app, qtbot, monkeypatch):
    old, state = app.window, app.document.state

    def choose(dialog):
        dialog.lengths_box.setCurrentIndex(dialog.lengths_box.findData("ft"))
        return QDialog.DialogCode.Accepted

    monkeypatch.setattr(PreferencesDialog, "exec", choose)
    app.trigger("preferences")
    qtbot.waitUntil(lambda: app.window is not old)
    assert Preferences().lengths == "ft"
    assert app.document.state is state, "the data stay as they are"
    app.window.bar.show_place(304.8, 609.6, 30.48)
    assert app.window.bar.place.text() == "E 1000.00   N 2000.00   Z 100.00 ft"


def test_axes_have_round_numbers_in_feet(qtbot):
    from matplotlib.figure import Figure

    from geofit.gui.panels.length_axes import number_lengths

    def labels():
        axes = Figure().subplots()
        axes.set_xlim(0, 300)
        axes.set_ylim(1500, 1540)
        axes.set_xlabel("Distance along the section, m")
        axes.set_ylabel("points")
        number_lengths(axes)
        texts = [label.get_text() for label in axes.get_xticklabels()]
        return axes.get_xlabel(), texts, axes.get_xticks(), axes.get_ylabel()

    assert labels()[0].endswith(", m")
    show_lengths_in("ft")
    title, texts, places, other = labels()
    assert title == "Distance along the section, ft"
    assert other == "points"
    assert all(float(text) % 100 == 0 for text in texts)
    assert places == pytest.approx([float(text) * FOOT for text in texts])


@pytest.mark.parametrize(
    ("shown", "grid", "text"),
    [
        ("m", "ft-us", "E 6000000.00  N 2000000.00 ft  Z -30.48 m\nresidual +0.305 m"),
        ("ft", "ft-us", "E 6000000.00  N 2000000.00  Z -100.00 ft\nresidual +1.001 ft"),
        ("ft", None, "E 6000012.00  N 2000004.00  Z -100.00 ft\nresidual +1.001 ft"),
    ],
)
def test_places_are_in_the_unit_of_the_grid(shown, grid, text):
    show_lengths_in(shown)
    count_coordinates_in(grid)
    east, north = 6_000_000 * SURVEY, 2_000_000 * SURVEY
    assert in_lengths(f"E {east:.4f}  N {north:.4f}  Z -30.48 m\nresidual +0.305 m").replace(".0000", ".00") == text
    assert in_title("Easting, m", coordinate=True) == ("Easting, ft")
    assert in_title("Elevation, m") == f"Elevation, {shown}"


def test_a_site_whose_grid_counts_in_feet_has_its_coordinates_in_them(app):
    pytest.importorskip("pyproj")
    site = sample_site()
    app.desktop.session.begin(replace(site, crs="EPSG:2227"), SITE)
    app.idle()
    app.window.bar.show_place(6_000_000 * SURVEY, 2_000_000 * SURVEY, 30.0)
    assert app.window.bar.place.text() == "E 6000000.00   N 2000000.00 ft   Z 30.00 m"
    view = app.window.panels.view
    view.view("top")
    view.canvas.land()
    app.qtbot.wait(50)
    marks = [mark.text for mark in view.content(view.canvas.projector()).marks]
    east = site.horizons["T3-T2"].xyz[:, 0] / SURVEY
    numbers = [float(re.sub(r"\D", "", text)) for text in marks if text.startswith("E ")]
    assert numbers
    assert all(east.min() - 5000 < number < east.max() + 5000 for number in numbers)
    app.desktop.session.begin(replace(site, crs="EPSG:32650"), SITE)
    app.idle()
    app.window.bar.show_place(304.8, 609.6, 30.48)
    assert app.window.bar.place.text() == "E 304.80   N 609.60   Z 30.48 m"
