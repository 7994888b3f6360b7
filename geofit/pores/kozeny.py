"""Kozeny's permeability, K = G phi^3 d_p^2 / (1 - phi)^2, as in table 1 of Huang et al. (2007) after Bear (1972)."""

from __future__ import annotations

from geofit.data.given import arguments_checked
from geofit.data.messages import message
from geofit.pores.volume import VolumeError

__all__ = ["CARMAN", "grain_diameter", "kozeny_permeability", "kozeny_ratio"]

#: Carman's value of the constant G, that of beds of spheres.
CARMAN = 1.0 / 180.0


@arguments_checked
def kozeny_permeability(porosity: float, diameter: float, constant: float = CARMAN) -> float:
    """Return K in square metres.

    It knows nothing of how pores are connected: for rock it is an upper bound in practice, not an estimate.

    Parameters
    ----------
    porosity : float
        phi, effective.
    diameter : float
        d_p, the diameter of the grains in metres.
    constant : float
        G.

    Examples
    --------
    >>> f"{kozeny_permeability(0.178, 40.2e-6):.3g}"
    '7.49e-14'
    """
    if not 0 <= porosity < 1:
        raise VolumeError(
            message(
                "pores.porosity-not-below-one",
                "A porosity of {porosity} has no Kozeny permeability; it must be below 1.",
                porosity=porosity,
            )
        )
    return constant * porosity**3 * diameter**2 / (1.0 - porosity) ** 2


@arguments_checked
def kozeny_ratio(before: float, after: float) -> float:
    """Return K after / K before for two porosities with the same grains; that before must be above 0.

    Examples
    --------
    >>> round(0.075 * kozeny_ratio(0.178, 0.171), 4)
    0.0654
    """
    first = kozeny_permeability(before, 1.0)
    if first == 0:
        raise VolumeError(
            message("pores.no-porosity-before", "The porosity before is 0: no ratio to it exists. Give one above 0.")
        )
    return kozeny_permeability(after, 1.0) / first


def grain_diameter(porosity: float, specific_surface: float) -> float:
    """Return d_p = 6 (1 - phi) / S in metres, S being the area of the pore walls per volume of rock, 1/m."""
    return 6.0 * (1.0 - porosity) / specific_surface
