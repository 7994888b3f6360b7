"""The order of strata: how thick what lies between two horizons is, and where they cross."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from geofit.data.accuracy import Check
from geofit.data.errors import SettingsError
from geofit.data.given import arguments_checked
from geofit.data.messages import EMPTY, Message, message
from geofit.data.site import Ground
from geofit.fitting.horizon_fit import HorizonFit
from geofit.site.height_field import HeightField
from geofit.site.overlap import HorizonCrossing, Overlap
from geofit.surfaces.below_ground import below_ground

__all__ = ["Order", "compare_horizons", "compare_pairs", "orders", "require_sequence", "thickness"]

Floats = NDArray[np.float64]

#: Share of a layer's volume that another horizon may claim without a word: what lattices leave.
DISPUTED = 1e-3


@dataclass(frozen=True, eq=False)
class Order:
    """Two horizons: what lies between them over their common ``area`` (m2), and where they cross.

    ``min``, ``mean`` and ``max`` are thicknesses in metres, negative where the horizons cross; ``thinnest`` and
    ``thickest`` the (x, y) of the extremes; ``crossings`` the places of crossing, the largest volume first.

    ``volume`` (m3) is what lies between them where the upper one is above the lower one, and ``present`` (m2) the area
    where that is thicker than ``least`` metres, the larger control error of the two: a thinner layer cannot be told
    from none. Above the ground nothing is counted where a ground was given (``grounded``). ``disputed`` (m3) is how
    much of it another horizon of the order claims, which crosses the two.

    If holes met both horizons at one contact (``without``, their number), the layer is counted as present where the
    nearest hole has it, too; its area is then known to lie between ``at_least`` and ``at_most`` (m2), and ``doubtful``
    (m3) is the volume over triangles of such holes alone: there the surfaces differ, and no layer is known.
    """

    upper: str
    lower: str
    area: float
    min: float
    mean: float
    max: float
    thinnest: tuple[float, float]
    thickest: tuple[float, float]
    crossings: tuple[HorizonCrossing, ...]
    volume: float = float("nan")
    present: float = float("nan")
    least: float = 0.0
    grounded: bool = False
    disputed: float = 0.0
    at_least: float = float("nan")
    at_most: float = float("nan")
    without: int = 0
    doubtful: float = 0.0

    @property
    def layer(self) -> Message:
        """How much lies between the horizons, in words that go on a sentence; empty if it was not measured."""
        if not np.isfinite(self.volume):
            return EMPTY
        figures: dict[str, float | Message] = {
            "volume": self.volume, "present": self.present, "least": self.least, "disputed": EMPTY, "seen": EMPTY,
        }  # fmt: skip
        if self.without:
            figures["seen"] = message(
                "site.layer-area-by-holes",
                " (at least {low:whole}, at most {high:whole} m²: {count} holes lack it, and {volume:whole} m³ lie "
                "between such holes alone)",
                low=self.at_least,
                high=self.at_most,
                count=self.without,
                volume=self.doubtful,
            )
        if self.disputed > DISPUTED * self.volume:
            figures["disputed"] = message(
                "site.layer-disputed",
                "; {volume:whole} m³ of it lie above or below another horizon of the order, which crosses them",
                volume=self.disputed,
            )
        if self.grounded:
            return message(
                "site.layer-below-ground",
                "; between them, below the ground, {volume:whole} m³ over {present:whole} m²{seen} where it is thicker "
                "than {least:g} m{disputed}",
                **figures,
            )
        return message(
            "site.layer-between",
            "; between them {volume:whole} m³ over {present:whole} m²{seen} where it is thicker than {least:g} m"
            "{disputed}",
            **figures,
        )

    @property
    def crossed_area(self) -> float:
        """Area over which the order is turned round, m2."""
        return sum(crossing.area for crossing in self.crossings)

    @property
    def crossed_volume(self) -> float:
        """Volume between the horizons where the order is turned round, m3."""
        return sum(crossing.volume for crossing in self.crossings)

    def check(self) -> Check:
        """Return the check; it fails where horizons cross below the ground, and is None without common area."""
        names: dict[str, str | Message] = {"upper": self.upper, "lower": self.lower}
        if not self.area:
            return Check(
                "order",
                None,
                0.0,
                0.0,
                "m",
                message("site.horizons-share-no-area", "{upper} and {lower} share no area", **names),
            )
        names["layer"] = self.layer
        if not self.crossings:
            text = message(
                "site.upper-above-everywhere",
                "{upper} lies above {lower} everywhere: {low:.2f} to {high:.2f} m, {mean:.2f} m on average{layer}",
                low=self.min,
                high=self.max,
                mean=self.mean,
                **names,
            )
            return Check("order", True, 0.0, 0.0, "m", text)
        deepest = max(self.crossings, key=lambda crossing: crossing.depth)
        figures = {
            "count": len(self.crossings), "area": self.crossed_area, "volume": self.crossed_volume,
            "depth": deepest.depth, "x": deepest.x, "y": deepest.y, **names,
        }  # fmt: skip
        below = [crossing for crossing in self.crossings if not crossing.in_air >= 1.0]
        if not below:
            text = message(
                "site.horizons-cross-above-ground",
                "{upper} lies below {lower} above the ground only (places: {count}): {area:whole} m², {volume:whole} m³"
                "{layer}",
                **figures,
            )
            return Check("order", True, 0.0, 0.0, "m", text)
        text = message(
            "site.horizons-cross",
            "{upper} lies below {lower} (places: {count}): {area:whole} m², {volume:whole} m³, deepest {depth:.2f} m "
            "at ({x:.1f}, {y:.1f}){layer}",
            **figures,
        )
        return Check("order", False, max(crossing.depth for crossing in below), 0.0, "m", text)


@arguments_checked
def thickness(upper: HorizonFit, lower: HorizonFit, x: ArrayLike, y: ArrayLike, ground: Ground | None = None) -> Floats:
    """Return the vertical thickness between two horizons.

    Parameters
    ----------
    upper, lower : HorizonFit
        The horizons.
    x, y : (n,) array_like
        Map coordinates, metres; any shapes that broadcast.
    ground : Ground, optional
        The ground surface: only what lies below it counts.

    Returns
    -------
    (n,) array
        Upper minus lower elevation, metres: negative where they cross, nan where either is absent, 0 where both lie
        above the ground.

    Notes
    -----
    Of an overturned surface the highest limb counts, as in ``elevation``.
    """
    top, base = (below_ground(one.elevation(x, y), x, y, ground) for one in (upper, lower))
    return np.asarray(top - base)


def orders(
    surfaces: Mapping[str, HorizonFit], sequence: Sequence[str], ground: Ground | None = None
) -> tuple[Order, ...]:
    """Compare every two horizons of a sequence, neighbours and others.

    Parameters
    ----------
    surfaces : mapping of str to HorizonFit
        Surfaces by name; height fields over the map.
    sequence : sequence of str
        Names from the top to the bottom.
    ground : Ground, optional
        Tells crossings above the ground from those in the rock.

    Raises
    ------
    SettingsError
        If the sequence names a horizon twice, one without a surface, or one that is not a height field.
    """
    require_sequence(surfaces, sequence)
    reliefs = [HeightField(surfaces[name]) for name in sequence]
    return tuple(
        _compare(reliefs[i], reliefs[k], ground, reliefs[:i], reliefs[k + 1 :])
        for i, k in combinations(range(len(reliefs)), 2)
    )


def compare_pairs(
    surfaces: Mapping[str, HorizonFit],
    pairs: Sequence[tuple[str, str]],
    ground: Ground | None,
    heard: Callable[[float], None] = lambda _: None,
) -> tuple[Order, ...]:
    """Compare pairs of an order, the upper horizon first; what lies above or below both by the pairs is considered.

    Parameters
    ----------
    surfaces : mapping of str to HorizonFit
        Surfaces by name.
    pairs : sequence of tuple of str
        Every two names of the order that can be compared.
    ground : Ground or None
        As in :func:`compare_horizons`.
    heard : callable, optional
        Called before each pair with the share of pairs done.

    Raises
    ------
    SettingsError
        If a surface is not a height field over the map.
    """
    reliefs = {name: HeightField(surfaces[name]) for name in dict.fromkeys(name for pair in pairs for name in pair)}
    found = []
    for k, (upper, lower) in enumerate(pairs):
        heard(k / len(pairs))
        above = [reliefs[one] for one, other in pairs if other == upper and (one, lower) in pairs]
        below = [reliefs[other] for one, other in pairs if one == lower and (upper, other) in pairs]
        found.append(_compare(reliefs[upper], reliefs[lower], ground, above, below))
    return tuple(found)


@arguments_checked
def compare_horizons(upper: HorizonFit, lower: HorizonFit, ground: Ground | None = None) -> Order:
    """Measure the thickness between two horizons, and find where they cross.

    Parameters
    ----------
    upper, lower : HorizonFit
        Height fields over the map.
    ground : Ground, optional
        The ground surface: crossings above it are not counted as faults of the horizons, nor what lies between the
        horizons above it as volume.

    Returns
    -------
    Order
        Thicknesses (m), areas (m2), volumes (m3) and the crossings; ``check()`` is the verdict.

    Raises
    ------
    SettingsError
        If a surface is not a height field over the map.

    Notes
    -----
    Thickness is measured vertically, over the area that both horizons cover.
    """
    return _compare(HeightField(upper), HeightField(lower), ground)


def require_sequence(surfaces: Mapping[str, HorizonFit], sequence: Sequence[str]) -> None:
    """Raise SettingsError unless each name of a sequence has a surface and stands once."""
    missing = [name for name in sequence if name not in surfaces]
    if missing:
        text = message(
            "site.order-without-surface",
            "The order names '{name}', which has no surface; the surfaces are {names}. Fit it, or "
            "take it out of the order.",
            name=missing[0],
            names=", ".join(surfaces) or message("data.none", "none"),
        )
        raise SettingsError(text)
    if len(set(sequence)) < len(sequence):
        text = message(
            "site.order-repeats-horizon",
            "The order names a horizon twice: {names}. Name each once, top to bottom.",
            names=", ".join(sequence),
        )
        raise SettingsError(text)


def _compare(
    upper: HeightField,
    lower: HeightField,
    ground: Ground | None,
    above: Sequence[HeightField] = (),
    below: Sequence[HeightField] = (),
) -> Order:
    found = Overlap.between(upper, lower)
    if found is None:
        nan = float("nan")
        return Order(upper.name, lower.name, 0.0, nan, nan, nan, (nan, nan), (nan, nan), ())
    thin, thick = found.thinnest, found.thickest
    least = max(upper.epsilon, lower.epsilon)
    size = found.layer(ground, least, above, below)
    return Order(
        upper=upper.name,
        lower=lower.name,
        area=found.size,
        min=thin[2],
        mean=found.mean,
        max=thick[2],
        thinnest=thin[:2],
        thickest=thick[:2],
        crossings=found.crossings(ground),
        volume=size.volume,
        present=size.present,
        least=least,
        grounded=ground is not None,
        disputed=size.disputed,
        at_least=size.at_least,
        at_most=size.at_most,
        without=size.without,
        doubtful=size.doubtful,
    )
