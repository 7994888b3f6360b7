"""Where a body comes from: codes of the open site's intervals, codes of another site file, or a closed mesh."""

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

from geofit.project.body_record import BodySource, ClosedMesh, Intervals, MorphFrame

__all__ = ["BodySourceForm"]

OWN, OTHER, MESH, FRAME = "own", "other", "mesh", "frame"
#: Rows of the list of codes that are seen at once, at most.
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
        self.codes = QListWidget()
        self.codes.setAccessibleName(self.tr("Codes inside the body"))
        self.head = QLabel(self.tr("Codes inside the body"))
        self.head.setBuddy(self.codes)
        self.frame = QLabel()
        self.frame.setWordWrap(True)
        column = QVBoxLayout(self)
        column.setContentsMargins(8, 4, 8, 0)
        column.setSpacing(4)
        for widget in (self.kind, self.place, self.head, self.codes, self.frame):
            column.addWidget(widget)
        self._own: Mapping[str, int] = {}
        self._other: tuple[str, Mapping[str, int]] = ("", {})
        self._mesh = ""
        self._wanted: frozenset[str] = frozenset()
        self._frame: MorphFrame | None = None
        self.kind.activated.connect(lambda _: self._choose())
        self.browse.clicked.connect(lambda: self.file_wanted.emit(self.kind.currentData()))
        self.codes.itemChanged.connect(self._check)
        self._arrange()

    def show_own(self, codes: Mapping[str, int]) -> None:
        """Offer the codes of the open site."""
        self._own = codes
        self._arrange()

    def show_other(self, file: str, codes: Mapping[str, int]) -> None:
        """Offer the codes of another site file."""
        self._other = (file, codes)
        self._arrange()
        self.changed.emit()

    def show_mesh(self, file: str) -> None:
        """Show the file of a closed mesh."""
        self._mesh = file
        self._arrange()
        self.changed.emit()

    def put(self, source: BodySource | None) -> None:
        """Show a source without emitting; None: intervals of the open site, none chosen."""
        self._frame = source if isinstance(source, MorphFrame) else None
        kind = OWN
        self._wanted = frozenset()
        if isinstance(source, Intervals):
            self._wanted, kind = frozenset(source.codes), OTHER if source.file else OWN
            if source.file and self._other[0] != source.file:
                self._other = (source.file, dict.fromkeys(source.codes, 0))
        elif isinstance(source, ClosedMesh):
            self._mesh, kind = source.file, MESH
        elif source is None and not self._own:
            kind = OTHER
        self.kind.setCurrentIndex(self.kind.findData(kind))
        self._arrange()

    def source(self) -> BodySource | None:
        """Return the source that is chosen; None while something is missing."""
        if self._frame is not None:
            return self._frame
        kind, codes = self.kind.currentData(), tuple(sorted(self._wanted & set(self._offered())))
        if kind == MESH:
            return ClosedMesh(self._mesh) if self._mesh else None
        if not codes:
            return None
        return Intervals(codes, self._other[0] if kind == OTHER else "")

    def _offered(self) -> Mapping[str, int]:
        return self._own if self.kind.currentData() == OWN else self._other[1]

    def _choose(self) -> None:
        self._arrange()
        kind = self.kind.currentData()
        if (kind == OTHER and not self._other[0]) or (kind == MESH and not self._mesh):
            self.file_wanted.emit(kind)
        self.changed.emit()

    def _arrange(self) -> None:
        kind = self.kind.currentData()
        made, logged = self._frame is not None, kind in (OWN, OTHER)
        file = self._other[0] if kind == OTHER else self._mesh
        self.file.setText(Path(file).name if file else self.tr("no file chosen"))
        self.file.setToolTip(file)
        for widget, shown in (
            (self.kind, not made), (self.place, not made and kind != OWN), (self.head, not made and logged),
            (self.codes, not made and logged), (self.frame, made),
        ):  # fmt: skip
            widget.setVisible(shown)
        if self._frame is not None:
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
