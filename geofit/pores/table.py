"""Figures of a rock before and after its pore space is rebuilt: table 1 of Huang et al. (2007) and more."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geofit.data.given import arguments_checked
from geofit.data.progress import Progress, tell
from geofit.pores.components import Connectivity, connectivity
from geofit.pores.crofton import surface_area
from geofit.pores.extraction import pore_network
from geofit.pores.kozeny import CARMAN, grain_diameter, kozeny_permeability
from geofit.pores.laplace import laplace_permeability
from geofit.pores.network import PoreNetwork
from geofit.pores.permeability import Permeability, network_permeability
from geofit.pores.surface import PoreSurface
from geofit.pores.volume import RockVolume

__all__ = ["BeforeAfter", "PoreFigures", "before_after"]


@dataclass(frozen=True)
class PoreFigures:
    """Figures of one pore space.

    Attributes
    ----------
    connectivity : Connectivity
        Porosities, percolation, parts and Euler number.
    specific_surface : float
        Area of the pore walls per volume of rock, 1/m (Crofton's formula, 13 directions).
    grain_diameter : float
        d_p = 6 (1 - phi) / S, metres.
    kozeny : float
        Kozeny's permeability, square metres: an upper bound, since it ignores how pores are connected.
    network, laplace : Permeability or None
        Along the three axes; None where it was not asked for, or all voxels are pore.
    """

    connectivity: Connectivity
    specific_surface: float
    grain_diameter: float
    kozeny: float
    network: Permeability | None
    laplace: Permeability | None


@dataclass(frozen=True)
class BeforeAfter:
    """Figures of the voxels as given, and of the rebuilt body.

    Attributes
    ----------
    before, after : PoreFigures
        ``after`` counts the voxels whose middle lies in the body.
    triangles : float
        Porosity by the volume within the triangles of the body, which its files have.
    dropped : float
        Porosity of the pores that no face of the sample reaches, which the network leaves out.
    smoothing : float
        Change of porosity by the smooth surface, ``after`` less what the network has: a share of the sample.
    kozeny_ratio : float
        K after / K before with the grain diameter held, as in the article: phi^3 / (1 - phi)^2 alone.
    """

    before: PoreFigures
    after: PoreFigures
    triangles: float
    dropped: float
    smoothing: float
    kozeny_ratio: float


@arguments_checked
def before_after(
    volume: RockVolume,
    network: PoreNetwork,
    body: PoreSurface,
    *,
    laplace: bool = False,
    progress: Progress | None = None,
) -> BeforeAfter:
    """Return the figures of a volume and of the body that was made from it.

    Parameters
    ----------
    volume : RockVolume
    network : PoreNetwork
        Of the volume.
    body : PoreSurface
        Of the network. It is sampled at the middles of the voxels.
    laplace : bool
        Solve for the Laplace permeability too, which takes longer than all the rest.
    progress : callable, optional
    """
    tell(progress, "before", 0.0)
    before = _figures(volume, network, laplace)
    tell(progress, "after", 0.5)
    rebuilt = RockVolume(body.voxels(), pore=[True], voxel=volume.voxel)
    settings = network.settings
    after = _figures(
        rebuilt, pore_network(rebuilt, r_min=settings["r_min"], tau=settings["tau"], border=settings["border"]), laplace
    )
    held = network.porosity
    return BeforeAfter(
        before,
        after,
        body.porosity,
        volume.porosity - held,
        rebuilt.porosity - held,
        kozeny_permeability(after.connectivity.connected, 1.0) / kozeny_permeability(before.connectivity.connected, 1.0)
        if before.connectivity.connected > 0
        else float("nan"),
    )


def _figures(volume: RockVolume, network: PoreNetwork, laplace: bool) -> PoreFigures:
    found = connectivity(volume)
    size = float(np.prod(volume.size))
    specific = surface_area(volume.pore, volume.edges) * volume.unit**2 / size
    phi = volume.porosity
    grain = grain_diameter(phi, specific) if specific > 0 else float("inf")
    return PoreFigures(
        found,
        specific,
        grain,
        kozeny_permeability(found.connected, grain, CARMAN) if phi < 1 and specific > 0 else float("inf"),
        network_permeability(network) if phi < 1 else None,
        laplace_permeability(volume) if laplace and phi < 1 else None,
    )
