"""The adjust panel: a control point or a data point, what it moves, what holds it, and the effect."""

from __future__ import annotations

import numpy as np
import pytest
from panel_samples import FAULT, failing, fitted
from PySide6.QtCore import Qt

from geofit.fitting.edit import acted_on, adjust, support
from geofit.gui.panels.adjust import AdjustPanel
from geofit.project.provenance import Row


@pytest.fixture
def panel(qtbot):
    panel = AdjustPanel()
    qtbot.addWidget(panel)
    panel.resize(260, 600)
    panel.show()
    return panel


def click(qtbot, button):
    qtbot.mouseClick(button, Qt.MouseButton.LeftButton)


def inside(plane, box):
    u0, u1, v0, v1 = box
    return (plane[:, 0] > u0) & (plane[:, 0] < u1) & (plane[:, 1] > v0) & (plane[:, 1] < v1)


def free_control(surface):
    """A control point that acts on points, none of which is exact."""
    plane = surface.model.problem.parametrization.plane
    for patch in surface.patches[1:]:
        for i in range(2, patch.control.shape[0]):
            u0, u1, v0, v1 = support(surface, patch.name, i, 2)
            # At its edges a control point hardly acts.
            middle = inside(plane, ((2 * u0 + u1) / 3, (u0 + 2 * u1) / 3, (2 * v0 + v1) / 3, (v0 + 2 * v1) / 3))
            if middle.any() and not (inside(plane, (u0, u1, v0, v1)) & surface.core).any():
                return patch, i, 2
    raise AssertionError("every control point is held")


def test_without_a_surface_or_a_net_it_says_so(panel):
    assert "press Fit" in str(panel.pages.text)
    panel.show_surface(fitted().with_(model=None))
    assert "read from a file" in str(panel.pages.text)


def test_a_picked_control_point_shows_its_place(panel, qtbot):
    patch, i, j = free_control(fitted())
    with qtbot.assertNotEmitted(panel.control_chosen):
        panel.show_surface(fitted())
        panel.choose_control(patch.name, i, j)
    x, y, z = patch.control[i, j] + fitted().origin
    assert f"At ({x:.1f}, {y:.1f}, {z:.2f})" in panel.control.about.text()
    assert panel.control.z.value() == pytest.approx(z, abs=1e-3)
    assert "nowhere else" in panel.control.about.text()
    assert not panel.apply_button.isEnabled()


def test_move_and_elevation_follow_each_other(panel, qtbot):
    panel.show_surface(fitted())
    patch, i, j = free_control(fitted())
    panel.choose_control(patch.name, i, j)
    z = panel.control.z.value()
    click(qtbot, panel.control.steps[3])
    click(qtbot, panel.control.steps[1])
    assert panel.control.dz.value() == pytest.approx(0.9)
    assert panel.control.z.value() == pytest.approx(z + 0.9, abs=2e-3)
    panel.control.z.setValue(z - 2)
    assert panel.control.dz.value() == pytest.approx(-2, abs=2e-3)
    with qtbot.waitSignal(panel.adjust_requested) as told:
        click(qtbot, panel.apply_button)
    assert told.args[:3] == [patch.name, i, j]
    assert told.args[3] == pytest.approx(-2, abs=2e-3)


def test_the_effect_is_asked_for_after_a_pause_and_shown(panel, qtbot):
    surface = fitted()
    panel.show_surface(surface)
    patch, i, j = free_control(surface)
    panel.choose_control(patch.name, i, j)
    with qtbot.waitSignal(panel.adjust_wanted, timeout=2000) as told:
        panel.control.dz.setValue(5.0)
    changed = adjust(surface, *told.args)
    panel.show_effect(surface.accuracy, changed.accuracy)
    cells = [[label.text() for label in row] for row in panel.effect.cells]
    assert cells[1][0] == "σ, m"
    assert cells[1][1] != cells[1][2]
    panel.show_effect(surface.accuracy, failing(surface).accuracy)
    assert panel.effect.words.text() == "PASS → FAIL"


def test_exact_points_hold_a_control_point_and_it_is_said(panel):
    surface = fitted()
    panel.show_surface(surface)
    row, columns = surface.patches[0].control.shape[0] // 2, surface.patches[0].control.shape[1]
    column = next(j for j in range(columns) if acted_on(surface, "core", row, j)[1].any())
    panel.choose_control("core", row, column)
    assert "interpolated exactly" in panel.control.about.text()
    assert not panel.control.dz.isEnabled()
    assert not panel.apply_button.isEnabled()


