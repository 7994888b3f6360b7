"""Asks for shape and type of a raw rock volume, which has no header."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QLabel,
    QSpinBox,
    QVBoxLayout,
    QWidget,
)

__all__ = ["RawVolumeDialog", "type_names"]

#: More voxels along an axis than any scan has.
MOST = 1_000_000


def type_names(tr: Callable[[str], str]) -> dict[str, str]:
    """Return what the types of a value are called, by their codes without byte order; ``tr`` is a window's."""
    return {
        "u1": tr("8 bits, unsigned"), "i1": tr("8 bits, signed"),
        "u2": tr("16 bits, unsigned"), "i2": tr("16 bits, signed"),
        "u4": tr("32 bits, unsigned"), "i4": tr("32 bits, signed"),
        "f4": tr("32 bits, floating point"), "f8": tr("64 bits, floating point"),
    }  # fmt: skip


class RawVolumeDialog(QDialog):
    """Three counts and the type of a value; ``stated`` returns them as the reader takes them.

    ``fault`` is what the reader said; ``shape`` and ``dtype`` are what was stated or assumed before.
    """

    def __init__(self, fault: str, shape: Sequence[int] | None, dtype: str | None, parent: QWidget) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Raw volume"))
        self.message = QLabel(fault)
        self.message.setWordWrap(True)
        self.counts = tuple(QSpinBox() for _ in range(3))
        self.kind, self.big_endian = QComboBox(), QCheckBox(self.tr("&Big-endian byte order"))
        for name, text in type_names(self.tr).items():
            self.kind.addItem(text, name)
        self.buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Open | QDialogButtonBox.StandardButton.Cancel)
        form = QFormLayout()
        titles = (self.tr("Slices (axis 0)"), self.tr("Rows (axis 1)"), self.tr("Columns (axis 2)"))
        for box, title in zip(self.counts, titles, strict=True):
            box.setRange(0, MOST)
            box.setSpecialValueText(self.tr("not stated"))
            box.valueChanged.connect(self._refresh)
            form.addRow(title, box)
        form.addRow(self.tr("Type of a value"), self.kind)
        form.addRow("", self.big_endian)
        layout = QVBoxLayout(self)
        layout.addWidget(self.message)
        layout.addLayout(form)
        layout.addWidget(self.buttons)
        for box, count in zip(self.counts, shape or (), strict=False):
            box.setValue(count)
        if dtype is not None:
            self.kind.setCurrentIndex(self.kind.findData(dtype.lstrip("<>|")))
            self.big_endian.setChecked(dtype.startswith(">"))
        self.kind.currentIndexChanged.connect(self._refresh)
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        self.counts[0].setFocus()
        self.counts[0].selectAll()
        self._refresh()

    @property
    def stated(self) -> tuple[tuple[int, ...], str]:
        """Voxels along each axis, the slowest first, and the type of their values."""
        kind = self.kind.currentData()
        order = "" if kind.endswith("1") else ">" if self.big_endian.isChecked() else "<"
        return tuple(box.value() for box in self.counts), order + kind

    def _refresh(self) -> None:
        self.big_endian.setEnabled(not self.kind.currentData().endswith("1"))
        stated = all(box.value() for box in self.counts)
        self.buttons.button(QDialogButtonBox.StandardButton.Open).setEnabled(stated)
