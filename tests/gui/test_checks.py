"""The checks panel: every check with mark, word, value and limit; conflicts and orders lead to their places."""

from __future__ import annotations

from dataclasses import replace

import pytest
from panel_samples import failing, fitted, prediction
from PySide6.QtWidgets import QApplication

from geofit.data.accuracy import Check, Conflict, ReadBack
from geofit.gui.panels.checks import ChecksPanel
from geofit.project.provenance import Row
from geofit.site.order import Order


@pytest.fixture
def panel(qtbot):
    panel = ChecksPanel()
    qtbot.addWidget(panel)
    panel.resize(900, 500)
    panel.show()
    return panel


def groups(panel):
    tree = panel.tree
    items = [tree.topLevelItem(i) for i in range(tree.topLevelItemCount())]
    return {item.text(0): [item.child(k) for k in range(item.childCount())] for item in items}


def changed(**changes):
    surface = fitted()
    return surface.with_(accuracy=replace(surface.accuracy, **changes))


def test_an_empty_panel_says_what_to_do(panel):
    assert "press Fit" in str(panel.pages.text)


def test_every_check_stands_there_with_its_result(panel):
    panel.show_surface(fitted())
    rows = groups(panel)["Surface"]
    assert [row.text(1) for row in rows[1:]] == [
        {True: "passed", False: "failed", None: "not applicable"}[check.passed] for check in fitted().accuracy.checks
    ]
    assert rows[0].text(0) == "σ"
    assert rows[0].text(3).replace("\xa0", " ") == "0.500 m"


def test_a_panel_that_was_filled_while_it_was_hidden_uses_its_width(qtbot):
    shown, filled = ChecksPanel(), ChecksPanel()
    for panel in (shown, filled):
        qtbot.addWidget(panel)
    shown.resize(1200, 500)
    shown.show()
    qtbot.waitExposed(shown)
    shown.show_surface(fitted())
    # As behind another panel: it has no width yet.
    filled.resize(100, 30)
    filled.show_surface(fitted())
    filled.resize(1200, 500)
    filled.show()
    qtbot.waitExposed(filled)
    assert filled.tree.columnWidth(0) == shown.tree.columnWidth(0)
    names = [row.text(0) for row in groups(filled)["Surface"]]
    assert filled.tree.columnWidth(0) > max(map(filled.fontMetrics().horizontalAdvance, names))


def test_a_failed_check_differs_in_word_and_mark(panel):
    panel.show_surface(failing(fitted()))
    sigma, core = groups(panel)["Surface"][:2]
    assert (sigma.text(1), core.text(1)) == ("failed", "passed")
    assert sigma.icon(0).pixmap(16).toImage() != core.icon(0).pixmap(16).toImage()


def test_a_conflict_leads_to_its_point(panel, qtbot):
    panel.show_surface(changed(conflicts=(Conflict(3, 9, 0.4, "the outcrop was dropped"),)))
    row = groups(panel)["Conflicts"][0]
    assert str(fitted().points.describe(9)) in row.text(0)
    assert "dropped" in row.text(4)
    with qtbot.waitSignal(panel.point_chosen) as told:
        panel.tree.setCurrentItem(row)
    assert told.args == [Row.of(fitted().points, 9)]


def test_a_check_with_a_place_leads_there(panel, qtbot):
    check = Check("self-intersection", False, 1, 0, "places", "it crosses itself", ((1.0, 2.0, 3.0),))
    panel.show_surface(changed(checks=(check,)))
    with qtbot.waitSignal(panel.place_chosen) as told:
        panel.tree.setCurrentItem(groups(panel)["Surface"][1])
    assert told.args == [1.0, 2.0, 3.0]


def test_order_off_data_and_read_back_have_their_groups(panel):
    order = Order("T3-T2", "T2-T1", 100.0, 4.5, 6.0, 9.0, (0.0, 0.0), (1.0, 1.0), ())
    back = ReadBack("a.step", "0" * 64, 9, 0.03, 0.0, 0.1, (), True, 12, 12, 1e-7, False, ())
    panel.show_surface(fitted(), prediction(len(fitted().points)), (order,), back)
    found = groups(panel)
    assert found["Order of horizons"][0].text(1) == "passed"
    assert "4.50 to 9.00 m" in found["Order of horizons"][0].text(4)
    assert "91 %" in found["Away from the data"][0].text(4)
    assert found["STEP file read back"][0].text(0) == "a.step"
    assert len(found["Notes"]) == len(fitted().accuracy.notes)


def test_long_words_are_broken_into_lines_and_not_cut(panel, qtbot):
    words = "no residual is beyond the interior tolerance, where the fit stops refining, so that their law is cut off"
    check = Check("normality", None, 0, 0.1, "", words)
    panel.show_surface(changed(checks=(check,)))
    row = groups(panel)["Surface"][1]
    heights = {}
    for width in (1600, 700):
        panel.resize(width, 500)
        qtbot.wait(20)
        heights[width] = panel.tree.visualItemRect(row).height()
        shown, line = panel.tree.columnWidth(4), panel.tree.fontMetrics()
        assert heights[width] // line.height() >= line.horizontalAdvance(words) / shown
    assert heights[700] > 1.5 * heights[1600]


def test_copy_gives_every_row(panel):
    panel.show_surface(fitted())
    panel.copy()
    lines = QApplication.clipboard().text().splitlines()
    assert lines[0].split("\t")[:4] == ["Check", "Result", "Value", "Limit"]
    assert len(lines) == 1 + sum(len(rows) for rows in groups(panel).values())
