"""The badge tells pass, fail, stale and empty by word and by shape."""

from __future__ import annotations

from dataclasses import replace

import pytest
from panel_samples import failing, fitted, prediction
from PySide6.QtWidgets import QLabel, QVBoxLayout, QWidget

from geofit.data.prediction import SourceOffset
from geofit.data.verdict import verdict_of
from geofit.gui.panels.verdict import VerdictBadge


@pytest.fixture
def badge(qtbot):
    badge = VerdictBadge()
    qtbot.addWidget(badge)
    badge.resize(260, 110)
    badge.show()
    return badge


def grey(badge):
    """The badge as a black-and-white print has it."""
    image = badge.grab().toImage().convertToFormat(badge.grab().toImage().Format.Format_Grayscale8)
    return bytes(image.constBits())


def test_empty(badge):
    badge.show_accuracy(None, True)
    assert "No surface yet" in str(badge.text)
    assert "Older" not in str(badge.text)


@pytest.mark.parametrize("width", [230, 320])
def test_a_long_text_is_not_cut_in_a_narrow_dock(qtbot, width):
    accuracy, dock = fitted().accuracy, QWidget()
    found = replace(prediction(accuracy.n), offsets=(SourceOffset("geophysics", "borehole", 200, 6.3, 0.7),))
    badge, below = VerdictBadge(), QWidget()
    column = QVBoxLayout(dock)
    column.addWidget(badge)
    column.addWidget(below, 1)
    qtbot.addWidget(dock)
    dock.resize(width, 700)
    dock.show()
    qtbot.waitExposed(dock)
    badge.show_accuracy(accuracy, verdict=verdict_of(accuracy, found))
    qtbot.waitUntil(lambda: badge.height() > 150)
    assert "above those of kind 'borehole'" in badge.text
    for label in badge.findChildren(QLabel):
        if label.isVisible():
            assert label.height() >= label.heightForWidth(label.width()), label.text()
    assert below.height() > 300, "the badge takes no more than it needs"


def test_the_figures_behind_the_verdict(badge):
    a = fitted().accuracy
    badge.show_accuracy(a)
    assert badge.text.splitlines()[0] == "PASS"
    assert "σ 0.0" in str(badge.text)
    assert "ε 0.5 m" in str(badge.text)
    assert f"of {a.n} points" in str(badge.text)
    assert f"{a.over['interior_tolerance'].count} over 0.1 m" in str(badge.text)
    badge.show_accuracy(failing(fitted()).accuracy)
    assert badge.text.splitlines()[0] == "FAIL"
    assert "σ 0.610 m ≥ ε 0.5 m" in str(badge.text)
    assert badge.accessibleName().startswith("FAIL")


def test_four_states_differ_without_colour(badge):
    pictures = []
    for accuracy, stale in (
        (None, False),
        (fitted().accuracy, False),
        (failing(fitted()).accuracy, False),
        (fitted().accuracy, True),
    ):
        badge.show_accuracy(accuracy, stale)
        mark = badge.mark.grab().toImage()
        pictures.append((bytes(mark.convertToFormat(mark.Format.Format_Grayscale8).constBits()), grey(badge)))
    assert len({mark for mark, _ in pictures}) == 3
    assert len({whole for _, whole in pictures}) == 4


def test_stale_says_so(badge):
    badge.show_accuracy(fitted().accuracy, True)
    assert "press Fit" in str(badge.text)
    assert badge.minimumSizeHint().width() <= 260