def test_what_the_panel_lets_through_the_fit_takes(panel, qtbot):
    """The panel's word on held control points agrees with what an adjustment does."""
    surface = fitted()
    panel.show_surface(surface)
    free = 0
    for patch in surface.patches[:6]:
        rows, columns = patch.control.shape[:2]
        for i, j in ((rows // 2, columns // 2), (rows - 1, 1)):
            panel.choose_control(patch.name, i, j)
            if panel.control.dz.isEnabled():
                free += 1
                assert adjust(surface, patch.name, i, j, 0.1).accuracy is not None
    assert free >= 3


def test_boxes_choose_a_control_point(panel, qtbot):
    panel.show_surface(fitted())
    with qtbot.waitSignal(panel.control_chosen) as told:
        panel.control.i.stepUp()
    assert told.args == [fitted().patches[0].name, 1, 0]
    assert panel.control.i.maximum() == fitted().patches[0].control.shape[0] - 1


def test_a_data_point_is_pulled_by_a_share(panel, qtbot):
    surface = fitted()
    panel.show_surface(surface)
    worst = surface.accuracy.worst[0]
    panel.choose_point(worst)
    assert str(surface.points.describe(worst)) in panel.point.about.text()
    assert f"{surface.accuracy.residuals[worst]:+.3f}" in panel.point.about.text()
    with qtbot.waitSignal(panel.move_wanted, timeout=2000):
        panel.point.share.setValue(50)
    with qtbot.waitSignal(panel.move_requested) as told:
        click(qtbot, panel.apply_button)
    assert told.args == [Row.of(surface.points, worst), 0.5]
    exact = int(np.flatnonzero(surface.core)[0])
    panel.choose_point(exact)
    assert "meets this point already" in panel.point.about.text()


def test_a_new_surface_keeps_the_choice_and_drops_the_move(panel):
    surface = fitted()
    panel.show_surface(surface)
    patch, i, j = free_control(surface)
    panel.choose_control(patch.name, i, j)
    panel.control.dz.setValue(0.5)
    changed = adjust(surface, patch.name, i, j, 0.5)
    panel.show_surface(changed)
    assert (
        panel.control.patch.currentText(),
        panel.control.i.value(),
        panel.control.j.value(),
        panel.control.dz.value(),
    ) == (patch.name, i, j, 0.0)
    assert panel.control.z.value() == pytest.approx(patch.control[i, j, 2] + surface.origin[2] + 0.5, abs=0.3)


def figures(panel):
    return [[label.text() for label in row] for row in panel.effect.cells if row[0].isVisible()]


def test_the_effect_of_an_edit_that_was_applied_stays_until_another_surface_comes(panel):
    surface = fitted()
    panel.show_surface(surface)
    patch, i, j = free_control(surface)
    panel.choose_control(patch.name, i, j)
    panel.control.dz.setValue(5.0)
    changed = adjust(surface, patch.name, i, j, 5.0)
    panel.show_applied(surface.accuracy, changed.accuracy)
    panel.show_surface(changed)
    shown = figures(panel)
    assert shown[0][0] == "Applied"
    assert shown[1][1] != shown[1][2]
    assert not panel.apply_button.isEnabled()
    panel.show_surface(surface)
    assert figures(panel) == []


def test_the_effect_on_a_data_point_is_asked_for_as_soon_as_it_is_chosen(panel, qtbot):
    surface = fitted()
    panel.show_surface(surface)
    with qtbot.waitSignal(panel.move_wanted, timeout=2000) as told:
        panel.choose_point(surface.accuracy.worst[0])
    assert told.args == [surface.accuracy.worst[0], 1.0]
    # It is computed when the panel is shown, not while it is behind others.
    panel.hide()
    with qtbot.assertNotEmitted(panel.move_wanted, wait=600):
        panel.choose_point(surface.accuracy.worst[1])
    with qtbot.waitSignal(panel.move_wanted, timeout=2000) as told:
        panel.show()
    assert told.args == [surface.accuracy.worst[1], 1.0]


def test_a_point_that_the_surface_lacks_is_not_asked_for_again(panel):
    panel.show_surface(fitted())
    panel.choose_point(None, "picks.csv row 7 is not among the points.")
    assert panel.ways.currentWidget() is panel.point
    assert "row 7" in panel.point.about.text()
    assert not panel.apply_button.isEnabled()
    assert "control point" not in panel.effect.words.text()


def test_a_steep_fault_can_be_chosen(panel):
    panel.show_surface(fitted(FAULT))
    assert str(panel.pages.text) == ""
    assert panel.minimumSizeHint().width() <= 260
