"""With the keyboard alone: Tab follows the layout and is not caught, keys are unique, Enter does what is shown."""

from __future__ import annotations

import re
import shutil
from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
from panel_samples import FAULT, SITE, WITH_PERIPHERY, fitted, sample_site
from PySide6.QtCore import QPoint, QRect, Qt
from PySide6.QtGui import QKeySequence, QUndoStack
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QAbstractSpinBox,
    QComboBox,
    QDialog,
    QGroupBox,
    QLabel,
    QLineEdit,
    QMenu,
    QPlainTextEdit,
    QPushButton,
    QTabBar,
    QTextEdit,
    QWidget,
)

from geofit.gui.dialogs.order import OrderDialog
from geofit.gui.dialogs.survey import SurveyDialog
from geofit.gui.language import apply_language
from geofit.project.commands import SetSurface

#: What a user enters, chooses or presses.
FIELDS = (
    QAbstractButton, QAbstractItemView, QAbstractSpinBox, QComboBox, QLineEdit, QPlainTextEdit, QTabBar, QTextEdit,
)  # fmt: skip


def box(widget: QWidget) -> QRect:
    return QRect(widget.mapTo(widget.window(), QPoint(0, 0)), widget.size())


def own(window: QWidget) -> list[QWidget]:
    """The fields that are seen, without the parts that Qt's own are made from."""
    found = []
    for widget in window.findChildren(QWidget):
        parent = widget.parentWidget()
        inner = isinstance(parent, (QAbstractSpinBox, QComboBox, QAbstractItemView))
        inner |= widget.objectName().startswith("qt_")
        if isinstance(widget, FIELDS) and widget.isVisible() and not inner and widget.window() is window.window():
            found.append(widget)
    return found


def name_of(widget: QWidget) -> str:
    text = getattr(widget, "text", None)
    words = text() if callable(text) else ""
    return f"{type(widget).__name__} '{words or widget.accessibleName() or widget.objectName()}'"


def way(window: QWidget) -> list[QWidget]:
    """The fields that Tab leads to, in its order, each as if enabled."""
    found, widget, fields = [], window.nextInFocusChain(), set(map(id, own(window)))
    while widget is not window:
        if id(widget) in fields and widget.focusPolicy() & Qt.FocusPolicy.TabFocus and widget.focusProxy() is None:
            found.append(widget)
        widget = widget.nextInFocusChain()
    return found


def steps_back(window: QWidget) -> list[tuple[str, str]]:
    """Steps of Tab that lead up, or to the left in one row, against the order in which one reads."""
    wrong = []
    for a, b in pairwise(way(window)):
        one, next_ = box(a), box(b)
        row = min(one.bottom(), next_.bottom()) - max(one.top(), next_.top()) > 0.5 * min(one.height(), next_.height())
        above = next_.bottom() < one.top() and not next_.left() > one.right()
        if above or (row and next_.right() < one.left()):
            wrong.append((name_of(a), name_of(b)))
    return wrong


def unreachable(window: QWidget) -> list[str]:
    """Fields that Tab passes over; of radio buttons and tabs arrows reach the others."""
    reached = set(map(id, way(window)))
    return [
        name_of(one)
        for one in own(window)
        if id(one) not in reached and not one.focusPolicy() & Qt.FocusPolicy.TabFocus and one.focusProxy() is None
    ]


def traps(window: QWidget) -> list[str]:
    """Fields that Tab enters and does not leave."""
    return [
        name_of(one)
        for one in own(window)
        if (isinstance(one, QAbstractItemView) and one.tabKeyNavigation())
        or (isinstance(one, (QPlainTextEdit, QTextEdit)) and not (one.tabChangesFocus() or one.isReadOnly()))
    ]


def keys(window: QWidget) -> dict[str, list[str]]:
    """Keys with Alt of what is seen, with the texts that have them."""
    known: dict[str, list[str]] = {}
    for widget in window.findChildren(QWidget):
        if not widget.isVisible() or widget.window() is not window.window():
            continue
        texts = []
        if isinstance(widget, QGroupBox):
            texts = [widget.title()]
        elif isinstance(widget, QAbstractButton) or (isinstance(widget, QLabel) and widget.buddy() is not None):
            texts = [widget.text()]
        elif isinstance(widget, QTabBar):
            texts = [widget.tabText(k) for k in range(widget.count())]
        for text in texts:
            key = QKeySequence.mnemonic(text).toString()
            if key:
                known.setdefault(key, []).append(text)
    return known


