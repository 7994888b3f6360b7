"""Histogram and normal plot: what they count, and that they follow theme and width."""

from __future__ import annotations

import pytest
from panel_samples import fitted
from PySide6.QtGui import QColor, QPalette

from geofit.gui.panels.histogram import HistogramPanel


@pytest.fixture
def panel(qtbot):
    panel = HistogramPanel()
    qtbot.addWidget(panel)
    panel.resize(900, 300)
    panel.show()
    return panel


def test_empty_and_exact_say_so(panel):
    assert "press Fit" in panel.pages.text
    exact = fitted().with_(core=fitted().points.row >= 0)
    panel.show_surface(exact)
    assert "met exactly" in panel.pages.text


def test_every_approximated_point_is_counted(panel):
    panel.show_surface(fitted())
    panel.canvas.draw()
    bars, normal = panel.canvas.figure.axes
    loose = int((~fitted().core).sum())
    assert sum(bar.get_height() for bar in bars.patches) == loose
    assert max(len(line.get_xdata()) for line in normal.lines) == loose
    words = [text.get_text() for text in bars.get_legend().get_texts()]
    assert any("interior tolerance 0.1 m" in word for word in words)
    assert any("0.5 m" in word for word in words)


def test_narrow_panels_stack_the_pictures(panel, qtbot):
    panel.show_surface(fitted())
    panel.resize(260, 500)
    qtbot.waitUntil(lambda: panel.canvas.narrow)
    panel.canvas.draw()
    top, below = panel.canvas.figure.axes
    assert top.get_position().y0 > below.get_position().y1
    renderer = panel.canvas.get_renderer()
    for axes in (top, below):
        box = axes.get_tightbbox(renderer)
        assert box.x0 >= 0
        assert box.x1 <= panel.canvas.figure.bbox.width + 1


def test_the_theme_reaches_the_figure(panel, qtbot):
    panel.show_surface(fitted())
    dark = QPalette(QColor("#22282e"))
    dark.setColor(QPalette.ColorRole.Base, QColor("#1a1f24"))
    dark.setColor(QPalette.ColorRole.Text, QColor("#e3e8ed"))
    panel.setPalette(dark)
    panel.canvas.draw()
    from matplotlib.colors import to_hex

    assert to_hex(panel.canvas.figure.get_facecolor()) == "#1a1f24"
    assert to_hex(panel.canvas.figure.axes[0].get_legend().get_texts()[0].get_color()) == "#e3e8ed"
