"""One leg of a metamorphosis: the way between two neighbouring surveys."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.columns import measurable_places
from geofit.data.messages import message
from geofit.data.progress import Progress
from geofit.implicit.grid import SplineGrid, spline_grid
from geofit.implicit.lattice import Lattice
from geofit.morphing.arrival import arrival, source_field
from geofit.morphing.distance import Samples, both_distances, distances, front_distances
from geofit.morphing.errors import MorphError
from geofit.morphing.parts import SEED, LonePart, isolated_parts, solid_parts, with_seeds, without_parts
from geofit.morphing.paths import BLOCK, Line, Path, level_set_path, quick_surface, samples_at

__all__ = ["Leg", "Mode", "Pace", "leg_between"]

Floats = NDArray[np.float64]
Mode = Literal["arrival", "blend", "pde"]
Pace = Literal["progress", "volume", "time"]

#: Shares of the way at which the pace is tabled; between them it is linear.
TABLED = 33
#: A frame's field is kept within this many spacings: a spline would swing next to larger steps.
KEPT = 8.0
#: A share is found by its volume to this.
FOUND = 1e-5


@dataclass(frozen=True, eq=False)
class Leg:
    """The way between two bodies.

    Parameters
    ----------
    path : Path
        Its fields.
    d_a, d_b : (nx, ny, nz) array
        Signed distances from both ends, metres; of the later one without the parts that are never reached.
    start, end : Samples
        Both ends on the lattice.
    unreached, vanishing : tuple of Part
        What the front cannot connect.
    """

    path: Path
    d_a: Floats
    d_b: Floats
    start: Samples
    end: Samples
    unreached: tuple[LonePart, ...]
    vanishing: tuple[LonePart, ...]

    @property
    def lattice(self) -> Lattice:
        """The nodes."""
        return self.path.lattice

    def spline(self, s: float) -> SplineGrid:
        """Return the C2 field of the frame at share s."""
        # No surface of a frame is farther away than both ends together: where these meet, large steps would make the
        # spline swing.
        far = np.minimum(np.abs(self.d_a) + np.abs(self.d_b), KEPT * self.lattice.spacing)
        return spline_grid(np.clip(samples_at(self.path, s), -far, far), self.lattice)

    @cached_property
    def _tabled(self) -> tuple[Floats, Floats, Floats]:
        """Shares s (k,), and the volume that joined (k,) and left (k,) the first frame up to each, m3."""
        from geofit.morphing.look_loops import block_spans, joint_volumes

        s = np.linspace(0, 1, TABLED)
        (first, *_), (_, last, _) = self.path.between(0.0), self.path.between(1.0)
        # Frames stay between both ends: where these agree, nothing changes.
        blocks, *_ = block_spans(first, last, BLOCK)
        frames = (self.path.between(one) for one in s.tolist())
        union, common = np.transpose([joint_volumes(*frame, first, blocks, BLOCK) for frame in frames])
        cell = self.lattice.spacing**3
        return s, (union - union[0]) * cell, (common[0] - common) * cell

    def progress(self, s: float) -> float:
        """Return the share of the symmetric difference of the ends that is done at share s."""
        tabled, done = self._done
        return float(np.interp(s, tabled, done))

    def share_at_progress(self, p: float) -> float:
        """Return the share s at which a share p of the symmetric difference is done."""
        tabled, done = self._done
        return float(np.interp(p, done, tabled))

    @property
    def _done(self) -> tuple[Floats, Floats]:
        """Shares s (k,) and the share of the symmetric difference that is done at each, rising from 0 to 1."""
        tabled, joined, left = self._tabled
        done = np.maximum.accumulate(joined + left)
        if done[-1] <= 0:
            return tabled, tabled
        # Flat parts would have no inverse: a trace of s itself keeps it.
        steady = done / done[-1] + 1e-9 * tabled
        return tabled, steady / steady[-1]

    def share_at_volume(self, p: float) -> float:
        """Return the share s at which the volume is (1 - p) V_A + p V_B.

        Raises
        ------
        MorphError
            If the volume does not rise or fall all the way.
        """
        from scipy.optimize import brentq

        ends = self._end_volumes
        change = ends[1.0] - ends[0.0]
        _, joined, left = self._tabled
        if abs(change) <= self.lattice.spacing**3 or (np.diff(joined - left) / change < -0.002).any():
            raise self._not_monotone()
        wanted = ends[0.0] + p * change

        def off(s: float) -> float:
            return (ends[s] if s in ends else self.volume(s)) - wanted

        return float(brentq(off, 0.0, 1.0, xtol=FOUND))

    @cached_property
    def _end_volumes(self) -> dict[float, float]:
        return {s: self.volume(s) for s in (0.0, 1.0)}

    def _not_monotone(self) -> MorphError:
        return MorphError(
            message(
                "morphing.volume-not-monotone",
                "The volume does not rise or fall all the way between the bodies, so it cannot set the pace. Use the "
                "pace 'progress'.",
            )
        )

    def volume(self, s: float) -> float:
        """Return the volume of the frame at share s, m3, its samples linear in tetrahedra."""
        from geofit.morphing.look_loops import tetrahedra_volume

        return float(tetrahedra_volume(samples_at(self.path, s))) * self.lattice.spacing**3

    def gain_and_loss(self, s: float) -> tuple[float, float]:
        """Return what the frame at share s has that A has not, and the reverse, m3."""
        from geofit.morphing.look_loops import cell_fractions

        # The later survey itself ends the way, with the parts that no front reaches.
        more = self.changed_fractions
        if s < 1:
            more = cell_fractions(samples_at(self.path, s), self.lattice.spacing) - self._first_fractions
        cell = self.lattice.spacing**3
        return float(more[more > 0].sum(dtype=float)) * cell, float(0.0 - more[more < 0].sum(dtype=float)) * cell

    @cached_property
    def _first_fractions(self) -> NDArray[np.float32]:
        from geofit.morphing.look_loops import cell_fractions

        return np.asarray(cell_fractions(self.d_a, self.lattice.spacing))

    @cached_property
    def changed_fractions(self) -> NDArray[np.float32]:
        """Part of the cube about each node that was gained, or lost if negative, (nx, ny, nz)."""
        from geofit.morphing.look_loops import cell_fractions

        # With the parts that no front reaches: they are gained, too.
        later = distances(self.end, self.end.inside) if self.unreached else self.d_b
        return np.asarray(cell_fractions(later, self.lattice.spacing) - self._first_fractions)

    def drift(self, s: float) -> float:
        """Return the volume of the frame at share s outside the corridor between both ends, m3."""
        from geofit.morphing.look_loops import tetrahedra_volume

        phi, cell = samples_at(self.path, s), self.lattice.spacing**3
        beyond = tetrahedra_volume(np.maximum(phi, -np.minimum(self.d_a, self.d_b)))
        missing = tetrahedra_volume(np.maximum(-phi, np.maximum(self.d_a, self.d_b)))
        return float(beyond + missing) * cell

    def topology(self, s: float) -> tuple[int, int]:
        """Return the number of separate parts and the Euler number of the frame at share s."""
        mesh = quick_surface(self.path, s)
        return solid_parts(mesh), mesh.euler


def leg_between(
    start: Samples, end: Samples, *, mode: Mode, origin: Floats, leg: int, eps: float,
    seeds: bool | Sequence[ArrayLike] = False, progress: Progress | None = None,
) -> Leg:  # fmt: skip
    """Return the way between two bodies on one lattice.

    Raises
    ------
    MorphError
        If the bodies do not touch and the mode needs it.
    """
    unreached, alone = isolated_parts(end, start.inside, "unreached", origin, leg)
    vanishing, _ = isolated_parts(start, end.inside, "vanishing", origin, leg)
    lattice = start.lattice
    places = _seed_places(seeds, unreached, origin)
    if len(places):
        radius = SEED * lattice.spacing
        seeded, _ = with_seeds(start, np.full(lattice.shape, np.inf), places, radius)
        unreached, alone = isolated_parts(end, seeded.inside, "unreached", origin, leg)
    target = end if mode == "blend" else without_parts(end, alone)
    if not target.inside.any():
        raise MorphError(
            message(
                "morphing.nothing-reached",
                "No part of the later body touches the earlier one, so no front reaches it. Give seeds=True, the mode "
                "'blend', or align='principal' if the bodies have different coordinates.",
            )
        )
    d_a, d_b = (front_distances if mode == "arrival" else both_distances)(start, target)
    first = d_a
    if len(places):
        _, first = with_seeds(start, d_a, places, SEED * lattice.spacing)
    path: Path
    if mode == "pde":
        path = level_set_path(first, d_b, lattice, eps, progress)
    elif mode == "blend":
        path = Line(lattice, first.astype(np.float32), d_b.astype(np.float32))
    else:
        source = source_field(arrival(first, d_b, lattice.spacing), first, d_b, lattice.spacing)
        if not (np.abs(source) < np.finfo(np.float32).max).all():
            raise MorphError(
                message(
                    "morphing.front-unbounded",
                    "No front leads from body {earlier} to body {later}: parts of a mesh overlap or are inside out. "
                    "Repair the meshes.",
                    earlier=leg + 1,
                    later=leg + 2,
                )
            )
        path = Line(lattice, source.astype(np.float32), d_b.astype(np.float32))
    return Leg(path, d_a, d_b, start, end, unreached, vanishing)


def _seed_places(seeds: bool | Sequence[ArrayLike], unreached: Sequence[LonePart], origin: Floats) -> Floats:
    if isinstance(seeds, bool):
        return np.array([part.deepest for part in unreached if seeds]).reshape(-1, 3) - origin
    return measurable_places(cast(ArrayLike, seeds), "seeds") - origin
