"""Alignment of one body with another: shift, rotation and scale from principal axes, polished on the surface."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations, product

import numpy as np
from numpy.typing import NDArray

from geofit.implicit.field import Box, Field
from geofit.implicit.grid import SplineGrid
from geofit.morphing.distance import Samples

__all__ = ["Alignment", "Carried", "align"]

Floats = NDArray[np.float64]

#: Principal axes whose moments differ by less than this share may change places.
ALIKE = 0.1
#: Cells of the grid on which candidates are compared.
COARSE = 32
#: Places of the surface that the last polish uses, and its evaluations.
PLACES, EVALUATIONS = 3000, 50


@dataclass(frozen=True, eq=False)
class Alignment:
    """The similarity x -> scale R (x - centre) + centre + shift that lays one body on another.

    Parameters
    ----------
    rotation : (3, 3) array
        R, with determinant +1.
    scale : float
        Uniform scale.
    centre : (3,) array
        Centroid of the body that is moved, about the local origin, metres.
    shift : (3,) array
        Shift of that centroid, metres.
    before, after : float
        Intersection over union of both bodies without and with the alignment.
    applied : bool
        Whether the metamorphosis uses it; otherwise it is a report only.
    """

    rotation: Floats
    scale: float
    centre: Floats
    shift: Floats
    before: float
    after: float
    applied: bool = False

    @property
    def angle(self) -> float:
        """Angle of the rotation, degrees."""
        return float(np.degrees(np.arccos(np.clip((np.trace(self.rotation) - 1) / 2, -1, 1))))

    @property
    def distance(self) -> float:
        """Length of the shift, metres."""
        return float(np.linalg.norm(self.shift))

    def part(self, share: float) -> tuple[Floats, float, Floats]:
        """Return rotation, scale and shift of a share of the way: slerp, log-linear, linear."""
        from scipy.spatial.transform import Rotation

        turned = Rotation.from_rotvec(share * Rotation.from_matrix(self.rotation).as_rotvec())
        return np.asarray(turned.as_matrix()), float(self.scale**share), share * self.shift

    def points(self, xyz: Floats, share: float = 1.0) -> Floats:
        """Return (n, 3) places carried a share of the way."""
        rotation, scale, shift = self.part(share)
        return np.asarray(scale * (xyz - self.centre) @ rotation.T + self.centre + shift)


@dataclass(frozen=True, eq=False)
class Carried:
    """A field carried by a share of an alignment, or back by a negative one; still metres."""

    field: Field
    alignment: Alignment
    share: float

    def _back(self, xyz: Floats) -> tuple[Floats, Floats, float]:
        rotation, scale, shift = self.alignment.part(self.share)
        centre = self.alignment.centre
        if self.share < 0:
            # The inverse of the positive share, exactly.
            rotation, scale, shift = self.alignment.part(-self.share)
            return scale * (xyz - centre) @ rotation.T + centre + shift, rotation.T, 1 / scale
        return (xyz - centre - shift) @ rotation / scale + centre, rotation, scale

    def value(self, xyz: Floats) -> Floats:
        """Return the values at (n, 3) points."""
        at, _, scale = self._back(xyz)
        return np.asarray(scale * self.field.value(at))

    def gradient(self, xyz: Floats) -> Floats:
        """Return the gradients at (n, 3) points."""
        at, rotation, _ = self._back(xyz)
        return np.asarray(self.field.gradient(at) @ rotation.T)

    @property
    def bounds(self) -> Box:
        """Box of the carried box."""
        low, high = self.field.bounds
        corners = np.array(list(product(*zip(low, high, strict=True))))
        rotation, scale, shift = self.alignment.part(abs(self.share))
        centre = self.alignment.centre
        if self.share < 0:
            moved = (corners - centre - shift) @ rotation / scale + centre
        else:
            moved = scale * (corners - centre) @ rotation.T + centre + shift
        return moved.min(axis=0), moved.max(axis=0)

    @property
    def lipschitz(self) -> float:
        """That of the field."""
        return self.field.lipschitz


def align(a: Samples, b: Samples, d_a: SplineGrid, d_b: SplineGrid, *, principal: bool) -> Alignment:
    """Return the alignment of a body with another.

    Parameters
    ----------
    a, b : Samples
        Both bodies.
    d_a, d_b : SplineGrid
        Their signed distances.
    principal : bool
        Begin with the principal axes and equal volumes; otherwise where the bodies are and without scale: what the
        registration of surveys may have missed.

    Notes
    -----
    Moments of the inner nodes; all proper sign changes of the axes are tried, and all orders of axes that are alike.
    The largest intersection over union wins and is polished by least squares of the distances of the surface.
    """
    places_a, places_b = (s.lattice.nodes()[s.inside.ravel()] for s in (a, b))
    centre, target = places_a.mean(axis=0), places_b.mean(axis=0)
    scale = (len(places_b) / len(places_a)) ** (1 / 3)
    grid = _grid(places_b)
    inside_b = d_b.value(grid) < 0

    def overlap(rotation: Floats, size: float, shift: Floats) -> float:
        back = (grid - centre - shift) @ rotation / size + centre
        inside = d_a.value(back) < 0
        either = (inside | inside_b).sum()
        return float((inside & inside_b).sum() / either) if either else 0.0

    if not principal:
        turned, _, shift = _polish(a, d_b, np.eye(3), 1.0, centre, np.zeros(3), scaled=False)
        before, after = overlap(np.eye(3), 1.0, np.zeros(3)), overlap(turned, 1.0, shift)
        if after <= before:
            turned, shift, after = np.eye(3), np.zeros(3), before
        return Alignment(turned, 1.0, centre, shift, before, after)
    moments_a, axes_a = np.linalg.eigh(np.cov(places_a.T))
    _, axes_b = np.linalg.eigh(np.cov(places_b.T))
    best, chosen = -1.0, np.eye(3)
    for order in permutations(range(3)):
        if any(abs(moments_a[order[k]] - moments_a[k]) > ALIKE * moments_a[k] for k in range(3)):
            continue
        for signs in product((1.0, -1.0), repeat=3):
            rotation = axes_b @ np.diag(signs) @ axes_a[:, list(order)].T
            if np.linalg.det(rotation) > 0 and (found := overlap(rotation, scale, target - centre)) > best + 1e-9:
                best, chosen = found, rotation
    polished = _polish(a, d_b, chosen, scale, centre, target - centre)
    if overlap(*polished) >= best:
        chosen, scale, shift = polished
    else:
        shift = target - centre
    return Alignment(chosen, scale, centre, shift, overlap(np.eye(3), 1.0, np.zeros(3)), overlap(chosen, scale, shift))


def _grid(places: Floats) -> Floats:
    low, high = places.min(axis=0), places.max(axis=0)
    room = 0.15 * (high - low)
    axes = [np.linspace(*ends, COARSE) for ends in zip(low - room, high + room, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def _polish(
    a: Samples,
    d_b: SplineGrid,
    rotation: Floats,
    scale: float,
    centre: Floats,
    shift: Floats,
    *,
    scaled: bool = True,
) -> tuple[Floats, float, Floats]:
    """Return rotation, scale and shift with the least squares of the distances of A's surface from B's."""
    from scipy.optimize import least_squares
    from scipy.spatial.transform import Rotation

    vertices = a.mesh.vertices
    some = vertices[:: max(1, len(vertices) // PLACES)] - centre
    size = float(np.abs(some).max())

    def moved(p: Floats) -> tuple[Floats, float, Floats]:
        turn = np.asarray(Rotation.from_rotvec(p[:3] / size).as_matrix())
        return turn @ rotation, scale * float(np.exp(p[6:].sum() / size)), shift + p[3:6]

    def off(p: Floats) -> Floats:
        turned, large, away = moved(p)
        return d_b.value(large * some @ turned.T + centre + away)

    found = least_squares(
        off,
        np.zeros(6 + scaled),
        max_nfev=EVALUATIONS // 8,
        diff_step=np.full(6 + scaled, 1e-4),
        x_scale=a.lattice.spacing,
    )
    return moved(found.x)
