"""A surface that was only read: no points judge it, so its file is checked for what surfaces alone can show."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from geofit.data.accuracy import Accuracy, Partition
from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.surfaces.protocol import FittedSurface, Surface

__all__ = ["as_fitted"]


@dataclass(frozen=True)
class _Unfitted:
    """A surface with no points; its geometry can be reached directly, and its seams may break."""

    surface: Surface
    points: PointSet = field(default_factory=lambda: PointSet(np.empty((0, 3))))
    settings: FitSettings = field(default_factory=lambda: FitSettings(seam="position"))
    partition: Partition | None = None
    core: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, bool))
    diagnostics: Mapping[str, Any] = field(default_factory=dict)
    accuracy: Accuracy | None = None

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return getattr(self.surface, name)


def as_fitted(surface: Surface) -> FittedSurface:
    """Return a fit as it is, and a surface that was read as one without points.

    Parameters
    ----------
    surface : Surface
        A fit, or patches from a file.

    Returns
    -------
    FittedSurface
        With points, settings and accuracy, which are none for patches from a file.
    """
    return cast("FittedSurface", surface if hasattr(surface, "points") else _Unfitted(surface))
