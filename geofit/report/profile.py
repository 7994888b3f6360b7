"""What the geological sections of a report show of each horizon: its line, its 90 % band, its contacts nearby."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from string import ascii_uppercase

import numpy as np
from numpy.typing import NDArray

from geofit.data.guard import guarded
from geofit.data.points import PointSet
from geofit.data.prediction import PredictionResult
from geofit.data.site import Section, Site
from geofit.fitting.horizon_fit import HorizonFit
from geofit.geometry.mesh import Mesh
from geofit.prediction.section_bands import SectionBand, section_bands
from geofit.sampling.cut import cut_section

__all__ = ["Profile", "along_polyline", "profiles", "report_sections"]

Floats = NDArray[np.float64]

#: Sections of a report, and how far from a section (share of its length) holes and points are shown on it.
MOST, THICKNESS = 4, 0.02
#: Largest distance of the triangles that are cut, metres; vertices of the lines are exact.
COARSE = 0.5
#: Points in one line have no section across it: below this share of the site's extent.
NARROWEST = 1e-3


@dataclass(frozen=True, eq=False)
class Profile:
    """A line of a horizon in a section: ``line`` (k, 2) distance along the section and elevation, metres.

    ``band`` is the 90 % band of a new hole's contact, None where it is not known.
    """

    horizon: str
    line: Floats
    band: SectionBand | None = None


def report_sections(site: Site, points: Sequence[PointSet]) -> tuple[Section, ...]:
    """Return the sections that a report shows: up to four of the site's, far apart; else two through its middle."""
    lines = [section for section in site.sections if _length(section.line) > 0]
    if not lines:
        return _crosswise(site, points)
    chosen = [max(lines, key=lambda one: _length(one.line))]
    while len(chosen) < min(MOST, len(lines)):
        rest = [one for one in lines if one not in chosen]
        chosen.append(max(rest, key=lambda one: min(_apart(one, other) for other in chosen)))
    return tuple(one for one in lines if one in chosen)


def profiles(
    fit: HorizonFit, found: PredictionResult | None, sections: Sequence[Section]
) -> Mapping[str, tuple[Profile, ...]]:
    """Return what each section cuts of a horizon, by the section's name."""
    mesh = fit.triangulate(COARSE)
    return {section.name: _profiles(fit, found, section, mesh) for section in sections}


def along_polyline(line: Floats, xy: Floats) -> tuple[Floats, Floats]:
    """Return distance along a polyline and distance from it of (n, 2) places, metres."""
    best, where = np.full(len(xy), np.inf), np.zeros(len(xy))
    start_at = 0.0
    for start, end in pairwise(line):
        way = end - start
        length = float(np.hypot(*way))
        t = np.clip((xy - start) @ way / max(length**2, 1e-12), 0.0, 1.0)
        off = np.linalg.norm(xy - start - t[:, None] * way, axis=1)
        nearer = off < best
        best, where = np.where(nearer, off, best), np.where(nearer, start_at + t * length, where)
        start_at += length
    return where, best


def _profiles(fit: HorizonFit, found: PredictionResult | None, section: Section, mesh: Mesh) -> tuple[Profile, ...]:
    cuts = cut_section(fit.surface, section.line, mesh=mesh)
    uncertainty = None if found is None else found.uncertainty
    unknown: tuple[SectionBand | None, ...] = (None,) * len(cuts)
    bands = guarded(lambda: section_bands(fit, uncertainty, section.line, cuts), unknown, lambda reason: None)
    return tuple(
        Profile(fit.name, np.column_stack([cut.distance, cut.xyz[:, 2]]), band)
        for cut, band in zip(cuts, bands, strict=True)
    )


def _crosswise(site: Site, points: Sequence[PointSet]) -> tuple[Section, ...]:
    """Return two lines through the middle of the points, along and across their longer axis.

    Their letters are not the names of horizons.
    """
    xy = np.concatenate([one.xyz[:, :2] for one in points])
    if len(xy) < 3:
        return ()
    ends = xy if site.boundary is None else site.boundary
    middle = (ends.min(axis=0) + ends.max(axis=0)) / 2
    _, _, axes = np.linalg.svd(xy - xy.mean(axis=0), full_matrices=False)
    sections = []
    extent = float(np.hypot(*np.ptp(ends, axis=0)))
    letters = (letter for letter in ascii_uppercase if letter not in site.horizons)
    for name, way in zip(letters, axes, strict=False):
        way = way if way[0] > 0 or (way[0] == 0 and way[1] > 0) else -way
        reach = (ends - middle) @ way
        if np.ptp(reach) > NARROWEST * extent:
            sections.append(Section(name, middle + np.outer([reach.min(), reach.max()], way)))
    return tuple(sections)


def _length(line: Floats) -> float:
    return float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())


def _apart(one: Section, other: Section) -> float:
    """Return how different two sections are: distance of their middles, and of their directions."""
    ways = [(section.line[-1] - section.line[0]) for section in (one, other)]
    lengths = [max(float(np.hypot(*way)), 1e-9) for way in ways]
    sine = abs(ways[0][0] * ways[1][1] - ways[0][1] * ways[1][0]) / (lengths[0] * lengths[1])
    middles = [(section.line[0] + section.line[-1]) / 2 for section in (one, other)]
    return float(np.linalg.norm(middles[0] - middles[1]) + sine * min(lengths))
