"""Everything that a worker can make ready before a surface is drawn: triangles, standard deviations, 90 % bounds."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from geofit.data.prediction import Uncertainty
from geofit.data.progress import Progress, tell
from geofit.data.site import Ground
from geofit.fitting.horizon_fit import HorizonFit
from geofit.gui.view3d.shape import Shape, sd_at, shape_of, split
from geofit.gui.view3d.sight import Sight
from geofit.prediction.bands import band, prediction_sd
from geofit.site.support import support_of

__all__ = ["BAND", "Drawn", "drawn_of"]

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

#: A 90 % band reaches so many standard deviations to either side.
BAND = 1.6449


@dataclass(frozen=True, eq=False)
class Drawn:
    """A surface as triangles; ``sd`` at the vertices of the fine and the coarse ones, metres, and the 90 % bounds.

    ``largest_sd`` is the figure of panels and reports: the largest in the grid over the study area, or over the hull of
    the points of a steep or folded surface. Vertices that the grid does not reach, on the border, can have more.
    ``supported`` names which triangles, fine and coarse, lie below the ground and within the hull of the points.
    ``sight`` is the view that it was made for; None: any.
    """

    shape: Shape
    sd: tuple[Floats, Floats] | None = None
    upper: Shape | None = None
    lower: Shape | None = None
    supported: tuple[Bools, Bools] | None = None
    sight: Sight | None = None
    largest_sd: float | None = None


def drawn_of(
    surface: HorizonFit,
    uncertainty: Uncertainty | None = None,
    ground: Ground | None = None,
    sight: Sight | None = None,
    *,
    progress: Progress | None = None,
) -> Drawn:
    """Return a surface made ready for drawing.

    The bounds of a surface that was fitted here are its own net moved up and down; of one that was read from a file
    its triangles are moved, by what the grid of standard deviations says.
    """
    tell(progress, "triangles", 0.0)
    shape = shape_of(surface, sight)
    if len(surface.points):
        support = support_of(surface.points.xyz, ground)
        divided, rough = split(shape, support.depth(shape.xyz)), shape.coarse or shape
        shape = replace(divided, coarse=divided if rough is shape else split(rough, support.depth(rough.xyz)))
    coarse = shape.coarse or shape
    held = _supported(surface, ground, shape), _supported(surface, ground, coarse)
    if uncertainty is None:
        return Drawn(shape, supported=held, sight=sight)
    if surface.model is None:
        fine, few = (sd_at(uncertainty, one.xyz) for one in (shape, coarse))
        upper, lower = (_lifted(shape, fine, few, sign) for sign in (BAND, -BAND))
    else:
        fine, few = (prediction_sd(surface, uncertainty, one.xyz) for one in (shape, coarse))
        upper, lower = (shape_of(bound) for bound in band(surface, uncertainty))
    return Drawn(shape, (fine, few), upper, lower, held, sight, uncertainty.max)


def _supported(surface: HorizonFit, ground: Ground | None, shape: Shape) -> Bools:
    """Return which triangles, none of which crosses the border, lie below the ground and within the points' hull."""
    if not len(surface.points):
        return np.ones(len(shape.triangles), bool)
    return support_of(surface.points.xyz, ground).within(shape.xyz[shape.triangles].mean(axis=1))


def _lifted(shape: Shape, fine: Floats, few: Floats, sign: float) -> Shape:
    way = np.array([0.0, 0.0, sign])
    moved = shape.lifted(fine, way)
    coarse = (shape.coarse or shape).lifted(few, way)
    return Shape(moved.xyz, moved.triangles, moved.normals, coarse)
