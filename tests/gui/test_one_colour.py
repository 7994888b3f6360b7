"""A horizon has one colour: in the scene, its list, the section, the plan and the project tree."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.colors import to_hex
from panel_samples import FAULT, WITH_PERIPHERY, fitted, item_of, sample_site
from PySide6.QtGui import QColor, QPalette

from geofit.gui import worker
from geofit.gui.panels.plan import PlanPanel
from geofit.gui.panels.project_tree import ProjectTree
from geofit.gui.panels.section import SectionPanel
from geofit.gui.view3d.view import SceneView
from geofit.report.style import horizon_colours

LINE = np.array([[500800.0, 3101000.0], [501600.0, 3101100.0]])
NAMES = (WITH_PERIPHERY, FAULT)


def shades(icon):
    """Return the colours of an icon, the most frequent first."""
    image = icon.pixmap(16, 16).toImage()
    pixels = [image.pixelColor(x, y) for x in range(image.width()) for y in range(image.height())]
    names = [pixel.name() for pixel in pixels if pixel.alpha() == 255]
    return sorted(set(names), key=names.count, reverse=True)


@pytest.fixture(params=[False, True], ids=["light", "dark"])
def palette(request):
    if not request.param:
        return QPalette(QColor("#eff1f3"))
    dark = QPalette(QColor("#22282e"))
    dark.setColor(QPalette.ColorRole.Base, QColor("#1a1f24"))
    dark.setColor(QPalette.ColorRole.Text, QColor("#e3e8ed"))
    return dark


def test_one_horizon_has_one_colour(qtbot, palette):
    site, surfaces = sample_site(), {name: fitted(name) for name in reversed(NAMES)}
    wanted = horizon_colours(site.horizons)
    assert len({wanted[name] for name in NAMES}) == len(NAMES)
    view, section, plan = SceneView(), SectionPanel(), PlanPanel()
    tree = ProjectTree(view.layers)
    for widget in (view, section, plan, tree):
        widget.setPalette(palette)
        qtbot.addWidget(widget)
    section.resize(800, 400)
    section.show()
    view.set_dark(palette.color(QPalette.ColorRole.Window).lightness() < 128)
    # Whichever is shown first.
    view.show_surface(surfaces[FAULT])
    view.show_site(site)
    view.show_surface(surfaces[WITH_PERIPHERY])
    view.show_surface(surfaces[FAULT])
    section.show_section(site, surfaces, LINE, 80.0)
    tree.show_site(site, surfaces)
    qtbot.waitUntil(lambda: section.idle, timeout=20_000)
    section.canvas.draw()
    drawn = {line.get_label(): to_hex(line.get_color()) for line in section.canvas.figure.axes[0].lines}
    for name in NAMES:
        (part, *_) = item_of(view, f"surface:{name}").parts
        assert QColor.fromRgbF(*part.actor.GetProperty().GetColor()).name() == wanted[name]
        assert shades(tree.row(f"points:{name}").mark) == [wanted[name]]
        assert drawn[name] == wanted[name]
        plan.show_surface(site, name, surfaces[name], surfaces[name].settings)
        assert plan.view.data.colour == wanted[name]
        (row,) = (row for row in tree.items.all() if row.text == name)
        assert shades(row.rows[-1].mark)[0] == wanted[name]
    tree.show_site(site, {})
    (row,) = (row for row in tree.items.all() if row.text == FAULT)
    assert shades(row.mark)[0] == wanted[FAULT]
    view.close()
    assert worker.finish_all()
