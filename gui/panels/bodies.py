"""The panel of bodies: which body, its verdict, what it is made from and how; Fit, with progress and Stop."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtWidgets import (
    QComboBox,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QMenu,
    QProgressBar,
    QPushButton,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from geofit.bodies.accuracy import BodyAccuracy
from geofit.bodies.settings import BodySettings
from geofit.data.messages import Message
from geofit.data.setting_texts import BODY_SETTINGS
from geofit.data.verdict import Verdict
from geofit.gui.panels.body_source import BodySourceForm
from geofit.gui.panels.fit_fields import AutoField, ChoiceField, NumberField, NumbersField
from geofit.gui.panels.fit_panel import Banner
from geofit.gui.panels.marks import icon
from geofit.gui.panels.placeholder import Placeholder
from geofit.gui.panels.settings_form import SettingsForm, scrolling
from geofit.gui.panels.verdict import VerdictBadge
from geofit.gui.translate import translated
from geofit.project.body_record import FITTED, BetweenHorizons, BodyProvenance, ClosedMesh, MorphFrame

__all__ = ["BodiesPanel", "BodyShown"]

#: Fields that are always shown; the others unfold.
FIRST = ("epsilon", "step", "closed", "reach")


class BodyShown:
    """What the panel shows of one body: what it is made from, its verdict, and what is to be said of it.

    ``old`` is why it is to be fitted again, empty if it is not; ``origin`` how it came here; ``warnings`` what limits
    its use.
    """

    def __init__(
        self,
        provenance: BodyProvenance,
        accuracy: BodyAccuracy | None = None,
        verdict: Verdict | None = None,
        *,
        waiting: bool = False,
        old: str = "",
        origin: str = "",
        warnings: Sequence[Message] = (),
    ) -> None:
        self.provenance, self.accuracy, self.verdict = provenance, accuracy, verdict
        self.waiting, self.old, self.origin, self.warnings = waiting, old, origin, warnings


class BodiesPanel(QWidget):
    """A form over one body, or over one that is to be made.

    Signals: ``chosen(name)`` another body ("" for a new one); ``fit_requested(name, source, settings)``;
    ``stop_requested()``; ``renamed(name)``, ``deleted(name)``, ``exported(name)`` ask for these; ``file_wanted(kind)``
    for a file of the source; ``edited(source, settings)`` reports what differs from the fit, None twice if nothing.
    """

    chosen = Signal(str)
    fit_requested = Signal(str, object, object)
    stop_requested = Signal()
    rename_requested = Signal(str)
    delete_requested = Signal(str)
    export_requested = Signal(str)
    file_wanted = Signal(str)
    edited = Signal(object, object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.name, self._given = "", BodySettings()
        self._shown: BodyShown | None = None
        self._running = False
        self._taken: tuple[str, ...] = ()
        self.list = QComboBox()
        self.list.setAccessibleName(self.tr("Body"))
        self.list.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.list.setMinimumContentsLength(8)
        self.more = QToolButton()
        self.more.setText("⋯")
        self.more.setAccessibleName(self.tr("More about this body"))
        self.more.setToolTip(self.tr("Rename or delete this body"))
        self.more.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        menu = QMenu(self.more)
        menu.addAction(self.tr("Rename…")).triggered.connect(lambda: self.rename_requested.emit(self.name))
        menu.addAction(self.tr("Delete")).triggered.connect(lambda: self.delete_requested.emit(self.name))
        self.more.setMenu(menu)
        self.badge, self.banner, self.origin = VerdictBadge(), Banner(), QLabel()
        #: What limits the use of the body, whatever its verdict.
        self.warning = Banner("warning")
        self.origin.setWordWrap(True)
        self.title = QLineEdit()
        self.title.setPlaceholderText(self.tr("Name, by default its codes"))
        self.title.setAccessibleName(self.tr("Name of the new body"))
        self.source = BodySourceForm()
        self.form = SettingsForm(BODY_SETTINGS, BodySettings, FIRST)
        self._make_fields()
        self.progress, self.stop = QProgressBar(), QPushButton(self.tr("Stop"))
        self.progress.setRange(0, 1000)
        self.progress.setAccessibleName(self.tr("Progress"))
        self.fit_button, self.export_button = QPushButton(self.tr("Fit")), QPushButton(self.tr("Export…"))
        self.fit_button.setProperty("primary", True)
        self.fit_button.setToolTip(self.tr("Fit this body to its data and compute its volumes."))
        self.export_button.setToolTip(self.tr("Write this body as STEP, triangles or block model."))
        self._lay_out()
        self.list.activated.connect(lambda _: self.chosen.emit(self.list.currentData()))
        self.source.changed.connect(self._check)
        self.source.file_wanted.connect(self.file_wanted)
        self.form.changed.connect(self._check)
        self.title.textEdited.connect(lambda _: self._check())
        self.fit_button.clicked.connect(self._fit)
        self.stop.clicked.connect(self.stop_requested)
        self.export_button.clicked.connect(lambda: self.export_requested.emit(self.name))
        self.form.put(self._given)
        self.set_running(False)
        self.close_site()

    def close_site(self) -> None:
        """Say that no site is open."""
        self.pages.say(self.tr("No site open: open one whose boreholes have interval tables to fit a body."))

    def show_bodies(self, names: Sequence[tuple[str, str]]) -> None:
        """Offer bodies by name and mark (see :func:`geofit.gui.panels.marks.icon`), and a new one."""
        self._taken = tuple(name for name, _ in names)
        with QSignalBlocker(self.list):
            self.list.clear()
            for name, mark in names:
                self.list.addItem(icon(mark), name, name)
            self.list.addItem(self.tr("New body"), "")
            self.list.setCurrentIndex(max(self.list.findData(self.name), 0) if self.name else self.list.count() - 1)
        self.pages.reveal()

    def show_body(self, name: str, shown: BodyShown | None) -> None:
        """Show a body; None: the form of a new one. What is written for it stays while it is the same body."""
        same = name == self.name and (shown is None) == (self._shown is None)
        if shown is not None and self._shown is not None:
            same = same and shown.provenance == self._shown.provenance
        self.name, self._shown = name, shown
        self.list.setCurrentIndex(self.list.findData(name))
        if not same:
            self._given = BodySettings() if shown is None else shown.provenance.settings
            self.source.put(None if shown is None else shown.provenance.source)
            self.form.put(self._given)
            self.title.clear()
        self.title.setVisible(shown is None)
        accuracy = None if shown is None else shown.accuracy
        judged = shown is None or isinstance(shown.provenance.source, FITTED)
        self.badge.setVisible(shown is not None and judged)
        if shown is not None:
            self.badge.show_accuracy(accuracy, bool(shown.old), shown.verdict, shown.waiting)
        self.warning.show_text("" if shown is None else "\n".join(map(translated, shown.warnings)))
        self.form.setVisible(judged and not isinstance(self.source.source(), ClosedMesh | BetweenHorizons | MorphFrame))
        self.origin.setText("" if shown is None else shown.origin)
        self.origin.setVisible(bool(self.origin.text()))
        self._check()

    def set_running(self, running: bool, stage: str = "", fraction: float = 0.0) -> None:
        """Show how far a fit is, and Stop."""
        self._running = running
        for widget in (self.progress, self.stop):
            widget.setVisible(running)
        self.fit_button.setVisible(not running)
        self.export_button.setVisible(not running)
        self.progress.setValue(round(1000 * fraction))
        self.progress.setFormat(stage.replace("%", "%%"))

    def _make_fields(self) -> None:
        metres, degrees = self.tr("m"), self.tr("°")
        automatic = {True: self.tr("Automatic"), False: self.tr("Fixed")}
        add, head, choices = self.form.add, self.form.head, self.form.choices
        add("epsilon", NumberField(metres))
        add("step", AutoField(None, automatic, start=1.0))
        add("closed", ChoiceField(choices("closed")))
        add("reach", AutoField(None, automatic, start=50.0))
        head(self.tr("Anisotropy"))
        add("ranges", NumbersField(3))
        for name in ("azimuth", "dip", "rake"):
            add(name, NumberField(degrees))
        head(self.tr("Fit"))
        add("box", NumbersField(6, rows=3, empty=None, hint=self.tr("of the data")))
        add("coincidence_distance", NumberField(metres))
        add("kernel", ChoiceField(choices("kernel")))
        add("dense", NumberField(whole=True))
        head(self.tr("Volumes"))
        for name in ("realizations", "seed"):
            add(name, NumberField(whole=True))
        assert set(self.form.fields) == {field.name for field in fields(BodySettings)}

    def _lay_out(self) -> None:
        head = QHBoxLayout()
        head.setContentsMargins(8, 0, 8, 0)
        head.addWidget(self.list, 1)
        head.addWidget(self.more)
        form = QWidget()
        column = QVBoxLayout(form)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(4)
        named = QHBoxLayout()
        named.setContentsMargins(8, 0, 8, 0)
        named.addWidget(self.title)
        column.addLayout(named)
        column.addWidget(self.source)
        column.addWidget(self.form)
        column.addStretch(1)
        buttons = QGridLayout()
        buttons.setContentsMargins(8, 0, 8, 0)
        buttons.setSpacing(6)
        for widget, at in (
            (self.progress, (0, 0)), (self.stop, (0, 1)), (self.fit_button, (1, 0)), (self.export_button, (1, 1)),
        ):  # fmt: skip
            buttons.addWidget(widget, *at)
        content = QWidget()
        outer = QVBoxLayout(content)
        outer.setContentsMargins(0, 8, 0, 8)
        outer.setSpacing(6)
        outer.addLayout(head)
        for said in (self.badge, self.origin, self.warning, self.banner):
            row = QHBoxLayout()
            row.setContentsMargins(8, 0, 8, 0)
            row.addWidget(said)
            outer.addLayout(row)
        outer.addWidget(scrolling(form), 1)
        outer.addLayout(buttons)
        self.pages = Placeholder(content, self)

    def _check(self) -> None:
        source = self.source.source()
        fitted = source is None or isinstance(source, FITTED)
        self.form.setVisible(fitted)
        settings = self.form.check(self._given) if fitted else self._given
        known = self._shown.provenance if self._shown is not None else None
        changed = known is not None and (source != known.source or settings != known.settings)
        title = self.title.text().strip()
        taken = self._shown is None and bool(title) and title in self._taken
        self.fit_button.setText(self.tr("Fit") if fitted else self.tr("Read"))
        new = fitted and source is not None and settings is not None and (known is None or changed)
        self.edited.emit(source if new else None, settings if new else None)
        frame = isinstance(source, MorphFrame)
        self.fit_button.setEnabled(source is not None and settings is not None and not taken and not frame)
        self.export_button.setEnabled(known is not None and not self._waiting())
        self.more.setEnabled(known is not None)
        self.banner.show_text(
            self.tr("There is a body of this name already: choose another name.")
            if taken
            else self.source.missing()
            if self._shown is None and source is None
            else self.tr("Not fitted with these settings yet: press Fit.")
            if changed
            else ""
            if self._shown is None
            else self._shown.old
        )

    def _waiting(self) -> bool:
        return self._shown is not None and self._shown.waiting

    def _fit(self) -> None:
        source, settings = self.source.source(), self.form.edited()
        if isinstance(source, ClosedMesh | BetweenHorizons):
            settings = BodySettings()
        if source is not None and settings is not None:
            self.fit_requested.emit(self.name or self.title.text().strip(), source, settings)
