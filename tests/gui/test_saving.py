"""Projects through the window: files that changed while it was closed, two windows on one project, a full disk."""

from __future__ import annotations

import errno
import json
import shutil

import numpy as np
import pytest
from PySide6.QtWidgets import QFileDialog, QMessageBox

from geofit.project.commands import RenameSite
from geofit.project.journal import unfinished
from geofit.project.named_points import excluded_names
from geofit.project.provenance import Row
from geofit.project.saving import read_project, save_state

HEAD = "hole,x,y,z,horizon"
NEW = ("N1,10,10,100.5,T2", "N2,20,10,100.9,T2")


def picks():
    rng = np.random.default_rng(1)
    return [
        f"B{k},{x:.2f},{y:.2f},{100 + 0.05 * x + rng.normal(0, 0.05):.3f},T2"
        for k, (x, y) in enumerate(rng.uniform(0, 400, (40, 2)))
    ]


def written(folder, lines):
    (folder / "picks.csv").write_text("\n".join([HEAD, *lines]) + "\n", encoding="utf-8")


@pytest.fixture
def folder(app, tmp_path):
    """The folder of a site that is open, with row 5 (hole B3) excluded."""
    folder = tmp_path / "site"
    folder.mkdir()
    written(folder, picks())
    (folder / "site.toml").write_text(
        '[site]\nname = "Dam"\n[[picks]]\nfile = "picks.csv"\nkind = "borehole"\n', encoding="utf-8"
    )
    app.window.files.open(folder / "site.toml")
    app.idle()
    app.window.fitting.exclude("T2", [Row("picks.csv", 5)])
    return folder


@pytest.fixture
def answers(monkeypatch):
    """What the user answers; each question takes one."""
    given = []
    monkeypatch.setattr(QMessageBox, "exec", lambda box: given.pop(0))
    return given


def full_disk(handle):
    raise OSError(errno.ENOSPC, "No space left on device")


def excluded_holes(document):
    points = document.site.horizons["T2"]
    return {str(points.hole[row.find(points)]) for row in document.state.excluded.get("T2", ())}


def saved(app, path):
    app.window.files.save_to(path)
    app.idle()
    assert not app.document.dirty
    return path


def test_exclusions_follow_their_points_while_the_project_is_closed_and_losses_are_shown(app, folder, caplog):
    app.window.fitting.exclude("T2", [Row("picks.csv", 9)])
    path = saved(app, folder / "dam.geofit")
    app.window.files.close()
    lines = picks()
    del lines[7]
    written(folder, [*NEW, *lines])
    said = []
    app.window.files.reported.connect(said.append)
    app.window.files.open(path)
    app.idle()
    assert excluded_holes(app.document) == {"B3"}
    assert app.document.dirty
    assert any("exclusion of picks.csv row 9 is lost" in text for text in said)
    panel = app.window.panels.changes
    assert panel.isVisible()
    assert "exclusion of picks.csv row 9 is lost" in panel.pages.text
    assert "have not changed" not in panel.pages.text
    assert "on another line" in caplog.text
    # Saved and opened again there is nothing left to say.
    saved(app, path)
    app.window.files.open(path)
    app.idle()
    assert not app.document.dirty
    assert excluded_holes(app.document) == {"B3"}
    assert "have not changed" in panel.pages.text


def test_exclusions_follow_their_points_when_a_session_is_brought_back(app, folder, tmp_path, caplog):
    app.window.fitting.exclude("T2", [Row("picks.csv", 9)])
    left = app.killed(tmp_path / "left")
    lines = picks()
    del lines[7]
    written(folder, [*NEW, *lines])
    (cut,) = unfinished(left)
    app.window.files.recover(cut)
    app.idle()
    assert excluded_holes(app.document) == {"B3"}
    assert app.document.dirty
    assert "exclusion of picks.csv row 9 is lost" in app.window.panels.changes.pages.text
    assert not app.desktop.session.stack.canUndo(), "its steps name lines of the former file"
    # Cut off again, it comes back again.
    (again,) = unfinished(app.killed(tmp_path / "again"))
    app.window.files.recover(again)
    app.idle()
    assert excluded_holes(app.document) == {"B3"}
    assert app.document.dirty


def test_another_window_that_saved_meanwhile_is_not_overwritten_unasked(app, folder, answers, monkeypatch):
    path = saved(app, folder / "dam.geofit")

    def other_window(name):
        found = read_project(path)
        state = RenameSite(name).on(found.state)
        save_state(state, found.site, found.site_file, path, {}, True, progress=lambda *_: True)

    def on_disk(file=path):
        return json.loads(file.read_text("utf-8"))["name"]

    app.window.fitting.push(RenameSite("Mine"))
    other_window("Theirs")
    answers.append(QMessageBox.StandardButton.Cancel)
    app.trigger("save")
    app.idle()
    assert (on_disk(), app.document.dirty, answers) == ("Theirs", True, [])
    # Another name, in a window that was made anew.
    app.desktop.change_lengths("ft")
    app.idle()
    copy = folder / "copy.geofit"
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_, **__: (str(copy), ""))
    answers.append(QMessageBox.StandardButton.No)
    app.trigger("save")
    app.idle()
    assert (on_disk(), on_disk(copy), app.document.dirty) == ("Theirs", "Mine", False)
    # Overwritten, and not asked again.
    app.window.files.open(path)
    app.idle()
    app.window.fitting.push(RenameSite("Mine"))
    other_window("Theirs again")
    answers.append(QMessageBox.StandardButton.Yes)
    app.trigger("save")
    app.idle()
    app.window.fitting.push(RenameSite("Mine too"))
    app.trigger("save")
    app.idle()
    assert (on_disk(), app.document.dirty) == ("Mine too", False)


