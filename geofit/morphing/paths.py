"""Ways from A to B: fields at every share s of the way."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from geofit.data.progress import Progress, tell
from geofit.implicit.isosurface import isosurface_of_blocks
from geofit.implicit.lattice import Lattice
from geofit.implicit.mesh import TriangleMesh
from geofit.morphing.levelset import Step, evolve

__all__ = ["Line", "Path", "Snapshots", "level_set_path"]

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]

#: Cells of a block of a quick surface along each axis.
BLOCK = 8
#: Shares at which blocks change are known to this.
ROUNDING = 1e-5
#: Snapshots of the level-set equation, evenly in s; between two of them fields are linear.
SNAPSHOTS = 32
#: Half-width of the band that a snapshot keeps, in spacings.
KEPT = 4.0


class Path(Protocol):
    """Fields between two bodies."""

    @property
    def lattice(self) -> Lattice:
        """The nodes."""
        ...

    def between(self, s: float) -> tuple[NDArray[np.floating], NDArray[np.floating], float]:
        """Return two stored fields and the share t between them: the frame is (1 - t) first + t last."""
        ...


def samples_at(path: Path, s: float) -> Floats:
    """Return the field of the frame at share s, (nx, ny, nz)."""
    first, last, t = path.between(s)
    return np.asarray((1 - t) * np.asarray(first, float) + t * np.asarray(last, float))


def quick_surface(path: Path, s: float) -> TriangleMesh:
    """Return the surface of the frame at share s, linear between nodes; only blocks with surface are looked at."""
    from geofit.morphing.look_loops import gather_blocks, mixed_blocks

    first, last, t = path.between(s)
    blocks = path.blocks(s) if isinstance(path, Line) else mixed_blocks(first, last, t, BLOCK)
    return isosurface_of_blocks(gather_blocks(first, last, t, blocks, BLOCK), blocks, path.lattice)


@dataclass(frozen=True, eq=False)
class Line:
    """Frames linear in s between two fields: the linear blend of distances, or the arrival field."""

    lattice: Lattice
    first: Singles
    last: Singles

    def between(self, s: float) -> tuple[Singles, Singles, float]:
        """Return both fields and s."""
        return self.first, self.last, s

    @cached_property
    def _spans(self) -> tuple[NDArray[np.int64], Singles, Singles]:
        from geofit.morphing.look_loops import block_spans

        return block_spans(self.first, self.last, BLOCK)

    def blocks(self, s: float) -> NDArray[np.int64]:
        """Return the first nodes (k, 3) of the blocks that may have surface at share s."""
        starts, low, high = self._spans
        return np.asarray(starts[(low <= s + ROUNDING) & (high >= s - ROUNDING)])


@dataclass(frozen=True, eq=False)
class Snapshots:
    """Stored bands of fields at increasing shares ``s`` (k,), with the history of the evolution.

    ``nodes`` and ``values`` are the band of each snapshot (flat indices, metres), ``inside`` its nodes inside, packed.
    ``steps`` (n, 4) has time, volume, energy and symmetric difference of every step.
    """

    lattice: Lattice
    s: Floats
    nodes: tuple[NDArray[np.int32], ...]
    values: tuple[Singles, ...]
    inside: tuple[NDArray[np.uint8], ...]
    steps: Floats

    def between(self, s: float) -> tuple[Singles, Singles, float]:
        """Return the snapshots around s and the share between them."""
        k = int(np.clip(np.searchsorted(self.s, s, side="right") - 1, 0, len(self.s) - 2))
        t = (s - self.s[k]) / (self.s[k + 1] - self.s[k])
        return self.whole(k), self.whole(k + 1), float(np.clip(t, 0, 1))

    def whole(self, k: int) -> Singles:
        """Return snapshot k at all nodes; away from its band +-4 spacings."""
        count = int(np.prod(self.lattice.shape))
        far = np.float32(KEPT * self.lattice.spacing)
        inside = np.unpackbits(self.inside[k], count=count).astype(bool)
        phi = np.where(inside, -far, far)
        phi[self.nodes[k]] = self.values[k]
        return phi.reshape(self.lattice.shape)


def level_set_path(
    d_a: Floats, d_b: Floats, lattice: Lattice, eps: float, progress: Progress | None = None
) -> Snapshots:
    """Evolve A to B and keep snapshots at even shares s = 1 - exp(-t) of the way.

    Parameters
    ----------
    d_a, d_b : (nx, ny, nz) array
        Signed distances, metres.
    lattice : Lattice
        The nodes.
    eps : float
        Weight of the area, m2.
    progress : callable, optional
        ``progress(stage, fraction)``; False stops.
    """
    marks = np.arange(SNAPSHOTS + 1) / SNAPSHOTS
    far = KEPT * lattice.spacing
    kept: list[tuple[NDArray[np.int32], Singles, NDArray[np.uint8]]] = []
    history: list[tuple[float, float, float, float]] = []
    last: list[Step] = []

    def keep(phi: Floats) -> None:
        flat = phi.ravel()
        nodes = np.flatnonzero(np.abs(flat) < far).astype(np.int32)
        kept.append((nodes, flat[nodes].astype(np.float32), np.packbits(flat < 0)))

    def each(step: Step) -> None:
        history.append((step.time, step.volume, step.energy, step.different))
        s = 1 - np.exp(-step.time)
        tell(progress, "morph", float(1 - step.different / max(history[0][3], 1e-300)))
        if not last:
            keep(step.phi)
        while last and len(kept) < len(marks) - 1 and marks[len(kept)] <= s:
            before = 1 - np.exp(-last[0].time)
            t = (marks[len(kept)] - before) / (s - before)
            keep((1 - t) * last[0].phi + t * step.phi)
        last[:] = [step]

    corridor = (np.minimum(d_a, d_b), np.maximum(d_a, d_b))
    evolve(d_a, d_b, lattice, eps=eps, corridor=corridor, each=each)
    s = marks[: len(kept)]
    keep(d_b)
    nodes, values, inside = zip(*kept, strict=True)
    return Snapshots(lattice, np.append(s, 1.0), nodes, values, inside, np.array(history))
