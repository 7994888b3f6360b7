"""The flow layout breaks into lines, and cuts nothing in a narrow dock."""

from __future__ import annotations

import panel_samples  # noqa: F401 - skips where PySide6 is missing
from PySide6.QtWidgets import QLabel, QLineEdit, QWidget

from geofit.gui.panels.flow import FlowLayout


def test_lines_break_where_the_width_ends(qtbot):
    box = QWidget()
    qtbot.addWidget(box)
    flow = FlowLayout(box)
    parts = [QLabel("one two three"), QLineEdit(), QLabel("four five six"), QLabel("seven")]
    for part in parts:
        flow.addWidget(part)
    box.resize(600, 80)
    box.show()
    middles = [part.geometry().center().y() for part in parts]
    assert max(middles) - min(middles) <= 1  # a pixel, where heights are even and odd
    assert parts[-1].geometry().right() == 599
    assert flow.heightForWidth(150) > flow.heightForWidth(600)
    box.resize(150, 200)
    flow.activate()
    assert all(part.x() >= 0 and part.geometry().right() < 150 for part in parts)
    boxes = [part.geometry() for part in parts]
    assert not any(a.intersects(b) for i, a in enumerate(boxes) for b in boxes[i + 1 :])
