"""A chosen control point in the scene: what it moves is highlighted, and follows it as it is dragged."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from vtkmodules.util.numpy_support import numpy_to_vtk

from geofit.fitting.preview import MovePreview
from geofit.gui.view3d.actors import ActorPart, coloured, lines, poly, triangles
from geofit.gui.view3d.contents import Contents
from geofit.gui.view3d.drawn import Drawn
from geofit.gui.view3d.free_drag import FreeDrag
from geofit.gui.view3d.handles import Handle
from geofit.gui.view3d.item import Look
from geofit.gui.view3d.moved_region import MovedRegion, moved_region
from geofit.gui.view3d.overlay import Ring
from geofit.gui.view3d.shape import Shape
from geofit.gui.view3d.stage import Stage
from geofit.report.style import rgb

__all__ = ["ControlMove"]

Floats = NDArray[np.float64]

#: Colour of what moves, by day and by night; its shares at the border and under the control point.
MARK = "#e8590c", "#f2a541"
TINT = 0.3, 0.85
#: The name of its actors on the stage.
EXTRA = "control move"


class ControlMove:
    """The one control point that is chosen: it can be dragged, or ``reason`` states why not.

    ``dragged(vector)`` hears how far it was pulled, (3,) metres in map coordinates; ``dropped()`` that it was let go;
    ``refused(reason)`` that somebody pulls at one that cannot move.
    """

    def __init__(
        self,
        stage: Stage,
        contents: Contents,
        dragged: Callable[[Floats], None],
        dropped: Callable[[], None],
        refused: Callable[[str], None],
    ) -> None:
        self._stage, self._contents = stage, contents
        self._dragged, self._dropped, self._refused = dragged, dropped, refused
        self._horizon = ""
        self._control: tuple[Floats, Floats] | None = None
        self._whole: Drawn | None = None
        self._region: MovedRegion | None = None
        self._look: Look | None = None
        self._data: tuple[Any, Any] | None = None
        self.by, self.figures, self.reason, self.waits = np.zeros(3), "", "", False
        self._preview: MovePreview | None = None

    def show(self, horizon: str, preview: MovePreview | None, reason: str = "") -> None:
        """Show what a control point of a surface moves, or why it cannot move; neither: nothing."""
        self._put_back()
        self._horizon, self._preview, self.reason = horizon, preview, reason
        self.by, self.figures, self.waits = np.zeros(3), "", False
        self._find_region()
        self._control = None if preview is None else _control_of(preview)
        self._draw()

    def move(self, by: Floats, figures: str = "") -> None:
        """Show the surface with the control point moved by (3,) metres, and the figures that it then has."""
        if self._preview is None:
            return
        away = bool(by.any())
        cut, self.by, self.figures = away != bool(self.by.any()), by, figures
        if cut:
            # Near by, the surface may have got other triangles since the control point was chosen.
            if away and self._whole is not self._contents.drawn.get(self._horizon):
                self._find_region()
                self._data = None
            self._contents.cut_out(self._horizon, self._region if away else None)
        self._place_control()
        if self._data is None or self._look is not self._stage.look:
            self._draw()
        else:
            self._bend(*self._data)

    def follow(self) -> None:
        """Draw anew where the scene has another origin or background."""
        if self._look is not None and self._look is not self._stage.look:
            self._draw()

    def handles(self) -> list[Handle]:
        """Return the control point itself as a handle, until its move is being applied."""
        if self._preview is not None and not self.waits:
            rest = np.asarray(self._preview.place)
            moved = partial(self._pull, rest)
            return [Handle(self._place(), moved, self._preview.way, dropped=self._dropped, drawn=False, rest=rest)]
        return []

    def held(self, ring: Ring) -> list[Handle]:
        """Return the control point in a ring as a handle that reports why it cannot move."""
        return [Handle(ring.xyz, lambda _: self._refused(self.reason), drawn=False)] if self.reason else []

    def dressed(self, ring: Ring, drag: FreeDrag | None = None) -> Ring:
        """Return the ring about the control point where it is now, with what the move does and what holds it."""
        if self._preview is None:
            return replace(ring, text=f"{ring.text}\n{self.reason}") if self.reason else ring
        lines = (ring.text, "" if drag is None else drag.words, self.figures)
        way = self._preview.way if drag is None or drag.axis is None else drag.axis
        text = "\n".join(line for line in lines if line)
        return replace(ring, xyz=self._place(), text=text, way=None if self.waits else way)

    @property
    def shown(self) -> bool:
        """Whether a control point is chosen."""
        return self._preview is not None or bool(self.reason)

    @property
    def drawn(self) -> Shape | None:
        """The triangles of what moves, where they are now; None where nothing is chosen."""
        return None if self._region is None else self._region.moved(self.by)

    @property
    def horizon(self) -> str:
        """The horizon of the control point."""
        return self._horizon

    def _place(self) -> Floats:
        assert self._preview is not None
        return np.asarray(self._preview.place + self.by)

    def _pull(self, start: Floats, xyz: Floats) -> None:
        if self._preview is not None:
            self._dragged(xyz - start)

    def _put_back(self) -> None:
        """Show the surface as it is, unless it is another one by now."""
        if self._preview is not None and self._contents.surfaces.get(self._horizon) is self._preview.surface:
            self.by = np.zeros(3)
            self._contents.cut_out(self._horizon, None)
            self._place_control()

    def _place_control(self) -> None:
        if self._control is not None:
            self._contents.place_control(self._horizon, self._control[0] + self._control[1] * self.by)

    def _find_region(self) -> None:
        """Cut what the control point moves out of the triangles that are drawn."""
        self._whole = self._contents.drawn.get(self._horizon)
        drawn, preview = self._whole, self._preview
        self._region = None if drawn is None or preview is None else moved_region(drawn.shape, preview)

    def _draw(self) -> None:
        """Make the actors: what moves, its border, and the way that the control point has gone."""
        self._look = look = self._stage.look
        self._data = None
        parts: list[ActorPart] = []
        if self._preview is not None:
            rim = self._preview.rim(0.0, self.by.tolist())
            border = poly(rim - look.origin, runs=[np.arange(len(rim))])
            parts.append(ActorPart(lines(border, MARK[look.dark], 4.0), width=2.0))
            if self._region is not None and len(self._region.inside.triangles):
                shape = self._region.moved(self.by)
                data = poly(shape.xyz - look.origin, faces=shape.triangles, normals=shape.normals)
                actor = triangles(data, MARK[look.dark])
                # What moves lies on the surface until it moves: it is drawn in front of it.
                actor.GetMapper().SetRelativeCoincidentTopologyPolygonOffsetParameters(0.5, 10.0)
                coloured(actor, self._colours(self._region, look))
                parts.insert(0, ActorPart(actor))
                self._data = data, border
        self._stage.set_extra(EXTRA, parts)

    def _colours(self, region: MovedRegion, look: Look) -> NDArray[np.uint8]:
        """Mix the horizon's colour with the mark, more of it where the surface moves more."""
        most = max(float(region.share.max(initial=0.0)), 1e-12)
        tint = (TINT[0] + (TINT[1] - TINT[0]) * region.share / most)[:, None]
        base, mark = (np.array(rgb(c), float) for c in (self._contents.colour(self._horizon), MARK[look.dark]))
        return np.asarray((1 - tint) * base + tint * mark, np.uint8)

    def _bend(self, data: Any, border: Any) -> None:
        """Move what is drawn; nothing is built anew."""
        assert self._region is not None
        assert self._preview is not None
        shape, origin = self._region.moved(self.by), self._stage.look.origin
        for one, places in ((data, shape.xyz), (border, self._preview.rim(0.0, self.by.tolist()))):
            one.GetPoints().SetData(numpy_to_vtk(np.ascontiguousarray(places - origin, np.float32), deep=True))
            one.GetPoints().Modified()
        data.GetPointData().SetNormals(numpy_to_vtk(np.ascontiguousarray(shape.normals, np.float32), deep=True))
        self._stage.redraw()


def _control_of(preview: MovePreview) -> tuple[Floats, Floats]:
    """Return the control points of all patches (n, 3), map coordinates, and their shares (n, 1) of the move."""
    surface = preview.surface
    places = [patch.control.reshape(-1, 3) for patch in surface.patches]
    shares = [share.ravel() for share in preview.control_shares()]
    return np.concatenate(places) + surface.origin, np.concatenate(shares)[:, None]
