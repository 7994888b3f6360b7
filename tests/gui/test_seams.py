"""The seam table: gaps and angles, coloured as in 3D, worst ones marked by shape."""

from __future__ import annotations

from dataclasses import replace

import pytest
from panel_samples import fitted

from geofit.data.accuracy import Seam
from geofit.data.settings import FitSettings
from geofit.gui.panels.seams import SeamTable, seam_holds
from geofit.gui.translate import speak, translated


@pytest.fixture
def panel(qtbot):
    panel = SeamTable()
    qtbot.addWidget(panel)
    panel.show()
    return panel


def test_empty_and_single_patches_say_so(panel):
    assert "press Fit" in str(panel.pages.text)
    panel.show_surface(fitted().with_(accuracy=replace(fitted().accuracy, seams=())))
    assert "no seams" in str(panel.pages.text)


def test_every_seam_has_a_row_and_tells_its_number(panel, qtbot):
    seams = fitted().accuracy.seams
    panel.show_surface(fitted())
    assert panel.table.rows.rowCount() == len(seams) == 12
    with qtbot.waitSignal(panel.seam_chosen) as told:
        panel.table.selectRow(5)
    assert told.args == [5]
    with qtbot.assertNotEmitted(panel.seam_chosen):
        panel.choose(2)
    assert panel.table.current == 2


def test_an_open_seam_is_marked_by_another_shape(panel):
    seams = (Seam("core", "west", 0.004, 2.0), Seam("core", "east", 0.0, 0.0))
    panel.show_surface(fitted().with_(accuracy=replace(fitted().accuracy, seams=seams)))
    gap = panel.table.rows.columns[2]
    assert gap.text(0) == "4.000000"
    pictures = [gap.icons(i).pixmap(16).toImage() for i in (0, 1)]
    assert pictures[0] != pictures[1]


def test_the_limits_of_a_seam():
    broken = Seam("a", "b", 0.0, 3.0)
    assert seam_holds(broken, FitSettings()) == (True, False)
    assert seam_holds(broken, FitSettings(seam="position")) == (True, None)
    assert seam_holds(Seam("a", "b", 1e-3, 0.0), FitSettings())[0] is False


def test_patches_are_named_in_the_language_of_the_windows(panel):
    speak("zh_CN")
    try:
        panel.show_surface(fitted())
        assert panel.table.rows.columns[0].text(0) == translated("core") != "core"
    finally:
        speak("en")
