"""How a horizon is fitted and judged: every setting with its unit, checked while it is typed."""

from __future__ import annotations

from dataclasses import fields

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QFrame, QGridLayout, QHBoxLayout, QLabel, QPushButton, QStyle, QVBoxLayout, QWidget

from geofit.data.setting_texts import SETTINGS
from geofit.data.settings import FitSettings
from geofit.gui.names import breakable
from geofit.gui.panels.fit_fields import AutoField, ChoiceField, CoreField, NumberField
from geofit.gui.panels.marks import icon
from geofit.gui.panels.placeholder import Placeholder
from geofit.gui.panels.settings_form import SettingsForm, scrolling

__all__ = ["FIRST", "Banner", "FitPanel"]

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
        self.title = QLabel()
        font = self.title.font()
        font.setBold(True)
        self.title.setFont(font)
        self.title.setWordWrap(True)
        self.title.setTextFormat(Qt.TextFormat.PlainText)
        self.banner = Banner()
        self.form = SettingsForm(SETTINGS, FitSettings, FIRST)
        self.fields, self.errors, self.more = self.form.fields, self.form.errors, self.form.more
        self._make_fields()
        self.form.changed.connect(self._check)
        scroll = scrolling(self.form)
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
        self.pages = Placeholder(content, self)
        self.apply_button.clicked.connect(self._apply)
        self.reset_button.clicked.connect(self._reset)
        self.fit_button.clicked.connect(self._fit)
        self.all_button.clicked.connect(self.fit_all_requested)
        self.show_settings("", FitSettings(), False)

    def show_settings(self, name: str, settings: FitSettings, stale: bool = False, locked: bool = False) -> None:
        """Show a horizon's settings; ``stale`` where its surface is older. Without a name nothing is chosen.

        What is written and not applied stays while it is the same horizon: something that ran may have ended.
        ``locked`` while a surface of the project is still being read or made: a fit must wait for it.
        """
        self._locked = locked
        core = self.fields["core"]
        written = self.form.written(self._settings) if name and name == self._name else set()
        if name != self._name and isinstance(core, CoreField):
            core.forget()
        self._name, self._settings, self._stale = name, settings, stale
        if not name:
            self.pages.say(self.tr("No horizon chosen: choose one in the project tree to see how it is fitted."))
            return
        self.title.setText(breakable(self.tr("Fit of {name}").format(name=name)))
        self.form.put(settings, keep=written)
        self._check()
        self.pages.reveal()

    def edited(self) -> FitSettings | None:
        """Return the settings as written in the form; None while one is out of its range."""
        found: FitSettings | None = self.form.edited()
        return found

    def apply(self, name: str) -> bool:
        """Apply what is written for a horizon, if anything is; False, and nothing done, where it has an error."""
        return name != self._name or self._apply()

    def _make_fields(self) -> None:
        unit = self.tr("m")
        automatic = {True: self.tr("Automatic"), False: self.tr("Fixed")}
        at_most = {True: self.tr("Automatic"), False: self.tr("At most")}
        add, head, choices = self.form.add, self.form.head, self.form.choices
        add("epsilon", NumberField(unit))
        add("interior_tolerance", NumberField(unit))
        add("core", CoreField(choices("core"), self.tr("Drawn, {n} corners")))
        add("smoothing", AutoField("auto", automatic))
        head(self.tr("Shape"))
        add("boundary_tolerance", NumberField(unit))
        for name in ("across", "seam", "frame"):
            add(name, ChoiceField(choices(name)))
        head(self.tr("Fit"))
        for name in ("robust", "strict"):
            add(name, ChoiceField(choices(name)))
        add("dips", ChoiceField(choices("dips")))
        add("dip_accuracy", NumberField("°"))
        add("max_iterations", NumberField(whole=True))
        add("max_control_points", AutoField(None, at_most, whole=True, start=2000))
        add("coincidence_distance", NumberField(unit))
        assert set(self.fields) == {field.name for field in fields(FitSettings)}

    def _check(self) -> None:
        new = self.form.check(self._settings)
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
            else self.tr("The surface is older than its data or settings: press Fit.")
            if self._stale
            else ""
        )

    def _reset(self) -> None:
        self.form.put(self._settings)
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


class Banner(QFrame):
    """A line with a mark, by default that of what is stale."""

    def __init__(self, mark: str = "stale") -> None:
        super().__init__()
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self._mark, self._label = QLabel(), QLabel()
        self._label.setWordWrap(True)
        row = QHBoxLayout(self)
        row.setContentsMargins(6, 4, 6, 4)
        row.addWidget(self._mark, 0, Qt.AlignmentFlag.AlignTop)
        row.addWidget(self._label, 1)
        size = self.style().pixelMetric(QStyle.PixelMetric.PM_SmallIconSize)
        self._mark.setPixmap(icon(mark).pixmap(size))
        self.hide()

    @property
    def text(self) -> str:
        """What it says."""
        return self._label.text()

    def show_text(self, text: str) -> None:
        """Say something, or nothing."""
        self._label.setText(text)
        self.setVisible(bool(text))
