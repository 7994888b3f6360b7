"""Permeability of a pore network: conduits of half a pore, a throat and half a pore, and one linear solve an axis."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geofit.data.given import arguments_checked
from geofit.data.messages import Message, message
from geofit.pores.network import AXES, FaceThroats, PoreNetwork, Throats

__all__ = ["MILLIDARCY", "Permeability", "network_permeability"]

#: One millidarcy in square metres.
MILLIDARCY = 9.869233e-16

#: Pores from which on pressures are found by conjugate gradients, to this share of the inflow.
MANY = 20_000
_RESIDUAL = 1e-10

#: Part of the way from a pore's centre to the middle of its throat that is as narrow as the throat, where both have the
#: same radius; Dong & Blunt (2009) take 0.6. Settled on sphere packs and sandstone.
_THROAT_SHARE = 0.66
#: Least cosine between a face of the sample and the flow through it that is believed.
_SLANT = 0.3
#: Share of the flow that single pores from face to face may carry without a warning.
_MOST = 0.5


@dataclass(frozen=True)
class Permeability:
    """Permeability along the three axes of the array.

    Attributes
    ----------
    square_metres : tuple of three float
        0 along an axis whose two faces are not connected.
    messages : tuple of Message
        One for each axis without flow, with the reason; a warning for each axis along which most of the flow passes
        through pores that touch both faces.
    """

    square_metres: tuple[float, float, float]
    messages: tuple[Message, ...]

    @property
    def millidarcy(self) -> tuple[float, float, float]:
        """The same in millidarcy."""
        k0, k1, k2 = (k / MILLIDARCY for k in self.square_metres)
        return k0, k1, k2


@arguments_checked
def network_permeability(network: PoreNetwork) -> Permeability:
    """Return the permeability of a network along each axis.

    Each conduit is a series of half a pore, a throat and half a pore. A throat conducts like a straight duct with its
    section; half a pore like a duct of the same shape, widened to the pore's radius. Lateral faces are closed. A pore
    that touches both faces is thus a straight duct between them: right for a tube, but not where the pores of a wide
    pore space were merged into one. :func:`geofit.pores.laplace_permeability` needs no network.

    Parameters
    ----------
    network : PoreNetwork

    Returns
    -------
    Permeability
        An axis along which the pore space is not connected has permeability 0 and a message; it is not an error.

    Raises
    ------
    VolumeError
        If all voxels are pore: nothing bounds the flow.
    """
    from geofit.pores.surface import require_rock

    require_rock(network)
    edges = network.edges
    conduits, inlets = _conduits(network), _face_conduits(network)
    lengths = np.array(network.shape) * edges
    values: list[float] = []
    messages: list[Message] = []
    for axis in range(3):
        if not network.percolates[axis]:
            values.append(0.0)
            messages.append(_no_flow(network, axis))
            continue
        flow, share = _flow(network, conduits, inlets, axis)
        if share > _MOST:
            messages.append(_through_single_pores(axis, share))
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


def _through_single_pores(axis: int, share: float) -> Message:
    return message(
        "pores.flow-through-single-pores",
        "{share:.0%} of the flow along {axis} passes through pores that touch both faces. The network takes them for "
        "straight ducts; where they are not, its permeability may be several times too high or too low. Check it by "
        "solving for the flow in the voxels (laplace_permeability of the library).",
        share=share,
        axis=AXES[axis],
    ).with_severity("warning")


def _conduits(network: PoreNetwork) -> NDArray[np.float64]:
    """Return the flow between two pores under unit pressure difference and viscosity, for each throat."""
    throats = network.throats
    length = sum(throats.length[:, end] * _narrow_share(network, throats, throats.pores[:, end]) for end in range(2))
    conduits: NDArray[np.float64] = throats.conductance / length
    return conduits


def _face_conduits(network: PoreNetwork) -> NDArray[np.float64]:
    """Return the same between a pore and a face of the sample, for each face throat.

    A face cuts a tube at a slant: its section there is an ellipse, and the tube's a circle. Slant and length are those
    of the way from the centre of the pore, which is known to half a voxel: less than that is not aside. Otherwise a
    tube of a single slice would be longer than its slice.
    """
    throats, edges = network.face_throats, network.edges
    gap = np.abs((throats.middle - network.pores.centre[throats.pore]) * edges)
    normal = throats.face[:, None] // 2 == np.arange(3)
    aside = np.where(normal, 0.0, np.maximum(gap - 0.5 * edges, 0.0))
    straight = np.where(normal, gap, 0.0).sum(axis=1)
    length = np.hypot(straight, np.linalg.norm(aside, axis=1))
    cosine = np.clip(straight / np.maximum(length, 1e-12), _SLANT, 1.0)
    conductance = throats.conductance * cosine * (1.0 + cosine**2) / 2.0
    conduits: NDArray[np.float64] = conductance / (length * _narrow_share(network, throats, throats.pore))
    return conduits


def _narrow_share(network: PoreNetwork, throats: Throats | FaceThroats, pore: NDArray[np.int32]) -> NDArray[np.float64]:
    """Return the length of the duct as narrow as a throat that resists like the way from the throat into a pore."""
    pores = network.pores
    share = _THROAT_SHARE * np.minimum(throats.radius / pores.radius[pore], 1.0)
    # Around a pore two voxels wide, the centres of rock voxels leave gaps into which a ball can grow: its true limit is
    # the faces of the voxels, half a voxel from its centre voxel's ball.
    most = np.where(pores.radius <= 0.5, pores.radius + 0.5, np.inf)
    widening = np.maximum(np.minimum(pores.inscribed, most)[pore] / throats.inscribed, 1.0)
    return np.asarray(share + (1.0 - share) / widening**4)


def _flow(
    network: PoreNetwork, conduits: NDArray[np.float64], inlets: NDArray[np.float64], axis: int
) -> tuple[float, float]:
    """Return the flow under unit pressure difference between the faces of an axis, and the share of single pores."""
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
    flow = float((inlets[leaving] * pressure[number[pore[leaving]]]).sum())
    # What enters a pore through one face and leaves it through the other meets no throat.
    into = source - np.bincount(k, weights=h * low[ends] * pressure[k], minlength=size)
    out = np.bincount(k, weights=h * high[ends] * pressure[k], minlength=size)
    return flow, float(np.minimum(into, out).sum() / flow) if flow > 0 else 0.0


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
