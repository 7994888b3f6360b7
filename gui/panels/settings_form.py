"""A form over frozen settings: words from the settings table, each field checked for itself, few fields first."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from typing import Any

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QPalette
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QScrollArea, QSizePolicy, QToolButton, QVBoxLayout, QWidget

from geofit.data.errors import SettingsError
from geofit.data.setting_texts import SettingText
from geofit.gui.panels.fit_fields import Field
from geofit.gui.panels.marks import readable
from geofit.gui.translate import translated
from geofit.report.style import FAIL

__all__ = ["SettingsForm", "scrolling"]


class SettingsForm(QWidget):
    """Fields with their labels and errors; those that are not ``first`` unfold.

    ``make`` makes the settings of keywords and raises SettingsError; ``changed`` reports each keystroke or choice.
    """

    changed = Signal()

    def __init__(self, texts: Mapping[str, SettingText], make: Callable[..., Any], first: tuple[str, ...]) -> None:
        super().__init__()
        self._texts, self._make, self._first = texts, make, first
        self.fields: dict[str, Field] = {}
        self.errors: dict[str, QLabel] = {}
        self._form, self._rest = QVBoxLayout(), QVBoxLayout()
        for form in (self._form, self._rest):
            form.setSpacing(2)
            form.setContentsMargins(0, 0, 0, 0)
        self.more = QToolButton()
        self.more.setText(self.tr("More settings"))
        self.more.setCheckable(True)
        self.more.setAutoRaise(True)
        self.more.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        others = QWidget()
        others.setLayout(self._rest)
        column = QVBoxLayout(self)
        column.setContentsMargins(8, 8, 8, 8)
        column.setSpacing(6)
        column.addLayout(self._form)
        column.addWidget(self.more)
        column.addWidget(others)
        column.addStretch(1)
        self.more.toggled.connect(others.setVisible)
        self.more.toggled.connect(self._turn_arrow)
        others.hide()
        self._turn_arrow(False)

    def choices(self, name: str) -> dict[object, str]:
        """Return the words of a setting's choices in the user's language."""
        return {value: translated(text) for value, text in self._texts[name].choices.items()}

    def head(self, words: str) -> None:
        """Put a heading before the fields that follow, among those that unfold."""
        label = QLabel(words)
        font = label.font()
        font.setBold(True)
        label.setFont(font)
        self._rest.addSpacing(4)
        self._rest.addWidget(label)

    def add(self, name: str, field: Field) -> None:
        """Add the field of a setting."""
        words, about = translated(self._texts[name].label), translated(self._texts[name].about)
        label, error = QLabel(words), QLabel()
        label.setBuddy(field)
        # In large text it takes two lines rather than losing its end.
        label.setWordWrap(True)
        label.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Preferred)
        label.setMinimumWidth(40)
        error.setWordWrap(True)
        error.hide()
        for widget in (label, field):
            widget.setToolTip(about)
        target = field.focusProxy() or field
        target.setAccessibleName(words)
        target.setAccessibleDescription(about)
        row = QHBoxLayout()
        row.setSpacing(6)
        row.addWidget(label, 5)
        row.addWidget(field, 5)
        form = self._form if name in self._first else self._rest
        form.addLayout(row)
        form.addWidget(error)
        field.changed.connect(self.changed)
        if name in self._first:
            QWidget.setTabOrder(target, self.more)
        self.fields[name], self.errors[name] = field, error

    def put(self, settings: Any, keep: Collection[str] = ()) -> None:
        """Show settings without emitting, but in the fields to ``keep``."""
        for name, field in self.fields.items():
            if name not in keep:
                field.put(getattr(settings, name))

    def written(self, base: Any) -> set[str]:
        """Return the names of fields in which something else is written than ``base`` has."""
        return {name for name, field in self.fields.items() if field.value() != getattr(base, name)}

    def edited(self) -> Any | None:
        """Return the settings as written in the form; None while one is out of its range."""
        try:
            return self._make(**{name: field.value() for name, field in self.fields.items()})
        except SettingsError:
            return None

    def check(self, base: Any) -> Any | None:
        """Validate each field for itself, so that every error is next to its own field; return the settings if sound.

        ``base`` are settings that are sound, with which each value is tried.
        """
        sound = True
        for name, field in self.fields.items():
            value, text = field.value(), ""
            try:
                replace(base, **{name: value})
            except SettingsError as error:
                text = translated(str(error))
                if isinstance(value, str) and "," in value:
                    text = self.tr("Write the decimal mark as a point: 0.5, not 0,5.")
            colours = self.errors[name].palette()
            colours.setColor(QPalette.ColorRole.WindowText, readable(FAIL, self.palette()))
            self.errors[name].setPalette(colours)
            self.errors[name].setText(text)
            self.errors[name].setVisible(bool(text))
            if text and name not in self._first:
                self.more.setChecked(True)
            sound = sound and not text
        return self.edited() if sound else None

    def _turn_arrow(self, unfolded: bool) -> None:
        self.more.setArrowType(Qt.ArrowType.DownArrow if unfolded else Qt.ArrowType.RightArrow)


def scrolling(content: QWidget) -> QScrollArea:
    """Return an area that scrolls its content up and down."""
    scroll = QScrollArea()
    scroll.setWidget(content)
    scroll.setWidgetResizable(True)
    scroll.setFrameShape(QFrame.Shape.NoFrame)
    scroll.setFocusPolicy(Qt.FocusPolicy.NoFocus)
    scroll.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
    return scroll