def keys_twice(window: QWidget) -> list[tuple[str, list[str]]]:
    """Keys with Alt that two fields share which are seen at once."""
    return [(key, texts) for key, texts in keys(window).items() if len(texts) > 1]


def nameless(window: QWidget) -> list[str]:
    """Fields that a screen reader has no word for."""
    buddies = {id(label.buddy()) for label in window.findChildren(QLabel) if label.buddy() is not None}
    wrong = []
    for widget in own(window):
        named = bool(widget.accessibleName()) or id(widget) in buddies or isinstance(widget, QTabBar)
        if isinstance(widget, QAbstractButton):
            named |= bool(re.search(r"\w", widget.text()))
        if not named:
            wrong.append(f"{name_of(widget)} of {type(widget.parentWidget()).__name__} at {box(widget).getRect()}")
    return wrong


def entered(dialog: QDialog) -> str | None:
    """Text of the button that Enter presses, as Qt chooses it; None without any."""
    buttons = [one for one in dialog.findChildren(QPushButton) if one.isVisible() and one.window() is dialog]
    chosen = [one for one in buttons if one.isDefault()]
    return chosen[0].text() if chosen else None


LINE = np.array([[500_500.0, 3_100_500.0], [501_500.0, 3_101_500.0]])


def raw(_):
    from geofit.gui.dialogs.raw_volume import RawVolumeDialog

    return RawVolumeDialog("core.raw", (2, 3, 4), "u2", None)


def rock(_):
    from geofit.gui.dialogs.rock_volume import RockVolumeDialog

    return RockVolumeDialog()


def survey(_):
    return SurveyDialog(dict, lambda: True)


def step(_):
    from geofit.gui.dialogs.export_step import ExportDialog

    dialog = ExportDialog({name: fitted(name) for name in (FAULT, WITH_PERIPHERY)})
    dialog.origin.choice.setCurrentIndex(dialog.origin.choice.findData("datum"))
    return dialog


def body_step(_):
    from geofit.gui.dialogs.step_fields import BodyStepDialog

    return BodyStepDialog("ORE", sample_site())


def report(_):
    from geofit.gui.dialogs.report import ReportDialog
    from geofit.report.result import HorizonResult

    return ReportDialog(sample_site(), [HorizonResult(fitted(FAULT), sample_site())])


def section_sheet(folder):
    from geofit.gui.dialogs.section_sheet import SectionSheetDialog

    return SectionSheetDialog(sample_site(), {FAULT: fitted(FAULT)}, LINE, 50.0, {}, {}, folder)


def plan_sheet(folder):
    from geofit.gui.dialogs.plan_sheet import PlanSheetDialog

    return PlanSheetDialog(sample_site(), {FAULT: fitted(FAULT)}, FAULT, folder)


def preferences(_):
    from geofit.gui.dialogs.preferences import PreferencesDialog
    from geofit.gui.preferences import Preferences

    return PreferencesDialog(Preferences())


def order(_):
    return OrderDialog(("a", "b", "c"))


def builder(_):
    from geofit.gui.dialogs.horizon_builder import HorizonBuilder

    return HorizonBuilder(sample_site(), tuple(sample_site().horizons))


def horizon_bodies(_):
    from geofit.gui.dialogs.horizon_bodies import HorizonBodies

    return HorizonBodies(("a", "b"), 0.0)


def issues(_):
    from geofit.gui.dialogs.issues import IssuesDialog

    return IssuesDialog(sample_site())


def failure(_):
    from geofit.gui.dialogs.error import ErrorDialog

    return ErrorDialog("Fit", ValueError("x"))


def help_page(_):
    from geofit.gui.dialogs.help_page import HelpPage

    return HelpPage(None)


def steps(_):
    from geofit.gui.dialogs.steps import StepsDialog

    stack = QUndoStack()
    dialog = StepsDialog(stack)
    stack.setParent(dialog)
    return dialog


def system_report(_):
    from geofit.gui.dialogs.system_report import SystemReport

    return SystemReport()


def recovery(_):
    from geofit.gui.dialogs.recovery import RecoveryDialog

    return RecoveryDialog([])


def wizard(folder):
    from geofit.gui.wizard.import_wizard import ImportWizard

    (folder / "picks.csv").write_text("hole,x,y,z\na,1,2,3\nb,2,3,4\n", encoding="utf-8")
    return ImportWizard([folder / "picks.csv"], folder)


