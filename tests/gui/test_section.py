"""The section panel: lines, what lies within the thickness, traces, and picking."""

from __future__ import annotations

import numpy as np
import pytest
from panel_samples import FAULT, WITH_PERIPHERY, fitted, sample_site
from PySide6.QtCore import QPoint, Qt

from geofit.gui import worker
from geofit.gui.panels.curtain import Curtain
from geofit.gui.panels.section import SectionPanel
from geofit.gui.panels.section_painter import TINT, near_points
from geofit.gui.panels.section_scale import SectionExtent, automatic, window
from geofit.prediction.bands import prediction_sd
from geofit.prediction.examine import examine

#: Triangles of the surfaces, made once for all tests.
MESHES = {}
LINE = np.array([[500800.0, 3101000.0], [501600.0, 3101100.0]])
#: A line from end to end of the site.
ACROSS = np.array([[500073.4, 3100977.7], [502211.8, 3100977.7]])


@pytest.fixture
def panel(qtbot):
    panel = SectionPanel()
    qtbot.addWidget(panel)
    panel.resize(800, 400)
    panel.meshes = MESHES
    panel.show()
    yield panel
    assert worker.finish_all()


def show(panel, qtbot, surfaces=None, **more):
    surfaces = {WITH_PERIPHERY: fitted()} if surfaces is None else surfaces
    panel.show_section(sample_site(), surfaces, more.pop("line", LINE), more.pop("thickness", 80.0), **more)
    wait(panel, qtbot)


def wait(panel, qtbot):
    qtbot.waitUntil(lambda: panel.idle, timeout=20_000)
    panel.canvas.draw()


def lines(panel):
    return {line.get_label(): line for line in panel.canvas.figure.axes[0].lines}


def test_without_a_site_it_says_so(panel):
    assert "No site open" in str(panel.pages.text)


def test_traces_lie_on_their_surfaces(panel, qtbot):
    show(panel, qtbot, {WITH_PERIPHERY: fitted(), FAULT: fitted(FAULT)})
    drawn = lines(panel)[WITH_PERIPHERY]
    distance, z = np.asarray(drawn.get_xdata()), np.asarray(drawn.get_ydata())
    way = (LINE[1] - LINE[0]) / np.linalg.norm(LINE[1] - LINE[0])
    inner = slice(1, -1)
    x, y = (LINE[0] + distance[inner, None] * way).T
    assert np.abs(fitted().elevation(x, y) - z[inner]).max() < 1e-5
    assert distance.max() == pytest.approx(np.linalg.norm(LINE[1] - LINE[0]), abs=1e-6)
    assert FAULT in lines(panel)


def test_before_a_fit_points_holes_and_ground_are_there(panel, qtbot):
    show(panel, qtbot, {})
    assert "press Fit" in panel.state.text()
    axes = panel.canvas.figure.axes[0]
    assert "ground" in lines(panel)
    assert any(text.get_text().startswith("孔") for text in axes.texts)


def test_points_within_the_thickness_are_drawn(panel, qtbot):
    show(panel, qtbot, {}, thickness=60.0)
    places, index = near_points(panel.data, WITH_PERIPHERY)
    xy = sample_site().horizons[WITH_PERIPHERY].xyz[:, :2]
    way = (LINE[1] - LINE[0]) / np.linalg.norm(LINE[1] - LINE[0])
    off = np.abs((xy - LINE[0]) @ [way[1], -way[0]])
    along = (xy - LINE[0]) @ way
    wanted = np.flatnonzero((off <= 30) & (along >= 0) & (along <= np.linalg.norm(LINE[1] - LINE[0])))
    assert index.tolist() == wanted.tolist()
    assert np.allclose(places[:, 0], along[wanted])


def test_showing_tells_nobody_and_editing_does(panel, qtbot):
    with qtbot.assertNotEmitted(panel.line_changed):
        show(panel, qtbot, {})
    assert panel.azimuth.value() == pytest.approx(82.9, abs=0.05)
    with qtbot.waitSignal(panel.line_changed, timeout=3000) as told:
        panel.azimuth.setValue(30.0)
    wait(panel, qtbot)
    east, north = told.args[0][1] - told.args[0][0]
    assert np.degrees(np.arctan2(east, north)) == pytest.approx(30.0)
    with qtbot.waitSignal(panel.thickness_changed) as told:
        panel.thickness.setValue(25.0)
    assert told.args == [25.0]


