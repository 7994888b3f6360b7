"""What a fit of a body leaves: the field, the look at it on a raster, and the figures of the solver."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.bodies.data import Prepared
from geofit.bodies.field import BodyField
from geofit.bodies.rbf import Saddle
from geofit.bodies.region import Region

__all__ = ["BodyRaster", "Fitted"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class BodyRaster:
    """A look at the body on a raster about the local origin: its node distance, (k, 3) places on the surface, extent.

    ``places`` are the middles of the raster's edges that cross the surface; ``lower`` and ``upper`` (3,) are corners of
    a box around the body, two nodes larger than it.
    """

    spacing: float
    places: Floats
    lower: Floats
    upper: Floats


@dataclass(frozen=True, eq=False)
class Fitted:
    """A fitted field and what it came from.

    ``survey`` is a look at the body on a raster, ``system`` the factorised system of contacts and active samples (None
    where parts were blended), ``active`` the number of active samples, ``conditions`` all that the field satisfies,
    ``buried`` the share of contacts that lie on cavities of the body.
    """

    field: BodyField
    region: Region
    prepared: Prepared
    survey: BodyRaster
    system: Saddle | None
    active: int
    conditions: int
    rounds: int
    seconds: float
    unsupported: int
    buried: float = 0.0
