"""The contour plan: which horizon, how many metres between contours, at which scale, and where the files go."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from PySide6.QtWidgets import QComboBox, QWidget

from geofit.data.site import Site
from geofit.data.stale import StaleCause
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.dialogs.sheet import LengthField, SheetDialog
from geofit.gui.translate import user_language
from geofit.project.plan_sheet import PlanOrder, write_plan_sheet

__all__ = ["PlanSheetDialog"]


class PlanSheetDialog(SheetDialog):
    """Asks for contour plans and writes them to scale."""

    def __init__(
        self,
        site: Site,
        surfaces: Mapping[str, HorizonFit],
        chosen: str | None,
        folder: Path,
        parent: QWidget | None = None,
        stale: Mapping[str, tuple[StaleCause, ...]] | None = None,
    ) -> None:
        super().__init__(site, "", folder / "plan", parent)
        self._stale = {name: causes for name, causes in (stale or {}).items() if causes}
        self.setWindowTitle(self.tr("Contour plan"))
        self.title_line.setText(self.tr("Contour plan"))
        self.drawing = self.tr("Drawing the contours…")
        # Of a folded surface contours would cross.
        flat = {name: surface for name, surface in surfaces.items() if surface.frame != "sections"}
        self._surfaces = {name: surface.with_(model=None) for name, surface in flat.items()}
        self.which = QComboBox()
        for name in self._surfaces:
            self.which.addItem(name, (name,))
        if len(self._surfaces) > 1:
            words = self.tr("Every horizon, a page each ({n})").format(n=len(self._surfaces))
            self.which.addItem(words, tuple(self._surfaces))
        if chosen in self._surfaces:
            self.which.setCurrentText(chosen)
        self.interval = LengthField(0.0, 1000.0, 0.0)
        self.interval.setSpecialValueText(self.tr("Automatic"))
        self.interval.setToolTip(self.tr("Distance between contours; 0 chooses 1, 2 or 5 times a power of ten"))
        self.lay_out(((self.tr("&Horizon"), self.which), (self.tr("C&ontours every"), self.interval)))
        self.hint = self.tr("Heights, holes with names, study area, scale bar, north arrow; every fifth contour heavy.")
        self.which.currentIndexChanged.connect(self.show_hint)
        self.show_hint()
        self.refresh()

    def order(self) -> PlanOrder:
        """Return what is asked for."""
        return PlanOrder(
            self.which.currentData(),
            self.title_block(),
            self.path(),
            self.interval.metres or None,
            self.wanted(),
            self.paper.currentText(),
            self.scale.currentData(),
            user_language().code,
        )

    def work(self) -> tuple[Callable[..., Any], tuple[Any, ...]]:
        """Return what writes the plans."""
        return write_plan_sheet, (self._site, self._surfaces, self.order(), self._stale)

    def sheets(self) -> Sequence[str]:
        """Return the horizons of the plans."""
        horizons: tuple[str, ...] = self.which.currentData()
        return horizons

    def stale(self) -> list[str]:
        """Return the chosen horizons that are older than their data."""
        return [name for name in self.which.currentData() or () if name in self._stale]

    def refresh(self) -> None:
        """Enable what can be done."""
        super().refresh()
        self.go.setEnabled(self.go.isEnabled() and bool(self._surfaces))
