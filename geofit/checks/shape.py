"""Faults of the surface itself: folds, collapsed patches, elevations far out, study area left uncovered."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.checks.lattice import PatchLattice, lattice_places
from geofit.data.accuracy import Check
from geofit.data.long_arrays import blocks, covariance
from geofit.data.messages import message
from geofit.geometry.elevation import plan_map
from geofit.geometry.trim_loops import inside_loops
from geofit.splines.bspline import greville
from geofit.splines.patch import Patch
from geofit.surfaces.protocol import FittedSurface

__all__ = ["shape_checks"]

Floats = NDArray[np.float64]

#: How far beyond the range of the data an elevation may go, as a share of that range.
RANGE_SHARE = 0.5
#: Points whose width is less than this share of their length say nothing across: one section, one line of holes.
STRIP = 0.05
#: Part of the study area, in percent, that the surface may leave uncovered.
UNCOVERED = 0.1
#: An edge shorter than this share of its patch has collapsed.
SHORT = 1e-6
#: Sine of the angle between a corner's edges below which the corner has collapsed (half a degree).
FLAT = 0.0087
#: Cosine between two legs of the control net beyond which the second runs back over the first (154 degrees).
BACK = -0.9
#: Places that a check names.
NAMED = 20
#: Pieces of each side of a face's rim, seen from above.
PIECES = 100


def shape_checks(surface: FittedSurface, parts: Sequence[PatchLattice]) -> list[Check]:
    """Look at the patches on lattices: "normals", "patches", "elevation range", "strip", "area" where they apply."""
    checks = [_normals(surface, parts), _patches(surface)]
    if len(surface.points) and np.ptp(surface.points.xyz[:, 2]) > 0:
        checks.append(_elevation_range(surface, parts))
    checks += _strip(surface, parts)
    if surface.outline is not None and surface.frame not in ("best-plane", "sections"):
        # A fold or a steep surface need not lie over all of the area.
        checks.append(_area(surface))
    return checks


def _normals(surface: FittedSurface, parts: Sequence[PatchLattice]) -> Check:
    """Folds and flipped normals: a fold that is meant turns its normals; any other surface's look to one side."""
    points, normal = lattice_places(parts)
    if not len(points):
        points = np.concatenate([p.points.reshape(-1, 3) for p in parts])
        normal = np.concatenate([p.normal.reshape(-1, 3) for p in parts])
    turned = np.linalg.norm(normal, axis=1) < 1e-9
    frame = surface.frame
    if frame != "sections":
        upward = np.array([0.0, 0.0, 1.0]) if frame == "map" else _majority(normal)
        turned |= normal @ upward < 0
    count = int(turned.sum())
    if count:
        text = message(
            "checks.places-folded",
            "{count} of {total} places folded or degenerate: the surface turns over there, or its "
            "normals point to the other side",
            count=count,
            total=len(normal),
        )
    else:
        text = message(
            "checks.places-folded-count",
            "{count} of {total} places folded or degenerate",
            count=0,
            total=len(normal),
        )
    where = points[turned][:NAMED] + surface.origin
    return Check("normals", count == 0, count, 0, "places", text, _named(where))


def _majority(normal: Floats) -> Floats:
    """Mean normal of the places that look to the side that most look to: patches that are turned round count less."""
    longest = normal[np.argmax(np.linalg.norm(normal, axis=1))]
    mean = (normal * np.where(normal @ longest < 0, -1.0, 1.0)[:, None]).mean(axis=0)
    return np.asarray(mean if np.median(normal @ mean) >= 0 else -mean)


def _patches(surface: FittedSurface) -> Check:
    """Edges without length, corners without an angle, control points that run back over their neighbours."""
    faults: list[tuple[str, Floats]] = []
    for patch, loops in zip(surface.patches, surface.loops, strict=True):
        faults += [(patch.name, place) for place in _collapsed(patch, loops)]
        if surface.frame != "best-plane" and plan_map(patch) is None:
            # A height field's control points are in order by construction.
            faults += [(patch.name, place) for place in _out_of_order(patch, loops)]
    count = len(faults)
    if not count:
        text = message(
            "checks.patches-not-degenerate",
            "no edge, corner or control point of the patches ({n}) has collapsed",
            n=len(surface.patches),
        )
        return Check("patches", True, 0, 0, "places", text)
    names = tuple(dict.fromkeys(name for name, _ in faults))
    text = message(
        "checks.patches-degenerate",
        "places where patches are degenerate (an edge without length, a corner without an angle, control points "
        "that run back): {count}, in {names}; other programs may refuse such a face",
        count=count,
        names=names,
    )
    return Check("patches", False, count, 0, "places", text, _named(np.array([p for _, p in faults]) + surface.origin))


