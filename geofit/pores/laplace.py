"""Permeability from one Laplace solve an axis and the work of viscosity in the flow that it gives.

1. -laplace u = 1 in the pores, u = 0 at the rock: in a straight passage of any section, u is the velocity under unit
   gradient.
2. div(u grad p) = 0 between two faces of the sample. The flow v = -u grad p loses nothing and rests at the rock.
3. Of all such flows, Stokes' does the least work against viscosity (Helmholtz's minimum dissipation theorem). So
   K = (mean v)^2 / mean(-v laplace v) is the permeability from below, and its error is of second order in that of v.

Straight passages are exact. Step 2 alone overrates narrow places between chambers by a fifth: it does not know what is
lost where a flow closes and opens.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geofit.data.given import arguments_checked
from geofit.data.messages import Message, message
from geofit.data.progress import Progress, tell
from geofit.pores.components import connectivity
from geofit.pores.network import AXES
from geofit.pores.permeability import Permeability
from geofit.pores.volume import RockVolume, VolumeError

__all__ = ["laplace_permeability", "mobility"]

#: Largest relative error of the flow, and of u. Errors of both enter the permeability squared.
_TOLERANCE = 1e-3
_SWEEPS, _STEPS = 20000, 5000


def mobility(volume: RockVolume) -> tuple[NDArray[np.float64], NDArray[np.float32]]:
    """Return u of each pore voxel, and the distances of its walls.

    Returns
    -------
    u : ndarray, shape (n,)
        In the order of the array, in units of the shortest voxel edge squared.
    wall : ndarray, shape (n, 6)
        In voxels; see :func:`geofit.pores.viscous.profile`.

    Raises
    ------
    VolumeError
        If the iteration does not converge.
    """
    from geofit.pores.viscous import profile

    number, order = _numbered(volume.pore)
    u, wall, sweeps = profile(number, order, np.array(volume.edges), _TOLERANCE, _SWEEPS)
    if sweeps < 0:
        raise VolumeError(
            message(
                "pores.profile-not-converged",
                "The profile of the flow did not converge in {count} steps.",
                count=_SWEEPS,
            )
        )
    return u, wall


def _numbered(inside: NDArray[np.bool_]) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
    """Return the row of each voxel, -1 outside, and the flat index of each row."""
    order = np.flatnonzero(inside)
    number = np.full(inside.shape, -1, np.int32)
    number.ravel()[order] = np.arange(len(order))
    return number, order


@arguments_checked
def laplace_permeability(volume: RockVolume, *, progress: Progress | None = None) -> Permeability:
    """Return the permeability along each axis from a Laplace solve on the voxels and the work of viscosity.

    Between a network and Stokes' equations in cost and trust: exact for straight passages, and else a few per cent low.
    The lateral faces are closed.

    Parameters
    ----------
    volume : RockVolume
    progress : callable, optional

    Returns
    -------
    Permeability
        0 with a message along an axis whose faces are not connected.

    Raises
    ------
    VolumeError
        If all voxels are pore, as nothing bounds the flow, or an iteration does not converge.
    """
    from scipy import ndimage

    from geofit.pores.laplace_loops import assemble
    from geofit.pores.laplace_solve import conjugate_gradients, pieces_in_blocks
    from geofit.pores.surface import require_rock
    from geofit.pores.viscous import LAYERS, work_and_flow

    require_rock(volume)
    # A single slice goes on beyond its faces as it is; the mirrored layers there need a second one.
    if 1 in volume.shape:
        pore = np.tile(volume.pore, [LAYERS if n == 1 else 1 for n in volume.shape])
        volume = RockVolume(pore, pore=True, voxel=volume.voxel)
    paths = connectivity(volume).percolates
    label: NDArray[np.int32] = np.asarray(ndimage.label(volume.pore)[0])
    profile, wall = mobility(volume)
    edges = np.array(volume.edges)
    lengths = np.array(volume.shape) * edges
    values: list[float] = []
    messages: list[Message] = []
    for axis in range(3):
        tell(progress, "permeability", axis / 3)
        if not paths[axis]:
            values.append(0.0)
            messages.append(
                message(
                    "pores.laplace-faces-not-connected",
                    "The pore space does not connect the two faces of {axis} (porosity {porosity:.4f}): its "
                    "permeability is 0.",
                    axis=AXES[axis],
                    porosity=volume.porosity,
                )
            )
            continue
        low, high = np.asarray(label.take(0, axis=axis)), np.asarray(label.take(-1, axis=axis))
        through = np.intersect1d(low[low > 0], high[high > 0])
        inside = np.isin(label, through)
        number, order = _numbered(inside)
        carrying = inside[volume.pore]
        weights = profile[carrying]
        links, diagonal, source = assemble(weights, number, order, axis, edges)
        start = 1.0 - (np.unravel_index(order, volume.shape)[axis] + 0.5) / volume.shape[axis]
        piece = pieces_in_blocks(links[0], order, volume.shape)
        pressure, _, steps = conjugate_gradients(links, diagonal, source[0], piece, start, _TOLERANCE, _STEPS)
        if steps < 0:
            raise VolumeError(
                message(
                    "pores.laplace-not-converged",
                    "The Laplace solve along {axis} did not converge in 5000 steps.",
                    axis=AXES[axis],
                )
            )
        layers = [(LAYERS * (d == axis),) * 2 for d in range(3)]
        number = np.pad(number, layers, mode="symmetric")
        work, flow = work_and_flow(number, wall[carrying], weights, pressure, axis, edges)
        values.append(float(flow**2 / work / lengths.prod() * volume.unit**2))
    return Permeability((values[0], values[1], values[2]), tuple(messages))
