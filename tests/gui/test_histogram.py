"""Histogram and normal plot: what they count, and that they follow theme and width."""

from __future__ import annotations

from dataclasses import replace

import pytest
from panel_samples import fitted
from PySide6.QtGui import QColor, QPalette

from geofit.gui.panels.canvas import wrapped
from geofit.gui.panels.histogram import HistogramPanel


@pytest.fixture
def panel(qtbot):
    panel = HistogramPanel()
    qtbot.addWidget(panel)
    panel.resize(900, 300)
    panel.show()
    return panel


def test_empty_and_exact_say_so(panel):
    assert "press Fit" in str(panel.pages.text)
    exact = fitted().with_(core=fitted().points.row >= 0)
    panel.show_surface(exact)
    assert "interpolated exactly" in str(panel.pages.text)


def test_every_approximated_point_is_counted(panel):
    panel.show_surface(fitted())
    panel.canvas.draw()
    bars, normal = panel.canvas.figure.axes
    loose = int((~fitted().core).sum())
    assert sum(bar.vertices[:, 1].max() for bar in bars.collections[0].get_paths()) == loose
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


def test_a_new_surface_is_drawn_into_the_same_axes(panel):
    panel.show_surface(fitted())
    panel.canvas.draw()
    axes = list(panel.canvas.figure.axes)
    before = [(len(each.lines), len(each.collections), each.get_xlim(), each.get_ylim()) for each in axes]
    wide = fitted()
    wide = wide.with_(accuracy=replace(wide.accuracy, residuals=3 * wide.accuracy.residuals))
    panel.show_surface(wide)
    panel.canvas.draw()
    assert panel.canvas.figure.axes == axes
    after = [(len(each.lines), len(each.collections)) for each in axes]
    assert [pair[:2] for pair in before] == [*after]
    assert axes[0].get_xlim()[1] == pytest.approx(3 * before[0][2][1])
    panel.show_surface(fitted())
    panel.canvas.draw()
    assert [(each.get_xlim(), each.get_ylim()) for each in axes] == [pair[2:] for pair in before]


@pytest.mark.parametrize("size", [(900, 300), (262, 520), (500, 260)])
def test_no_text_is_cut_off_or_stands_on_another(panel, qtbot, size):
    panel.show_surface(fitted())
    panel.resize(*size)
    qtbot.waitUntil(lambda: (panel.width(), panel.height()) == size)
    panel.canvas.draw()
    figure, renderer = panel.canvas.figure, panel.canvas.get_renderer()
    for axes in figure.axes:
        box = axes.get_tightbbox(renderer)
        assert 0 <= box.x0 < box.x1 <= figure.bbox.width
        assert 0 <= box.y0 < box.y1 <= figure.bbox.height
        low, high = axes.get_ylim()
        shown = [text for text in axes.get_yticklabels() if low <= text.get_position()[1] <= high]
        numbers = [text.get_window_extent(renderer) for text in shown]
        assert axes.yaxis.label.get_window_extent(renderer).x1 <= min(number.x0 for number in numbers)
        below = [text.get_window_extent(renderer) for text in axes.get_xticklabels()]
        assert axes.xaxis.label.get_window_extent(renderer).y1 <= min(number.y0 for number in below)
        legend = axes.get_legend().get_window_extent(renderer)
        drawn = axes.transData.transform([(0.0, axes.dataLim.y1)])[0, 1]
        assert legend.y0 >= drawn - 1


@pytest.mark.parametrize(
    ("text", "lines"), [("one two three", 2), ("曲面之下曲面之上", 2), ("", 1), ("a", 1), ("unbreakable-word", 1)]
)
def test_long_texts_are_broken(text, lines):
    broken = wrapped(text, 60.0, 9.0)
    assert broken.count("\n") + 1 == lines
    assert broken.replace("\n", "").replace(" ", "") == str(text).replace(" ", "")


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
