"""Horizons built from lithology while a site is imported: the builder's form, and its picks among the holes at once."""

from __future__ import annotations

from dataclasses import dataclass, replace

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QCloseEvent
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QSplitter, QVBoxLayout, QWidget

from geofit.data.site import Site
from geofit.gui.dialogs.horizon_form import HorizonForm
from geofit.gui.theme import is_dark
from geofit.gui.view3d.picks import show_picks
from geofit.gui.view3d.view import SceneView
from geofit.io.contact_rules import ContactRule
from geofit.project.horizon_builder import RulePicks

__all__ = ["BuiltHorizon", "HorizonPage"]


@dataclass(frozen=True)
class BuiltHorizon:
    """A horizon to be added to the imported site: its name, its rule, and all horizons then, the highest first."""

    name: str
    rule: ContactRule
    order: tuple[str, ...]


class HorizonPage(QWidget):
    """Builds horizons of an imported site; ``built`` holds them, and ``changed`` tells of one more or less.

    Call :meth:`close` before the window that holds it is destroyed, as with any 3D view.
    """

    changed = Signal()

    def __init__(self, site: Site, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.site, self.built = site, list[BuiltHorizon]()
        self.form, self.view = HorizonForm(site, tuple(site.horizons), upright=True), SceneView(self)
        self.view.set_dark(is_dark(self.palette()))
        # The holes with their lithology alone: what the import took for horizons would hide the picks.
        self.view.show_site(replace(site, horizons={}))
        self.view.setMinimumSize(300, 200)
        self.words, self.back = QLabel(), QPushButton(self.tr("Ta&ke back"))
        self.words.setWordWrap(True)
        self.back.clicked.connect(self._take_back)
        row = QHBoxLayout()
        row.addWidget(self.words, 1)
        row.addWidget(self.back)
        parts = QSplitter(Qt.Orientation.Horizontal)
        parts.addWidget(self.form)
        parts.addWidget(self.view)
        parts.setStretchFactor(1, 1)
        parts.setSizes([420, 580])
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(parts, 1)
        column.addLayout(row)
        self._picks: RulePicks | None = None
        self.form.previewed.connect(self._preview)
        self.form.built.connect(self._add)
        self._show()

    def closeEvent(self, event: QCloseEvent) -> None:  # noqa: N802
        """Let go of the view's OpenGL."""
        self.view.close()
        super().closeEvent(event)

    def _preview(self, picks: RulePicks | None) -> None:
        self._picks = picks
        show_picks(self.view, self.tr("Preview"), picks)

    def _add(self, name: str, rule: ContactRule, order: tuple[str, ...]) -> None:
        self.built.append(BuiltHorizon(name, rule, order))
        show_picks(self.view, name, self._picks)
        self._show()

    def _take_back(self) -> None:
        last = self.built.pop()
        self.view.remove_surface(last.name)
        self.form.withdraw(last.name)
        self._show()

    def _show(self) -> None:
        names = ", ".join(one.name for one in self.built)
        self.words.setText(
            self.tr("Added when the site opens: {names}").format(names=names)
            if names
            else self.tr("Choose codes and add horizons, or open the site without any.")
        )
        self.back.setEnabled(bool(self.built))
        self.changed.emit()
