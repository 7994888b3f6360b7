"""What a fit is: patches of one surface about a local origin, with their points and their check."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.accuracy import Accuracy
from geofit.data.messages import Message
from geofit.data.points import PointSet
from geofit.data.settings import FitSettings
from geofit.splines.patch import Patch

if TYPE_CHECKING:
    from geofit.data.accuracy import ReadBack
    from geofit.fitting.model import Model

__all__ = ["HorizonSurface", "Partition"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Partition:
    """How the points were split into core and periphery, and why (paper, sec. 3.2; fig. 3a).

    ``corners`` are the core's four corners in map coordinates (None without a core), ``core`` and
    ``periphery`` count points, ``reason`` says in words what was chosen.
    """

    corners: tuple[tuple[float, float], ...] | None
    core: int
    periphery: int
    reason: Message


@dataclass(frozen=True, eq=False)
class HorizonSurface:
    """A fitted (or imported) surface: patches, the points they were fitted to, and the check.

    Parameters
    ----------
    patches : tuple of Patch
        The core first, if there is one.
    origin : (3,) array
        Offset that turns the patches' coordinates into map coordinates, metres.
    points : PointSet
        All original points.
    settings : FitSettings
        Settings of the fit.
    name : str
        Name of the horizon.
    outline : (k, 2) array or None
        Plan polygon (map coordinates, not closed) that trims the surface; None: not trimmed.
    partition : Partition or None
        The split into core and periphery.
    core : (n,) array of bool
        Which points the surface interpolates exactly.
    accuracy : Accuracy or None
        The check; None only while the fit is under way.
    fit : mapping
        Figures of the fit for the report: control points, energy, smoothing, iterations, seconds a stage.
    model : Model or None
        What stands behind the patches of a fit; None for an imported surface.
    """

    patches: tuple[Patch, ...]
    origin: Floats
    points: PointSet
    settings: FitSettings = field(default_factory=FitSettings)
    name: str = "horizon"
    outline: Floats | None = None
    partition: Partition | None = None
    core: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, bool))
    accuracy: Accuracy | None = None
    fit: Mapping[str, Any] = field(default_factory=dict)
    model: Model | None = None

    def with_(self, **changes: Any) -> HorizonSurface:
        """Return a copy with some fields replaced."""
        return replace(self, **changes)

    @property
    def control_points(self) -> int:
        """Number of control points; rows that two patches share count once for each."""
        return sum(patch.control.shape[0] * patch.control.shape[1] for patch in self.patches)

    def elevation(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Return the height at map coordinates in metres, nan outside; arrays broadcast.

        Where the surface stands over a place more than once (an overturned fold), the highest.
        """
        from geofit.geometry.projection import elevation

        return elevation(self, x, y)

    def distance(self, xyz: ArrayLike) -> Floats:
        """Return the signed orthogonal distance of (n, 3) map coordinates, metres, positive above."""
        from geofit.geometry.projection import project

        return project(self.patches, np.atleast_2d(np.asarray(xyz, float)) - self.origin).distance

    def adjust(self, patch: str, i: int, j: int, dz: float) -> HorizonSurface:
        """Return the surface with one control point moved by hand; see :func:`geofit.fitting.edit.adjust`."""
        from geofit.fitting.edit import adjust

        return adjust(self, patch, i, j, dz)

    def pull_to(self, point: int | ArrayLike, share: float = 1.0) -> HorizonSurface:
        """Return the surface pulled to one of its points, or to a place; see :func:`geofit.fitting.edit.pull_to`."""
        from geofit.fitting.edit import pull_to

        return pull_to(self, point, share)

    def weigh(self, patch: str, i: int, j: int, weight: float) -> HorizonSurface:
        """Return the surface with another weight of one control point; see :func:`geofit.fitting.edit.weigh`."""
        from geofit.fitting.edit import weigh

        return weigh(self, patch, i, j, weight)

    def to_shape(self) -> Any:
        """Return a cadquery shell of the sewn patches in map coordinates."""
        from geofit.cad.sewing import to_shape

        return to_shape(self)

    def write_step(self, path: str | PathLike[str]) -> ReadBack:
        """Write the shell as STEP AP242, read it back, and return what the reader found."""
        from geofit.cad.step import write_step

        return write_step({self.name: self}, path)[self.name]
