"""The project tree: what it lists, marks and tells."""

from __future__ import annotations

import pytest
from panel_samples import FAULT, WITH_PERIPHERY, failing, fitted, sample_site
from PySide6.QtCore import Qt

from geofit.gui.panels.project_tree import ProjectTree
from geofit.gui.view3d.layers import Layers


@pytest.fixture
def tree(qtbot):
    tree = ProjectTree(Layers())
    qtbot.addWidget(tree)
    tree.resize(260, 500)
    tree.show()
    return tree


def heads(tree):
    return {head.target[1]: head for head in tree.items.rows}


def go(tree, item):
    tree.view.setCurrentIndex(tree.shown.mapFromSource(tree.items.index_of(item)))


def test_no_site(tree):
    assert "No site open" in str(tree.pages.text)


def test_everything_of_the_site_is_listed(tree):
    site = sample_site()
    tree.show_site(site, {WITH_PERIPHERY: fitted()})
    found = heads(tree)
    assert [item.text for item in found["horizons"].rows] == list(site.horizons)
    assert len(found["borehole"].rows) == sum(hole.kind == "borehole" for hole in site.holes)
    assert len(found["adit"].rows) == sum(hole.kind == "adit" for hole in site.holes)
    assert len(found["sections"].rows) == len(site.sections)
    assert found["borehole"].rows[0].text.startswith("孔")
    names = [item.text for item in found["sections"].rows]
    assert names.index("C8") < names.index("L1")


def test_points_are_counted_by_horizon_and_patch(tree):
    tree.show_site(sample_site(), {WITH_PERIPHERY: fitted()})
    horizon = heads(tree)["horizons"].rows[0]
    assert horizon.count == len(fitted().points)
    assert f"Points: {horizon.count}" in tree.items.index_of(horizon).data(Qt.ItemDataRole.ToolTipRole)
    counts = {row.text: row.count for row in horizon.rows}
    names = fitted().accuracy.patch.tolist()
    assert counts == {patch.name: names.count(patch.name) for patch in fitted().patches}


def test_the_verdict_is_marked(tree):
    surfaces = {WITH_PERIPHERY: fitted(), "W": failing(fitted()), "T2-T1": fitted()}
    tree.show_site(sample_site(), surfaces, {"T2-T1"})
    by_name = {item.target[1]: item for item in heads(tree)["horizons"].rows}
    pictures = {name: by_name[name].mark.pixmap(16).toImage() for name in (WITH_PERIPHERY, "W", "T2-T1", FAULT)}
    assert all(a == b or pictures[a] != pictures[b] for a in pictures for b in pictures)
    assert "PASS" in by_name[WITH_PERIPHERY].words
    assert "FAIL" in by_name["W"].words
    assert "Older than its data" in by_name["T2-T1"].aloud
    assert "not fitted" in by_name[FAULT].words


def test_what_is_chosen_is_told(tree, qtbot):
    tree.show_site(sample_site(), {WITH_PERIPHERY: fitted()})
    tree.show_reports(["/reports/报告.pdf"])
    found = heads(tree)
    horizon = found["horizons"].rows[0]
    for item, signal, args in (
        (horizon, tree.horizon_chosen, [WITH_PERIPHERY]),
        (horizon.rows[0], tree.patch_chosen, [WITH_PERIPHERY, fitted().patches[0].name]),
        (found["borehole"].rows[2], tree.hole_chosen, [found["borehole"].rows[2].text]),
        (found["sections"].rows[1], tree.section_chosen, ["C2"]),
        (found["reports"].rows[0], tree.report_chosen, ["/reports/报告.pdf"]),
    ):
        with qtbot.waitSignal(signal) as told:
            go(tree, item)
        assert told.args == args


def test_showing_again_keeps_the_choice_and_tells_nobody(tree, qtbot):
    tree.show_site(sample_site(), {})
    tree.choose_horizon("W")
    with qtbot.assertNotEmitted(tree.horizon_chosen):
        tree.show_site(sample_site(), {"W": fitted()}, {"W"})
        tree.choose_hole(sample_site().holes[0].name)
        tree.choose_horizon("W")
    assert tree.items.row_of(tree.shown.mapToSource(tree.view.currentIndex())).target == ("horizon", "W")


def test_the_filter_finds_chinese_names(tree):
    tree.show_site(sample_site(), {})
    wanted = sample_site().holes[4].name
    tree.search.setText(wanted)
    assert tree.shown.rowCount() == 1
    head = tree.shown.index(0, 0)
    assert [tree.shown.index(k, 0, head).data() for k in range(tree.shown.rowCount(head))] == [wanted]
    tree.search.clear()
    assert tree.shown.rowCount() == tree.items.rowCount()
