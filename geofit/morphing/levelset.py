"""The level-set equation from A to B, after Pan & Xu, completed: transport, curvature, path correction."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geofit.data.errors import FitError
from geofit.data.messages import message
from geofit.implicit.grid import spline_grid
from geofit.implicit.lattice import Lattice

__all__ = ["Step", "evolve"]

Floats = NDArray[np.float64]

#: Half-widths of the band that moves and of the band that has exact distances, in spacings.
MOVING, KNOWN = 5.0, 6.5
#: The front moves this part of a spacing a step at most, in at most LONGEST of time.
CFL, LONGEST = 0.5, 0.3
#: Steps with curvature are shorter than this part of h^2 / eps: the spline's second derivative has symbol 12 / h^2.
STABLE = 1 / 18
#: Distances are renewed when the front has moved this far (in spacings), and after this many steps.
MOVED, STEPS_APART = 0.45, 3
#: A step may raise energy or symmetric difference by this part of B's volume (and its h); else it is halved.
RISE, HALVINGS = 1e-3, 4
MOST_STEPS = 400
#: The front has arrived when it is nearer to B than this part of a spacing.
ARRIVED = 0.03
#: Nearer than this, a step that raises energy or symmetric difference is rounding: the front rests.
RESTING = 0.25


@dataclass(frozen=True, eq=False)
class Step:
    """One step: time, field (nx, ny, nz) in metres, volume (m3), energy (m4), symmetric difference from B (m3)."""

    time: float
    phi: Floats
    volume: float
    energy: float
    different: float


def evolve(
    start: Floats,
    target: Floats,
    lattice: Lattice,
    *,
    eps: float = 0.0,
    until: float = np.inf,
    corridor: tuple[Floats, Floats] | None = None,
    speed: Floats | None = None,
    each: Callable[[Step], None] | None = None,
) -> Step:
    """Move a surface with the normal speed -(d_B + eps kappa) until it is at B.

    Parameters
    ----------
    start, target : (nx, ny, nz) array
        Signed distances from the first surface, and d_B, metres.
    lattice : Lattice
        The nodes.
    eps : float
        Weight of the area in the energy, m2; it falls to 0 over the last third of progress where there is no ``until``.
    until : float
        Time at which to end exactly.
    corridor : pair of (nx, ny, nz) arrays, optional
        Least and largest values of the field (path correction).
    speed : (nx, ny, nz) array, optional
        Used in place of d_B for the speed; then nothing but time ends the motion.
    each : callable
        Gets every step, the first (time 0) included.

    Returns
    -------
    Step
        The last one.

    Raises
    ------
    FitError
        If a step halved four times still raises the energy or the symmetric difference.

    Notes
    -----
    The energy of a body W is the integral of d_B over W plus eps times its area: gradient flow gives the speed. eps = 0
    is D. Breen & R. Whitaker, IEEE TVCG 7(2), 2001. WENO5 with Godunov's Hamiltonian (G.-S. Jiang & D. Peng, SIAM J.
    Sci. Comput. 21, 2000), two stages of SSP Runge-Kutta.
    """
    from geofit.morphing.distance import redistanced
    from geofit.morphing.levelset_loops import band_nodes, fastest_front

    h = lattice.spacing
    pace = np.ascontiguousarray(spline_grid((target if speed is None else speed) / h, lattice).coefficients)
    scaled = np.ascontiguousarray(target / h)
    phi = redistanced(start, lattice, KNOWN) / h
    nodes = band_nodes(phi, MOVING)
    limits = None if corridor is None else (corridor[0] / h, corridor[1] / h)
    unit = _Unit(h, scaled)
    state = unit.step(0.0, phi)
    first = state.different
    whole = float(np.clip(0.5 - scaled, 0, 1).sum()) * h**3
    if each is not None:
        each(state)
    moved, apart, time = 0.0, 0, 0.0
    steps = 0
    while steps < MOST_STEPS or np.isfinite(until):
        steps += 1
        fastest = fastest_front(phi, nodes, pace)
        progress = 1 - state.different / first if first > 0 else 1.0
        arrived = speed is None and fastest < ARRIVED
        if time >= until or (arrived and not np.isfinite(until)):
            break
        weight = eps / h**2 * (1.0 if np.isfinite(until) else min(1.0, 3 * (1 - progress)))
        dt = min(CFL / max(fastest, 1e-9), LONGEST, STABLE / weight if weight > 0 else np.inf, until - time)
        for halving in range(HALVINGS + 1):
            trial = _advance(phi, nodes, pace, weight, dt, lattice, limits)
            after = unit.step(time + dt, trial)
            energy_rises = weight == 0 and after.energy > state.energy + RISE * whole * h
            if speed is not None or not (energy_rises or after.different > state.different + RISE * whole):
                break
            if halving == HALVINGS:
                raise FitError(
                    message(
                        "morphing.step-rises",
                        "A step of the level-set metamorphosis moves away from the target although it was halved "
                        "{count} times. Use a smaller spacing, or the mode 'arrival'.",
                        count=HALVINGS,
                    )
                )
            dt /= 2
        phi, time = trial, time + dt
        moved, apart = moved + fastest * dt, apart + 1
        if moved >= MOVED or apart >= STEPS_APART:
            phi = redistanced(phi * h, lattice, KNOWN) / h
            if limits is not None:
                phi = np.clip(phi, *limits)
            nodes = band_nodes(phi, MOVING)
            moved, apart = 0.0, 0
            after = unit.step(time, phi)
        rises = after.energy > state.energy or after.different > state.different
        if rises and speed is None and not np.isfinite(until) and fastest < RESTING:
            break
        state = after
        if each is not None:
            each(state)
        if not (phi < 0).any():
            break
    return state


class _Unit:
    """Sums in metres from a field in spacings."""

    def __init__(self, h: float, target: Floats) -> None:
        self.h, self.target = h, target

    def step(self, time: float, phi: Floats) -> Step:
        from geofit.morphing.levelset_loops import sums

        volume, energy, different = sums(np.ascontiguousarray(phi), self.target)
        return Step(time, phi * self.h, volume * self.h**3, energy * self.h**4, different * self.h**3)


def _advance(
    phi: Floats, nodes: NDArray[np.int64], pace: Floats, eps: float, dt: float, lattice: Lattice,
    limits: tuple[Floats, Floats] | None,
) -> Floats:  # fmt: skip
    """Return the field after one step of two stages (Heun), held in its limits."""
    from geofit.morphing.levelset_loops import rates

    none = np.zeros((1, 1, 1))
    before = phi.ravel()[nodes]
    trial = phi.copy()
    for stage in range(2):
        spline = np.ascontiguousarray(spline_grid(trial, lattice).coefficients) if eps > 0 else none
        moved = trial.ravel()[nodes] + dt * rates(trial, nodes, pace, spline, eps)
        values = moved if stage == 0 else (before + moved) / 2
        if limits is not None:
            values = np.clip(values, limits[0].ravel()[nodes], limits[1].ravel()[nodes])
        trial.ravel()[nodes] = values
    return trial
