"""Surfaces are made ready for the 3D view beside the window: it draws them when their triangles are there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from PySide6.QtCore import QObject, Signal

from geofit.data.prediction import Uncertainty
from geofit.data.site import Ground
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.view3d.drawn import Drawn, drawn_of
from geofit.gui.view3d.sight import Sight
from geofit.gui.worker import run, run_in_process

__all__ = ["SurfaceDrawing"]

#: So many are kept, for undoing at once.
KEPT = 12


@dataclass(frozen=True, eq=False)
class _Made:
    surface: HorizonFit
    uncertainty: Uncertainty | None
    drawn: Drawn


class SurfaceDrawing(QObject):
    """Calls back with what can be drawn; at once, where it was made already. ``failed(exception)`` if it cannot be."""

    failed = Signal(object)

    def __init__(self, parent: QObject) -> None:
        super().__init__(parent)
        self._made: list[_Made] = []
        self._wanted: dict[str, Callable[[Drawn], object]] = {}

    @property
    def busy(self) -> bool:
        """Whether something is being made ready."""
        return bool(self._wanted)

    def draw(
        self,
        surface: HorizonFit,
        uncertainty: Uncertainty | None,
        ground: Ground | None,
        show: Callable[[Drawn], object],
    ) -> None:
        """Call ``show`` as soon as the surface can be drawn; one that is asked for later takes its place."""
        self.forget(surface.name)
        for made in self._made:
            # Judged by another control error, it is the same surface.
            same = made.surface.surface is surface.surface and made.surface.model is surface.model
            if same and made.uncertainty is uncertainty:
                show(made.drawn)
                return

        def done(drawn: Drawn) -> None:
            self._made = [*self._made, _Made(surface, uncertainty, drawn)][-KEPT:]
            if self._wanted.get(surface.name) is show:
                del self._wanted[surface.name]
                show(drawn)

        def fail(error: Exception) -> None:
            self.forget(surface.name)
            self.failed.emit(error)

        self._wanted[surface.name] = show
        run_in_process(self, drawn_of, surface, uncertainty, ground, on_done=done, on_failed=fail)

    def sharpen(
        self,
        surface: HorizonFit,
        uncertainty: Uncertainty | None,
        ground: Ground | None,
        sight: Sight,
        show: Callable[[Drawn], object],
    ) -> None:
        """Call ``show`` with what is drawn for a view, unless another is still being made of this surface.

        It takes a tenth of a second, in a thread: what another process would need of a surface takes longer to send.
        """
        if surface.name in self._wanted:
            return

        def done(drawn: Drawn) -> None:
            if self._wanted.get(surface.name) is show:
                del self._wanted[surface.name]
                show(drawn)

        def fail(error: Exception) -> None:
            self.forget(surface.name)
            self.failed.emit(error)

        self._wanted[surface.name] = show
        run(self, drawn_of, surface, uncertainty, ground, sight, on_done=done, on_failed=fail)

    def forget(self, name: str) -> None:
        """Take back what was asked for of a horizon; its process is let be."""
        self._wanted.pop(name, None)

    def clear(self) -> None:
        """Forget everything."""
        self._wanted.clear()
        self._made.clear()