#: Each dialog with what Enter presses.
DIALOGS = {
    raw: "Open", rock: "Find pores", survey: "Make body", step: "Write", body_step: "Write", report: "Write",
    section_sheet: "Write", plan_sheet: "Write", preferences: "OK", order: "OK", builder: "Add horizon",
    horizon_bodies: "OK", issues: "Close", failure: "Close", steps: "Close", system_report: "Close",
    recovery: "Bring back", wizard: "Read", help_page: "Close",
}  # fmt: skip


@pytest.mark.parametrize("code", ["en", "zh_CN"])
@pytest.mark.parametrize("make", DIALOGS, ids=lambda make: make.__name__)
def test_a_dialog_is_worked_with_the_keyboard(qtbot, tmp_path, make, code):
    apply_language(code)
    try:
        dialog = make(tmp_path)
        qtbot.addWidget(dialog)
        dialog.show()
        qtbot.waitExposed(dialog)
        if make is wizard:
            qtbot.waitUntil(lambda: not dialog.running and len(way(dialog)) > 12)
        assert steps_back(dialog) == []
        assert unreachable(dialog) == []
        assert traps(dialog) == []
        assert keys_twice(dialog) == []
        assert nameless(dialog) == []
        if code == "en":
            assert (entered(dialog) or "").replace("&", "") == DIALOGS[make]
        QTest.keyClick(dialog, Qt.Key.Key_Escape)
        assert not dialog.isVisible()
    finally:
        apply_language("en")


@pytest.mark.parametrize("code", ["en", "zh_CN"])
def test_every_page_of_the_import_is_worked_with_the_keyboard(qtbot, tmp_path, code):
    from geofit.gui.wizard.import_wizard import ImportWizard

    for name in ("collar.csv", "lithology.csv"):
        shutil.copy(SITE.parent / name, tmp_path)
    apply_language(code)
    try:
        dialog = ImportWizard(sorted(tmp_path.glob("*.csv")), tmp_path)
        qtbot.addWidget(dialog)
        dialog.show()
        for button in (dialog.go, dialog.build):
            qtbot.waitUntil(lambda button=button: not dialog.running and button.isEnabled() and button.isVisible())
            button.click()
            qtbot.waitUntil(lambda: not dialog.running)
            assert steps_back(dialog) == []
            assert unreachable(dialog) == []
            assert traps(dialog) == []
            assert keys_twice(dialog) == []
            assert nameless(dialog) == []
            assert entered(dialog) == dialog.go.text()
        dialog.reject()
    finally:
        apply_language("en")


@pytest.fixture(params=["en", "zh_CN"])
def shown(app, request):
    """The window with a surface, in either language."""
    app.desktop.session.begin(sample_site(), SITE)
    app.document.select(WITH_PERIPHERY)
    provenance = app.document.provenance(WITH_PERIPHERY)
    app.document.put(provenance, fitted())
    app.window.fitting.push(SetSurface(provenance))
    app.idle()
    app.desktop.change_language(request.param)
    app.idle()
    yield app
    app.desktop.change_language("en")
    app.idle()


def menus(bar):
    """Yield a menu bar's menus, those below, too."""
    below = [action.menu() for action in bar.actions() if isinstance(action.menu(), QMenu)]
    for menu in below:
        yield menu
        yield from menus(menu)


def test_keys_of_the_menus_are_unique(shown):
    window = shown.window
    for menu in (window.menuBar(), *menus(window.menuBar())):
        keys = Counter(QKeySequence.mnemonic(action.text()).toString() for action in menu.actions())
        del keys[""]
        assert [key for key, n in keys.items() if n > 1] == []
    keys = Counter(key.toString() for action in window.actions() for key in action.shortcuts())
    keys.update(key.toString() for action in (window.menus.undo, window.menus.redo) for key in action.shortcuts())
    assert [key for key, n in keys.items() if n > 1] == []


def test_every_panel_is_worked_with_the_keyboard(shown):
    window = shown.window
    bar = {QKeySequence.mnemonic(action.text()).toString() for action in window.menuBar().actions()}
    for name, dock in window.panels.docks.items():
        window.panels.reveal(name)
        shown.idle()
        known = [one for one in nameless(window) if one]
        assert known == [], name
        assert keys_twice(window) == [], name
        assert not [key for key in keys(window) if key in bar], name
        assert traps(window) == [], name
        assert steps_back(dock.widget()) == [], name