def test_a_section_of_the_site_is_chosen_by_name(panel, qtbot):
    show(panel, qtbot, {})
    panel.along.setFocus()
    with qtbot.waitSignal(panel.line_changed, timeout=3000) as told:
        qtbot.keyClick(panel.along, Qt.Key.Key_Down)
    assert panel.along.currentText() == "C1"
    assert np.allclose(told.args[0], sample_site().sections[0].line)


def test_the_last_of_many_edits_is_cut(panel, qtbot):
    show(panel, qtbot)
    for value in (-100.0, -50.0, 50.0, 120.0):
        with qtbot.waitSignal(panel.line_changed):
            panel.position.setValue(value)
    wait(panel, qtbot)
    start, way = panel.line[0], panel.line[1] - panel.line[0]
    drawn = lines(panel)[WITH_PERIPHERY]
    share = np.asarray(drawn.get_xdata())[1:-1, None] / np.linalg.norm(way)
    x, y = (start + share * way).T
    assert np.abs(fitted().elevation(x, y) - np.asarray(drawn.get_ydata())[1:-1]).max() < 1e-5


def test_the_band_is_ninety_per_cent_wide(panel, qtbot):
    surface, uncertainty = fitted(), examine(fitted()).uncertainty
    show(panel, qtbot, uncertainty={WITH_PERIPHERY: uncertainty})
    ((cut, _),) = panel.data.traces[WITH_PERIPHERY]
    half = 1.6449 * prediction_sd(surface, uncertainty, cut.xyz, "contact")
    (drawn,) = bands(panel)
    upper, lower = np.split(drawn.get_xy()[:-1], 2)
    np.testing.assert_allclose(upper[:, 1], cut.xyz[:, 2] + half, atol=1e-4)
    np.testing.assert_allclose(lower[::-1, 1], cut.xyz[:, 2] - half, atol=1e-4)
    assert drawn.get_label() == "90 % band of a new hole"


@pytest.mark.parametrize("name", [FAULT, "M1"])
def test_steep_and_folded_surfaces_have_their_bands(panel, qtbot, name):
    surface, uncertainty = fitted(name), examine(fitted(name)).uncertainty
    assert uncertainty.frame == surface.frame != "map"
    middle = surface.points.xyz[:, :2].mean(axis=0)
    way = {FAULT: [0.0, 1.0], "M1": [1.0, 0.3]}[name]
    show(
        panel, qtbot, {name: surface}, line=middle + np.outer([-300, 300], way), uncertainty={name: uncertainty}
    )  # fmt: skip
    drawn, cuts = bands(panel), panel.data.traces[name]
    assert len(drawn) == len(cuts) > 0
    for polygon, (cut, _) in zip(drawn, cuts, strict=True):
        upper, lower = np.split(polygon.get_xy()[:-1], 2)
        trace = np.column_stack([cut.distance, cut.xyz[:, 2]])
        np.testing.assert_allclose((upper + lower[::-1]) / 2, trace, atol=1e-6, err_msg="the surface is in the middle")
        # In the plane of the section a band is no narrower than it is across the surface.
        half = 1.6449 * prediction_sd(surface, uncertainty, cut.xyz, "contact")
        assert (np.linalg.norm(upper - trace, axis=1) > half - 1e-4).all()


def bands(panel):
    return [patch for patch in panel.canvas.figure.axes[0].patches if patch.get_alpha() == TINT]


def test_exaggeration_is_what_is_drawn(panel, qtbot):
    show(panel, qtbot, {})
    panel.factor.setCurrentIndex(panel.factor.findData(5.0))
    panel.factor.activated.emit(panel.factor.currentIndex())
    panel.canvas.draw()
    axes = panel.canvas.figure.axes[0]
    (x0, z0), (x1, z1) = axes.transData.transform([[0.0, 1500.0], [100.0, 1600.0]])
    assert (z1 - z0) / (x1 - x0) == pytest.approx(5.0, rel=1e-3)
    assert noted(panel) == "Vertical 5×"


