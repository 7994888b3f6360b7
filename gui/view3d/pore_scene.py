"""Pores, throats and surface of a rock sample in space, coloured by radius or by connection."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from PySide6.QtGui import QColor
from PySide6.QtWidgets import QWidget

from geofit.gui.view3d.small_scene import SmallScene
from geofit.project.pore_view import PoreView

__all__ = ["Colour", "PoreScene"]

Colour = Literal["radius", "connection"]
Floats = NDArray[np.float64]

#: Colours of pores that percolate along no, one, two and three axes: from warm to cool.
CONNECTED = ("#b5452c", "#d9a441", "#5aa6a6", "#0b5c8a")
#: Sides of a throat's tube, and of a pore's ball; of more pores than ``MANY`` each is a few pixels.
SIDES, RINGS = 8, 12
MANY, FEW_SIDES, FEW_RINGS = 20_000, 4, 5


class PoreScene(SmallScene):
    """A 3D view of a :class:`PoreView`: "pores", "throats" and "surface", of which the first two are the "network".

    Raises
    ------
    NoOpenGLError
        If no 3D view can be drawn on this machine.
    """

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(("network", "surface"), parent)
        self.setAccessibleName(self.tr("Pores in space"))
        self._view: PoreView | None = None
        self.colour: Colour = "radius"
        self.limits = (0.0, 1.0)

    def show_view(self, view: PoreView) -> None:
        """Draw another network and surface, and move the camera so that all is seen."""
        import pyvista as pv

        self.clear()
        self._view = view
        network = view.network
        centre = (network.pores.centre + 0.5) * network.edges
        balls = pv.PolyData(centre)
        balls["size"] = network.pores.radius
        sides, rings = (SIDES, RINGS) if len(centre) <= MANY else (FEW_SIDES, FEW_RINGS)
        ball = pv.Sphere(radius=1.0, theta_resolution=rings, phi_resolution=rings)
        balls["pore"] = np.arange(len(centre))
        if len(centre):
            self.add("pores", balls.glyph(scale="size", orient=False, geom=ball), "network")
        if len(network.throats):
            self.add("throats", _tubes(centre, network.throats.pores, network.throats.radius, sides), "network")
        if len(view.triangles):
            surface = pv.PolyData.from_regular_faces(view.vertices, view.triangles)
            surface["pore"] = view.vertex_pore
            self.add("surface", surface, "surface", 0.25)
        self._paint()
        self.frame(np.array([[0.0] * 3, np.array(network.shape) * network.edges]))

    def clear(self) -> None:
        """Remove network and surface."""
        super().clear()
        self._view = None

    def set_colour(self, colour: Colour) -> None:
        """Colour by the radius of pores in voxels, or by the axes along which they percolate."""
        self.colour = colour
        self._paint()

    def values(self) -> Floats:
        """Return what pores are coloured by (n,): radii in voxels, or numbers of axes."""
        assert self._view is not None
        return self._view.network.pores.radius if self.colour == "radius" else self._view.axes.astype(np.float64)

    def _paint(self) -> None:
        if self._view is None or not len(self._view.network.pores):
            return
        values = self.values()
        self.limits = (0.0, 3.0) if self.colour == "connection" else (float(values.min()), float(values.max()))
        low, high = self.limits
        for actor in self.actors.values():
            mesh = actor.mapper.dataset
            of_pore = values[np.asarray(mesh["pore"]).astype(np.int64)]
            if self.colour == "radius":
                import matplotlib as mpl

                share = (of_pore - low) / max(high - low, 1e-12)
                colours = (255 * np.asarray(mpl.colormaps["viridis"](share))[:, :3]).astype(np.uint8)
            else:
                known = [QColor(colour) for colour in CONNECTED]
                table = np.array([(c.red(), c.green(), c.blue()) for c in known], np.uint8)
                colours = table[of_pore.astype(np.int64)]
            mesh["colour"] = colours
            mesh.set_active_scalars("colour")
            actor.mapper.SetScalarModeToUsePointData()
            actor.mapper.SetColorModeToDirectScalars()
            actor.mapper.ScalarVisibilityOn()
        self.canvas.render()


def _tubes(centre: Floats, pores: NDArray[np.int32], radius: Floats, sides: int) -> Any:
    """Return the tubes of throats from pore to pore, each with its radius."""
    import pyvista as pv

    ends = centre[pores].reshape(-1, 3)
    cells = np.column_stack([np.full(len(pores), 2), np.arange(len(ends)).reshape(-1, 2)]).ravel()
    lines = pv.PolyData(ends, lines=cells)
    lines["size"] = np.repeat(np.maximum(radius, 0.25), 2)
    lines["pore"] = pores.ravel()
    return lines.tube(scalars="size", absolute=True, n_sides=sides)
