"""Horizons built from lithology in a site that is open: the form of codes and limits in a window of its own."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtWidgets import QDialog, QDialogButtonBox, QVBoxLayout, QWidget

from geofit.data.site import Site
from geofit.gui.dialogs.horizon_form import HorizonForm

__all__ = ["HorizonBuilder"]


class HorizonBuilder(QDialog):
    """Shows a :class:`HorizonForm`, whose signals tell of picks and horizons, until it is closed."""

    def __init__(self, site: Site, order: Sequence[str], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Build a horizon from lithology"))
        self.form = HorizonForm(site, order)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
        buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.addWidget(self.form, 1)
        column.addWidget(buttons)
        # Now that it is in the dialog; else Enter would press the first button, Up.
        self.form.add.setDefault(True)
        self.resize(860, 500)

    def done(self, result: int) -> None:
        """Take the preview away with the dialog."""
        self.form.previewed.emit(None)
        super().done(result)
