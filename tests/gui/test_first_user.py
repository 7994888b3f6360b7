"""The way of a first user through the real windows, on the sample site, with no manual."""

from __future__ import annotations

import pytest
from PySide6.QtCore import Qt


def test_the_way_of_a_first_user(app, qtbot, tmp_path, monkeypatch):
    window, document, panels = app.window, app.document, app.window.panels

    # Start: one button, and nothing that is of no use yet.
    assert panels.centre.currentWidget() is panels.start
    assert not window.actions_["fit"].isEnabled()
    from geofit.gui import files

    monkeypatch.setattr(files, "_documents", lambda: str(tmp_path))
    qtbot.mouseClick(panels.start.sample, Qt.MouseButton.LeftButton)
    app.idle()
    assert panels.centre.currentWidget() is panels.view
    assert document.horizons == ("T3-T2", "T2-T1", "W", "F1", "M1")
    assert not window.isWindowModified()

    # Choose a horizon in the tree, fit it.
    panels.tree.horizon_chosen.emit("T2-T1")
    app.idle()
    app.trigger("fit")
    app.idle()
    surface = document.surface("T2-T1")
    assert surface.accuracy.verdict == "PASS"
    assert "PASS" in panels.verdict.text
    assert window.isWindowModified()
    assert window.session.stack.undoText() == "Fit T2-T1"

    # The worst point: chosen in all windows, its file and row said.
    app.trigger("worst")
    app.idle()
    worst = surface.accuracy.worst[0]
    assert window.selecting.index() == worst
    assert surface.points.describe(worst) in window.statusBar().currentMessage()

    # Pull the surface there by hand; only the neighbourhood moves; undo.
    panels.adjust.pull_requested.emit(worst, 1.0)
    app.idle()
    pulled = document.surface("T2-T1")
    assert abs(pulled.accuracy.residuals[worst]) < 1e-9
    window.session.stack.undo()
    app.idle()
    assert document.surface("T2-T1") is surface
    window.session.stack.redo()
    app.idle()
    assert document.surface("T2-T1") is pulled

    # Exclude a row: the result is stale until it is fitted again.
    app.trigger("exclude")
    app.idle()
    assert document.stale("T2-T1")
    assert len(document.points("T2-T1")) == len(surface.points) - 1
    window.session.stack.undo()
    app.idle()
    assert not document.stale("T2-T1")

    # Save, close, open again: the surface is there, and can be adjusted further.
    project = tmp_path / "dam.geofit"
    window.files.save_to(project)
    app.idle()
    assert not window.isWindowModified()
    assert project.is_file()
    window.files.close()
    app.idle()
    assert panels.centre.currentWidget() is panels.start
    window.files.open(project)
    app.idle()
    again = document.surface("T2-T1")
    assert again.accuracy.sigma == pytest.approx(pulled.accuracy.sigma, abs=1e-9)
    assert again.model is not None
    assert document.selection.horizon == "T2-T1"
    assert not document.stale("T2-T1")
    assert not window.isWindowModified()
    assert window.preferences.recent[0] == project
