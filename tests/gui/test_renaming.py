"""Horizons and bodies that get another name, or go, while something is made for them, through the window."""

from __future__ import annotations

import numpy as np
import pytest

from geofit.bodies.settings import BodySettings
from geofit.gui.activity import Activity
from geofit.io.site_file import read_site
from geofit.project.body_commands import DeleteBody, RenameBody
from geofit.project.body_record import BetweenHorizons
from geofit.project.commands import RemoveHorizons, RenameHorizon
from geofit.project.provenance import Move


def rows(name, level, seed):
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(0, 400, (2, 40))
    z = level + 0.05 * x + 4 * np.sin(x / 60) * np.cos(y / 80)
    return [f"{name}{k},{a:.2f},{b:.2f},{c:.3f},{name}" for k, (a, b, c) in enumerate(zip(x, y, z, strict=True))]


def written(folder, lines):
    (folder / "picks.csv").write_text("hole,x,y,z,horizon\n" + "\n".join(lines) + "\n", encoding="utf-8")


@pytest.fixture
def three(app, tmp_path):
    """The application with a site of three horizons, none of them fitted."""
    written(tmp_path, [*rows("A", 100, 1), *rows("B", 80, 2), *rows("C", 60, 3)])
    (tmp_path / "site.toml").write_text(
        '[site]\nname = "Three"\n[[picks]]\nfile = "picks.csv"\nkind = "borehole"\n', encoding="utf-8"
    )
    app.window.files.open(tmp_path / "site.toml")
    app.idle()
    return app


def begun(app):
    """Wait until a task runs."""
    app.qtbot.waitUntil(lambda: app.window.activity.busy)
    app.qtbot.wait(50)


def test_a_renamed_horizon_is_not_made_again(three):
    fitting, document = three.window.fitting, three.document
    fitting.fit("A")
    three.idle()
    fitting.adjust("A", Move("periphery", 3, 3, 0.4))
    three.idle()
    fitting.examine("A")
    three.idle()
    fitting.push(RenameHorizon("A", "Top of A"))
    assert not three.window.activity.busy
    assert document.surface("Top of A") is not None
    assert document.prediction("Top of A") is not None
    assert len(document.state.provenances["Top of A"].edits) == 1
    three.window.menus.undo.trigger()
    assert document.prediction("A") is not None
    fitting.push(RenameHorizon("B", "B & <i>"))
    # A single & would underline the next letter.
    merge = next(menu for action in three.window.context.menu_of("horizon", "A").actions() if (menu := action.menu()))
    assert [action.text() for action in merge.actions()] == ["B && <i>", "C"]
    three.idle()


def test_what_was_stopped_is_made_as_it_was_with_its_edits(three):
    fitting, document, window = three.window.fitting, three.document, three.window
    fitting.fit("A")
    three.idle()
    fitting.adjust("A", Move("periphery", 3, 3, 0.4))
    three.idle()
    control = document.surface("A").patches[-1].control
    document.shelf.clear()
    fitting.make_missing()
    window.activity.cancel()
    three.idle()
    assert document.waiting("A")
    document.select("A")
    three.idle()
    assert "make it as it was" in window.panels.verdict.text
    fitting.fit("A")
    three.idle()
    assert len(document.state.provenances["A"].edits) == 1
    assert np.array_equal(document.surface("A").patches[-1].control, control)


def scene(app):
    """What a person set up in the scene."""
    view = app.window.panels.view
    chosen = {layer.key: (layer.visible, layer.opacity) for layer in view.layers if layer.horizon in ("A", "A1")}
    target, names = view.canvas.target, ("section", "orthographic", "faded", "clip")
    looks = (*(target.centre + view.canvas.origin * (1, 1, view.canvas.stretch)), target.distance, *target.axes[0])
    return (
        {key.replace("A1", "A"): one for key, one in chosen.items()},
        np.round(looks, 6).tolist(),
        view.canvas.stretch,
        [app.window.actions_[name].isChecked() for name in names],
        None if app.window.showing.line is None else app.window.showing.line.tolist(),
        sum(handle.drawn for handle in view.handles()),
        np.round([handle.xyz for handle in view.handles()[-6:]], 6).tolist(),
    )