def _collapsed(patch: Patch, loops: tuple[Floats, ...]) -> list[Floats]:
    net = patch.control
    size = float(np.linalg.norm(np.ptp(net.reshape(-1, 3), axis=0)))
    held = _held(patch, loops)
    edges = ((net[:, 0], held[:, 0]), (net[:, -1], held[:, -1]), (net[0], held[0]), (net[-1], held[-1]))
    long = [np.linalg.norm(np.diff(edge, axis=0), axis=1).sum() for edge, _ in edges]
    found = [edge[0] for (edge, some), length in zip(edges, long, strict=True) if some.any() and length <= SHORT * size]
    for i in (0, -1):
        for j in (0, -1):
            if not held[i, j]:
                continue
            along = net[1 if i == 0 else -2, j] - net[i, j]
            across = net[i, 1 if j == 0 else -2] - net[i, j]
            lengths = float(np.linalg.norm(along) * np.linalg.norm(across))
            if np.linalg.norm(np.cross(along, across)) <= FLAT * lengths:
                found.append(net[i, j])
    return found


def _held(patch: Patch, loops: tuple[Floats, ...]) -> NDArray[np.bool_]:
    """Which control points (nu, nv) stand inside the loops, by their Greville abscissae."""
    u, v = greville(patch.knots_u, patch.degree[0]), greville(patch.knots_v, patch.degree[1])
    return inside_loops(patch, loops, *np.meshgrid(u, v, indexing="ij"))


def _out_of_order(patch: Patch, loops: tuple[Floats, ...]) -> list[Floats]:
    found, held = [], _held(patch, loops)
    for net, some in ((patch.control, held), (patch.control.transpose(1, 0, 2), held.T)):
        legs = np.diff(net, axis=0)
        lengths = np.linalg.norm(legs, axis=2)
        cosine = (legs[1:] * legs[:-1]).sum(axis=2) / np.maximum(lengths[1:] * lengths[:-1], 1e-300)
        found.append(net[1:-1][(cosine < BACK) & some[1:-1]])
    return list(np.concatenate(found))


def _elevation_range(surface: FittedSurface, parts: Sequence[PatchLattice]) -> Check:
    points, _ = lattice_places(parts)
    if not len(points):
        points = np.concatenate([p.points.reshape(-1, 3) for p in parts])
    z = surface.points.xyz[:, 2]
    low, high = z.min() - surface.origin[2], z.max() - surface.origin[2]
    beyond = np.maximum(low - points[:, 2], points[:, 2] - high)
    worst = int(np.argmax(beyond))
    value, limit = max(float(beyond[worst]), 0.0), RANGE_SHARE * float(high - low)
    text = message("data.elevations-beyond-data", "elevations reach {value:.1f} m beyond the data's range", value=value)
    where = _named(points[[worst]] + surface.origin) if value > limit else ()
    return Check("elevation range", value <= limit, value, limit, "m", text, where)


def _strip(surface: FittedSurface, parts: Sequence[PatchLattice]) -> list[Check]:
    """Ask whether the surface goes on aside from points that stand along one line, seen at right angles to it."""
    if surface.frame == "sections" or len(surface.points) < 3:
        return []
    places, normal = lattice_places(parts)
    if not len(places):
        return []
    up = np.array([0.0, 0.0, 1.0]) if surface.frame == "map" else _majority(normal)
    flat = np.linalg.svd(up[None])[2][1:].T
    directions = flat @ np.linalg.eigh(flat.T @ covariance(surface.points.xyz)[1] @ flat)[1]

    def extent(direction: Floats) -> float:
        # Some points at a time: all at once would take a third of their coordinates' memory again.
        ends = [(at.min(), at.max()) for at in (some @ direction for (some,) in blocks(surface.points.xyz))]
        low, high = np.transpose(ends)
        return float(high.max() - low.min())

    across, along = (extent(direction) for direction in directions.T)
    wide = float(np.ptp(places @ directions[:, 0]))
    if across >= STRIP * along or wide <= 2 * across:
        return []
    text = message(
        "checks.points-along-a-line",
        "the points lie along one line: {along:.1f} m long, {across:.1f} m wide; the surface is {wide:.1f} m wide, "
        "and away from the line nothing is known of it",
        along=along,
        across=across,
        wide=wide,
    )
    return [Check("strip", False, float(across), STRIP * float(along), "m", text)]


