"""Radial potentials of metaballs, as functions of q = (r/R)^2.

Each falls from 1 at the centre to 0 at the effective radius R; Blinn's never gets there and is cut off.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import message

__all__ = ["POTENTIALS", "Potential", "potential"]

Floats = NDArray[np.float64]

#: Blinn's potential counts as zero below this part of the iso value.
CUT = 1e-6


@arguments_checked
@dataclass(frozen=True)
class Potential:
    """A radial potential f(q), q = (r/R)^2.

    Parameters
    ----------
    name : str
        "smooth", "wyvill", "murakami", "nishimura" or "blinn".
    code : int
        Its number in the compiled loops.
    integral : float
        Integral over space for R = 1.
    """

    name: str
    code: int
    integral: float

    def value(self, q: ArrayLike) -> Floats:
        """Return f at (r/R)^2."""
        q = np.asarray(q, float)
        s = np.sqrt(q)
        inside = q < 1
        match self.name:
            case "smooth":
                f = (1 - q) ** 3
            case "wyvill":
                f = 1 + q * (-22 / 9 + q * (17 / 9 - q * 4 / 9))
            case "murakami":
                f = (1 - q) ** 2
            case "nishimura":
                f = np.where(q <= 1 / 9, 1 - 3 * q, 1.5 * (1 - s) ** 2)
            case _:
                f, inside = np.exp(-q), np.ones_like(inside)
        return np.asarray(np.where(inside, f, 0.0))

    def slope(self, q: ArrayLike) -> Floats:
        """Return df/dq; the derivative along r is that times 2 r / R^2."""
        q = np.asarray(q, float)
        inside = q < 1
        match self.name:
            case "smooth":
                f = -3 * (1 - q) ** 2
            case "wyvill":
                f = -22 / 9 + q * (34 / 9 - q * 12 / 9)
            case "murakami":
                f = -2 * (1 - q)
            case "nishimura":
                s = np.sqrt(np.maximum(q, 1 / 9))
                f = np.where(q <= 1 / 9, -3.0, -1.5 * (1 - s) / s)
            case _:
                f, inside = -np.exp(-q), np.ones_like(inside)
        return np.asarray(np.where(inside, f, 0.0))

    def bend(self, q: ArrayLike) -> Floats:
        """Return d2f/dq2, from inside where it jumps."""
        q = np.asarray(q, float)
        inside = q <= 1
        match self.name:
            case "smooth":
                f = 6 * (1 - q)
            case "wyvill":
                f = 34 / 9 - q * 24 / 9
            case "murakami":
                f = np.full_like(q, 2.0)
            case "nishimura":
                s = np.sqrt(np.maximum(q, 1 / 9))
                f = np.where(q <= 1 / 9, 0.0, 0.75 / s**3)
            case _:
                f, inside = np.exp(-q), np.ones_like(inside)
        return np.asarray(np.where(inside, f, 0.0))

    def support(self, ratio: float) -> float:
        """Return r/R beyond which the potential counts as zero, for a threshold over density of ``ratio``."""
        return math.sqrt(max(-math.log(CUT * ratio), 0.0)) if self.name == "blinn" else 1.0

    def iso_radius(self, ratio: float) -> float:
        """Return r/R at which a lone ball has the value ``ratio``, threshold over density.

        Raises
        ------
        SettingsError
            If the ratio is not between 0 and 1: such a ball has no surface.
        """
        if not 0 < ratio < 1:
            raise SettingsError(
                message(
                    "implicit.ball-without-surface",
                    "a ball with threshold/density {ratio} has no surface: give a ratio between 0 and 1",
                    ratio=ratio,
                )
            )
        match self.name:
            case "smooth":
                return math.sqrt(1 - ratio ** (1 / 3))
            case "murakami":
                return math.sqrt(1 - math.sqrt(ratio))
            case "nishimura":
                return math.sqrt((1 - ratio) / 3) if ratio >= 2 / 3 else 1 - math.sqrt(ratio / 1.5)
            case "wyvill":
                roots = np.roots([-4 / 9, 17 / 9, -22 / 9, 1 - ratio])
                q = float(min(r.real for r in roots if abs(r.imag) < 1e-9 and r.real > 0))
                for _ in range(3):
                    q -= float((self.value(q) - ratio) / self.slope(q))
                return math.sqrt(q)
            case _:
                return math.sqrt(-math.log(ratio))

    @property
    def steepest(self) -> float:
        """Largest |df/dr| for R = 1."""
        # Where d/dq of q f'^2 vanishes: the derivative along r is 2 sqrt(q) f'.
        q = {"smooth": 0.2, "murakami": 1 / 3, "nishimura": 1 / 9, "blinn": 0.5}.get(self.name)
        if q is None:
            q = float(min(r.real for r in np.roots([-60 / 9, 102 / 9, -22 / 9]) if r.real > 0))
        return 2 * math.sqrt(q) * abs(float(self.slope(q)))


#: Integrals: Blinn pi^(3/2), Nishimura 16 pi/81, Murakami 32 pi/105, Wyvill 736 pi/2835, smooth 64 pi/315.
POTENTIALS = {
    p.name: p
    for p in (
        Potential("smooth", 0, 64 * math.pi / 315),
        Potential("wyvill", 1, 736 * math.pi / 2835),
        Potential("murakami", 2, 32 * math.pi / 105),
        Potential("nishimura", 3, 16 * math.pi / 81),
        Potential("blinn", 4, math.pi**1.5),
    )
}


@arguments_checked
def potential(name: str) -> Potential:
    """Return a potential by name: "smooth" is (1-q)^3, which is C2 at its rim.

    Raises
    ------
    SettingsError
        If there is none of that name.
    """
    if name not in POTENTIALS:
        raise SettingsError(
            message(
                "implicit.potential-unknown",
                "there is no potential '{name}': choose one of {names}",
                name=name,
                names=", ".join(POTENTIALS),
            )
        )
    return POTENTIALS[name]
