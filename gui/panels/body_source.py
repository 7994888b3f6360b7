"""Where a body comes from: codes of intervals, outlines on sections, picked points, or a closed mesh."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import (
    QComboBox,
    QHBoxLayout,
    QLabel,
    QListWidget,
    QListWidgetItem,
    QPushButton,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from geofit.project.body_record import (
    BetweenHorizons,
    BodySource,
    ClosedMesh,
    Intervals,
    MorphFrame,
    Outlines,
    SurfacePicks,
)

__all__ = ["MESH", "OTHER", "OUTLINES", "OWN", "POINTS", "BodySourceForm"]

OWN, OTHER, OUTLINES, POINTS, MESH = "own", "other", "outlines", "points", "mesh"
#: Kinds of which a list chooses: codes, or layers.
LISTED = (OWN, OTHER, OUTLINES)
#: Rows of the list that are seen at once, at most.
ROWS = 6


class BodySourceForm(QWidget):
    """Asks for the source of a body. ``changed`` reports each choice; ``file_wanted(kind)`` asks for a file."""

    changed = Signal()
    file_wanted = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self.kind = QComboBox()
        self.kind.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.kind.setMinimumContentsLength(10)
        self.kind.setAccessibleName(self.tr("Source of the body"))
        for kind, words in (
            (OWN, self.tr("Intervals of this site")),
            (OTHER, self.tr("Intervals of another site file")),
            (OUTLINES, self.tr("Outlines on sections in a file")),
            (POINTS, self.tr("Points on its surface in a file")),
            (MESH, self.tr("Closed mesh or solid in a file")),
        ):
            self.kind.addItem(words, kind)
        self.file, self.browse = QLabel(), QPushButton(self.tr("Choose…"))
        self.file.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.place = QWidget()
        row = QHBoxLayout(self.place)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(6)
        row.addWidget(self.file, 1)
        row.addWidget(self.browse)
        self.codes, self.head = QListWidget(), QLabel()
        self.head.setBuddy(self.codes)
        self.frame = QLabel()
        self.frame.setWordWrap(True)
        column = QVBoxLayout(self)
        column.setContentsMargins(8, 4, 8, 0)
        column.setSpacing(4)
        for widget in (self.kind, self.place, self.head, self.codes, self.frame):
            column.addWidget(widget)
        #: The file of each kind, and what its list offers with how often it occurs.
        self._files: dict[str, str] = dict.fromkeys((OWN, OTHER, OUTLINES, POINTS, MESH), "")
        self._offers: dict[str, Mapping[str, int]] = {}
        self._wanted: frozenset[str] = frozenset()
        self._frame: MorphFrame | BetweenHorizons | None = None
        self.kind.activated.connect(lambda _: self._choose())
        self.browse.clicked.connect(lambda: self.file_wanted.emit(self.kind.currentData()))
        self.codes.itemChanged.connect(self._check)
        self._arrange()

    def show_own(self, codes: Mapping[str, int]) -> None:
        """Offer the codes of the open site."""
        self._offers[OWN] = codes
        self._arrange()

    def show_file(self, kind: str, file: str, offered: Mapping[str, int] | None = None) -> None:
        """Show the file of a kind with the codes or layers that it offers; of new layers all are wanted."""
        self._files[kind], self._offers[kind] = file, offered or {}
        if kind == OUTLINES and kind == self.kind.currentData():
            self._wanted = frozenset(self._offers[kind])
        self._arrange()
        self.changed.emit()

    def put(self, source: BodySource | None) -> None:
        """Show a source without emitting; None: intervals of the open site, none chosen."""
        self._frame = source if isinstance(source, MorphFrame | BetweenHorizons) else None
        kind = OWN
        self._wanted = frozenset()
        match source:
            case Intervals(codes, file):
                self._wanted, kind = frozenset(codes), OTHER if file else OWN
                self._remember(kind, file, codes)
            case Outlines(file, layers):
                self._wanted, kind = frozenset(layers), OUTLINES
                self._remember(kind, file, layers)
                self._wanted = self._wanted or frozenset(self._offers[OUTLINES])
            case SurfacePicks(file):
                self._files[POINTS], kind = file, POINTS
            case ClosedMesh(file):
                self._files[MESH], kind = file, MESH
            case None if not self._offers.get(OWN):
                kind = OTHER
        self.kind.setCurrentIndex(self.kind.findData(kind))
        self._arrange()

    def source(self) -> BodySource | None:
        """Return the source that is chosen; None while something is missing."""
        if self._frame is not None:
            return self._frame
        kind, offered = self.kind.currentData(), self._offered()
        file, chosen = self._files[kind], tuple(sorted(self._wanted & set(offered)))
        if kind != OWN and not file:
            return None
        match kind:
            case "mesh":
                return ClosedMesh(file)
            case "points":
                return SurfacePicks(file)
            case "outlines":
                # All layers: the same source as without a choice.
                whole = len(chosen) == len(offered)
                return Outlines(file, () if whole else chosen) if chosen or not offered else None
        return Intervals(chosen, file) if chosen else None

    def missing(self) -> str:
        """Say what is missing of a source."""
        kind = self.kind.currentData()
        if kind != OWN and not self._files[kind]:
            return self.tr("Choose the file that the body is made from.")
        if kind == OUTLINES:
            return self.tr("Choose the layers whose outlines bound the body.")
        return self.tr("Choose the codes that lie inside the body.")

    def _remember(self, kind: str, file: str, names: tuple[str, ...]) -> None:
        """Offer what a body was made from until its file is read."""
        if kind != OWN and self._files[kind] != file:
            self._files[kind], self._offers[kind] = file, dict.fromkeys(names, 0)

    def _offered(self) -> Mapping[str, int]:
        return self._offers.get(self.kind.currentData(), {})

    def _choose(self) -> None:
        kind = self.kind.currentData()
        self._wanted = frozenset(self._offered()) if kind == OUTLINES else self._wanted & set(self._offered())
        self._arrange()
        if kind != OWN and not self._files[kind]:
            self.file_wanted.emit(kind)
        self.changed.emit()

    def _arrange(self) -> None:
        kind = self.kind.currentData()
        made = self._frame is not None
        listed = kind in LISTED and (kind != OUTLINES or len(self._offered()) > 1)
        file = self._files[kind]
        self.file.setText(Path(file).name if file else self.tr("no file chosen"))
        self.file.setToolTip(file)
        words = self.tr("Layers of its outlines") if kind == OUTLINES else self.tr("Codes inside the body")
        self.head.setText(words)
        self.codes.setAccessibleName(words)
        for widget, shown in (
            (self.kind, not made), (self.place, not made and kind != OWN), (self.head, not made and listed),
            (self.codes, not made and listed), (self.frame, made),
        ):  # fmt: skip
            widget.setVisible(shown)
        if isinstance(self._frame, BetweenHorizons):
            lower = self._frame.lower
            self.frame.setText(
                self.tr("Below {upper} and above {lower}.").format(
                    upper=self._frame.upper, lower=lower if isinstance(lower, str) else f"{lower:g} m"
                )
            )
        if isinstance(self._frame, MorphFrame):
            self.frame.setText(
                self.tr("Frame at {share:.0f} % between {names}: geometry, not a record of the process.").format(
                    share=100 * self._frame.tau, names=", ".join(self._frame.names)
                )
            )
        with QSignalBlocker(self.codes):
            self.codes.clear()
            for code, count in self._offered().items():
                item = QListWidgetItem(f"{code}  ({count})" if count else code)
                item.setData(Qt.ItemDataRole.UserRole, code)
                item.setFlags(item.flags() | Qt.ItemFlag.ItemIsUserCheckable)
                item.setCheckState(Qt.CheckState.Checked if code in self._wanted else Qt.CheckState.Unchecked)
                self.codes.addItem(item)

        rows = min(max(self.codes.count(), 2), ROWS)
        row = self.codes.sizeHintForRow(0) if self.codes.count() else self.codes.fontMetrics().height() + 5
        self.codes.setFixedHeight(rows * row + 4)

    def _check(self, item: QListWidgetItem) -> None:
        code = item.data(Qt.ItemDataRole.UserRole)
        on = item.checkState() == Qt.CheckState.Checked
        self._wanted = self._wanted | {code} if on else self._wanted - {code}
        self.changed.emit()