def test_the_scene_stays_as_it_was_set_up_until_another_site_is_opened(three, tmp_path):
    window, fitting = three.window, three.window.fitting
    fitting.fit_all()
    three.idle()
    layers, view = window.panels.view.layers, window.panels.view
    layers.change("points:A", visible=False)
    layers.change("surface:A", opacity=0.3)
    window.actions_["section"].setChecked(True)
    window.actions_["orthographic"].setChecked(True)
    window.actions_["faded"].setChecked(False)
    window.actions_.exaggerations.actions()[-1].trigger()
    window.actions_["clip"].setChecked(True)
    east = view.handles()[-3]
    east.moved(east.xyz - (20.0, 0.0, 0.0))
    assert view.handles()[-3].xyz[0] == east.xyz[0] - 20.0
    view.view("north")
    view.canvas.land()
    three.idle()
    before = scene(three)
    assert before[0]["surface:A"] == (True, 0.3)
    assert before[4] is not None
    for change in (
        lambda: fitting.push(RenameHorizon("A", "A1")),
        lambda: fitting.push(RemoveHorizons(("C",))),
        lambda: window.menus.undo.trigger(),
        lambda: window.menus.undo.trigger(),
        lambda: three.desktop.change_language("zh_CN"),
        lambda: three.desktop.change_language("en"),
    ):
        change()
        three.idle()
        assert scene(three) == before
    checked = [action.data() for action in three.window.actions_.exaggerations.actions() if action.isChecked()]
    assert checked == [before[2]]
    three.desktop.session.begin(read_site(tmp_path / "site.toml"), tmp_path / "site.toml")
    three.idle()
    assert three.window.panels.view.layers["points:A"].visible
    assert not any(three.window.actions_[name].isChecked() for name in ("section", "clip"))
    assert not any(handle.drawn for handle in three.window.panels.view.handles())


def test_a_fit_goes_to_the_horizon_that_was_renamed_meanwhile(three):
    fitting, document = three.window.fitting, three.document
    fitting.fit_all()
    begun(three)
    fitting.push(RenameHorizon("A", "A1"))
    fitting.push(RenameHorizon("B", "B1"))
    three.idle()
    assert set(document.surfaces()) == {"A1", "B1", "C"}
    assert [document.surface(name).name for name in ("A1", "B1")] == ["A1", "B1"]
    fitting.examine("A1")
    fitting.adjust("B1", Move("periphery", 3, 3, 0.4))
    fitting.push(RenameHorizon("A1", "A"))
    fitting.push(RenameHorizon("B1", "B"))
    three.idle()
    assert document.prediction("A") is not None
    assert len(document.state.provenances["B"].edits) == 1


def test_a_queue_goes_on_without_the_horizons_that_are_gone(three):
    fitting, document, said = three.window.fitting, three.document, []
    fitting.reported.connect(said.append)
    fitting.fit_all()
    begun(three)
    fitting.push(RemoveHorizons(("A", "B")))
    three.idle()
    assert set(document.surfaces()) == {"C"}
    assert [text.split("'")[1] for text in said] == ["A", "B"]
    assert not three.window.actions_["stop"].isEnabled()


def test_a_body_that_is_renamed_or_deleted_while_it_is_fitted_does_not_come_back(three):
    bodies, fitting, document, said = three.window.bodies, three.window.fitting, three.document, []
    bodies.reported.connect(said.append)
    fitting.fit_all()
    three.idle()
    bodies.fit("clay", BetweenHorizons("A", "B"), BodySettings())
    begun(three)
    # A new body that is under way follows the names of its horizons.
    fitting.push(RenameHorizon("B", "B1"))
    three.idle()
    assert document.state.bodies["clay"].provenance.source == BetweenHorizons("A", "B1")
    assert not bodies.showing.stale("clay")
    assert document.body("clay") is not None
    bodies.fit("clay", BetweenHorizons("A", "C"), BodySettings())
    begun(three)
    fitting.push(RenameBody("clay", "lens"))
    three.idle()
    assert list(document.state.bodies) == ["lens"]
    assert document.state.bodies["lens"].provenance.source == BetweenHorizons("A", "B1")
    bodies.fit("lens", BetweenHorizons("A", "C"), BodySettings())
    begun(three)
    fitting.push(DeleteBody("lens"))
    three.idle()
    assert document.state.bodies == {}
    assert [text.split(" was")[0] for text in said if "discarded" in text] == ["Body clay", "Body lens"]


def test_an_earlier_state_is_compared_under_the_new_name(three, tmp_path):
    window, document = three.window, three.document
    window.fitting.fit("A")
    three.idle()
    written(tmp_path, [*rows("A", 100, 1), *rows("B", 80, 2), *rows("C", 60, 3), "N,150,150,110,A"])
    window.living.reload()
    three.idle()
    window.fitting.push(RenameHorizon("A", "A1"))
    document.select("A1")
    three.idle()
    assert "A1: 1 new, 0 corrected, 0 gone" in window.panels.changes.pages.text
    window.fitting.fit("A1")
    three.idle()
    assert document.comparison("A1") is not None


def test_a_task_that_cannot_begin_keeps_no_other_from_its_turn(qtbot, qapp):
    activity, heard = Activity(), []

    def broken():
        activity.cancel()
        raise ValueError("nothing to work on")

    activity.failed.connect(lambda title, error: heard.append((title, str(error))))
    activity.ended.connect(lambda: heard.append("ended"))
    activity.prepare("first", broken, on_done=heard.append)
    assert heard == [("first", "nothing to work on"), "ended"]
    assert not activity.busy
    activity.do("second", lambda progress: 2, on_done=heard.append)
    qtbot.waitUntil(lambda: not activity.busy)
    assert heard[2:] == [2, "ended"]
