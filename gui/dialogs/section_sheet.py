"""The section sheet: which sections, at which scale, what the title block says, and where the files go."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PySide6.QtWidgets import QComboBox, QWidget

from geofit.data.prediction import Uncertainty
from geofit.data.site import Site
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.dialogs.sheet import LengthField, SheetDialog
from geofit.gui.lengths import shown_length
from geofit.gui.translate import user_language
from geofit.project.section_sheet import SheetBody, SheetOrder, write_section_sheet
from geofit.site.section_view import parallel_lines

__all__ = ["SectionSheetDialog"]

Floats = NDArray[np.float64]
_FACTORS = (1.0, 1.5, 2.0, 3.0, 5.0, 10.0)


class SectionSheetDialog(SheetDialog):
    """Asks for sections and writes them to scale."""

    def __init__(
        self,
        site: Site,
        surfaces: Mapping[str, HorizonFit],
        line: Floats,
        thickness: float,
        uncertainty: Mapping[str, Uncertainty],
        bodies: Mapping[str, SheetBody],
        folder: Path,
        parent: QWidget | None = None,
        stale: Collection[str] = (),
    ) -> None:
        super().__init__(site, "", folder / "sections", parent)
        self._stale = stale
        self.setWindowTitle(self.tr("Section sheet"))
        self.title_line.setText(self.tr("Geological section"))
        self.drawing = self.tr("Cutting and drawing the sections…")
        self._line, self._uncertainty, self._bodies = line, dict(uncertainty), dict(bodies)
        # Only bands need the model behind the patches; elsewhere it need not travel to the other process.
        self._surfaces = {
            name: surface if name in uncertainty else surface.with_(model=None) for name, surface in surfaces.items()
        }
        self.which = QComboBox()
        self.which.addItem(self.tr("The line of the section panel"), "line")
        self.which.addItem(self.tr("Across that line, at equal distances"), "across")
        if site.sections:
            self.which.addItem(self.tr("Every section of the site ({n})").format(n=len(site.sections)), "sections")
        # Round numbers of the unit, but for what the section panel has.
        self.spacing, self.half = LengthField(1.0, 1e5, 100.0), LengthField(1.0, 1e5, 200.0)
        self.thickness = LengthField(0.1, 1e5, shown_length(thickness))
        self.factor = QComboBox()
        for factor in _FACTORS:
            self.factor.addItem(f"× {factor:g}", factor)
        self.lay_out(
            (
                (self.tr("&Sections"), self.which),
                (self.tr("&Every"), self.spacing),
                (self.tr("&Length to each side"), self.half),
                (self.tr("&Thickness"), self.thickness),
            ),
            ((self.tr("&Height"), self.factor),),
        )
        self.which.currentIndexChanged.connect(self.refresh)
        self.hint = self.tr(
            "Each section is drawn to scale: holes with lithology, horizons and bodies with their bands."
        )
        self.show_hint()
        self.refresh()

    def lines(self) -> Mapping[str, Floats]:
        """Return the lines of the sections by their names; SettingsError where a number does not fit."""
        which = self.which.currentData()
        if which == "across":
            return parallel_lines(self._line, self.spacing.metres, self.half.metres)
        if which == "sections":
            return {section.name: section.line for section in self._site.sections}
        return {"": self._line}

    def order(self) -> SheetOrder:
        """Return what is asked for."""
        return SheetOrder(
            self.lines(),
            self.thickness.metres,
            self.title_block(),
            self.path(),
            self.wanted(),
            self.paper.currentText(),
            self.scale.currentData(),
            self.factor.currentData(),
            user_language().code,
        )

    def work(self) -> tuple[Callable[..., Any], tuple[Any, ...]]:
        """Return what writes the sections."""
        work = (self._site, self._surfaces, self._uncertainty, self.order(), self._bodies, self._stale)
        return write_section_sheet, work

    def sheets(self) -> Sequence[str]:
        """Return the names of the sections."""
        return list(self.lines())

    def stale(self) -> list[str]:
        """Return the surfaces and bodies that are older than their data."""
        old = [name for name in self._surfaces if name in self._stale]
        return [*old, *(name for name, body in self._bodies.items() if body.stale)]

    def refresh(self) -> None:
        """Enable what can be done."""
        super().refresh()
        across = self.which.currentData() == "across"
        for widget in (self.spacing, self.half):
            widget.setEnabled(not self.running and across)
