"""The plan: corners dragged with the mouse become the core that the next fit takes."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from panel_samples import FAULT, WITH_PERIPHERY, cloud, fitted, sample_site
from PySide6.QtCore import QPoint, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QImage, QPainter
from PySide6.QtTest import QTest

import geofit
from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.geometry.frame import map_frame
from geofit.gui.panels.core_box import CoreBox
from geofit.gui.panels.plan import PlanPanel
from geofit.gui.panels.plan_painter import draw_labels, round_length
from geofit.gui.panels.plan_view import PERIPHERY
from geofit.report.style import CORE


@pytest.fixture
def panel(qtbot):
    panel = PlanPanel()
    qtbot.addWidget(panel)
    panel.resize(700, 600)
    panel.show()
    qtbot.waitExposed(panel)
    return panel


@pytest.fixture
def shown(panel):
    panel.show_surface(sample_site(), WITH_PERIPHERY, fitted(), fitted().settings)
    return panel


def drag(view, start, end):
    begin, stop = (QPoint(*map(round, place)) for place in (start, end))
    QTest.mousePress(view, Qt.MouseButton.LeftButton, pos=begin)
    for share in (0.3, 0.7, 1.0):
        QTest.mouseMove(
            view,
            begin + QPoint(*(round(share * (b - a)) for a, b in zip(begin.toTuple(), stop.toTuple(), strict=True))),
        )
    QTest.mouseRelease(view, Qt.MouseButton.LeftButton, pos=stop)


def corner(view, k):
    return view.to_widget(view.box.corners[k])


def metres_a_pixel(view):
    return np.ptp([view.to_map(QPointF(x, 0))[0] for x in (0, 1)])


def by(place, x, y):
    return place + np.array([x, y])


def click(qtbot, button):
    qtbot.mouseClick(button, Qt.MouseButton.LeftButton)


def test_without_a_horizon_it_says_so(panel):
    assert "No horizon chosen" in str(panel.pages.text)


def test_the_partition_is_shown_with_its_reason(shown):
    partition = fitted().partition
    assert shown.reason.text() == str(partition.reason)
    assert np.allclose(np.sort(shown.view.box.corners, axis=0), np.sort(partition.corners, axis=0), atol=1e-6)
    assert shown.buttons["auto"].isChecked()
    assert not shown.buttons["use"].isEnabled()


def test_scales_are_equal_and_north_is_up(shown):
    view = shown.view
    a, b, c = view.to_widget(np.array([[0.0, 0.0], [100.0, 0.0], [0.0, 100.0]]) + fitted().points.xyz[0, :2])
    assert b[0] - a[0] == pytest.approx(a[1] - c[1])
    assert b[0] > a[0]
    place = QPointF(123.0, 77.0)
    assert view.to_widget(view.to_map(place)).tolist() == pytest.approx([123.0, 77.0], abs=1e-6)


def test_a_dragged_corner_is_taken_by_use_only(shown, qtbot):
    view = shown.view
    before = view.box.corners
    with qtbot.assertNotEmitted(shown.core_changed):
        drag(view, corner(view, 2), by(corner(view, 2), 30, -40))
    assert "Press Use" in shown.reason.text()
    with qtbot.waitSignal(shown.core_changed) as told:
        click(qtbot, shown.buttons["use"])
    name, corners = told.args
    assert name == WITH_PERIPHERY
    assert np.allclose(corners[0], before[0], atol=1e-6)
    step = view.to_map(QPointF(30, -40)) - view.to_map(QPointF(0, 0))
    assert np.allclose(np.array(corners[2]) - before[2], step, atol=2 * metres_a_pixel(view))
    assert FitSettings(core=corners).core == corners


@pytest.mark.parametrize(("k", "shift", "widened"), [(2, (0, -60), True), (0, (40, -30), False)])
def test_the_fit_takes_what_was_counted(shown, qtbot, k, shift, widened):
    view = shown.view
    drag(view, corner(view, k), by(corner(view, k), *shift))
    counted = re.search(r"(\d+) points inside, (\d+) outside", shown.reason.text()).group()
    assert ("widens" in shown.reason.text()) is widened
    with qtbot.waitSignal(shown.core_changed) as told:
        shown.use()
    site = sample_site()
    again = geofit.fit_horizon(
        site.horizons[WITH_PERIPHERY], FitSettings(core=told.args[1]), boundary=site.boundary, name=WITH_PERIPHERY
    )
    assert counted in str(again.partition.reason)


def test_drags_are_undone_one_by_one(shown, qtbot):
    view = shown.view
    first = view.box.corners
    drag(view, corner(view, 0), by(corner(view, 0), -20, 15))
    second = view.box.corners
    drag(view, view.to_widget(second.mean(axis=0)), by(view.to_widget(second.mean(axis=0)), 15, 10))
    assert not np.allclose(view.box.corners, second)
    click(qtbot, shown.buttons["undo"])
    assert np.allclose(view.box.corners, second)
    click(qtbot, shown.buttons["undo"])
    assert np.allclose(view.box.corners, first)
    assert not shown.buttons["undo"].isEnabled()
    assert shown.reason.text() == str(fitted().partition.reason)


@pytest.mark.parametrize("word", ["all", "none"])
def test_words_are_told_at_once(shown, qtbot, word):
    with qtbot.waitSignal(shown.core_changed) as told:
        click(qtbot, shown.buttons[word])
    assert told.args == [WITH_PERIPHERY, word]
    assert [key for key in ("auto", "all", "none") if shown.buttons[key].isChecked()] == [word]


def test_a_rectangle_is_drawn_before_the_first_fit(panel, qtbot):
    panel.show_surface(sample_site(), "W", None, FitSettings())
    assert panel.view.box is None
    assert "Not fitted yet" in panel.reason.text()
    click(qtbot, panel.buttons["draw"])
    middle = np.array([panel.view.width(), panel.view.height()]) / 2
    drag(panel.view, middle - 60, middle + 50)
    assert not panel.buttons["draw"].isChecked()
    with qtbot.waitSignal(panel.core_changed) as told:
        click(qtbot, panel.buttons["use"])
    assert len(told.args[1]) == 4


def test_dragging_beside_the_rectangle_moves_the_plan(shown, qtbot):
    view = shown.view
    before = view.to_map(QPointF(10, 10))
    with qtbot.assertNotEmitted(view.box_dragged):
        drag(view, (12, 200), (52, 230))
    shift = view.to_map(QPointF(10, 10)) - before
    assert shift[0] == pytest.approx(-40 * metres_a_pixel(view), rel=1e-6)
    assert shift[1] == pytest.approx(30 * metres_a_pixel(view), rel=1e-6)
    view.mouseDoubleClickEvent(None)
    assert np.allclose(view.to_map(QPointF(10, 10)), before)


def test_zoom_keeps_the_place_under_the_pointer(shown):
    place = QPointF(200, 150)
    before = shown.view.to_map(place)
    shown.view.zoom(1.7, place)
    assert np.allclose(shown.view.to_map(place), before, atol=1e-6)


def test_a_fault_over_its_plane_has_no_rectangle_to_drag(panel):
    panel.show_surface(sample_site(), FAULT, fitted(FAULT), fitted(FAULT).settings)
    assert panel.view.locked
    assert not panel.buttons["draw"].isEnabled()
    assert "fitted over the map" in panel.reason.text()


def test_a_cloud_is_painted_in_both_colours(panel):
    surface = cloud(20_000)
    site = replace(sample_site(), horizons={"cloud": surface.points}, boundary=None, sections=(), holes=())
    panel.show_surface(site, "cloud", surface.with_(patches=()), surface.settings)
    image = panel.view.grab().toImage()
    colours = {image.pixelColor(x, y).name() for x in range(0, image.width(), 3) for y in range(0, image.height(), 3)}
    assert {CORE, PERIPHERY} <= colours


def test_a_rectangle_keeps_its_directions():
    frame = map_frame(PointSet([[0.0, 0.0, 0.0], [100.0, 100.0, 1.0]]), np.radians(60))
    box = CoreBox.around(frame, [[10, 10], [60, 20], [40, 70], [0, 30]])
    assert box.holds(np.array([[10.0, 10.0], [60.0, 20.0], [40.0, 70.0], [0.0, 30.0]])).all()
    dragged = box.with_corner(2, [200.0, 150.0])
    assert np.allclose(dragged.corners[2], [200.0, 150.0])
    assert np.allclose(dragged.corners[0], box.corners[0])
    sides = np.diff(dragged.corners, axis=0)
    assert sides[0] @ sides[1] == pytest.approx(0, abs=1e-6)
    folded = box.with_corner(2, box.corners[0] - 500)
    assert min(folded.size) >= 1.0
    assert np.allclose(box.moved([3.0, -4.0]).corners - box.corners, [3.0, -4.0])


def test_scale_bars_have_round_lengths():
    assert [round_length(x) for x in (0.03, 1.0, 19.9, 20.0, 999.0)] == [0.02, 1.0, 10.0, 20.0, 500.0]


def lettered(named, busy=(), size=(400, 300), paper="white", title=""):
    """Write names over a black picture; return where they stand, and the picture."""
    image = QImage(*size, QImage.Format.Format_RGB32)
    image.fill(QColor("black"))
    painter = QPainter(image)
    painter.setPen(QColor("red"))
    places = [(name, np.array(place, float)) for name, place in named]
    crowd = np.array(busy, float).reshape(-1, 2)
    written = draw_labels(painter, places, crowd, image.rect(), QColor(paper), title)
    painter.end()
    return written, image


def test_every_name_with_room_is_written():
    named = [(f"ZK{i}{j}", (60 * i, 40 * j)) for i in range(1, 6) for j in range(1, 6)]
    assert sorted(name for name, _ in lettered(named)[0]) == sorted(name for name, _ in named)


def test_names_never_cover_each_other_and_stay_inside():
    rng = np.random.default_rng(3)
    named = [(f"ZK{k}", place) for k, place in enumerate(rng.uniform(0, 300, (200, 2)))]
    written, _ = lettered(named, title="T2-T1")
    boxes = [QRectF(*box) for _, box in written]
    assert 20 < len(boxes) < 200
    assert not any(a.intersects(b) for k, a in enumerate(boxes) for b in boxes[:k])
    assert all(QRectF(0, 0, 400, 300).contains(box) for box in boxes)
    # The corners of the legend, north and the title are free.
    assert not any(box.intersects(QRectF(0, 260, 400, 40)) or box.intersects(QRectF(360, 0, 40, 52)) for box in boxes)


def test_a_name_stands_where_it_covers_no_points():
    crowd = [(x, y) for x in range(205, 260, 4) for y in range(100, 200, 4)]
    ((_, (left, _, width, _)),), _ = lettered([("ZK1", (200, 150))], crowd)
    assert left + width < 200
    everywhere = [(x, y) for x in range(0, 400, 3) for y in range(0, 300, 3)]
    assert lettered([("ZK1", (200, 150))], everywhere)[0] == []


def test_letters_have_a_rim_of_paper():
    ((_, box),), image = lettered([("ZK1", (200, 150))])
    colours = {
        image.pixelColor(x, y).name()
        for x in range(int(box[0]), int(box[0] + box[2]))
        for y in range(int(box[1]), int(box[1] + box[3]))
    }
    assert {"#ffffff", "#ff0000"} <= colours


def test_it_fits_a_narrow_dock(shown):
    assert shown.minimumSizeHint().width() <= 260
