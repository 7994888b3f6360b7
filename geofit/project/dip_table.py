"""The measured dips of a site as a table: what was measured, where, and what the surface of a horizon does there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import Message, message, plural_message
from geofit.data.site import Orientations
from geofit.fitting.horizon_fit import HorizonFit
from geofit.geometry.attitudes import mean_plane
from geofit.site.dips import check_dips
from geofit.site.site_checks import measured_on

__all__ = ["DipTable", "dip_lines", "dip_table"]

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class DipTable:
    """Some of the measurements of a site.

    ``index`` (n,) counts in ``measured``. ``surface_azimuth``, ``surface_dip`` and ``angle`` between the planes are
    (n,) degrees, nan where no surface was compared.
    """

    measured: Orientations
    index: NDArray[np.int64]
    surface_azimuth: Floats
    surface_dip: Floats
    angle: Floats

    def __len__(self) -> int:
        return len(self.index)

    @property
    def azimuth(self) -> Floats:
        """Azimuth of the steepest descent, (n,) degrees."""
        return self.measured.azimuth[self.index]

    @property
    def dip(self) -> Floats:
        """Dip below the horizontal, (n,) degrees."""
        return self.measured.dip[self.index]

    @property
    def text(self) -> Message:
        """The number of measurements, their mean plane, and how far they lie from the surface, in words."""
        if not len(self):
            return message("project.dips-none", "no dips were measured here")
        azimuth, dip, spread = mean_plane(self.azimuth, self.dip)
        head = plural_message(
            "project.dips-mean",
            "{count} measurement, {azimuth:03.0f}/{dip:02.0f}",
            "{count} measurements, mean plane {azimuth:03.0f}/{dip:02.0f}, mean angle from it {spread:.0f}°",
            count=len(self),
            azimuth=azimuth,
            dip=dip,
            spread=spread,
        )
        known = self.angle[np.isfinite(self.angle)]
        if not len(known):
            return head
        return message(
            "project.dips-mean-and-surface",
            "{head}; angle to the surface: mean {mean:.0f}°, largest {largest:.0f}°",
            head=head,
            mean=float(known.mean()),
            largest=float(known.max()),
        )


def dip_table(
    measured: Orientations, horizon: str = "", surface: HorizonFit | None = None, whole: str = ""
) -> DipTable:
    """Return the measurements of a horizon, or all of them.

    Parameters
    ----------
    measured : Orientations
        All measurements of the site.
    horizon : str
        The horizon whose measurements are wanted; all where it is empty.
    surface : HorizonFit, optional
        Its surface, which the measurements are compared with.
    whole : str
        The horizon that a block is a part of; without a block the horizon itself.
    """
    index = np.arange(len(measured))
    if horizon:
        index = index[measured.horizon == (whole or horizon)]
    compared = np.full((3, len(measured)), np.nan)
    if surface is not None:
        own = measured_on(measured, surface, whole) if whole not in ("", surface.name) else measured
        for one in check_dips(surface, own)[0]:
            compared[:, one.index] = one.surface_azimuth, one.surface_dip, one.angle
    return DipTable(measured, index, *compared[:, index])


def dip_lines(measured: Orientations, index: int) -> tuple[Message, ...]:
    """Return what is known of one measurement, a line each."""
    name, file = str(measured.horizon[index]), str(measured.file[index])
    lines = [
        message(
            "project.dip-towards",
            "dip {dip:.0f}° towards {azimuth:03.0f}°",
            dip=float(measured.dip[index]),
            azimuth=float(measured.azimuth[index]),
        )
    ]
    if name:
        lines.append(message("project.dips-of-horizon", "horizon {name}", name=name))
    if file:
        lines.append(message("project.dips-from-file", "{file}, row {row}", file=file, row=int(measured.row[index])))
    return tuple(lines)