def noted(panel):
    (note,) = panel.canvas.figure.texts
    return note.get_text()


def drawn_factor(panel):
    axes = panel.canvas.figure.axes[0]
    (x0, z0), (x1, z1) = axes.transData.transform([[0.0, 1500.0], [100.0, 1600.0]])
    return (z1 - z0) / (x1 - x0)


def test_a_flat_section_is_drawn_higher_by_itself_and_says_so(panel, qtbot):
    show(panel, qtbot, {}, line=ACROSS)
    assert panel.factor.currentData() is None
    factors = []
    for height in (300, 700):
        panel.resize(800, height)
        qtbot.waitUntil(lambda height=height: panel.height() == height)
        panel.canvas.draw()
        axes = panel.canvas.figure.axes[0]
        factors.append(drawn_factor(panel))
        assert noted(panel) == f"Vertical {factors[-1]:.0f}×"
        # All of it is seen, at true elevations.
        (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
        low, high = axes.dataLim.intervaly
        assert left <= 0
        assert right >= panel.data.curtain.length
        assert bottom <= low
        assert top >= high
    assert factors == pytest.approx([2.0, 10.0], rel=1e-3)


def test_the_factor_is_told_while_a_section_is_moved_and_magnified(panel, qtbot):
    show(panel, qtbot, {})
    axes = panel.canvas.figure.axes[0]
    before, whole = drawn_factor(panel), axes.get_xlim()
    panel.look_at((100.0, 300.0), (1450.0, 1450.0 + 200.0 * np.ptp(axes.get_ylim()) / np.ptp(whole)))
    panel.thickness.setValue(30.0)
    panel.resize(900, 500)
    wait(panel, qtbot)
    assert axes.get_xlim() != whole
    assert drawn_factor(panel) == pytest.approx(before, rel=1e-3)
    assert noted(panel) == f"Vertical {before:.0f}×"
    panel.along.setCurrentIndex(1)
    panel.along.activated.emit(1)
    wait(panel, qtbot)
    assert axes.get_xlim()[0] <= 0


@pytest.mark.parametrize("factor", [1.0, 2.0, 20.0])
def test_a_window_holds_the_section_and_its_names(factor):
    seen, size = SectionExtent(900.0, 1300.0, 1420.0, head=1410.0, names=50.0), (700.0, 200.0)
    (left, right), (bottom, top) = window(seen, size, factor)
    upwards = size[1] / (top - bottom)
    assert upwards / (size[0] / (right - left)) == pytest.approx(factor)
    assert left < 0 < 900 < right
    assert bottom < 1300
    assert top > 1420
    assert (top - 1410) * upwards >= 50


@pytest.mark.parametrize("low", [-8900.0, -3.0, 0.0, 1300.0])
def test_a_section_without_names_is_in_the_middle_at_any_elevation(low):
    """Below sea level, too: no name is at elevation 0 then."""
    seen, size = SectionExtent(3500.0, low, low + 120.0), (700.0, 200.0)
    for factor in (1.0, automatic(seen, size)):
        _, (bottom, top) = window(seen, size, factor)
        assert (bottom + top) / 2 == pytest.approx(low + 60.0)
        assert bottom < low
        assert top > low + 120.0


def test_a_section_without_any_height_is_still_drawn():
    flat = SectionExtent(100.0, 5.0, 5.0)
    assert np.isfinite(window(flat, (300.0, 200.0), automatic(flat, (300.0, 200.0)))).all()


def test_no_text_is_cut_off(panel, qtbot):
    show(panel, qtbot, {WITH_PERIPHERY: fitted()})
    for size in ((800, 300), (262, 480), (1100, 700)):
        panel.resize(*size)
        qtbot.waitUntil(lambda size=size: (panel.width(), panel.height()) == size)
        panel.canvas.draw()
        figure, renderer = panel.canvas.figure, panel.canvas.get_renderer()
        axes = figure.axes[0]
        low, high = axes.get_ylim()
        numbers = [text for text in axes.get_yticklabels() if low <= text.get_position()[1] <= high]
        for part in (axes.xaxis.label, axes.yaxis.label, *numbers, *figure.texts, *figure.legends):
            box = part.get_window_extent(renderer)
            assert box.x0 >= 0, part
            assert box.y0 >= 0, part
            assert box.x1 <= figure.bbox.width, part
            assert box.y1 <= figure.bbox.height, part
        left = min(text.get_window_extent(renderer).x0 for text in numbers)
        assert axes.yaxis.label.get_window_extent(renderer).x1 <= left


def test_names_of_holes_stand_apart(panel, qtbot):
    show(panel, qtbot, {}, thickness=400.0)
    axes, renderer = panel.canvas.figure.axes[0], panel.canvas.get_renderer()
    drawn = sorted(t.get_window_extent(renderer).x0 for t in axes.texts if t.get_visible())
    assert len(drawn) < len(axes.texts)
    assert np.diff(drawn).min() >= 11
    panel.look_at((400.0, 500.0), axes.get_ylim())
    inside = [text for text in axes.texts if 400 < text.xy[0] < 500]
    assert inside
    assert all(text.get_visible() for text in inside)


def test_axes_are_kept_for_the_next_section(panel, qtbot):
    show(panel, qtbot, {})
    axes = panel.canvas.figure.axes[0]
    counted = len(axes.lines), len(axes.texts), len(panel.canvas.figure.legends), len(panel.canvas.figure.texts)
    for _ in range(3):
        panel.canvas.repaint_figure()
        panel.canvas.draw()
    assert panel.canvas.figure.axes == [axes]
    assert counted == (
        len(axes.lines), len(axes.texts), len(panel.canvas.figure.legends), len(panel.canvas.figure.texts),
    )  # fmt: skip


def test_a_hidden_panel_cuts_when_it_is_shown(panel, qtbot):
    panel.hide()
    panel.show_section(sample_site(), {WITH_PERIPHERY: fitted()}, LINE, 80.0)
    assert panel.idle
    panel.show()
    qtbot.waitUntil(lambda: not panel.idle)
    wait(panel, qtbot)
    assert WITH_PERIPHERY in lines(panel)


def test_a_clicked_point_is_told(panel, qtbot):
    show(panel, qtbot, {})
    places, _ = near_points(panel.data, WITH_PERIPHERY)
    x, y = panel.canvas.figure.axes[0].transData.transform(places[0])
    ratio = panel.canvas.device_pixel_ratio
    place = QPoint(round(x / ratio), round(panel.canvas.height() - y / ratio))
    with qtbot.waitSignal(panel.point_chosen) as told:
        qtbot.mouseClick(panel.canvas, Qt.MouseButton.LeftButton, pos=place)
    name, found = told.args
    points = sample_site().horizons[name]
    xyz = points.xyz[found.find(points)]
    along, _ = panel.data.curtain.project(xyz[None, :2])
    assert np.hypot(*(panel.canvas.figure.axes[0].transData.transform([along[0], xyz[2]]) - [x, y])) < 8


def test_curtains_turn_round_the_middle():
    box = np.array([[0.0, 0.0], [200.0, 100.0]])
    east = Curtain.straight(90.0, 0.0, box)
    assert np.allclose(east.line, [[0, 50], [200, 50]])
    right = Curtain.straight(90.0, 20.0, box)
    assert np.allclose(right.line[:, 1], 30.0)
    assert right.position(box) == pytest.approx(20.0)
    assert Curtain.straight(237.0, -15.0, box).azimuth == pytest.approx(237.0)
    assert Curtain.straight(237.0, -15.0, box).position(box) == pytest.approx(-15.0)


def test_places_beside_a_bent_curtain():
    bent = Curtain.along([[0.0, 0.0], [100.0, 0.0], [100.0, 50.0]])
    along, beside = bent.project(np.array([[30.0, 4.0], [103.0, 20.0], [-5.0, -5.0]]))
    assert along[:2].tolist() == [30.0, 120.0]
    assert beside[:2].tolist() == [4.0, 3.0]
    assert np.isnan(along[2])
    assert np.isnan(beside[2])
    assert bent.length == 150.0


def test_it_fits_a_narrow_dock(panel, qtbot):
    show(panel, qtbot, {})
    assert panel.minimumSizeHint().width() <= 260
