"""The fit panel: every setting, checked while it is typed, applied, reset, stale."""

from __future__ import annotations

from dataclasses import fields

import pytest
from panel_samples import fitted
from PySide6.QtCore import Qt

from geofit.data.settings import FitSettings
from geofit.gui.panels.fit_panel import FitPanel

CORNERS = ((0.0, 0.0), (10.0, 0.0), (10.0, 20.0), (0.0, 20.0))


@pytest.fixture
def panel(qtbot):
    panel = FitPanel()
    qtbot.addWidget(panel)
    panel.resize(260, 700)
    panel.show()
    panel.show_settings("T3-T2", FitSettings())
    return panel


def click(qtbot, button):
    qtbot.mouseClick(button, Qt.MouseButton.LeftButton)


def type_in(qtbot, panel, name, text):
    edit = panel.fields[name].edit
    edit.selectAll()
    qtbot.keyClicks(edit, text)


def test_without_a_horizon_it_says_so(panel):
    panel.show_settings("", FitSettings())
    assert "No horizon chosen" in str(panel.pages.text)


@pytest.mark.parametrize(
    "settings",
    [
        FitSettings(),
        FitSettings(
            epsilon=0.25, interior_tolerance=0.05, boundary_tolerance=0.002, across="linear", seam="position",
            core=CORNERS, frame="best-plane", smoothing=0.3, robust=True, max_iterations=7, max_control_points=900,
            coincidence_distance=0.2,
        ),
        FitSettings(core="none", frame="sections", epsilon=1e-7),
    ],
)  # fmt: skip
def test_every_setting_goes_in_and_comes_out_again(panel, settings):
    panel.show_settings("W", settings)
    assert set(panel.fields) == {field.name for field in fields(FitSettings)}
    assert panel.edited() == settings
    assert not panel.apply_button.isEnabled()


def test_a_number_of_many_digits_is_not_rounded(panel):
    settings = FitSettings(epsilon=1 / 3, interior_tolerance=0.12345678, smoothing=1e-7 / 3)
    panel.show_settings("W", settings)
    assert panel.edited() == settings
    assert "Not applied" not in panel.banner.text


def test_what_is_written_stays_when_something_else_ends(panel, qtbot):
    """A fit or an examination in the background shows the horizon anew when it ends."""
    type_in(qtbot, panel, "epsilon", "0.3")
    panel.show_settings("T3-T2", FitSettings(), True)
    assert panel.edited() == FitSettings(epsilon=0.3)
    assert panel.apply_button.isEnabled()
    # Another setting of the horizon came from elsewhere, as its core does from the plan.
    panel.show_settings("T3-T2", FitSettings(core="all"))
    assert panel.edited() == FitSettings(epsilon=0.3, core="all")
    click(qtbot, panel.apply_button)
    # Undone, there is nothing written any more.
    panel.show_settings("T3-T2", FitSettings(core="all"))
    assert panel.edited() == FitSettings(core="all")
    type_in(qtbot, panel, "epsilon", "0.7")
    panel.show_settings("W", FitSettings())
    assert panel.edited() == FitSettings()


def test_a_drawn_core_is_named_by_its_corners(panel):
    panel.show_settings("W", FitSettings(core=CORNERS))
    assert panel.fields["core"].box.currentText() == "Drawn, 4 corners"


def test_the_drawn_core_of_another_horizon_is_forgotten(panel):
    panel.show_settings("W", FitSettings(core=CORNERS))
    panel.show_settings("W", FitSettings(core="all"))
    assert panel.fields["core"].box.count() == 4
    panel.show_settings("F1", FitSettings())
    assert panel.fields["core"].box.count() == 3


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("epsilon", "-1", "above 0"),
        ("epsilon", "abc", "'abc'"),
        ("epsilon", "0,5", "0.5, not 0,5"),
        ("max_iterations", "2.5", "whole number"),
        ("coincidence_distance", "", "above 0"),
        ("interior_tolerance", "nan", "finite"),
    ],
)
def test_an_error_stands_beside_its_field_while_it_is_typed(panel, qtbot, name, text, words):
    edit = panel.fields[name].edit
    edit.clear()
    edit.setFocus()
    qtbot.keyClicks(edit, text or "1")
    if not text:
        qtbot.keyClick(edit, Qt.Key.Key_Backspace)
    assert words in panel.errors[name].text()
    assert panel.errors[name].isVisible()
    assert not any(label.isVisible() for other, label in panel.errors.items() if other != name)
    assert not panel.fit_button.isEnabled()
    assert not panel.apply_button.isEnabled()
    click(qtbot, panel.reset_button)
    assert not panel.errors[name].isVisible()
    assert panel.edited() == FitSettings()


def test_apply_tells_the_new_settings_once(panel, qtbot):
    type_in(qtbot, panel, "epsilon", "0.3")
    assert "Not applied" in str(panel.banner.text)
    with qtbot.waitSignal(panel.applied) as told:
        click(qtbot, panel.apply_button)
    assert told.args == ["T3-T2", FitSettings(epsilon=0.3)]
    assert not panel.apply_button.isEnabled()
    assert str(panel.banner.text) == ""


def test_fit_applies_first(panel, qtbot):
    heard = []
    panel.applied.connect(lambda name, settings: heard.append(settings.seam))
    panel.fit_requested.connect(heard.append)
    box = panel.fields["seam"].box
    box.setFocus()
    qtbot.keyClick(box, Qt.Key.Key_Down)
    click(qtbot, panel.fit_button)
    click(qtbot, panel.fit_button)
    assert heard == ["position", "T3-T2", "T3-T2"]


def test_fit_all(panel, qtbot):
    with qtbot.waitSignal(panel.fit_all_requested):
        click(qtbot, panel.all_button)


def test_stale_results_raise_the_banner(panel):
    panel.show_settings("T3-T2", fitted().settings, True)
    assert "older than its data or settings" in str(panel.banner.text)
    assert panel.banner.isVisible()
    panel.show_settings("T3-T2", fitted().settings, False)
    assert not panel.banner.isVisible()


def test_a_fixed_smoothing_starts_with_a_number(panel, qtbot):
    box = panel.fields["smoothing"].box
    box.setFocus()
    qtbot.keyClick(box, Qt.Key.Key_Down)
    assert panel.edited().smoothing == 1
    qtbot.keyClick(box, Qt.Key.Key_Up)
    assert panel.edited().smoothing == "auto"


def test_every_field_says_what_it_does_and_fits_a_dock(panel):
    for name, field in panel.fields.items():
        target = field.focusProxy()
        assert len(field.toolTip()) > 40, name
        assert target.accessibleName()
        assert target.accessibleDescription() == field.toolTip()
    assert panel.minimumSizeHint().width() <= 260
