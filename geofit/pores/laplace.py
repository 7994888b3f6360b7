"""Permeability by one Laplace solve an axis: div(w grad p) = 0 with the local mobility w of each pore voxel.

w = c (2 R d - d^2), where d is the distance to the wall and R half the width of the passage. c = 1/4 makes a tube exact
(mean R^2 / 8), c = 1/2 a slit (mean H^2 / 12 of a slit H wide); between them c follows the flatness of the passage.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import Message, message
from geofit.data.progress import Progress, tell
from geofit.pores.balls import balls_of_distance
from geofit.pores.components import connectivity
from geofit.pores.distance import Border, squared_distance
from geofit.pores.network import AXES
from geofit.pores.permeability import Permeability
from geofit.pores.volume import RockVolume, VolumeError

__all__ = ["laplace_permeability", "mobility"]

#: Largest relative error of the flow.
_TOLERANCE = 1e-3
#: From the centre of the nearest rock voxel back to the wall: half a voxel at a flat wall. At a round one the nearest
#: of many rock voxels lies just behind the wall; a narrow passage has few, and its wall is that of their faces. Half
#: widths and what belongs to them, from the flow in ducts with the section of voxel discs of radius 1.2 to 12.
_FLAT_WALL = 0.5
_ROUND_WALL = ((2.0, 6.8), (0.5, 0.3))


def mobility(volume: RockVolume) -> NDArray[np.float64]:
    """Return w of each voxel in units of the shortest voxel edge squared; 0 in rock.

    Returns
    -------
    ndarray of float, shape of the volume
    """
    from geofit.pores.ball_painting import paint_widest
    from geofit.pores.contacts import passages

    border: Border = "closed" if volume.pore.all() else "open"
    reach2 = squared_distance(volume.pore, border, volume.edges)
    balls = balls_of_distance(reach2, "exact" if volume.cubic else "cover", volume.edges)
    widest = np.full(volume.shape, -1, np.int32)
    paint_widest(balls.centre, balls.reach2.astype(np.float64), np.square(volume.edges), widest)
    half, flatness = passages(balls, volume.pore)
    inside = volume.pore
    ball = widest[inside]
    round_wall = np.interp(half, *_ROUND_WALL)
    back = (round_wall + (_FLAT_WALL - round_wall) * flatness)[ball]
    d = np.sqrt(reach2[inside].astype(np.float64)) - back
    width = np.maximum(half[ball] - back, d)
    out = np.zeros(volume.shape)
    # The mean of d^2 over a voxel exceeds that in its middle by 1/12 for each direction in which d changes.
    out[inside] = 0.25 * (1.0 + flatness[ball]) * np.maximum(2.0 * width * d - d * d - 1.0 / 12.0, 0.5 * d * d)
    return out


def laplace_permeability(volume: RockVolume, *, progress: Progress | None = None) -> Permeability:
    """Return the permeability along each axis from a Laplace solve on the voxels.

    Between a network and Stokes' equations in cost and trust: exact for straight tubes and slits. The lateral faces are
    closed.

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
        If the iteration does not converge.
    """
    from scipy import ndimage

    from geofit.pores.laplace_loops import assemble
    from geofit.pores.laplace_solve import conjugate_gradients, pieces_in_blocks

    paths = connectivity(volume).percolates
    label: NDArray[np.int32] = np.asarray(ndimage.label(volume.pore)[0])
    weights = mobility(volume)
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
        order = np.flatnonzero(inside)
        number = np.full(volume.shape, -1, np.int32)
        number.ravel()[order] = np.arange(len(order))
        links, diagonal, source = assemble(weights, number, order, axis, edges)
        start = 1.0 - (np.unravel_index(order, volume.shape)[axis] + 0.5) / volume.shape[axis]
        piece = pieces_in_blocks(links[0], order, volume.shape)
        flow, steps = conjugate_gradients(links, diagonal, source[0], piece, start, _TOLERANCE, 5000)
        if steps < 0:
            raise VolumeError(
                message(
                    "pores.laplace-not-converged",
                    "The Laplace solve along {axis} did not converge in 5000 steps.",
                    axis=AXES[axis],
                )
            )
        values.append(float(flow * lengths[axis] ** 2 / lengths.prod() * volume.unit**2))
    return Permeability((values[0], values[1], values[2]), tuple(messages))
