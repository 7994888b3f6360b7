"""Sections: the lines in which a vertical curtain along a polyline in plan cuts a surface."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.columns import LARGEST
from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.geometry.mesh import Mesh
from geofit.geometry.projection import project
from geofit.sampling.isolines import plane_lines
from geofit.surfaces.protocol import Surface

__all__ = ["CutLine", "cut_section", "section_line"]

Floats = NDArray[np.float64]

#: Ends of lines nearer than this (metres) are joined where the section turns.
JOIN = 1e-6
#: Most Newton steps to the surface above a corner of the section.
STEPS = 20


@dataclass(frozen=True, eq=False)
class CutLine:
    """One line of a section: ``distance`` (k,) along the section and ``xyz`` (k, 3) map coordinates, metres."""

    distance: Floats
    xyz: Floats


def section_line(line: ArrayLike) -> Floats:
    """Return the corners of a section's line in plan as a (k, 2) array.

    Raises
    ------
    SettingsError
        If there are fewer than two different corners.
    """
    try:
        corners = np.asarray(line, float)
    except (TypeError, ValueError, OverflowError):
        corners = np.empty(0)
    if corners.ndim != 2 or corners.shape[1] != 2 or not (np.abs(corners) <= LARGEST).all():
        raise SettingsError(
            message(
                "sampling.section-line-wrong-shape",
                "The section line has shape {shape}; (k, 2) finite map coordinates are needed.",
                shape=corners.shape,
            )
        )
    apart = np.append(True, np.linalg.norm(np.diff(corners, axis=0), axis=1) > JOIN)
    if apart.sum() < 2:
        raise SettingsError(
            message(
                "sampling.section-line-one-point",
                "The section line has only one distinct point; give two different ends.",
            )
        )
    return np.asarray(corners[apart])


@arguments_checked
def cut_section(
    surface: Surface, line: ArrayLike, *, tolerance: float = 0.05, mesh: Mesh | None = None
) -> list[CutLine]:
    """Return the lines in which a section cuts a surface.

    Parameters
    ----------
    surface : Surface
        Any surface, steep and overturned ones included.
    line : (k, 2) array_like
        The section's line in plan, map coordinates; where it turns, so does the curtain.
    tolerance : float
        Largest distance in metres between a line and the surface, between its vertices; these are exact.
    mesh : Mesh, optional
        Triangles of the surface, if they are there already.

    Returns
    -------
    list of CutLine
        By distance. An overturned fold gives one line that turns back.

    Raises
    ------
    SettingsError
        If the line has fewer than two different corners.

    Notes
    -----
    Lines are traced through the triangles, and their vertices moved along the surface into the curtain.
    """
    corners = section_line(line) - surface.origin[:2]
    mesh = surface.triangulate(tolerance) if mesh is None else mesh
    pieces: list[tuple[Floats, Floats]] = []
    start_at = 0.0
    for start, end in pairwise(corners):
        length = float(np.linalg.norm(end - start))
        way = (end - start) / length
        normal = np.array([-way[1], way[0], 0.0])
        for places in plane_lines(surface, mesh, normal, float(normal[:2] @ start)):
            for part in _within(surface, places, start, end):
                along = ((part[:, :2] - start) @ way).clip(0, length)
                pieces.append((along + start_at, part))
        start_at += length
    joined = [
        (distance, places) if distance[0] <= distance[-1] else (distance[::-1], places[::-1])
        for distance, places in _joined(pieces)
    ]
    joined.sort(key=lambda piece: (piece[0].min(), piece[1][:, 2].min()))
    return [CutLine(distance, places + surface.origin) for distance, places in joined]


def _within(surface: Surface, places: Floats, start: Floats, end: Floats) -> list[Floats]:
    """Cut a line at both ends of a leg of the section; return what lies between."""
    length = float(np.linalg.norm(end - start))
    along = (places[:, :2] - start) @ (end - start) / length
    # Places at the ends belong to the leg.
    along = np.where(np.abs(along) <= JOIN, 0.0, np.where(np.abs(along - length) <= JOIN, length, along))
    rows: list[Floats] = [places[:1]]
    values: list[float] = [float(along[0])]
    for k in range(1, len(places)):
        a, b = float(along[k - 1]), float(along[k])
        for t, corner in sorted(
            ((limit - a) / (b - a), tuple(place))
            for limit, place in ((0.0, start), (length, end))
            if min(a, b) < limit < max(a, b)
        ):
            near = places[k - 1] + t * (places[k] - places[k - 1])
            rows.append(_upright(surface, np.array(corner), near)[None])
            values.append(0.0 if np.array_equal(corner, start) else length)
        rows.append(places[k : k + 1])
        values.append(b)
    line, value = np.concatenate(rows), np.array(values)
    middle = (value[:-1] + value[1:]) / 2
    held = (middle > 0) & (middle < length)
    bounds = np.flatnonzero(np.diff(np.concatenate([[0], held.astype(int), [0]])))
    return [line[first : last + 1] for first, last in bounds.reshape(-1, 2)]


def _upright(surface: Surface, corner: Floats, near: Floats) -> Floats:
    """Return where the vertical line at a corner meets the surface near a place; the place where it does not."""
    if not surface.patches:  # triangles of a file: the line between two places is the surface
        return near
    foot = project(surface.patches, near[None])
    patch, uv = surface.patches[int(foot.patch[0])], np.array([foot.u[0], foot.v[0]])
    u0, u1, v0, v1 = patch.domain
    for _ in range(STEPS):
        place = patch.evaluate(uv[0], uv[1])
        off = corner - place[:2]
        if np.abs(off).max() <= 1e-10:
            return np.asarray(place)
        jacobian = np.stack([patch.evaluate(uv[0], uv[1], 1, 0)[:2], patch.evaluate(uv[0], uv[1], 0, 1)[:2]], axis=1)
        step = np.linalg.lstsq(jacobian, off, rcond=None)[0]
        uv = (uv + step).clip([u0, v0], [u1, v1])
    return near


def _joined(pieces: list[tuple[Floats, Floats]]) -> list[tuple[Floats, Floats]]:
    """Join lines of neighbouring legs that meet at the corner, whichever way they run."""
    lines = list(pieces)
    k = 0
    while k < len(lines):
        for j in range(k + 1, len(lines)):
            both = _meeting(lines[k], lines[j])
            if both is not None:
                lines[k] = both
                lines.pop(j)
                break
        else:
            k += 1
    return lines


def _meeting(first: tuple[Floats, Floats], second: tuple[Floats, Floats]) -> tuple[Floats, Floats] | None:
    for one in (first, (first[0][::-1], first[1][::-1])):
        for two in (second, (second[0][::-1], second[1][::-1])):
            if abs(one[0][-1] - two[0][0]) <= JOIN and np.abs(one[1][-1] - two[1][0]).max() <= JOIN:
                return np.concatenate([one[0], two[0][1:]]), np.concatenate([one[1], two[1][1:]])
    return None
