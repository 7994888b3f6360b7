"""The residual table: worst first, filtered, linked both ways, copied and exported."""

from __future__ import annotations

import csv
import io

import numpy as np
import pytest
from panel_samples import cloud, fitted
from PySide6.QtCore import QItemSelectionModel, Qt
from PySide6.QtWidgets import QApplication

from geofit.gui.panels.residuals import ResidualTable
from geofit.project.listing import listing as list_points
from geofit.project.provenance import Row

DISTANCE, HOLE = 1, 3


@pytest.fixture
def panel(qtbot):
    panel = ResidualTable()
    qtbot.addWidget(panel)
    panel.resize(900, 400)
    panel.show()
    return panel


def column(panel, k):
    rows = panel.table.rows
    return [rows.data(rows.index(r, k)) for r in range(rows.rowCount())]


def test_an_empty_table_says_what_to_do(panel):
    assert "press Fit" in str(panel.pages.text)


def test_the_worst_point_comes_first(panel):
    surface = fitted()
    panel.show_surface(surface)
    assert str(panel.pages.text) == ""
    sources = [panel.table.rows.source(r) for r in range(20)]
    assert sources == list(surface.accuracy.worst)
    assert float(column(panel, DISTANCE)[0]) == pytest.approx(surface.accuracy.max_abs, abs=1e-4)


def test_going_to_a_row_tells_its_point(panel, qtbot):
    panel.show_surface(fitted())
    with qtbot.waitSignal(panel.point_chosen) as told:
        panel.table.selectRow(2)
    assert told.args == [Row.of(fitted().points, fitted().accuracy.worst[2])]


def test_choosing_a_point_selects_its_row_and_tells_nobody(panel, qtbot):
    panel.show_surface(fitted())
    with qtbot.assertNotEmitted(panel.point_chosen):
        panel.choose(Row.of(fitted().points, 200))
        panel.choose(Row.of(fitted().points, 200))
    assert panel.table.current == 200
    assert panel.table.rows.source(panel.table.selectionModel().selectedRows()[0].row()) == 200
    top, bottom = panel.table.rowAt(0), panel.table.rowAt(panel.table.viewport().height() - 1)
    assert top <= panel.table.currentIndex().row() <= bottom


def test_sorting_keeps_the_chosen_point(panel):
    panel.show_surface(fitted())
    panel.choose(Row.of(fitted().points, 123))
    panel.table.sortByColumn(HOLE, Qt.SortOrder.AscendingOrder)
    assert panel.table.current == 123


def test_holes_sort_by_their_numbers(panel):
    panel.show_surface(cloud(300))
    panel.table.sortByColumn(HOLE, Qt.SortOrder.AscendingOrder)
    assert column(panel, HOLE) == [f"ZK{i}" for i in range(300)]


def test_the_filters_keep_what_they_name(panel, qtbot):
    surface = cloud(5_000)
    panel.show_surface(surface)
    panel.only_over.setChecked(True)
    panel.only_approximated.setChecked(True)
    wanted = (np.abs(surface.accuracy.residuals) > surface.settings.interior_tolerance) & ~surface.core
    assert panel.table.rows.rowCount() == wanted.sum()
    assert f"{wanted.sum()} of 5000" in panel.count.text()
    panel.search.setText("zk12")
    named = wanted & (np.char.find(np.char.lower(surface.points.hole), "zk12") >= 0)
    qtbot.waitUntil(lambda: panel.table.rows.rowCount() == named.sum())


def test_a_point_that_the_filter_hides_is_said_to_be_hidden(panel, qtbot):
    surface = cloud(100)
    panel.show_surface(surface)
    panel.search.setText("ZK99")
    qtbot.waitUntil(lambda: panel.table.rows.rowCount() == 1)
    assert panel.count.text() == "Points: 1 of 100"
    panel.choose(Row.of(surface.points, 4))
    assert "hidden" in panel.count.text()
    assert panel.table.current is None


