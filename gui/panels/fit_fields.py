"""The fields of a fit's settings as widgets: each takes and gives one value, and says when it changes."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QLabel, QLineEdit, QSizePolicy, QWidget

__all__ = ["AutoField", "ChoiceField", "CoreField", "Field", "NumberField", "NumbersField"]


class NumberField(QWidget):
    """A number with its unit. What cannot be read as a number is handed on as text, for the settings to refuse."""

    changed = Signal()

    def __init__(self, unit: str = "", *, whole: bool = False) -> None:
        super().__init__()
        self._whole = whole
        self.edit = QLineEdit()
        self.edit.setAlignment(Qt.AlignmentFlag.AlignRight)
        self.edit.setMinimumWidth(54)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(4)
        row.addWidget(self.edit, 1)
        if unit:
            row.addWidget(QLabel(unit))
        self.edit.textEdited.connect(lambda _: self.changed.emit())
        self.setFocusProxy(self.edit)

    def value(self) -> Any:
        """Return the number, or the text if it is none."""
        text = self.edit.text().strip()
        try:
            return int(text) if self._whole else float(text)
        except ValueError:
            return text

    def put(self, value: Any) -> None:
        """Show a number without emitting."""
        if self.value() != value:
            self.edit.setText(_shortest(value) if isinstance(value, float) else str(value))


def _shortest(value: float) -> str:
    """Return a number in as few digits as give it back: a form that rounds would apply another one."""
    short = f"{value:g}"
    return short if float(short) == value else repr(value)


class ChoiceField(QWidget):
    """One of a few words."""

    changed = Signal()

    def __init__(self, choices: dict[Any, str]) -> None:
        super().__init__()
        self.box = QComboBox()
        self.box.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.box.setMinimumContentsLength(7)
        self.box.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        for value, words in choices.items():
            self.box.addItem(words, value)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.box)
        self.box.activated.connect(lambda _: self.changed.emit())
        self.setFocusProxy(self.box)

    def value(self) -> Any:
        """Return the word of the settings."""
        return self.box.currentData()

    def put(self, value: Any) -> None:
        """Show a word without emitting."""
        self.box.setCurrentIndex(max(self.box.findData(value), 0))


class AutoField(QWidget):
    """A number that may be left to the fit; ``automatic`` is what the settings hold then."""

    changed = Signal()

    def __init__(self, automatic: Any, words: dict[bool, str], *, whole: bool = False, start: float = 1) -> None:
        super().__init__()
        self._automatic, self._start = automatic, start
        self.box = QComboBox()
        self.box.addItem(words[True])
        self.box.addItem(words[False])
        self.box.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.box.setMinimumContentsLength(6)
        self.box.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.number = NumberField(whole=whole)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(4)
        row.addWidget(self.box, 1)
        row.addWidget(self.number, 1)
        self.number.hide()
        self.box.activated.connect(self._switch)
        self.number.changed.connect(self.changed)
        self.setFocusProxy(self.box)

    def value(self) -> Any:
        """Return the number or what represents the fit's choice."""
        return self._automatic if self.box.currentIndex() == 0 else self.number.value()

    def put(self, value: Any) -> None:
        """Show a value without emitting."""
        fixed = value != self._automatic
        self.box.setCurrentIndex(int(fixed))
        self.number.setVisible(fixed)
        if fixed:
            self.number.put(value)

    def _switch(self, index: int) -> None:
        self.number.setVisible(index == 1)
        if index == 1 and self.number.value() == "":
            self.number.put(self._start)
        self.changed.emit()


class NumbersField(QWidget):
    """So many numbers in one line, apart by spaces; nothing where ``empty`` is what the settings hold then.

    What cannot be read as these numbers is handed on as text, for the settings to refuse. ``rows`` numbers make one
    tuple each.
    """

    changed = Signal()

    def __init__(self, count: int, *, rows: int = 0, empty: Any = "", hint: str = "") -> None:
        super().__init__()
        self._count, self._rows, self._empty = count, rows, empty
        self.edit = QLineEdit()
        self.edit.setAlignment(Qt.AlignmentFlag.AlignRight)
        self.edit.setMinimumWidth(54)
        self.edit.setPlaceholderText(hint)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.edit)
        self.edit.textEdited.connect(lambda _: self.changed.emit())
        self.setFocusProxy(self.edit)

    def value(self) -> Any:
        """Return the numbers as a tuple, or of tuples; the text if they are not these."""
        text = self.edit.text().strip()
        if not text:
            return self._empty
        try:
            numbers = tuple(float(word) for word in text.replace(";", " ").split())
        except ValueError:
            return text
        if len(numbers) != self._count:
            return text
        step = self._rows
        return tuple(numbers[k : k + step] for k in range(0, self._count, step)) if step else numbers

    def put(self, value: Any) -> None:
        """Show numbers without emitting."""
        if self.value() != value:
            flat = [] if value == self._empty else [x for one in value for x in (one if self._rows else (one,))]
            self.edit.setText(" ".join(_shortest(float(x)) for x in flat))


class CoreField(ChoiceField):
    """Automatic, all, none, or the polygon that was drawn in the plan."""

    def __init__(self, choices: dict[Any, str], drawn: str) -> None:
        super().__init__(choices)
        self._drawn = drawn
        self._plain = len(choices)

    def value(self) -> Any:
        """Return a word or the polygon."""
        found = self.box.currentData()
        return found if isinstance(found, str) else tuple(tuple(corner) for corner in found)

    def put(self, value: Any) -> None:
        """Show a word or a polygon; the last polygon stays on offer."""
        if isinstance(value, str):
            super().put(value)
            return
        while self.box.count() > self._plain:
            self.box.removeItem(self._plain)
        self.box.addItem(self._drawn.format(n=len(value)), value)
        self.box.setCurrentIndex(self._plain)

    def forget(self) -> None:
        """Drop the polygon, when another horizon is shown."""
        while self.box.count() > self._plain:
            self.box.removeItem(self._plain)


#: What the panel works with: each takes and gives one value, and ``changed`` reports each keystroke or choice.
Field = NumberField | ChoiceField | AutoField | NumbersField
