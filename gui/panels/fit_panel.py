"""How a horizon is fitted and judged: every setting with its unit, checked while it is typed."""

from __future__ import annotations

from dataclasses import fields, replace

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QPalette
from PySide6.QtWidgets import (
    QFrame,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QScrollArea,
    QSizePolicy,
    QStyle,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from geofit.data.errors import SettingsError
from geofit.data.setting_texts import SETTINGS
from geofit.data.settings import FitSettings
from geofit.gui.panels.fit_fields import AutoField, ChoiceField, CoreField, Field, NumberField
from geofit.gui.panels.marks import icon, readable
from geofit.gui.panels.placeholder import Placeholder
from geofit.gui.translate import translated
from geofit.report.style import FAIL

__all__ = ["FIRST", "FitPanel"]

#: Fields that are always shown; the others unfold.
FIRST = ("epsilon", "interior_tolerance", "core", "smoothing")


class FitPanel(QWidget):
    """A form over one horizon's settings.

    ``applied`` carries the name and the settings; ``fit_requested`` follows it where there was something to apply.
    """

    applied = Signal(str, object)
    fit_requested = Signal(str)
    fit_all_requested = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._name, self._settings, self._stale, self._locked = "", FitSettings(), False, False
        self.fields: dict[str, Field] = {}
        self.errors: dict[str, QLabel] = {}
        self._labels: dict[str, QLabel] = {}
        self.title = QLabel()
        font = self.title.font()
        font.setBold(True)
        self.title.setFont(font)
        self.title.setWordWrap(True)
        self.banner = _Banner()
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
        self._make_fields()
        page = QWidget()
        column = QVBoxLayout(page)
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
        scroll = QScrollArea()
        scroll.setWidget(page)
        scroll.setWidgetResizable(True)
        scroll.setFrameShape(QFrame.Shape.NoFrame)
        scroll.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        scroll.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.apply_button = QPushButton(self.tr("Apply"))
        self.reset_button = QPushButton(self.tr("Reset"))
        self.fit_button = QPushButton(self.tr("Fit"))
        self.all_button = QPushButton(self.tr("Fit all"))
        self.apply_button.setToolTip(self.tr("Take these settings; the surface stays as it is until it is fitted."))
        self.reset_button.setToolTip(self.tr("Go back to the settings that were applied last."))
        self.fit_button.setToolTip(self.tr("Apply, and fit this horizon."))
        self.all_button.setToolTip(self.tr("Fit every horizon with its own settings."))
        self.fit_button.setDefault(True)
        self.fit_button.setProperty("primary", True)
        buttons = QGridLayout()
        buttons.setSpacing(6)
        buttons.addWidget(self.fit_button, 0, 0)
        buttons.addWidget(self.all_button, 0, 1)
        buttons.addWidget(self.apply_button, 1, 0)
        buttons.addWidget(self.reset_button, 1, 1)
        content = QWidget()
        outer = QVBoxLayout(content)
        outer.setContentsMargins(0, 8, 0, 8)
        outer.setSpacing(6)
        for widget in (self.title, self.banner):
            row = QHBoxLayout()
            row.setContentsMargins(8, 0, 8, 0)
            row.addWidget(widget)
            outer.addLayout(row)
        outer.addWidget(scroll, 1)
        row = QHBoxLayout()
        row.setContentsMargins(8, 0, 8, 0)
        row.addLayout(buttons)
        outer.addLayout(row)
        self.pages = Placeholder(content)
        self.setLayout(self.pages)
        self.apply_button.clicked.connect(self._apply)
        self.reset_button.clicked.connect(self._reset)
        self.fit_button.clicked.connect(self._fit)
        self.all_button.clicked.connect(self.fit_all_requested)
        self.show_settings("", FitSettings(), False)

    def show_settings(self, name: str, settings: FitSettings, stale: bool = False, locked: bool = False) -> None:
        """Show a horizon's settings; ``stale`` where its surface is older. Without a name nothing is chosen.

        ``locked`` while a surface of the project is still being read or made: a fit must wait for it.
        """
        self._locked = locked
        core = self.fields["core"]
        if name != self._name and isinstance(core, CoreField):
            core.forget()
        self._name, self._settings, self._stale = name, settings, stale
        if not name:
            self.pages.say(self.tr("No horizon chosen: choose one in the project tree to see how it is fitted."))
            return
        self.title.setText(self.tr("Fit of {name}").format(name=name))
        self._reset()
        self.pages.reveal()

    def edited(self) -> FitSettings | None:
        """Return the settings as written in the form; None while one is out of its range."""
        try:
            return FitSettings(**{name: field.value() for name, field in self.fields.items()})
        except SettingsError:
            return None

    def _make_fields(self) -> None:
        unit = self.tr("m")
        automatic = {True: self.tr("Automatic"), False: self.tr("Fixed")}
        at_most = {True: self.tr("Automatic"), False: self.tr("At most")}
        self._add("epsilon", NumberField(unit))
        self._add("interior_tolerance", NumberField(unit))
        self._add("core", CoreField(_choices("core"), self.tr("Drawn, {n} corners")))
        self._add("smoothing", AutoField("auto", automatic))
        self._head(self.tr("Shape"))
        self._add("boundary_tolerance", NumberField(unit))
        for name in ("across", "seam", "frame"):
            self._add(name, ChoiceField(_choices(name)))
        self._head(self.tr("Fit"))
        for name in ("robust", "strict"):
            self._add(name, ChoiceField(_choices(name)))
        self._add("max_iterations", NumberField(whole=True))
        self._add("max_control_points", AutoField(None, at_most, whole=True, start=2000))
        self._add("coincidence_distance", NumberField(unit))
        assert set(self.fields) == {field.name for field in fields(FitSettings)}

    def _turn_arrow(self, unfolded: bool) -> None:
        self.more.setArrowType(Qt.ArrowType.DownArrow if unfolded else Qt.ArrowType.RightArrow)

    def _head(self, words: str) -> None:
        label = QLabel(words)
        font = label.font()
        font.setBold(True)
        label.setFont(font)
        self._rest.addSpacing(4)
        self._rest.addWidget(label)

    def _add(self, name: str, field: Field) -> None:
        words, about = translated(SETTINGS[name].label), translated(SETTINGS[name].about)
        label, error = QLabel(words), QLabel()
        label.setBuddy(field)
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
        form = self._form if name in FIRST else self._rest
        form.addLayout(row)
        form.addWidget(error)
        field.changed.connect(self._check)
        self.fields[name], self.errors[name], self._labels[name] = field, error, label

    def _check(self) -> None:
        """Validate each field for itself, so that every error is next to its own field."""
        sound = True
        for name, field in self.fields.items():
            value, text = field.value(), ""
            try:
                replace(self._settings, **{name: value})
            except SettingsError as error:
                text = translated(str(error))
                if isinstance(value, str) and "," in value:
                    text = self.tr("Write the decimal mark as a point: 0.5, not 0,5.")
            colours = self.errors[name].palette()
            colours.setColor(QPalette.ColorRole.WindowText, readable(FAIL, self.palette()))
            self.errors[name].setPalette(colours)
            self.errors[name].setText(text)
            self.errors[name].setVisible(bool(text))
            if text and name not in FIRST:
                self.more.setChecked(True)
            sound = sound and not text
        new = self.edited() if sound else None
        changed = new != self._settings
        self.apply_button.setEnabled(new is not None and changed)
        self.reset_button.setEnabled(changed)
        self.fit_button.setEnabled(new is not None and not self._locked)
        self.all_button.setEnabled(not self._locked)
        self.banner.show_text(
            self.tr("The surfaces of the project are being read: Fit waits for them.")
            if self._locked
            else self.tr("Not applied yet: press Apply or Fit.")
            if changed
            else self.tr("The surface is older than these settings: press Fit.")
            if self._stale
            else ""
        )

    def _reset(self) -> None:
        for name, field in self.fields.items():
            field.put(getattr(self._settings, name))
        self._check()

    def _apply(self) -> bool:
        new = self.edited()
        if new is None:
            return False
        if new != self._settings:
            self._settings = new
            self.applied.emit(self._name, new)
            self._check()
        return True

    def _fit(self) -> None:
        if self._apply():
            self.fit_requested.emit(self._name)


def _choices(name: str) -> dict[object, str]:
    """Return the words of a setting's choices in the user's language."""
    return {value: translated(text) for value, text in SETTINGS[name].choices.items()}


class _Banner(QFrame):
    """A line with a warning mark."""

    def __init__(self) -> None:
        super().__init__()
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self._mark, self._label = QLabel(), QLabel()
        self._label.setWordWrap(True)
        row = QHBoxLayout(self)
        row.setContentsMargins(6, 4, 6, 4)
        row.addWidget(self._mark, 0, Qt.AlignmentFlag.AlignTop)
        row.addWidget(self._label, 1)
        size = self.style().pixelMetric(QStyle.PixelMetric.PM_SmallIconSize)
        self._mark.setPixmap(icon("stale").pixmap(size))
        self.hide()

    @property
    def text(self) -> str:
        """What it says."""
        return self._label.text()

    def show_text(self, text: str) -> None:
        """Say something, or nothing."""
        self._label.setText(text)
        self.setVisible(bool(text))
