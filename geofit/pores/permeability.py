"""Permeability of a pore network: conduits of half a pore, a throat and half a pore, and one linear solve an axis."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.messages import Message, message
from geofit.pores.network import AXES, PoreNetwork

__all__ = ["MILLIDARCY", "Permeability", "network_permeability"]

#: One millidarcy in square metres.
MILLIDARCY = 9.869233e-16

#: Pores from which on pressures are found by conjugate gradients, to this share of the inflow.
MANY = 20_000
_RESIDUAL = 1e-10

#: Dong & Blunt (2009): the part of the way from a pore's centre to the throat that belongs to the pore.
_PORE_SHARE = 0.6


@dataclass(frozen=True)
class Permeability:
    """Permeability along the three axes of the array.

    Attributes
    ----------
    square_metres : tuple of three float
        0 along an axis whose two faces are not connected.
    messages : tuple of Message
        One for each axis without flow, with the reason.
    """

    square_metres: tuple[float, float, float]
    messages: tuple[Message, ...]

    @property
    def millidarcy(self) -> tuple[float, float, float]:
        """The same in millidarcy."""
        k0, k1, k2 = (k / MILLIDARCY for k in self.square_metres)
        return k0, k1, k2


def network_permeability(network: PoreNetwork) -> Permeability:
    """Return the permeability of a network along each axis.

    Each conduit is a series of half a pore, a throat and half a pore. A throat conducts like a straight duct with its
    section; a pore like a tube of its radius, and at least like the widest of its throats. Lateral faces are closed.

    Parameters
    ----------
    network : PoreNetwork

    Returns
    -------
    Permeability
        An axis along which the pore space is not connected has permeability 0 and a message; it is not an error.
    """
    edges = network.edges
    lengths = np.array(network.shape) * edges
    values: list[float] = []
    messages: list[Message] = []
    for axis in range(3):
        if not network.percolates[axis]:
            values.append(0.0)
            messages.append(_no_flow(network, axis))
            continue
        section = _pore_conductance(network, axis)
        flow = _flow(network, _conduits(network, section), _face_conduits(network, section), axis)
        values.append(float(flow * lengths[axis] ** 2 / lengths.prod() * network.unit**2))
    return Permeability((values[0], values[1], values[2]), tuple(messages))


def _no_flow(network: PoreNetwork, axis: int) -> Message:
    return message(
        "pores.faces-not-connected",
        "The pore space does not connect the two faces of {axis} (porosity {porosity:.4f}): its permeability is 0. A "
        "larger sample or a finer scan may show a path.",
        axis=AXES[axis],
        porosity=network.porosity,
    )


def _pore_conductance(network: PoreNetwork, axis: int) -> NDArray[np.float64]:
    """Return the conductance of a straight duct with the section of each pore, for flow along an axis."""
    pores = network.pores
    # Around a pore two voxels wide, the centres of rock voxels leave gaps into which a ball can grow: its true limit is
    # the faces of the voxels, half a voxel from its centre voxel's ball.
    narrow = pores.radius <= 0.5
    best = np.pi / 8.0 * np.where(narrow, np.minimum(pores.inscribed, pores.radius + 0.5), pores.inscribed) ** 4
    np.maximum.at(best, network.throats.pores.ravel(), np.repeat(network.throats.conductance, 2))
    ends = network.face_throats
    use = ends.face // 2 == axis
    np.maximum.at(best, ends.pore[use], ends.conductance[use])
    return best


def _conduits(network: PoreNetwork, section: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the flow between two pores under unit pressure difference and viscosity, for each throat."""
    throats, pores = network.throats, network.pores
    resistance = np.zeros(len(throats))
    narrow = np.zeros(len(throats))
    for end in range(2):
        pore = throats.pores[:, end]
        share = 1.0 - _PORE_SHARE * np.minimum(throats.radius / pores.radius[pore], 1.0)
        resistance += throats.length[:, end] * share / section[pore]
        narrow += throats.length[:, end] * (1.0 - share)
    with np.errstate(divide="ignore"):  # a throat too small for a section does not conduct: one over infinity
        conduits: NDArray[np.float64] = 1.0 / (resistance + narrow / throats.conductance)
    return conduits


def _face_conduits(network: PoreNetwork, section: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the same between a pore and a face of the sample, for each face throat."""
    throats = network.face_throats
    share = 1.0 - _PORE_SHARE * np.minimum(throats.radius / network.pores.radius[throats.pore], 1.0)
    conduits: NDArray[np.float64] = 1.0 / (
        throats.length * (share / section[throats.pore] + (1.0 - share) / throats.conductance)
    )
    return conduits


def _flow(network: PoreNetwork, conduits: NDArray[np.float64], inlets: NDArray[np.float64], axis: int) -> float:
    """Return the flow through the sample under unit pressure difference between the faces of an axis."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    count = len(network.pores)
    first, second = network.throats.pores.T
    face, pore = network.face_throats.face, network.face_throats.pore
    low, high = face == 2 * axis, face == 2 * axis + 1
    links = coo_array((np.ones(len(first)), (first, second)), shape=(count, count))
    _, part = connected_components(links, directed=False)
    through = np.intersect1d(part[pore[low]], part[pore[high]])
    active = np.isin(part, through)
    number = np.cumsum(active) - 1
    use = active[first]
    i, j, g = number[first[use]], number[second[use]], conduits[use]
    ends = (low | high) & active[pore]
    k, h = number[pore[ends]], inlets[ends]
    size = int(active.sum())
    matrix = coo_array(
        (np.concatenate([g, g, -g, -g, h]), (np.concatenate([i, j, i, j, k]), np.concatenate([i, j, j, i, k]))),
        shape=(size, size),
    ).tocsc()
    source: NDArray[np.float64] = np.asarray(np.bincount(k, weights=h * low[ends], minlength=size), float)
    pressure = _pressure(matrix, source)
    leaving = high & active[pore]
    return float((inlets[leaving] * pressure[number[pore[leaving]]]).sum())


def _pressure(matrix: Any, source: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the pressures of the pores, directly for a few pores: factors of many fill up."""
    from scipy.sparse import diags_array
    from scipy.sparse.linalg import cg, spsolve

    if len(source) > MANY:
        scaled = diags_array(1.0 / matrix.diagonal())
        pressure, steps = cg(matrix, source, rtol=_RESIDUAL, maxiter=10 * len(source), M=scaled)
        if steps == 0:
            return np.asarray(pressure)
    return np.asarray(spsolve(matrix, source, permc_spec="MMD_AT_PLUS_A"))
