"""How a horizon is fitted and judged: every setting with its unit, checked while it is typed."""

from __future__ import annotations

from dataclasses import fields, replace

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QPalette
from PySide6.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QScrollArea,
    QSizePolicy,
    QStyle,
    QVBoxLayout,
    QWidget,
)

from geofit.data.errors import SettingsError
from geofit.data.settings import FitSettings
from geofit.gui.panels.fit_fields import AutoField, ChoiceField, CoreField, Field, NumberField
from geofit.gui.panels.flow import FlowLayout
from geofit.gui.panels.marks import icon, readable
from geofit.gui.panels.placeholder import Placeholder
from geofit.gui.words import spoken
from geofit.report.style import FAIL

__all__ = ["FitPanel"]


class FitPanel(QWidget):
    """A form over one horizon's settings.

    ``applied`` carries the name and the settings; ``fit_requested`` follows it where there was something to apply.
    """

    applied = Signal(str, object)
    fit_requested = Signal(str)
    fit_all_requested = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._name, self._settings, self._stale = "", FitSettings(), False
        self.fields: dict[str, Field] = {}
        self.errors: dict[str, QLabel] = {}
        self._labels: dict[str, QLabel] = {}
        self.title = QLabel()
        font = self.title.font()
        font.setBold(True)
        self.title.setFont(font)
        self.title.setWordWrap(True)
        self.banner = _Banner()
        self._form = QVBoxLayout()
        self._form.setSpacing(2)
        self._make_fields()
        page = QWidget()
        column = QVBoxLayout(page)
        column.setContentsMargins(8, 8, 8, 8)
        column.setSpacing(6)
        column.addLayout(self._form)
        column.addStretch(1)
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
        buttons = FlowLayout()
        for button in (self.apply_button, self.reset_button, self.fit_button, self.all_button):
            buttons.addWidget(button)
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

    def show_settings(self, name: str, settings: FitSettings, stale: bool = False) -> None:
        """Show a horizon's settings; ``stale`` where its surface is older. Without a name nothing is chosen."""
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
        """Return the settings as they stand in the form; None while one is out of its range."""
        try:
            return FitSettings(**{name: field.value() for name, field in self.fields.items()})
        except SettingsError:
            return None

    def _make_fields(self) -> None:
        metres = self.tr("m")
        self._head(self.tr("Judged by"))
        self._add(
            "epsilon", self.tr("Control error ε"), NumberField(metres),
            self.tr("The surface passes when σ, the standard deviation of all points from it, is below this."),
        )  # fmt: skip
        self._add(
            "interior_tolerance", self.tr("Interior tolerance"), NumberField(metres),
            self.tr(
                "How far a point outside the core may lie from the surface. The fit refines until it holds or nothing "
                "more helps."
            ),
        )  # fmt: skip
        self._add(
            "boundary_tolerance", self.tr("Seam tolerance"), NumberField(metres),
            self.tr("How far the edges of neighbouring patches may gape. Patches of a fit share their edges: no gap."),
        )  # fmt: skip
        self._head(self.tr("Shape"))
        self._add(
            "core", self.tr("Exact core"),
            CoreField(
                {"auto": self.tr("Automatic"), "all": self.tr("All points"), "none": self.tr("None")},
                self.tr("Drawn, {n} corners"),
            ),
            self.tr(
                "The region whose points the surface meets exactly. Automatic: where the points are dense. All: every "
                "point. None: all points are approximated. Drawn: the rectangle around the polygon of the plan."
            ),
        )  # fmt: skip
        self._add(
            "across", self.tr("Across sections"),
            ChoiceField({"cubic": self.tr("Cubic"), "linear": self.tr("Linear")}),
            self.tr(
                "How the core runs from one section to the next: smoothly, or along straight lines as drawn by hand."
            ),
        )  # fmt: skip
        self._add(
            "seam", self.tr("At the seams"),
            ChoiceField({"tangent": self.tr("Smooth"), "position": self.tr("Break allowed")}),
            self.tr("Whether neighbouring patches share a tangent plane, or meet at the edge and may break there."),
        )  # fmt: skip
        self._add(
            "frame", self.tr("Laid over"),
            ChoiceField(
                {
                    "auto": self.tr("Automatic"),
                    "map": self.tr("The map"),
                    "best-plane": self.tr("Its best plane"),
                    "sections": self.tr("Its sections"),
                }
            ),
            self.tr(
                "Map: one height at each place. Best plane: for steep faults. Sections: for overturned folds, through "
                "the section lines in order."
            ),
        )  # fmt: skip
        self._head(self.tr("Fit"))
        choice = {True: self.tr("Automatic"), False: self.tr("Fixed")}
        at_most = {True: self.tr("Automatic"), False: self.tr("At most")}
        self._add(
            "smoothing", self.tr("Smoothing"), AutoField("auto", choice),
            self.tr(
                "Weight of the bending energy outside the core. Automatic: from the scatter of the points. Larger is "
                "smoother, smaller is nearer to the points."
            ),
        )  # fmt: skip
        self._add(
            "robust", self.tr("Outliers", "FitPanel"),
            ChoiceField({False: self.tr("Fitted too"), True: self.tr("Left out", "FitPanel")}),
            self.tr(
                "Peripheral points that their neighbours do not bear out. They are named and count in sigma either way."
            ),
        )  # fmt: skip
        self._add(
            "strict", self.tr("Beyond tolerance"),
            ChoiceField({False: self.tr("Listed where noise explains them"), True: self.tr("Met where knots allow")}),
            self.tr(
                "Peripheral points farther from the surface than the interior tolerance: listed where noise explains "
                "them or neighbours contradict them, or met in any case, at the price of swings between them."
            ),
        )  # fmt: skip
        self._add(
            "max_iterations", self.tr("Rounds, at most"), NumberField(whole=True),
            self.tr("How often the fit may refine and adjust before it stops and says what is not met."),
        )  # fmt: skip
        self._add(
            "max_control_points", self.tr("Control points"), AutoField(None, at_most, whole=True, start=2000),
            self.tr("Limit of the surface's size. Automatic: ten a point, at least 400 and at most 60 000."),
        )  # fmt: skip
        self._add(
            "conflict_distance", self.tr("One place within"), NumberField(metres),
            self.tr(
                "Points nearer to each other in plan than this count as one place. If their elevations differ, the "
                "more accurate is kept and the other listed."
            ),
        )  # fmt: skip
        assert set(self.fields) == {field.name for field in fields(FitSettings)}

    def _head(self, words: str) -> None:
        label = QLabel(words)
        font = label.font()
        font.setBold(True)
        label.setFont(font)
        if self.fields:
            self._form.addSpacing(8)
        self._form.addWidget(label)

    def _add(self, name: str, words: str, field: Field, about: str) -> None:
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
        row.addWidget(label, 4)
        row.addWidget(field, 5)
        self._form.addLayout(row)
        self._form.addWidget(error)
        field.changed.connect(self._check)
        self.fields[name], self.errors[name], self._labels[name] = field, error, label

    def _check(self) -> None:
        """Validate each field for itself, so that every error stands beside its own field."""
        sound = True
        for name, field in self.fields.items():
            value, text = field.value(), ""
            try:
                replace(self._settings, **{name: value})
            except SettingsError as error:
                text = spoken(str(error))
                if isinstance(value, str) and "," in value:
                    text = self.tr("Write the decimal mark as a point: 0.5, not 0,5.")
            colours = self.errors[name].palette()
            colours.setColor(QPalette.ColorRole.WindowText, readable(FAIL, self.palette()))
            self.errors[name].setPalette(colours)
            self.errors[name].setText(text)
            self.errors[name].setVisible(bool(text))
            sound = sound and not text
        new = self.edited() if sound else None
        changed = new != self._settings
        self.apply_button.setEnabled(new is not None and changed)
        self.reset_button.setEnabled(changed)
        self.fit_button.setEnabled(new is not None)
        self.banner.show_text(
            self.tr("Not applied yet: press Apply or Fit.")
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
