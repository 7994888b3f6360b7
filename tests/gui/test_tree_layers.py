"""The eyes and opacities in the project tree: what a person does there reaches the scene, and the other way round."""

import pytest
from panel_samples import SITE, fitted, sample_site
from PySide6.QtCore import QEvent, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QSlider

from geofit.gui.panels.project_tree import ProjectTree
from geofit.gui.panels.tree_model import OPACITY, SHOWN
from geofit.gui.view3d.layers import Layer, Layers, Legend, Swatch
from geofit.project.commands import SetSurface

CHECK, ALOUD = Qt.ItemDataRole.CheckStateRole, Qt.ItemDataRole.AccessibleTextRole


@pytest.fixture
def shown(qtbot):
    """A tree of the sample site, with some layers."""
    layers = Layers()
    tree = ProjectTree(layers)
    qtbot.addWidget(tree)
    tree.resize(240, 700)
    tree.show()
    legend = Legend("deviation", "m", (Swatch("#ff0000", "+ ≥ 0.5"), Swatch("#0000ff", "− ≥ 0.5")))
    layers.add(Layer("ground", "ground", opacity=0.3))
    layers.add(Layer("points:W", "points", "W", "#5b8fb5", choices=("kind", "deviation"), colour_by="kind"))
    layers.add(Layer("surface:W", "surface", "W", "#5b8fb5", choices=("plain", "dip"), isolines=False, legend=legend))
    layers.add(Layer("upper:W", "upper", "W", "#5b8fb5", visible=False))
    layers.add(Layer("holes", "holes", labels=True))
    tree.show_site(sample_site(), {})
    return tree


def cell(tree, key, column):
    index = tree.shown.mapFromSource(tree.items.index_of(tree.row(key)).siblingAtColumn(column))
    tree.view.scrollTo(index)
    return index


def click(tree, key, column):
    at = tree.view.visualRect(cell(tree, key, column)).center()
    QTest.mouseClick(tree.view.viewport(), Qt.MouseButton.LeftButton, pos=at)


def seen(tree):
    return [layer.key for layer in tree.layers if layer.visible]


def head(tree, key):
    return next(row for row in tree.items.rows if row.target == ("group", key))


def test_layers_hang_under_what_they_belong_to(shown):
    assert [row.text for row in head(shown, "site").rows] == ["Ground"]
    assert head(shown, "borehole").layer == "holes"
    horizon = shown.row("surface:W")
    assert horizon.target == ("horizon", "W")
    assert [(row.text, row.layer) for row in horizon.rows] == [("Points", "points:W"), ("Upper 90 % bound", "upper:W")]
    assert not next(row for row in head(shown, "horizons").rows if row.text == "F1").layer


def test_a_click_on_the_eye_hides_and_shows_and_chooses_nothing(shown, qtbot):
    with qtbot.assertNotEmitted(shown.horizon_chosen):
        click(shown, "holes", SHOWN)
        assert "holes" not in seen(shown)
        click(shown, "surface:W", SHOWN)
    assert seen(shown) == ["ground"]
    click(shown, "surface:W", SHOWN)
    assert seen(shown) == ["ground", "points:W", "surface:W"], "the bound stays hidden until it is asked for"
    shown.layers.change("ground", visible=False)
    assert cell(shown, "ground", SHOWN).data(CHECK) == Qt.CheckState.Unchecked
    assert cell(shown, "ground", SHOWN).data(ALOUD) == "Hidden in the scene"


def test_a_horizon_counts_as_shown_while_anything_of_it_is(shown):
    shown.layers.change("surface:W", visible=False)
    assert shown.row("surface:W").checked
    shown.layers.change("points:W", visible=False)
    assert not shown.row("surface:W").checked


def test_the_space_bar_opens_and_closes_the_eye_of_the_row(shown):
    shown.choose_layer("points:W")
    shown.view.setFocus()
    QTest.keyClick(shown.view, Qt.Key.Key_Space)
    assert "points:W" not in seen(shown)
    QTest.keyClick(shown.view, Qt.Key.Key_Space)
    assert "points:W" in seen(shown)


