"""Errors that nobody foresaw: the log has their traceback, in every language, and one dialog tells of them."""

from __future__ import annotations

import logging
import sys
import threading

import pytest

from geofit.gui.main_window import MainWindow


def broken():
    raise IndexError("no such row")


def hear(desktop):
    """Let the application hear an error as Python's hook would."""
    try:
        broken()
    except IndexError as error:
        desktop.hear_mistake(type(error), error, error.__traceback__)


@pytest.fixture
def log(app):
    return lambda: app.window.panels.log.text.toPlainText()


def test_a_mistake_is_in_the_log_with_its_traceback(app, log):
    hear(app.desktop)
    assert [type(error) for error in app.failures] == [IndexError]
    assert "IndexError: no such row" in log()
    assert 'raise IndexError("no such row")' in log()


def test_a_program_without_a_console_loses_no_traceback(app, log, monkeypatch):
    monkeypatch.setattr(sys, "stderr", None)
    hear(app.desktop)
    assert 'raise IndexError("no such row")' in log()


def test_a_mistake_that_comes_back_while_its_dialog_is_shown_opens_no_other(app, log, monkeypatch):
    shown = []

    def fail(window, title, error):
        shown.append(error)
        hear(app.desktop)  # as a panel that fails whenever it is drawn

    monkeypatch.setattr(MainWindow, "fail", fail)
    hear(app.desktop)
    assert len(shown) == 1
    assert log().count("error: IndexError: no such row") == 2
    hear(app.desktop)
    assert len(shown) == 2


def test_a_mistake_in_a_thread_opens_no_dialog_there(app, log, qtbot):
    thread = threading.Thread(target=hear, args=(app.desktop,))
    thread.start()
    thread.join()
    qtbot.waitUntil(lambda: 'raise IndexError("no such row")' in log())
    assert not app.failures


def test_the_log_goes_on_in_another_language(app, log):
    hear(app.desktop)
    logging.getLogger("geofit.gui").warning("before")
    app.desktop.change_language("zh_CN")
    assert "警告: before" in log()
    assert 'raise IndexError("no such row")' in log()
    app.window.panels.log.clear()
    app.desktop.change_language("en")
    assert "before" not in log()
