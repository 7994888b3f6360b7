"""Parts of the target that the front never reaches, parts of the source that vanish, and seeds for the former."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from geofit.implicit.lattice import Lattice
from geofit.implicit.mesh import TriangleMesh
from geofit.morphing.distance import Samples

__all__ = ["LonePart", "isolated_parts", "solid_parts", "with_seeds", "without_parts"]

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

#: Radius of a seed, in spacings.
SEED = 2.0


@dataclass(frozen=True, eq=False)
class LonePart:
    """A part of one body that does not touch the other.

    Parameters
    ----------
    kind : str
        "unreached": a part of the later body; "vanishing": a part of the earlier one.
    volume : float
        Of its nodes, m3.
    deepest : (3,) array
        Its place farthest from its surface, map coordinates in metres: where a seed is offered.
    depth : float
        Distance of that place from the surface, metres.
    leg : int
        Between which surveys: 0 for the first two.
    """

    kind: Literal["unreached", "vanishing"]
    volume: float
    deepest: Floats
    depth: float
    leg: int = 0

    def __repr__(self) -> str:
        x, y, z = self.deepest.tolist()
        return f"<{self.kind} part of {self.volume:.6g} m3 about ({x:.2f}, {y:.2f}, {z:.2f})>"


def isolated_parts(
    body: Samples, other: Bools, kind: Literal["unreached", "vanishing"], origin: Floats, leg: int
) -> tuple[tuple[LonePart, ...], Bools]:
    """Return the parts of a body that have no node in another, the largest first, and their nodes."""
    from scipy.ndimage import label

    lattice = body.lattice
    numbers, count = label(body.inside)
    touched = np.zeros(count + 1, bool)
    touched[np.unique(numbers[other])] = True
    touched[0] = True
    alone = ~touched[numbers]
    parts = []
    for number in np.flatnonzero(~touched):
        nodes = np.argwhere(numbers == number)
        depth, at = _deepest(nodes, lattice)
        parts.append(LonePart(kind, len(nodes) * lattice.spacing**3, at + origin, depth, leg))
    parts.sort(key=lambda part: -part.volume)
    return tuple(parts), alone


def solid_parts(mesh: TriangleMesh) -> int:
    """Return the number of separate parts of a closed mesh: a cavity is a closed surface of its own, but no part."""
    if not len(mesh.triangles):
        return 0
    # About a place near by: far from the origin the tetrahedra would cancel.
    outward = ((mesh.corners.mean(axis=1) - mesh.vertices.mean(axis=0)) * mesh.area_vectors).sum(axis=1)
    return int(np.count_nonzero(np.bincount(mesh.component_of, outward) > 0))


def _deepest(nodes: NDArray[np.int64], lattice: Lattice) -> tuple[float, Floats]:
    """Return how deep the deepest of some nodes lies, metres, and where it is."""
    from scipy.ndimage import distance_transform_edt

    low = nodes.min(axis=0) - 1
    box = np.zeros(nodes.max(axis=0) - low + 2, bool)
    box[tuple((nodes - low).T)] = True
    depth = distance_transform_edt(box)
    at = np.array(np.unravel_index(int(np.argmax(depth)), box.shape)) + low
    return float(depth.max() - 0.5) * lattice.spacing, lattice.origin + lattice.spacing * at


def without_parts(body: Samples, alone: Bools) -> Samples:
    """Return a body without some of its parts, given by their nodes."""
    if not alone.any():
        return body
    lattice, mesh = body.lattice, body.mesh
    normal = mesh.area_vectors / np.maximum(np.linalg.norm(mesh.area_vectors, axis=1, keepdims=True), 1e-300)
    within = mesh.corners.mean(axis=1) - 0.6 * lattice.spacing * normal
    node = np.clip(np.rint((within - lattice.origin) / lattice.spacing).astype(int), 0, np.array(lattice.shape) - 1)
    votes = np.zeros((mesh.components, 2))
    np.add.at(votes, (mesh.component_of, alone[tuple(node.T)].astype(int)), 1.0)
    kept = votes[:, 1] <= votes[:, 0]
    # A part below the spacing has votes for neither side; the rest keeps all that is left.
    return Samples(lattice, body.inside & ~alone, mesh.only(kept[mesh.component_of]), body.spline)


def with_seeds(body: Samples, distance: Floats, seeds: Floats, radius: float) -> tuple[Samples, Floats]:
    """Return a body with balls about seeds (k, 3, about the local origin), and its distances."""
    lattice = body.lattice
    x, y, z = lattice.axes
    inside, distance = body.inside.copy(), distance.copy()
    for seed in seeds:
        ball = (
            np.sqrt(((x - seed[0]) ** 2)[:, None, None] + ((y - seed[1]) ** 2)[:, None] + (z - seed[2]) ** 2) - radius
        )
        inside |= ball < 0
        distance = np.minimum(distance, ball)
    return Samples(lattice, inside, TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), int)), body.spline), distance