def test_a_click_on_the_opacity_brings_a_slider(shown, qtbot):
    assert cell(shown, "ground", OPACITY).data(ALOUD) == "Opacity 30 %"
    click(shown, "ground", OPACITY)
    menu = QApplication.activePopupWidget()
    menu.findChild(QSlider).setValue(70)
    menu.close()
    assert shown.layers["ground"].opacity == shown.row("ground").opacity == 0.7
    assert cell(shown, "ground", OPACITY).data(ALOUD) == "Opacity 70 %"


def test_opacity_colour_and_lines_reach_the_layer(shown):
    shown.choose_layer("surface:W")
    form = shown.form
    assert form.isVisible()
    form.opacity.setValue(40)
    form.colour_by.setCurrentIndex(1)
    form.colour_by.activated.emit(1)
    form.isolines.setChecked(True)
    layer = shown.layers["surface:W"]
    assert (layer.opacity, layer.colour_by, layer.isolines) == (0.4, "dip", True)
    assert form.legend.isVisible()
    assert form.legend.sizeHint().height() > 40


def test_the_form_goes_with_the_horizon_that_is_chosen_elsewhere(shown):
    """The form stayed with the row before: its slider changed another horizon than the tree showed as chosen."""
    shown.choose_layer("ground")
    shown.choose_horizon("W")
    shown.form.opacity.setValue(55)
    assert shown.layers["surface:W"].opacity == 0.55
    assert shown.layers["ground"].opacity == 0.3


def test_a_layer_shows_only_what_it_has(shown):
    shown.choose_layer("holes")
    assert not shown.form.isolines.isVisible()
    assert not shown.form.colour_by.isVisible()
    assert shown.form.labels.isChecked()
    shown.form.labels.setChecked(False)
    assert shown.layers["holes"].labels is False


def test_the_form_follows_changes_from_elsewhere(shown):
    shown.choose_layer("points:W")
    shown.layers.change("points:W", opacity=0.25, colour_by="deviation")
    assert shown.form.opacity.value() == 25
    assert shown.form.colour_by.currentData() == "deviation"


def test_the_menu_zooms_and_shows_only_this(shown, qtbot):
    zoom, only, every = shown.menu_for("points:W").actions()
    with qtbot.waitSignal(shown.zoom_requested) as told:
        zoom.trigger()
    assert told.args == ["points:W"]
    only.trigger()
    assert seen(shown) == ["points:W"]
    every.trigger()
    assert all(layer.visible for layer in shown.layers)


def test_rows_come_and_go_with_their_layers_and_folds_stay(shown, qtbot):
    shown.view.expand(cell(shown, "surface:W", 0))
    shown.layers.add(Layer("control:W", "control", "W"))
    shown.layers.remove("upper:W")
    qtbot.waitUntil(lambda: any(row.layer == "control:W" for row in shown.items.all()), timeout=2000)
    assert [row.layer for row in shown.row("surface:W").rows] == ["points:W", "control:W"]
    assert shown.view.isExpanded(cell(shown, "surface:W", 0))
    shown.layers.clear()
    qtbot.waitUntil(lambda: not any(row.layer for row in shown.items.all()), timeout=2000)
    assert not shown.form.isVisible()


def test_a_destroyed_tree_no_longer_listens(qtbot, qapp):
    layers = Layers()
    tree = ProjectTree(layers)
    tree.deleteLater()
    qapp.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    layers.add(Layer("ground", "ground"))
    assert not layers.listeners


def test_it_fits_a_narrow_dock(shown):
    shown.choose_layer("surface:W")
    assert shown.minimumSizeHint().width() <= 200


def test_in_the_window_one_tree_has_verdict_eye_and_opacity(app):
    app.desktop.session.begin(sample_site(), SITE)
    provenance = app.document.provenance("T3-T2")
    app.document.put(provenance, fitted())
    app.window.fitting.push(SetSurface(provenance))
    app.idle()
    tree, layers = app.window.panels.tree, app.window.panels.view.layers
    app.qtbot.waitUntil(lambda: any(row.layer == "surface:T3-T2" for row in tree.items.all()), timeout=5000)
    row = tree.row("surface:T3-T2")
    assert (row.target, row.checked, row.opacity) == (("horizon", "T3-T2"), True, 1.0)
    assert row.mark.availableSizes()[0].width() == 2 * row.mark.availableSizes()[0].height()
    assert "PASS" in row.aloud
    click(tree, "surface:T3-T2", SHOWN)
    assert not any(layer.visible for layer in layers if layer.horizon == "T3-T2")
    assert len(app.window.panels.docks) == 16
