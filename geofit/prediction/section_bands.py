"""The 90 % band of a surface in a vertical section: the lines between which a new hole meets it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.prediction import Uncertainty
from geofit.fitting.calibration import BAND
from geofit.fitting.horizon_fit import HorizonFit
from geofit.prediction.bands import band_directions, prediction_sd
from geofit.sampling.cut import CutLine, section_line

__all__ = ["SectionBand", "section_bands"]

Floats = NDArray[np.float64]

#: Least square of the part of a normal in the section: nearly parallel to it, the band would run out of any drawing.
_PARALLEL = 0.05


@dataclass(frozen=True, eq=False)
class SectionBand:
    """Edges of a 90 % band: ``lower`` and ``upper`` (k, 2), distance along the section and elevation, metres."""

    lower: Floats
    upper: Floats

    @property
    def outline(self) -> Floats:
        """The band as a polygon, (2 k, 2)."""
        return np.concatenate([self.upper, self.lower[::-1]])

    def part(self, run: slice) -> SectionBand:
        """Return the band along a stretch of its line."""
        return SectionBand(self.lower[run], self.upper[run])


def section_bands(
    surface: HorizonFit, uncertainty: Uncertainty | None, line: ArrayLike, cuts: Sequence[CutLine]
) -> tuple[SectionBand | None, ...]:
    """Return the 90 % band of a new hole's contact along each line in which a section cuts a surface.

    None without an uncertainty, or where nothing is known about how the surface was fitted.

    Parameters
    ----------
    surface : HorizonFit
        A fitted surface: a height field, a steep one over its best plane, or a folded one.
    uncertainty : Uncertainty or None
        ``examine(surface).uncertainty``.
    line : (k, 2) array_like
        The section's line in plan, map coordinates, metres.
    cuts : sequence of CutLine
        What :func:`geofit.sampling.cut.cut_section` found along it.

    Notes
    -----
    The standard deviation is measured upwards, across the best plane, or along the normal. Moving a plane by w along
    its normal n moves its trace by w n' / |n'|^2, n' the part of n in the section.
    """
    if uncertainty is None or surface.model is None or not cuts:
        return (None,) * len(cuts)
    xyz = np.concatenate([cut.xyz for cut in cuts])
    distance = np.concatenate([cut.distance for cut in cuts])
    shift = BAND * prediction_sd(surface, uncertainty, xyz, "contact")[:, None]
    shift = shift * _within_section(section_line(line), distance, band_directions(surface, xyz))
    trace = np.column_stack([distance, xyz[:, 2]])
    whole = SectionBand(trace - shift, trace + shift)
    ends = np.cumsum([len(cut.distance) for cut in cuts])
    return tuple(whole.part(slice(int(end) - len(cut.distance), int(end))) for cut, end in zip(cuts, ends, strict=True))


def _within_section(corners: Floats, distance: Floats, normal: Floats) -> Floats:
    """Return how a shift by one metre along the normals moves the trace in the plane of the section, (n, 2)."""
    steps = np.diff(corners, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    leg = np.clip(np.searchsorted(np.cumsum(lengths), distance), 0, len(steps) - 1)
    ways = steps / lengths[:, None]
    across = np.column_stack([(ways[leg] * normal[:, :2]).sum(axis=1), normal[:, 2]])
    return np.asarray(across / np.maximum((across**2).sum(axis=1), _PARALLEL)[:, None])
