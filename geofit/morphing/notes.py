"""What a reader of a metamorphosis must know: meshes that were turned, cells too coarse for what they measure."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import Message, message

if TYPE_CHECKING:
    from geofit.morphing.distance import Samples
    from geofit.morphing.sequence import Morph

__all__ = ["notes", "turned_note"]

Floats = NDArray[np.float64]

#: Spacings across a part below which its volume by the lattice is off by more than a few per cent.
ACROSS = 6.0
#: Parts smaller than this share of their body cannot change its volume.
SPECK = 0.01
#: Gain less loss may differ by this share of both from the difference of the volumes.
AGREES = 0.02
#: And by this share of the larger body: bodies that are equal differ by rounding.
ROUNDING = 1e-5


def notes(morph: Morph) -> tuple[Message, ...]:
    """Return the notes of a metamorphosis."""
    found = [turned_note(end.name) for end in morph.ends if end.turned]
    bodies = [morph.legs[0].start, *(leg.end for leg in morph.legs)]
    for end, body in zip(morph.ends, bodies, strict=True):
        if (across := _thinnest(body)) < ACROSS * body.lattice.spacing:
            found.append(_coarse(end.name, across, body.lattice.spacing))
    for leg, change, (first, last) in zip(morph.legs, morph.changes, pairwise(morph.ends), strict=True):
        before, after = leg.start.mesh.volume, leg.end.mesh.volume
        off = abs(change.net - (after - before))
        if off > AGREES * (change.gain + change.loss) + ROUNDING * max(before, after):
            found.append(
                message(
                    "morphing.volumes-disagree",
                    "From '{first}' to '{last}', gain less loss is {net:.6g} m³ on a lattice of {spacing:.3g} m, but "
                    "the volumes differ by {wanted:.6g} m³. Use a smaller spacing; if this remains, parts of a mesh "
                    "overlap or are inside out: repair it.",
                    first=first.name,
                    last=last.name,
                    net=change.net,
                    spacing=leg.lattice.spacing,
                    wanted=after - before,
                ).with_severity("warning")
            )
    return tuple(found)


def turned_note(name: str) -> Message:
    """Return the note of a mesh that was given inside out."""
    return message(
        "morphing.mesh-turned",
        "The normals of the mesh '{name}' point inwards: its triangles are reversed.",
        name=name,
    ).with_severity("warning")


def _coarse(name: str, across: float, spacing: float) -> Message:
    return message(
        "morphing.cells-too-coarse",
        "A part of '{name}' is about {across:.3g} m thick, {count:.1f} spacings of {spacing:.3g} m: its volume and "
        "shape are coarse. Use a spacing of {least:.2g} m or less; if parts lie far from each other, treat them one "
        "by one.",
        name=name,
        across=across,
        count=across / spacing,
        spacing=spacing,
        least=across / ACROSS,
    ).with_severity("warning")


def _thinnest(body: Samples) -> float:
    """Return the least thickness of the parts of a body: the diameter of the largest ball within each, metres.

    For parts of six spacings or more a bound from below.
    """
    from geofit.morphing.triangle_loops import spread_triangles

    mesh, lattice = body.mesh, body.lattice
    cones = ((mesh.corners.mean(axis=1) - mesh.vertices.mean(axis=0)) * mesh.area_vectors).sum(axis=1) / 3
    volume, area = np.bincount(mesh.component_of, cones), np.bincount(mesh.component_of, mesh.areas)
    # A plate is as thick as this, and all others are thicker, a ball three times.
    thick = 2 * np.abs(volume) / np.maximum(area, 1e-300)
    doubtful = (np.abs(volume) > SPECK * np.abs(volume).max(initial=0.0)) & (thick < ACROSS * lattice.spacing)
    if not doubtful.any():
        return np.inf
    places = (mesh.vertices - lattice.origin) / lattice.spacing
    nowhere = np.zeros(body.inside.size, bool)
    depth, nearest = spread_triangles(places, mesh.triangles, lattice.shape, nowhere, ACROSS / 2 + 1)
    part = np.where(nearest >= 0, mesh.component_of[nearest], -1)
    for k in np.flatnonzero(doubtful).tolist():
        # A cavity is a part, too: its nodes are outside.
        nodes = np.flatnonzero((part == k) & (body.inside.ravel() == (volume[k] > 0)))
        if len(nodes):
            middle = np.array(np.unravel_index(nodes[np.argmax(depth[nodes])], lattice.shape), float)
            thick[k] = 2 * lattice.spacing * _depth(middle, places[mesh.triangles[mesh.component_of == k]])
    return float(thick[doubtful].min())


def _depth(start: Floats, corners: Floats) -> float:
    """Return the greatest distance from triangles (n, 3, 3), uphill from a place (3,)."""
    from scipy.optimize import minimize

    from geofit.morphing.triangle_loops import nearest_places

    def minus_distance(place: Floats) -> float:
        feet = nearest_places(np.tile(place, (len(corners), 1)), corners)
        return -float(np.linalg.norm(feet - place, axis=1).min())

    # A simplex: at the middle of a plate the distance has a kink. A small one: beyond the triangles it grows again.
    simplex = start + np.concatenate([np.zeros((1, 3)), 0.5 * np.eye(3)])
    found = minimize(
        minus_distance, start, method="Nelder-Mead", options={"xatol": 0.02, "fatol": 0.02, "initial_simplex": simplex}
    )
    return -float(found.fun)
