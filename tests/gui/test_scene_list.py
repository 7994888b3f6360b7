"""The scene list: what a person does there reaches the layers, and the other way round."""

import pytest
from PySide6.QtCore import Qt

from geofit.gui.view3d.layers import Layer, Layers, Legend, Swatch


@pytest.fixture
def shown(qtbot):
    from geofit.gui.panels.scene_list import SceneList

    layers = Layers()
    panel = SceneList(layers)
    qtbot.addWidget(panel)
    panel.resize(240, 600)
    panel.show()
    legend = Legend("deviation", "m", (Swatch("#ff0000", "+ ≥ 0.5"), Swatch("#0000ff", "− ≥ 0.5")))
    layers.add(Layer("points:W", "points", "W", "#5b8fb5", choices=("kind", "deviation"), colour_by="kind"))
    layers.add(Layer("surface:W", "surface", "W", "#5b8fb5", choices=("plain", "dip"), isolines=False, legend=legend))
    layers.add(Layer("holes", "holes", labels=True))
    return panel


def row(panel, key):
    return panel.row(key)


def test_an_empty_list_says_what_to_do(qtbot):
    from geofit.gui.panels.scene_list import SceneList

    panel = SceneList(Layers())
    qtbot.addWidget(panel)
    assert "open or import a site" in str(panel.placeholder.text)
    panel.layers.add(Layer("ground", "ground"))
    assert str(panel.placeholder.text) == ""


def test_layers_stand_under_their_horizon_and_the_site_first(shown):
    tops = [shown.tree.topLevelItem(k) for k in range(shown.tree.topLevelItemCount())]
    assert [top.text(0) for top in tops] == ["Site", "W"]
    assert [tops[1].child(k).text(0) for k in range(tops[1].childCount())] == ["Points", "Surface"]


def test_a_check_box_hides_and_shows(shown):
    row(shown, "surface:W").setCheckState(0, Qt.CheckState.Unchecked)
    assert not shown.layers["surface:W"].visible
    shown.layers.change("surface:W", visible=True)
    assert row(shown, "surface:W").checkState(0) == Qt.CheckState.Checked


def test_the_check_box_of_a_horizon_hides_all_of_it(shown):
    row(shown, "surface:W").parent().setCheckState(0, Qt.CheckState.Unchecked)
    assert [layer.key for layer in shown.layers if layer.visible] == ["holes"]


def test_opacity_colour_and_lines_reach_the_layer(shown):
    shown.choose("surface:W")
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


def test_a_layer_shows_only_what_it_has(shown):
    shown.choose("holes")
    assert not shown.form.isolines.isVisible()
    assert not shown.form.colour_by.isVisible()
    assert shown.form.labels.isChecked()
    shown.form.labels.setChecked(False)
    assert shown.layers["holes"].labels is False


def test_the_form_follows_changes_from_elsewhere(shown):
    shown.choose("points:W")
    shown.layers.change("points:W", opacity=0.25, colour_by="deviation")
    assert shown.form.opacity.value() == 25
    assert shown.form.colour_by.currentData() == "deviation"


def test_the_menu_zooms_and_shows_only_this(shown, qtbot):
    menu = shown.menu_for("points:W")
    zoom, only, every = menu.actions()
    with qtbot.waitSignal(shown.zoom_requested) as told:
        zoom.trigger()
    assert told.args == ["points:W"]
    only.trigger()
    assert [layer.key for layer in shown.layers if layer.visible] == ["points:W"]
    every.trigger()
    assert all(layer.visible for layer in shown.layers)


def test_removed_layers_go_with_their_empty_horizon(shown):
    shown.layers.remove("points:W")
    shown.layers.remove("surface:W")
    assert [shown.tree.topLevelItem(k).text(0) for k in range(shown.tree.topLevelItemCount())] == ["Site"]
    shown.layers.clear()
    assert shown.tree.topLevelItemCount() == 0
    assert not shown.form.isVisible()


def test_a_destroyed_list_no_longer_listens(qtbot, qapp):
    from PySide6.QtCore import QEvent

    from geofit.gui.panels.scene_list import SceneList

    layers = Layers()
    panel = SceneList(layers)
    panel.deleteLater()
    qapp.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    layers.add(Layer("ground", "ground"))
    assert not layers.listeners


def test_it_fits_a_narrow_dock(shown):
    assert shown.minimumSizeHint().width() <= 260
