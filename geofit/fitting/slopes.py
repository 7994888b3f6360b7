"""Measured dips as data of the fit: each is two linear observations of the surface's gradient, of a stated accuracy.

A plane that dips as measured has the upward normal n; in a frame of heights its gradient is g = -(n_u, n_v) / n_w. An
angular error of standard deviation a about any axis in the plane gives g the covariance a^2 (1 + g'g) (I + g g'): the
derivative of g by n, squared. Divided by its Cholesky factor, each measurement is two rows of unit variance, which join
the normal equations of the field as the heights do (gradient data of a Gaussian field: C. E. Rasmussen, C. K. I.
Williams, *Gaussian Processes for Machine Learning*, 2006, sec. 9.4).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import Message, plural_message
from geofit.data.settings import FitSettings
from geofit.data.site import Orientations
from geofit.fitting.parametrize import Parametrization
from geofit.geometry.attitudes import plane_normals
from geofit.splines.tensor import TensorSpace

__all__ = ["Slopes", "slopes_of"]

Floats = NDArray[np.float64]

#: A measured plane steeper than this against the frame has no gradient that a height field could follow, degrees.
STEEPEST = 75.0


@dataclass(frozen=True, eq=False)
class Slopes:
    """Rows ``along . gradient(place) = value``, each with an error of standard deviation 1.

    ``plane`` (m, 2) places, ``along`` (m, 2), ``value`` (m,); two rows a measurement.
    """

    plane: Floats
    along: Floats
    value: Floats

    def __len__(self) -> int:
        return len(self.value)

    def in_units(self, unit: float, trend: Floats) -> Slopes:
        """Return the rows with places counted in ``unit`` metres, for heights about a trend 1, u, v (3,)."""
        along = self.along / unit
        return Slopes(self.plane / unit, along, self.value - along @ trend[1:])

    @property
    def turned(self) -> Slopes:
        """The same rows with u and v exchanged."""
        return replace(self, plane=self.plane[:, ::-1], along=self.along[:, ::-1])

    def equations(self, space: TensorSpace, noise: float) -> tuple[Floats, Floats, float]:
        """Return the band of G' W G, (bandwidth + 1, size), G' W g (size,), and g' W g.

        The weights are relative to points of the standard deviation ``noise``, metres.
        """
        weight = np.full(len(self), noise**2)
        band, right = space.equations_of(*space.gradient_rows(self.plane, self.along), self.value, weight)
        return band, right, float(weight @ self.value**2)


def slopes_of(
    orientations: Orientations | None, name: str, parametrization: Parametrization, settings: FitSettings
) -> tuple[Slopes | None, tuple[Message, ...]]:
    """Return the dips of a horizon as rows in its frame, metres, and what is to be said of them.

    Parameters
    ----------
    orientations : Orientations or None
        All measurements of the site; those that name the horizon count.
    name : str
        The horizon.
    parametrization : Parametrization
        The frame and the area; measurements off the area, and planes steeper than 75 degrees against the frame, are
        not used.
    settings : FitSettings
        ``dips`` switches them on, ``dip_accuracy`` is their standard deviation in degrees.
    """
    if settings.dips != "fit" or orientations is None:
        return None, ()
    mine = orientations.horizon == name
    if not mine.any():
        return None, ()
    if parametrization.parametric:
        return None, (_note_parametric(int(mine.sum())),)
    frame = parametrization.frame
    normal = plane_normals(orientations.azimuth[mine], orientations.dip[mine]) @ frame.axes.T
    normal *= np.where(normal[:, 2:] < 0, -1.0, 1.0)
    place = frame.to_local(orientations.xyz[mine])[:, :2]
    u0, u1, v0, v1 = parametrization.area
    within = (place[:, 0] >= u0) & (place[:, 0] <= u1) & (place[:, 1] >= v0) & (place[:, 1] <= v1)
    used = within & (normal[:, 2] > np.cos(np.radians(STEEPEST)))
    notes = _notes(int(used.sum()), int((~used).sum()), settings.dip_accuracy)
    if not used.any():
        return None, notes
    return _rows(place[used], -normal[used, :2] / normal[used, 2:], np.radians(settings.dip_accuracy)), notes


def _rows(place: Floats, gradient: Floats, accuracy: float) -> Slopes:
    steep = 1 + (gradient**2).sum(axis=1)
    covariance = accuracy**2 * steep[:, None, None] * (np.eye(2) + gradient[:, :, None] * gradient[:, None, :])
    whitened = np.linalg.inv(np.linalg.cholesky(covariance))
    value = np.einsum("kij,kj->ki", whitened, gradient)
    return Slopes(np.repeat(place, 2, axis=0), whitened.reshape(-1, 2), value.ravel())


def _note_parametric(count: int) -> Message:
    return plural_message(
        "fitting.dips-not-fitted-parametric",
        "{count} measured dip is checked but not fitted: a surface through sections has no gradient over the map",
        "{count} measured dips are checked but not fitted: a surface through sections has no gradient over the map",
        count=count,
    ).with_severity("warning")


def _notes(used: int, left: int, accuracy: float) -> tuple[Message, ...]:
    notes = []
    if used:
        notes.append(
            plural_message(
                "fitting.dips-fitted",
                "{count} measured dip holds the surface's slope, with an accuracy of {accuracy:g} degrees",
                "{count} measured dips hold the surface's slope, with an accuracy of {accuracy:g} degrees",
                count=used,
                accuracy=accuracy,
            )
        )
    if left:
        notes.append(
            plural_message(
                "fitting.dips-not-fitted",
                "{count} measured dip is checked but not fitted: it is off the study area, or nearly at right angles "
                "to the surface's plane",
                "{count} measured dips are checked but not fitted: they are off the study area, or nearly at right "
                "angles to the surface's plane",
                count=left,
            ).with_severity("warning")
        )
    return tuple(notes)
