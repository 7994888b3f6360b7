"""Away from the data: the button, the figures, and what the tables lead to."""

from __future__ import annotations

from dataclasses import replace

import pytest
from panel_samples import fitted, prediction
from PySide6.QtCore import Qt

from geofit.gui.panels.prediction import PredictionPanel
from geofit.project.provenance import Row


@pytest.fixture
def panel(qtbot):
    panel = PredictionPanel()
    qtbot.addWidget(panel)
    panel.resize(260, 600)
    panel.show()
    return panel


def test_nothing_examined_offers_to_examine(panel, qtbot):
    assert panel.pages.button.text() == "Examine"
    with qtbot.waitSignal(panel.examine_requested):
        qtbot.mouseClick(panel.pages.button, Qt.MouseButton.LeftButton)


def test_without_a_surface_there_is_nothing_to_examine(panel):
    panel.show_prediction(None, fitted=False)
    assert "press Fit" in str(panel.pages.text)
    assert not panel.pages.button.isVisible()


def test_the_figures_are_told(panel):
    panel.show_prediction(prediction(393), fitted().points)
    words = panel.figures.text()
    assert "1.10 m on average, 6.20 m at most" in words
    assert "1.62" in words
    assert "91 %" in words
    titles = [column.title for column in panel.left_out.rows.columns]
    assert {"geofit, m", "Thin plate, m", "Kriging, m"} <= set(titles)
    kriging = panel.left_out.rows.columns[titles.index("Kriging, m")]
    assert [kriging.text(0), kriging.text(1)] == ["1.400", ""]
    assert "left out together" in panel.notes.text()


@pytest.mark.parametrize(("inside", "words"), [((0.9, 1.0), "Not widened: the 90 % band contains 90 %"),
                                              ((1.0, 0.0), "The 90 % band was not widened."),
                                              ((), "The 90 % band was not widened.")])  # fmt: skip
def test_a_band_that_was_not_widened_contains_what_it_contains(panel, inside, words):
    found = prediction(393)
    left = tuple(replace(found.left_out[0], inside=share) for share in inside)
    panel.show_prediction(replace(found, left_out=left, uncertainty=replace(found.uncertainty, factor=1.0)))
    text = panel.figures.text()
    assert words in text
    assert ("or more" in text) == words.startswith("Not")


def test_a_suggestion_leads_to_its_place(panel, qtbot):
    panel.show_prediction(prediction(393), fitted().points)
    with qtbot.waitSignal(panel.suggestion_chosen) as told:
        panel.suggestions.selectRow(1)
    assert told.args == [30.0, 40.0, 1211.5]


def test_an_outlier_leads_to_its_point_even_when_sorted(panel, qtbot):
    points = fitted().points
    panel.show_prediction(prediction(len(points)), points)
    panel.outliers.sortByColumn(1, Qt.SortOrder.AscendingOrder)
    assert panel.outliers.rows.columns[0].text(0) == str(points.describe(7))
    with qtbot.waitSignal(panel.point_chosen) as told:
        panel.outliers.selectRow(0)
    assert told.args == [Row.of(points, 3)]
    with qtbot.assertNotEmitted(panel.point_chosen):
        panel.choose_point(7)
    assert panel.outliers.current == 0


def test_every_column_is_seen_beside_the_view(panel):
    """In a window of 1280 pixels the dock has about 790."""
    panel.resize(790, 300)
    panel.show_prediction(prediction(393), fitted().points)
    for table in (panel.left_out, panel.suggestions, panel.outliers):
        assert table.horizontalHeader().length() <= table.viewport().width()
        for column in range(table.model().columnCount()):
            title = table.rows.columns[column].title
            assert table.fontMetrics().horizontalAdvance(title) < table.columnWidth(column), title


def test_it_fits_a_narrow_dock(panel):
    panel.show_prediction(prediction(393), fitted().points)
    assert panel.minimumSizeHint().width() <= 260