def test_a_journal_that_cannot_be_written_does_not_stop_a_save(app, folder, monkeypatch, caplog):
    monkeypatch.setattr("geofit.project.journal.os.fsync", full_disk)
    done = []
    app.window.files.save_to(folder / "dam.geofit", lambda: done.append(True))
    app.idle()
    assert done
    assert not app.document.dirty
    assert folder / "dam.geofit" in app.desktop.preferences.recent
    assert "No space left" in caplog.text


def test_a_journal_that_lacks_steps_is_offered_to_nobody(app, folder, monkeypatch):
    journals = app.desktop.journals
    with monkeypatch.context() as patched:
        patched.setattr("geofit.project.journal.os.fsync", full_disk)
        app.window.fitting.exclude("T2", [Row("picks.csv", 6)])
    app.window.fitting.exclude("T2", [Row("picks.csv", 7)])
    assert unfinished(journals) == []
    # The next save begins another one, which has the next steps.
    saved(app, folder / "dam.geofit")
    assert len(list(journals.glob("*.journal"))) == 1
    app.window.fitting.exclude("T2", [Row("picks.csv", 8)])
    (cut,) = unfinished(app.killed(folder / "left"))
    assert len(cut.commands) == 1
    assert cut.final == app.document.state
    # Steps that are older than that journal are undone and done again, too.
    for turn, action in enumerate([*["undo"] * 3, *["redo"] * 2, "undo"]):
        getattr(app.window.menus, action).trigger()
        found = unfinished(app.killed(folder / f"left {turn}"))
        assert [cut.final for cut in found] == [app.document.state] * app.document.dirty
        for name, points in excluded_names(app.document.state, app.document.read).items():
            assert all(points.items() <= cut.names[name].items() for cut in found)
    app.desktop.session.end()
    assert list(journals.glob("*.journal")) == []


def test_a_damaged_surface_is_made_again(app, folder, caplog):
    app.window.fitting.fit("T2")
    app.idle()
    path = saved(app, folder / "dam.geofit")
    app.window.files.close()
    (step,) = (folder / "dam_surfaces").iterdir()
    step.write_bytes(step.read_bytes()[:2000])
    app.window.files.open(path)
    app.idle()
    assert app.document.surface("T2") is not None
    assert "The saved surface of T2 could not be read" in caplog.text
    app.trigger("save")
    app.idle()
    assert read_project(path).changed == {}


def test_the_ending_of_a_project_may_be_in_capitals(app, folder):
    path = folder / "DAM.GEOFIT"
    shutil.move(saved(app, folder / "dam.geofit"), path)
    app.window.files.open(path)
    app.idle()
    assert app.document.project_file == path


def opened_where_it_moved(app, folder, answers, monkeypatch, open_it):
    """Move a site, open it without its new place and then with it, and return that."""
    moved = folder.parent / "moved"
    shutil.move(folder, moved)
    answers += [QMessageBox.StandardButton.Cancel, QMessageBox.StandardButton.Open]
    open_it()
    app.idle()
    assert not app.document.is_open
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_, **__: (str(moved / "site.toml"), ""))
    open_it()
    app.idle()
    assert app.document.site_file == moved / "site.toml"
    return moved


def test_the_new_place_of_a_site_is_asked_for(app, folder, tmp_path, answers, monkeypatch):
    path = saved(app, tmp_path / "dam.geofit")
    app.window.files.close()
    moved = opened_where_it_moved(app, folder, answers, monkeypatch, lambda: app.window.files.open(path))
    assert excluded_holes(app.document) == {"B3"}
    assert app.document.dirty
    saved(app, path)
    app.window.files.open(path)
    app.idle()
    assert app.document.site_file == moved / "site.toml"


@pytest.mark.parametrize("place", ["with", "apart", "nowhere"])
def test_recovery_asks_where_a_site_is_that_was_moved(app, folder, tmp_path, answers, monkeypatch, place):
    project = {"with": folder / "dam.geofit", "apart": tmp_path / "dam.geofit", "nowhere": None}[place]
    if project is not None:
        saved(app, project)
    app.window.fitting.exclude("T2", [Row("picks.csv", 9)])
    holes = excluded_holes(app.document)
    (cut,) = unfinished(app.killed(tmp_path / "left"))
    answers.append(QMessageBox.StandardButton.Discard)
    app.window.files.close()

    def recover():
        assert cut.path.is_file(), "it is offered again"
        app.window.files.recover(cut)

    moved = opened_where_it_moved(app, folder, answers, monkeypatch, recover)
    assert app.document.project_file == {"with": moved / "dam.geofit"}.get(place, project)
    assert excluded_holes(app.document) == holes
    assert app.document.dirty
    if place == "with":
        app.desktop.session.stack.undo()
        assert not app.document.dirty, "the project that was moved with it holds the earlier state"
    else:
        saved(app, tmp_path / "dam.geofit")
        assert read_project(tmp_path / "dam.geofit").site_file == moved / "site.toml"


def test_a_site_file_that_is_gone_is_said_when_the_project_is_saved(app, folder, caplog):
    (folder / "site.toml").unlink()
    saved(app, folder / "dam.geofit")
    assert "the project cannot be opened without it" in caplog.text
