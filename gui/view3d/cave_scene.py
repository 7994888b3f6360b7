"""A survey in space: centre line coloured by its loops, stations, sections with their walls, and the body."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from PySide6.QtGui import QColor
from PySide6.QtWidgets import QWidget

from geofit.caves.adjust import AdjustedSurvey
from geofit.gui.view3d.small_scene import SmallScene
from geofit.project.cave_run import CaveRun
from geofit.project.cave_view import shot_states, wall_rings

__all__ = ["FILLED", "MEASURED", "STATES", "CaveScene"]

Floats = NDArray[np.float64]

#: Colours of shots that no loop checks, of those of loops that close, and of those of loops to be checked.
STATES = ("#5f7d95", "#1f9d8a", "#d1495b")
#: Colours of sections whose walls were all measured, and of those with a wall that was filled.
MEASURED, FILLED = "#3d7dca", "#d9952b"
_BODY, _CHOSEN = "#b08d57", "#e8308a"


class CaveScene(SmallScene):
    """A 3D view of an adjusted survey: "line", "stations", "walls" and "body", each a part that can be hidden."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(("line", "stations", "walls", "body"), parent)
        self.setAccessibleName(self.tr("Survey in space"))
        self._adjusted: AdjustedSurvey | None = None
        #: Map coordinates of the scene's origin: single precision would lose centimetres in them.
        self.origin = np.zeros(3)

    def set_dark(self, dark: bool) -> None:
        """Follow the theme: stations are dark on a light background, and light on a dark one."""
        super().set_dark(dark)
        if "stations" in self.actors:
            self.actors["stations"].prop.color = "#dde3e8" if dark else "#26313b"

    def show_survey(self, adjusted: AdjustedSurvey) -> None:
        """Draw the centre line and stations of another survey, without a body."""
        import pyvista as pv

        self.clear()
        self._adjusted = adjusted
        self.origin = np.round(adjusted.xyz.mean(axis=0))
        survey, xyz = adjusted.survey, adjusted.xyz - self.origin
        shots = np.column_stack([survey.start, survey.end])
        line = _lines(xyz, shots)
        line.cell_data["colour"] = _rgb(STATES)[shot_states(adjusted)]
        _flat(self.add("line", line, "line"), 3.0)
        stations = self.add("stations", pv.PolyData(xyz), "stations")
        stations.prop.style = "points"
        stations.prop.render_points_as_spheres = True
        stations.prop.point_size = 4.5
        stations.prop.color = "#dde3e8" if self.dark else "#26313b"
        self.frame(np.array([xyz.min(axis=0) - 1, xyz.max(axis=0) + 1]), outline=False)

    def show_body(self, run: CaveRun) -> None:
        """Draw sections and body of the survey that is shown."""
        import pyvista as pv

        rings = wall_rings(run.body)
        count, sides = rings.corners.shape[:2]
        first = np.arange(count * sides).reshape(count, sides)
        pairs = np.stack([first, np.roll(first, -1, axis=1)], axis=2).reshape(-1, 2)
        walls = _lines(rings.corners.reshape(-1, 3) - self.origin, pairs)
        walls.cell_data["colour"] = np.repeat(_rgb((FILLED, MEASURED))[rings.measured.astype(int)], sides, axis=0)
        _flat(self.add("walls", walls, "walls"), 1.2)
        if len(run.triangles.triangles):
            mesh = pv.PolyData.from_regular_faces(run.triangles.vertices - self.origin, run.triangles.triangles)
            self.add("body", mesh, "body", 0.35).prop.color = _BODY
        self.canvas.render()

    def choose_loop(self, number: int | None) -> None:
        """Draw thick lines along a loop of the survey, by its number in ``loops``; None: along none."""
        self.remove("chosen")
        if number is not None and self._adjusted is not None:
            survey = self._adjusted.survey
            place = [survey.stations.index(name) for name in self._adjusted.loops[number].stations]
            xyz = self._adjusted.xyz[place] - self.origin
            # Fixed coordinates close a loop without a shot from its last station to its first.
            shots = {frozenset(pair) for pair in zip(survey.start.tolist(), survey.end.tolist(), strict=True)}
            follows = zip(range(len(place)), np.roll(np.arange(len(place)), -1).tolist(), strict=True)
            links = [(a, b) for a, b in follows if frozenset((place[a], place[b])) in shots]
            actor = self.add("chosen", _lines(xyz, links), "line")
            actor.prop.color, actor.prop.line_width, actor.prop.lighting = _CHOSEN, 7.0, False
        self.canvas.render()


def _lines(xyz: Floats, pairs: Any) -> Any:
    import pyvista as pv

    return pv.PolyData(xyz, lines=np.column_stack([np.full(len(pairs), 2), pairs]).ravel())


def _rgb(colours: tuple[str, ...]) -> NDArray[np.uint8]:
    found = [QColor(colour) for colour in colours]
    return np.array([(c.red(), c.green(), c.blue()) for c in found], np.uint8)


def _flat(actor: Any, width: float) -> None:
    """Draw an actor's cells in their own colours, without light."""
    actor.mapper.dataset.set_active_scalars("colour", preference="cell")
    actor.mapper.SetScalarModeToUseCellData()
    actor.mapper.SetColorModeToDirectScalars()
    actor.mapper.ScalarVisibilityOn()
    actor.prop.lighting = False
    actor.prop.line_width = width
