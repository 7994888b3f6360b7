"""Names with signs that Qt takes for something else: & underlines a letter, < begins markup."""

from __future__ import annotations

from panel_samples import FAULT, fitted, sample_site
from PySide6.QtCore import Qt

from geofit.data.settings import FitSettings
from geofit.gui.dialogs.report import ReportDialog
from geofit.gui.panels.fit_panel import FitPanel
from geofit.gui.panels.layer_form import LayerForm
from geofit.gui.view3d.layers import Layer, Layers
from geofit.report.result import HorizonResult

NAME = "T2 & T3"


def test_a_group_shows_the_sign(qtbot):
    form = LayerForm(Layers())
    qtbot.addWidget(form)
    form.resize(400, 200)
    form.show_layer(Layer(f"points:{NAME}", "points", NAME))
    assert "T2 && T3" in form.title()
    assert form.toolTip() == ""


def test_a_title_shows_no_markup(qtbot):
    panel = FitPanel()
    qtbot.addWidget(panel)
    panel.show_settings("<b>bold</b>", FitSettings())
    assert panel.title.textFormat() == Qt.TextFormat.PlainText


def test_a_box_to_check_shows_the_sign(qtbot):
    site = sample_site()
    dialog = ReportDialog(site, [HorizonResult(fitted(FAULT).with_(name=NAME), site)])
    qtbot.addWidget(dialog)
    assert dialog.examine.text().endswith("T2 && T3")