def test_copy_gives_tab_separated_text_of_the_selected_rows(panel):
    panel.show_surface(fitted())
    panel.table.setFocus()
    flags = QItemSelectionModel.SelectionFlag.Select | QItemSelectionModel.SelectionFlag.Rows
    panel.table.clearSelection()
    for row in (0, 3):
        panel.table.selectionModel().select(panel.table.rows.index(row, 0), flags)
    panel.table.copy_action.trigger()
    lines = QApplication.clipboard().text().splitlines()
    assert len(lines) == 3
    assert lines[0].split("\t")[:2] == ["Residual, m", "|d|, m"]
    assert float(lines[1].split("\t")[1]) == pytest.approx(fitted().accuracy.max_abs, abs=1e-4)


def test_export_writes_every_row_that_is_shown(panel, tmp_path):
    panel.show_surface(fitted())
    panel.only_approximated.setChecked(True)
    panel.table.export(tmp_path / "残差.csv")
    text = (tmp_path / "残差.csv").read_text(encoding="utf-8-sig")
    rows = list(csv.DictReader(io.StringIO(text)))
    assert len(rows) == (~fitted().core).sum()
    assert {row["Hole"] for row in rows} == set(fitted().points.hole[~fitted().core].tolist())
    assert any(row["Hole"].startswith("孔") for row in rows)
    assert [p.name for p in tmp_path.iterdir()] == ["残差.csv"]


def test_the_menu_excludes_and_pulls(panel, qtbot):
    panel.show_surface(fitted())
    panel.choose(Row.of(fitted().points, 17))
    menu = panel.table.menu()
    words = [action.text() for action in menu.actions() if action.text()]
    assert len(words) == 4
    with qtbot.waitSignal(panel.exclude_requested) as excluded:
        menu.actions()[0].trigger()
    with qtbot.waitSignal(panel.move_requested) as pulled:
        menu.actions()[1].trigger()
    row = Row.of(fitted().points, 17)
    assert excluded.args == [(row,)]
    assert pulled.args == [row]


def test_all_selected_rows_are_excluded_then_struck_listed_and_still_selected(panel, qtbot):
    surface = fitted()
    panel.show_surface(surface, list_points(surface.points, (), surface))
    panel.table.select([3, 8, 21])
    with qtbot.waitSignal(panel.exclude_requested) as excluded:
        panel.table.menu().actions()[0].trigger()
    rows = excluded.args[0]
    assert {row.find(surface.points) for row in rows} == {3, 8, 21}
    panel.show_surface(surface, list_points(surface.points, frozenset(rows), surface))
    assert set(panel.chosen_rows()) == set(rows)
    assert "excluded: 3" in str(panel.count.text())
    panel.only_excluded.setChecked(True)
    assert panel.table.rows.rowCount() == 3
    index = panel.table.rows.index(0, 0)
    assert panel.table.rows.data(index, Qt.ItemDataRole.FontRole).strikeOut()
    assert panel.table.rows.data(index, Qt.ItemDataRole.ForegroundRole) is not None
    panel.only_excluded.setChecked(False)
    panel.table.select([5])
    assert panel.table.rows.data(panel.table.currentIndex(), Qt.ItemDataRole.FontRole) is None
    panel.table.select([3, 8])
    assert "again" in str(panel.table.menu().actions()[0].text())


def test_a_hundred_thousand_rows_are_sorted_as_arrays(panel, monkeypatch):
    surface = cloud(100_000)
    asked = []
    panel.show_surface(surface)
    original = type(panel.table.rows).data
    monkeypatch.setattr(type(panel.table.rows), "data", lambda self, *a: (asked.append(1), original(self, *a))[1])
    for k in (HOLE, DISTANCE, 0):
        panel.table.sortByColumn(k, Qt.SortOrder.AscendingOrder)
    # Only cells that are seen are asked for; a proxy that compares cells would ask for millions.
    assert len(asked) < 20_000
    d = surface.accuracy.residuals
    assert panel.table.rows.source(0) == int(np.argmin(d))
