"""The list of steps: named, and a click goes back or forward to any of them."""

from __future__ import annotations

from panel_samples import SITE, fitted, sample_site
from PySide6.QtWidgets import QInputDialog

from geofit.project.commands import SetSurface
from geofit.project.provenance import Row

NAME = "T3-T2"


def test_a_click_goes_back_to_a_step_and_forward_again(app, qtbot):
    app.desktop.session.begin(sample_site(), SITE)
    document, fitting = app.document, app.window.fitting
    states = [document.state]
    provenance = document.provenance(NAME)
    document.put(provenance, fitted())
    points = document.site.horizons[NAME]
    for do in (
        lambda: fitting.push(SetSurface(provenance)),
        lambda: fitting.exclude(NAME, [Row.of(points, 3), Row.of(points, 9)]),
        lambda: fitting.set_core(NAME, "none"),
    ):
        do()
        states.append(document.state)
    app.idle()
    app.trigger("steps")
    steps = app.window.steps
    assert steps.isVisible()
    model = steps.list.model()
    words = [model.data(model.index(k, 0)) for k in range(model.rowCount())]
    assert words[0] == "As opened"
    assert words[1] == f"Fit {NAME}"
    assert words[2].startswith("Exclude 2 rows")
    assert words[3] == f"Core of {NAME}"
    for target in (1, 3, 0, 2):
        steps.list.setCurrentIndex(model.index(target, 0))
        app.idle()
        assert document.state == states[target]
    app.trigger("steps")
    assert app.window.steps is steps, "one list at a time"


def test_the_list_rests_while_a_task_runs(app, qtbot):
    app.desktop.session.begin(sample_site(), SITE)
    app.idle()
    app.trigger("steps")
    app.window.fitting.fit("W")
    assert not app.window.steps.list.isEnabled()
    app.trigger("stop")
    app.idle()
    assert app.window.steps.list.isEnabled()


def test_the_own_name_with_blanks_is_no_step(app, monkeypatch):
    app.desktop.session.begin(sample_site(), SITE)
    document, name = app.document, app.document.state.name
    for given, expected in ((f"{name}  ", name), (f" {name} II ", f"{name} II")):
        monkeypatch.setattr(QInputDialog, "getText", lambda *_, given=given, **__: (given, True))
        before = document.state
        app.trigger("rename")
        assert document.state.name == expected
        assert (document.state is before) == (expected == name)
