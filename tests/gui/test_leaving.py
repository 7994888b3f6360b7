"""Leaving a site: what is asked, what a save that fails leaves behind, and tasks that run meanwhile."""

from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtWidgets import QFileDialog, QMessageBox

from geofit.project.commands import RenameSite


def written(folder, horizons, count=40):
    """A site of tilted planes with errors of centimetres."""
    folder.mkdir()
    rng = np.random.default_rng(0)
    rows = ["x,y,z,horizon"]
    for k, name in enumerate(horizons):
        for x, y in rng.uniform(0, 1000, (count, 2)):
            rows.append(f"{x:.2f},{y:.2f},{100 - 10 * k + 0.02 * x + rng.normal(0, 0.05):.3f},{name}")
    (folder / "p.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    (folder / "site.toml").write_text('[site]\nname = "S"\n[[picks]]\nfile = "p.csv"\n', encoding="utf-8")
    return folder / "site.toml"


@pytest.fixture
def answers(monkeypatch):
    """What the user answers when asked whether to save; each question takes one."""
    given = []
    monkeypatch.setattr(QMessageBox, "exec", lambda box: given.pop(0))
    return given


def test_a_save_that_failed_on_leaving_is_forgotten(app, tmp_path, answers, monkeypatch):
    app.window.files.open(written(tmp_path / "one", ["a"]))
    app.idle()
    app.window.fitting.push(RenameSite("Other"))
    chosen = [tmp_path / "one" / "p.csv" / "dam.geofit", tmp_path / "dam.geofit"]
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_, **__: (str(chosen.pop(0)), ""))
    answers.append(QMessageBox.StandardButton.Save)
    app.window.close()
    app.qtbot.waitUntil(app.rests)
    assert app.failures
    app.failures.clear()
    app.trigger("save")
    app.idle()
    assert (tmp_path / "dam.geofit").is_file()
    assert app.window.isVisible(), "the second save was not asked to close the window"


def test_what_was_fitted_while_it_was_saved_is_asked_again(app, tmp_path, answers, monkeypatch):
    app.window.files.open(written(tmp_path / "one", ["a"]))
    app.idle()
    app.window.fitting.push(RenameSite("Other"))
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_, **__: (str(tmp_path / "dam.geofit"), ""))
    answers += [QMessageBox.StandardButton.Save, QMessageBox.StandardButton.Discard]
    app.window.fitting.fit("a")
    app.window.files.close()
    app.idle()
    assert not answers
    assert not app.document.is_open


def test_another_site_does_not_wait_for_the_fits_of_the_one_that_is_left(app, tmp_path):
    one, two = written(tmp_path / "one", ["a", "b", "c"], 300), written(tmp_path / "two", ["q"])
    app.window.files.open(one)
    app.idle()
    fitted = []
    app.document.result_changed.connect(fitted.append)
    app.window.fitting.fit_all()
    app.window.files.open(two)
    app.idle()
    assert app.document.horizons == ("q",)
    assert not fitted