def _area(surface: FittedSurface) -> Check:
    """Area of the surface's plan within the study area, beside the area of its polygon."""
    assert surface.outline is not None
    outline = surface.outline - surface.origin[:2]
    wanted = abs(_signed_area(outline))
    covered = _covered(surface, outline)
    off = 100.0 * abs(covered / wanted - 1.0)
    figures = {"covered": covered, "wanted": wanted, "off": off}
    if off <= UNCOVERED:
        text = message(
            "checks.area-covered",
            "the surface covers {covered:whole} of the study area's {wanted:whole} square metres",
            **figures,
        )
    elif covered < wanted:
        text = message(
            "checks.area-not-covered",
            "the surface covers only {covered:whole} of the study area's {wanted:whole} square metres: {off:.1f} % of "
            "it have no surface",
            **figures,
        )
    else:
        text = message(
            "checks.patches-overlap",
            "the patches cover {covered:whole} square metres of a study area of {wanted:whole}: they overlap",
            **figures,
        )
    return Check("area", off <= UNCOVERED, off, UNCOVERED, "%", text)


def _covered(surface: FittedSurface, outline: Floats) -> float:
    faces = list(zip(surface.patches, surface.loops, strict=True))
    if all(not loops and plan_map(patch) is not None for patch, loops in faces):
        corners = [patch.control[[0, -1, -1, 0], [0, 0, -1, -1], :2] for patch, _ in faces]
        return sum(abs(_signed_area(_clipped(outline, quad))) for quad in corners)
    import shapely

    rims = [_plan(patch, loops) for patch, loops in faces]
    return float(shapely.intersection(shapely.union_all(rims), shapely.Polygon(outline)).area)


def _plan(patch: Patch, loops: tuple[Floats, ...]) -> Any:
    """Return what a face covers of the map, its rim taken in short pieces."""
    import shapely

    u0, u1, v0, v1 = patch.domain
    region: Any = shapely.Polygon()
    for loop in loops or (np.array([[u0, v0], [u1, v0], [u1, v1], [u0, v1]]),):
        share = np.arange(PIECES)[:, None] / PIECES
        along = loop[:, None] + share * (np.roll(loop, -1, axis=0) - loop)[:, None]
        ring = patch.evaluate(*along.reshape(-1, 2).T)[:, :2]
        region = region.symmetric_difference(shapely.make_valid(shapely.Polygon(ring)))
    return region


def _clipped(polygon: Floats, convex: Floats) -> Floats:
    """Sutherland and Hodgman (1974): the part of a polygon within a convex one; edges may run back on themselves."""
    if _signed_area(convex) < 0:
        convex = convex[::-1]
    for start, end in zip(convex, np.roll(convex, -1, axis=0), strict=True):
        if not len(polygon):
            break
        side = end - start
        off = side[0] * (polygon[:, 1] - start[1]) - side[1] * (polygon[:, 0] - start[0])
        kept: list[Floats] = []
        for k in range(len(polygon)):
            a, b = k - 1, k
            if (off[a] < 0) != (off[b] < 0):
                kept.append(polygon[a] + (polygon[b] - polygon[a]) * off[a] / (off[a] - off[b]))
            if off[b] >= 0:
                kept.append(polygon[b])
        polygon = np.array(kept).reshape(-1, 2)
    return polygon


def _signed_area(ring: Floats) -> float:
    if len(ring) < 3:
        return 0.0
    x, y = (ring - ring[0]).T
    return float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2)


def _named(where: Floats) -> tuple[tuple[float, float, float], ...]:
    return tuple((float(x), float(y), float(z)) for x, y, z in where[:NAMED])
